//! Merges the reservoirs of neighboring pixels.

use super::confidence::of_neighbor;
use super::pairwise::{Pairwise, Weighed};
use super::{CrossProposal, Pixels, is_similar, reservoir_index};
use crate::frame::{FrameConstants, Settings};
use crate::passes::{Silent, Witness};
use crate::reservoir::StoredReservoir;
use crate::rng::{Rng, unit_f32};
use crate::sampling::square_to_disk;
use crate::shadow::ShadowRay;
use crate::surface::{GBufferTexel, Surface};
use glam::{IVec2, UVec2, Vec2};

/// A neighbor of `pixel`, uniform over the disk of `radius` pixels; none outside the image or on `pixel` itself.
fn neighbor_of(pixel: UVec2, size: UVec2, radius: f32, random: Vec2) -> Option<UVec2> {
    let offset = square_to_disk(random) * radius;
    // Truncation after a shift by half a pixel: rounding that both sides agree on.
    let place = (pixel.as_vec2() + 0.5 + offset).floor().as_ivec2();
    let inside = place.cmpge(IVec2::ZERO).all() && place.cmplt(size.as_ivec2()).all();
    if inside && place != pixel.as_ivec2() { Some(place.as_uvec2()) } else { None }
}

/// The next neighbor of `pixel`, whatever it sees, if this draw lies in the image; and two numbers in [0, 1) to merge it with.
fn draw_neighbor(frame: &FrameConstants, pixel: UVec2, rng: &mut Rng) -> (Option<UVec2>, [f32; 2]) {
    let random = rng.next_u32x4();
    let at = Vec2::new(unit_f32(random.x), unit_f32(random.y));
    let place = neighbor_of(pixel, frame.size, frame.settings.radius, at);
    (place, [unit_f32(random.z), unit_f32(random.w)])
}

/// The next neighbor if it is similar: the G-buffer alone decides; and two numbers in [0, 1) to merge it with.
pub fn next_neighbor(
    frame: &FrameConstants,
    surface: &Surface,
    gbuffer: &[GBufferTexel],
    pixel: UVec2,
    rng: &mut Rng,
    note: &mut impl Witness,
) -> (Option<UVec2>, [f32; 2]) {
    let (place, numbers) = draw_neighbor(frame, pixel, rng);
    let similar = place.filter(|&place| {
        let texel = gbuffer[frame.pixel_index(place) as usize];
        is_similar(&frame.settings, surface.distance, surface.normal, &texel)
    });
    note.place(place, similar.is_some());
    (similar, numbers)
}

/// Neighbors merged, but for one question: does the neighbor that `ray` leaves from see the canonical sample?
///
/// Which neighbors see the canonical sample matters to its weight alone, m_0 = known + Σ_i pending_i (1 - V_i). One ray estimates the
/// sum: a neighbor drawn in proportion to its pending weight answers for all. That keeps the mean, as the merged estimate is linear in
/// m_0, and m_0 stays within [0, 1].
#[derive(Clone, Copy, Debug)]
pub struct OneRayMerge {
    merge: Pairwise,
    /// Σ of what the canonical weight gains by each neighbor that does not see its sample.
    pub pending: f32,
    /// From the neighbor that answers for all.
    pub ray: ShadowRay,
}

impl OneRayMerge {
    /// Of one reservoir with `target` p̂_0(y_0), before its neighbors are added. `others`: their confidences.
    pub fn new(settings: &Settings, canonical: StoredReservoir, target: f32, others: f32) -> Self {
        let merge = Pairwise::new(canonical, target, others, settings.neighbor_trust());
        OneRayMerge { merge, pending: 0.0, ray: ShadowRay::default() }
    }

    /// Adds a neighbor. `u` in [0, 1) decides over its survival, `v` in [0, 1) whether it answers for all so far.
    pub fn add(&mut self, cross: CrossProposal, u: f32, v: f32) -> Added {
        let weighed = self.merge.add(cross.neighbor, cross.targets, u);
        // Who holds the same sample has seen it.
        let agrees = cross.neighbor.shares_sample_with(self.merge.canonical());
        let canonical_at_neighbor = if agrees { 0.0 } else { cross.targets.canonical_at_neighbor };
        let pending = self.merge.pending(cross.neighbor.confidence, canonical_at_neighbor);
        self.pending += pending;
        let asked = v * self.pending < pending;
        if asked {
            self.ray = cross.ray;
        }
        Added { weighed, pending, asked }
    }

    /// The merge once the ray has answered.
    pub fn resolved(&self, visible: bool) -> Pairwise {
        let mut merge = self.merge;
        if !visible {
            merge.resolve(self.pending);
        }
        merge
    }

    /// No ray is worth tracing for nothing.
    pub fn is_certain(&self) -> bool {
        self.pending == 0.0
    }
}

/// What became of a neighbor.
#[derive(Clone, Copy, Debug)]
pub struct Added {
    /// How it was weighed.
    pub weighed: Weighed,
    /// What the canonical weight gains if this neighbor does not see the canonical sample.
    pub pending: f32,
    /// It answers for all, for now.
    pub asked: bool,
}

/// S of [`Pairwise`]. The numbers in `rng` choose the neighbors here, and again where they are merged.
pub fn confidence_of_neighbors(
    frame: &FrameConstants,
    surface: &Surface,
    pixels: Pixels<'_>,
    pixel: UVec2,
    lane: u32,
    mut rng: Rng,
) -> f32 {
    let mut sum = 0.0;
    for _ in 0..frame.settings.neighbors {
        if let (Some(place), _) = next_neighbor(frame, surface, pixels.gbuffer, pixel, &mut rng, &mut Silent)
        {
            let neighbor = pixels.reservoirs[reservoir_index(frame, place, lane) as usize];
            sum += of_neighbor(&frame.settings, neighbor).confidence;
        }
    }
    sum
}
