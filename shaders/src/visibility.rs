//! Pass 0 of frames that are not traced from the eye: which triangle each pixel sees, drawn by the graphics pipeline.

use crate::hit::{Transparency, transparency};
use crate::textures::Textures;
use shared::alpha;
use shared::frame::FrameConstants;
use shared::geometry::{InstanceGeometry, VertexAttributes};
use shared::glam::{UVec2, Vec2, Vec3, Vec4, Vec4Swizzles};
use shared::material::Material;
use shared::raster;
use spirv_std::arch::kill;
use spirv_std::spirv;

/// A vertex shader: the draw's first instance is the geometry, and vertices are counted through its triangles.
macro_rules! vertex {
    ($(#[$doc:meta])* $stem:ident $name:tt ($($barycentrics:ident)?)) => {
        $(#[$doc])*
        #[spirv(vertex(entry_point_name = $name))]
        pub fn $stem(
            #[spirv(vertex_index)] vertex: u32,
            #[spirv(instance_index)] instance: u32,
            #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] instances: &[InstanceGeometry],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] positions: &[Vec3],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] indices: &[u32],
            #[spirv(uniform, descriptor_set = 1, binding = 0)] frame: &FrameConstants,
            #[spirv(position)] place: &mut Vec4,
            #[spirv(flat)] triangle: &mut UVec2,
            $($barycentrics: &mut Vec2,)?
        ) {
            let geometry = instances[instance as usize];
            let corner = raster::Corner::new(&geometry, vertex);
            let index = geometry.first_vertex + indices[corner.index(&geometry) as usize];
            *place = raster::aimed(frame, geometry.clip(&frame.camera, positions[index as usize]));
            *triangle = raster::stored(instance, corner.primitive);
            $(*$barycentrics = corner.barycentrics();)?
        }
    };
}

vertex! {
    /// A corner of an opaque triangle.
    visibility_vertex "visibility_vertex" ()
}
vertex! {
    /// A corner of a masked or blended triangle.
    visibility_alpha_vertex "visibility_alpha_vertex" (barycentrics)
}

/// A pixel of an opaque triangle.
#[spirv(fragment(entry_point_name = "visibility"))]
pub fn visibility(#[spirv(flat)] triangle: UVec2, seen: &mut UVec2) {
    *seen = triangle;
}

transparency! {
    /// A pixel of a masked or blended triangle, which the pixel's ray may go through.
    #[spirv(fragment(entry_point_name = "visibility_alpha"))]
    visibility_alpha(
        #[spirv(flat)] triangle: UVec2,
        barycentrics: Vec2,
        #[spirv(frag_coord)] place: Vec4,
        #[spirv(uniform, descriptor_set = 1, binding = 0)] frame: &FrameConstants,
        seen: &mut UVec2,
    ) |scene, textures| {
        let key = alpha::primary_key(frame, place.xy().as_uvec2());
        if let Some((instance, primitive)) = raster::triangle(triangle)
            && scene.lets_through(textures, instance, primitive, barycentrics, key)
        {
            kill();
        }
        *seen = triangle;
    }
}
