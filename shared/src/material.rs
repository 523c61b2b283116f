//! Materials: glTF 2.0 parameters as the GPU reads them, and what is left of them at one point.

use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3, Vec4};

/// Stands for "no texture" in [`Material`].
pub const NO_TEXTURE: u32 = u32::MAX;

/// Luminance that a white unlit surface shows, nit: the reference white of displays (ITU-R BT.1886), and about that of
/// white paper in an office's light.
pub const UNLIT_WHITE: f32 = 100.0;

/// Bits of [`Material::flags`].
pub mod flag {
    /// The back emits and is lit too.
    pub const DOUBLE_SIDED: u32 = 1;
    /// KHR_materials_pbrSpecularGlossiness, else metallic-roughness.
    pub const SPECULAR_GLOSSINESS: u32 = 2;
    /// KHR_materials_unlit: shows its base color and reflects nothing.
    pub const UNLIT: u32 = 4;
    /// A hit counts where alpha reaches the cutoff.
    pub const MASK: u32 = 8;
    /// A hit counts with probability alpha.
    pub const BLEND: u32 = 16;
}

/// Textures of a material, as indices into [`Material::textures`] and [`Material::uv_maps`].
pub mod slot {
    /// Base color and alpha.
    pub const BASE_COLOR: usize = 0;
    /// Metallic-roughness or specular-glossiness.
    pub const REFLECTANCE: usize = 1;
    /// Tangent-space normals.
    pub const NORMAL: usize = 2;
    /// Factor on the emission.
    pub const EMISSIVE: usize = 3;
    /// How many there are.
    pub const COUNT: usize = 4;
}

/// Vertex uv -> texture uv: (u', v') = (u . (uv, 1), v . (uv, 1)) (KHR_texture_transform), from one of the two uv sets
/// of a vertex. 28 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct UvMap {
    /// Row of u'.
    pub u: Vec3,
    /// Row of v'.
    pub v: Vec3,
    /// 0 or 1
    pub set: u32,
}

impl Default for UvMap {
    fn default() -> Self {
        UvMap { u: Vec3::X, v: Vec3::Y, set: 0 }
    }
}

impl UvMap {
    /// The uv of the texture for that of the vertex.
    pub fn apply(&self, uv: Vec2) -> Vec2 {
        Vec2::new(self.u.dot(uv.extend(1.0)), self.v.dot(uv.extend(1.0)))
    }

    /// Texture area of a unit of vertex uv area.
    pub fn area_scale(&self) -> f32 {
        (self.u.x * self.v.y - self.u.y * self.v.x).abs()
    }
}

/// glTF's material parameters: metallic-roughness, or specular-glossiness by its flag. 188 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Material {
    /// Linear RGB, 0..=1; times the texture and the vertex color. Of specular-glossiness: the diffuse color.
    pub base_color: Vec3,
    /// 0..=1; times the alpha of the same two.
    pub alpha: f32,
    /// Radiance, nit, linear RGB; times the texture.
    pub emission: Vec3,
    /// 0..=1; times the blue channel of its texture.
    pub metallic: f32,
    /// Reflectance at normal incidence: of what is no metal, or, of specular-glossiness, times the texture's RGB.
    pub specular: Vec3,
    /// 0..=1; times the green channel of its texture. Of specular-glossiness: 1 - glossiness.
    pub roughness: f32,
    /// Scale of the normal map's x and y.
    pub normal_scale: f32,
    /// Of [`flag::MASK`].
    pub alpha_cutoff: f32,
    /// Bits of [`flag`].
    pub flags: u32,
    /// By [`slot`]: indices into the texture array, or [`NO_TEXTURE`].
    pub textures: [u32; slot::COUNT],
    /// By [`slot`].
    pub uv_maps: [UvMap; slot::COUNT],
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
pub const DIELECTRIC_F0: f32 = 0.04;

/// Specular reflectance at normal incidence of a dielectric in air (KHR_materials_ior: 0 stands for a mirror).
pub fn f0_of_ior(ior: f32) -> f32 {
    if ior == 0.0 {
        return 1.0;
    }
    let ratio = (ior - 1.0) / (ior + 1.0);
    ratio * ratio
}

impl Reflectance {
    /// From glTF's metallic-roughness parameters (appendix B.3.5: c_diff and f0).
    pub fn from_metallic_roughness(base_color: Vec3, metallic: f32, roughness: f32) -> Self {
        Self::from_metallic(base_color, metallic, roughness, Vec3::splat(DIELECTRIC_F0))
    }

    /// As [`Reflectance::from_metallic_roughness`], for a dielectric that reflects `dielectric_f0`.
    pub fn from_metallic(base_color: Vec3, metallic: f32, roughness: f32, dielectric_f0: Vec3) -> Self {
        Reflectance {
            diffuse: base_color * (1.0 - metallic),
            f0: dielectric_f0.lerp(base_color, metallic),
            roughness,
        }
    }

