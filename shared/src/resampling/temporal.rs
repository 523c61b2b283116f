//! Merges the reservoir that the same surface point had in the previous frame.

use super::pairwise::Pairwise;
use super::{CrossProposal, Pixels, initial, is_similar, reservoir_index, target_of};
use crate::frame::FrameConstants;
use crate::light::LightTable;
use crate::reservoir::{Reservoir, StoredReservoir};
use crate::rng::{Rng, unit_f32};
use crate::surface::{GBufferTexel, Surface};
use glam::{UVec2, Vec2, Vec3};

/// Where `surface` was seen in the previous frame.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    pub pixel: UVec2,
    /// Of the surface to the previous camera, m.
    pub distance: f32,
}

/// The pixel of the previous frame that `surface` fell into; none outside the image, and in the first frame.
///
/// Positions are subtracted camera from camera first: near numbers, whatever the distance from the origin.
pub fn previous_place(frame: &FrameConstants, surface: &Surface) -> Option<Place> {
    place_of(frame, relative_to_previous(frame, surface))
}

/// From the previous frame's camera to `surface`, m.
pub(super) fn relative_to_previous(frame: &FrameConstants, surface: &Surface) -> Vec3 {
    (frame.camera.position - frame.previous_camera.position) - surface.wo * surface.distance
}

/// Where the previous frame saw what was at `relative` to its camera, m.
pub(super) fn place_of(frame: &FrameConstants, relative: Vec3) -> Option<Place> {
    let place = frame.previous_camera.project(relative, frame.size);
    let inside = place.cmpge(Vec2::ZERO).all() && place.cmplt(frame.size.as_vec2()).all();
    if frame.index == 0 || !inside {
        return None;
    }
    Some(Place { pixel: place.as_uvec2().min(frame.size - 1), distance: relative.length() })
}

/// The pixel of the previous frame that saw `surface`, or none.
pub fn reproject(frame: &FrameConstants, surface: &Surface, previous_gbuffer: Pixels<'_>) -> Option<UVec2> {
    similar_at(frame, surface, surface.normal, previous_place(frame, surface)?, previous_gbuffer)
}

/// The pixel of `place` if it saw `surface`, whose normal was `normal` then.
pub(super) fn similar_at(
    frame: &FrameConstants,
    surface: &Surface,
    normal: Vec3,
    place: Place,
    previous_gbuffer: Pixels<'_>,
) -> Option<UVec2> {
    let texel = previous_gbuffer.gbuffer[frame.pixel_index(place.pixel) as usize];
    let same =
        is_similar(&frame.settings, place.distance, normal, &texel) && is_similar_albedo(surface, &texel);
    if same { Some(place.pixel) } else { None }
}

/// Another material is another target function: its history is of little use. 0.25: a visibly different color.
pub fn is_similar_albedo(surface: &Surface, previous: &GBufferTexel) -> bool {
    (surface.reflectance.diffuse - previous.diffuse()).abs().max_element() <= 0.25
}

/// What `pixel` of the previous frame ended with, at most `confidence_cap` times as confident as `current`.
pub fn capped_history(
    frame: &FrameConstants,
    current: StoredReservoir,
    previous: Pixels<'_>,
    pixel: UVec2,
    lane: u32,
) -> StoredReservoir {
    previous.reservoirs[reservoir_index(frame, pixel, lane) as usize]
        .capped(frame.settings.confidence_cap * current.confidence)
}

/// Biased temporal reuse, 1/M (Bitterli et al. 2020, Alg. 4): `current` merged with the history of its surface.
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
    let history = capped_history(frame, current, previous, pixel, lane);
    merge_biased(lights, surface, current, history, rng)
}

pub(super) fn merge_biased(
    lights: LightTable<'_>,
    surface: &Surface,
    current: StoredReservoir,
    history: StoredReservoir,
    rng: &mut Rng,
) -> StoredReservoir {
    let random = rng.next_u32x4();
    let mut merged = Reservoir::default();
    merged.merge(current, target_of(surface, lights, current), unit_f32(random.x));
    merged.merge(history, target_of(surface, lights, history), unit_f32(random.y));
    merged.finish(merged.confidence)
}

/// Unbiased temporal reuse begins: `current` and the history of its surface, with the ray that asks whether the history's
/// pixel sees the current sample; none where there is no history.
pub fn propose(
    frame: &FrameConstants,
    lights: LightTable<'_>,
    surface: &Surface,
    current: StoredReservoir,
    previous: Pixels<'_>,
    lane: u32,
) -> Option<CrossProposal> {
    let pixel = reproject(frame, surface, previous)?;
    let history = capped_history(frame, current, previous, pixel, lane);
    let texel = previous.gbuffer[frame.pixel_index(pixel) as usize];
    let there = texel.unpack(&frame.previous_camera, pixel, frame.size);
    let cross = CrossProposal::new(lights, surface, current, &there, history);
    Some(CrossProposal { same_point: there.is_same_point(surface).into(), ..cross })
}

/// Unbiased temporal reuse ends (pairwise MIS of two): `visible` answers the proposal's ray. The survivor's own visibility
/// is still to be asked.
pub fn accept(
    lights: LightTable<'_>,
    surface: &Surface,
    current: StoredReservoir,
    proposal: CrossProposal,
    visible: bool,
    rng: &mut Rng,
) -> initial::Proposal {
    let random = rng.next_u32x4();
    let mut merge = begin(lights, surface, current, proposal);
    merge.add(proposal.neighbor, proposal.seen(visible), unit_f32(random.x));
    let merged = initial::Proposal::merged(surface, lights, current, merge.finish(unit_f32(random.y)));
    initial::Proposal { seen: merged.seen || proposal.same_point != 0, ..merged }
}

/// Unbiased temporal reuse of a frame that asks no rays: where nothing has moved, history and pixel see the same point, and
/// what one has seen, the other sees; where visibility is left to shading (`asks` is false), nobody wants to know. `current`
/// stays where a ray would be needed nevertheless.
pub fn without_rays(
    frame: &FrameConstants,
    lights: LightTable<'_>,
    surface: &Surface,
    current: StoredReservoir,
    previous: Pixels<'_>,
    lane: u32,
    rng: &mut Rng,
) -> StoredReservoir {
    let asks = frame.settings.visibility_is_known();
    let Some(proposal) = propose(frame, lights, surface, current, previous, lane) else {
        return current;
    };
    let merged = accept(lights, surface, current, proposal, true, rng);
    if asks && !(proposal.is_certain() && merged.is_certain()) {
        current
    } else {
        initial::accept(merged, true)
    }
}

/// A merge of two, before the history is added.
pub fn begin(
    lights: LightTable<'_>,
    surface: &Surface,
    current: StoredReservoir,
    proposal: CrossProposal,
) -> Pairwise {
    Pairwise::new(current, target_of(surface, lights, current), proposal.neighbor.confidence, 1.0)
}
