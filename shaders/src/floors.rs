//! What the hardware needs for a pass's rays and bytes, without the pass: rays from a buffer, traced and counted, and a copy.

use crate::trace::{trace_primary, trace_shadow};
use shared::frame::FrameConstants;
use shared::glam::UVec3;
use shared::interface::{HitPayload, ShadowPayload};
use shared::stored_ray::StoredRay;
use shared::surface::GBufferTexel;
use spirv_std::ray_tracing::AccelerationStructure;
use spirv_std::spirv;

#[spirv(ray_generation(entry_point_name = "floor_primary"))]
pub fn floor_primary(
    #[spirv(launch_id)] launch: UVec3,
    #[spirv(spec_constant(id = 0, default = 0))] features: u32,
    #[spirv(descriptor_set = 0, binding = 0)] tlas: &AccelerationStructure,
    #[spirv(uniform, descriptor_set = 1, binding = 0)] frame: &FrameConstants,
    #[spirv(storage_buffer, descriptor_set = 1, binding = 13)] rays: &[StoredRay],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 14)] hits: &mut [u32],
    #[spirv(ray_payload)] payload: &mut HitPayload,
) {
    let index = frame.pixel_index(launch.truncate()) as usize;
    let ray = rays[index];
    payload.hit = 0;
    if ray.traced != 0 {
        trace_primary(tlas, features, ray.origin, ray.direction, ray.key, payload);
    }
    hits[index] = payload.hit;
}

#[spirv(ray_generation(entry_point_name = "floor_shadow"))]
pub fn floor_shadow(
    #[spirv(launch_id)] launch: UVec3,
    #[spirv(spec_constant(id = 0, default = 0))] features: u32,
    #[spirv(descriptor_set = 0, binding = 0)] tlas: &AccelerationStructure,
    #[spirv(uniform, descriptor_set = 1, binding = 0)] frame: &FrameConstants,
    #[spirv(storage_buffer, descriptor_set = 1, binding = 13)] rays: &[StoredRay],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 14)] hits: &mut [u32],
    #[spirv(ray_payload)] payload: &mut ShadowPayload,
) {
    let index = frame.pixel_index(launch.truncate()) as usize;
    let ray = rays[index];
    let hit = ray.traced != 0 && !trace_shadow(tlas, features, ray.shadow(), ray.key, payload);
    hits[index] = hit as u32;
}

#[spirv(compute(threads(32, 4, 1), entry_point_name = "floor_copy"))]
pub fn floor_copy(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(uniform, descriptor_set = 1, binding = 0)] frame: &FrameConstants,
    #[spirv(storage_buffer, descriptor_set = 1, binding = 1)] gbuffer: &[GBufferTexel],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 2)] previous: &mut [GBufferTexel],
) {
    let pixel = id.truncate();
    if pixel.cmpge(frame.size).any() {
        return;
    }
    let index = frame.pixel_index(pixel) as usize;
    previous[index] = gbuffer[index];
}
