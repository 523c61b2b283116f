//! Lights: one `Light` for every kind, in world space and photometric units, as the GPU reads it.

use crate::math::{luminance, normalize_or, safe_ratio};
use crate::pdf::{Pmf, SourcePdf};
use crate::sampling::{square_to_triangle, triangle_pdf};
use crate::{alias_table, alias_table::AliasEntry};
use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3};

/// `Light::kind`.
pub mod kind {
    /// A point that radiates `emission` candela in every direction.
    pub const POINT: u32 = 0;
    /// A triangle whose every point radiates `emission` nit (Lambertian).
    pub const TRIANGLE: u32 = 1;
}

/// `Light::flags`: both sides of a triangle emit.
pub const DOUBLE_SIDED: u32 = 1;

/// One light. 64 bytes, as in memory.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Light {
    /// Point: its position. Triangle: its first vertex. World space, m.
    pub position: Vec3,
    /// One of [`kind`].
    pub kind: u32,
    /// Triangle: second vertex - first vertex, m.
    pub edge1: Vec3,
    /// [`DOUBLE_SIDED`].
    pub flags: u32,
    /// Triangle: third vertex - first vertex, m.
    pub edge2: Vec3,
    /// Triangle: its area, m²; computed in f64 by the host.
    pub area: f32,
    /// Point: intensity, cd. Triangle: radiance, nit. Linear RGB.
    pub emission: Vec3,
    /// [`Light::power`], lm: kept for those who look at the table.
    pub power: f32,
}

/// A point on a light: what a reservoir keeps. The light and where on it, both as drawn, so that every pass that
/// reads it evaluates the very same point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct LightSample {
    /// Index into the light table.
    pub light: u32,
    /// Where on the light: two 16-bit coordinates in the unit square, see [`LightSample::square`].
    pub uv: u32,
}

impl LightSample {
    /// The point of the unit square: centers of a 65536 x 65536 grid, so never on its edge.
    pub fn square(self) -> Vec2 {
        Vec2::new((self.uv & 0xffff) as f32 + 0.5, (self.uv >> 16) as f32 + 0.5) * (1.0 / 65536.0)
    }
}

/// A light sample as seen from a shading point.
#[derive(Clone, Copy, Debug, Default)]
pub struct Incident {
    /// The sampled point, world space, m.
    pub position: Vec3,
    /// Normal of the light there, on the side of the receiver; 0 for lights without a surface.
    pub normal: Vec3,
    /// Unit direction from the receiver to the light.
    pub direction: Vec3,
    /// Distance to it, m.
    pub distance: f32,
    /// What arrives per unit of the light's measure, without the receiver's cosine: Le cosθ'/d² (nit/m²) for an area,
    /// I/d² (lx) for a point. Linear RGB, unshadowed.
    pub irradiance: Vec3,
}

/// The lights of a scene and the table that draws them in proportion to their power.
#[derive(Clone, Copy)]
pub struct LightTable<'a> {
    pub lights: &'a [Light],
    pub alias: &'a [AliasEntry],
}

impl Light {
    /// A point light. `position` in m, `intensity` in cd.
    pub fn point(position: Vec3, intensity: Vec3) -> Self {
        Light { position, kind: kind::POINT, emission: intensity, ..Zeroable::zeroed() }.with_power()
    }

    /// An emissive triangle. Vertices in m, counter-clockwise seen from the side that emits; `radiance` in nit.
    pub fn triangle(vertices: [Vec3; 3], radiance: Vec3, double_sided: bool) -> Self {
        let [a, b, c] = vertices;
        let (edge1, edge2) = (b - a, c - a);
        let area = 0.5 * edge1.as_dvec3().cross(edge2.as_dvec3()).length();
        Light {
            position: a,
            kind: kind::TRIANGLE,
            edge1,
            flags: if double_sided { DOUBLE_SIDED } else { 0 },
            edge2,
            area: area as f32,
            emission: radiance,
            power: 0.0,
        }
        .with_power()
    }

    fn with_power(mut self) -> Self {
        self.power = self.power();
        self
    }

