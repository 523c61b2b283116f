//! Pass 6: radiance to display values.

use shared::frame::FrameConstants;
use shared::glam::{UVec3, Vec3};
use shared::tonemap;
use spirv_std::spirv;

#[spirv(compute(threads(32, 4, 1), entry_point_name = "tonemap"))]
pub fn tonemap(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(uniform, descriptor_set = 1, binding = 0)] frame: &FrameConstants,
    #[spirv(storage_buffer, descriptor_set = 1, binding = 6)] radiance: &[Vec3],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 7)] display: &mut [u32],
) {
    let pixel = id.truncate();
    if pixel.cmpge(frame.size).any() {
        return;
    }
    let index = frame.pixel_index(pixel) as usize;
    display[index] = tonemap::pack_rgba8(tonemap::display(radiance[index], frame.exposure));
}
