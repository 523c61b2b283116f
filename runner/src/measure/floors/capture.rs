//! The rays of a frame, computed again on the CPU from what its passes found, by the functions that the shaders call.
//!
//! A pass of unbiased reuse traces a second ray that depends on what the first one met: the first ones are traced on the device
//! before the second ones are known.

use super::Frame;
use crate::error::Result;
use crate::frame::history::History;
use crate::frame::pass::{Access, Role, Step};
use crate::frame::renderer::Renderer;
use crate::parallel;
use crate::scene::lights::LightTable as SceneLights;
use glam::UVec2;
use shared::alpha::{self, SURE_HITS_ONLY};
use shared::frame::{FrameConstants, Settings};
use shared::light::{LightTable, Lights};
use shared::resampling::{Pixels, initial, pairs, spatial, temporal};
use shared::reservoir::StoredReservoir;
use shared::rng::{Rng, Stream};
use shared::shading;
use shared::shadow::ShadowRay;
use shared::stored_ray::StoredRay;
use shared::surface::{GBufferTexel, Surface};

/// The rays that a pass traces at once, one place a pixel.
pub struct Captured {
    pub pass: &'static str,
    pub rays: Vec<StoredRay>,
}

/// What a pass found.
struct Found {
    pass: &'static str,
    iteration: u32,
    frame: FrameConstants,
    reservoirs: Vec<StoredReservoir>,
    previous: Vec<GBufferTexel>,
    history: Vec<StoredReservoir>,
}

/// The rays of the next frame of `renderer`, in its order. `trace` says of each ray whether it met anything.
pub fn rays(
    renderer: &mut Renderer,
    lights: &SceneLights,
    frame: Frame,
    mut trace: impl FnMut(&mut Renderer, &[StoredRay]) -> Result<Vec<u32>>,
) -> Result<Vec<Captured>> {
    let Frame { camera, settings, .. } = frame;
    let mut capture = Capture { lights, gbuffer: Vec::new(), fresh: Vec::new(), found: Vec::new() };
    let (recorder, history) = renderer.parts();
    recorder.render_stepwise(history, camera, &frame.options(), |history, frame, step| {
        capture.see(history, frame, step)
    })?;
    // A survivor that was tested and failed leaves no trace of its ray. In the next frame nothing is tested.
    let untested = Settings { visibility_reuse: 0, temporal: 0, spatial: 0, ..settings };
    let untested = Frame { settings: untested, ..frame }.options();
    let mut survivors = Vec::new();
    recorder.render_stepwise(history, camera, &untested, |history, frame, step| {
        if step.pass.stem.starts_with("initial") && settings.visibility_reuse != 0 {
            let reservoirs = history.read_role(step, Role::ReservoirsOut)?;
            survivors.push(Found::new(step, frame, reservoirs));
        }
        Ok(())
    })?;
    let found = std::mem::take(&mut capture.found);
    let at = found.iter().position(|found| found.pass != "gbuffer").unwrap_or(found.len());
    let mut captured = Vec::new();
    for (i, found) in found.iter().enumerate() {
        if i == at {
            captured
                .extend(survivors.iter().map(|s| capture.captured(s, |pixel| capture.survivor(s, pixel))));
        }
        captured.extend(capture.of(found, |rays| trace(renderer, rays))?);
    }
    Ok(captured)
}

impl Found {
    fn new(step: &Step, frame: &FrameConstants, reservoirs: Vec<StoredReservoir>) -> Self {
        let (pass, iteration) = (step.pass.stem, step.constants.iteration);
        Found { pass, iteration, frame: *frame, reservoirs, previous: Vec::new(), history: Vec::new() }
    }

    fn at(&self, pixel: UVec2) -> StoredReservoir {
        self.reservoirs[self.frame.pixel_index(pixel) as usize]
    }

    fn rng(&self, pixel: UVec2, stream: Stream) -> Rng {
        Rng::new(pixel, self.frame.index, self.frame.seed, stream, self.iteration)
    }
}

struct Capture<'a> {
    lights: &'a SceneLights,
    gbuffer: Vec<GBufferTexel>,
    /// As `initial` left them.
    fresh: Vec<StoredReservoir>,
    found: Vec<Found>,
}

