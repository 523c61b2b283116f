//! Transparency: whether a ray goes through a hit. Runs in any-hit shaders, for triangles that are not opaque only.
//!
//! A mask is exact. Blending is stochastic: a hit counts with probability alpha (Enderton et al. 2010, "Stochastic
//! Transparency"), so the mean over frames is that of sorted blending, in any order of the hits, and a shadow ray's mean
//! visibility is the product of (1 - alpha). One frame is noisy.

use crate::frame::FrameConstants;
use crate::material::{Material, flag};
use crate::rng::{Rng, Stream, hash, unit_f32};
use glam::{UVec2, UVec4};

/// Key of rays that only what is surely in the way may stop: every blended surface with alpha below 1 lets them through.
///
/// Rays that decide over *reuse* (a reservoir's fate, a mixture weight) must not take stochastic alpha: the final shadow ray
/// does, and light would be attenuated twice.
pub const SURE_HITS_ONLY: u32 = 0;

/// A ray's key from random bits: never [`SURE_HITS_ONLY`].
pub fn key(random: u32) -> u32 {
    random | 1
}

/// The key of the ray from the eye through `pixel`.
pub fn primary_key(frame: &FrameConstants, pixel: UVec2) -> u32 {
    key(Rng::new(pixel, frame.index, frame.seed, Stream::Primary, 0).next_u32x4().x)
}

/// Does the ray with `key` go through triangle `primitive` of geometry `instance`, where its alpha is `alpha`?
/// `alpha`: factor x texture x vertex color. The same ray gets the same answer whenever it asks again.
pub fn is_let_through(material: &Material, alpha: f32, key: u32, instance: u32, primitive: u32) -> bool {
    if material.has(flag::MASK) {
        return alpha < material.alpha_cutoff;
    }
    if key == SURE_HITS_ONLY {
        return alpha < 1.0;
    }
    unit_f32(hash(UVec4::new(key, instance, primitive, 0)).x) >= alpha
}

#[cfg(test)]
mod tests {
    use super::*;
    use bytemuck::Zeroable;

    fn material(flags: u32) -> Material {
        Material { alpha_cutoff: 0.5, flags, ..Material::zeroed() }
    }

    #[test]
    fn masks_cut_at_their_cutoff() {
        let mask = material(flag::MASK);
        for key in [SURE_HITS_ONLY, 1, 77] {
            assert!(is_let_through(&mask, 0.499, key, 0, 0) && !is_let_through(&mask, 0.5, key, 0, 0));
        }
    }

    /// Binomial: 2^16 draws each, |z| < 4.9 is a false alarm in 1e-6 (fixed keys, so: now or never).
    #[test]
    fn blended_hits_count_with_probability_alpha() {
        const N: u32 = 1 << 16;
        let blend = material(flag::BLEND);
        for alpha in [0.0f32, 0.1, 0.5, 0.9, 1.0] {
            let passes = |layer: u32| move |&i: &u32| is_let_through(&blend, alpha, key(i * 2), 3, layer);
            let through = (0..N).filter(passes(0)).count() as f64;
            let both = (0..N).filter(passes(0)).filter(passes(1)).count() as f64;
            let p = f64::from(1.0 - alpha);
            for (count, p) in [(through, p), (both, p * p)] {
                let deviation = (f64::from(N) * p * (1.0 - p)).sqrt();
                assert!((count - f64::from(N) * p).abs() <= 4.9 * deviation, "{count} of {N} at {alpha}");
            }
        }
    }

    #[test]
    fn only_sure_hits_stop_rays_of_reuse() {
        let blend = material(flag::BLEND);
        assert!(is_let_through(&blend, 0.999, SURE_HITS_ONLY, 0, 0));
        assert!(!is_let_through(&blend, 1.0, SURE_HITS_ONLY, 0, 0));
    }
}
