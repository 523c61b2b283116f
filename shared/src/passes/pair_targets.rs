//! What each pixel makes of its partner's sample, with at most one ray: the first half of unbiased spatial reuse in pairs.

use super::{At, Question, Visibility, Witness};
use crate::alias_table::AliasEntry;
use crate::alpha::SURE_HITS_ONLY;
use crate::light::Light;
use crate::resampling::pairs::similar_partner;
use crate::resampling::{confidence, reservoir_index, target_of};
use crate::reservoir::StoredReservoir;
use crate::shadow::ShadowRay;
use crate::surface::GBufferTexel;
use crate::target::target_function;
use bytemuck::{Pod, Zeroable};

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

/// The targets of the pixel's own and its partner's sample.
pub fn pair_targets(
    at: At<'_>,
    mut rays: impl Visibility,
    mut note: impl Witness,
    lights: &[Light],
    alias: &[AliasEntry],
    gbuffer: &[GBufferTexel],
    reservoirs: &[StoredReservoir],
) -> PairTargets {
    let frame = at.frame;
    let index = reservoir_index(frame, at.pixel, at.lane);
    let partner = similar_partner(frame, gbuffer, at.pixel, at.repetition());
    let Some(place) = partner else {
        note.place(None, false);
        return PairTargets { index, ..PairTargets::default() };
    };
    let own = reservoirs[index as usize];
    let others = reservoir_index(frame, place, at.lane);
    let other = reservoirs[others as usize];
    let alone = confidence::both_last(&frame.settings, own, other);
    note.place(partner, !alone);
    if alone {
        return PairTargets { index, ..PairTargets::default() };
    }
    let surface = at.surface(&at.texel(gbuffer));
    let table = at.light_table(lights, alias);
    let incident = table.incident(other.sample, surface.position);
    let holds_one = other.contribution_weight > 0.0;
    let partner = if holds_one { target_function(&surface, &incident) } else { 0.0 };
    // All but the answer stands before the ray: less to keep across it.
    let targets = PairTargets { own: target_of(&surface, table, own), partner, index: others };
    let ray = ShadowRay::new(&surface, &incident);
    // Both hold the same sample, and so both have seen it.
    let is_certain = own.shares_sample_with(other) || partner == 0.0;
    let visible = is_certain
        || !frame.settings.visibility_is_known()
        || rays.sees(Question::Partner, ray, SURE_HITS_ONLY);
    PairTargets { partner: if visible { partner } else { 0.0 }, ..targets }
}
