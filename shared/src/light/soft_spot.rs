//! Spot lights with a radius.

#[cfg(not(target_arch = "spirv"))]
use super::HostKind;
#[cfg(not(target_arch = "spirv"))]
use super::disk::disk_bound;
use super::spot::Spot;
#[cfg(not(target_arch = "spirv"))]
use super::tree::Bound;
use super::{Kind, Light, Place, Shape};
use crate::math::basis;
use crate::sampling::square_to_disk;
use glam::{Vec2, Vec3};

/// A disk of spots: the flux of one is spread evenly over its points, and each keeps the cone. From afar it is that spot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoftSpot {
    /// In the middle of the disk, with the whole intensity.
    pub spot: Spot,
    /// m
    pub radius: f32,
}

impl Kind for SoftSpot {
    const SHAPE: Shape = Shape::Point;
    const HAS_EXTENT: bool = true;
    const ATTENUATES: bool = true;

    fn of(light: &Light) -> Self {
        SoftSpot { spot: Spot::of(light), radius: light.edge2.z }
    }

    fn place(self, square: Vec2) -> Place {
        let (u, v) = basis(self.spot.axis);
        let at = square_to_disk(square) * self.radius;
        Place::at(self.spot.position + at.x * u + at.y * v)
    }

    fn attenuation(self, direction: Vec3) -> f32 {
        self.spot.attenuation(direction)
    }
}

#[cfg(not(target_arch = "spirv"))]
impl HostKind for SoftSpot {
    const NAME: &'static str = "spot with a radius";
    const LIGHTS: &'static str = "spot lights with a radius";

    fn numbers(self) -> Light {
        let light = self.spot.numbers();
        Light { edge2: Vec3::new(light.edge2.x, light.edge2.y, self.radius), ..light }
    }

    fn bound(self) -> Option<Bound> {
        let Bound { axis, angle, .. } = self.spot.bound()?;
        Some(Bound { axis, angle, ..disk_bound(self.spot.position, self.radius, axis) })
    }

    fn flux_factor(self) -> f32 {
        self.spot.flux_factor()
    }
}

#[cfg(not(target_arch = "spirv"))]
impl Light {
    /// A [`Light::spot`] with a radius in m: a disk across its axis.
    pub fn soft_spot(self, radius: f32) -> Self {
        SoftSpot { spot: Spot::of(&self), radius }.light()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::sampling_tests::{COLOR, Known, Sample, brightness, irradiance};
    use core::f64::consts::TAU;

    impl Sample for SoftSpot {
        fn known(strength: f32) -> Known {
            let (inner, outer) = (0.3f64, 0.8f64);
            let spot = Light::spot(Vec3::ONE, Vec3::Z, COLOR * strength, inner as f32, outer as f32);
            let solid_angle = TAU * ((1.0 - inner.cos()) + (inner.cos() - outer.cos()) / 3.0);
            let light = spot.soft_spot(0.2 * strength);
            Known { light, power: solid_angle * brightness(strength), measure: 1.0 }
        }

        fn quarter(self, place: Vec3) -> usize {
            let at = place - self.spot.position;
            let (u, v) = basis(self.spot.axis);
            usize::from(at.dot(u) > 0.0) + 2 * usize::from(at.dot(v) > 0.0)
        }
    }

    /// On the axis, all of it within the full cone: E = I/(π r²) ∫ cosθ/d² dA = 2 I/r² (1 - h / √(h² + r²)).
    #[test]
    fn irradiance_on_the_axis_in_closed_form() {
        let (radius, height) = (0.4f64, 1.0f64);
        let spot = Light::spot(Vec3::new(1.0, 2.0, 0.5), -Vec3::Y, Vec3::splat(9.0), 0.9, 1.0);
        let sum = irradiance(&spot.soft_spot(radius as f32), spot.position - Vec3::Y, Vec3::Y);
        let exact = 2.0 * 9.0 / radius.powi(2) * (1.0 - height / (height.powi(2) + radius.powi(2)).sqrt());
        assert!((sum / exact - 1.0).abs() < 1e-4, "{sum} instead of {exact}");
        assert!((9.0 / exact - 1.0).abs() > 0.05, "a point would do as well");
    }

    #[test]
    fn from_afar_it_is_its_spot() {
        let spot = Light::spot(Vec3::ZERO, -Vec3::Y, Vec3::splat(9.0), 0.2, 0.7);
        let soft = spot.soft_spot(0.05);
        for angle in [0.0f32, 0.3, 0.5, 0.6] {
            let place = 100.0 * Vec3::new(angle.sin(), -angle.cos(), 0.0);
            let one = irradiance(&spot, place, Vec3::Y);
            let other = irradiance(&soft, place, Vec3::Y);
            assert!((other / one - 1.0).abs() < 2e-3, "{angle} rad: {other} instead of {one}");
        }
        assert_eq!(irradiance(&soft, Vec3::new(100.0, -100.0, 0.0), Vec3::Y), 0.0);
        assert_eq!(soft.power, spot.power);
    }
}
