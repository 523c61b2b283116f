//! How many lights a scene has, and how close together they are: knobs that decide for themselves ask.

use super::Light;
use glam::Vec3;
use std::ops::RangeInclusive;

/// So many lights.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LightCount {
    /// All.
    pub number: u32,
    /// Those that are somewhere, in the light tree.
    pub placed: u32,
    /// They, over the area of the largest side of the box around them, 1/m²; infinite where that has none.
    pub per_m2: f32,
}

impl LightCount {
    /// Of a scene.
    pub fn of(lights: &[Light]) -> Self {
        let bounds = lights.iter().filter_map(Light::bound);
        let (mut low, mut high, mut placed) = (Vec3::INFINITY, Vec3::NEG_INFINITY, 0u32);
        for bound in bounds {
            (low, high, placed) = (low.min(bound.min), high.max(bound.max), placed + 1);
        }
        let number = lights.len() as u32;
        if placed == 0 {
            return LightCount { number, placed, per_m2: 0.0 };
        }
        let side = high - low;
        let area = (side * Vec3::new(side.y, side.z, side.x)).max_element();
        LightCount { number, placed, per_m2: placed as f32 / area }
    }
}

/// Lights that are far apart.
impl From<u32> for LightCount {
    fn from(number: u32) -> Self {
        LightCount { number, placed: number, per_m2: 0.0 }
    }
}

/// With which lights a knob is on by itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Condition {
    /// How many there are.
    pub number: RangeInclusive<u32>,
    /// From so many on, only where at most that many lie on a m².
    pub sparse: Option<(u32, f32)>,
}

impl Condition {
    /// Is the knob on with `lights`?
    pub fn holds(&self, lights: LightCount) -> bool {
        let sparse = self.sparse.is_none_or(|(from, most)| lights.number < from || lights.per_m2 <= most);
        self.number.contains(&lights.number) && sparse
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lights_are_counted_over_the_largest_side_of_their_box() {
        let point = |x: f32, y: f32, z: f32| Light::point(Vec3::new(x, y, z), Vec3::ONE);
        let corners = [point(0.0, 0.0, 0.0), point(4.0, 1.0, 5.0)];
        assert_eq!(LightCount::of(&corners), LightCount { number: 2, placed: 2, per_m2: 0.1 });
        assert_eq!(LightCount::of(&corners[..1]), LightCount { number: 1, placed: 1, per_m2: f32::INFINITY });
        let sun = Light::directional(Vec3::Y, Vec3::ONE, 9.0);
        assert_eq!(LightCount::of(&[sun, sun, sun]), LightCount { number: 3, placed: 0, per_m2: 0.0 });
        assert_eq!(LightCount::of(&[]), LightCount::default());
    }

    #[test]
    fn many_lights_have_to_be_sparse() {
        let condition = Condition { number: 2..=u32::MAX, sparse: Some((100, 0.5)) };
        let holds = |number: u32, per_m2| condition.holds(LightCount { per_m2, ..number.into() });
        assert!(holds(2, f32::INFINITY) && holds(99, 9.0) && holds(100, 0.5));
        assert!(!holds(1, 0.1) && !holds(100, 0.6) && !holds(100, f32::INFINITY));
    }
}
