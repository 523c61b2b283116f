//! The origin of a scene: positions far from zero lose digits in f32, so they are kept relative to a point among them.

use crate::scene::Primitive;
use glam::{DVec3, Vec3};

/// Where the middle of a thing is so many of its radii from zero, its positions have lost log2 of that many bits: 4.
const FAR: f64 = 16.0;

/// A box in f64, m.
#[derive(Clone, Copy, Debug)]
pub struct Extent {
    min: DVec3,
    max: DVec3,
}

impl Default for Extent {
    fn default() -> Self {
        Extent { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY }
    }
}

impl Extent {
    pub fn add(&mut self, p: DVec3) {
        (self.min, self.max) = (self.min.min(p), self.max.max(p));
    }

    /// The point that positions are best kept relative to: the middle if that is far from zero, else zero.
    pub fn origin(&self) -> DVec3 {
        let (center, radius) = (0.5 * (self.min + self.max), 0.5 * (self.max - self.min).length());
        // Not so for boxes that are empty, infinite or no box.
        if center.is_finite() && center.length() > FAR * radius { center } else { DVec3::ZERO }
    }
}

/// Moves `primitives` to their [`Extent::origin`], and gives that point: where they were, in object space.
pub fn recenter(primitives: &mut [Primitive]) -> DVec3 {
    let mut extent = Extent::default();
    primitives.iter().flat_map(|primitive| &primitive.positions).for_each(|p| extent.add(p.as_dvec3()));
    // As f32 has it: then the differences are exact.
    let origin = extent.origin().as_vec3();
    if origin != Vec3::ZERO {
        primitives.iter_mut().flat_map(|primitive| &mut primitive.positions).for_each(|p| *p -= origin);
    }
    origin.as_dvec3()
}
