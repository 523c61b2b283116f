//! Sums over a block of the picture that is shown.

use super::At;
use crate::statistics::{BLOCK, BlockSums};
use glam::{UVec2, Vec3};

/// Of the block at `at.pixel`.
pub fn statistics(at: At<'_>, radiance: &[Vec3], mean: &[Vec3], reference: &[Vec3]) -> BlockSums {
    let size = at.frame.size;
    let first = at.pixel * BLOCK;
    let mut sum = BlockSums::default();
    let mut y = first.y;
    while y < size.y && y < first.y + BLOCK {
        let mut x = first.x;
        while x < size.x && x < first.x + BLOCK {
            let index = at.frame.pixel_index(UVec2::new(x, y)) as usize;
            let shown = if at.constants.count > 0 { mean[index] } else { radiance[index] };
            sum.add(shown, reference[index]);
            x += 1;
        }
        y += 1;
    }
    sum
}
