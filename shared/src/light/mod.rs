//! Lights: one [`Light`] for every kind, in world space and photometric units, as the GPU reads it. Each kind has a file, with a
//! view of those 64 bytes; [`kinds`] lists them.

mod arrival;
#[cfg(not(target_arch = "spirv"))]
pub mod count;
pub mod directional;
pub mod disk;
pub mod environment;
pub mod found;
pub mod kinds;
pub mod point;
pub mod rectangle;
#[cfg(test)]
mod sampling_tests;
#[cfg(test)]
mod segment;
pub mod soft_spot;
pub mod sphere;
pub mod spot;
mod table;
#[cfg(test)]
mod tests;
pub mod tile;
pub mod tree;
pub mod triangle;

pub use kinds::kind;
#[cfg(not(target_arch = "spirv"))]
pub use kinds::{KINDS, KindFacts};
#[cfg(not(target_arch = "spirv"))]
pub use table::build_alias_table;
pub use table::{LightSample, LightTable, Lights};

#[cfg(not(target_arch = "spirv"))]
use crate::math::luminance;
use crate::math::safe_ratio;
use crate::pdf::SourcePdf;
use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3};
use kinds::Listed;
#[cfg(not(target_arch = "spirv"))]
use tree::Bound;

/// `Light::flags`: both sides of a triangle emit.
pub const DOUBLE_SIDED: u32 = 1;
/// `Light::flags`: a ray does not know that it found this light (a part of a texture), passes it (a transparent one), or never
/// meets it ([`Kind::TRACEABLE`]).
pub const UNTRACEABLE: u32 = 2;

/// One light: numbers that its kind's view names. 64 bytes, as in memory.
///
/// ```
/// use candela_shared::glam::{Vec2, Vec3};
/// use candela_shared::light::Light;
///
/// // 100 cd, 2 m above the receiver: 25 lx, from 4π 100 lm.
/// let light = Light::point(Vec3::new(0.0, 2.0, 0.0), Vec3::splat(100.0));
/// let incident = light.sample_li(Vec2::ZERO, Vec3::ZERO);
/// assert!((incident.irradiance - Vec3::splat(25.0)).length() < 1e-4);
/// assert!((light.power() - 4.0 * std::f32::consts::PI * 100.0).abs() < 0.1);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Light {
    /// World space, m.
    pub position: Vec3,
    /// One of [`kind`].
    pub kind: u32,
    /// One edge of a surface, m; other kinds have their own use for it.
    pub edge1: Vec3,
    /// [`DOUBLE_SIDED`] and [`UNTRACEABLE`].
    pub flags: u32,
    /// Of light from infinity: x is the radius of the scene's bounding sphere, m.
    pub edge2: Vec3,
    /// Of a surface, m².
    pub area: f32,
    /// Intensity, cd, of a point; radiance, nit, of a surface or of a part of the sky; illuminance, lx, of parallel light.
    /// Linear RGB.
    pub emission: Vec3,
    /// Luminous flux, lm: the weight in the alias table. See [`Light::power`].
    pub power: f32,
}

/// Where the points of a light lie, and with that in which measure: what arrives from them follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Shape {
    /// Points in space, which radiate `emission` cd (or cd a metre).
    Point,
    /// Points of surfaces, which radiate `emission` nit in every direction (Lambertian). Area measure.
    Surface,
    /// Directions: `emission` is in lx, or in nit for those with an extent. Solid angle.
    Infinity,
    /// Points that depend on who looks ([`Kind::seen`]): a sample is a point of the unit square, and its measure that square's.
    Seen,
}

/// A point on a light, whoever looks at it.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// World space, m; of light from infinity the unit direction to it.
    pub position: Vec3,
    /// Of a surface, on the side that emits. Any length; 0 for a surface without area.
    pub normal: Vec3,
    /// Largest number that the position on a surface was computed from, m (see [`crate::math::offset_ray_origin`]).
    pub magnitude: f32,
}

impl Place {
    /// A place without a surface.
    pub fn at(position: Vec3) -> Self {
        Place { position, normal: Vec3::ZERO, magnitude: 0.0 }
    }
}

/// A kind of light: a named view of the 64 bytes of a [`Light`], and what is asked of it.
pub trait Kind: Listed + Copy {
    /// Where its points lie.
    const SHAPE: Shape;
    /// Are there several points to sample?
    const HAS_EXTENT: bool = false;
    /// Does its intensity depend on the direction?
    const ATTENUATES: bool = false;
    /// Does a ray in a random direction find it, and know that it did ([`found::Emitters`])?
    const TRACEABLE: bool = false;