impl Capture<'_> {
    fn see(&mut self, history: &History, frame: &FrameConstants, step: &Step) -> Result<()> {
        if step.pass.uses.contains(&(Role::GBuffer, Access::Write)) {
            self.gbuffer = history.read_role(step, Role::GBuffer)?;
        }
        match step.pass.stem {
            "gbuffer" => self.found.push(Found::new(step, frame, Vec::new())),
            "initial" | "initial_tiled" => self.fresh = history.read_role(step, Role::ReservoirsOut)?,
            "temporal_unbiased" => self.found.push(Found {
                previous: history.read_role(step, Role::PreviousGBuffer)?,
                history: history.read_role(step, Role::ReservoirsHistory)?,
                ..Found::new(step, frame, std::mem::take(&mut self.fresh))
            }),
            "spatial_unbiased" | "pair_targets" | "shade" => {
                let reservoirs = history.read_role(step, Role::ReservoirsIn)?;
                self.found.push(Found::new(step, frame, reservoirs));
            }
            _ => {}
        }
        Ok(())
    }

    /// The rays of a pass: one list, or two where the second ray waits for the first.
    fn of(
        &self,
        found: &Found,
        trace: impl FnOnce(&[StoredRay]) -> Result<Vec<u32>>,
    ) -> Result<Vec<Captured>> {
        let settings = &found.frame.settings;
        match found.pass {
            "gbuffer" => Ok(vec![self.captured(found, |pixel| Some(primary(&found.frame, pixel)))]),
            "shade" => Ok(vec![self.captured(found, |pixel| self.shading(found, pixel))]),
            "pair_targets" if settings.visibility_is_known() => {
                Ok(vec![self.captured(found, |pixel| self.partner(found, pixel))])
            }
            "temporal_unbiased" | "spatial_unbiased" if settings.visibility_is_known() => {
                let first = self.captured(found, |pixel| self.reuse(found, pixel, true)[0]);
                let hits = trace(&first.rays)?;
                let second = self.captured(found, |pixel| {
                    let seen = hits[found.frame.pixel_index(pixel) as usize] == 0;
                    self.reuse(found, pixel, seen)[1]
                });
                Ok(vec![first, second])
            }
            _ => Ok(Vec::new()),
        }
    }

    /// Whether a neighbor or the history sees the pixel's sample, and, if the answer is `seen`, whether the pixel sees what it
    /// has taken.
    fn reuse(&self, found: &Found, pixel: UVec2, seen: bool) -> [Option<StoredRay>; 2] {
        let (frame, lights) = (&found.frame, self.lights());
        let Some(surface) = self.surface(frame, pixel) else { return [None; 2] };
        let asked = |certain: bool, ray| (!certain).then(|| shadow(ray, SURE_HITS_ONLY));
        if found.pass == "temporal_unbiased" {
            let previous = Pixels { gbuffer: &found.previous, reservoirs: &found.history };
            let current = found.at(pixel);
            let Some(cross) = temporal::propose(frame, lights, &surface, current, previous, 0) else {
                return [None; 2];
            };
            let mut rng = found.rng(pixel, Stream::Temporal);
            let merged = temporal::accept(lights, &surface, current, cross, seen, &mut rng);
            [asked(cross.is_certain(), cross.ray), asked(merged.is_certain(), merged.ray)]
        } else {
            let mut rng = found.rng(pixel, Stream::Spatial);
            let pixels = Pixels { gbuffer: &self.gbuffer, reservoirs: &found.reservoirs };
            let proposal = spatial::propose(frame, lights, &surface, pixels, pixel, 0, &mut rng);
            let merged = spatial::accept(&surface, lights, proposal, seen, &mut rng);
            [asked(proposal.is_certain(), proposal.ray), asked(merged.is_certain(), merged.ray)]
        }
    }

    /// Whether the pixel sees its partner's sample.
    fn partner(&self, found: &Found, pixel: UVec2) -> Option<StoredRay> {
        let surface = self.surface(&found.frame, pixel)?;
        let pixels = Pixels { gbuffer: &self.gbuffer, reservoirs: &found.reservoirs };
        let proposal =
            pairs::propose(&found.frame, self.lights(), &surface, pixels, pixel, 0, found.iteration);
        (!proposal.is_certain()).then(|| shadow(proposal.ray, SURE_HITS_ONLY))
    }

    fn survivor(&self, found: &Found, pixel: UVec2) -> Option<StoredRay> {
        let surface = self.surface(&found.frame, pixel)?;
        let proposal = initial::Proposal::new(&surface, self.lights(), found.at(pixel));
        (!proposal.is_certain()).then(|| shadow(proposal.ray, SURE_HITS_ONLY))
    }

    fn shading(&self, found: &Found, pixel: UVec2) -> Option<StoredRay> {
        let surface = self.surface(&found.frame, pixel)?;
        let key = alpha::key(found.rng(pixel, Stream::Shade).next_u32x4().x);
        let proposal = shading::propose(&surface, self.lights(), found.at(pixel));
        (!proposal.is_dark()).then(|| shadow(proposal.ray, key))
    }

    fn captured(&self, found: &Found, ray: impl Fn(UVec2) -> Option<StoredRay> + Sync) -> Captured {
        let size = found.frame.size;
        let rows: Vec<u32> = (0..size.y).collect();
        let row =
            |&y: &u32| (0..size.x).map(|x| ray(UVec2::new(x, y)).unwrap_or_default()).collect::<Vec<_>>();
        Captured { pass: found.pass, rays: parallel::map(&rows, row).concat() }
    }

    fn surface(&self, frame: &FrameConstants, pixel: UVec2) -> Option<Surface> {
        let texel = self.gbuffer[frame.pixel_index(pixel) as usize];
        (!texel.is_empty()).then(|| texel.unpack(&frame.camera, pixel, frame.size))
    }

    fn lights(&self) -> LightTable<'_> {
        LightTable { lights: Lights::untextured(&self.lights.lights), alias: &self.lights.alias }
    }
}

fn shadow(ray: ShadowRay, key: u32) -> StoredRay {
    StoredRay::new(ray.origin, ray.direction, key)
}

fn primary(frame: &FrameConstants, pixel: UVec2) -> StoredRay {
    let direction = frame.camera.direction(pixel.as_vec2() + 0.5, frame.size);
    StoredRay::new(frame.camera.position, direction, alpha::primary_key(frame, pixel))
}
