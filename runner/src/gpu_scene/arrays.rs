//! A scene as the flat arrays that the GPU reads; still plain CPU data.

use crate::error::{Error, Result};
use crate::scene::animation::Pose;
use crate::scene::environment::shines;
use crate::scene::lights::{LightTable, is_traceable};
use crate::scene::{AlphaMode, Material, Mesh, Primitive, SceneDescription, Workflow};
use glam::{Affine3A, Vec2, Vec3, Vec4};
use rayon::prelude::*;
use shared::environment::EnvironmentTexel;
use shared::frame::features;
use shared::geometry::{InstanceGeometry, VertexAttributes, edge_bulge, pack_tangent};
use shared::material::{NO_TEXTURE, UvMap, flag};
use shared::math::{pack_direction, unpack_direction};
use shared::motion::NO_LIGHT;
use std::collections::{BTreeSet, HashSet};
use std::ops::Range;

/// Everything that set 0 holds, but for textures and acceleration structures.
#[derive(Debug, Default)]
pub struct SceneArrays {
    pub positions: Vec<Vec3>,
    pub attributes: Vec<VertexAttributes>,
    pub indices: Vec<u32>,
    pub instances: Vec<InstanceGeometry>,
    pub materials: Vec<shared::material::Material>,
    /// `SECOND_UVS`: one a vertex if any texture needs them, else none.
    pub second_uvs: Vec<Vec2>,
    /// Primitives that share a bottom-level structure: those of a mesh, apart by whether rays see their backs.
    pub parts: Vec<Part>,
    /// The instances of the top-level structure.
    pub placements: Vec<Placement>,
    /// [`shared::frame::features`].
    pub features: u32,
    /// Object to world of the scene's instances.
    pub transforms: Vec<Affine3A>,
}

/// Where a primitive lies in [`SceneArrays`], and how rays meet it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PrimitiveRange {
    /// Its index in the mesh.
    pub primitive: usize,
    pub first_vertex: u32,
    pub vertex_count: u32,
    pub first_index: u32,
    pub triangle_count: u32,
    /// No alpha: no any-hit shader runs.
    pub opaque: bool,
}

/// One bottom-level structure; culling is switched an instance at a time, so it is all double-sided or all single-sided.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    pub double_sided: bool,
    pub ranges: Vec<PrimitiveRange>,
}

/// A part in the world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Placement {
    /// Index of the scene's instance.
    pub instance: usize,
    /// Index of the [`Part`].
    pub part: usize,
    /// Index of the [`InstanceGeometry`] of the part's first primitive.
    pub custom_index: u32,
}

impl SceneArrays {
    /// `table`: the scene's lights.
    pub fn new(scene: &SceneDescription, table: &LightTable) -> Result<Self> {
        let mut arrays = SceneArrays { features: features_of(scene, table), ..Default::default() };
        arrays.transforms = scene.instances.iter().map(|instance| instance.transform).collect();
        arrays.materials = scene.materials.iter().map(gpu_material).collect();
        let meshes =
            scene.meshes.iter().map(|mesh| arrays.add_mesh(scene, mesh)).collect::<Result<Vec<_>>>()?;
        for (i, instance) in scene.instances.iter().enumerate() {
            for (part, primitives) in &meshes[instance.mesh] {
                let custom_index = index32(arrays.instances.len())?;
                arrays.placements.push(Placement { instance: i, part: *part, custom_index });
                for (&p, range) in primitives.iter().zip(&arrays.parts[*part].ranges) {
                    arrays.instances.push(InstanceGeometry::new(
                        instance.transform,
                        range.first_index,
                        range.first_vertex,
                        index32(scene.meshes[instance.mesh].primitives[p].material)?,
                    ));
                }
            }
        }
        arrays.set_lights(table);
        // What is flat at first may bend.
        if !scene.hard_terminator && (scene.bends() || arrays.is_smooth()) {
            arrays.features |= features::SMOOTH;
        }
        Ok(arrays)
    }

