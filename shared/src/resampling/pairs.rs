//! Which two pixels choose each other (reciprocal neighbors, Lin et al. 2026).
//!
//! What two pixels want to know of each other is the same: how each sees the other's sample. Each evaluates and traces that
//! once, from its own surface ([`crate::passes::pair_targets`]); then both know all four targets of their merge, visibility
//! included, for one ray each ([`crate::passes::pair_merge`]).

use super::is_similar_normal;
use crate::frame::{FrameConstants, Settings};
use crate::rng::{Rng, Stream};
use crate::surface::GBufferTexel;
use glam::{UVec2, UVec4};

/// Side of the cells whose pixels find partners in one other cell, pixels: neighboring threads read neighboring memory.
const CELL: u32 = 4;

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

#[cfg(test)]
mod tests;
