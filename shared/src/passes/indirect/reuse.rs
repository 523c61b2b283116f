//! Reuse of paths, in time and in pairs: always by pairwise MIS, with the rays that it needs.

use super::lane;
use crate::bounced::{Bounced, PathSample};
use crate::passes::pair_targets::PairTargets;
use crate::passes::temporal::history_of;
use crate::passes::{At, Question, Visibility, Witness};
use crate::points::Aim;
use crate::resampling::pairs::similar_partner;
use crate::resampling::pairwise::{CrossTargets, Pairwise};
use crate::resampling::reprojection::Before;
use crate::resampling::{CrossProposal, Source, Survivor, confidence, target_of};
use crate::reservoir::StoredPath;
use crate::resources::Extent;
use crate::rng::{Stream, unit_f32};
use crate::shadow::ShadowRay;
use crate::surface::{GBufferTexel, Surface};
use crate::target::target_function;
use crate::textures::Texels;

/// Merges a pixel's path with that of its history.
#[allow(clippy::too_many_arguments)]
pub fn temporal<V: Visibility, T: Texels>(
    at: At<'_>,
    mut rays: V,
    mut note: impl Witness,
    source: Bounced<'_, T>,
    gbuffer: &[GBufferTexel],
    previous_gbuffer: &[GBufferTexel],
    history: &[StoredPath],
    aims: &[Aim],
    current: StoredPath,
) -> StoredPath {
    let frame = at.frame;
    let texel = at.texel(gbuffer);
    if texel.is_empty() {
        return current;
    }
    let surface = at.surface(&texel);
    let Some(place) =
        history_of(at, &mut note, &surface, Before::still(frame, &surface), previous_gbuffer, aims)
    else {
        return current;
    };
    let index = frame.pixel_index(place.pixel) as usize;
    let there = previous_gbuffer[index].unpack(at.features, &frame.previous_camera, place.pixel, frame.size);
    // Of a path without light x2 alone is known, and of no use here.
    let holds_one = current.contribution_weight > 0.0;
    let current = if holds_one { current } else { StoredPath { sample: PathSample::default(), ..current } };
    let same_point = place.lasts != 0 || there.is_same_point(&surface);
    let history = confidence::of_history(frame, history[index], same_point, current.confidence);
    if !V::TRACES && !same_point {
        return current;
    }
    let mut cross = if same_point {
        at_same_point(source, &surface, current, history)
    } else {
        CrossProposal::new(source, &surface, current, &there, history)
    };
    note.crosses(&mut cross);
    let seen =
        cross.is_certain() || rays.sees(Question::History, cross.ray, current.sample.key().to_surface());
    let target = target_of(&surface, source, current);
    let random = at.lane_rng(Stream::Indirect, lane::TEMPORAL).next_u32x4();
    let mut merge = Pairwise::new(current, target, cross.neighbor.confidence, 1.0);
    merge.add(cross.neighbor, cross.seen(seen), unit_f32(random.x));
    merge.add_canonical(unit_f32(random.y));
    let merged = merge.finish();
    if same_point {
        return merged;
    }
    let survivor = Survivor::merged(&surface, source, current, merged);
    let key = merged.sample.key().to_surface();
    survivor.kept(survivor.is_certain() || rays.sees(Question::Survivor, survivor.ray, key))
}

/// Where history and pixel see one point of a scene that stands still, they see the same paths.
fn at_same_point(
    source: impl Source<Sample = PathSample>,
    surface: &Surface,
    current: StoredPath,
    history: StoredPath,
) -> CrossProposal<PathSample> {
    let of_history = target_of(surface, source, history);
    let targets = CrossTargets {
        neighbor_at_canonical: of_history,
        neighbor_at_neighbor: of_history,
        canonical_at_neighbor: target_of(surface, source, current),
    };
    CrossProposal { neighbor: history, targets, same_point: 1, ..CrossProposal::default() }
}

/// What each pixel makes of its partner's path.
pub fn pair_targets<T: Texels>(
    at: At<'_>,
    mut rays: impl Visibility,
    mut note: impl Witness,
    source: Bounced<'_, T>,
    gbuffer: &[GBufferTexel],
    paths: &[StoredPath],
) -> PairTargets {
    let frame = at.frame;
    let index = frame.pixel_index(at.pixel);
    let alone = PairTargets { index, ..PairTargets::default() };
    let partner = similar_partner(frame, gbuffer, at.pixel, at.repetition());
    let Some(place) = partner else {
        note.place(None, false);
        return alone;
    };
    let own = paths[index as usize];
    let index = frame.pixel_index(place);
    let other = paths[index as usize];
    let both_last = confidence::both_last(&frame.settings, own, other);
    note.place(partner, !both_last);
    if both_last {
        return alone;
    }
    let surface = at.surface(&at.texel(gbuffer));
    let holds_one = other.contribution_weight > 0.0;
    let sample = if holds_one { other.sample } else { PathSample::default() };
    let incident = source.incident(sample, surface.position);
    let partner = if holds_one { target_function(&surface, &incident) } else { 0.0 };
    let targets = PairTargets { own: target_of(&surface, source, own), partner, index };
    let ray = ShadowRay::new(&surface, &incident);
    let is_certain = own.shares_sample_with(other) || partner == 0.0;
    let visible = is_certain || rays.sees(Question::Partner, ray, other.sample.key().to_surface());
    PairTargets { partner: if visible { partner } else { 0.0 }, ..targets }
}

/// Merges the paths of partners: both know all four targets of their merge, visibility included.
pub fn indirect_pair_merge(
    at: At<'_>,
    _: impl Visibility,
    mut note: impl Witness,
    paths: &[StoredPath],
    pair_targets: &[PairTargets],
) -> StoredPath {
    let index = at.index(Extent::Pixels);
    let (own, here) = (paths[index], pair_targets[index]);
    let partner = here.index as usize;
    if partner == index {
        return own;
    }
    let settings = &at.frame.settings;
    let other = confidence::of_neighbor(settings, paths[partner]);
    let there = pair_targets[partner];
    let targets = CrossTargets {
        neighbor_at_canonical: here.partner,
        neighbor_at_neighbor: there.own,
        canonical_at_neighbor: there.partner,
    };
    let mut cross = CrossProposal { neighbor: other, targets, ..CrossProposal::default() };
    note.crosses(&mut cross);
    let random = at.lane_rng(Stream::Indirect, lane::PAIRS + at.constants.iteration).next_u32x4();
    let mut merge = Pairwise::new(own, here.own, other.confidence, settings.pair_trust());
    merge.add(other, cross.targets, unit_f32(random.x));
    merge.add_canonical(unit_f32(random.y));
    confidence::with_neighbors(settings, own.confidence, merge.finish())
}
