//! Spheres that glow: point lights with a radius.

#[cfg(not(target_arch = "spirv"))]
use super::HostKind;
use super::arrival::{Connection, reach};
#[cfg(not(target_arch = "spirv"))]
use super::tree::Bound;
use super::{Incident, Kind, Light, Place, Shape};
use core::f32::consts::{PI, TAU};
use glam::{Vec2, Vec3};
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float;

/// A sphere whose every point radiates evenly (Lambertian). From outside it lights as a point of `intensity` in its center does,
/// as long as nothing hides a part of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// World space, m.
    pub center: Vec3,
    /// m
    pub radius: f32,
    /// I, cd, linear RGB: the radiance of its points is I / (π r²).
    pub intensity: Vec3,
}

impl Kind for Sphere {
    const SHAPE: Shape = Shape::Seen;
    const HAS_EXTENT: bool = true;

    fn of(light: &Light) -> Self {
        Sphere { center: light.position, radius: light.edge1.x, intensity: light.emission }
    }

    fn place(self, square: Vec2) -> Place {
        Place::at(square.extend(0.0))
    }

    /// Uniform over the solid angle 2π (1 - cosθ) that the sphere fills (Shirley, Wang & Zimmerman 1996, "Monte Carlo Techniques
    /// for Direct Lighting Calculations"), by sums that keep their digits for small and for large ones. Dark from inside.
    fn seen(self, square: Vec2, receiver: Vec3) -> Incident {
        let to_center = Connection::new(receiver, self.center);
        let sin2_limit = self.radius * self.radius * to_center.inverse_square;
        if sin2_limit >= 1.0 {
            return Incident::default();
        }
        let cos_limit = (1.0 - sin2_limit).sqrt();
        // 1 - cos of the angle from the center.
        let drop = square.x * sin2_limit / (1.0 + cos_limit);
        let (cos, sin2) = (1.0 - drop, drop * (2.0 - drop));
        let angle = TAU * square.y - PI;
        let (u, v) = frame(to_center.direction);
        let aside = u * angle.cos() + v * angle.sin();
        let direction = (to_center.direction * cos + aside * sin2.sqrt()).normalize_or_zero();
        // The product of both distances to the sphere is d² - r².
        let distance = to_center.distance * (1.0 - sin2_limit) / (cos + (sin2_limit - sin2).max(0.0).sqrt());
        Incident {
            position: receiver + direction * distance,
            direction,
            distance,
            irradiance: reach(self.intensity, to_center.inverse_square * 2.0 / (1.0 + cos_limit)),
            ..Incident::default()
        }
    }
}

/// Two unit vectors across the unit vector `n`, which turn with it without a leap but where it points down: receivers beside each
/// other see the same square alike (Frisvad 2012, "Building an Orthonormal Basis from a 3D Unit Vector Without Normalization").
fn frame(n: Vec3) -> (Vec3, Vec3) {
    // 1 / (1 + y), also near y = -1.
    let across = n.x * n.x + n.z * n.z;
    let a = if n.y >= 0.0 { 1.0 / (1.0 + n.y) } else { (1.0 - n.y) / across.max(1e-30) };
    let b = -n.x * n.z * a;
    (Vec3::new(1.0 - n.x * n.x * a, -n.x, b), Vec3::new(b, -n.z, 1.0 - n.z * n.z * a))
}

#[cfg(not(target_arch = "spirv"))]
impl HostKind for Sphere {
    const NAME: &'static str = "sphere";
    const LIGHTS: &'static str = "spheres";

    fn numbers(self) -> Light {
        let edge1 = Vec3::new(self.radius, 0.0, 0.0);
        Light { position: self.center, edge1, emission: self.intensity, ..Light::default() }
    }

    fn bound(self) -> Option<Bound> {
        let reach = Vec3::splat(self.radius);
        Some(Bound { min: self.center - reach, max: self.center + reach, ..Bound::point(self.center) })
    }

    /// That of a point.
    fn flux_factor(self) -> f32 {
        4.0 * PI
    }
}

