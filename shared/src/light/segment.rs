//! Glowing segments: the example of docs/adding-a-light.md. It is in the list of kinds in tests alone.

use super::tree::Bound;
use super::{HostKind, Kind, Light, Place, Shape};
use core::f32::consts::PI;
use glam::{Vec2, Vec3};

/// A segment without thickness that radiates as a thin tube does: with the sine of the angle from its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// World space, m.
    pub start: Vec3,
    /// From there to its end, m.
    pub edge: Vec3,
    /// Across the axis, of each metre, cd/m, linear RGB.
    pub intensity: Vec3,
}

impl Kind for Segment {
    const SHAPE: Shape = Shape::Point;
    const HAS_EXTENT: bool = true;
    const ATTENUATES: bool = true;

    fn of(light: &Light) -> Self {
        Segment { start: light.position, edge: light.edge1, intensity: light.emission }
    }

    fn place(self, square: Vec2) -> Place {
        Place::at(self.start + square.x * self.edge)
    }

    fn measure(self) -> f32 {
        self.edge.length()
    }

    fn attenuation(self, direction: Vec3) -> f32 {
        direction.cross(self.edge.normalize_or_zero()).length()
    }
}

impl HostKind for Segment {
    const NAME: &'static str = "segment";
    const LIGHTS: &'static str = "glowing segments";

    fn numbers(self) -> Light {
        Light { position: self.start, edge1: self.edge, emission: self.intensity, ..Light::default() }
    }

    fn bound(self) -> Option<Bound> {
        let end = self.start + self.edge;
        Some(Bound { min: self.start.min(end), max: self.start.max(end), ..Bound::point(self.start) })
    }

    /// ∫ sinθ dω = π² a metre.
    fn flux_factor(self) -> f32 {
        PI * PI * self.edge.length()
    }
}

mod tests {
    use super::*;
    use crate::light::sampling_tests::{COLOR, Known, Sample, brightness};

    impl Sample for Segment {
        fn known(strength: f32) -> Known {
            let edge = Vec3::new(0.6, 0.0, 0.8) * strength;
            let light = Segment { start: Vec3::Y, edge, intensity: COLOR * strength }.light();
            let length = f64::from(strength);
            Known { light, power: f64::from(PI).powi(2) * length * brightness(strength), measure: length }
        }

        fn quarter(self, place: Vec3) -> usize {
            (4.0 * (place - self.start).dot(self.edge) / self.edge.length_squared()) as usize
        }
    }

    /// Irradiance at a distance h from the middle of a segment of half length a, facing it:
    /// ∫ I h² / d⁴ dl = I [a / (h² + a²) + atan(a / h) / h].
    #[test]
    fn sampled_segment_gives_the_irradiance_of_its_closed_form() {
        let (a, h) = (1.5f64, 0.7f64);
        let (start, edge) = (Vec3::new(-1.5, 0.7, 0.0), Vec3::X * 3.0);
        let light = Segment { start, edge, intensity: Vec3::splat(2.0) }.light();
        let exact = 2.0 * (a / (h * h + a * a) + (a / h).atan() / h);
        let n = 10_000;
        let at = |i| light.sample_li(Vec2::new((i as f32 + 0.5) / n as f32, 0.5), Vec3::ZERO);
        let mean =
            (0..n).map(|i| f64::from(at(i).irradiance.x * at(i).direction.y)).sum::<f64>() / f64::from(n);
        let sum = mean / f64::from(light.pdf_li().0);
        assert!((sum / exact - 1.0).abs() < 1e-4, "{sum} instead of {exact} lx");
    }
}
