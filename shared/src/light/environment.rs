//! Texels of an environment map, see [`crate::environment`].

#[cfg(not(target_arch = "spirv"))]
use super::HostKind;
#[cfg(not(target_arch = "spirv"))]
use super::tree::Bound;
use super::{Kind, Light, Place, Shape};
use crate::environment;
use crate::math::safe_ratio;
#[cfg(not(target_arch = "spirv"))]
use glam::UVec2;
use glam::{Vec2, Vec3};

/// Even light from every direction of a texel: a rectangle in φ and cosθ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Texel {
    /// φ of its left edge, and cosθ of its lower one.
    pub corner: Vec2,
    /// Width in φ, height in cosθ.
    pub extent: Vec2,
    /// Computed in f64, sr.
    pub solid_angle: f32,
    /// nit, linear RGB.
    pub radiance: Vec3,
    /// Radius of the scene's bounding sphere, m.
    pub radius: f32,
}

impl Kind for Texel {
    const SHAPE: Shape = Shape::Infinity;
    const HAS_EXTENT: bool = true;
    const TRACEABLE: bool = true;

    fn of(light: &Light) -> Self {
        Texel {
            corner: light.edge1.truncate(),
            extent: Vec2::new(light.edge2.y, light.edge2.z),
            solid_angle: light.area,
            radiance: light.emission,
            radius: light.edge2.x,
        }
    }

    fn place(self, square: Vec2) -> Place {
        let cos_theta = self.corner.y + square.y * self.extent.y;
        Place::at(environment::direction(cos_theta, self.corner.x + square.x * self.extent.x))
    }

    fn measure(self) -> f32 {
        self.solid_angle
    }

    fn invert(self, direction: Vec3, _: Vec3) -> Vec2 {
        let (cos_theta, phi) = environment::angles(direction);
        let place = Vec2::new(phi - self.corner.x, cos_theta - self.corner.y);
        Vec2::new(safe_ratio(place.x, self.extent.x), safe_ratio(place.y, self.extent.y))
    }
}

#[cfg(not(target_arch = "spirv"))]
impl HostKind for Texel {
    const NAME: &'static str = "environment";
    const LIGHTS: &'static str = "environment lights";

    fn numbers(self) -> Light {
        Light {
            edge1: self.corner.extend(0.0),
            edge2: Vec3::new(self.radius, self.extent.x, self.extent.y),
            area: self.solid_angle,
            emission: self.radiance,
            ..Light::default()
        }
    }

    fn bound(self) -> Option<Bound> {
        None
    }

    /// Ω π r²: what falls into the scene's bounding sphere.
    fn flux_factor(self) -> f32 {
        self.solid_angle * core::f32::consts::PI * self.radius * self.radius
    }
}

#[cfg(not(target_arch = "spirv"))]
impl Light {
    /// Texel `texel` (column, row from the top) of an environment map of `size`, its mean `radiance` in nit, for a scene
    /// with a bounding sphere of `radius` m.
    pub fn environment(texel: UVec2, size: UVec2, radiance: Vec3, radius: f32) -> Self {
        use core::f64::consts::{PI, TAU};
        let cos = |row: u32| (PI * f64::from(row) / f64::from(size.y)).cos();
        let (width, height) = (TAU / f64::from(size.x), cos(texel.y) - cos(texel.y + 1));
        let left = f64::from(texel.x) * width - PI;
        Texel {
            corner: Vec2::new(left as f32, cos(texel.y + 1) as f32),
            extent: Vec2::new(width as f32, height as f32),
            solid_angle: (width * height) as f32,
            radiance,
            radius,
        }
        .light()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::sampling_tests::{COLOR, Known, RADIUS, Sample, brightness};
    use core::f64::consts::{PI, TAU};

    impl Sample for Texel {
        fn known(strength: f32) -> Known {
            let size = UVec2::new(8, 4);
            let texel = UVec2::new(strength as u32 % 8, strength as u32 % 4);
            let light = Light::environment(texel, size, COLOR * strength, RADIUS);
            let height = |row: u32| (PI * f64::from(row) / 4.0).cos();
            let solid_angle = TAU / 8.0 * (height(texel.y) - height(texel.y + 1));
            let power = solid_angle * PI * f64::from(RADIUS).powi(2) * brightness(strength);
            Known { light, power, measure: solid_angle }
        }

        fn quarter(self, direction: Vec3) -> usize {
            let d = direction.as_dvec3();
            let (width, height) = (f64::from(self.extent.x), f64::from(self.extent.y));
            let right = d.z.atan2(d.x) - f64::from(self.corner.x) > 0.5 * width;
            let up = d.y - f64::from(self.corner.y) > 0.5 * height;
            usize::from(right) + 2 * usize::from(up)
        }
    }
}
