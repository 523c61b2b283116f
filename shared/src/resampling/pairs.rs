//! Merges the reservoirs of two neighboring pixels that chose each other (reciprocal neighbors: Lin et al. 2026).
//!
//! Each pixel evaluates and traces what both need of it, p̂ V of its partner's sample at its own surface; then both know all
//! four targets, visibility included, for one ray each.

use super::{Pixels, reservoir_index, target_of};
use crate::frame::{FrameConstants, Settings};
use crate::light::LightTable;
use crate::math::safe_ratio;
use crate::reservoir::{Reservoir, StoredReservoir};
use crate::rng::{Rng, Stream};
use crate::shadow::ShadowRay;
use crate::surface::{GBufferTexel, Surface};
use bytemuck::{Pod, Zeroable};
use glam::{UVec2, UVec4};

/// Pixels on a side of the cells that stay together, so that neighboring threads read neighboring memory.
const CELL: u32 = 4;

/// What a pixel's surface makes of its own sample and of its partner's. 8 bytes; it lies in the place of a reservoir.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct PairTargets {
    /// p̂_i(y_i).
    pub own: f32,
    /// p̂_i(y_j), 0 where y_j is hidden from here; negative: there is no partner.
    pub partner: f32,
    /// Place of its reservoir; [`NOBODY`].
    pub index: u32,
}

pub const NOBODY: u32 = u32::MAX;

impl PairTargets {
    pub const ALONE: PairTargets = PairTargets { own: 0.0, partner: 0.0, index: NOBODY };
}

/// Side of the squares within which pixels find partners, pixels.
fn square_of(settings: &Settings) -> u32 {
    (settings.radius as u32).clamp(CELL, 1024).next_power_of_two()
}

fn numbers(frame: &FrameConstants, place: UVec2, repetition: u32) -> UVec4 {
    Rng::new(place, frame.index, frame.seed, Stream::Pairs, repetition).next_u32x4() >> 16
}

/// The partner of `pixel`, whose partner is `pixel`; none outside the image and on itself. `repetition`: of the reservoir and
/// iteration; each pairs anew.
///
/// The image is cut into squares at a random place. In a square, partners' coordinates differ in bits drawn at random: all
/// of a cell's lead to one other cell, and the two cells draw the lowest bits.
pub fn partner_of(frame: &FrameConstants, pixel: UVec2, repetition: u32) -> Option<UVec2> {
    let square = square_of(&frame.settings);
    let random = numbers(frame, UVec2::MAX, 4 * repetition);
    let shift = UVec2::new(random.x, random.y) & (square - 1);
    let place = pixel + shift;
    let random = numbers(frame, place / square, 4 * repetition + 1);
    let far = UVec2::new(random.x, random.y) & (square - CELL);
    let cell = (place / CELL).min((place ^ far) / CELL);
    let random = numbers(frame, cell, 4 * repetition + 2);
    let near = UVec2::new(random.x, random.y) & (CELL - 1);
    let other = place ^ far ^ near;
    let inside = other.cmpge(shift).all() && (other - shift).cmplt(frame.size).all();
    if inside && other != place { Some(other - shift) } else { None }
}

/// Are both alike? The G-buffer alone decides, and both sides come to the same answer.
fn are_similar(settings: &Settings, a: &GBufferTexel, b: &GBufferTexel) -> bool {
    let nearer = a.distance().min(b.distance());
    // `is_similar` takes its fraction of the distance that it is given.
    let apart = (a.distance() - b.distance()).abs();
    !a.is_empty() && !b.is_empty() && apart <= settings.depth_threshold * nearer
        && a.normal().dot(b.normal()) >= settings.normal_threshold
}

/// The partner of `pixel` if it is similar.
pub fn similar_partner(
    frame: &FrameConstants,
    gbuffer: &[GBufferTexel],
    pixel: UVec2,
    repetition: u32,
) -> Option<UVec2> {
    let first = partner_if_similar(frame, gbuffer, pixel, repetition);
    if first.is_some() || frame.settings.experiment & 4 == 0 {
        return first;
    }
    let second = partner_if_similar(frame, gbuffer, pixel, repetition + 1024)?;
    if partner_if_similar(frame, gbuffer, second, repetition).is_some() { None } else { Some(second) }
}

