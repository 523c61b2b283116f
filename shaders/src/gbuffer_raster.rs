//! Pass 1 where `visibility` has drawn the scene: what each pixel sees, from the number of its triangle.

use crate::primary::Scene;
use crate::textures::Textures;
use shared::environment::EnvironmentTexel;
use shared::frame::FrameConstants;
use shared::geometry::{InstanceGeometry, VertexAttributes};
use shared::glam::{UVec2, UVec3, Vec2, Vec3};
use shared::material::Material;
use shared::raster;
use shared::surface::GBufferTexel;
use spirv_std::spirv;

#[spirv(compute(threads(32, 4, 1), entry_point_name = "gbuffer_raster"))]
pub fn gbuffer_raster(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(spec_constant(id = 0, default = 0))] features: u32,
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
    #[spirv(storage_buffer, descriptor_set = 1, binding = 15)] visibility: &[UVec2],
) {
    let pixel = id.truncate();
    if pixel.cmpge(frame.size).any() {
        return;
    }
    let index = frame.pixel_index(pixel) as usize;
    let direction = frame.camera.direction(pixel.as_vec2() + 0.5, frame.size);
    let scene =
        Scene { features, instances, positions, attributes, indices, materials, second_uvs, environment };
    (gbuffer[index], radiance[index]) = match raster::triangle(visibility[index]) {
        None => scene.background(frame, direction),
        Some((instance, primitive)) => {
            scene.surface(textures, frame, direction, scene.hit(frame, direction, instance, primitive))
        }
    };
}
