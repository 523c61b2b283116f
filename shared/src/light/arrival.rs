//! What arrives at a receiver from a point on a light.

use super::kinds::{attenuates, is_shape};
use super::{DOUBLE_SIDED, Incident, Light, Shape, UNTRACEABLE};
use crate::math::{inverse_sqrt, normalize_or};
use glam::{Vec2, Vec3};

/// How far light from infinity is followed, in radii of the scene: from any point of the bounding sphere to beyond it.
const REACH: f32 = 2.01;

impl Light {
    /// The point `square` of this light as seen from `receiver` (world space, m). A light at the receiver itself, or one
    /// seen from behind or edge-on, gives no irradiance; nothing here is ever NaN or infinite for finite input.
    pub fn sample_li(&self, square: Vec2, receiver: Vec3) -> Incident {
        self.sample_li_among(u32::MAX, square, receiver)
    }

    /// The same where `features` (as in [`super::Lights`]) says which kinds there are.
    pub fn sample_li_among(&self, features: u32, square: Vec2, receiver: Vec3) -> Incident {
        if is_shape(self.kind, Shape::Seen, features) {
            return self.seen(square, receiver, features);
        }
        let place = self.place(square, features);
        if is_shape(self.kind, Shape::Infinity, features) {
            let direction = place.position;
            let distance = REACH * self.scene_radius();
            return Incident {
                position: receiver + direction * distance,
                direction,
                distance,
                irradiance: self.emission,
                solid_angle: traceable(self.flags),
                ..Incident::default()
            };
        }
        let ray = Connection::new(receiver, place.position);
        let Connection { direction, distance, .. } = ray;
        if is_shape(self.kind, Shape::Surface, features) {
            let mut normal = normalize_or(place.normal, Vec3::ZERO);
            if self.flags & DOUBLE_SIDED != 0 && normal.dot(direction) > 0.0 {
                normal = -normal;
            }
            let cos_light = (-normal.dot(direction)).max(0.0);
            return Incident {
                position: place.position,
                normal,
                magnitude: place.magnitude,
                direction,
                distance,
                irradiance: fall_off(self.emission, cos_light, &ray),
                solid_angle: traceable(self.flags) * cos_light * ray.inverse_square,
            };
        }
        let incident = from_point(place.position, &ray, self.emission);
        if attenuates(self.kind, features) {
            let irradiance = incident.irradiance * self.attenuation(incident.direction, features);
            return Incident { irradiance, ..incident };
        }
        incident
    }
}

/// 1 for a light that rays can find, else 0.
pub(super) fn traceable(flags: u32) -> f32 {
    if flags & UNTRACEABLE == 0 { 1.0 } else { 0.0 }
}

/// Light of `intensity` (cd) from the point where `ray` ends.
pub(super) fn from_point(position: Vec3, ray: &Connection, intensity: Vec3) -> Incident {
    let Connection { direction, distance, .. } = *ray;
    let irradiance = fall_off(intensity, 1.0, ray);
    Incident { position, direction, distance, irradiance, ..Incident::default() }
}

/// From a receiver to a point.
pub(super) struct Connection {
    /// Unit; 0 between equal points.
    pub direction: Vec3,
    /// m
    pub distance: f32,
    /// 1/d², 1/m²; 0 between equal points.
    pub inverse_square: f32,
}

impl Connection {
    /// Points nearer than 1e-15 m count as equal: d² has to be a normal number.
    pub(super) fn new(from: Vec3, to: Vec3) -> Self {
        let v = to - from;
        let square = v.length_squared();
        let inverse = if square > 1e-30 { inverse_sqrt(square) } else { 0.0 };
        Connection { direction: v * inverse, distance: square * inverse, inverse_square: inverse * inverse }
    }
}

/// emission cosθ' / d². Components that overflow become the largest number: one absurdly near light must not make a NaN
/// pixel.
fn fall_off(emission: Vec3, cos_light: f32, ray: &Connection) -> Vec3 {
    reach(emission, cos_light * ray.inverse_square)
}

/// emission x `share`, as far as f32 goes.
pub(super) fn reach(emission: Vec3, share: f32) -> Vec3 {
    let e = emission * share;
    Vec3::new(e.x.min(1e30), e.y.min(1e30), e.z.min(1e30))
}
