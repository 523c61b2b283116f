//! Pass 3 in unbiased mode: merges the history of each surface, with up to two shadow rays: one from the history's pixel to the
//! current sample, one from this pixel to the survivor.

use crate::trace::trace_shadow;
use shared::alias_table::AliasEntry;
use shared::alpha::SURE_HITS_ONLY;
use shared::frame::FrameConstants;
use shared::glam::UVec3;
use shared::interface::ShadowPayload;
use shared::light::{Light, LightTable, Lights};
use shared::resampling::{Pixels, initial, reservoir_index, temporal};
use shared::reservoir::StoredReservoir;
use shared::rng::{Rng, Stream};
use shared::surface::GBufferTexel;
use spirv_std::ray_tracing::AccelerationStructure;
use spirv_std::spirv;

#[spirv(ray_generation(entry_point_name = "temporal_unbiased"))]
pub fn temporal_unbiased(
    #[spirv(launch_id)] launch: UVec3,
    #[spirv(spec_constant(id = 0, default = 0))] features: u32,
    #[spirv(descriptor_set = 0, binding = 0)] tlas: &AccelerationStructure,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] lights: &[Light],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 7)] alias: &[AliasEntry],
    #[spirv(uniform, descriptor_set = 1, binding = 0)] frame: &FrameConstants,
    #[spirv(storage_buffer, descriptor_set = 1, binding = 1)] gbuffer: &[GBufferTexel],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 2)] previous_gbuffer: &[GBufferTexel],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 4)] reservoirs: &mut [StoredReservoir],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 5)] history: &[StoredReservoir],
    #[spirv(ray_payload)] payload: &mut ShadowPayload,
) {
    let (pixel, lane) = (launch.truncate(), launch.z);
    let texel = gbuffer[frame.pixel_index(pixel) as usize];
    if texel.is_empty() {
        return;
    }
    let index = reservoir_index(frame, pixel, lane) as usize;
    let surface = texel.unpack(&frame.camera, pixel, frame.size);
    let lights = LightTable { lights: Lights { lights, features }, alias };
    let previous = Pixels { gbuffer: previous_gbuffer, reservoirs: history };
    let current = reservoirs[index];
    let Some(proposal) = temporal::propose(frame, lights, &surface, current, previous, lane) else {
        return;
    };
    let asks = frame.settings.visibility_is_known();
    let visible =
        !asks || proposal.is_certain() || trace_shadow(tlas, features, proposal.ray, SURE_HITS_ONLY, payload);
    let mut rng = Rng::new(pixel, frame.index, frame.seed, Stream::Temporal, lane);
    let merged = temporal::accept(lights, &surface, current, proposal, visible, &mut rng);
    let visible =
        !asks || merged.is_certain() || trace_shadow(tlas, features, merged.ray, SURE_HITS_ONLY, payload);
    reservoirs[index] = initial::accept(merged, visible);
}
