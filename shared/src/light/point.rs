//! Point lights (KHR_lights_punctual).

#[cfg(not(target_arch = "spirv"))]
use super::HostKind;
#[cfg(not(target_arch = "spirv"))]
use super::tree::Bound;
use super::{Kind, Light, Place, Shape};
use glam::{Vec2, Vec3};

/// A point that radiates alike in every direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// World space, m.
    pub position: Vec3,
    /// cd, linear RGB.
    pub intensity: Vec3,
}

impl Kind for Point {
    const SHAPE: Shape = Shape::Point;

    fn of(light: &Light) -> Self {
        Point { position: light.position, intensity: light.emission }
    }

    fn place(self, _: Vec2) -> Place {
        Place::at(self.position)
    }
}

#[cfg(not(target_arch = "spirv"))]
impl HostKind for Point {
    const NAME: &'static str = "point";
    const LIGHTS: &'static str = "point lights";

    fn numbers(self) -> Light {
        Light { position: self.position, emission: self.intensity, ..Light::default() }
    }

    fn bound(self) -> Option<Bound> {
        Some(Bound::point(self.position))
    }

    fn flux_factor(self) -> f32 {
        4.0 * core::f32::consts::PI
    }
}

#[cfg(not(target_arch = "spirv"))]
impl Light {
    /// A point light. `position` in m, `intensity` in cd.
    pub fn point(position: Vec3, intensity: Vec3) -> Self {
        Point { position, intensity }.light()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::sampling_tests::{COLOR, Known, Sample, brightness};
    use core::f64::consts::PI;

    impl Sample for Point {
        fn known(strength: f32) -> Known {
            let light = Light::point(Vec3::new(strength, 2.0, 3.0), COLOR * strength);
            Known { light, power: 4.0 * PI * brightness(strength), measure: 1.0 }
        }
    }

    #[test]
    fn intensity_falls_off_with_the_square() {
        let light = Light::point(Vec3::new(0.0, 3.0, 0.0), Vec3::new(9.0, 18.0, 27.0));
        let incident = light.sample_li(Vec2::splat(0.5), Vec3::ZERO);
        assert_eq!((incident.direction, incident.distance), (Vec3::Y, 3.0));
        assert!((incident.irradiance - Vec3::new(1.0, 2.0, 3.0)).length() < 1e-6);
        // At the light itself there is no direction to come from.
        assert_eq!(light.sample_li(Vec2::splat(0.5), light.position).irradiance, Vec3::ZERO);
        let hot = Light::point(Vec3::ZERO, Vec3::splat(1e30));
        assert!(hot.sample_li(Vec2::ZERO, Vec3::new(1e-10, 0.0, 0.0)).irradiance.is_finite());
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
}
