//! Defensive pairwise MIS: merges reservoirs of different pixels without bias, at a cost linear in their number.
//!
//! With canonical reservoir 0, others i = 1..k, their confidences c (those of the others times a trust t), S = Σ_{i>0} c_i and
//! T = c_0 + S (Wyman et al. 2023, "A Gentle Introduction to ReSTIR", generalized from Bitterli 2022):
//!
//! ```text
//! m_i(y) = c_i/T · S p̂_i(y) / (S p̂_i(y) + c_0 p̂_0(y))
//! m_0(y) = c_0/T + Σ_i c_i/T · c_0 p̂_0(y) / (S p̂_i(y) + c_0 p̂_0(y))
//! ```
//!
//! They sum to 1 wherever p̂_0 > 0. Unbiased as long as every p̂_i is 0 where pixel i can't have found y: with visibility
//! reuse, p̂_i includes the visibility from pixel i, which is why [`Pairwise::add`] wants a ray's answer.

use crate::light::LightSample;
use crate::math::safe_ratio;
use crate::reservoir::{Reservoir, Stored};

/// A merge in progress, around one canonical reservoir.
#[derive(Clone, Copy, Debug)]
pub struct Pairwise<S = LightSample> {
    canonical: Stored<S>,
    /// p̂_0(y_0).
    canonical_target: f32,
    /// m_0(y_0) so far.
    canonical_mis: f32,
    /// S and T.
    others: f32,
    total: f32,
    /// t: what the confidence of others counts beside the canonical one's.
    trust: f32,
    merged: Reservoir<S>,
}

/// The four target functions between the canonical pixel 0 and another pixel i.
#[derive(Clone, Copy, Debug, Default)]
pub struct CrossTargets {
    /// p̂_0(y_i): `neighbor_at_canonical`.
    pub neighbor_at_canonical: f32,
    /// p̂_i(y_i).
    pub neighbor_at_neighbor: f32,
    /// p̂_i(y_0), 0 where a ray found y_0 hidden from pixel i.
    pub canonical_at_neighbor: f32,
}

/// What became of a reservoir in a merge.
#[derive(Clone, Copy, Debug, Default)]
pub struct Weighed {
    /// m
    pub mis_weight: f32,
    /// w = m p̂_0(y) W
    pub weight: f32,
    /// It is the survivor, for now.
    pub survives: bool,
}

impl<S: Copy + Default + PartialEq> Pairwise<S> {
    /// `others`: the confidences of all reservoirs that will be added. `trust`: t.
    pub fn new(canonical: Stored<S>, canonical_target: f32, others: f32, trust: f32) -> Self {
        let others = trust * others;
        let total = canonical.confidence + others;
        Pairwise {
            canonical,
            canonical_target,
            canonical_mis: safe_ratio(canonical.confidence, total),
            others,
            total,
            trust,
            merged: Reservoir::default(),
        }
    }

    /// Adds the survivor of another pixel. `u` in [0, 1).
    ///
    /// Equation (22): Bitterli section 4.3.
    /// Equation (24).
    pub fn add(&mut self, neighbor: Stored<S>, targets: CrossTargets, u: f32) -> Weighed {
        let share = safe_ratio(self.trust * neighbor.confidence, self.total);
        let there = self.others * targets.neighbor_at_neighbor;
        let here = self.canonical.confidence * targets.neighbor_at_canonical;
        let mis_weight = share * safe_ratio(there, there + here);
        let weight = mis_weight * targets.neighbor_at_canonical * neighbor.contribution_weight;
        let target = targets.neighbor_at_canonical;
        let survives = self.merged.add(neighbor.sample, target, weight, neighbor.confidence, u);

        let there = self.others * targets.canonical_at_neighbor;
        let here = self.canonical.confidence * self.canonical_target;
        self.canonical_mis += share * safe_ratio(here, there + here);
        Weighed { mis_weight, weight, survives }
    }

    /// The reservoir that others are merged into.
    pub fn canonical(&self) -> Stored<S> {
        self.canonical
    }

    /// What the canonical survivor's MIS weight gains if the pixel of a reservoir with this `confidence`, just added with target
    /// p̂_i(y_0) = `canonical_at_neighbor` > 0, does not see it.
    ///
    /// Equation (25).
    pub fn pending(&self, confidence: f32, canonical_at_neighbor: f32) -> f32 {
        let there = self.others * canonical_at_neighbor;
        let here = self.canonical.confidence * self.canonical_target;
        safe_ratio(self.trust * confidence, self.total) * safe_ratio(there, there + here)
    }

    /// Adds such a gain.
    ///
    /// Equation (26).
    pub fn resolve(&mut self, pending: f32) {
        self.canonical_mis += pending;
    }

