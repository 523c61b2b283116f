//! Parallel light (KHR_lights_punctual), such as the sun's.

#[cfg(not(target_arch = "spirv"))]
use super::HostKind;
#[cfg(not(target_arch = "spirv"))]
use super::tree::Bound;
use super::{Kind, Light, Place, Shape};
use glam::{Vec2, Vec3};

/// Light from one direction, alike everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Directional {
    /// Unit, toward the light.
    pub direction: Vec3,
    /// On a surface that faces it, lx, linear RGB.
    pub illuminance: Vec3,
    /// Radius of the scene's bounding sphere, m.
    pub radius: f32,
}

impl Kind for Directional {
    const SHAPE: Shape = Shape::Infinity;

    fn of(light: &Light) -> Self {
        Directional { direction: light.edge1, illuminance: light.emission, radius: light.edge2.x }
    }

    fn place(self, _: Vec2) -> Place {
        Place::at(self.direction)
    }
}

#[cfg(not(target_arch = "spirv"))]
impl HostKind for Directional {
    const NAME: &'static str = "directional";
    const LIGHTS: &'static str = "directional lights";

    fn numbers(self) -> Light {
        let edge2 = Vec3::new(self.radius, 0.0, 0.0);
        Light { edge1: self.direction, edge2, emission: self.illuminance, ..Light::default() }
    }

    fn bound(self) -> Option<Bound> {
        None
    }

    /// π r²: what falls into the scene's bounding sphere.
    fn flux_factor(self) -> f32 {
        core::f32::consts::PI * self.radius * self.radius
    }
}

#[cfg(not(target_arch = "spirv"))]
impl Light {
    /// Parallel light from `direction` (unit, toward the light) on a scene with a bounding sphere of `radius` m.
    /// `illuminance` in lx on a surface that faces it.
    pub fn directional(direction: Vec3, illuminance: Vec3, radius: f32) -> Self {
        Directional { direction, illuminance, radius }.light()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::build_alias_table;
    use crate::light::sampling_tests::{COLOR, Known, RADIUS, Sample, brightness};
    use crate::math::luminance;
    use core::f64::consts::PI;

    impl Sample for Directional {
        fn known(strength: f32) -> Known {
            let light = Light::directional(Vec3::Y, COLOR * strength, RADIUS);
            Known { light, power: PI * f64::from(RADIUS).powi(2) * brightness(strength), measure: 1.0 }
        }
    }

    #[test]
    fn it_is_the_same_everywhere() {
        let direction = Vec3::new(1.0, 2.0, -2.0) / 3.0;
        let illuminance = Vec3::new(3.0, 2.0, 1.0);
        let light = Light::directional(direction, illuminance, 10.0);
        assert!((light.power - PI as f32 * 100.0 * luminance(illuminance)).abs() < 1e-2);
        assert_eq!(light.pdf_li().0, 1.0);
        for receiver in [Vec3::ZERO, Vec3::new(0.0, -10.0, 0.0), direction * -10.0] {
            let incident = light.sample_li(Vec2::splat(0.1), receiver);
            assert_eq!((incident.direction, incident.irradiance), (direction, illuminance));
            assert!(incident.position.length() > 10.0, "the shadow ray leaves the bounding sphere");
            assert!((incident.position - receiver).normalize().dot(direction) > 0.999_999);
        }
    }

    #[test]
    fn a_flux_beyond_all_numbers_is_still_drawn() {
        let light = Light::directional(Vec3::Y, Vec3::splat(1e12), 1e15);
        assert_eq!(light.power, f32::MAX);
        assert!(build_alias_table(&[light])[0].pmf == 1.0);
    }
}
