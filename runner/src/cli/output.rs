//! What commands leave behind: the picture, and a verdict of the validation layer.

use super::args::PictureArgs;
use crate::error::{Error, Result};
use crate::exposure;
use crate::image_io::{self, PictureFormat};
use crate::vulkan::Device;
use glam::{UVec2, Vec3};
use shared::tonemap;
use std::path::Path;

/// Writes `radiance` (nit) as the picture that was asked for, under the exposure that was metered, or by itself.
pub fn write(
    args: &PictureArgs,
    format: PictureFormat,
    radiance: &[Vec3],
    metered: Option<f32>,
) -> Result<()> {
    let exposure = match metered {
        Some(exposure) => exposure * args.exposure.exp2(),
        None => exposure::automatic(radiance, args.exposure),
    };
    write_exposed(&args.output, args.size, format, radiance, exposure)?;
    println!("wrote {}", args.output.display());
    Ok(())
}

/// Writes `radiance` (nit) to `path`. `exposure`: factor to display values, where the format has such.
pub fn write_exposed(
    path: &Path,
    size: UVec2,
    format: PictureFormat,
    radiance: &[Vec3],
    exposure: f32,
) -> Result<()> {
    match format {
        PictureFormat::Exr => image_io::write_exr(path, size, radiance),
        PictureFormat::Png => {
            let display: Vec<u32> =
                radiance.iter().map(|&c| tonemap::pack_rgba8(tonemap::display(c, exposure))).collect();
            image_io::write_png(path, size, &display)
        }
    }
}

/// Under `--validate`, a message of the layer is an error.
pub fn check_validation(device: &Device) -> Result<()> {
    let messages = device.validation_messages();
    match messages.first() {
        None => Ok(()),
        Some(first) => {
            Err(Error::Check(format!("{} validation messages, the first: {first}", messages.len())))
        }
    }
}
