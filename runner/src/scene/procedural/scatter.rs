//! Lights to add to a scene that has too few.

use crate::scene::{PointLight, SceneDescription};
use glam::{UVec2, Vec3};
use shared::math::luminance;
use shared::rng::{Rng, Stream};
use std::f32::consts::PI;

/// Mean illuminance that [`scatter`] aims at, lx: a well-lit office.
const SCATTERED_ILLUMINANCE: f32 = 500.0;

/// Adds `count` equally strong point lights of random hue, uniformly in the scene's bounds (shrunk by 1 % on each
/// side, so that none lies in a wall). The same seed gives the same lights.
///
/// Together they emit Φ = E A, with E = 500 lx and A the surface area of the bounds: if all of the flux
/// met that surface, its mean illuminance would be E, whatever the scene's size and the number of lights. Each
/// light has the luminous intensity Φ / (4π count).
pub fn scatter(scene: &mut SceneDescription, count: usize, seed: u64) {
    let bounds = scene.bounds();
    let extent = bounds.extent();
    if count == 0 || extent.min_element() < 0.0 {
        return;
    }
    let area = 2.0 * (extent.x * extent.y + extent.y * extent.z + extent.z * extent.x);
    let intensity = SCATTERED_ILLUMINANCE * area / (4.0 * PI * count as f32);
    for i in 0..count as u64 {
        // No pass draws from this lane.
        let place = UVec2::new(i as u32, (i >> 32) as u32);
        let mut rng = Rng::new(place, (seed >> 32) as u32, seed as u32, Stream::Initial, u32::MAX);
        let unit = Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32());
        let color = moderate_color(rng.next_f32());
        let position = bounds.min + extent * (0.01 + 0.98 * unit);
        scene.lights.push(PointLight { position, intensity: color * intensity, radius: 0.0 }.into());
    }
}

/// Linear RGB of luminance 1: the fully saturated color of `hue` (0..1, once around), mixed half and half with white.
fn moderate_color(hue: f32) -> Vec3 {
    let channel = |shift: f32| ((((hue + shift).fract() * 6.0) - 3.0).abs() - 1.0).clamp(0.0, 1.0);
    let color = Vec3::new(channel(0.0), channel(2.0 / 3.0), channel(1.0 / 3.0)).lerp(Vec3::ONE, 0.5);
    color / luminance(color)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::procedural::shapes::cuboid;
    use crate::scene::{Instance, Mesh};
    use glam::Affine3A;

    /// A box of 2 x 4 x 6 m, enlarged.
    fn scene(scale: f32) -> SceneDescription {
        let walls = cuboid(Vec3::ZERO, Vec3::new(2.0, 4.0, 6.0)).into_primitive(0, false);
        let transform = Affine3A::from_scale(Vec3::splat(scale));
        SceneDescription {
            meshes: vec![Mesh { name: "box".into(), primitives: vec![walls] }],
            instances: vec![Instance { name: "box".into(), mesh: 0, transform }],
            ..SceneDescription::default()
        }
    }

    #[test]
    fn scattered_lights_are_repeatable_and_inside() {
        let lights = |count, seed| {
            let mut scene = scene(1.0);
            scatter(&mut scene, count, seed);
            (scene.bounds(), scene.lights)
        };
        let (bounds, first) = lights(1000, 5);
        assert_eq!(first, lights(1000, 5).1);
        // Both halves of the seed count.
        assert_ne!(first, lights(1000, 6).1);
        assert_ne!(first, lights(1000, 5 + (1 << 32)).1);
        let places: Vec<Vec3> = first.iter().filter_map(|light| light.position()).collect();
        let inset = 0.0099 * bounds.extent();
        let (min, max) = (bounds.min + inset, bounds.max - inset);
        assert!(places.iter().all(|p| p.cmpge(min).all() && p.cmple(max).all()));
        // Uniform: the mean of 1000 has a deviation of extent / sqrt(12 000); 5 of them.
        let mean = places.iter().sum::<Vec3>() / 1000.0;
        assert!(
            ((mean - bounds.center()) / bounds.extent()).abs().max_element() < 5.0 / 12_000f32.sqrt(),
            "{mean}"
        );
    }

    #[test]
    fn scattered_flux_depends_on_neither_count_nor_size() {
        for (count, scale) in [(1, 1.0), (100, 1.0), (100, 10.0)] {
            let mut scene = scene(scale);
            scatter(&mut scene, count, 1);
            let flux: f32 = scene.lights.iter().map(|l| l.light(|| 0.0).power).sum();
            // The box of 2 x 4 x 6 m has 88 m².
            let illuminance = flux / (88.0 * scale * scale);
            assert!((illuminance - 500.0).abs() < 0.05, "{count} lights, scale {scale}: {illuminance} lx");
        }
        let mut empty = SceneDescription::default();
        scatter(&mut empty, 10, 1);
        assert!(empty.lights.is_empty());
    }
}
