//! Materials: glTF 2.0 parameters as the GPU reads them, and what is left of them at one point.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// Stands for "no texture" in [`Material`].
pub const NO_TEXTURE: u32 = u32::MAX;

/// glTF metallic-roughness parameters. 64 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Material {
    /// Linear RGB, 0..=1; times the texture and the vertex color.
    pub base_color: Vec3,
    /// 0..=1; times the blue channel of its texture.
    pub metallic: f32,
    /// Radiance, nit, linear RGB; times the texture.
    pub emission: Vec3,
    /// 0..=1; times the green channel of its texture.
    pub roughness: f32,
    /// Indices into the texture array, or [`NO_TEXTURE`].
    pub base_color_texture: u32,
    pub metallic_roughness_texture: u32,
    pub normal_texture: u32,
    pub emissive_texture: u32,
    /// Scale of the normal map's x and y.
    pub normal_scale: f32,
    /// 1: the back emits and is lit too.
    pub double_sided: u32,
    pub padding: [u32; 2],
}

/// Reflectance at one point of a surface: all that the BSDF needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reflectance {
    /// Albedo of the diffuse lobe.
    pub diffuse: Vec3,
    /// Specular reflectance at normal incidence.
    pub f0: Vec3,
    /// Perceptual roughness, 0..=1.
    pub roughness: f32,
}

/// Specular reflectance of a dielectric with index of refraction 1.5 (glTF 2.0, appendix B.2.2).
const DIELECTRIC_F0: f32 = 0.04;

impl Reflectance {
    /// From glTF's metallic-roughness parameters (appendix B.3.5: c_diff and f0).
    pub fn from_metallic_roughness(base_color: Vec3, metallic: f32, roughness: f32) -> Self {
        Reflectance {
            diffuse: base_color * (1.0 - metallic),
            f0: Vec3::splat(DIELECTRIC_F0).lerp(base_color, metallic),
            roughness,
        }
    }
}

/// Values of a material's textures at one point; white where it has none. Linear, 0..=1.
#[derive(Clone, Copy, Debug)]
pub struct MaterialTexels {
    pub base_color: Vec3,
    /// Green: roughness, blue: metallic.
    pub metallic_roughness: Vec3,
    pub normal: Vec3,
    pub emission: Vec3,
}

impl Default for MaterialTexels {
    fn default() -> Self {
        let white = Vec3::ONE;
        MaterialTexels { base_color: white, metallic_roughness: white, normal: white, emission: white }
    }
}

impl Material {
    /// The reflectance where the textures read `texels` and the vertices have `color`.
    pub fn reflectance(&self, texels: &MaterialTexels, color: Vec3) -> Reflectance {
        let base_color = self.base_color * texels.base_color * color;
        let metallic = self.metallic * texels.metallic_roughness.z;
        Reflectance::from_metallic_roughness(
            base_color,
            metallic,
            self.roughness * texels.metallic_roughness.y,
        )
    }
}
