//! The truth, in place of passes 2 to 5: adds a range of the lights, each with its own shadow ray, to `radiance`.

use crate::trace::trace_shadow;
use shared::alpha;
use shared::frame::FrameConstants;
use shared::glam::{UVec3, Vec3};
use shared::interface::{PassConstants, ShadowPayload};
use shared::light::{Light, Lights};
use shared::reference;
use shared::rng::{Rng, Stream};
use shared::surface::GBufferTexel;
use spirv_std::ray_tracing::AccelerationStructure;
use spirv_std::spirv;

#[spirv(ray_generation(entry_point_name = "reference"))]
pub fn reference(
    #[spirv(launch_id)] launch: UVec3,
    #[spirv(spec_constant(id = 0, default = 0))] features: u32,
    #[spirv(push_constant)] constants: &PassConstants,
    #[spirv(descriptor_set = 0, binding = 0)] tlas: &AccelerationStructure,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] lights: &[Light],
    #[spirv(uniform, descriptor_set = 1, binding = 0)] frame: &FrameConstants,
    #[spirv(storage_buffer, descriptor_set = 1, binding = 1)] gbuffer: &[GBufferTexel],
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
    let mut rng = Rng::new(pixel, frame.index, frame.seed, Stream::Reference, constants.first_light);
    let lights = Lights { lights, features };
    let mut sum = Vec3::ZERO;
    let mut light = constants.first_light;
    while light < constants.first_light + constants.light_count {
        let random = rng.next_u32x4();
        let proposal = reference::propose(&surface, lights, light, random.x);
        let key = alpha::key(random.y);
        if !proposal.is_dark() && trace_shadow(tlas, features, proposal.ray, key, payload) {
            sum += proposal.radiance;
        }
        light += 1;
    }
    radiance[index] += sum;
}
