//! Merges the reservoirs of partners by pairwise MIS, without a ray: both know from [`super::pair_targets`] all four targets of their
//! merge, visibility included. The survivor has been seen.

use super::pair_targets::PairTargets;
use super::{At, Visibility, Witness};
use crate::resampling::pairwise::{CrossTargets, Pairwise};
use crate::resampling::{CrossProposal, confidence};
use crate::reservoir::StoredReservoir;
use crate::resources::Extent;
use crate::rng::{Stream, unit_f32};

/// The pixel's reservoir, merged with its partner's.
pub fn pair_merge(
    at: At<'_>,
    _: impl Visibility,
    mut note: impl Witness,
    reservoirs: &[StoredReservoir],
    pair_targets: &[PairTargets],
) -> StoredReservoir {
    let index = at.index(Extent::Reservoirs);
    let (own, here) = (reservoirs[index], pair_targets[index]);
    let partner = here.index as usize;
    if partner == index {
        return own;
    }
    let settings = &at.frame.settings;
    let other = confidence::of_neighbor(settings, reservoirs[partner]);
    let there = pair_targets[partner];
    let targets = CrossTargets {
        neighbor_at_canonical: here.partner,
        neighbor_at_neighbor: there.own,
        canonical_at_neighbor: there.partner,
    };
    let mut cross = CrossProposal { neighbor: other, targets, ..CrossProposal::default() };
    note.cross(&mut cross);
    let random = at.repeated_rng(Stream::Spatial).next_u32x4();
    let mut merge = Pairwise::new(own, here.own, other.confidence, settings.neighbor_trust());
    let weighed = merge.add(other, cross.targets, unit_f32(random.x));
    note.merged(other, cross.targets.neighbor_at_canonical, weighed);
    note.merged_canonical(own, here.own, merge.add_canonical(unit_f32(random.y)));
    confidence::with_neighbors(settings, own.confidence, merge.finish())
}
