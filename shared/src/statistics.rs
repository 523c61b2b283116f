//! Sums over a picture, a block of pixels at a time: how far it is from the reference.

use crate::math::luminance;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// Pixels a side that one thread sums.
pub const BLOCK: u32 = 16;

/// Sums over the pixels of a block. 12 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct BlockSums {
    /// How many.
    pub pixels: f32,
    /// Σ (L - L_ref)² of the luminances, nit².
    pub squared_difference: f32,
    /// Σ L_ref, nit.
    pub reference: f32,
}

impl BlockSums {
    /// One more pixel: what is shown and the reference's radiance, nit.
    pub fn add(&mut self, radiance: Vec3, reference: Vec3) {
        let (x, truth) = (luminance(radiance), luminance(reference));
        let difference = x - truth;
        self.pixels += 1.0;
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
        sums.add(Vec3::splat(3.0), Vec3::splat(1.0));
        sums.add(Vec3::ZERO, Vec3::splat(2.0));
        sums.add(Vec3::splat(1.0), Vec3::splat(1.0));
        let close = |a: f32, b: f32| (a - b).abs() < 1e-5;
        assert!(sums.pixels == 3.0 && close(sums.reference, 4.0) && close(sums.squared_difference, 8.0));
    }
}
