//! `candela reference`: the truth, accumulated in f64.

use super::accumulation::Accumulation;
use super::args::{DeviceArgs, PictureArgs, SceneArgs, choice};
use super::output::Picture;
use super::progress::Steps;
use super::{output, view};
use crate::error::Result;
use crate::frame::renderer::Renderer;
use crate::frame::schedule::{Primary, Work};
use crate::gpu_scene::GpuScene;
use crate::image_io::PictureFormat;
use crate::measure::sweep::truth::Lighting;
use crate::vulkan::Device;
use clap::Args;

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
    let format = output::check(&args.picture.output, &args.picture)?;
    let mut scene = view::load_scene(&args.scene)?;
    view::pose(&mut scene, args.picture.time);
    let camera = view::camera(&scene, &args.picture)?;
    let device = Device::new(&args.device.options())?;
    let gpu_scene = GpuScene::new(&device, &scene)?;
    let lighting = Lighting::new(&gpu_scene, args.primary);
    let lights = lighting.lights;
    let samples = if lighting.is_exact() { 1 } else { args.samples };
    let mut renderer = Renderer::new(&device, gpu_scene, args.picture.size, 0)?;
    let options = args.picture.options(Work::Reference { lights }, args.primary);
    let metered = match format {
        PictureFormat::Png => renderer.meter(camera, &options)?,
        PictureFormat::Exr => None,
    };
    let mut progress = Steps::new(samples.into(), "reference");
    let mut accumulation = Accumulation::new(args.picture.size, options.parts);
    for _ in 0..samples {
        renderer.render(camera, &options)?;
        accumulation.add(&renderer)?;
        progress.step();
    }
    progress.end();
    let picture = Picture { frames: &accumulation, renderer: &renderer, camera, format };
    picture.write(&args.picture, metered)?;
    println!("{}: {lights} lights, {samples} samples each", device.info().name);
    match samples {
        1 if lighting.is_exact() => println!("exact: no light has an extent"),
        1 => {}
        _ => println!(
            "standard error of the mean: {:.2e} of the mean luminance",
            accumulation.radiance.relative_standard_error()
        ),
    }
    output::check_validation(&device)
}