    /// What the numbers of `light` mean.
    fn of(light: &Light) -> Self;

    /// The point for two numbers in (0, 1), uniform in the light's measure; of [`Shape::Seen`] those numbers themselves.
    fn place(self, square: Vec2) -> Place;

    /// Of a light with extent: its area, m², solid angle, sr, or length, m; 1 where points are of the unit square. Points have the
    /// density 1 / measure.
    fn measure(self) -> f32 {
        1.0
    }

    /// Fraction of the intensity that leaves it against `direction` (unit, to the light).
    fn attenuation(self, _direction: Vec3) -> f32 {
        1.0
    }

    /// Of [`Shape::Seen`]: what `receiver` (world space, m) sees of it at a point of the unit square.
    fn seen(self, _square: Vec2, _receiver: Vec3) -> Incident {
        Incident::default()
    }

    /// The inverse of [`Kind::place`], for one that is traceable: the point in `direction` (unit) from `receiver`.
    fn invert(self, _direction: Vec3, _receiver: Vec3) -> Vec2 {
        Vec2::ZERO
    }
}

/// What only the host asks of a kind.
#[cfg(not(target_arch = "spirv"))]
pub trait HostKind: Kind {
    /// One of them is a ..
    const NAME: &'static str;
    /// Several are ..
    const LIGHTS: &'static str;

    /// As a light without a kind or a power: the inverse of [`Kind::of`].
    fn numbers(self) -> Light;

    /// Where it is, and where it shines; none for light from infinity.
    fn bound(self) -> Option<Bound>;

    /// Luminous flux Φ, lm, of a light with an emission of 1 (but for the factor 683 that photometric input already holds).
    /// 0 only for one that lights nothing.
    fn flux_factor(self) -> f32;

    /// As a light.
    fn light(self) -> Light {
        let numbers = self.numbers();
        let found = if Self::TRACEABLE { 0 } else { UNTRACEABLE };
        let light = Light { kind: Self::KIND, flags: numbers.flags | found, ..numbers };
        // An infinite weight would count as none.
        Light { power: light.power().min(f32::MAX), ..light }
    }
}

/// A light sample as seen from a shading point.
#[derive(Clone, Copy, Debug, Default)]
pub struct Incident {
    /// The sampled point, world space, m. Of light from infinity: a point in its direction beyond the scene.
    pub position: Vec3,
    /// Normal of the light there, on the side of the receiver; 0 for lights without a surface.
    pub normal: Vec3,
    /// Largest number the position was computed from (see [`crate::math::offset_ray_origin`]), m.
    pub magnitude: f32,
    /// Unit direction from the receiver to the light.
    pub direction: Vec3,
    /// Distance to it, m.
    pub distance: f32,
    /// What arrives per unit of the light's measure, without the receiver's cosine: Le cosθ'/d² (nit/m²) for an area,
    /// I/d² (lx) for a point, E (lx) from a direction, L (nit) for a solid angle. Linear RGB, unshadowed.
    pub irradiance: Vec3,
    /// Solid angle per unit of the light's measure, as the receiver sees it: cosθ'/d² (sr/m²) for an area, 1 for a solid angle;
    /// 0 for lights that no ray in a random direction can find.
    pub solid_angle: f32,
}

impl Light {
    /// Luminous flux Φ in lm.
    ///
    /// Equation (5): Bitterli section 5; thesis section 5.1.
    #[cfg(not(target_arch = "spirv"))]
    pub fn power(&self) -> f32 {
        self.flux_factor() * luminance(self.emission)
    }

    /// The greatest intensity of a light that is somewhere, cd.
    #[cfg(not(target_arch = "spirv"))]
    pub(crate) fn intensity(&self) -> f64 {
        f64::from(luminance(self.emission)) * f64::from(self.measure(u32::MAX))
    }

    /// Of light from infinity: radius of the scene's bounding sphere, m.
    pub fn scene_radius(&self) -> f32 {
        self.edge2.x
    }

    /// Density of a sample on this light in the light's own measure: 1/area, 1/solid angle, or 1 for a delta light.
    pub fn pdf_li(&self) -> SourcePdf {
        self.pdf_li_among(u32::MAX)
    }

    /// The same where `features` (as in [`Lights`]) says which kinds there are.
    pub fn pdf_li_among(&self, features: u32) -> SourcePdf {
        SourcePdf(safe_ratio(1.0, self.measure(features)))
    }
}
