//! Merges the reservoir that the same surface point had in the previous frame.

use super::{Pixels, is_similar, reservoir_index};
use crate::frame::FrameConstants;
use crate::light::LightTable;
use crate::reservoir::{Reservoir, StoredReservoir};
use crate::rng::{Rng, unit_f32};
use crate::surface::Surface;
use crate::target::target_function;
use glam::{UVec2, Vec2};

/// The pixel of the previous frame that saw `surface`, or none.
///
/// Positions are subtracted camera from camera first: near numbers, whatever the distance from the origin.
pub fn reproject(frame: &FrameConstants, surface: &Surface, previous_gbuffer: Pixels<'_>) -> Option<UVec2> {
    let relative = (frame.camera.position - frame.previous_camera.position) - surface.wo * surface.distance;
    let place = frame.previous_camera.project(relative, frame.size);
    let inside = place.cmpge(Vec2::ZERO).all() && place.cmplt(frame.size.as_vec2()).all();
    if frame.index == 0 || !inside {
        return None;
    }
    let pixel = place.as_uvec2().min(frame.size - 1);
    let texel = previous_gbuffer.gbuffer[frame.pixel_index(pixel) as usize];
    let same = is_similar(&frame.settings, relative.length(), surface.normal, &texel)
        && same_albedo(surface, texel.diffuse());
    if same { Some(pixel) } else { None }
}

/// Another material is another target function: its history is of little use. 0.25: a visibly different color.
fn same_albedo(surface: &Surface, previous: glam::Vec3) -> bool {
    (surface.reflectance.diffuse - previous).abs().max_element() <= 0.25
}

/// Biased temporal reuse, 1/M (Bitterli et al. 2020, Alg. 4): `current` merged with the history of its surface, the
/// latter capped at `confidence_cap` times the former.
pub fn biased(
    frame: &FrameConstants,
    lights: LightTable<'_>,
    surface: &Surface,
    current: StoredReservoir,
    previous: Pixels<'_>,
    lane: u32,
    rng: &mut Rng,
) -> StoredReservoir {
    let Some(pixel) = reproject(frame, surface, previous) else {
        return current;
    };
    let history = previous.reservoirs[reservoir_index(frame, pixel, lane) as usize]
        .capped(frame.settings.confidence_cap * current.confidence);
    let random = rng.next_u32x4();
    let mut merged = Reservoir::default();
    merged.merge(current, target_of(surface, lights, current), unit_f32(random.x));
    merged.merge(history, target_of(surface, lights, history), unit_f32(random.y));
    merged.finish(merged.confidence)
}

/// p̂ of a reservoir's survivor at `surface`.
pub(super) fn target_of(surface: &Surface, lights: LightTable<'_>, reservoir: StoredReservoir) -> f32 {
    if reservoir.contribution_weight <= 0.0 {
        return 0.0;
    }
    target_function(surface, &lights.incident(reservoir.sample, surface.position))
}
