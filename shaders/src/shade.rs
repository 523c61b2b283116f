//! Pass 5: the radiance of each pixel from its reservoirs, one shadow ray each.

use crate::trace::trace_shadow;
use shared::alias_table::AliasEntry;
use shared::frame::FrameConstants;
use shared::glam::{UVec3, Vec3};
use shared::interface::ShadowPayload;
use shared::light::{Light, LightTable, Lights};
use shared::resampling::reservoir_index;
use shared::reservoir::StoredReservoir;
use shared::shading;
use shared::surface::GBufferTexel;
use spirv_std::ray_tracing::AccelerationStructure;
use spirv_std::spirv;

#[spirv(ray_generation(entry_point_name = "shade"))]
pub fn shade(
    #[spirv(launch_id)] launch: UVec3,
    #[spirv(descriptor_set = 0, binding = 0)] tlas: &AccelerationStructure,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] lights: &[Light],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 7)] alias: &[AliasEntry],
    #[spirv(uniform, descriptor_set = 1, binding = 0)] frame: &FrameConstants,
    #[spirv(storage_buffer, descriptor_set = 1, binding = 1)] gbuffer: &[GBufferTexel],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 3)] reservoirs: &[StoredReservoir],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 6)] radiance: &mut [Vec3],
    #[spirv(ray_payload)] payload: &mut ShadowPayload,
) {
    let pixel = launch.truncate();
    let index = frame.pixel_index(pixel) as usize;
    let texel = gbuffer[index];
    if texel.is_empty() {
        return;
    }
    let surface = texel.unpack(&frame.camera, pixel, frame.size);
    let lights = LightTable { lights: Lights { lights }, alias };
    let mut lit = shading::Average::default();
    for lane in 0..frame.settings.reservoirs {
        let stored = reservoirs[reservoir_index(frame, pixel, lane) as usize];
        let proposal = shading::propose(&surface, lights, stored);
        let visible = !proposal.is_dark() && trace_shadow(tlas, proposal.ray, payload);
        lit.add(proposal, visible);
    }
    radiance[index] += lit.radiance();
}