    /// Does a triangle stand for a curved surface?
    fn is_smooth(&self) -> bool {
        self.parts.par_iter().flat_map(|part| &part.ranges).any(|range| {
            let triangles = |t| -> [usize; 3] {
                let index = |i| self.indices[(range.first_index + 3 * t + i) as usize] + range.first_vertex;
                [0, 1, 2].map(|i| index(i) as usize)
            };
            (0..range.triangle_count).into_par_iter().map(triangles).any(|corners| {
                [(0, 1), (1, 2), (2, 0)].map(|(i, j)| [corners[i], corners[j]]).iter().any(|&[i, j]| {
                    let [a, b] = [i, j].map(|vertex| self.attributes[vertex].normal);
                    let apart = || unpack_direction(b) - unpack_direction(a);
                    a != b && edge_bulge(self.positions[j] - self.positions[i], apart()) != 0.0
                })
            })
        })
    }

    /// Forgets what only the device needs: vertices, indices and materials.
    pub fn without_geometry(self) -> Self {
        let SceneArrays { instances, parts, placements, features, transforms, .. } = self;
        SceneArrays { instances, parts, placements, features, transforms, ..SceneArrays::default() }
    }

    /// The instance geometries of the scene's instance `i`, which lie together.
    pub fn geometries_of(&self, i: usize) -> Range<usize> {
        let first = self.placements.partition_point(|p| p.instance < i);
        let end = self.placements.partition_point(|p| p.instance <= i);
        let at = |p: usize| self.placements.get(p).map_or(self.instances.len(), |p| p.custom_index as usize);
        at(first)..at(end)
    }

    /// Parts of the meshes that `pose` bends, by their instances: index of the mesh, and of the part.
    pub fn bent_parts(&self, scene: &SceneDescription, pose: &Pose) -> BTreeSet<(usize, usize)> {
        let instances: HashSet<usize> = scene.bent_instances(pose).collect();
        let bent = self.placements.iter().filter(|placement| instances.contains(&placement.instance));
        bent.map(|placement| (scene.instances[placement.instance].mesh, placement.part)).collect()
    }

    /// Bends what `pose` bends to the shape that `scene`, to which it was applied, has it in.
    pub fn bend(&mut self, scene: &SceneDescription, pose: &Pose) {
        for (mesh, part) in self.bent_parts(scene, pose) {
            for range in &self.parts[part].ranges {
                let (positions, attributes) = vertices(&scene.meshes[mesh].primitives[range.primitive]);
                let at = range.first_vertex as usize;
                self.positions[at..][..positions.len()].copy_from_slice(positions);
                self.attributes[at..][..attributes.len()].copy_from_slice(&attributes);
            }
        }
    }

    /// Puts the scene's instance `i` at `transform`.
    pub fn place(&mut self, i: usize, transform: Affine3A) {
        self.transforms[i] = transform;
        for geometry in self.geometries_of(i) {
            let InstanceGeometry { first_index, first_vertex, material, first_light, .. } =
                self.instances[geometry];
            let moved = InstanceGeometry::new(transform, first_index, first_vertex, material);
            self.instances[geometry] = InstanceGeometry { first_light, ..moved };
        }
    }

    /// Tells geometries which lights their triangles are.
    pub fn set_lights(&mut self, table: &LightTable) {
        for placement in &self.placements {
            for (i, range) in self.parts[placement.part].ranges.iter().enumerate() {
                let light = table.traceable(placement.instance, range.primitive);
                self.instances[placement.custom_index as usize + i].first_light =
                    light.map_or(NO_LIGHT, |light| light as u32);
            }
        }
    }

    /// Gives each of the mesh's parts, and which of its primitives the part has.
    fn add_mesh(&mut self, scene: &SceneDescription, mesh: &Mesh) -> Result<Vec<(usize, Vec<usize>)>> {
        let material = |p: usize| &scene.materials[mesh.primitives[p].material];
        let mut parts = Vec::new();
        for double_sided in [false, true] {
            let primitives: Vec<usize> =
                (0..mesh.primitives.len()).filter(|&p| material(p).double_sided == double_sided).collect();
            if primitives.is_empty() {
                continue;
            }
            let range = |&p: &usize| self.add_primitive(mesh, p, material(p).alpha == AlphaMode::Opaque);
            let ranges = primitives.iter().map(range).collect::<Result<_>>()?;
            self.parts.push(Part { double_sided, ranges });
            parts.push((self.parts.len() - 1, primitives));
        }
        Ok(parts)
    }

