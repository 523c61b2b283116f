//! Pass 4 in unbiased mode, repeated: merges the reservoirs of neighboring pixels, with up to one shadow ray from a neighbor to the
//! canonical sample and one from this pixel to the survivor.

use crate::trace::trace_shadow;
use shared::alias_table::AliasEntry;
use shared::alpha::SURE_HITS_ONLY;
use shared::frame::FrameConstants;
use shared::glam::UVec3;
use shared::interface::{PassConstants, ShadowPayload};
use shared::light::{Light, LightTable, Lights};
use shared::resampling::{Pixels, initial, reservoir_index, spatial};
use shared::reservoir::StoredReservoir;
use shared::rng::{Rng, Stream};
use shared::surface::GBufferTexel;
use spirv_std::ray_tracing::AccelerationStructure;
use spirv_std::spirv;

#[spirv(ray_generation(entry_point_name = "spatial_unbiased"))]
pub fn spatial_unbiased(
    #[spirv(launch_id)] launch: UVec3,
    #[spirv(push_constant)] constants: &PassConstants,
    #[spirv(spec_constant(id = 0, default = 0))] features: u32,
    #[spirv(descriptor_set = 0, binding = 0)] tlas: &AccelerationStructure,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] lights: &[Light],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 7)] alias: &[AliasEntry],
    #[spirv(uniform, descriptor_set = 1, binding = 0)] frame: &FrameConstants,
    #[spirv(storage_buffer, descriptor_set = 1, binding = 1)] gbuffer: &[GBufferTexel],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 3)] reservoirs: &[StoredReservoir],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 4)] merged: &mut [StoredReservoir],
    #[spirv(ray_payload)] payload: &mut ShadowPayload,
) {
    let (pixel, lane) = (launch.truncate(), launch.z);
    let index = reservoir_index(frame, pixel, lane) as usize;
    let texel = gbuffer[frame.pixel_index(pixel) as usize];
    if texel.is_empty() {
        merged[index] = StoredReservoir::default();
        return;
    }
    let surface = texel.unpack(&frame.camera, pixel, frame.size);
    let (lights, pixels) =
        (LightTable { lights: Lights { lights, features }, alias }, Pixels { gbuffer, reservoirs });
    let repetition = lane + frame.settings.reservoirs * constants.iteration;
    let mut rng = Rng::new(pixel, frame.index, frame.seed, Stream::Spatial, repetition);
    let asks = frame.settings.visibility_is_known();
    let proposal = spatial::propose(frame, lights, &surface, pixels, pixel, lane, &mut rng);
    let visible =
        !asks || proposal.is_certain() || trace_shadow(tlas, features, proposal.ray, SURE_HITS_ONLY, payload);
    let proposal = spatial::accept(&surface, lights, proposal, visible, &mut rng);
    let visible =
        !asks || proposal.is_certain() || trace_shadow(tlas, features, proposal.ray, SURE_HITS_ONLY, payload);
    merged[index] = initial::accept(proposal, visible);
}