    /// Luminous flux Φ in lm (but for the factor 683 that photometric input already holds): the weight in the alias
    /// table. Point: 4π I. Triangle: π L A a side (Lambertian emitter).
    pub fn power(&self) -> f32 {
        use core::f32::consts::PI;
        let sides = if self.flags & DOUBLE_SIDED != 0 { 2.0 } else { 1.0 };
        if self.kind == kind::TRIANGLE {
            PI * self.area * sides * luminance(self.emission)
        } else {
            4.0 * PI * luminance(self.emission)
        }
    }

    /// Density of a sample on this light in the light's own measure: 1/area, or 1 for a delta light.
    pub fn pdf_li(&self) -> SourcePdf {
        if self.kind == kind::TRIANGLE { SourcePdf(triangle_pdf(self.area).0) } else { SourcePdf(1.0) }
    }

    /// The point `square` of this light as seen from `receiver` (world space, m). A light at the receiver itself, or one
    /// seen from behind or edge-on, gives no irradiance; nothing here is ever NaN or infinite for finite input.
    pub fn sample_li(&self, square: Vec2, receiver: Vec3) -> Incident {
        let mut position = self.position;
        let mut normal = Vec3::ZERO;
        if self.kind == kind::TRIANGLE {
            let b = square_to_triangle(square);
            position += b.x * self.edge1 + b.y * self.edge2;
            normal = normalize_or(self.edge1.cross(self.edge2), Vec3::ZERO);
        }
        let to_light = position - receiver;
        let direction = normalize_or(to_light, Vec3::ZERO);
        let distance = to_light.dot(direction);
        let mut cos_light = 1.0;
        if self.kind == kind::TRIANGLE {
            let facing = -normal.dot(direction);
            if self.flags & DOUBLE_SIDED != 0 && facing < 0.0 {
                normal = -normal;
            }
            cos_light = normal.dot(-direction).max(0.0);
        }
        // Two divisions, as d² may under- or overflow where the quotient does not.
        let geometry = safe_ratio(safe_ratio(cos_light, distance), distance);
        Incident { position, normal, direction, distance, irradiance: finite(self.emission * geometry) }
    }
}

/// Components that overflowed, as the largest number: one absurdly near light must not make a NaN pixel.
fn finite(v: Vec3) -> Vec3 {
    v.min(Vec3::splat(1e30))
}

impl<'a> LightTable<'a> {
    /// Draws a light by its power, and a point on it. `random`: alias column, alias ticket, point.
    pub fn sample(self, random: [u32; 3]) -> (LightSample, SourcePdf) {
        let (light, pmf) = alias_table::sample(self.alias, [random[0], random[1]]);
        let sample = LightSample { light, uv: random[2] };
        (sample, self.source_pdf(light, pmf))
    }

    fn source_pdf(self, light: u32, pmf: Pmf) -> SourcePdf {
        if light < self.lights.len() as u32 {
            pmf.and_on_light(self.lights[light as usize].pdf_li())
        } else {
            SourcePdf(0.0)
        }
    }

    /// `sample` as seen from `receiver`; dark for a sample of no light.
    pub fn incident(self, sample: LightSample, receiver: Vec3) -> Incident {
        if sample.light < self.lights.len() as u32 {
            self.lights[sample.light as usize].sample_li(sample.square(), receiver)
        } else {
            Incident::default()
        }
    }
}

