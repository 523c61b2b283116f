//! `candela explain X Y`: how one pixel of one frame came to be.

use super::args::ExplainArgs;
use super::{output, progress, view};
use crate::error::{Error, Result};
use crate::explain::{World, check_pixel, next_frame};
use crate::frame::renderer::{FrameOptions, Renderer};
use crate::frame::schedule::Work;
use crate::gpu_scene::GpuScene;
use crate::scene::SceneDescription;
use crate::vulkan::Device;
use glam::{UVec2, Vec3};
use shared::camera::Camera;

pub fn run(args: &ExplainArgs) -> Result<()> {
    let pixel = UVec2::new(args.x, args.y);
    check_pixel(pixel, args.size)?;
    let knobs = args.knobs.document()?;
    let scene = view::load_scene(&args.scene)?;
    view::scene_camera(&scene, args.camera.as_deref())?;
    let device = Device::new(&args.device.options())?;
    let gpu_scene = GpuScene::new(&device, &scene)?;
    let settings = knobs.settings(gpu_scene.light_count());
    let mut renderer = Renderer::new(&device, gpu_scene, args.size, settings.reservoirs)?;
    let options =
        FrameOptions { work: Work::Restir(settings), seed: args.seed, exposure: 1.0, background: Vec3::ZERO };

    let before = args.frame.unwrap_or(args.frames - 1);
    let bar = progress::bar(before.into(), "frames before");
    let mut stage = Stage { args, world: World::new(&scene)?, scene: scene.clone() };
    for frame in 0..before {
        let camera = stage.set(frame, &mut renderer)?;
        renderer.render(camera, &options)?;
        bar.inc(1);
    }
    bar.finish_and_clear();
    let camera = stage.set(before, &mut renderer)?;
    let (recorder, history) = renderer.parts();
    let explanation = next_frame(recorder, history, &stage.world, camera, &options, pixel)?;
    if args.json {
        let json = serde_json::to_string_pretty(&explanation)
            .map_err(|e| Error::Usage(format!("the explanation can't be written as JSON: {e}")))?;
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
            if self.scene.animation.moves_things() {
                renderer.update_scene(&self.scene, &pose)?;
                self.world.follow(&self.scene, &pose);
            }
        }
        let camera = view::scene_camera(&self.scene, self.args.camera.as_deref())?;
        Ok(view::shared_camera(&camera, self.args.size))
    }
}
