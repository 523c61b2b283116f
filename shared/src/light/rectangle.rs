//! Rectangles that glow.

#[cfg(not(target_arch = "spirv"))]
use super::HostKind;
#[cfg(not(target_arch = "spirv"))]
use super::tree::Bound;
use super::{Kind, Light, Place, Shape};
use crate::math::cross;
#[cfg(not(target_arch = "spirv"))]
use crate::math::normalize_or;
#[cfg(not(target_arch = "spirv"))]
use core::f32::consts::{FRAC_PI_2, PI};
use glam::{Vec2, Vec3};

/// A rectangle whose every point radiates evenly (Lambertian) to one side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    /// World space, m.
    pub corner: Vec3,
    /// From there along its sides, m: it shines along their cross product.
    pub edges: [Vec3; 2],
    /// m²
    pub area: f32,
    /// nit, linear RGB.
    pub radiance: Vec3,
}

impl Kind for Rectangle {
    const SHAPE: Shape = Shape::Surface;
    const HAS_EXTENT: bool = true;

    fn of(light: &Light) -> Self {
        Rectangle {
            corner: light.position,
            edges: [light.edge1, light.edge2],
            area: light.area,
            radiance: light.emission,
        }
    }

    fn place(self, square: Vec2) -> Place {
        let [u, v] = self.edges;
        Place {
            position: self.corner + square.x * u + square.y * v,
            normal: cross(u, v),
            magnitude: self.corner.abs().max(u.abs()).max(v.abs()).max_element(),
        }
    }

    fn measure(self) -> f32 {
        self.area
    }
}

#[cfg(not(target_arch = "spirv"))]
impl HostKind for Rectangle {
    const NAME: &'static str = "rectangle";
    const LIGHTS: &'static str = "rectangles";

    fn numbers(self) -> Light {
        Light {
            position: self.corner,
            edge1: self.edges[0],
            edge2: self.edges[1],
            area: self.area,
            emission: self.radiance,
            ..Light::default()
        }
    }

    fn bound(self) -> Option<Bound> {
        let [u, v] = self.edges;
        let (low, high) = (u.min(Vec3::ZERO) + v.min(Vec3::ZERO), u.max(Vec3::ZERO) + v.max(Vec3::ZERO));
        Some(Bound {
            min: self.corner + low,
            max: self.corner + high,
            axis: normalize_or(cross(u, v), Vec3::Y),
            angle: FRAC_PI_2,
        })
    }

    /// π A
    fn flux_factor(self) -> f32 {
        PI * self.area
    }
}

#[cfg(not(target_arch = "spirv"))]
impl Light {
    /// A rectangle around `center` with sides as long as `sides` and parallel to them, m, at right angles; it shines along their
    /// cross product. `radiance` in nit.
    pub fn rectangle(center: Vec3, sides: [Vec3; 2], radiance: Vec3) -> Self {
        let area = sides[0].as_dvec3().cross(sides[1].as_dvec3()).length() as f32;
        let corner = center - 0.5 * (sides[0] + sides[1]);
        Rectangle { corner, edges: sides, area, radiance }.light()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::sampling_tests::{COLOR, Known, Sample, brightness};

    impl Sample for Rectangle {
        fn known(strength: f32) -> Known {
            let (width, height) = (0.5 * f64::from(strength), 1.5);
            let (u, v) = (Vec3::new(0.6, 0.0, 0.8) * width as f32, Vec3::Y * height as f32);
            let light = Light::rectangle(Vec3::new(1.0, strength, -1.0), [u, v], COLOR * strength);
            let power = core::f64::consts::PI * width * height * brightness(strength);
            Known { light, power, measure: width * height }
        }

        fn quarter(self, place: Vec3) -> usize {
            let right =
                |side: Vec3| usize::from((place - self.corner).dot(side) > 0.5 * side.length_squared());
            right(self.edges[0]) + 2 * right(self.edges[1])
        }
    }

    /// Lambert 1760: E = L/2 Σ θ_i Γ_i·n over the edges of a polygon, seen from the origin with normal +Y.
    fn lambert(corners: [Vec3; 4], radiance: f64) -> f64 {
        let corners = corners.map(|c| c.as_dvec3().normalize());
        let edge = |i: usize| {
            let (a, b) = (corners[i], corners[(i + 1) % 4]);
            a.dot(b).acos() * a.cross(b).normalize().y
        };
        (0..4).map(edge).sum::<f64>().abs() * radiance / 2.0
    }

    #[test]
    fn sampled_rectangle_gives_lamberts_irradiance() {
        for (center, u, v) in [
            (Vec3::new(0.0, 2.0, 0.0), Vec3::X, Vec3::Z),
            (Vec3::new(1.0, 1.5, -0.5), Vec3::new(0.0, 0.6, 0.8) * 0.7, Vec3::X * 2.0),
        ] {
            let light = Light::rectangle(center, [u, v], Vec3::splat(10.0));
            let corner = |x: f32, y: f32| center + x * u + y * v;
            let exact =
                lambert([corner(-0.5, -0.5), corner(0.5, -0.5), corner(0.5, 0.5), corner(-0.5, 0.5)], 10.0);
            let n = 200;
            let irradiance = |light: Light| {
                let at = |i: i32| Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32;
                let one = |i| {
                    let incident = light.sample_li(at(i), Vec3::ZERO);
                    f64::from(incident.irradiance.x * incident.direction.y / light.pdf_li().0)
                };
                (0..n * n).map(one).sum::<f64>() / f64::from(n * n)
            };
            // One of both sides faces the origin.
            let back = Light::rectangle(center, [v, u], Vec3::splat(10.0));
            let [sum, other] = [irradiance(light), irradiance(back)];
            assert!((sum.max(other) / exact - 1.0).abs() < 1e-4, "{sum} or {other}, Lambert {exact}");
            assert_eq!(sum.min(other), 0.0, "one side is dark");
            let wide = Light::rectangle(center, [u * 1.01, v], Vec3::splat(10.0));
            let wider =
                irradiance(wide).max(irradiance(Light { edge1: wide.edge2, edge2: wide.edge1, ..wide }));
            assert!((wider / exact - 1.0).abs() > 1e-3, "a side longer by 1 % was not seen");
        }
    }

    #[test]
    fn it_shines_along_the_cross_product_of_its_sides() {
        let light = Light::rectangle(Vec3::ZERO, [Vec3::X, Vec3::Y], Vec3::ONE);
        let toward = |p| light.sample_li(Vec2::splat(0.4), p).irradiance.x;
        assert!(toward(Vec3::Z) > 0.0 && toward(Vec3::NEG_Z) == 0.0);
        let bound = light.bound().unwrap();
        assert_eq!((bound.min, bound.max), (Vec3::new(-0.5, -0.5, 0.0), Vec3::new(0.5, 0.5, 0.0)));
        assert!((bound.axis - Vec3::Z).length() < 1e-6);
    }
}
