//! Pass 4, repeated: merges the reservoirs of neighboring pixels.

use shared::alias_table::AliasEntry;
use shared::frame::FrameConstants;
use shared::glam::UVec3;
use shared::interface::PassConstants;
use shared::light::{Light, LightTable, Lights};
use shared::resampling::{Pixels, reservoir_index, spatial};
use shared::reservoir::StoredReservoir;
use shared::rng::{Rng, Stream};
use shared::surface::GBufferTexel;
use spirv_std::spirv;

#[spirv(compute(threads(32, 4, 1), entry_point_name = "spatial"))]
pub fn spatial(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(push_constant)] constants: &PassConstants,
    #[spirv(spec_constant(id = 0, default = 0))] features: u32,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] lights: &[Light],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 7)] alias: &[AliasEntry],
    #[spirv(uniform, descriptor_set = 1, binding = 0)] frame: &FrameConstants,
    #[spirv(storage_buffer, descriptor_set = 1, binding = 1)] gbuffer: &[GBufferTexel],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 3)] reservoirs: &[StoredReservoir],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 4)] merged: &mut [StoredReservoir],
) {
    let (pixel, lane) = (id.truncate(), id.z);
    if pixel.cmpge(frame.size).any() {
        return;
    }
    let index = reservoir_index(frame, pixel, lane) as usize;
    let texel = gbuffer[frame.pixel_index(pixel) as usize];
    if texel.is_empty() {
        merged[index] = StoredReservoir::default();
        return;
    }
    let surface = texel.unpack(&frame.camera, pixel, frame.size);
    let pixels = Pixels { gbuffer, reservoirs };
    let repetition = lane + frame.settings.reservoirs * constants.iteration;
    let mut rng = Rng::new(pixel, frame.index, frame.seed, Stream::Spatial, repetition);
    let lights = LightTable { lights: Lights { lights, features }, alias };
    merged[index] = spatial::biased(frame, lights, &surface, pixels, pixel, lane, &mut rng);
}
