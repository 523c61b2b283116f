//! `candela reference`: the truth, accumulated in f64: a sum over all lights, and paths for light that bounces.

use super::accumulation::Accumulation;
use super::args::values::bounces;
use super::args::{DeviceArgs, PictureArgs, SceneArgs, choice};
use super::progress::Steps;
use super::{output, view};
use candela::error::Result;
use candela::frame::renderer::{FrameOptions, Renderer};
use candela::frame::schedule::{Primary, Work};
use candela::gpu_scene::GpuScene;
use candela::image_io::PictureFormat;
use candela::vulkan::Device;
use candela_lab::measure::sweep::truth::{Lighting, PATHS_A_FRAME};
use clap::Args;
use shared::antialias::PixelFilter;
use shared::interface::UNBOUNDED;
use shared::math::CENTER;
use std::time::{Duration, Instant};

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
    /// Reflections of light before the visible surface: 0 is direct light, `inf` has no limit.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = bounces)]
    pub bounces: u32,
    /// Paths a pixel for indirect light.
    #[arg(long, default_value_t = 256, value_parser = clap::value_parser!(u32).range(1..))]
    pub paths: u32,
    /// Look through another place in each pixel with each sample, drawn like a filter: the truth of an antialiased mean.
    #[arg(long, value_name = "FILTER", num_args = 0..=1, require_equals = true, default_missing_value = "gaussian", value_parser = choice::<PixelFilter>())]
    pub antialias: Option<PixelFilter>,
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
    let samples = if lighting.is_exact() && args.antialias.is_none() { 1 } else { args.samples };
    let place = |frame: u32| args.antialias.map_or(CENTER, |filter| filter.place(frame));
    let mut renderer = Renderer::new(&device, gpu_scene, args.picture.size, 0)?;
    let options = args.picture.options(Work::Reference { lights }, args.primary);
    let metered = match format {
        PictureFormat::Png => renderer.meter(camera, &options)?,
        PictureFormat::Exr => None,
    };
    // As many in each frame: all weigh the same.
    let path_frames = if args.bounces > 0 { args.paths.div_ceil(PATHS_A_FRAME) } else { 0 };
    let paths_a_frame = args.paths.div_ceil(path_frames.max(1));
    let mut progress = Steps::new(u64::from(samples) + u64::from(path_frames), "reference");
    let start = Instant::now();
    let mut accumulation = Accumulation::new(args.picture.size, options.parts);
    for frame in 0..samples {
        renderer.render(camera, &FrameOptions { place: place(frame), ..options })?;
        accumulation.add(&renderer)?;
        progress.step();
    }
    let summed = start.elapsed();
    let work = Work::Paths { bounces: args.bounces, paths: paths_a_frame };
    for frame in 0..path_frames {
        renderer.render(camera, &FrameOptions { work, place: place(frame), ..options })?;
        accumulation.add_paths(&renderer)?;
        progress.step();
    }
    progress.end();
    let traced = start.elapsed() - summed;
    let content = accumulation.content(&renderer, camera, None)?;
    output::write(content, format, &args.picture, metered)?;
    let seconds = |time: Duration| format!("{:.1} s", time.as_secs_f64());
    println!("{}: {lights} lights, {samples} samples each, {}", device.info().name, seconds(summed));
    let paths = path_frames * paths_a_frame;
    match args.bounces {
        0 => {}
        UNBOUNDED => println!("{paths} paths a pixel, any number of bounces, {}", seconds(traced)),
        n => println!("{paths} paths a pixel, {n} bounces, {}", seconds(traced)),
    }
    match samples.max(path_frames) {
        1 if lighting.is_exact() && args.antialias.is_none() && paths == 0 => {
            println!("exact: no light has an extent")
        }
        1 => {}
        _ => println!(
            "standard error of the mean: {:.2e} of the mean luminance",
            accumulation.relative_standard_error()
        ),
    }
    output::check_validation(&device)
}
