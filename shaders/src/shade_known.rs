//! Pass 5 where the reservoirs hold visible samples only: no ray.

use shared::alias_table::AliasEntry;
use shared::frame::FrameConstants;
use shared::glam::{UVec3, Vec3};
use shared::light::{Light, LightTable, Lights};
use shared::resampling::reservoir_index;
use shared::reservoir::StoredReservoir;
use shared::shading;
use shared::surface::GBufferTexel;
use spirv_std::spirv;

#[spirv(compute(threads(32, 4, 1), entry_point_name = "shade_known"))]
pub fn shade_known(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(spec_constant(id = 0, default = 0))] features: u32,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] lights: &[Light],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 7)] alias: &[AliasEntry],
    #[spirv(uniform, descriptor_set = 1, binding = 0)] frame: &FrameConstants,
    #[spirv(storage_buffer, descriptor_set = 1, binding = 1)] gbuffer: &[GBufferTexel],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 3)] reservoirs: &[StoredReservoir],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 6)] radiance: &mut [Vec3],
) {
    let pixel = id.truncate();
    if pixel.cmpge(frame.size).any() {
        return;
    }
    let index = frame.pixel_index(pixel) as usize;
    let texel = gbuffer[index];
    if texel.is_empty() {
        return;
    }
    let surface = texel.unpack(&frame.camera, pixel, frame.size);
    let lights = LightTable { lights: Lights { lights, features }, alias };
    let mut lit = shading::Average::default();
    for lane in 0..frame.settings.reservoirs {
        let stored = reservoirs[reservoir_index(frame, pixel, lane) as usize];
        lit.add(shading::propose(&surface, lights, stored), true);
    }
    radiance[index] += lit.radiance();
}
