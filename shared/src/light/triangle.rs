//! Emissive triangles.

#[cfg(not(target_arch = "spirv"))]
use super::tree::Bound;
#[cfg(not(target_arch = "spirv"))]
use super::{DOUBLE_SIDED, HostKind};
use super::{Kind, Light, Place, Shape};
#[cfg(not(target_arch = "spirv"))]
use crate::math::normalize_or;
use crate::math::{cross, safe_ratio};
use crate::sampling::{square_to_triangle, triangle_to_square};
#[cfg(not(target_arch = "spirv"))]
use core::f32::consts::{FRAC_PI_2, PI};
#[cfg(not(target_arch = "spirv"))]
use glam::DVec3;
use glam::{Vec2, Vec3};

/// A triangle whose every point radiates evenly (Lambertian).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    /// First vertex, world space, m.
    pub vertex: Vec3,
    /// From there to the second and the third, m: counter-clockwise seen from the side that emits.
    pub edges: [Vec3; 2],
    /// Computed in f64, m².
    pub area: f32,
    /// nit, linear RGB.
    pub radiance: Vec3,
    /// [`super::DOUBLE_SIDED`] and [`super::UNTRACEABLE`].
    pub flags: u32,
}

impl Kind for Triangle {
    const SHAPE: Shape = Shape::Surface;
    const HAS_EXTENT: bool = true;
    const TRACEABLE: bool = true;

    fn of(light: &Light) -> Self {
        Triangle {
            vertex: light.position,
            edges: [light.edge1, light.edge2],
            area: light.area,
            radiance: light.emission,
            flags: light.flags,
        }
    }

    fn place(self, square: Vec2) -> Place {
        let b = square_to_triangle(square);
        let [u, v] = self.edges;
        Place {
            position: self.vertex + b.x * u + b.y * v,
            normal: cross(u, v),
            magnitude: self.vertex.abs().max(u.abs()).max(v.abs()).max_element(),
        }
    }

    fn measure(self) -> f32 {
        self.area
    }

    fn invert(self, direction: Vec3, receiver: Vec3) -> Vec2 {
        // Cramer's rule for receiver + t direction = position + b1 edge1 + b2 edge2 (Möller & Trumbore 1997).
        let [u, v] = self.edges;
        let p = cross(direction, v);
        let determinant = u.dot(p);
        let s = (receiver - self.vertex) * if determinant < 0.0 { -1.0 } else { 1.0 };
        let q = cross(s, u);
        let b = Vec2::new(s.dot(p), direction.dot(q)) * safe_ratio(1.0, determinant.abs());
        triangle_to_square(b.max(Vec2::ZERO))
    }
}

#[cfg(not(target_arch = "spirv"))]
impl HostKind for Triangle {
    const NAME: &'static str = "triangle";
    const LIGHTS: &'static str = "emissive triangles";

    fn numbers(self) -> Light {
        Light {
            position: self.vertex,
            edge1: self.edges[0],
            flags: self.flags,
            edge2: self.edges[1],
            area: self.area,
            emission: self.radiance,
            ..Light::default()
        }
    }

    fn bound(self) -> Option<Bound> {
        let [u, v] = self.edges.map(|edge| self.vertex + edge);
        let normal = normalize_or(cross(self.edges[0], self.edges[1]), Vec3::Y);
        // Without area it has no side.
        let one_side = self.flags & DOUBLE_SIDED == 0 && self.area > 0.0;
        Some(Bound {
            min: self.vertex.min(u).min(v),
            max: self.vertex.max(u).max(v),
            axis: normal,
            angle: if one_side { FRAC_PI_2 } else { PI },
        })
    }

    /// π A a side.
    fn flux_factor(self) -> f32 {
        let sides = if self.flags & DOUBLE_SIDED != 0 { 2.0 } else { 1.0 };
        core::f32::consts::PI * self.area * sides
    }
}

#[cfg(not(target_arch = "spirv"))]
impl Light {
    /// An emissive triangle. Vertices in m, counter-clockwise seen from the side that emits; `radiance` in nit.
    pub fn triangle(vertices: [Vec3; 3], radiance: Vec3, double_sided: bool) -> Self {
        let [a, b, c] = vertices;
        Self::triangle_between(a, [b - a, c - a].map(Vec3::as_dvec3), radiance, double_sided)
    }

    /// As [`Light::triangle`], by its first vertex and the edges from there to the second and third, m.
    pub fn triangle_between(vertex: Vec3, edges: [DVec3; 2], radiance: Vec3, double_sided: bool) -> Self {
        let area = (0.5 * edges[0].cross(edges[1]).length()) as f32;
        let flags = if double_sided { DOUBLE_SIDED } else { 0 };
        Triangle { vertex, edges: edges.map(|e| e.as_vec3()), area, radiance, flags }.light()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::sampling_tests::{COLOR, Known, Sample, brightness};
    use core::f32::consts::PI;

    impl Sample for Triangle {
        fn known(strength: f32) -> Known {
            let v = [Vec3::ZERO, Vec3::new(strength, 0.5, 0.0), Vec3::new(0.2, 1.0, 0.7)];
            let double_sided = strength > 2.0;
            // Heron's formula.
            let [a, b, c] = [v[0] - v[1], v[1] - v[2], v[2] - v[0]].map(|e| e.as_dvec3().length());
            let s = 0.5 * (a + b + c);
            let area = (s * (s - a) * (s - b) * (s - c)).sqrt();
            let sides = if double_sided { 2.0 } else { 1.0 };
            let light = Light::triangle(v, COLOR * strength, double_sided);
            let power = sides * core::f64::consts::PI * area * brightness(strength);
            Known { light, power, measure: area }
        }

        /// The triangles at the corners, and the one between the middles of the edges.
        fn quarter(self, place: Vec3) -> usize {
            let [e1, e2] = self.edges.map(|e| e.as_dvec3());
            let p = place.as_dvec3() - self.vertex.as_dvec3();
            let normal = e1.cross(e2);
            let share = |v: DVec3| v.dot(normal) / normal.length_squared();
            let (b, c) = (share(p.cross(e2)), share(e1.cross(p)));
            [b > 0.5, c > 0.5, 1.0 - b - c > 0.5].iter().position(|&at| at).unwrap_or(3)
        }
    }

    fn triangle(double_sided: bool) -> Light {
        let vertices = [Vec3::new(-0.5, 2.0, -0.5), Vec3::new(0.5, 2.0, -0.5), Vec3::new(-0.5, 2.0, 0.5)];
        Light::triangle(vertices, Vec3::splat(10.0), double_sided)
    }

    #[test]
    fn both_sides_give_twice_the_power() {
        assert!((triangle(false).power() - 10.0 * PI * 0.5).abs() < 1e-5);
        assert_eq!(triangle(true).power(), 2.0 * triangle(false).power());
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
    fn a_triangle_without_area_is_dark_and_finite() {
        let sliver = Light::triangle([Vec3::ZERO, Vec3::X, Vec3::X * 2.0], Vec3::ONE, true);
        assert_eq!((sliver.power(), sliver.pdf_li().0), (0.0, 0.0));
        assert_eq!(sliver.sample_li(Vec2::splat(0.5), Vec3::Y).irradiance, Vec3::ZERO);
    }
}
