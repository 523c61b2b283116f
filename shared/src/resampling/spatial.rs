//! Merges the reservoirs of neighboring pixels.

use super::pairwise::Pairwise;
use super::{CrossProposal, Pixels, initial, is_similar, reservoir_index, target_of};
use crate::frame::FrameConstants;
use crate::light::LightTable;
use crate::reservoir::{Reservoir, StoredReservoir};
use crate::rng::{Rng, unit_f32};
use crate::sampling::square_to_disk;
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

/// The next similar neighbor of `pixel`, if this draw finds one; the G-buffer alone decides.
fn next_neighbor(
    frame: &FrameConstants,
    surface: &Surface,
    pixels: Pixels<'_>,
    pixel: UVec2,
    rng: &mut Rng,
) -> (Option<UVec2>, f32) {
    let random = rng.next_u32x4();
    let at = Vec2::new(unit_f32(random.x), unit_f32(random.y));
    let place = neighbor_of(pixel, frame.size, frame.settings.radius, at).filter(|&place| {
        let texel = pixels.gbuffer[frame.pixel_index(place) as usize];
        is_similar(&frame.settings, surface.distance, surface.normal, &texel)
    });
    (place, unit_f32(random.z))
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
        let (place, u) = next_neighbor(frame, surface, pixels, pixel, rng);
        if let Some(place) = place {
            let neighbor = pixels.reservoirs[reservoir_index(frame, place, lane) as usize];
            merged.merge(neighbor, target_of(surface, lights, neighbor), u);
        }
    }
    merged.finish(merged.confidence)
}

/// Unbiased spatial reuse begins. The numbers in `rng` choose the neighbors here, to sum their confidences, and again in
/// [`propose`], so `rng` is taken by value.
pub fn begin(
    frame: &FrameConstants,
    lights: LightTable<'_>,
    surface: &Surface,
    pixels: Pixels<'_>,
    pixel: UVec2,
    lane: u32,
    mut rng: Rng,
) -> Pairwise {
    let canonical = pixels.reservoirs[reservoir_index(frame, pixel, lane) as usize];
    let mut others = 0.0;
    for _ in 0..frame.settings.neighbors {
        if let (Some(place), _) = next_neighbor(frame, surface, pixels, pixel, &mut rng) {
            others += pixels.reservoirs[reservoir_index(frame, place, lane) as usize].confidence;
        }
    }
    Pairwise::new(canonical, target_of(surface, lights, canonical), others)
}

/// The next neighbor, with the ray that asks whether it sees the canonical sample; and the number that [`Pairwise::add`]
/// decides with.
pub fn propose(
    frame: &FrameConstants,
    lights: LightTable<'_>,
    surface: &Surface,
    pixels: Pixels<'_>,
    pixel: UVec2,
    lane: u32,
    rng: &mut Rng,
) -> (Option<CrossProposal>, f32) {
    let (place, u) = next_neighbor(frame, surface, pixels, pixel, rng);
    let Some(place) = place else { return (None, u) };
    let canonical = pixels.reservoirs[reservoir_index(frame, pixel, lane) as usize];
    let neighbor = pixels.reservoirs[reservoir_index(frame, place, lane) as usize];
    let there = pixels.gbuffer[frame.pixel_index(place) as usize].unpack(&frame.camera, place, frame.size);
    (Some(CrossProposal::new(lights, surface, canonical, &there, neighbor)), u)
}

/// Takes the neighbor in once its ray has answered.
pub fn accept(merge: &mut Pairwise, proposal: CrossProposal, visible: bool, u: f32) {
    merge.add(proposal.neighbor, proposal.seen(visible), u);
}

/// The survivor; its own visibility is still to be asked.
pub fn finish(
    surface: &Surface,
    lights: LightTable<'_>,
    merge: Pairwise,
    rng: &mut Rng,
) -> initial::Proposal {
    initial::Proposal::new(surface, lights, merge.finish(rng.next_f32()))
}
