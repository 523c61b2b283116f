//! Pass 1: what each pixel sees. Writes the G-buffer, and the radiance that needs no lighting (emission, background).

use crate::trace::trace_primary;
use shared::environment::texel_of;
use shared::frame::FrameConstants;
use shared::geometry::{InstanceGeometry, Triangle, VertexAttributes};
use shared::glam::{UVec3, Vec2, Vec3, Vec4};
use shared::interface::HitPayload;
use shared::material::{Material, MaterialTexels};
use shared::surface::{GBufferTexel, PrimaryHit};
use spirv_std::image::{Image2d, SampledImage};
use spirv_std::ray_tracing::AccelerationStructure;
use spirv_std::{RuntimeArray, spirv};

type Textures = RuntimeArray<SampledImage<Image2d>>;

/// The vertex data of a scene.
#[derive(Clone, Copy)]
struct Vertices<'a> {
    positions: &'a [Vec3],
    attributes: &'a [VertexAttributes],
    indices: &'a [u32],
}

impl Vertices<'_> {
    fn triangle(self, geometry: &InstanceGeometry, primitive: u32) -> Triangle {
        let first = (geometry.first_index + 3 * primitive) as usize;
        let a = (geometry.first_vertex + self.indices[first]) as usize;
        let b = (geometry.first_vertex + self.indices[first + 1]) as usize;
        let c = (geometry.first_vertex + self.indices[first + 2]) as usize;
        Triangle {
            positions: [self.positions[a], self.positions[b], self.positions[c]],
            attributes: [self.attributes[a], self.attributes[b], self.attributes[c]],
        }
    }
}

/// The texel at `uv`, white where the material has no such texture.
fn texel(textures: &Textures, index: u32, uv: Vec2) -> Vec4 {
    if index == shared::material::NO_TEXTURE {
        return Vec4::ONE;
    }
    // SAFETY: the host writes only indices of textures that exist.
    let texture = unsafe { textures.index(index as usize) };
    texture.sample_by_lod(uv, 0.0)
}

fn texels(textures: &Textures, features: u32, material: &Material, uv: Vec2) -> MaterialTexels {
    if features & shared::frame::features::TEXTURES == 0 {
        return MaterialTexels::default();
    }
    MaterialTexels {
        base_color: texel(textures, material.base_color_texture, uv).truncate(),
        metallic_roughness: texel(textures, material.metallic_roughness_texture, uv).truncate(),
        normal: texel(textures, material.normal_texture, uv).truncate(),
        emission: texel(textures, material.emissive_texture, uv).truncate(),
    }
}

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
    #[spirv(storage_buffer, descriptor_set = 0, binding = 8)] environment: &[Vec3],
    #[spirv(descriptor_set = 0, binding = 9)] textures: &Textures,
    #[spirv(uniform, descriptor_set = 1, binding = 0)] frame: &FrameConstants,
    #[spirv(storage_buffer, descriptor_set = 1, binding = 1)] gbuffer: &mut [GBufferTexel],
    #[spirv(storage_buffer, descriptor_set = 1, binding = 6)] radiance: &mut [Vec3],
    #[spirv(ray_payload)] payload: &mut HitPayload,
) {
    let pixel = launch.truncate();
    let index = frame.pixel_index(pixel) as usize;
    let direction = frame.camera.direction(pixel.as_vec2() + 0.5, frame.size);
    trace_primary(tlas, frame.camera.position, direction, payload);
    if payload.hit == 0 {
        gbuffer[index] = GBufferTexel::default();
        radiance[index] = if features & shared::frame::features::ENVIRONMENT != 0 {
            environment[texel_of(direction, frame.environment_size) as usize]
        } else {
            frame.background
        };
        return;
    }
    let geometry = instances[payload.instance as usize];
    let triangle = Vertices { positions, attributes, indices }.triangle(&geometry, payload.primitive);
    let point = geometry.surface_point(triangle, payload.barycentrics);
    let material = materials[geometry.material as usize];
    let texels = texels(textures, features, &material, point.uv);
    let hit = PrimaryHit { point, material, texels, features, instance: payload.instance };
    gbuffer[index] = hit.texel(frame.camera.position);
    radiance[index] = hit.emission(frame.camera.position);
}
