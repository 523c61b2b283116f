//! `candela denoise`: a still picture through Intel Open Image Denoise, helped by the layers that `render --layers` writes.

use super::args::values::stops;
use candela::error::{Error, Result};
use candela::exposure;
use candela::image_io::{self, Layers, PictureFormat};
use clap::Args;
use glam::{UVec2, Vec3};
use std::path::PathBuf;

#[derive(Args, Clone, Debug)]
pub struct DenoiseArgs {
    /// The picture: .exr, linear radiance. Its layers albedo, f0 and normal keep edges and textures (`render --layers`).
    pub picture: PathBuf,
    /// Picture to write: .png (tone mapped) or .exr.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Stops brighter (+) or darker (-) than the automatic exposure of a .png.
    #[arg(long, default_value_t = 0.0, allow_hyphen_values = true, value_parser = stops)]
    pub exposure: f32,
}

/// What the filter is given: as many of each as there are pixels.
#[cfg_attr(not(feature = "oidn"), expect(dead_code, reason = "only the filter reads the pixels"))]
struct Noisy {
    size: UVec2,
    /// nit, finite.
    color: Vec<Vec3>,
    /// Albedo, 0..=1, and unit normals, of the same surfaces; without noise.
    guides: Option<[Vec<Vec3>; 2]>,
}

pub fn run(args: &DenoiseArgs) -> Result<()> {
    let format = image_io::check_writable(&args.output)?;
    let noisy = Noisy::new(image_io::read_layers(&args.picture)?).map_err(Error::input(&args.picture))?;
    if noisy.guides.is_none() {
        eprintln!(
            "note: {} has no layers albedo, f0 and normal; with them (`render --layers`) edges and textures stay sharper",
            args.picture.display()
        );
    }
    let size = noisy.size;
    let clean = filter(noisy)?;
    match format {
        PictureFormat::Exr => image_io::write_exr(&args.output, size, &clean)?,
        PictureFormat::Png => {
            let exposure = exposure::automatic(&clean, args.exposure);
            image_io::write_tone_mapped(&args.output, size, &clean, exposure)?;
        }
    }
    println!("wrote {}", args.output.display());
    Ok(())
}

impl Noisy {
    /// Of a picture's channels; pixels that are not finite count as black.
    fn new(layers: Layers) -> Result<Self, String> {
        let color = layers.colors(["R", "G", "B"]).ok_or("it has no channels R, G and B")?;
        let broken = color.iter().filter(|c| !c.is_finite()).count();
        if broken > 0 {
            eprintln!("warning: {broken} pixels are not finite, and count as black");
        }
        let color = color.into_iter().map(|c| if c.is_finite() { c } else { Vec3::ZERO }).collect();
        let layer = |names: [&str; 3]| layers.colors(names);
        let guides = layer(["albedo.R", "albedo.G", "albedo.B"])
            .zip(layer(["f0.R", "f0.G", "f0.B"]))
            .zip(layer(["normal.X", "normal.Y", "normal.Z"]))
            .map(|((albedo, f0), normal)| {
                // What a surface reflects at all: metals have no albedo of their own.
                let reflects = albedo.into_iter().zip(f0).map(|(a, b)| (a + b).clamp(Vec3::ZERO, Vec3::ONE));
                [reflects.collect(), normal]
            });
        Ok(Noisy { size: layers.size, color, guides })
    }
}

#[cfg(not(feature = "oidn"))]
fn filter(_: Noisy) -> Result<Vec<Vec3>> {
    Err(Error::Unsupported(
        "this build has no Open Image Denoise: install it (your system's package, or `pip install pyoidn` and OIDN_DIR set to its \
         folder oidn), then build with `--features oidn`; or denoise while rendering, `render --denoise`"
            .into(),
    ))
}

#[cfg(feature = "oidn")]
fn filter(noisy: Noisy) -> Result<Vec<Vec3>> {
    fn flat(pixels: &[Vec3]) -> Vec<f32> {
        pixels.iter().flat_map(|p| p.to_array()).collect()
    }
    let failed = |error: oidn::Error| Error::Platform(format!("Open Image Denoise: {error}"));
    let device = oidn::Device::new().map_err(failed)?;
    let mut filter = oidn::RayTracing::try_new(&device).map_err(failed)?;
    filter.image_dimensions(noisy.size.x as usize, noisy.size.y as usize).hdr(true);
    if let Some(guides) = &noisy.guides {
        let buffer = |guide: &Vec<Vec3>| device.create_buffer(&flat(guide)).map_err(failed);
        let [albedo, normal] = guides;
        filter.albedo_normal_buffer(buffer(albedo)?, buffer(normal)?).map_err(failed)?;
        filter.clean_aux(true);
    }
    let color = flat(&noisy.color);
    let mut clean = vec![0.0; color.len()];
    filter.filter(&color, &mut clean).map_err(failed)?;
    Ok(clean.chunks_exact(3).map(|c| Vec3::from_slice(c)).collect())
}
