//! Lights: one `Light` for every kind, in world space and photometric units, as the GPU reads it.

pub mod found;
#[cfg(test)]
mod sampling_tests;
mod table;
#[cfg(test)]
mod tests;
pub mod tile;

#[cfg(not(target_arch = "spirv"))]
pub use table::build_alias_table;
pub use table::{LightSample, LightTable, Lights};

use crate::environment;
use crate::frame::features;
#[cfg(not(target_arch = "spirv"))]
use crate::math::luminance;
use crate::math::{cross, inverse_sqrt, normalize_or, safe_ratio};
use crate::pdf::SourcePdf;
use crate::sampling::{square_to_triangle, triangle_pdf, triangle_to_square};
use bytemuck::{Pod, Zeroable};
#[cfg(not(target_arch = "spirv"))]
use core::f32::consts::PI;
#[cfg(not(target_arch = "spirv"))]
use glam::{DVec3, UVec2};
use glam::{Vec2, Vec3};

/// `Light::kind`.
pub mod kind {
    /// A point that radiates `emission` candela in every direction.
    pub const POINT: u32 = 0;
    /// A triangle whose every point radiates `emission` nit (Lambertian).
    pub const TRIANGLE: u32 = 1;
    /// A point that radiates `emission` candela along its axis, and less around it (KHR_lights_punctual).
    pub const SPOT: u32 = 2;
    /// Parallel light of `emission` lux on a surface that faces it.
    pub const DIRECTIONAL: u32 = 3;
    /// A texel of an environment map: `emission` nit from every direction in it.
    pub const ENVIRONMENT: u32 = 4;
}

/// `Light::flags`: both sides of a triangle emit.
pub const DOUBLE_SIDED: u32 = 1;
/// `Light::flags`: a ray that ends on the triangle does not know that it found this light (a part of a texture), or passes it
/// (a transparent one).
pub const UNTRACEABLE: u32 = 2;

/// How far light from infinity is followed, in radii of the scene: from any point of the bounding sphere to beyond it.
const REACH: f32 = 2.01;

/// One light. 64 bytes, as in memory.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Light {
    /// Point, spot: its position. Triangle: its first vertex. World space, m.
    pub position: Vec3,
    /// One of [`kind`].
    pub kind: u32,
    /// Triangle: second vertex - first vertex, m. Spot: unit direction it shines in. Directional: unit direction to it.
    /// Environment: (φ of its left edge, cosθ of its lower edge, 0).
    pub edge1: Vec3,
    /// [`DOUBLE_SIDED`] and [`UNTRACEABLE`].
    pub flags: u32,
    /// Triangle: third vertex - first vertex, m. Spot: (cosine of the outer angle, 1 / (cosine of the inner angle - that),
    /// 0). Directional, environment: (radius of the scene's bounding sphere, m, width in φ, height in cosθ).
    pub edge2: Vec3,
    /// Triangle: its area, m². Environment: its solid angle, sr. Computed in f64 by the host.
    pub area: f32,
    /// Point, spot: intensity, cd. Triangle: radiance, nit. Directional: illuminance, lx.
    /// Environment: radiance, nit. Linear RGB.
    pub emission: Vec3,
    /// Luminous flux, lm: the weight in the alias table. See [`Light::power`].
    pub power: f32,
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

#[cfg(not(target_arch = "spirv"))]
impl Light {
    /// A point light. `position` in m, `intensity` in cd.
    pub fn point(position: Vec3, intensity: Vec3) -> Self {
        Light { position, kind: kind::POINT, emission: intensity, ..Zeroable::zeroed() }.with_power()
    }

    /// An emissive triangle. Vertices in m, counter-clockwise seen from the side that emits; `radiance` in nit.
    pub fn triangle(vertices: [Vec3; 3], radiance: Vec3, double_sided: bool) -> Self {
        let [a, b, c] = vertices;
        Self::triangle_between(a, [b - a, c - a].map(Vec3::as_dvec3), radiance, double_sided)
    }