fn partner_if_similar(
    frame: &FrameConstants,
    gbuffer: &[GBufferTexel],
    pixel: UVec2,
    repetition: u32,
) -> Option<UVec2> {
    let partner = partner_of(frame, pixel, repetition)?;
    let (a, b) = (gbuffer[frame.pixel_index(pixel) as usize], gbuffer[frame.pixel_index(partner) as usize]);
    if are_similar(&frame.settings, &a, &b) { Some(partner) } else { None }
}

/// Targets before the ray has answered.
#[derive(Clone, Copy, Debug)]
pub struct Proposal {
    pub targets: PairTargets,
    /// From this pixel to its partner's sample.
    pub ray: ShadowRay,
    /// 1: both hold the same sample, so both have seen it. (rust-gpu takes no bool in an Option.)
    pub same_sample: u32,
}

impl Proposal {
    /// No ray is worth tracing for nothing, or twice.
    pub fn is_certain(&self) -> bool {
        self.same_sample != 0 || self.targets.partner <= 0.0
    }
}

/// What `pixel`, which sees `surface`, makes of its own sample and its partner's.
pub fn propose(
    frame: &FrameConstants,
    lights: LightTable<'_>,
    surface: &Surface,
    pixels: Pixels<'_>,
    pixel: UVec2,
    lane: u32,
    repetition: u32,
) -> Proposal {
    let Some(partner) = similar_partner(frame, pixels.gbuffer, pixel, repetition) else {
        return Proposal { targets: PairTargets::ALONE, ray: ShadowRay::default(), same_sample: 0 };
    };
    let own = pixels.reservoirs[reservoir_index(frame, pixel, lane) as usize];
    let other = pixels.reservoirs[reservoir_index(frame, partner, lane) as usize];
    let incident = lights.incident(other.sample, surface.position);
    let at_partner = if other.contribution_weight > 0.0 {
        crate::target::target_function(surface, &incident)
    } else {
        0.0
    };
    let targets = PairTargets { own: target_of(surface, lights, own), partner: at_partner, index: reservoir_index(frame, partner, lane) };
    let same_sample = own.shares_sample_with(other).into();
    Proposal { targets, ray: ShadowRay::new(surface, &incident), same_sample }
}

/// Ends once the ray has answered.
pub fn accept(proposal: Proposal, visible: bool) -> PairTargets {
    let partner = if visible { proposal.targets.partner } else { 0.0 };
    PairTargets { partner, ..proposal.targets }
}

/// The reservoir of `pixel` merged with its partner's by the balance heuristic, c_i p̂_i / (c_i p̂_i + c_j p̂_j).
pub fn merge(
    frame: &FrameConstants,
    reservoirs: &[StoredReservoir],
    targets: &[PairTargets],
    pixel: UVec2,
    lane: u32,
    rng: &mut Rng,
) -> StoredReservoir {
    let index = reservoir_index(frame, pixel, lane) as usize;
    let (own, here) = (reservoirs[index], targets[index]);
    if here.index == NOBODY {
        return own;
    }
    let (other, there) = (reservoirs[here.index as usize], targets[here.index as usize]);
    let (c0, c1) = (own.confidence, other.confidence);
    let balance = |a: f32, b: f32| safe_ratio(a, a + b);
    let mut own_mis = balance(c0 * here.own, c1 * there.partner);
    let mut other_mis = balance(c1 * there.own, c0 * here.partner);
    if frame.settings.experiment & 1 != 0 {
        let share = safe_ratio(c1, c0 + c1) * if frame.settings.experiment & 2 != 0 { 0.5 } else { 1.0 };
        own_mis = (1.0 - share) + share * own_mis;
        other_mis *= share;
    }
    let random = rng.next_u32x4();
    let mut merged = Reservoir::default();
    merged.add(own.sample, here.own, own_mis * here.own * own.contribution_weight, c0, crate::rng::unit_f32(random.x));
    let weight = other_mis * here.partner * other.contribution_weight;
    merged.add(other.sample, here.partner, weight, c1, crate::rng::unit_f32(random.y));
    merged.finish(1.0)
}
