//! `candela explain X Y`: one pixel of one frame, replayed.

use super::args::values::{parse_size, positive, time};
use super::args::{DeviceArgs, KnobArgs, SceneArgs};
use super::progress::Steps;
use super::{output, view};
use candela::error::{Error, Result};
use candela::frame::renderer::{FrameOptions, Renderer};
use candela::frame::schedule::Work;
use candela::gpu_scene::GpuScene;
use candela::scene::SceneDescription;
use candela::vulkan::Device;
use candela_lab::explain::{World, check_pixel, next_frame};
use clap::Args;
use glam::UVec2;
use shared::camera::Camera;

#[derive(Args, Clone, Debug)]
pub struct ExplainArgs {
    /// Column of the pixel, from the left, from 0.
    pub x: u32,
    /// Row of the pixel, from the top, from 0.
    pub y: u32,
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Width x height in pixels.
    #[arg(long, default_value = "1280x720", value_parser = parse_size)]
    pub size: UVec2,
    /// As for `render`.
    #[arg(long)]
    pub camera: Option<String>,
    /// As for `render`.
    #[arg(long, default_value_t = 0)]
    pub seed: u32,
    /// Frames, as `render` counts them; the last one is explained.
    #[arg(long, default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..))]
    pub frames: u32,
    /// Explain this frame instead, counted from 0.
    #[arg(long, value_name = "F", conflicts_with = "frames")]
    pub frame: Option<u32>,
    /// Play the scene's animations: time of frame 0, in seconds [default: at rest].
    #[arg(long, value_name = "T", value_parser = time)]
    pub time: Option<f64>,
    /// Frames a second of the animation.
    #[arg(long, default_value_t = 24.0, value_parser = positive, requires = "time")]
    pub fps: f32,
    #[command(flatten)]
    pub device: DeviceArgs,
    #[command(flatten)]
    pub knobs: KnobArgs,
    /// Print JSON, for scripts.
    #[arg(long)]
    pub json: bool,
}

pub fn run(args: &ExplainArgs) -> Result<()> {
    let pixel = UVec2::new(args.x, args.y);
    check_pixel(pixel, args.size)?;
    let knobs = args.knobs.knobs()?;
    let scene = view::load_scene(&args.scene)?;
    scene.camera(args.camera.as_deref())?;
    let device = Device::new(&args.device.options())?;
    let gpu_scene = GpuScene::new(&device, &scene)?;
    let settings = knobs.settings(gpu_scene.lights());
    let mut renderer = Renderer::new(&device, gpu_scene, args.size, settings.reservoirs)?;
    let options = FrameOptions::new(Work::Restir(settings), knobs.primary, args.seed);

    let before = args.frame.unwrap_or(args.frames - 1);
    let mut progress = Steps::new(before.into(), "frames before");
    let mut stage = Stage { args, world: World::new(&scene)?, scene: scene.clone() };
    for frame in 0..before {
        let camera = stage.set(frame, &mut renderer)?;
        renderer.render(camera, &options)?;
        progress.step();
    }
    progress.end();
    let camera = stage.set(before, &mut renderer)?;
    let (recorder, history) = renderer.parts();
    let explanation = next_frame(recorder, history, &stage.world, camera, &options, pixel)?;
    if args.json {
        let json = serde_json::to_string_pretty(&explanation).map_err(Error::internal)?;
        println!("{json}");
    } else {
        print!("{explanation}");
    }
    output::check_validation(&device)
}

/// The scene as the frames show it, on the GPU and for the replay.
struct Stage<'a> {
    args: &'a ExplainArgs,
    world: World<'a>,
    scene: SceneDescription,
}

impl Stage<'_> {
    /// Sets it for `frame`, and gives the camera.
    fn set(&mut self, frame: u32, renderer: &mut Renderer) -> Result<Camera> {
        if let Some(start) = self.args.time {
            let pose = self.scene.pose(start + f64::from(frame) / f64::from(self.args.fps));
            self.scene.apply(&pose);
            if self.scene.changes() {
                renderer.update_scene(&self.scene, &pose)?;
                self.world.follow(&self.scene, &pose);
            }
        }
        Ok(self.scene.camera(self.args.camera.as_deref())?.seen_in(self.args.size))
    }
}
