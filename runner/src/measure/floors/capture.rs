//! The rays of a frame, computed again on the CPU from what its passes left, by the functions that the shaders call.

use super::Kind;
use crate::error::Result;
use crate::frame::history::History;
use crate::frame::pass::{Role, Step};
use crate::frame::renderer::{FrameOptions, Renderer};
use crate::frame::schedule::Work;
use crate::scene::lights::LightTable as SceneLights;
use glam::{IVec2, UVec2};
use shared::alpha::{self, SURE_HITS_ONLY};
use shared::camera::Camera;
use shared::frame::{FrameConstants, Settings};
use shared::light::{LightTable, Lights};
use shared::reservoir::StoredReservoir;
use shared::rng::{Rng, Stream};
use shared::shading;
use shared::stored_ray::StoredRay;
use shared::surface::GBufferTexel;

/// The rays of one kind, one place a pixel.
pub struct Captured {
    pub kind: Kind,
    pub rays: Vec<StoredRay>,
}

/// The rays of the next frame of `renderer`: first those of the frame itself, then, of the frame after it, those that test
/// survivors before reuse.
pub fn rays(
    renderer: &mut Renderer,
    lights: &SceneLights,
    camera: Camera,
    settings: Settings,
) -> Result<Vec<Captured>> {
    let mut capture = Capture { lights, gbuffer: Vec::new(), captured: Vec::new() };
    let (recorder, history) = renderer.parts();
    let options = super::options(settings);
    recorder.render_stepwise(history, camera, &options, |history, frame, step| {
        capture.see_frame(history, frame, step)
    })?;
    // A test that failed leaves no trace of its ray: here nothing is tested.
    let untested = Settings { visibility_reuse: 0, ..settings };
    let options = FrameOptions { work: Work::Restir(untested), ..options };
    recorder.render_stepwise(history, camera, &options, |history, frame, step| {
        capture.see_candidates(history, frame, step)
    })?;
    let mut captured = capture.captured;
    captured.sort_by_key(|captured| captured.kind);
    Ok(captured)
}

struct Capture<'a> {
    lights: &'a SceneLights,
    gbuffer: Vec<GBufferTexel>,
    captured: Vec<Captured>,
}

impl Capture<'_> {
    fn see_frame(&mut self, history: &History, frame: &FrameConstants, step: &Step) -> Result<()> {
        match step.pass.stem {
            "gbuffer" => {
                self.gbuffer = history.read_role(step, Role::GBuffer)?;
                self.captured.push(collect(Kind::Primary, frame, |pixel| Some(primary(frame, pixel))));
            }
            "shade" => {
                let reservoirs: Vec<StoredReservoir> = history.read_role(step, Role::ReservoirsIn)?;
                let at = |pixel: UVec2| reservoirs[frame.pixel_index(pixel) as usize];
                let shading = collect(Kind::Shading, frame, |pixel| {
                    let mut rng = Rng::new(pixel, frame.index, frame.seed, Stream::Shade, 0);
                    self.shadow(frame, pixel, at(pixel), alpha::key(rng.next_u32x4().x))
                });
                let neighbors = collect(Kind::Neighbor, frame, |pixel| {
                    self.shadow(frame, pixel, at(neighbor(frame, pixel)), SURE_HITS_ONLY)
                });
                self.captured.extend([shading, neighbors]);
            }
            _ => {}
        }
        Ok(())
    }

    fn see_candidates(&mut self, history: &History, frame: &FrameConstants, step: &Step) -> Result<()> {
        match step.pass.stem {
            "gbuffer" => self.gbuffer = history.read_role(step, Role::GBuffer)?,
            "initial" | "initial_tiled" => {
                let reservoirs: Vec<StoredReservoir> = history.read_role(step, Role::ReservoirsOut)?;
                let survivors = collect(Kind::Visibility, frame, |pixel| {
                    let survivor = reservoirs[frame.pixel_index(pixel) as usize];
                    self.shadow(frame, pixel, survivor, SURE_HITS_ONLY)
                });
                self.captured.push(survivors);
            }
            _ => {}
        }
        Ok(())
    }

    /// From the surface of `pixel` to the sample of `reservoir`, if there is anything to ask.
    fn shadow(
        &self,
        frame: &FrameConstants,
        pixel: UVec2,
        reservoir: StoredReservoir,
        key: u32,
    ) -> Option<StoredRay> {
        let texel = self.gbuffer[frame.pixel_index(pixel) as usize];
        if texel.is_empty() {
            return None;
        }
        let surface = texel.unpack(&frame.camera, pixel, frame.size);
        let lights =
            LightTable { lights: Lights::untextured(&self.lights.lights), alias: &self.lights.alias };
        let proposal = shading::propose(&surface, lights, reservoir);
        (!proposal.is_dark()).then(|| StoredRay::new(proposal.ray.origin, proposal.ray.direction, key))
    }
}

fn collect(kind: Kind, frame: &FrameConstants, ray: impl Fn(UVec2) -> Option<StoredRay>) -> Captured {
    let pixels = (0..frame.size.y).flat_map(|y| (0..frame.size.x).map(move |x| UVec2::new(x, y)));
    Captured { kind, rays: pixels.map(|pixel| ray(pixel).unwrap_or_default()).collect() }
}

fn primary(frame: &FrameConstants, pixel: UVec2) -> StoredRay {
    let mut rng = Rng::new(pixel, frame.index, frame.seed, Stream::Primary, 0);
    let direction = frame.camera.direction(pixel.as_vec2() + 0.5, frame.size);
    StoredRay::new(frame.camera.position, direction, alpha::key(rng.next_u32x4().x))
}

/// Anywhere in the square of the radius, inside the picture.
fn neighbor(frame: &FrameConstants, pixel: UVec2) -> UVec2 {
    let mut rng = Rng::new(pixel, frame.index, frame.seed, Stream::Spatial, 0);
    let random = rng.next_u32x4();
    let radius = frame.settings.radius as i32;
    let side = 2 * radius as u32 + 1;
    let offset = IVec2::new((random.x % side) as i32, (random.y % side) as i32) - radius;
    (pixel.as_ivec2() + offset).clamp(IVec2::ZERO, frame.size.as_ivec2() - 1).as_uvec2()
}
