//! Merges the reservoirs of neighboring pixels.

use super::temporal::target_of;
use super::{Pixels, is_similar, reservoir_index};
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
    let settings = &frame.settings;
    let canonical = pixels.reservoirs[reservoir_index(frame, pixel, lane) as usize];
    let mut merged = Reservoir::default();
    merged.merge(canonical, target_of(surface, lights, canonical), rng.next_f32());
    for _ in 0..settings.neighbors {
        let random = rng.next_u32x4();
        let at = Vec2::new(unit_f32(random.x), unit_f32(random.y));
        if let Some(place) = neighbor_of(pixel, frame.size, settings.radius, at) {
            let texel = pixels.gbuffer[frame.pixel_index(place) as usize];
            if is_similar(settings, surface.distance, surface.normal, &texel) {
                let neighbor = pixels.reservoirs[reservoir_index(frame, place, lane) as usize];
                merged.merge(neighbor, target_of(surface, lights, neighbor), unit_f32(random.z));
            }
        }
    }
    merged.finish(merged.confidence)
}
