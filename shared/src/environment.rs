//! Environment maps: light from infinity, as an equirectangular picture (rows from the top).
//!
//! +Y is up, as in glTF viewers: with θ the angle from +Y and φ = atan2(z, x),
//!
//! ```text
//! u = 1/2 + φ / 2π,   v = θ / π,   direction = (sinθ cosφ, cosθ, sinθ sinφ)
//! ```
//!
//! so the middle of the picture shows +X, a quarter of its width to the right +Z, to the left -Z, and its ends -X.

use bytemuck::{Pod, Zeroable};
use core::f32::consts::{PI, TAU};
use glam::{UVec2, Vec3};
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float;

/// A texel as the GPU has it. 16 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct EnvironmentTexel {
    /// nit, linear RGB
    pub radiance: Vec3,
    /// Place of its light among those of lit texels; [`crate::motion::NO_LIGHT`] for a black one.
    pub light: u32,
}

/// The unit direction at cosθ and φ (radians).
pub fn direction(cos_theta: f32, phi: f32) -> Vec3 {
    // Factors, as 1 - cos² has no digits left near the poles.
    let sin_theta = ((1.0 - cos_theta) * (1.0 + cos_theta)).max(0.0).sqrt();
    Vec3::new(sin_theta * phi.cos(), cos_theta, sin_theta * phi.sin())
}

/// The inverse of [`direction`]: cosθ, and φ in [-π, π].
pub fn angles(direction: Vec3) -> (f32, f32) {
    // Straight up or down, any φ will do; atan2(0, 0) would not.
    let level = direction.x != 0.0 || direction.z != 0.0;
    (direction.y, if level { direction.z.atan2(direction.x) } else { 0.0 })
}

