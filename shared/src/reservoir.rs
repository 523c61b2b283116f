//! Weighted reservoir sampling: one survivor from a stream of candidates, drawn in proportion to their weights.

use crate::bounced::PathSample;
use crate::light::LightSample;
use crate::math::safe_ratio;
use bytemuck::{Pod, Zeroable};

/// A reservoir while it is being filled, in registers (Bitterli et al. 2020, Alg. 2).
///
/// ```
/// use candela_shared::reservoir::Reservoir;
///
/// // Two candidates with p̂ = 2 and 6, both drawn with p = 1/2: w = p̂/p.
/// let mut reservoir = Reservoir::default();
/// reservoir.add("dim", 2.0, 4.0, 1.0, 0.5);
/// reservoir.add("bright", 6.0, 12.0, 1.0, 0.5);
/// let stored = reservoir.finish(reservoir.confidence);
/// // u = 0.5 is below 12/16. W = (4 + 12) / (2 * 6).
/// assert_eq!((stored.sample, stored.contribution_weight), ("bright", 16.0 / 12.0));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reservoir<S = LightSample> {
    /// The survivor y.
    pub sample: S,
    /// p̂(y) at the pixel that fills the reservoir.
    pub target: f32,
    /// Σ w over all candidates seen.
    pub weight_sum: f32,
    /// M: candidates seen, directly or through merged reservoirs. An integer, exact up to 2^24.
    pub confidence: f32,
}

/// A reservoir in memory between passes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Zeroable)]
#[repr(C)]
pub struct Stored<S> {
    /// y, the survivor.
    pub sample: S,
    /// W, an unbiased estimate of 1/p(y); 0: no light found. Always finite.
    pub contribution_weight: f32,
    /// M. An integer.
    pub confidence: f32,
}

/// Of direct light. 16 bytes.
pub type StoredReservoir = Stored<LightSample>;

/// Of light that bounces. 32 bytes.
pub type StoredPath = Stored<PathSample>;

// SAFETY: `repr(C)`, of 4-byte scalars alone, so without padding; any bits are a value.
unsafe impl Pod for StoredReservoir {}
// SAFETY: as above.
unsafe impl Pod for StoredPath {}

impl<S: Copy + PartialEq> Reservoir<S> {
    /// Shows the reservoir one candidate that stands for `confidence` others and weighs `resampling_weight`; `u` in [0, 1).
    /// Tells whether it became the survivor, which happens with probability w / Σw. A weight that is no positive
    /// finite number counts as 0.
    ///
    /// Equation (9): Bitterli (8); thesis (4.18).
    /// Equation (13): Bitterli section 2.2, Bitterli Alg. 2; thesis (4.20).
    pub fn add(&mut self, sample: S, target: f32, resampling_weight: f32, confidence: f32, u: f32) -> bool {
        self.confidence += confidence;
        // False for NaN too; f32::MAX keeps the sum of few weights finite.
        if !((resampling_weight > 0.0) & (resampling_weight < 1e35)) {
            return false;
        }
        self.weight_sum += resampling_weight;
        let survives = u * self.weight_sum < resampling_weight;
        if survives {
            self.sample = sample;
            self.target = target;
        }
        survives
    }

    /// Shows the reservoir the survivor of `other`, whose target function at *this* pixel is `target`:
    /// w = p̂(y) W M (Bitterli et al. 2020, Alg. 4).
    ///
    /// Equation (18): Bitterli section 3.2, Bitterli Alg. 4; thesis section 4.1.7.
    pub fn merge(&mut self, other: Stored<S>, target: f32, u: f32) -> bool {
        self.add(other.sample, target, other.merged_weight(target), other.confidence, u)
    }

    /// W = Σw / (`normalization` p̂(y)). With normalization M it is RIS with uniform MIS weights.
    ///
    /// Equation (9): Bitterli Alg. 1; thesis (4.16), thesis (4.17).
    pub fn finish(&self, normalization: f32) -> Stored<S> {
        Stored {
            sample: self.sample,
            contribution_weight: safe_ratio(safe_ratio(self.weight_sum, normalization), self.target),
            confidence: self.confidence,
        }
    }
}

impl<S: Copy + PartialEq> Stored<S> {
    /// Do both hold a sample, and the same?
    pub fn shares_sample_with(self, other: Self) -> bool {
        self.contribution_weight > 0.0 && other.contribution_weight > 0.0 && self.sample == other.sample
    }

    /// Visibility reuse: an occluded survivor contributes nothing, here and wherever it would be reused.
    ///
    /// Equation (20): Bitterli section 3.2, Bitterli Alg. 5; thesis section 4.1.7.
    pub fn occluded(self) -> Self {
        Stored { contribution_weight: 0.0, ..self }
    }

    /// p̂(y) W M, what it weighs in a merge at a pixel where its target is `target`.
    ///
    /// Equation (18): Bitterli Alg. 4; thesis section 4.1.7.
    pub fn merged_weight(&self, target: f32) -> f32 {
        target * self.contribution_weight * self.confidence
    }

