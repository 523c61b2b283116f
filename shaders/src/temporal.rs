//! Pass 3: merges the history of each surface.

use shared::alias_table::AliasEntry;
use shared::frame::FrameConstants;
use shared::glam::UVec3;
use shared::light::{Light, LightTable, Lights};
use shared::resampling::{Pixels, reservoir_index, temporal};
use shared::reservoir::StoredReservoir;
use shared::rng::{Rng, Stream};
use shared::surface::GBufferTexel;
use spirv_std::spirv;

#[spirv(compute(threads(32, 4, 1), entry_point_name = "temporal"))]
pub fn temporal(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(spec_constant(id = 0, default = 0))] features: u32,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] lights: &[Light],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 7)] alias: &[AliasEntry],
    #[spirv(uniform, descriptor_set = 1, binding = 0)] frame: &FrameConstants,
    #[spirv(storage_buffer, descriptor_set = 1, binding = 1)] gbuffer: &[GBufferTexel],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 2)] previous_gbuffer: &[GBufferTexel],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 4)] reservoirs: &mut [StoredReservoir],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 5)] history: &[StoredReservoir],
) {
    let (pixel, lane) = (id.truncate(), id.z);
    if pixel.cmpge(frame.size).any() {
        return;
    }
    let texel = gbuffer[frame.pixel_index(pixel) as usize];
    if texel.is_empty() {
        return;
    }
    let index = reservoir_index(frame, pixel, lane) as usize;
    let surface = texel.unpack(&frame.camera, pixel, frame.size);
    let previous = Pixels { gbuffer: previous_gbuffer, reservoirs: history };
    let mut rng = Rng::new(pixel, frame.index, frame.seed, Stream::Temporal, lane);
    let lights = LightTable { lights: Lights { lights, features }, alias };
    reservoirs[index] =
        temporal::biased(frame, lights, &surface, reservoirs[index], previous, lane, &mut rng);
}
