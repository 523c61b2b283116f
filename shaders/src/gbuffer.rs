//! Pass 1: what each pixel sees. Writes the G-buffer, and the radiance that needs no lighting (emission, background).

use crate::textures::{Place, Textures, corners, triangle, uv_sets};
use crate::trace::trace_primary;
use shared::environment::{EnvironmentTexel, texel_of};
use shared::frame::FrameConstants;
use shared::geometry::{InstanceGeometry, VertexAttributes};
use shared::glam::{UVec3, Vec2, Vec3};
use shared::interface::HitPayload;
use shared::material::Material;
use shared::ray_cone::{self, Footprint};
use shared::rng::{Rng, Stream};
use shared::surface::{GBufferTexel, PrimaryHit};
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
    let (eye, direction) = (frame.camera.position, frame.camera.direction(pixel.as_vec2() + 0.5, frame.size));
    let mut rng = Rng::new(pixel, frame.index, frame.seed, Stream::Primary, 0);
    trace_primary(tlas, features, eye, direction, rng.next_u32x4().x, payload);
    if payload.hit == 0 {
        gbuffer[index] = GBufferTexel::default();
        radiance[index] = if features & shared::frame::features::ENVIRONMENT != 0 {
            environment[texel_of(direction, frame.environment_size) as usize].radiance
        } else {
            frame.background
        };
        return;
    }
    let geometry = instances[payload.instance as usize];
    let corners = corners(&geometry, indices, payload.primitive);
    let triangle = triangle(positions, attributes, corners);
    let point = geometry.surface_point(triangle, payload.barycentrics);
    let material = materials[geometry.material as usize];
    let uvs = uv_sets(features, triangle.uvs(), second_uvs, corners);
    let place = Place { uvs, barycentrics: payload.barycentrics, features };
    let footprint = Footprint::new(
        ray_cone::spread(&frame.camera, frame.size),
        (point.position - eye).length(),
        direction,
        point.geometric_normal,
        geometry.double_area(triangle.positions),
    );
    let texels = place.texels(textures, &material, footprint);
    let hit = PrimaryHit { point, material, texels, features, instance: payload.instance };
    gbuffer[index] = hit.texel(eye);
    radiance[index] = hit.emission(eye);
}
