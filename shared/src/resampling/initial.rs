//! Fills a pixel's reservoir with fresh light candidates: streaming RIS (Bitterli et al. 2020, Alg. 3).

use crate::light::tile::{TILE_SIZE, Tiles};
use crate::light::{LightSample, LightTable};
use crate::math::safe_ratio;
use crate::pdf::SourcePdf;
use crate::reservoir::{Reservoir, StoredReservoir};
use crate::rng::{Rng, unit_f32};
use crate::shadow::ShadowRay;
use crate::surface::Surface;
use crate::target::target_function;
use glam::UVec4;

/// A finished reservoir, and the ray of visibility reuse that may still empty it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Proposal {
    pub reservoir: StoredReservoir,
    pub ray: ShadowRay,
    /// An earlier ray has shown the sample to be visible.
    pub seen: bool,
}

impl Proposal {
    /// `reservoir`, filled at `surface`.
    pub fn new(surface: &Surface, lights: LightTable<'_>, reservoir: StoredReservoir) -> Self {
        let ray = ShadowRay::new(surface, &lights.incident(reservoir.sample, surface.position));
        Proposal { reservoir, ray, seen: false }
    }

    /// A merge at `surface`, which sees the sample of `canonical`.
    pub fn merged(
        surface: &Surface,
        lights: LightTable<'_>,
        canonical: StoredReservoir,
        reservoir: StoredReservoir,
    ) -> Self {
        let seen = canonical.shares_sample_with(reservoir);
        Proposal { seen, ..Proposal::new(surface, lights, reservoir) }
    }

    /// No ray is worth tracing for nothing, or twice.
    pub fn is_certain(&self) -> bool {
        self.seen || self.reservoir.contribution_weight == 0.0
    }
}

/// A light sample that competes for a reservoir.
#[derive(Clone, Copy, Debug)]
pub struct Candidate {
    /// From a tile, `uv` is the place of its entry in all tiles: the point is looked up for the survivor only.
    pub sample: LightSample,
    pub source_pdf: SourcePdf,
    /// p̂ as far as it decides over survival.
    pub target: f32,
    /// Decides over its survival, in [0, 1).
    pub u: f32,
}

impl Candidate {
    /// w = p̂/p.
    pub fn weight(&self) -> f32 {
        safe_ratio(self.target, self.source_pdf.0)
    }

    /// Does `reservoir` keep it, for now?
    pub fn compete(&self, reservoir: &mut Reservoir) -> bool {
        reservoir.add(self.sample, self.target, self.weight(), 1.0, self.u)
    }
}

/// The next candidate from the light table.
pub fn candidate(surface: &Surface, lights: LightTable<'_>, rng: &mut Rng) -> Candidate {
    let random = rng.next_u32x4();
    let (sample, source_pdf) = lights.sample([random.x, random.y, random.z]);
    let target = target_function(surface, &lights.incident(sample, surface.position));
    Candidate { sample, source_pdf, target, u: unit_f32(random.w) }
}

/// Resamples `candidates` draws from the light table: w = p̂/p, survivor ~ p̂ as candidates grow.
pub fn propose(surface: &Surface, lights: LightTable<'_>, candidates: u32, rng: &mut Rng) -> Proposal {
    let mut reservoir = Reservoir::default();
    for _ in 0..candidates {
        candidate(surface, lights, rng).compete(&mut reservoir);
    }
    Proposal::new(surface, lights, lights.canonical(reservoir.finish(reservoir.confidence)))
}

/// Random numbers of candidate `i` of a tile in x and y; `last` are those of the candidate before. Four serve two.
pub fn numbers_from_tile(i: u32, last: UVec4, rng: &mut Rng) -> UVec4 {
    if i & 1 == 0 { rng.next_u32x4() } else { UVec4::new(last.z, last.w, 0, 0) }
}

/// The candidate from tile `tile` that `random` draws.
pub fn candidate_from_tile(
    surface: &Surface,
    lights: LightTable<'_>,
    tiles: Tiles<'_>,
    tile: u32,
    random: UVec4,
) -> Candidate {
    let place = tile * TILE_SIZE + (random.x & (TILE_SIZE - 1));
    let entry = tiles.entries[place as usize];
    let target = target_function(surface, &entry.incident(lights, surface.position));
    let sample = LightSample { light: entry.light(), uv: place };
    Candidate { sample, source_pdf: entry.source_pdf(), target, u: unit_f32(random.y) }
}

/// As [`propose`], from the entries of one tile of [`crate::light::tile`].
pub fn propose_from_tile(
    surface: &Surface,
    lights: LightTable<'_>,
    tiles: Tiles<'_>,
    tile: u32,
    candidates: u32,
    rng: &mut Rng,
) -> Proposal {
    let mut reservoir = Reservoir::default();
    let mut random = UVec4::ZERO;
    for i in 0..candidates {
        random = numbers_from_tile(i, random, rng);
        candidate_from_tile(surface, lights, tiles, tile, random).compete(&mut reservoir);
    }
    let mut finished = reservoir.finish(reservoir.confidence);
    if finished.contribution_weight > 0.0 {
        finished.sample.uv = tiles.points[finished.sample.uv as usize];
    }
    Proposal::new(surface, lights, lights.canonical(finished))
}

/// Visibility reuse (Bitterli et al. 2020, Alg. 5, line 6).
pub fn accept(proposal: Proposal, visible: bool) -> StoredReservoir {
    if visible { proposal.reservoir } else { proposal.reservoir.occluded() }
}
