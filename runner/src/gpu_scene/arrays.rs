//! A scene as the flat arrays that the GPU reads; still plain CPU data.

use crate::error::{Error, Result};
use crate::scene::lights::LightTable;
use crate::scene::{Material, Primitive, SceneDescription};
use glam::{Vec3, Vec4};
use shared::frame::features;
use shared::geometry::{InstanceGeometry, NO_LIGHT, VertexAttributes, pack_tangent};
use shared::material::NO_TEXTURE;
use shared::math::pack_direction;

/// Everything that set 0 holds, but for textures and acceleration structures.
#[derive(Debug, Default)]
pub struct SceneArrays {
    pub positions: Vec<Vec3>,
    pub attributes: Vec<VertexAttributes>,
    pub indices: Vec<u32>,
    pub instances: Vec<InstanceGeometry>,
    pub materials: Vec<shared::material::Material>,
    /// For each mesh, its primitives' places in the arrays above.
    pub meshes: Vec<Vec<PrimitiveRange>>,
    /// For each scene instance, the index of its first [`InstanceGeometry`]: the TLAS instance's custom index.
    pub custom_indices: Vec<u32>,
    /// [`shared::frame::features`].
    pub features: u32,
}

/// Where a primitive lies in [`SceneArrays`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PrimitiveRange {
    pub first_vertex: u32,
    pub vertex_count: u32,
    pub first_index: u32,
    pub triangle_count: u32,
}

impl SceneArrays {
    pub fn new(scene: &SceneDescription, lights: &LightTable) -> Result<Self> {
        let mut arrays = SceneArrays { features: features_of(scene), ..Default::default() };
        for mesh in &scene.meshes {
            let ranges = mesh.primitives.iter().map(|p| arrays.add_primitive(p)).collect::<Result<_>>()?;
            arrays.meshes.push(ranges);
        }
        arrays.materials = scene.materials.iter().map(gpu_material).collect();
        for (instance, first_lights) in scene.instances.iter().zip(&lights.first_light) {
            arrays.custom_indices.push(index32(arrays.instances.len())?);
            let primitives = &scene.meshes[instance.mesh].primitives;
            let ranges = &arrays.meshes[instance.mesh];
            for ((primitive, range), first_light) in primitives.iter().zip(ranges).zip(first_lights) {
                arrays.instances.push(InstanceGeometry::new(
                    instance.transform,
                    range.first_index,
                    range.first_vertex,
                    index32(primitive.material)?,
                    first_light.unwrap_or(NO_LIGHT),
                ));
            }
        }
        Ok(arrays)
    }

    fn add_primitive(&mut self, primitive: &Primitive) -> Result<PrimitiveRange> {
        let range = PrimitiveRange {
            first_vertex: index32(self.positions.len())?,
            vertex_count: index32(primitive.positions.len())?,
            first_index: index32(self.indices.len())?,
            triangle_count: index32(primitive.indices.len() / 3)?,
        };
        self.positions.extend_from_slice(&primitive.positions);
        self.indices.extend_from_slice(&primitive.indices);
        self.attributes.extend((0..primitive.positions.len()).map(|i| attributes(primitive, i)));
        index32(self.indices.len())?;
        Ok(range)
    }
}

/// Indices are 32 bits wide on the GPU.
fn index32(n: usize) -> Result<u32> {
    u32::try_from(n)
        .map_err(|_| Error::Usage(format!("the scene has too many elements for 32-bit indices ({n})")))
}

fn attributes(primitive: &Primitive, i: usize) -> VertexAttributes {
    let tangent = primitive.tangents.get(i).copied().unwrap_or(Vec4::new(1.0, 0.0, 0.0, 1.0));
    let color = primitive.colors.get(i).copied().unwrap_or(Vec4::ONE).clamp(Vec4::ZERO, Vec4::ONE);
    let bytes = (color * 255.0 + 0.5).to_array().map(|c| c as u8);
    VertexAttributes {
        normal: pack_direction(primitive.normals.get(i).copied().unwrap_or(Vec3::Y)),
        tangent: pack_tangent(tangent.truncate(), tangent.w),
        uv: primitive.uvs.get(i).copied().unwrap_or_default(),
        color: u32::from_le_bytes(bytes),
    }
}

fn gpu_material(material: &Material) -> shared::material::Material {
    let texture = |index: Option<usize>| index.map_or(NO_TEXTURE, |i| i as u32);
    shared::material::Material {
        base_color: material.base_color.truncate(),
        metallic: material.metallic,
        emission: material.emission,
        roughness: material.roughness,
        base_color_texture: texture(material.base_color_texture),
        metallic_roughness_texture: texture(material.metallic_roughness_texture),
        normal_texture: texture(material.normal_texture),
        emissive_texture: texture(material.emissive_texture),
        normal_scale: material.normal_scale,
        double_sided: material.double_sided.into(),
        padding: [0; 2],
    }
}

/// What the scene's pipelines are specialised for.
fn features_of(scene: &SceneDescription) -> u32 {
    let mut bits = if scene.environment.is_some() { features::ENVIRONMENT } else { 0 };
    for m in &scene.materials {
        let any = [m.base_color_texture, m.metallic_roughness_texture, m.normal_texture, m.emissive_texture];
        bits |= if any.iter().any(Option::is_some) { features::TEXTURES } else { 0 };
        bits |= if m.normal_texture.is_some() { features::NORMAL_MAPS } else { 0 };
    }
    bits
}