/// Index of the texel of a map of `size` that `direction` (unit) points to.
pub fn texel_of(direction: Vec3, size: UVec2) -> u32 {
    let horizontal = (direction.x * direction.x + direction.z * direction.z).sqrt();
    let (_, phi) = angles(direction);
    let theta = horizontal.atan2(direction.y);
    let x = ((0.5 + phi / TAU) * size.x as f32).max(0.0) as u32;
    let y = (theta / PI * size.y as f32).max(0.0) as u32;
    y.min(size.y - 1) * size.x + x.min(size.x - 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::{Light, LightTable, Lights, build_alias_table};
    use crate::rng::{Rng, Stream};
    use glam::Vec2;

    const SIZE: UVec2 = UVec2::new(32, 16);

    fn texels() -> impl Iterator<Item = UVec2> {
        (0..SIZE.x * SIZE.y).map(|i| UVec2::new(i % SIZE.x, i / SIZE.x))
    }

    fn lights(radiance: impl Fn(UVec2) -> f32) -> Vec<Light> {
        texels().map(|t| Light::environment(t, SIZE, Vec3::splat(radiance(t)), 10.0)).collect()
    }

    #[test]
    fn landmarks() {
        let place = |d: Vec3| UVec2::new(texel_of(d, SIZE) % SIZE.x, texel_of(d, SIZE) / SIZE.x);
        let level = |x: f32, z: f32| place(Vec3::new(x, 0.01, z).normalize());
        assert_eq!(level(1.0, 0.01), UVec2::new(16, 7));
        assert_eq!(level(-0.01, 1.0), UVec2::new(24, 7));
        assert_eq!(level(0.01, -1.0), UVec2::new(8, 7));
        assert_eq!((level(-1.0, -0.01).x, level(-1.0, 0.01).x), (0, 31));
        assert_eq!((place(Vec3::Y).y, place(-Vec3::Y).y), (0, 15));
    }

    /// What is drawn for a texel's light is what a primary ray sees there.
    #[test]
    fn samples_lie_in_their_texel() {
        for (i, light) in lights(|_| 1.0).iter().enumerate() {
            for square in [Vec2::splat(0.5), Vec2::new(0.001, 0.999), Vec2::new(0.999, 0.001)] {
                let incident = light.sample_li(square, Vec3::new(1.0, 2.0, 3.0));
                assert_eq!(texel_of(incident.direction, SIZE), i as u32, "{square}");
                assert!((incident.direction.length() - 1.0).abs() < 1e-6);
                assert_eq!(incident.irradiance, Vec3::ONE);
                assert!(incident.position.length() > 10.0, "the shadow ray leaves the bounding sphere");
            }
        }
    }

    /// Under a constant sky of L nit a plane receives π L lx, whichever way it faces; and from 4π sr of it the bounding
    /// sphere's cross-section of π r² receives 4π L π r² lm.
    #[test]
    fn a_constant_sky() {
        let lights = lights(|_| 3.0);
        let n = 16;
        for normal in [Vec3::Y, -Vec3::Y, Vec3::X, Vec3::new(1.0, 2.0, -2.0) / 3.0] {
            let mut irradiance = 0.0;
            for light in &lights {
                for i in 0..n * n {
                    let square = Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32;
                    let incident = light.sample_li(square, Vec3::ZERO);
                    let cos = incident.direction.dot(normal).max(0.0);
                    irradiance +=
                        f64::from(incident.irradiance.x * cos / light.pdf_li().0) / f64::from(n * n);
                }
            }
            let exact = 3.0 * std::f64::consts::PI;
            assert!((irradiance / exact - 1.0).abs() < 1e-4, "{normal}: {irradiance} instead of {exact}");
        }
        let solid_angle: f64 = lights.iter().map(|light| 1.0 / f64::from(light.pdf_li().0)).sum();
        assert!((solid_angle / (4.0 * std::f64::consts::PI) - 1.0).abs() < 1e-6);
        let flux: f64 = lights.iter().map(|light| f64::from(light.power)).sum();
        let exact = std::f64::consts::PI * 100.0 * 4.0 * std::f64::consts::PI * 3.0;
        assert!((flux / exact - 1.0).abs() < 1e-5, "{flux} instead of {exact} lm");
    }

    /// Draws against radiance x solid angle: chi-square with 511 degrees of freedom, false alarm 1e-4; a table over the
    /// radiance alone must fail.
    #[test]
    fn draws_follow_the_map() {
        let radiance = |t: UVec2| (1 + (t.x * 7 + t.y * 13) % 11) as f32;
        let lights = lights(radiance);
        let edge = |y: u32| (std::f64::consts::PI * f64::from(y) / f64::from(SIZE.y)).cos();
        let weight = |t: UVec2| f64::from(radiance(t)) * (edge(t.y) - edge(t.y + 1));
        let total: f64 = texels().map(weight).sum();
        let chi2 = |alias: &[crate::alias_table::AliasEntry]| {
            let table = LightTable { lights: Lights::untextured(&lights), alias };
            let mut rng = Rng::new(UVec2::new(5, 6), 7, 8, Stream::Initial, 0);
            let n = 1 << 19;
            let mut counts = vec![0u32; lights.len()];
            for _ in 0..n {
                let r = rng.next_u32x4();
                counts[table.sample([r.x, r.y, r.z]).0.light as usize] += 1;
            }
            texels().zip(&counts).fold(0.0, |sum, (t, &count)| {
                let expected = f64::from(n) * weight(t) / total;
                sum + (f64::from(count) - expected).powi(2) / expected
            })
        };
        const LIMIT: f64 = 635.0;
        let alias = build_alias_table(&lights);
        assert!((alias.iter().map(|entry| f64::from(entry.pmf)).sum::<f64>() - 1.0).abs() < 1e-6);
        assert!(chi2(&alias) < LIMIT, "chi-square {}", chi2(&alias));
        let planted: Vec<f64> = texels().map(|t| f64::from(radiance(t))).collect();
        assert!(chi2(&crate::alias_table::build(&planted)) > LIMIT, "the planted error was not seen");
    }
}
