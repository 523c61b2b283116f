//! Merges the reservoirs of two pixels that chose each other (reciprocal neighbors, Lin et al. 2026).
//!
//! What two pixels want to know of each other is the same: how each sees the other's sample. Each evaluates and traces that
//! once, from its own surface ([`propose`], [`accept`]); then both know all four targets of their merge, visibility
//! included, for one ray each ([`merge`]).

use super::pairwise::{CrossTargets, Pairwise};
use super::{Pixels, is_similar_normal, reservoir_index, target_of};
use crate::frame::{FrameConstants, Settings};
use crate::light::LightTable;
use crate::reservoir::StoredReservoir;
use crate::rng::{Rng, Stream, unit_f32};
use crate::shadow::ShadowRay;
use crate::surface::{GBufferTexel, Surface};
use crate::target::target_function;
use bytemuck::{Pod, Zeroable};
use glam::{UVec2, UVec4};

/// Side of the cells whose pixels find partners in one other cell, pixels: neighboring threads read neighboring memory.
const CELL: u32 = 4;

/// What the surface of pixel i makes of its own sample and of that of its partner j. 12 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct PairTargets {
    /// p̂_i(y_i).
    pub own: f32,
    /// p̂_i(y_j); 0 where a ray found y_j hidden from pixel i.
    pub partner: f32,
    /// Place of the partner's reservoir; its own without a partner.
    pub index: u32,
}

/// The targets of a pixel before its ray has answered.
#[derive(Clone, Copy, Debug)]
pub struct Proposal {
    pub targets: PairTargets,
    /// From this pixel to its partner's sample.
    pub ray: ShadowRay,
    /// Both hold the same sample, and so both have seen it.
    pub same_sample: bool,
}

impl Proposal {
    /// No ray is worth tracing for nothing, or twice.
    pub fn is_certain(&self) -> bool {
        self.same_sample || self.targets.partner == 0.0
    }
}

/// Side of the squares in which pixels find partners, pixels: the power of two from the radius on.
fn square_of(settings: &Settings) -> u32 {
    (settings.radius as u32).clamp(CELL, 1024).next_power_of_two()
}

/// The partner of `pixel`, whose partner is `pixel`; none outside the image and on itself. `repetition`: of reservoir and
/// iteration; each pairs anew.
///
/// Squares lie over the image from a random place on. In each, a random number says in which bits the coordinates of
/// partners differ, cell by cell; two cells that are partners draw the lowest bits.
pub fn partner_of(frame: &FrameConstants, pixel: UVec2, repetition: u32) -> Option<UVec2> {
    let square = square_of(&frame.settings);
    let draw = |key: UVec2, level: u32| {
        let mut rng = Rng::new(key, frame.index, frame.seed, Stream::Pairs, 3 * repetition + level);
        let UVec4 { x, y, .. } = rng.next_u32x4() >> 16;
        UVec2::new(x, y)
    };
    let shift = draw(UVec2::ZERO, 0) & (square - 1);
    let place = pixel + shift;
    let far = draw(place / square, 1) & (square - CELL);
    let cell = (place / CELL).min((place ^ far) / CELL);
    let near = draw(cell, 2) & (CELL - 1);
    let other = place ^ far ^ near;
    let inside = other.cmpge(shift).all() && (other - shift).cmplt(frame.size).all();
    if inside && other != place { Some(other - shift) } else { None }
}

/// The partner of `pixel` if both are similar: the G-buffer alone decides, and decides the same for both.
pub fn similar_partner(
    frame: &FrameConstants,
    gbuffer: &[GBufferTexel],
    pixel: UVec2,
    repetition: u32,
) -> Option<UVec2> {
    let partner = partner_of(frame, pixel, repetition)?;
    let (a, b) = (gbuffer[frame.pixel_index(pixel) as usize], gbuffer[frame.pixel_index(partner) as usize]);
    if are_similar(&frame.settings, &a, &b) { Some(partner) } else { None }
}

/// Of distances the smaller one is the measure.
fn are_similar(settings: &Settings, a: &GBufferTexel, b: &GBufferTexel) -> bool {
    let (near, far) = (a.distance().min(b.distance()), a.distance().max(b.distance()));
    near > 0.0 && far - near <= settings.depth_threshold * near && is_similar_normal(settings, a.normal(), b)
}

/// What `pixel`, which sees `surface`, makes of its own sample and its partner's. `repetition` as in [`partner_of`].
pub fn propose(
    frame: &FrameConstants,
    lights: LightTable<'_>,
    surface: &Surface,
    pixels: Pixels<'_>,
    pixel: UVec2,
    lane: u32,
    repetition: u32,
) -> Proposal {
    let index = reservoir_index(frame, pixel, lane);
    let Some(place) = similar_partner(frame, pixels.gbuffer, pixel, repetition) else {
        let targets = PairTargets { index, ..PairTargets::default() };
        return Proposal { targets, ray: ShadowRay::default(), same_sample: false };
    };
    let own = pixels.reservoirs[index as usize];
    let index = reservoir_index(frame, place, lane);
    let other = pixels.reservoirs[index as usize];
    let incident = lights.incident(other.sample, surface.position);
    let holds_one = other.contribution_weight > 0.0;
    let partner = if holds_one { target_function(surface, &incident) } else { 0.0 };
    Proposal {
        targets: PairTargets { own: target_of(surface, lights, own), partner, index },
        ray: ShadowRay::new(surface, &incident),
        same_sample: own.shares_sample_with(other),
    }
}

/// The targets once the ray has answered.
pub fn accept(proposal: Proposal, visible: bool) -> PairTargets {
    let PairTargets { partner, .. } = proposal.targets;
    PairTargets { partner: if visible { partner } else { 0.0 }, ..proposal.targets }
}

/// All targets of the merge of a pixel that sees `here` with the partner that sees `there`.
pub fn cross(here: PairTargets, there: PairTargets) -> CrossTargets {
    CrossTargets {
        neighbor_at_canonical: here.partner,
        neighbor_at_neighbor: there.own,
        canonical_at_neighbor: there.partner,
    }
}

/// A merge of a pixel's reservoir with its partner's, before that is added.
pub fn begin(
    settings: &Settings,
    own: StoredReservoir,
    other: StoredReservoir,
    here: PairTargets,
) -> Pairwise {
    Pairwise::new(own, here.own, other.confidence, settings.neighbor_trust())
}

/// The reservoir `own` of a pixel merged with that of its partner by pairwise MIS. The survivor has been seen.
pub fn merge(
    settings: &Settings,
    [own, other]: [StoredReservoir; 2],
    [here, there]: [PairTargets; 2],
    rng: &mut Rng,
) -> StoredReservoir {
    let random = rng.next_u32x4();
    let mut merge = begin(settings, own, other, here);
    merge.add(other, cross(here, there), unit_f32(random.x));
    merge.finish(unit_f32(random.y))
}

#[cfg(test)]
mod tests;
