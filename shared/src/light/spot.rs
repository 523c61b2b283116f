//! Spot lights (KHR_lights_punctual).

#[cfg(not(target_arch = "spirv"))]
use super::HostKind;
#[cfg(not(target_arch = "spirv"))]
use super::tree::Bound;
use super::{Kind, Light, Place, Shape};
#[cfg(not(target_arch = "spirv"))]
use core::f32::consts::PI;
use glam::{Vec2, Vec3};

/// A point that radiates along its axis, and less around it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// World space, m.
    pub position: Vec3,
    /// Unit, the way it shines.
    pub axis: Vec3,
    /// a, the cosine of the outer angle: from there on it is dark.
    pub cos_outer: f32,
    /// 1 / (b - a), with b the cosine of the inner angle: up to there it is full.
    pub scale: f32,
    /// On the axis, cd, linear RGB.
    pub intensity: Vec3,
}

impl Kind for Spot {
    const SHAPE: Shape = Shape::Point;
    const ATTENUATES: bool = true;

    fn of(light: &Light) -> Self {
        Spot {
            position: light.position,
            axis: light.edge1,
            cos_outer: light.edge2.x,
            scale: light.edge2.y,
            intensity: light.emission,
        }
    }

    fn place(self, _: Vec2) -> Place {
        Place::at(self.position)
    }

    /// ((c - a) / (b - a))² between the cones, c the cosine of the angle from the axis.
    fn attenuation(self, direction: Vec3) -> f32 {
        let cos = -direction.dot(self.axis);
        let t = ((cos - self.cos_outer) * self.scale).clamp(0.0, 1.0);
        t * t
    }
}

#[cfg(not(target_arch = "spirv"))]
impl HostKind for Spot {
    const NAME: &'static str = "spot";
    const LIGHTS: &'static str = "spot lights";

    fn numbers(self) -> Light {
        let edge2 = Vec3::new(self.cos_outer, self.scale, 0.0);
        Light {
            position: self.position,
            edge1: self.axis,
            edge2,
            emission: self.intensity,
            ..Light::default()
        }
    }

    fn bound(self) -> Option<Bound> {
        let angle = self.cos_outer.clamp(-1.0, 1.0).acos();
        Some(Bound { axis: self.axis, angle, ..Bound::point(self.position) })
    }

    /// Integral of the attenuation over all directions, sr:
    /// 2π [(1 - b) + ∫ ((c - a) / (b - a))² dc] = 2π [(1 - b) + (b - a) / 3], c from a to b.
    fn flux_factor(self) -> f32 {
        let (a, width) = (self.cos_outer, 1.0 / self.scale);
        let full = 1.0 - (a + width);
        // Within the guard of 0.001 the intensity may not reach its full value: then c ends at 1.
        let integral =
            if full >= 0.0 { full + width / 3.0 } else { (1.0 - a).powi(3) / (3.0 * width * width) };
        2.0 * PI * integral
    }
}

#[cfg(not(target_arch = "spirv"))]
impl Light {
    /// A spot light that shines along `axis` (unit). `intensity` on the axis in cd; it is full up to `inner` rad from the
    /// axis and 0 from `outer` on (KHR_lights_punctual, "Inner and Outer Cone Angles").
    pub fn spot(position: Vec3, axis: Vec3, intensity: Vec3, inner: f32, outer: f32) -> Self {
        let [cos_inner, cos_outer] = [inner, outer].map(|angle| f64::from(angle).cos());
        // 0.001: the extension's own guard.
        let scale = (1.0 / (cos_inner - cos_outer).max(0.001)) as f32;
        Spot { position, axis, cos_outer: cos_outer as f32, scale, intensity }.light()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::sampling_tests::{COLOR, Known, Sample, brightness};
    use core::f64::consts::TAU;

    impl Sample for Spot {
        fn known(strength: f32) -> Known {
            let (inner, outer) = (0.3f64, 0.8f64);
            let light = Light::spot(Vec3::ONE, Vec3::Z, COLOR * strength, inner as f32, outer as f32);
            // Quadratic between the cones: a third of their difference counts.
            let solid_angle = TAU * ((1.0 - inner.cos()) + (inner.cos() - outer.cos()) / 3.0);
            Known { light, power: solid_angle * brightness(strength), measure: 1.0 }
        }
    }

    /// ∫ attenuation dω by quadrature, sr: independent of the closed form, from the extension's own formula in f64.
    fn quadrature(inner: f64, outer: f64) -> f64 {
        let scale = 1.0 / (inner.cos() - outer.cos()).max(0.001);
        let offset = -outer.cos() * scale;
        let n = 1_000_000;
        let step = (1.0 - outer.cos()) / f64::from(n);
        let ring = |i: i32| {
            let cos = outer.cos() + (f64::from(i) + 0.5) * step;
            (cos * scale + offset).clamp(0.0, 1.0).powi(2)
        };
        TAU * step * (0..n).map(ring).sum::<f64>()
    }

    #[test]
    fn power_is_the_integral_of_the_attenuation() {
        for (inner, outer) in
            [(0.0, 0.785), (0.3, 0.6), (0.5, 0.5), (0.0, 1.57), (1.5, 1.57), (0.0, 0.03), (0.2, 0.201)]
        {
            let light = Light::spot(Vec3::ZERO, Vec3::Z, Vec3::splat(5.0), inner, outer);
            let exact = 5.0 * quadrature(inner.into(), outer.into());
            let error = f64::from(light.power) / exact - 1.0;
            // 1 - cos of 0.03 rad has lost three digits in f32.
            assert!(error.abs() < 1e-3, "{inner} to {outer} rad: {} instead of {exact} lm", light.power);
        }
    }

    #[test]
    fn light_fades_from_the_inner_to_the_outer_cone() {
        let (inner, outer) = (0.4f32, 0.7f32);
        let light = Light::spot(Vec3::new(1.0, 4.0, 1.0), -Vec3::Y, Vec3::new(16.0, 32.0, 8.0), inner, outer);
        assert_eq!(light.pdf_li().0, 1.0);
        // 4 m from the light at `angle` from its axis.
        let at = |angle: f32| {
            let place = light.position + 4.0 * Vec3::new(angle.sin(), -angle.cos(), 0.0);
            light.sample_li(Vec2::splat(0.5), place).irradiance
        };
        for angle in [0.0, 0.2, 0.399] {
            assert!((at(angle) - Vec3::new(1.0, 2.0, 0.5)).length() < 1e-5, "full inside: {}", at(angle));
        }
        let halfway = (0.5 * (inner.cos() + outer.cos())).acos();
        assert!((at(halfway).x - 0.25).abs() < 1e-4, "a quarter at the middle cosine: {}", at(halfway));
        for angle in [0.7001, 1.0, 2.0, PI] {
            assert_eq!(at(angle), Vec3::ZERO, "dark from the outer cone on");
        }
        assert_eq!(light.sample_li(Vec2::ZERO, light.position).irradiance, Vec3::ZERO);
    }
}
