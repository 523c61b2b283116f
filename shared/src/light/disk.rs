//! Disks that glow.

#[cfg(not(target_arch = "spirv"))]
use super::HostKind;
#[cfg(not(target_arch = "spirv"))]
use super::tree::Bound;
use super::{Kind, Light, Place, Shape};
use crate::math::cross;
#[cfg(not(target_arch = "spirv"))]
use crate::math::{basis, normalize_or};
use crate::sampling::square_to_disk;
#[cfg(not(target_arch = "spirv"))]
use core::f32::consts::{FRAC_PI_2, PI};
use glam::{Vec2, Vec3};

/// A disk whose every point radiates evenly (Lambertian) to one side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disk {
    /// World space, m.
    pub center: Vec3,
    /// Two radii at right angles, m: it shines along their cross product.
    pub radii: [Vec3; 2],
    /// m²
    pub area: f32,
    /// nit, linear RGB.
    pub radiance: Vec3,
}

impl Kind for Disk {
    const SHAPE: Shape = Shape::Surface;
    const HAS_EXTENT: bool = true;

    fn of(light: &Light) -> Self {
        Disk {
            center: light.position,
            radii: [light.edge1, light.edge2],
            area: light.area,
            radiance: light.emission,
        }
    }

    fn place(self, square: Vec2) -> Place {
        let [u, v] = self.radii;
        let at = square_to_disk(square);
        Place {
            position: self.center + at.x * u + at.y * v,
            normal: cross(u, v),
            magnitude: self.center.abs().max(u.abs()).max(v.abs()).max_element(),
        }
    }

    fn measure(self) -> f32 {
        self.area
    }
}

#[cfg(not(target_arch = "spirv"))]
impl HostKind for Disk {
    const NAME: &'static str = "disk";
    const LIGHTS: &'static str = "disks";

    fn numbers(self) -> Light {
        Light {
            position: self.center,
            edge1: self.radii[0],
            edge2: self.radii[1],
            area: self.area,
            emission: self.radiance,
            ..Light::default()
        }
    }

    fn bound(self) -> Option<Bound> {
        let [u, v] = self.radii;
        let axis = normalize_or(cross(u, v), Vec3::Y);
        Some(Bound { axis, angle: FRAC_PI_2, ..disk_bound(self.center, u.length(), axis) })
    }

    /// π A
    fn flux_factor(self) -> f32 {
        PI * self.area
    }
}

/// Around a disk across `axis` (unit), which shines everywhere.
#[cfg(not(target_arch = "spirv"))]
pub(super) fn disk_bound(center: Vec3, radius: f32, axis: Vec3) -> Bound {
    let reach = (Vec3::ONE - axis * axis).max(Vec3::ZERO).map(f32::sqrt) * radius;
    Bound { min: center - reach, max: center + reach, ..Bound::point(center) }
}

#[cfg(not(target_arch = "spirv"))]
impl Light {
    /// A disk that shines along `axis` (unit). `center` and `radius` in m, `radiance` in nit.
    pub fn disk(center: Vec3, axis: Vec3, radius: f32, radiance: Vec3) -> Self {
        let (u, v) = basis(axis);
        let area = (core::f64::consts::PI * f64::from(radius) * f64::from(radius)) as f32;
        Disk { center, radii: [u * radius, v * radius], area, radiance }.light()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::sampling_tests::{COLOR, Known, Sample, brightness, irradiance};

    impl Sample for Disk {
        fn known(strength: f32) -> Known {
            let axis = Vec3::new(0.36, -0.48, 0.8);
            let light = Light::disk(Vec3::new(strength, 1.0, 0.0), axis, 0.3 * strength, COLOR * strength);
            let area = core::f64::consts::PI * (0.3 * f64::from(strength)).powi(2);
            Known { light, power: core::f64::consts::PI * area * brightness(strength), measure: area }
        }

        fn quarter(self, place: Vec3) -> usize {
            let right = |radius: Vec3| usize::from((place - self.center).dot(radius) > 0.0);
            right(self.radii[0]) + 2 * right(self.radii[1])
        }
    }

    /// E = π L r² / (r² + h²) on the axis.
    #[test]
    fn irradiance_on_the_axis_in_closed_form() {
        for (radius, height) in [(0.5f32, 2.0f32), (1.0, 0.8), (1e-3, 1.0)] {
            let axis = Vec3::new(0.6, 0.0, -0.8);
            let light = Light::disk(Vec3::new(1.0, 2.0, 3.0), axis, radius, Vec3::splat(7.0));
            let sum = irradiance(&light, light.position + axis * height, -axis);
            let (r2, h2) = (f64::from(radius).powi(2), f64::from(height).powi(2));
            let exact = core::f64::consts::PI * 7.0 * r2 / (r2 + h2);
            assert!((sum / exact - 1.0).abs() < 1e-4, "r {radius}, h {height}: {sum} instead of {exact}");
            let wider = Light::disk(light.position, axis, radius * 1.01, Vec3::splat(7.0));
            let wider = irradiance(&wider, light.position + axis * height, -axis);
            assert!((wider / exact - 1.0).abs() > 5e-4, "a radius larger by 1 % was not seen");
            assert_eq!(irradiance(&light, light.position - axis * height, axis), 0.0, "its back is dark");
        }
    }

    #[test]
    fn its_box_is_tight() {
        for axis in [Vec3::Y, Vec3::new(0.36, -0.48, 0.8)] {
            let light = Light::disk(Vec3::ONE, axis, 2.0, Vec3::ONE);
            let bound = light.bound().unwrap();
            let mut reached = Vec3::splat(-9.0);
            for i in 0..10_000 {
                let square = Vec2::new(1.0 - 1e-6, i as f32 / 10_000.0);
                let place = light.place(square, u32::MAX).position;
                reached = reached.max(place);
                assert!(
                    (place - bound.min).min_element() > -1e-5 && (bound.max - place).min_element() > -1e-5
                );
            }
            assert!((reached - bound.max).abs().max_element() < 1e-4);
            assert!((bound.axis - axis).length() < 1e-6);
        }
    }
}
