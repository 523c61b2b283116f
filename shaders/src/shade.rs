//! Pass 5: the radiance of each pixel from its reservoirs, one shadow ray each; [`crate::shade_known`] where no ray is needed.

use crate::trace::trace_shadow;
use shared::alias_table::AliasEntry;
use shared::alpha;
use shared::frame::FrameConstants;
use shared::glam::{UVec3, Vec3};
use shared::interface::ShadowPayload;
use shared::light::{Light, LightTable, Lights};
use shared::resampling::reservoir_index;
use shared::reservoir::StoredReservoir;
use shared::rng::{Rng, Stream};
use shared::shading;
use shared::surface::GBufferTexel;
use spirv_std::ray_tracing::AccelerationStructure;
use spirv_std::spirv;

#[spirv(ray_generation(entry_point_name = "shade"))]
pub fn shade(
    #[spirv(launch_id)] launch: UVec3,
    #[spirv(spec_constant(id = 0, default = 0))] features: u32,
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
    let lights = LightTable { lights: Lights { lights, features }, alias };
    let mut rng = Rng::new(pixel, frame.index, frame.seed, Stream::Shade, 0);
    let mut lit = shading::Average::default();
    let mut lane = 0;
    while lane < frame.settings.reservoirs {
        let stored = reservoirs[reservoir_index(frame, pixel, lane) as usize];
        let proposal = shading::propose(&surface, lights, stored);
        let key = alpha::key(rng.next_u32x4().x);
        let visible = !proposal.is_dark() && trace_shadow(tlas, features, proposal.ray, key, payload);
        lit.add(proposal, visible);
        lane += 1;
    }
    radiance[index] += lit.radiance();
}