#[cfg(not(target_arch = "spirv"))]
impl Light {
    /// A sphere with the flux of a point of `intensity` cd. `center` and `radius` in m.
    pub fn sphere(center: Vec3, radius: f32, intensity: Vec3) -> Self {
        Sphere { center, radius, intensity }.light()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::sampling_tests::{COLOR, Known, Sample, brightness};
    use glam::DVec3;

    impl Sample for Sphere {
        fn known(strength: f32) -> Known {
            let light = Light::sphere(Vec3::new(strength, 2.0, 3.0), 0.1 * strength, COLOR * strength);
            Known { light, power: 4.0 * core::f64::consts::PI * brightness(strength), measure: 1.0 }
        }

        /// Of the square itself: where a point lies depends on who looks.
        fn quarter(self, place: Vec3) -> usize {
            usize::from(place.x > 0.5) + 2 * usize::from(place.y > 0.5)
        }
    }

    fn grid(n: usize) -> impl Iterator<Item = Vec2> {
        (0..n * n).map(move |i| Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32)
    }

    /// E = I cosτ / d² for a surface tilted by τ that sees all of it, whatever its size (the configuration factor of a sphere,
    /// r² cosτ / d²).
    #[test]
    fn irradiance_is_that_of_a_point() {
        let center = Vec3::new(0.3, 1.0, -0.2);
        let d = f64::from(center.length());
        for radius in [0.9f32, 0.5, 0.1, 1e-3, 1e-6] {
            let light = Light::sphere(center, radius, Vec3::new(5.0, 2.0, 1.0));
            let limit = (f64::from(radius) / d).asin();
            for tilt in [0.0, 0.5, core::f64::consts::FRAC_PI_2 - limit].map(|t: f64| t.min(1.4)) {
                if tilt > core::f64::consts::FRAC_PI_2 - limit {
                    continue;
                }
                let n = center.as_dvec3().normalize();
                let aside = n.cross(DVec3::Z).normalize();
                let normal = n * tilt.cos() + aside * tilt.sin();
                let steps = 256;
                let sum: DVec3 = grid(steps)
                    .map(|square| {
                        let incident = light.sample_li(square, Vec3::ZERO);
                        incident.irradiance.as_dvec3() * incident.direction.as_dvec3().dot(normal)
                    })
                    .sum();
                let mean = sum / (steps * steps) as f64;
                let exact = 5.0 * tilt.cos() / (d * d);
                assert!((mean.x / exact - 1.0).abs() < 2e-4, "radius {radius}, tilt {tilt}: {mean}, {exact}");
                // A density over the disk behind it (without the cone's cosine) would be off.
                let planted = exact * (1.0 + limit.cos()) / 2.0;
                assert!(radius < 0.1 || (mean.x / planted - 1.0).abs() > 2e-3, "radius {radius}");
            }
        }
    }

    /// Directions are even over the cone: chi-square over 8 rings of equal solid angle x 8 sectors, 63 degrees of freedom, false
    /// alarm 1e-4 (fixed seed). Sampling the disk behind the sphere evenly has to fail.
    #[test]
    fn directions_are_even_over_the_solid_angle() {
        use crate::rng::{Rng, Stream};
        let (center, radius) = (Vec3::new(1.0, -0.5, 0.7), 1.1);
        let light = Light::sphere(center, radius, Vec3::ONE);
        let axis = center.as_dvec3().normalize();
        let sin_limit = f64::from(radius) / f64::from(center.length());
        let cos_limit = (1.0 - sin_limit * sin_limit).sqrt();
        let u = axis.any_orthonormal_vector();
        let v = axis.cross(u);
        let n = 100_000;
        let statistic = |warp: fn(f32, f64) -> f32| {
            let mut rng = Rng::new(glam::UVec2::new(3, 5), 0, 2, Stream::Initial, 0);
            let mut counts = [0u32; 64];
            for _ in 0..n {
                let square = Vec2::new(warp(rng.next_f32(), cos_limit), rng.next_f32());
                let direction = light.sample_li(square, Vec3::ZERO).direction.as_dvec3();
                let ring = (1.0 - direction.dot(axis)) / (1.0 - cos_limit) * 8.0;
                let sector = (direction.dot(v).atan2(direction.dot(u)) / core::f64::consts::TAU + 0.5) * 8.0;
                counts[ring.clamp(0.0, 7.0) as usize * 8 + sector.clamp(0.0, 7.0) as usize] += 1;
            }
            let expected = f64::from(n) / 64.0;
            counts.iter().map(|&count| (f64::from(count) - expected).powi(2) / expected).sum::<f64>()
        };
        let right = statistic(|x, _| x);
        assert!(right < 109.0, "chi-square {right}");
        // sin² even in place of the cosine.
        let disk =
            |x: f32, cos: f64| ((1.0 - (1.0 - f64::from(x) * (1.0 - cos * cos)).sqrt()) / (1.0 - cos)) as f32;
        assert!(statistic(disk) > 109.0, "the disk passes too");
    }

    #[test]
    fn points_lie_on_the_near_side() {
        for (distance, radius) in [(1.0001f32, 1.0f32), (2.0, 1.0), (1e3, 1.0), (1e5, 0.01), (1e-3, 5e-4)] {
            let center = Vec3::new(0.36, -0.48, 0.8) * distance;
            let light = Light::sphere(center, radius, Vec3::ONE);
            for square in grid(20) {
                let at = light.sample_li(square, Vec3::ZERO);
                let off = (at.position - center).length() - radius;
                assert!(off.abs() < 1e-6 * distance.max(radius), "{distance}, {radius}: {off}");
                assert!((at.position - at.direction * at.distance).length() < 1e-6 * distance);
                assert!(at.direction.dot(at.position - center) <= 1e-6 * distance, "the far side");
                assert!((at.direction.length() - 1.0).abs() < 1e-6 && at.irradiance.is_finite());
            }
        }
        let light = Light::sphere(Vec3::ONE, 0.5, Vec3::ONE);
        for inside in [Vec3::ONE, Vec3::new(1.2, 0.9, 1.1)] {
            assert_eq!(light.sample_li(Vec2::splat(0.3), inside).irradiance, Vec3::ZERO);
        }
    }

    #[test]
    fn frames_are_orthonormal_and_turn_evenly() {
        for i in 0..2000 {
            let y = 1.0 - 2.0 * (i as f32 + 0.5) / 2000.0;
            let y = if i % 7 == 0 { -(y * 1e-4).cos() } else { y };
            let (sin, cos) = (i as f32 * 2.4).sin_cos();
            let across = ((1.0 - y) * (1.0 + y)).max(0.0).sqrt();
            let n = Vec3::new(across * cos, y, across * sin).normalize();
            let (u, v) = frame(n);
            for product in [u.dot(v), u.dot(n), v.dot(n), u.length() - 1.0, v.length() - 1.0] {
                assert!(product.abs() < 1e-5, "{n}: {u}, {v}");
            }
            let turned = frame((n + Vec3::new(1e-3, 0.0, -1e-3)).normalize()).0;
            assert!(n.y < -0.99 || (turned - u).length() < 0.03, "a leap at {n}");
        }
        for pole in [Vec3::Y, Vec3::NEG_Y] {
            let (u, v) = frame(pole);
            assert_eq!((u.dot(v), u.dot(pole), u.length(), v.length()), (0.0, 0.0, 1.0, 1.0));
        }
    }
}
