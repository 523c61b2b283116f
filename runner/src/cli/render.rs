//! `candela render`: frames of ReSTIR, the last one or their mean as a picture.

use super::args::{Frames, RenderArgs};
use super::{output, progress, sequence, view};
use crate::error::Result;
use crate::frame::renderer::{FrameOptions, Renderer};
use crate::frame::schedule::Work;
use crate::gpu_scene::GpuScene;
use crate::measure::mean::Mean;
use crate::measure::times::PassTimes;
use crate::vulkan::Device;
use glam::Vec3;

pub fn run(args: &RenderArgs) -> Result<()> {
    match &args.frames {
        Frames::Still(frames) => still(args, *frames),
        Frames::Sequence(range) => sequence::run(args, range.clone()),
    }
}

fn still(args: &RenderArgs, frames: u32) -> Result<()> {
    let format = crate::image_io::check_writable(&args.picture.output)?;
    let knobs = args.knobs.document()?;
    let mut scene = view::load_scene(&args.scene)?;
    view::pose(&mut scene, args.picture.time);
    let camera = view::camera(&scene, &args.picture)?;
    let device = Device::new(&args.device.options())?;
    let gpu_scene = GpuScene::new(&device, &scene)?;
    let settings = knobs.settings(gpu_scene.light_count());
    let size = args.picture.size;
    let mut renderer = Renderer::new(&device, gpu_scene, size, settings.reservoirs)?;
    let options = FrameOptions {
        work: Work::Restir(settings),
        seed: args.picture.seed,
        exposure: 1.0,
        background: Vec3::ZERO,
    };

    let bar = progress::bar(frames.into(), "rendering");
    let mut times = PassTimes::default();
    let mut mean = Mean::new(size);
    for _ in 0..frames {
        times.add(renderer.render(camera, &options)?);
        if args.accumulate {
            mean.add(&renderer.radiance()?);
        }
        bar.inc(1);
    }
    bar.finish_and_clear();

    let radiance = if args.accumulate { mean.radiance() } else { renderer.radiance()? };
    output::write(&args.picture, format, &radiance)?;
    let lights = renderer.scene().light_count();
    println!("{}: {lights} lights, {}x{}, {} frames", device.info().name, size.x, size.y, frames);
    println!("{}", times.summary());
    println!("rays a frame: {}", settings_rays(size, &settings));
    output::check_validation(&device)
}

/// How many rays a frame traces: exact for primary rays; shadow rays are traced only where light could arrive.
fn settings_rays(size: glam::UVec2, settings: &shared::frame::Settings) -> String {
    let pixels = u64::from(size.x) * u64::from(size.y);
    let shadow = pixels * u64::from(settings.reservoirs);
    let initial = if settings.visibility_reuse != 0 { shadow } else { 0 };
    format!("{pixels} primary, at most {initial} for visibility reuse, at most {shadow} for shading")
}