    /// As [`Light::triangle`], by its first vertex and the edges from there to the second and third, m.
    pub fn triangle_between(first: Vec3, edges: [DVec3; 2], radiance: Vec3, double_sided: bool) -> Self {
        Light {
            position: first,
            kind: kind::TRIANGLE,
            edge1: edges[0].as_vec3(),
            flags: if double_sided { DOUBLE_SIDED } else { 0 },
            edge2: edges[1].as_vec3(),
            area: (0.5 * edges[0].cross(edges[1]).length()) as f32,
            emission: radiance,
            power: 0.0,
        }
        .with_power()
    }

    /// A spot light that shines along `axis` (unit). `intensity` on the axis in cd; it is full up to `inner` rad from the
    /// axis and 0 from `outer` on (KHR_lights_punctual, "Inner and Outer Cone Angles").
    pub fn spot(position: Vec3, axis: Vec3, intensity: Vec3, inner: f32, outer: f32) -> Self {
        let [cos_inner, cos_outer] = [inner, outer].map(|angle| f64::from(angle).cos());
        // 0.001: the extension's own guard.
        let edge2 = Vec3::new(cos_outer as f32, (1.0 / (cos_inner - cos_outer).max(0.001)) as f32, 0.0);
        let light = Light { position, kind: kind::SPOT, edge1: axis, edge2, ..Zeroable::zeroed() };
        Light { emission: intensity, ..light }.with_power()
    }

    /// Parallel light from `direction` (unit, toward the light) on a scene with a bounding sphere of `radius` m.
    /// `illuminance` in lx on a surface that faces it.
    pub fn directional(direction: Vec3, illuminance: Vec3, radius: f32) -> Self {
        let edge2 = Vec3::new(radius, 0.0, 0.0);
        let light = Light { kind: kind::DIRECTIONAL, edge1: direction, edge2, ..Zeroable::zeroed() };
        Light { emission: illuminance, ..light }.with_power()
    }

    /// Texel `texel` (column, row from the top) of an environment map of `size`, its mean `radiance` in nit, for a scene
    /// with a bounding sphere of `radius` m. See [`crate::environment`].
    pub fn environment(texel: UVec2, size: UVec2, radiance: Vec3, radius: f32) -> Self {
        use core::f64::consts::{PI, TAU};
        let cos = |row: u32| (PI * f64::from(row) / f64::from(size.y)).cos();
        let (width, height) = (TAU / f64::from(size.x), cos(texel.y) - cos(texel.y + 1));
        let left = f64::from(texel.x) * width - PI;
        Light {
            kind: kind::ENVIRONMENT,
            edge1: Vec3::new(left as f32, cos(texel.y + 1) as f32, 0.0),
            edge2: Vec3::new(radius, width as f32, height as f32),
            area: (width * height) as f32,
            emission: radiance,
            ..Zeroable::zeroed()
        }
        .with_power()
    }

    fn with_power(mut self) -> Self {
        // An infinite weight would count as none.
        self.power = self.power().min(f32::MAX);
        self
    }

    /// Luminous flux Φ in lm (but for the factor 683 that photometric input already holds).
    /// Point: 4π I. Triangle: π L A a side (Lambertian emitter). Spot: see [`Light::spot_solid_angle`].
    /// Directional: E π r², what falls into the scene's bounding sphere. Environment: L Ω π r².
    ///
    /// Equation (5): Bitterli section 5; thesis section 5.1.
    pub fn power(&self) -> f32 {
        let sides = if self.flags & DOUBLE_SIDED != 0 { 2.0 } else { 1.0 };
        let extent = match self.kind {
            kind::TRIANGLE => PI * self.area * sides,
            kind::SPOT => self.spot_solid_angle(),
            kind::DIRECTIONAL => PI * self.edge2.x * self.edge2.x,
            kind::ENVIRONMENT => self.area * PI * self.edge2.x * self.edge2.x,
            _ => 4.0 * PI,
        };
        extent * luminance(self.emission)
    }