    /// Adds the canonical survivor, whose weight is known only now. `u` in [0, 1).
    ///
    /// Equation (24).
    pub fn add_canonical(&mut self, u: f32) -> Weighed {
        let Pairwise { canonical, canonical_target: target, canonical_mis: mis_weight, .. } = *self;
        let weight = mis_weight * target * canonical.contribution_weight;
        let survives = self.merged.add(canonical.sample, target, weight, canonical.confidence, u);
        Weighed { mis_weight, weight, survives }
    }

    /// All that was added; the canonical survivor comes last.
    pub fn finish(self) -> Stored<S> {
        self.merged.finish(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reservoir::StoredReservoir;

    fn stored(light: u32, weight: f32, confidence: f32) -> StoredReservoir {
        StoredReservoir { sample: LightSample { light, uv: 0 }, contribution_weight: weight, confidence }
    }

    fn finished(mut merge: Pairwise, u: f32) -> StoredReservoir {
        merge.add_canonical(u);
        merge.finish()
    }

    /// Σ m_i(y) = 1 at one y that every pixel proposes: with p̂_j(y) = targets[j] and W = 1 everywhere, the merged weight
    /// sum is Σ m_j p̂_0 = p̂_0.
    ///
    /// Equation (23): Bitterli section 4.3.
    #[test]
    fn weights_sum_to_one() {
        for targets in [[1.0, 1.0, 1.0], [2.0, 0.5, 7.0], [1.0, 0.0, 3.0], [5.0, 0.0, 0.0], [1e-6, 1e6, 1.0]]
        {
            for (confidences, trust) in
                [([1.0, 1.0, 1.0], 1.0), ([32.0, 640.0, 5.0], 0.25), ([1.0, 0.0, 1000.0], 1.0)]
            {
                let others: f32 = confidences[1] + confidences[2];
                let mut merge = Pairwise::new(stored(0, 1.0, confidences[0]), targets[0], others, trust);
                for i in 1..3 {
                    let cross = CrossTargets {
                        neighbor_at_canonical: targets[0],
                        neighbor_at_neighbor: targets[i],
                        canonical_at_neighbor: targets[i],
                    };
                    merge.add(stored(0, 1.0, confidences[i]), cross, 0.5);
                }
                let merged = finished(merge, 0.5);
                // W = Σ m p̂_0 / p̂_0.
                let sum = merged.contribution_weight;
                assert!((sum - 1.0).abs() < 1e-5, "{targets:?} {confidences:?}: {sum}");
                assert_eq!(merged.confidence, confidences.iter().sum::<f32>());
            }
        }
    }

    /// A pending weight resolved is a target that was 0 from the start.
    #[test]
    fn resolved_weights_are_zero_targets() {
        let begin = || Pairwise::new(stored(0, 1.0, 3.0), 2.0, 9.0, 0.5);
        let cross = |canonical_at_neighbor| CrossTargets {
            neighbor_at_canonical: 0.7,
            neighbor_at_neighbor: 1.3,
            canonical_at_neighbor,
        };
        let (mut pending_merge, mut exact) = (begin(), begin());
        pending_merge.add(stored(1, 0.5, 9.0), cross(5.0), 0.5);
        let pending = pending_merge.pending(9.0, 5.0);
        assert!(pending > 0.1);
        pending_merge.resolve(pending);
        exact.add(stored(1, 0.5, 9.0), cross(0.0), 0.5);
        let (a, b) = (finished(pending_merge, 0.5), finished(exact, 0.5));
        assert!((a.contribution_weight - b.contribution_weight).abs() < 1e-6, "{a:?} {b:?}");
    }

    /// A neighbor that is certain of a light which is nearly black to it can't become a firefly: its weight is bounded
    /// by what the canonical pixel would have given it.
    #[test]
    fn strange_neighbors_stay_small() {
        let mut merge = Pairwise::new(stored(0, 1.0, 1.0), 1.0, 1.0, 1.0);
        let cross = CrossTargets {
            neighbor_at_canonical: 1e6,
            neighbor_at_neighbor: 1e-6,
            canonical_at_neighbor: 1.0,
        };
        // W = 1/p̂ there.
        merge.add(stored(1, 1e6, 1.0), cross, 0.0);
        let merged = finished(merge, 0.999);
        assert!(merged.contribution_weight * 1e6 < 2.0, "{merged:?}");
    }

    #[test]
    fn empty_reservoirs_merge_to_nothing() {
        let mut merge = Pairwise::new(StoredReservoir::default(), 0.0, 0.0, 1.0);
        merge.add(StoredReservoir::default(), CrossTargets::default(), 0.0);
        assert_eq!(finished(merge, 0.0).contribution_weight, 0.0);
    }
}
