//! The one question that needs hardware: does a light sample reach a surface?

use crate::light::Incident;
use crate::math::offset_ray_origin;
use crate::surface::Surface;
use glam::Vec3;

/// A segment to test, from `origin` to `origin + direction` (so t runs from 0 to 1). World space, m.
#[derive(Clone, Copy, Debug, Default)]
pub struct ShadowRay {
    /// Where it starts.
    pub origin: Vec3,
    /// From there to its end.
    pub direction: Vec3,
}

impl ShadowRay {
    /// From `surface` to the sampled point of a light; both ends are moved off the surfaces they lie on.
    pub fn new(surface: &Surface, incident: &Incident) -> Self {
        let to_light = incident.direction * incident.distance;
        let origin = surface.ray_origin(surface.geometric_normal.dot(to_light));
        let room = -incident.normal.dot(to_light);
        let end = offset_ray_origin(incident.position, incident.normal, incident.magnitude, room);
        ShadowRay { origin, direction: end - origin }
    }
}
