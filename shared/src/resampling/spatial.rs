//! Merges the reservoirs of neighboring pixels.

use super::pairwise::Pairwise;
use super::{CrossProposal, Pixels, initial, is_similar, reservoir_index, target_of};
use crate::frame::FrameConstants;
use crate::light::LightTable;
use crate::reservoir::{Reservoir, StoredReservoir};
use crate::rng::{Rng, unit_f32};
use crate::sampling::square_to_disk;
use crate::shadow::ShadowRay;
use crate::surface::Surface;
use glam::{IVec2, UVec2, Vec2};

/// A neighbor of `pixel`, uniform over the disk of `radius` pixels; none outside the image or on `pixel` itself.
fn neighbor_of(pixel: UVec2, size: UVec2, radius: f32, random: Vec2) -> Option<UVec2> {
    let offset = square_to_disk(random) * radius;
    // Truncation after a shift by half a pixel: rounding that both sides agree on.
    let place = (pixel.as_vec2() + 0.5 + offset).floor().as_ivec2();
    let inside = place.cmpge(IVec2::ZERO).all() && place.cmplt(size.as_ivec2()).all();
    if inside && place != pixel.as_ivec2() { Some(place.as_uvec2()) } else { None }
}

/// The next similar neighbor of `pixel`, if this draw finds one; the G-buffer alone decides. And two numbers in [0, 1) to
/// merge it with.
fn next_neighbor(
    frame: &FrameConstants,
    surface: &Surface,
    pixels: Pixels<'_>,
    pixel: UVec2,
    rng: &mut Rng,
) -> (Option<UVec2>, [f32; 2]) {
    let random = rng.next_u32x4();
    let at = Vec2::new(unit_f32(random.x), unit_f32(random.y));
    let place = neighbor_of(pixel, frame.size, frame.settings.radius, at).filter(|&place| {
        let texel = pixels.gbuffer[frame.pixel_index(place) as usize];
        is_similar(&frame.settings, surface.distance, surface.normal, &texel)
    });
    (place, [unit_f32(random.z), unit_f32(random.w)])
}

/// Biased spatial reuse, 1/M (Bitterli et al. 2020, Alg. 4): the reservoir of `pixel` merged with those of
/// `neighbors` similar surfaces.
pub fn biased(
    frame: &FrameConstants,
    lights: LightTable<'_>,
    surface: &Surface,
    pixels: Pixels<'_>,
    pixel: UVec2,
    lane: u32,
    rng: &mut Rng,
) -> StoredReservoir {
    let canonical = pixels.reservoirs[reservoir_index(frame, pixel, lane) as usize];
    let mut merged = Reservoir::default();
    merged.merge(canonical, target_of(surface, lights, canonical), rng.next_f32());
    for _ in 0..frame.settings.neighbors {
        let (place, [u, _]) = next_neighbor(frame, surface, pixels, pixel, rng);
        if let Some(place) = place {
            let neighbor = pixels.reservoirs[reservoir_index(frame, place, lane) as usize];
            merged.merge(neighbor, target_of(surface, lights, neighbor), u);
        }
    }
    merged.finish(merged.confidence)
}

/// Neighbors merged, but for one question: does the neighbor that `ray` leaves from see the canonical sample?
#[derive(Clone, Copy, Debug)]
pub struct Proposal {
    merge: Pairwise,
    /// Σ of what the canonical weight gains by each neighbor that does not see its sample.
    doubt: f32,
    pub ray: ShadowRay,
}

impl Proposal {
    /// No ray is worth tracing for nothing.
    pub fn is_certain(&self) -> bool {
        self.doubt == 0.0
    }
}

/// Unbiased spatial reuse begins: the reservoir of `pixel` merged with those of `neighbors` similar surfaces by pairwise
/// MIS. Which neighbors see the canonical sample matters to its weight alone, m_0 = known + Σ_i doubt_i (1 - V_i). One
/// ray estimates the sum: a neighbor drawn in proportion to its doubt answers for all. That keeps the mean, as the merged
/// estimate is linear in m_0, and m_0 stays within [0, 1].
pub fn propose(
    frame: &FrameConstants,
    lights: LightTable<'_>,
    surface: &Surface,
    pixels: Pixels<'_>,
    pixel: UVec2,
    lane: u32,
    rng: &mut Rng,
) -> Proposal {
    let canonical = pixels.reservoirs[reservoir_index(frame, pixel, lane) as usize];
    let others = confidence_of_neighbors(frame, surface, pixels, pixel, lane, *rng);
    let mut merge = Pairwise::new(canonical, target_of(surface, lights, canonical), others);
    let (mut doubt, mut ray) = (0.0, ShadowRay::default());
    for _ in 0..frame.settings.neighbors {
        let (place, [u, lot]) = next_neighbor(frame, surface, pixels, pixel, rng);
        if let Some(place) = place {
            let neighbor = pixels.reservoirs[reservoir_index(frame, place, lane) as usize];
            let texel = pixels.gbuffer[frame.pixel_index(place) as usize];
            let there = texel.unpack(&frame.camera, place, frame.size);
            let cross = CrossProposal::new(lights, surface, canonical, &there, neighbor);
            merge.add(neighbor, cross.targets, u);
            let doubted = merge.doubt(neighbor.confidence, cross.targets.canonical_at_neighbor);
            doubt += doubted;
            if lot * doubt < doubted {
                ray = cross.ray;
            }
        }
    }
    Proposal { merge, doubt, ray }
}

/// Ends once the ray has answered. The survivor's own visibility is still to be asked.
pub fn accept(
    surface: &Surface,
    lights: LightTable<'_>,
    proposal: Proposal,
    visible: bool,
    rng: &mut Rng,
) -> initial::Proposal {
    let mut merge = proposal.merge;
    if !visible {
        merge.resolve(proposal.doubt);
    }
    initial::Proposal::new(surface, lights, merge.finish(rng.next_f32()))
}

/// S of [`Pairwise`]. The numbers in `rng` choose the neighbors here, and again where they are merged.
fn confidence_of_neighbors(
    frame: &FrameConstants,
    surface: &Surface,
    pixels: Pixels<'_>,
    pixel: UVec2,
    lane: u32,
    mut rng: Rng,
) -> f32 {
    let mut sum = 0.0;
    for _ in 0..frame.settings.neighbors {
        if let (Some(place), _) = next_neighbor(frame, surface, pixels, pixel, &mut rng) {
            sum += pixels.reservoirs[reservoir_index(frame, place, lane) as usize].confidence;
        }
    }
    sum
}
