//! Sums over the picture that is shown, a thread a block.

use shared::frame::FrameConstants;
use shared::glam::{UVec2, UVec3, Vec3};
use shared::interface::PassConstants;
use shared::statistics::{BLOCK, BlockSums};
use spirv_std::spirv;

#[spirv(compute(threads(32, 4, 1), entry_point_name = "statistics"))]
pub fn statistics(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(push_constant)] constants: &PassConstants,
    #[spirv(uniform, descriptor_set = 1, binding = 0)] frame: &FrameConstants,
    #[spirv(storage_buffer, descriptor_set = 1, binding = 6)] radiance: &[Vec3],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 10)] mean: &[Vec3],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 11)] reference: &[Vec3],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 12)] sums: &mut [BlockSums],
) {
    let blocks = UVec2::new(frame.size.x.div_ceil(BLOCK), frame.size.y.div_ceil(BLOCK));
    if id.truncate().cmpge(blocks).any() {
        return;
    }
    let first = id.truncate() * BLOCK;
    let mut sum = BlockSums::default();
    let mut y = first.y;
    while y < frame.size.y && y < first.y + BLOCK {
        let mut x = first.x;
        while x < frame.size.x && x < first.x + BLOCK {
            let index = frame.pixel_index(UVec2::new(x, y)) as usize;
            let shown = if constants.count > 0 { mean[index] } else { radiance[index] };
            sum.add(shown, reference[index]);
            x += 1;
        }
        y += 1;
    }
    sums[(id.y * blocks.x + id.x) as usize] = sum;
}
