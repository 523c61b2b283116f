//! `candela reference`: the truth, accumulated in f64.

use super::args::{DeviceArgs, PictureArgs, SceneArgs, choice};
use super::progress::Steps;
use super::{output, view};
use crate::error::Result;
use crate::frame::renderer::{FrameOptions, Renderer};
use crate::frame::schedule::{Primary, Work};
use crate::gpu_scene::GpuScene;
use crate::image_io::PictureFormat;
use crate::measure::mean::Mean;
use crate::measure::sweep::truth::Lighting;
use crate::vulkan::Device;
use clap::Args;
use glam::Vec3;

#[derive(Args, Clone, Debug)]
pub struct ReferenceArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    #[command(flatten)]
    pub picture: PictureArgs,
    #[command(flatten)]
    pub device: DeviceArgs,
    /// Points drawn on each light with an extent. Where every light is a point, a spot or a sun and nothing is transparent, one is
    /// exact and no more are taken.
    #[arg(long, default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..))]
    pub samples: u32,
    /// As for `render`.
    #[arg(long, value_parser = choice::<Primary>(), default_value = "auto")]
    pub primary: Primary,
}

pub fn run(args: &ReferenceArgs) -> Result<()> {
    let format = crate::image_io::check_writable(&args.picture.output)?;
    let mut scene = view::load_scene(&args.scene)?;
    view::pose(&mut scene, args.picture.time);
    let camera = view::camera(&scene, &args.picture)?;
    let device = Device::new(&args.device.options())?;
    let gpu_scene = GpuScene::new(&device, &scene)?;
    let lighting = Lighting::new(&gpu_scene, args.primary);
    let lights = lighting.lights;
    let samples = if lighting.is_exact() { 1 } else { args.samples };
    let mut renderer = Renderer::new(&device, gpu_scene, args.picture.size, 0)?;
    let options = FrameOptions {
        work: Work::Reference { lights },
        primary: args.primary,
        seed: args.picture.seed,
        exposure: 1.0,
        background: Vec3::ZERO,
    };
    let metered = match format {
        PictureFormat::Png => renderer.meter(camera, &options)?,
        PictureFormat::Exr => None,
    };
    let mut progress = Steps::new(samples.into(), "reference");
    let mut mean = Mean::new(args.picture.size);
    for _ in 0..samples {
        renderer.render(camera, &options)?;
        mean.add(&renderer.radiance()?);
        progress.step();
    }
    progress.end();
    output::write(&args.picture, format, &mean.radiance(), metered)?;
    println!("{}: {lights} lights, {samples} samples each", device.info().name);
    match samples {
        1 if lighting.is_exact() => println!("exact: no light has an extent"),
        1 => {}
        _ => println!(
            "standard error of the mean: {:.2e} of the mean luminance",
            mean.relative_standard_error()
        ),
    }
    output::check_validation(&device)
}