    /// The same reservoir standing for at most `cap` candidates.
    ///
    /// Equation (19): Bitterli section 5; thesis section 4.1.7.
    pub fn capped(self, cap: f32) -> Self {
        Stored { confidence: self.confidence.min(cap), ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Rng, Stream};
    use glam::UVec2;

    fn sample(light: u32) -> LightSample {
        LightSample { light, uv: 0 }
    }

    fn chi2(counts: &[u32], mass: &[f64]) -> f64 {
        let n: u32 = counts.iter().sum();
        counts
            .iter()
            .zip(mass)
            .map(|(&c, m)| (f64::from(c) - m * f64::from(n)).powi(2) / (m * f64::from(n)))
            .sum()
    }

    /// Survivors follow w_i / Σw. Chi-square with 4 degrees of freedom, false alarm 1e-4 (fixed seed); the planted
    /// error (the last candidate always survives) must be seen.
    ///
    /// Equation (14): Bitterli section 2.2; thesis (4.19), thesis (4.21), thesis (4.22).
    #[test]
    fn survivors_follow_their_weights() {
        const WEIGHTS: [f32; 5] = [1.0, 5.0, 0.5, 2.5, 1.0];
        const LIMIT: f64 = 23.51;
        let mass = WEIGHTS.map(|w| f64::from(w) / 10.0);
        let run = |bias: f32| {
            let mut counts = [0u32; 5];
            for i in 0..200_000 {
                let mut rng = Rng::new(UVec2::new(i, 0), 0, 5, Stream::Initial, 0);
                let mut reservoir = Reservoir::default();
                for (light, &w) in WEIGHTS.iter().enumerate() {
                    reservoir.add(sample(light as u32), w, w, 1.0, rng.next_f32() * bias);
                }
                assert_eq!((reservoir.confidence, reservoir.weight_sum), (5.0, 10.0));
                counts[reservoir.sample.light as usize] += 1;
            }
            chi2(&counts, &mass)
        };
        assert!(run(1.0) < LIMIT, "chi-square {}", run(1.0));
        assert!(run(0.9) > LIMIT, "the planted error was not seen");
    }

    /// Merging two reservoirs draws as one reservoir that saw both streams would: with W = Σw/(M p̂) and one p̂, the
    /// merged weight p̂ W M is Σw again. Chi-square as above.
    #[test]
    fn merging_equals_one_long_stream() {
        const STREAMS: [[f32; 3]; 2] = [[1.0, 2.0, 3.0], [4.0, 1.0, 1.0]];
        let mass = [1.0, 2.0, 3.0, 4.0, 1.0, 1.0].map(|w| w / 12.0);
        let mut counts = [0u32; 6];
        for i in 0..200_000 {
            let mut rng = Rng::new(UVec2::new(i, 1), 0, 6, Stream::Spatial, 0);
            let mut merged = Reservoir::default();
            for (s, weights) in STREAMS.iter().enumerate() {
                let mut stream = Reservoir::default();
                for (k, &w) in weights.iter().enumerate() {
                    stream.add(sample((3 * s + k) as u32), w, w, 1.0, rng.next_f32());
                }
                let stored = stream.finish(stream.confidence);
                merged.merge(stored, stream.target, rng.next_f32());
            }
            assert!((merged.weight_sum - 12.0).abs() < 1e-4 && merged.confidence == 6.0);
            counts[merged.sample.light as usize] += 1;
        }
        // 5 degrees of freedom, quantile 0.9999.
        assert!(chi2(&counts, &mass) < 25.74, "chi-square {}", chi2(&counts, &mass));
    }

    #[test]
    fn useless_candidates_count_but_never_survive() {
        let mut reservoir = Reservoir::default();
        for w in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert!(!reservoir.add(sample(1), 1.0, w, 1.0, 0.0));
        }
        assert_eq!((reservoir.confidence, reservoir.weight_sum), (4.0, 0.0));
        let stored = reservoir.finish(reservoir.confidence);
        assert_eq!((stored.contribution_weight, stored.confidence), (0.0, 4.0));
        // W of zero stays out of a merge, whatever its confidence.
        assert!(!Reservoir::default().merge(stored, 1.0, 0.0));
        assert!(reservoir.add(sample(2), 3.0, 3.0, 1.0, 0.999));
    }

    #[test]
    fn stored_weights_are_finite() {
        for target in [0.0, 1e-38, 1e-20, 1.0, 1e30] {
            for weight in [1e-38, 1.0, 1e34] {
                let mut reservoir = Reservoir::default();
                reservoir.add(sample(0), target, weight, 1.0, 0.0);
                assert!(reservoir.finish(1.0).contribution_weight.is_finite(), "{weight} / {target}");
                assert!(reservoir.finish(0.0).contribution_weight == 0.0);
            }
        }
        assert_eq!((size_of::<StoredReservoir>(), size_of::<StoredPath>()), (16, 32));
    }
}
