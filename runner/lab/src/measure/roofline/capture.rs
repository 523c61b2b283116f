//! The rays of a frame, asked for again on the CPU by the bodies of its passes, from what they found.
//!
//! A ray may depend on what the one before it met: the first ones are traced on the device before the second ones are known.

use super::Frame;
use candela::error::Result;
use candela::frame::follow::{Follower, Ran};
use candela::frame::renderer::Renderer;
use candela::parallel;
use candela::scene::lights::LightTable;
use glam::UVec2;
use shared::alpha;
use shared::frame::FrameConstants;
use shared::light::tree::{self, Tree};
use shared::passes::{Pass, Question, Rays, Silent, Stage, Visibility, run};
use shared::resources::Buffers;
use shared::shadow::ShadowRay;
use shared::stored_ray::StoredRay;

/// The rays that a pass traces at once, one place a pixel.
pub struct Captured {
    pub pass: &'static str,
    pub rays: Vec<StoredRay>,
}

/// The rays of the next frame of `renderer`, in its order. `trace` says of each ray whether it met anything.
pub fn rays(
    renderer: &mut Renderer,
    lights: &LightTable,
    frame: Frame,
    mut trace: impl FnMut(&mut Renderer, &[StoredRay]) -> Result<Vec<u32>>,
) -> Result<Vec<Captured>> {
    let (recorder, history) = renderer.parts();
    let features = recorder.scene().features();
    let (mut follower, mut ran) = (Follower::default(), Vec::new());
    recorder.render_stepwise(history, frame.camera, &frame.options(), |history, frame, step| {
        ran.push(follower.see(history, frame, step)?);
        Ok(())
    })?;
    let draws_from_tree = ran.iter().any(|step| step.pass == Pass::pools);
    let tree = if draws_from_tree { tree::build(&lights.lights) } else { Tree::default() };
    let scene = Buffers {
        lights: &lights.lights,
        alias: &lights.alias,
        tree_nodes: &tree.nodes,
        tree_lights: &tree.lights,
        tree_leaves: &tree.leaves,
        ..Buffers::default()
    };
    let mut captured = Vec::new();
    for pass in &ran {
        match pass.pass.stage() {
            Stage::RayTracing(Rays::Primary) => captured.push(primary(pass)),
            Stage::RayTracing(Rays::Shadow | Rays::Both) => {
                captured.extend(shadow(pass, features, &scene, |rays| trace(renderer, rays))?);
            }
            // No frame that is measured has paths.
            Stage::RayTracing(Rays::Bounces) | Stage::Compute | Stage::Raster => {}
        }
    }
    Ok(captured)
}

fn primary(ran: &Ran) -> Captured {
    let frame: &FrameConstants = &ran.frame;
    let ray = |pixel: UVec2| {
        let direction = frame.camera.direction(pixel.as_vec2() + 0.5, frame.size);
        StoredRay::new(frame.camera.position, direction, alpha::primary_key(frame, pixel))
    };
    Captured { pass: ran.pass.stem(), rays: each_pixel(frame.size, ray) }
}

/// The shadow rays of a pass: a list for each ray that a thread traces, as long as any pixel asks.
fn shadow(
    ran: &Ran,
    features: u32,
    scene: &Buffers<'_>,
    mut trace: impl FnMut(&[StoredRay]) -> Result<Vec<u32>>,
) -> Result<Vec<Captured>> {
    let buffers = ran.buffers(scene);
    let mut rounds: Vec<Vec<bool>> = Vec::new();
    let mut captured = Vec::new();
    loop {
        let rays = each_pixel(ran.frame.size, |pixel| {
            let at = ran.at(features, pixel, 0);
            let index = ran.frame.pixel_index(pixel) as usize;
            let mut recorder = Recorder { rounds: &rounds, index, asked: 0, next: StoredRay::default() };
            run(ran.pass.body(), at, &mut recorder, Silent, &buffers);
            recorder.next
        });
        if rays.iter().all(|ray| ray.traced == 0) {
            return Ok(captured);
        }
        rounds.push(trace(&rays)?.into_iter().map(|hit| hit == 0).collect());
        captured.push(Captured { pass: ran.pass.stem(), rays });
    }
}

/// Answers the rays of one pixel that were traced before, and writes down the next one. BSDF rays find nothing.
struct Recorder<'a> {
    /// Of each ray that a thread traces, whether it was visible, by pixel.
    rounds: &'a [Vec<bool>],
    index: usize,
    asked: usize,
    next: StoredRay,
}

impl Visibility for Recorder<'_> {
    const TRACES: bool = true;

    fn sees(&mut self, _: Question, ray: ShadowRay, key: u32) -> bool {
        let answer = self.rounds.get(self.asked).map(|round| round[self.index]);
        if self.asked == self.rounds.len() {
            self.next = StoredRay::new(ray.origin, ray.direction, key);
        }
        self.asked += 1;
        answer.unwrap_or(true)
    }
}

fn each_pixel(size: UVec2, ray: impl Fn(UVec2) -> StoredRay + Sync) -> Vec<StoredRay> {
    let rows: Vec<u32> = (0..size.y).collect();
    let row = |&y: &u32| (0..size.x).map(|x| ray(UVec2::new(x, y))).collect::<Vec<_>>();
    parallel::map(&rows, row).concat()
}
