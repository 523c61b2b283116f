//! Pass 4 in unbiased mode, in pairs, repeated: what each pixel makes of its partner's sample, with at most one shadow ray.

use crate::trace::trace_shadow;
use shared::alias_table::AliasEntry;
use shared::alpha::SURE_HITS_ONLY;
use shared::frame::FrameConstants;
use shared::glam::UVec3;
use shared::interface::{PassConstants, ShadowPayload};
use shared::light::{Light, LightTable, Lights};
use shared::resampling::pairs::{self, PairTargets};
use shared::resampling::{Pixels, reservoir_index};
use shared::reservoir::StoredReservoir;
use shared::surface::GBufferTexel;
use spirv_std::ray_tracing::AccelerationStructure;
use spirv_std::spirv;

#[spirv(ray_generation(entry_point_name = "pair_targets"))]
pub fn pair_targets(
    #[spirv(launch_id)] launch: UVec3,
    #[spirv(push_constant)] constants: &PassConstants,
    #[spirv(spec_constant(id = 0, default = 0))] features: u32,
    #[spirv(descriptor_set = 0, binding = 0)] tlas: &AccelerationStructure,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] lights: &[Light],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 7)] alias: &[AliasEntry],
    #[spirv(uniform, descriptor_set = 1, binding = 0)] frame: &FrameConstants,
    #[spirv(storage_buffer, descriptor_set = 1, binding = 1)] gbuffer: &[GBufferTexel],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 3)] reservoirs: &[StoredReservoir],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 16)] targets: &mut [PairTargets],
    #[spirv(ray_payload)] payload: &mut ShadowPayload,
) {
    let (pixel, lane) = (launch.truncate(), launch.z);
    let texel = gbuffer[frame.pixel_index(pixel) as usize];
    let surface = texel.unpack(&frame.camera, pixel, frame.size);
    let lights = LightTable { lights: Lights { lights, features }, alias };
    let pixels = Pixels { gbuffer, reservoirs };
    let repetition = lane + frame.settings.reservoirs * constants.iteration;
    let proposal = pairs::propose(frame, lights, &surface, pixels, pixel, lane, repetition);
    let visible = proposal.is_certain()
        || !frame.settings.visibility_is_known()
        || trace_shadow(tlas, features, proposal.ray, SURE_HITS_ONLY, payload);
    targets[reservoir_index(frame, pixel, lane) as usize] = pairs::accept(proposal, visible);
}
