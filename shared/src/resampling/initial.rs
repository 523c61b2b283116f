//! Fills a pixel's reservoir with fresh light candidates: streaming RIS (Bitterli et al. 2020, Alg. 3).

use crate::light::tile::{TILE_SIZE, Tiles};
use crate::light::{LightSample, LightTable};
use crate::math::safe_ratio;
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
}

impl Proposal {
    /// `reservoir`, filled at `surface`.
    pub fn new(surface: &Surface, lights: LightTable<'_>, reservoir: StoredReservoir) -> Self {
        let ray = ShadowRay::new(surface, &lights.incident(reservoir.sample, surface.position));
        Proposal { reservoir, ray }
    }

    /// No ray is worth tracing for nothing.
    pub fn is_dark(&self) -> bool {
        self.reservoir.contribution_weight == 0.0
    }
}

/// Resamples `candidates` draws from the light table: w = p̂/p, survivor ~ p̂ as candidates grow.
pub fn propose(surface: &Surface, lights: LightTable<'_>, candidates: u32, rng: &mut Rng) -> Proposal {
    let mut reservoir = Reservoir::default();
    for _ in 0..candidates {
        let random = rng.next_u32x4();
        let (sample, source_pdf) = lights.sample([random.x, random.y, random.z]);
        let target = target_function(surface, &lights.incident(sample, surface.position));
        reservoir.add(sample, target, safe_ratio(target, source_pdf.0), 1.0, unit_f32(random.w));
    }
    Proposal::new(surface, lights, reservoir.finish(reservoir.confidence))
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
    let first = tile * TILE_SIZE;
    let mut reservoir = Reservoir::default();
    let mut random = UVec4::ZERO;
    for i in 0..candidates {
        // Four numbers serve two candidates.
        random = if i & 1 == 0 { rng.next_u32x4() } else { UVec4::new(random.z, random.w, 0, 0) };
        let place = first + (random.x & (TILE_SIZE - 1));
        let entry = tiles.entries[place as usize];
        let target = target_function(surface, &entry.incident(lights, surface.position));
        let sample = LightSample { light: entry.light(), uv: place };
        reservoir.add(sample, target, safe_ratio(target, entry.source_pdf().0), 1.0, unit_f32(random.y));
    }
    let mut finished = reservoir.finish(reservoir.confidence);
    if finished.contribution_weight > 0.0 {
        finished.sample.uv = tiles.points[finished.sample.uv as usize];
    }
    Proposal::new(surface, lights, finished)
}

/// Visibility reuse (Bitterli et al. 2020, Alg. 5, line 6).
pub fn accept(proposal: Proposal, visible: bool) -> StoredReservoir {
    if visible { proposal.reservoir } else { proposal.reservoir.occluded() }
}
