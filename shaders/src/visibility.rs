//! Pass 0 of frames that are not traced from the eye: which triangle each pixel sees, drawn by the graphics pipeline.

use crate::hit::Transparency;
use crate::textures::Textures;
use shared::alpha;
use shared::frame::FrameConstants;
use shared::geometry::{InstanceGeometry, VertexAttributes};
use shared::glam::{UVec2, Vec2, Vec3, Vec4, Vec4Swizzles};
use shared::material::Material;
use shared::raster;
use spirv_std::arch::kill;
use spirv_std::spirv;

/// A corner of an opaque triangle: the draw's first instance is the geometry, and vertices are counted through its triangles.
#[spirv(vertex(entry_point_name = "visibility_vertex"))]
pub fn visibility_vertex(
    #[spirv(vertex_index)] vertex: u32,
    #[spirv(instance_index)] instance: u32,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] instances: &[InstanceGeometry],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] positions: &[Vec3],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] indices: &[u32],
    #[spirv(uniform, descriptor_set = 1, binding = 0)] frame: &FrameConstants,
    #[spirv(position)] place: &mut Vec4,
    #[spirv(flat)] triangle: &mut UVec2,
) {
    let geometry = instances[instance as usize];
    let corner = raster::Corner::new(&geometry, vertex);
    let position = positions[(geometry.first_vertex + indices[corner.index(&geometry) as usize]) as usize];
    *place = geometry.clip(&frame.camera, position);
    *triangle = raster::stored(instance, corner.primitive);
}

/// A corner of a masked or blended triangle.
#[spirv(vertex(entry_point_name = "visibility_alpha_vertex"))]
pub fn visibility_alpha_vertex(
    #[spirv(vertex_index)] vertex: u32,
    #[spirv(instance_index)] instance: u32,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] instances: &[InstanceGeometry],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] positions: &[Vec3],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] indices: &[u32],
    #[spirv(uniform, descriptor_set = 1, binding = 0)] frame: &FrameConstants,
    #[spirv(position)] place: &mut Vec4,
    #[spirv(flat)] triangle: &mut UVec2,
    barycentrics: &mut Vec2,
) {
    visibility_vertex(vertex, instance, instances, positions, indices, frame, place, triangle);
    *barycentrics = raster::Corner::new(&instances[instance as usize], vertex).barycentrics();
}

/// A pixel of an opaque triangle.
#[spirv(fragment(entry_point_name = "visibility"))]
pub fn visibility(#[spirv(flat)] triangle: UVec2, seen: &mut UVec2) {
    *seen = triangle;
}

/// A pixel of a masked or blended triangle, which the pixel's ray may go through.
#[spirv(fragment(entry_point_name = "visibility_alpha"))]
pub fn visibility_alpha(
    #[spirv(flat)] triangle: UVec2,
    barycentrics: Vec2,
    #[spirv(frag_coord)] place: Vec4,
    #[spirv(spec_constant(id = 0, default = 0))] features: u32,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] instances: &[InstanceGeometry],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] attributes: &[VertexAttributes],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] indices: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 5)] materials: &[Material],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 8)] second_uvs: &[Vec2],
    #[spirv(descriptor_set = 0, binding = 10)] textures: &Textures,
    #[spirv(uniform, descriptor_set = 1, binding = 0)] frame: &FrameConstants,
    seen: &mut UVec2,
) {
    let scene = Transparency { features, instances, attributes, indices, materials, second_uvs };
    let key = alpha::primary_key(frame, place.xy().as_uvec2());
    if let Some((instance, primitive)) = raster::triangle(triangle)
        && scene.lets_through(textures, instance, primitive, barycentrics, key)
    {
        kill();
    }
    *seen = triangle;
}
