//! Pass 1: what each pixel sees. Writes the G-buffer, and the radiance that needs no lighting (emission, background).

use crate::primary::{Hit, Scene};
use crate::textures::Textures;
use crate::trace::trace_primary;
use shared::alpha;
use shared::environment::EnvironmentTexel;
use shared::frame::FrameConstants;
use shared::geometry::{InstanceGeometry, VertexAttributes};
use shared::glam::{UVec3, Vec2, Vec3};
use shared::interface::HitPayload;
use shared::material::Material;
use shared::surface::GBufferTexel;
use spirv_std::ray_tracing::AccelerationStructure;
use spirv_std::spirv;

#[spirv(ray_generation(entry_point_name = "gbuffer"))]
pub fn gbuffer(
    #[spirv(launch_id)] launch: UVec3,
    #[spirv(spec_constant(id = 0, default = 0))] features: u32,
    #[spirv(descriptor_set = 0, binding = 0)] tlas: &AccelerationStructure,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] instances: &[InstanceGeometry],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] positions: &[Vec3],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] attributes: &[VertexAttributes],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] indices: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 5)] materials: &[Material],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 8)] second_uvs: &[Vec2],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 9)] environment: &[EnvironmentTexel],
    #[spirv(descriptor_set = 0, binding = 10)] textures: &Textures,
    #[spirv(uniform, descriptor_set = 1, binding = 0)] frame: &FrameConstants,
    #[spirv(storage_buffer, descriptor_set = 1, binding = 1)] gbuffer: &mut [GBufferTexel],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 6)] radiance: &mut [Vec3],
    #[spirv(ray_payload)] payload: &mut HitPayload,
) {
    let pixel = launch.truncate();
    let index = frame.pixel_index(pixel) as usize;
    let direction = frame.camera.direction(pixel.as_vec2() + 0.5, frame.size);
    let scene =
        Scene { features, instances, positions, attributes, indices, materials, second_uvs, environment };
    trace_primary(
        tlas,
        features,
        frame.camera.position,
        direction,
        alpha::primary_key(frame, pixel),
        payload,
    );
    (gbuffer[index], radiance[index]) = if payload.hit == 0 {
        scene.background(frame, direction)
    } else {
        let HitPayload { instance, primitive, barycentrics, .. } = *payload;
        scene.surface(textures, frame, direction, Hit { instance, primitive, barycentrics })
    };
}
