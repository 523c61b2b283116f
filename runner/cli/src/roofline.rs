//! `candela roofline`: how fast this device traces the rays of a frame, and moves its bytes, without the frame around them.

use super::args::values::parse_size;
use super::args::{DeviceArgs, KnobArgs, SceneArgs};
use super::{output, view};
use candela::error::{Error, Result};
use candela::frame::renderer::Renderer;
use candela::gpu_scene::GpuScene;
use candela::scene::lights::LightTable;
use candela::vulkan::Device;
use candela_lab::measure::roofline::{self, RayTimes, Roofline};
use clap::Args;
use glam::UVec2;

#[derive(Args, Clone, Debug)]
pub struct RooflineArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Width x height in pixels.
    #[arg(long, default_value = "1920x1080", value_parser = parse_size)]
    pub size: UVec2,
    /// As for `render`.
    #[arg(long)]
    pub camera: Option<String>,
    /// Of the frame whose rays are traced; `--primary rays` has the rays from the eye among them.
    #[command(flatten)]
    pub knobs: KnobArgs,
    /// Timed launches of each kind of ray, and timed frames.
    #[arg(long, default_value_t = 32, value_parser = clap::value_parser!(u32).range(2..))]
    pub frames: u32,
    #[command(flatten)]
    pub device: DeviceArgs,
    /// Print one JSON object.
    #[arg(long)]
    pub json: bool,
}

pub fn run(args: &RooflineArgs) -> Result<()> {
    let scene = view::load_scene(&args.scene)?;
    let camera = scene.camera(args.camera.as_deref())?.seen_in(args.size);
    let lights = LightTable::new(&scene);
    let device = Device::new(&args.device.options())?;
    let gpu_scene = GpuScene::new(&device, &scene)?;
    let knobs = args.knobs.knobs()?;
    let settings = knobs.settings(gpu_scene.lights());
    let mut renderer = Renderer::new(&device, gpu_scene, args.size, settings.reservoirs)?;
    let frame = roofline::Frame { camera, settings, primary: knobs.primary };
    let roofline = roofline::measure(&mut renderer, &lights, frame, args.frames)?;
    if args.json {
        println!("{}", serde_json::to_string_pretty(&roofline).map_err(Error::internal)?);
    } else {
        let size = args.size;
        println!(
            "{}: {}, {} lights, {}x{}",
            device.info().name,
            scene.name,
            lights.lights.len(),
            size.x,
            size.y
        );
        print(&roofline);
    }
    output::check_validation(&device)
}

fn print(roofline: &Roofline) {
    println!("\n| rays of | traced | of them hit | ms | spread | Mrays/s |\n|---|---|---|---|---|---|");
    for RayTimes { pass, rays, hits, ms, rate } in &roofline.rays {
        println!("| {pass} | {rays} | {hits} | {:.3} | {:.3} | {rate:.1} |", ms.median, ms.spread);
    }
    println!("\n| pass | ms | its rays alone, ms | times its rays |\n|---|---|---|---|");
    for (stem, ms) in &roofline.passes {
        let rays: f64 = roofline.rays.iter().filter(|r| r.pass == stem).map(|r| r.ms.median).sum();
        let (alone, times) = match rays > 0.0 {
            true => (format!("{rays:.3}"), format!("{:.2}", ms / rays)),
            false => Default::default(),
        };
        println!("| {stem} | {ms:.3} | {alone} | {times} |");
    }
    let (frame, rays) = (roofline.frame_ms, roofline.ray_ms());
    println!("| frame | {frame:.3} | {rays:.3} | {:.2} |", frame / rays);
    let (megabytes, copy) = (roofline.copied as f64 * 1e-6, &roofline.copy_ms);
    println!(
        "\ncopy: {megabytes:.1} MB read and written in {:.3} ms, {:.1} GB/s",
        copy.median, roofline.bandwidth
    );
    if !roofline.steady {
        println!("not steady: times still changed by more than 1 % at the end of the longest warm-up");
    }
}