/// The alias table over the power of `lights`.
#[cfg(not(target_arch = "spirv"))]
pub fn build_alias_table(lights: &[Light]) -> Vec<AliasEntry> {
    let weights: Vec<f64> = lights.iter().map(|light| f64::from(light.power())).collect();
    alias_table::build(&weights)
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f32::consts::PI;

    fn triangle(double_sided: bool) -> Light {
        let vertices = [Vec3::new(-0.5, 2.0, -0.5), Vec3::new(0.5, 2.0, -0.5), Vec3::new(-0.5, 2.0, 0.5)];
        Light::triangle(vertices, Vec3::splat(10.0), double_sided)
    }

    #[test]
    fn memory_is_as_documented() {
        assert_eq!(size_of::<Light>(), 64);
        assert_eq!(core::mem::offset_of!(Light, edge1), 16);
        assert_eq!(core::mem::offset_of!(Light, edge2), 32);
        assert_eq!(core::mem::offset_of!(Light, emission), 48);
        assert_eq!(size_of::<LightSample>(), 8);
    }

    #[test]
    fn power_is_flux() {
        assert!((Light::point(Vec3::ZERO, Vec3::ONE).power() - 4.0 * PI).abs() < 1e-5);
        assert!((triangle(false).power() - 10.0 * PI * 0.5).abs() < 1e-5);
        assert_eq!(triangle(true).power(), 2.0 * triangle(false).power());
    }

    #[test]
    fn point_light_falls_off_with_the_square() {
        let light = Light::point(Vec3::new(0.0, 3.0, 0.0), Vec3::new(9.0, 18.0, 27.0));
        let incident = light.sample_li(Vec2::splat(0.5), Vec3::ZERO);
        assert_eq!((incident.direction, incident.distance), (Vec3::Y, 3.0));
        assert!((incident.irradiance - Vec3::new(1.0, 2.0, 3.0)).length() < 1e-6);
        // At the light itself there is no direction to come from.
        assert_eq!(light.sample_li(Vec2::splat(0.5), light.position).irradiance, Vec3::ZERO);
    }

    #[test]
    fn distances_from_a_tenth_of_a_millimetre_to_a_hundred_kilometres() {
        for distance in [1e-4f32, 1e-2, 1.0, 1e3, 1e5] {
            let light = Light::point(Vec3::new(distance, 0.0, 0.0), Vec3::ONE);
            let irradiance = light.sample_li(Vec2::ZERO, Vec3::ZERO).irradiance.x;
            let exact = 1.0 / (f64::from(distance) * f64::from(distance));
            assert!((f64::from(irradiance) / exact - 1.0).abs() < 1e-6, "at {distance} m: {irradiance}");
        }
    }

    #[test]
    fn triangles_emit_where_they_face() {
        // Counter-clockwise seen from below: the normal is (0, -1, 0).
        let lit = Vec3::new(0.0, 0.0, 0.0);
        let behind = Vec3::new(0.0, 4.0, 0.0);
        let at = |light: Light, p| light.sample_li(Vec2::new(0.25, 0.5), p).irradiance.x;
        let front_emits = at(triangle(false), lit) > 0.0;
        assert_ne!(front_emits, at(triangle(false), behind) > 0.0);
        assert!(at(triangle(true), lit) > 0.0 && at(triangle(true), behind) > 0.0);
        let normal = triangle(true).sample_li(Vec2::splat(0.3), lit).normal;
        assert!(normal.y < -0.99, "the normal is on the receiver's side: {normal}");
    }

    /// Irradiance from a triangle in closed form (Lambert 1760): E = L/2 Σ θ_i Γ_i·n over its edges.
    #[test]
    fn sampled_triangle_gives_lamberts_irradiance() {
        let light = triangle(true);
        let corners = [light.position, light.position + light.edge1, light.position + light.edge2]
            .map(|v| v.as_dvec3());
        let exact: f64 = (0..3)
            .map(|i| {
                let (a, b) = (corners[i].normalize(), corners[(i + 1) % 3].normalize());
                a.dot(b).acos() * a.cross(b).normalize().y
            })
            .sum::<f64>()
            .abs()
            * 10.0
            / 2.0;
        let n = 256;
        let mut sum = 0.0;
        for i in 0..n * n {
            let square = Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32;
            let incident = light.sample_li(square, Vec3::ZERO);
            sum +=
                f64::from(incident.irradiance.x * incident.direction.y / light.pdf_li().0) / f64::from(n * n);
        }
        assert!((sum / exact - 1.0).abs() < 1e-4, "quadrature {sum}, Lambert {exact}");
    }

    #[test]
    fn degenerate_lights_are_dark_and_finite() {
        let sliver = Light::triangle([Vec3::ZERO, Vec3::X, Vec3::X * 2.0], Vec3::ONE, true);
        assert_eq!((sliver.power(), sliver.pdf_li().0), (0.0, 0.0));
        assert_eq!(sliver.sample_li(Vec2::splat(0.5), Vec3::Y).irradiance, Vec3::ZERO);
        let hot = Light::point(Vec3::ZERO, Vec3::splat(1e30));
        assert!(hot.sample_li(Vec2::ZERO, Vec3::new(1e-10, 0.0, 0.0)).irradiance.is_finite());
    }
}