    /// Integral of the spot's attenuation over all directions, sr. With a = cos outer, b = cos inner:
    /// 2π [(1 - b) + ∫ ((c - a) / (b - a))² dc] = 2π [(1 - b) + (b - a) / 3], c from a to b.
    fn spot_solid_angle(&self) -> f32 {
        let (a, width) = (self.edge2.x, 1.0 / self.edge2.y);
        let full = 1.0 - (a + width);
        // Within the guard of 0.001 the intensity may not reach its full value: then c ends at 1.
        let integral =
            if full >= 0.0 { full + width / 3.0 } else { (1.0 - a).powi(3) / (3.0 * width * width) };
        2.0 * PI * integral
    }
}

impl Light {
    /// Has it more than one point to sample?
    pub fn has_extent(&self) -> bool {
        self.kind == kind::TRIANGLE || self.kind == kind::ENVIRONMENT
    }

    /// Density of a sample on this light in the light's own measure: 1/area, 1/solid angle, or 1 for a delta light.
    pub fn pdf_li(&self) -> SourcePdf {
        self.pdf_li_among(u32::MAX)
    }

    /// The same where `features` (as in [`Lights`]) says which kinds there are.
    pub fn pdf_li_among(&self, features: u32) -> SourcePdf {
        if self.is_a(kind::TRIANGLE, features) {
            return SourcePdf(triangle_pdf(self.area).0);
        }
        SourcePdf(if self.is_a(kind::ENVIRONMENT, features) { safe_ratio(1.0, self.area) } else { 1.0 })
    }

    /// The point `square` of this light as seen from `receiver` (world space, m). A light at the receiver itself, or one
    /// seen from behind or edge-on, gives no irradiance; nothing here is ever NaN or infinite for finite input.
    pub fn sample_li(&self, square: Vec2, receiver: Vec3) -> Incident {
        self.sample_li_among(u32::MAX, square, receiver)
    }

    /// The same where `features` (as in [`Lights`]) says which kinds there are: one test for each.
    pub fn sample_li_among(&self, features: u32, square: Vec2, receiver: Vec3) -> Incident {
        if self.is_a(kind::TRIANGLE, features) {
            return self.sample_triangle(square, receiver);
        }
        if self.is_a(kind::DIRECTIONAL, features) {
            return from_infinity(self.edge1, self.edge2.x, receiver, self.emission, 0.0);
        }
        if self.is_a(kind::ENVIRONMENT, features) {
            let cos_theta = self.edge1.y + square.y * self.edge2.z;
            let direction = environment::direction(cos_theta, self.edge1.x + square.x * self.edge2.y);
            return from_infinity(direction, self.edge2.x, receiver, self.emission, 1.0);
        }
        let incident = from_point(self.position, receiver, self.emission);
        if self.is_a(kind::SPOT, features) {
            let irradiance = incident.irradiance * self.attenuation(incident.direction);
            return Incident { irradiance, ..incident };
        }
        incident
    }

    fn is_a(&self, kind: u32, features: u32) -> bool {
        is_kind(self.kind, kind, features)
    }

    /// Fraction of a spot's intensity that leaves it against `direction` (unit, to the spot).
    fn attenuation(&self, direction: Vec3) -> f32 {
        let cos = -direction.dot(self.edge1);
        let t = ((cos - self.edge2.x) * self.edge2.y).clamp(0.0, 1.0);
        t * t
    }

