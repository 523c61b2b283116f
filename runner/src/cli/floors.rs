//! `candela floors`: how fast this device traces the rays of a frame, and moves its bytes, without the frame around them.

use super::args::values::parse_size;
use super::args::{DeviceArgs, SceneArgs};
use super::{output, view};
use crate::error::{Error, Result};
use crate::frame::renderer::Renderer;
use crate::gpu_scene::GpuScene;
use crate::measure::floors::{self, Floors, RayFloor};
use crate::scene::lights::LightTable;
use crate::settings_file::SettingsFile;
use crate::vulkan::Device;
use clap::Args;
use glam::UVec2;

#[derive(Args, Clone, Debug)]
pub struct FloorsArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Width x height in pixels.
    #[arg(long, default_value = "1920x1080", value_parser = parse_size)]
    pub size: UVec2,
    /// As for `render`.
    #[arg(long)]
    pub camera: Option<String>,
    /// Timed launches of each kind of ray, and timed frames.
    #[arg(long, default_value_t = 32, value_parser = clap::value_parser!(u32).range(2..))]
    pub frames: u32,
    #[command(flatten)]
    pub device: DeviceArgs,
    /// As one JSON object.
    #[arg(long)]
    pub json: bool,
}

pub fn run(args: &FloorsArgs) -> Result<()> {
    let scene = view::load_scene(&args.scene)?;
    let camera = view::shared_camera(&view::scene_camera(&scene, args.camera.as_deref())?, args.size);
    let lights = LightTable::new(&scene);
    let device = Device::new(&args.device.options())?;
    let gpu_scene = GpuScene::new(&device, &scene)?;
    let settings = SettingsFile::default().settings(gpu_scene.light_count());
    let mut renderer = Renderer::new(&device, gpu_scene, args.size, settings.reservoirs)?;
    let floors = floors::measure(&mut renderer, &lights, camera, settings, args.frames)?;
    if args.json {
        println!("{}", serde_json::to_string_pretty(&floors).map_err(|e| Error::Usage(e.to_string()))?);
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
        print(&floors);
    }
    output::check_validation(&device)
}

fn print(floors: &Floors) {
    println!("\n| rays | traced | of them hit | ms | spread | Mrays/s |\n|---|---|---|---|---|---|");
    for RayFloor { kind, rays, hits, ms, rate } in &floors.rays {
        let name = format!("{kind:?}").to_lowercase();
        println!("| {name} | {rays} | {hits} | {:.3} | {:.3} | {rate:.1} |", ms.median, ms.spread);
    }
    let megabytes = floors.copied as f64 * 1e-6;
    println!(
        "\ncopy of {megabytes:.1} MB read and written: {:.3} ms, {:.1} GB/s",
        floors.copy_ms.median, floors.bandwidth
    );
    let passes: Vec<_> = floors.passes.iter().map(|(stem, ms)| format!("{stem} {ms:.3}")).collect();
    println!("biased frame, ms: {} = {:.3}", passes.join(" + "), floors.frame_ms);
    let rays = floors.ray_ms();
    println!("its rays alone: {rays:.3} ms; the frame takes {:.2} times as long", floors.frame_ms / rays);
    if !floors.steady {
        println!("not steady: times still changed by more than 1 % when the longest wait was over");
    }
}