    fn add_primitive(&mut self, mesh: &Mesh, index: usize, opaque: bool) -> Result<PrimitiveRange> {
        let primitive = &mesh.primitives[index];
        let range = PrimitiveRange {
            primitive: index,
            first_vertex: index32(self.positions.len())?,
            vertex_count: index32(primitive.positions.len())?,
            first_index: index32(self.indices.len())?,
            triangle_count: index32(primitive.indices.len() / 3)?,
            opaque,
        };
        let (positions, attributes) = vertices(primitive);
        self.positions.extend_from_slice(positions);
        self.indices.extend_from_slice(&primitive.indices);
        self.attributes.extend(attributes);
        if self.features & features::UV_MAPS != 0 {
            let uv = |i: usize| primitive.second_uvs.get(i).copied().unwrap_or_default();
            self.second_uvs.extend((0..primitive.positions.len()).map(uv));
        }
        index32(self.indices.len())?;
        Ok(range)
    }
}

/// The vertices of a primitive as the GPU has them: positions, attributes.
pub fn vertices(primitive: &Primitive) -> (&[Vec3], Vec<VertexAttributes>) {
    let count = primitive.positions.len();
    (&primitive.positions, (0..count).map(|i| attributes(primitive, i)).collect())
}

/// Indices are 32 bits wide on the GPU.
fn index32(n: usize) -> Result<u32> {
    u32::try_from(n)
        .map_err(|_| Error::Unsupported(format!("the scene has too many elements for 32-bit indices ({n})")))
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
    let mut flags = 0;
    for (bit, is_set) in [
        (flag::DOUBLE_SIDED, material.double_sided),
        (flag::SPECULAR_GLOSSINESS, material.workflow == Workflow::SpecularGlossiness),
        (flag::UNLIT, material.unlit),
        (flag::MASK, matches!(material.alpha, AlphaMode::Mask { .. })),
        (flag::BLEND, material.alpha == AlphaMode::Blend),
    ] {
        flags |= if is_set { bit } else { 0 };
    }
    shared::material::Material {
        base_color: material.base_color.truncate(),
        alpha: material.base_color.w,
        emission: material.emission,
        metallic: material.metallic,
        specular: material.specular,
        roughness: material.roughness,
        normal_scale: material.normal_scale,
        alpha_cutoff: if let AlphaMode::Mask { cutoff } = material.alpha { cutoff } else { 0.0 },
        flags,
        textures: material.textures().map(|index| index.map_or(NO_TEXTURE, |i| i as u32)),
        uv_maps: material.uv_maps,
    }
}

/// An environment map as the GPU has it; empty without one.
pub fn environment_texels(scene: &SceneDescription) -> Vec<EnvironmentTexel> {
    let mut lit = 0..NO_LIGHT;
    let texel = |&radiance: &Vec3| EnvironmentTexel {
        radiance,
        light: if shines(radiance) { lit.next().unwrap_or(NO_LIGHT) } else { NO_LIGHT },
    };
    scene.environment.iter().flat_map(|map| &map.radiance).map(texel).collect()
}

/// What the scene's pipelines are specialised for.
fn features_of(scene: &SceneDescription, lights: &LightTable) -> u32 {
    let mut bits = if scene.environment.is_some() { features::ENVIRONMENT } else { 0 };
    bits |= lights.lights.iter().fold(0, |bits, light| bits | features::light_kind(light.kind));
    let traceable = scene.environment.is_some() || scene.materials.iter().any(is_traceable);
    bits |= if traceable { features::TRACEABLE } else { 0 };
    for m in &scene.materials {
        for (_, map) in m.textures().iter().zip(&m.uv_maps).filter(|(texture, _)| texture.is_some()) {
            bits |= features::TEXTURES;
            bits |= if *map != UvMap::default() { features::UV_MAPS } else { 0 };
        }
        bits |= if m.normal_texture.is_some() { features::NORMAL_MAPS } else { 0 };
        bits |= if m.alpha != AlphaMode::Opaque { features::ALPHA } else { 0 };
    }
    bits
}