    /// From KHR_materials_pbrSpecularGlossiness: c_diff = diffuse (1 - max(specular)), F0 = specular.
    pub fn from_specular_glossiness(diffuse: Vec3, specular: Vec3, roughness: f32) -> Self {
        Reflectance { diffuse: diffuse * (1.0 - specular.max_element()), f0: specular, roughness }
    }
}

/// Values of a material's textures at one point; white where it has none. Linear, 0..=1.
#[derive(Clone, Copy, Debug)]
pub struct MaterialTexels {
    /// Factor on the base color.
    pub base_color: Vec3,
    /// Green: roughness, blue: metallic. Or RGB: specular, alpha: glossiness.
    pub reflectance: Vec4,
    /// Tangent space, from 0 to 1.
    pub normal: Vec3,
    /// Factor on the emission.
    pub emission: Vec3,
}

impl Default for MaterialTexels {
    fn default() -> Self {
        let white = Vec3::ONE;
        MaterialTexels { base_color: white, reflectance: Vec4::ONE, normal: white, emission: white }
    }
}

impl Material {
    /// Is `flag`, one of [`flag`], set?
    pub fn has(&self, flag: u32) -> bool {
        self.flags & flag != 0
    }

    /// The base color where the textures read `texels` and the vertices have `color`.
    pub fn base_color(&self, texels: &MaterialTexels, color: Vec3) -> Vec3 {
        self.base_color * texels.base_color * color
    }

    /// The reflectance where the textures read `texels` and the vertices have `color`.
    pub fn reflectance(&self, texels: &MaterialTexels, color: Vec3) -> Reflectance {
        let base_color = self.base_color(texels, color);
        let texel = texels.reflectance;
        if self.has(flag::SPECULAR_GLOSSINESS) {
            let roughness = 1.0 - (1.0 - self.roughness) * texel.w;
            return Reflectance::from_specular_glossiness(
                base_color,
                self.specular * texel.truncate(),
                roughness,
            );
        }
        let (metallic, roughness) = (self.metallic * texel.z, self.roughness * texel.y);
        Reflectance::from_metallic(base_color, metallic, roughness, self.specular)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f32::consts::FRAC_PI_2;

    fn material(flags: u32) -> Material {
        Material {
            base_color: Vec3::new(0.8, 0.4, 0.2),
            specular: Vec3::splat(0.04),
            roughness: 0.25,
            metallic: 1.0,
            flags,
            ..Material::zeroed()
        }
    }

    /// A metal is a specular color over a black body, a dielectric a diffuse color under 4 %: both workflows can say so.
    #[test]
    fn twins_of_both_workflows_agree() {
        let texels = MaterialTexels {
            reflectance: Vec4::new(1.0, 0.5, 0.0, 1.0),
            base_color: Vec3::new(0.5, 1.0, 0.25),
            ..MaterialTexels::default()
        };
        let dielectric = material(0).reflectance(&texels, Vec3::ONE);
        assert_eq!((dielectric.f0, dielectric.roughness), (Vec3::splat(0.04), 0.125));
        let twin = Material {
            base_color: dielectric.diffuse / (1.0 - 0.04),
            roughness: 0.125,
            ..material(flag::SPECULAR_GLOSSINESS)
        };
        let twin = twin.reflectance(&MaterialTexels::default(), Vec3::ONE);
        assert!((twin.diffuse - dielectric.diffuse).abs().max_element() < 1e-6);
        assert_eq!((twin.f0, twin.roughness), (dielectric.f0, dielectric.roughness));

        let metal = material(0).reflectance(&MaterialTexels::default(), Vec3::ONE);
        let twin = Material {
            base_color: Vec3::ZERO,
            specular: Vec3::new(1.0, 0.5, 0.25),
            roughness: 0.0,
            ..material(flag::SPECULAR_GLOSSINESS)
        };
        let texels =
            MaterialTexels { reflectance: Vec4::new(0.8, 0.8, 0.8, 0.75), ..MaterialTexels::default() };
        assert_eq!(twin.reflectance(&texels, Vec3::ONE), metal);
    }

    #[test]
    fn refraction_gives_reflection() {
        assert!((f0_of_ior(1.5) - DIELECTRIC_F0).abs() < 1e-7);
        assert!((f0_of_ior(2.0) - 1.0 / 9.0).abs() < 1e-7);
        assert_eq!((f0_of_ior(1.0), f0_of_ior(0.0)), (0.0, 1.0));
    }

    #[test]
    fn maps_move_coordinates() {
        let (sin, cos) = FRAC_PI_2.sin_cos();
        // Twice as large, a quarter turn, moved.
        let map = UvMap {
            u: Vec3::new(2.0 * cos, 2.0 * sin, 0.5),
            v: Vec3::new(-2.0 * sin, 2.0 * cos, 0.0),
            set: 0,
        };
        assert!((map.apply(Vec2::new(0.25, 1.0)) - Vec2::new(2.5, -0.5)).length() < 1e-6);
        assert!((map.area_scale() - 4.0).abs() < 1e-6);
        assert_eq!(UvMap::default().apply(Vec2::new(0.3, 0.7)), Vec2::new(0.3, 0.7));
        assert_eq!(size_of::<Material>(), 188);
    }
}
