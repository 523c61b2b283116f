//! Sums over a picture, a block of pixels at a time: brightness for the exposure, differences for the error.

use crate::math::luminance;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float;

/// Pixels a side that one thread sums.
pub const BLOCK: u32 = 16;

/// Sums over the pixels of a block. 24 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct BlockSums {
    /// Pixels with a luminance L above 0, Σ ln L and Σ L of those.
    pub lit: f32,
    pub log_luminance: f32,
    pub luminance: f32,
    /// All pixels.
    pub pixels: f32,
    /// Σ (L - L_ref)² and Σ L_ref.
    pub squared_difference: f32,
    pub reference: f32,
}

impl BlockSums {
    /// One more pixel: what is shown and the reference's, nit.
    pub fn add(&mut self, radiance: Vec3, reference: Vec3) {
        let (x, truth) = (luminance(radiance), luminance(reference));
        self.pixels += 1.0;
        if x > 0.0 && x < f32::MAX {
            self.lit += 1.0;
            self.log_luminance += x.ln();
            self.luminance += x;
        }
        let difference = x - truth;
        self.squared_difference += difference * difference;
        self.reference += truth;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_of_known_pixels() {
        let mut sums = BlockSums::default();
        sums.add(Vec3::splat(core::f32::consts::E), Vec3::splat(1.0));
        sums.add(Vec3::ZERO, Vec3::splat(2.0));
        sums.add(Vec3::splat(1.0), Vec3::splat(1.0));
        assert_eq!((sums.lit, sums.pixels, sums.reference), (2.0, 3.0, 4.0));
        assert!((sums.log_luminance - 1.0).abs() < 1e-5);
        let expected = (core::f32::consts::E - 1.0).powi(2) + 4.0;
        assert!((sums.squared_difference - expected).abs() < 1e-4);
    }
}
