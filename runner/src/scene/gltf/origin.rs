//! Things far from zero: f32 has few digits left there, so positions are kept relative to a point among them.

use crate::scene::{Mesh, Primitive};
use glam::{DAffine3, DVec3, Vec3};

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
    /// Adds the box around `mesh` where `world` puts it.
    pub fn add(&mut self, mesh: &Mesh, world: &DAffine3) {
        let bounds = mesh.bounds();
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        for corner in 0..8 {
            let pick = |axis: usize| if corner >> axis & 1 == 0 { min[axis] } else { max[axis] };
            let corner = world.transform_point3(DVec3::new(pick(0), pick(1), pick(2)));
            (self.min, self.max) = (self.min.min(corner), self.max.max(corner));
        }
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
    for &p in primitives.iter().flat_map(|primitive| &primitive.positions) {
        (extent.min, extent.max) = (extent.min.min(p.as_dvec3()), extent.max.max(p.as_dvec3()));
    }
    // As f32 has it: then the differences are exact.
    let origin = extent.origin().as_vec3();
    if origin != Vec3::ZERO {
        primitives.iter_mut().flat_map(|primitive| &mut primitive.positions).for_each(|p| *p -= origin);
    }
    origin.as_dvec3()
}