    fn sample_triangle(&self, square: Vec2, receiver: Vec3) -> Incident {
        let b = square_to_triangle(square);
        let position = self.position + b.x * self.edge1 + b.y * self.edge2;
        let mut normal = normalize_or(cross(self.edge1, self.edge2), Vec3::ZERO);
        let ray = Segment::new(receiver, position);
        let Segment { direction, distance, .. } = ray;
        if self.flags & DOUBLE_SIDED != 0 && normal.dot(direction) > 0.0 {
            normal = -normal;
        }
        let cos_light = (-normal.dot(direction)).max(0.0);
        let traceable = if self.flags & UNTRACEABLE == 0 { 1.0 } else { 0.0 };
        Incident {
            position,
            normal,
            magnitude: self.position.abs().max(self.edge1.abs()).max(self.edge2.abs()).max_element(),
            direction,
            distance,
            irradiance: fall_off(self.emission, cos_light, &ray),
            solid_angle: traceable * cos_light * ray.inverse_square,
        }
    }

    /// The inverse of [`Light::sample_li`] for a triangle or a texel: the point of the unit square that lies in `direction`
    /// (unit) from `receiver`; the nearest one, where rounding leads past an edge.
    pub fn invert_li(&self, direction: Vec3, receiver: Vec3) -> Vec2 {
        if self.kind == kind::ENVIRONMENT {
            let (cos_theta, phi) = environment::angles(direction);
            let place = Vec2::new(phi - self.edge1.x, cos_theta - self.edge1.y);
            return Vec2::new(safe_ratio(place.x, self.edge2.y), safe_ratio(place.y, self.edge2.z));
        }
        // Cramer's rule for receiver + t direction = position + b1 edge1 + b2 edge2 (Möller & Trumbore 1997).
        let p = cross(direction, self.edge2);
        let determinant = self.edge1.dot(p);
        let s = (receiver - self.position) * if determinant < 0.0 { -1.0 } else { 1.0 };
        let q = cross(s, self.edge1);
        let b = Vec2::new(s.dot(p), direction.dot(q)) * safe_ratio(1.0, determinant.abs());
        triangle_to_square(b.max(Vec2::ZERO))
    }
}

/// Is a light of kind `this` of kind `that`, in a scene with these [`features`]?
fn is_kind(this: u32, that: u32, features: u32) -> bool {
    features & features::light_kind(that) != 0 && this == that
}

/// Light of `intensity` (cd) from a point.
fn from_point(position: Vec3, receiver: Vec3, intensity: Vec3) -> Incident {
    let ray = Segment::new(receiver, position);
    let irradiance = fall_off(intensity, 1.0, &ray);
    let Segment { direction, distance, .. } = ray;
    Incident { position, direction, distance, irradiance, ..Incident::default() }
}

/// Light from `direction` that knows no distance, in a scene with a bounding sphere of `radius` m.
fn from_infinity(
    direction: Vec3,
    radius: f32,
    receiver: Vec3,
    irradiance: Vec3,
    solid_angle: f32,
) -> Incident {
    let distance = REACH * radius;
    let position = receiver + direction * distance;
    Incident { position, direction, distance, irradiance, solid_angle, ..Incident::default() }
}

/// From a receiver to a point.
struct Segment {
    /// Unit; 0 between equal points.
    direction: Vec3,
    /// m
    distance: f32,
    /// 1/d², 1/m²; 0 between equal points.
    inverse_square: f32,
}

impl Segment {
    /// Points nearer than 1e-15 m count as equal: d² has to be a normal number.
    fn new(from: Vec3, to: Vec3) -> Self {
        let v = to - from;
        let square = v.length_squared();
        let inverse = if square > 1e-30 { inverse_sqrt(square) } else { 0.0 };
        Segment { direction: v * inverse, distance: square * inverse, inverse_square: inverse * inverse }
    }
}

/// emission cosθ' / d². Components that overflow become the largest number: one absurdly near light must not make a NaN
/// pixel.
fn fall_off(emission: Vec3, cos_light: f32, ray: &Segment) -> Vec3 {
    let e = emission * (cos_light * ray.inverse_square);
    Vec3::new(e.x.min(1e30), e.y.min(1e30), e.z.min(1e30))
}
