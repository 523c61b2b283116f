//! Merges the reservoir with which the same surface point ended the previous frame: by 1/M (Bitterli et al. 2020, Alg. 4), or by
//! pairwise MIS with up to two rays. Where history and pixel see the same point of a scene in which nothing has moved, no ray is needed.

use super::{At, Question, Visibility, Witness, variant};
use crate::alias_table::AliasEntry;
use crate::alpha::SURE_HITS_ONLY;
use crate::light::{Light, Lights};
use crate::motion::{InstanceMotion, PastLights};
use crate::points::Aim;
use crate::resampling::pairwise::Pairwise;
use crate::resampling::reprojection::{Before, similar_at};
use crate::resampling::{
    CrossProposal, Survivor, UniformMerge, confidence, moving, reservoir_index, target_of,
};
use crate::reservoir::StoredReservoir;
use crate::resources::Extent;
use crate::rng::{Stream, unit_f32};
use crate::surface::{GBufferTexel, Surface};
use glam::UVec2;

/// `current`: the reservoir as `initial` left it.
#[allow(clippy::too_many_arguments)]
pub fn temporal<V: Visibility>(
    at: At<'_>,
    mut rays: V,
    mut note: impl Witness,
    lights: &[Light],
    alias: &[AliasEntry],
    gbuffer: &[GBufferTexel],
    previous_gbuffer: &[GBufferTexel],
    history: &[StoredReservoir],
    aims: &[Aim],
    previous_lights: &[Light],
    motions: &[InstanceMotion],
    previous_to_current: &[u32],
    current_to_previous: &[u32],
    current: StoredReservoir,
) -> StoredReservoir {
    let (frame, moving) = (at.frame, at.is(variant::MOVING));
    let texel = at.texel(gbuffer);
    if texel.is_empty() {
        return current;
    }
    let surface = at.surface(&texel);
    let mut then = Before::still(frame, &surface);
    if moving {
        then = then.moved(&surface, &motions[texel.instance() as usize]);
    }
    let Some(History { pixel, lasts }) = history_of(at, &mut note, &surface, then, previous_gbuffer, aims)
    else {
        return current;
    };
    // Points that are kept know what they see; the others are listed, and ask.
    let split = at.is(variant::LASTING) && at.is(variant::UNBIASED) && frame.settings.visibility_is_known();
    if split && !V::TRACES && lasts == 0 {
        return current;
    }
    let previous_texel = previous_gbuffer[frame.pixel_index(pixel) as usize];
    let table = at.light_table(lights, alias);
    let past = PastLights {
        lights: Lights { lights: previous_lights, features: at.features },
        previous_to_current,
        current_to_previous,
    };
    let history = history[reservoir_index(frame, pixel, at.lane) as usize];
    let fresh = current.confidence;
    let random = at.rng(Stream::Temporal).next_u32x4();
    if !at.is(variant::UNBIASED) {
        let history = confidence::of_history(frame, history, false, fresh);
        let history = if moving { past.carried(table.lights, history) } else { history };
        let mut merge = UniformMerge::default();
        let (at_current, at_history) =
            (target_of(&surface, table, current), target_of(&surface, table, history));
        note.merged_canonical(current, at_current, merge.add(current, at_current, unit_f32(random.x)));
        note.merged(history, at_history, merge.add(history, at_history, unit_f32(random.y)));
        return merge.finish();
    }
    let there = previous_texel.unpack(at.features, &frame.previous_camera, pixel, frame.size);
    let same_point = !moving && (lasts != 0 || there.is_same_point(&surface));
    let history = confidence::of_history(frame, history, same_point, fresh);
    let mut cross = if moving {
        moving::cross(table, past, &surface, current, &there, history)
    } else {
        let same_point = same_point.into();
        CrossProposal { same_point, ..CrossProposal::new(table, &surface, current, &there, history) }
    };
    note.cross(&mut cross);
    let asks = frame.settings.visibility_is_known();
    let known = !asks || cross.is_certain();
    if !V::TRACES && !known {
        return current;
    }
    let seen = known
        || if moving {
            rays.saw(Question::History, cross.ray, SURE_HITS_ONLY)
        } else {
            rays.sees(Question::History, cross.ray, SURE_HITS_ONLY)
        };
    let target = target_of(&surface, table, current);
    let mut merge = Pairwise::new(current, target, cross.neighbor.confidence, 1.0);
    let weighed = merge.add(cross.neighbor, cross.seen(seen), unit_f32(random.x));
    note.merged(cross.neighbor, cross.targets.neighbor_at_canonical, weighed);
    note.merged_canonical(current, target, merge.add_canonical(unit_f32(random.y)));
    let merged = Survivor::merged(&surface, table, current, merge.finish());
    let survivor = Survivor { seen: merged.seen || cross.same_point != 0, ..merged };
    let known = !asks || survivor.is_certain();
    if !V::TRACES && !known {
        return current;
    }
    survivor.kept(known || rays.sees(Question::Survivor, survivor.ray, SURE_HITS_ONLY))
}

/// The pixel of the previous frame that saw what this one sees.
#[derive(Clone, Copy, Debug)]
pub struct History {
    /// In the previous frame.
    pub pixel: UVec2,
    /// 1: it is the very point, which has lasted. (rust-gpu takes no bool in an Option.)
    pub lasts: u32,
}

/// Where the previous frame saw `surface`, if it was `then` what it is; nowhere where that pixel saw another. `aims` are read by the
/// variant whose points last.
pub fn history_of(
    at: At<'_>,
    note: &mut impl Witness,
    surface: &Surface,
    then: Before,
    previous_gbuffer: &[GBufferTexel],
    aims: &[Aim],
) -> Option<History> {
    let frame = at.frame;
    if at.is(variant::LASTING)
        && let Some(source) = aims[at.index(Extent::Pixels)].source()
    {
        let pixel = frame.pixel_at(source);
        note.place(Some(pixel), true);
        return Some(History { pixel, lasts: 1 });
    }
    let Some(place) = then.place(frame) else {
        note.place(None, false);
        return None;
    };
    let previous_texel = previous_gbuffer[frame.pixel_index(place.pixel) as usize];
    let found = similar_at(frame, surface, then, place, &previous_texel);
    note.place(Some(place.pixel), found);
    if found { Some(History { pixel: place.pixel, lasts: 0 }) } else { None }
}
