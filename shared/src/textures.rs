//! What a hit's indices lead to: coordinates, texels.

use crate::frame::features;
use crate::geometry::{Triangle, VertexAttributes, interpolate};
use crate::material::{Material, MaterialTexels, NO_TEXTURE, slot};
use crate::ray_cone::{Footprint, double_area};
use glam::{UVec2, Vec2, Vec3, Vec4};

/// Reads textures: the hardware's samplers, or a test. Index: of [`Material::textures`], never [`NO_TEXTURE`].
pub trait Texels: Copy {
    /// Texels of the finest level.
    fn size(self, texture: u32) -> UVec2;

    /// The texel at `uv` (glTF's, v down) of mip level `lod`, filtered, linear.
    fn sample(self, texture: u32, uv: Vec2, lod: f32) -> Vec4;
}

/// The triangle with corners a, b, c.
pub fn triangle(positions: &[Vec3], attributes: &[VertexAttributes], [a, b, c]: [usize; 3]) -> Triangle {
    Triangle {
        positions: [positions[a], positions[b], positions[c]],
        attributes: [attributes[a], attributes[b], attributes[c]],
    }
}

/// Both uv sets of a triangle's corners; the second one is the first in scenes that need no more.
pub fn uv_sets(features: u32, first: [Vec2; 3], second: &[Vec2], [a, b, c]: [usize; 3]) -> UvSets {
    if features & features::UV_MAPS == 0 {
        return UvSets { first, second: first };
    }
    UvSets { first, second: [second[a], second[b], second[c]] }
}

/// Coordinates of a triangle's corners.
#[derive(Clone, Copy)]
pub struct UvSets {
    first: [Vec2; 3],
    second: [Vec2; 3],
}

impl UvSets {
    /// At barycentric coordinates `b`: where the material's texture in `slot` is read, and twice the area that it has on
    /// the triangle.
    fn of_slot(&self, features: u32, material: &Material, slot: usize, b: Vec2) -> (Vec2, f32) {
        if features & features::UV_MAPS == 0 {
            return (interpolate(self.first, b), double_area(self.first));
        }
        let map = material.uv_maps[slot];
        let corners = if map.set == 0 { self.first } else { self.second };
        (map.apply(interpolate(corners, b)), double_area(corners) * map.area_scale())
    }
}

/// A place on a triangle whose textures are read.
#[derive(Clone, Copy)]
pub struct Place {
    /// Of its corners.
    pub uvs: UvSets,
    /// Weights of the second and third corner.
    pub barycentrics: Vec2,
    /// [`crate::frame::features`]
    pub features: u32,
}

impl Place {
    /// The texel of the material's texture in `slot` at the level that `footprint` sees; white where it has none.
    fn texel(&self, textures: impl Texels, material: &Material, slot: usize, footprint: Footprint) -> Vec4 {
        let index = material.textures[slot];
        if index == NO_TEXTURE {
            return Vec4::ONE;
        }
        let (uv, area) = self.uvs.of_slot(self.features, material, slot, self.barycentrics);
        textures.sample(index, uv, footprint.lod(textures.size(index), area))
    }

    /// All that the material reads.
    pub fn texels(&self, textures: impl Texels, material: &Material, footprint: Footprint) -> MaterialTexels {
        if self.features & features::TEXTURES == 0 {
            return MaterialTexels::default();
        }
        MaterialTexels {
            base_color: self.texel(textures, material, slot::BASE_COLOR, footprint).truncate(),
            reflectance: self.texel(textures, material, slot::REFLECTANCE, footprint),
            normal: self.texel(textures, material, slot::NORMAL, footprint).truncate(),
            emission: self.texel(textures, material, slot::EMISSIVE, footprint).truncate(),
        }
    }

    /// Alpha of the base color texture, at its finest level: coarser ones would thin a mask out.
    pub fn alpha(&self, textures: impl Texels, material: &Material) -> f32 {
        if self.features & features::TEXTURES == 0 || material.textures[slot::BASE_COLOR] == NO_TEXTURE {
            return 1.0;
        }
        let (uv, _) = self.uvs.of_slot(self.features, material, slot::BASE_COLOR, self.barycentrics);
        textures.sample(material.textures[slot::BASE_COLOR], uv, 0.0).w
    }
}
