//! `initial` of one pixel: candidates from the light table or a tile, and along the reflectance.

use super::{Rays, Replay, Replayed};
use crate::explain::record::{Candidate, Glance, PassReport, Tile};
use glam::UVec4;
use shared::light::LightSample;
use shared::light::tile::{self, TILE_SIZE, Tiles};
use shared::motion::NO_LIGHT;
use shared::resampling::initial::{self, Fresh, Techniques};
use shared::reservoir::StoredReservoir;
use shared::rng::{Rng, Stream};

/// Steps of a light's grid that rounding may be off by: lavapipe's sine and cosine differ in the last bits, H100's by 1e-4.
const NEAR: f32 = 16.0;

/// Are both on one light, at most [`NEAR`] steps of its grid apart?
fn are_near(a: LightSample, b: LightSample) -> bool {
    let [a_square, b_square] = [a, b].map(LightSample::square);
    a.light == b.light && (a_square - b_square).abs().max_element() * 65536.0 <= NEAR
}

impl Replay<'_> {
    /// `gpu`: what the pass ended with, all pixels. `tiles`: those of the frame, if it has any.
    pub fn initial(
        &self,
        pass: &'static str,
        lane: u32,
        tiles: Option<Tiles<'_>>,
        gpu: &[StoredReservoir],
    ) -> PassReport {
        let gpu = self.at(gpu, lane);
        self.report(gpu, |rays| {
            let mut rng = self.rng(Stream::Initial, lane);
            let (lights, techniques) = (self.lights(), self.techniques());
            let tile = tiles.map(|tiles| (tiles, tile::tile_of(&self.frame, self.pixel, lane)));
            let (mut lines, tile_report, mut walked) = match tile {
                Some((tiles, tile)) => self.tile_candidates(tiles, tile, rng),
                None => self.candidates(rng),
            };
            let mut fresh = match tile {
                Some((tiles, tile)) => {
                    initial::from_tile(&self.surface, lights, techniques, tiles, tile, &mut rng)
                }
                None => initial::from_table(&self.surface, lights, techniques, &mut rng),
            };
            for _ in 0..techniques.bsdf {
                let glance = initial::Glance::new(&self.surface, &mut rng);
                if glance.is_worth_tracing(&self.surface) {
                    let candidate = self.found(&glance, gpu, rays);
                    fresh.add_found(candidate);
                    let chosen = walked.add_found(candidate);
                    lines.push(self.line("bsdf", candidate, &walked, chosen));
                }
            }
            let proposal = fresh.finish(&self.surface, lights);
            let visible = self.is_seen(&proposal, self.frame.settings.visibility_reuse != 0, rays);
            let report = PassReport {
                pass,
                reservoir: lane,
                tile: tile_report,
                candidates: lines,
                glances: std::mem::take(&mut rays.glances),
                ..Default::default()
            };
            let finished = walked.finish(&self.surface, lights).reservoir;
            Replayed::new(report, initial::accept(proposal, visible), finished, visible)
        })
    }

    fn techniques(&self) -> Techniques {
        Techniques::new(&self.frame.settings, self.world.features())
    }

    fn candidates(&self, mut rng: Rng) -> (Vec<Candidate>, Option<Tile>, Fresh) {
        let mut fresh = Fresh::default();
        let techniques = self.techniques();
        let lines = (0..techniques.lights).map(|_| {
            let candidate = initial::candidate(&self.surface, self.lights(), techniques, &mut rng);
            let chosen = fresh.add(candidate);
            self.line("table", candidate, &fresh, chosen)
        });
        (lines.collect(), None, fresh)
    }

    fn tile_candidates(
        &self,
        tiles: Tiles<'_>,
        tile: u32,
        mut rng: Rng,
    ) -> (Vec<Candidate>, Option<Tile>, Fresh) {
        let (mut fresh, mut random, mut equal_entries) = (Fresh::default(), UVec4::ZERO, 0);
        let (mut lines, lights, techniques) = (Vec::new(), self.lights(), self.techniques());
        for i in 0..techniques.lights {
            random = initial::numbers_from_tile(i, random, &mut rng);
            let candidate =
                initial::candidate_from_tile(&self.surface, lights, techniques, tiles, tile, random);
            let place = candidate.sample.uv;
            let (entry, point) = tile::presample(lights, tile, place % TILE_SIZE, &self.frame);
            let same = entry.light() == candidate.sample.light && point == tiles.points[place as usize];
            equal_entries += u32::from(same);
            let chosen = fresh.add(candidate);
            lines.push(self.line("tile", candidate, &fresh, chosen));
        }
        (lines, Some(Tile { tile, equal_entries }), fresh.looked_up(tiles))
    }

    /// `fresh`: with the candidate.
    fn line(
        &self,
        by: &'static str,
        candidate: initial::Candidate,
        fresh: &Fresh,
        chosen: bool,
    ) -> Candidate {
        Candidate {
            by,
            light: candidate.sample.light,
            kind: self.world.kind(candidate.sample.light),
            source_pdf: candidate.source_pdf.0,
            target: candidate.target,
            weight: candidate.weight(),
            weight_sum: fresh.reservoir.weight_sum,
            chosen,
        }
    }

    /// What a ray along the reflectance finds. `gpu`: what the pass ended with; a flip takes its sample for what was found, as
    /// directions are rounded otherwise on the GPU.
    fn found(
        &self,
        glance: &initial::Glance,
        gpu: StoredReservoir,
        rays: &mut Rays<'_>,
    ) -> initial::Candidate {
        let (surface, lights) = (&self.surface, self.lights());
        let (light, hit) = self.world.light_along(&self.frame, glance.origin, glance.direction);
        let candidate = glance.candidate(surface, lights, self.techniques(), light);
        let found = candidate.sample;
        let flip = rays.next_flips() && gpu.contribution_weight > 0.0;
        rays.glances.push(Glance {
            origin: glance.origin.to_array(),
            direction: glance.direction.to_array(),
            hit,
            light: (light != NO_LIGHT).then_some(light),
            uv: found.uv,
            gpu_disagrees: flip && !are_near(found, gpu.sample),
        });
        if !flip {
            return candidate;
        }
        glance.candidate_at(surface, lights, self.techniques(), gpu.sample)
    }
}
