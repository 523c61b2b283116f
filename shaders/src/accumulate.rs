//! The viewer's mean over frames: one more frame.

use shared::frame::FrameConstants;
use shared::glam::{UVec3, Vec3};
use shared::interface::PassConstants;
use shared::view;
use spirv_std::spirv;

#[spirv(compute(threads(32, 4, 1), entry_point_name = "accumulate"))]
pub fn accumulate(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(push_constant)] constants: &PassConstants,
    #[spirv(uniform, descriptor_set = 1, binding = 0)] frame: &FrameConstants,
    #[spirv(storage_buffer, descriptor_set = 1, binding = 6)] radiance: &[Vec3],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 10)] mean: &mut [Vec3],
) {
    let pixel = id.truncate();
    if pixel.cmpge(frame.size).any() {
        return;
    }
    let index = frame.pixel_index(pixel) as usize;
    mean[index] = view::running_mean(mean[index], radiance[index], constants.count);
}
