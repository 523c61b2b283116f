//! Pass 3 in unbiased mode after something moved: as `temporal_unbiased`, but the ray from the history's pixel to the current
//! sample runs among the things of the previous frame.

use crate::trace::trace_shadow;
use shared::alias_table::AliasEntry;
use shared::alpha::SURE_HITS_ONLY;
use shared::frame::FrameConstants;
use shared::glam::UVec3;
use shared::interface::ShadowPayload;
use shared::light::{Light, LightTable, Lights};
use shared::motion::{InstanceMotion, PastLights};
use shared::resampling::{Pixels, initial, moving, reservoir_index, temporal};
use shared::reservoir::StoredReservoir;
use shared::rng::{Rng, Stream};
use shared::surface::GBufferTexel;
use spirv_std::ray_tracing::AccelerationStructure;
use spirv_std::spirv;

#[spirv(ray_generation(entry_point_name = "temporal_unbiased_moving"))]
pub fn temporal_unbiased_moving(
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
    #[spirv(descriptor_set = 2, binding = 0)] past_tlas: &AccelerationStructure,
    #[spirv(storage_buffer, descriptor_set = 2, binding = 1)] past_lights: &[Light],
    #[spirv(storage_buffer, descriptor_set = 2, binding = 2)] motions: &[InstanceMotion],
    #[spirv(storage_buffer, descriptor_set = 2, binding = 3)] previous_to_current: &[u32],
    #[spirv(storage_buffer, descriptor_set = 2, binding = 4)] current_to_previous: &[u32],
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
    let past = PastLights {
        lights: Lights { lights: past_lights, features },
        previous_to_current,
        current_to_previous,
    };
    let motion = motions[texel.instance as usize];
    let previous = Pixels { gbuffer: previous_gbuffer, reservoirs: history };
    let current = reservoirs[index];
    let found = moving::propose(frame, lights, past, &surface, &motion, current, previous, lane);
    let Some(proposal) = found else {
        return;
    };
    let asks = frame.settings.visibility_is_known();
    let visible = !asks
        || proposal.is_certain()
        || trace_shadow(past_tlas, features, proposal.ray, SURE_HITS_ONLY, payload);
    let mut rng = Rng::new(pixel, frame.index, frame.seed, Stream::Temporal, lane);
    let merged = temporal::accept(lights, &surface, current, proposal, visible, &mut rng);
    let visible =
        !asks || merged.is_certain() || trace_shadow(tlas, features, merged.ray, SURE_HITS_ONLY, payload);
    reservoirs[index] = initial::accept(merged, visible);
}
