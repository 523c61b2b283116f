//! The past of a scene that moves: where points of an instance were in the previous frame, and what its light samples were.

use crate::light::{LightSample, Lights};
use crate::math::{normalize_or, safe_ratio};
use crate::reservoir::StoredReservoir;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// Index of no light: one that is new, or gone.
pub const NO_LIGHT: u32 = u32::MAX;

/// The way back from an instance's place in this frame to its place in the previous one: p -> p + D (p - c) + d. 64 bytes.
/// All zero: it stood still.
///
/// A displacement, not a matrix, and about a point c of the instance: near numbers, whatever the distance from the origin.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct InstanceMotion {
    /// Columns of D, the linear part minus the identity.
    pub axis_x: Vec3,
    /// Second column.
    pub axis_y: Vec3,
    /// Third column.
    pub axis_z: Vec3,
    /// c: the instance's origin now, world space, m.
    pub pivot: Vec3,
    /// d: from there to its origin in the previous frame, m.
    pub shift: Vec3,
    /// 0
    pub padding: u32,
}

impl InstanceMotion {
    /// From a point of the instance now (world space, m) to where it was.
    pub fn displacement(&self, position: Vec3) -> Vec3 {
        let p = position - self.pivot;
        self.axis_x * p.x + self.axis_y * p.y + self.axis_z * p.z + self.shift
    }

    /// A unit normal of the instance now, as it was.
    pub fn normal(&self, normal: Vec3) -> Vec3 {
        let (x, y, z) = (Vec3::X + self.axis_x, Vec3::Y + self.axis_y, Vec3::Z + self.axis_z);
        // The cofactor matrix is the inverse transpose but for a factor.
        normalize_or(y.cross(z) * normal.x + z.cross(x) * normal.y + x.cross(y) * normal.z, normal)
    }
}

#[cfg(not(target_arch = "spirv"))]
impl InstanceMotion {
    /// Between two places (object to world) of an instance. One that is flat now only shifts; one that stood still is all zero.
    pub fn between(previous: glam::Affine3A, current: glam::Affine3A) -> Self {
        if previous == current {
            return InstanceMotion::default();
        }
        let (before, now) = (previous.matrix3.as_dmat3(), current.matrix3.as_dmat3());
        let back = before * now.inverse();
        let d = if back.is_finite() { back - glam::DMat3::IDENTITY } else { glam::DMat3::ZERO };
        InstanceMotion {
            axis_x: d.x_axis.as_vec3(),
            axis_y: d.y_axis.as_vec3(),
            axis_z: d.z_axis.as_vec3(),
            pivot: current.translation.into(),
            shift: (previous.translation.as_dvec3() - current.translation.as_dvec3()).as_vec3(),
            padding: 0,
        }
    }
}

/// The lights of the previous frame, and how its indices and this frame's belong together.
#[derive(Clone, Copy)]
pub struct PastLights<'a> {
    /// As the previous frame had them.
    pub lights: Lights<'a>,
    /// This frame's index of each light of the previous frame, or [`NO_LIGHT`]. Lights beyond its end kept theirs.
    pub previous_to_current: &'a [u32],
    /// The inverse.
    pub current_to_previous: &'a [u32],
}

fn mapped(map: &[u32], light: u32) -> u32 {
    if light < map.len() as u32 { map[light as usize] } else { light }
}

impl<'a> PastLights<'a> {
    /// What `sample` of this frame was in the previous frame: the same place on the same light. Of a new light: no light.
    pub fn before(self, sample: LightSample) -> LightSample {
        LightSample { light: mapped(self.current_to_previous, sample.light), ..sample }
    }

    /// What `sample` of the previous frame is now. Of a light that is gone: no light.
    pub fn now(self, sample: LightSample) -> LightSample {
        LightSample { light: mapped(self.previous_to_current, sample.light), ..sample }
    }

    /// |∂y'/∂y| of the map from this frame's samples y to the previous frame's y': the ratio of the light's areas, 1 for
    /// what has none. 0 for a light without a past.
    ///
    /// Equation (27).
    pub fn jacobian(self, lights: Lights<'a>, current: u32, previous: u32) -> f32 {
        safe_ratio(lights.pdf_li(current).0, self.lights.pdf_li(previous).0)
    }

    /// A reservoir of the previous frame as one of this frame. The sample of a light that is gone weighs nothing, but its
    /// candidates count: the others of its stream were drawn no more often for it.
    ///
    /// Equation (28).
    pub fn carried(self, lights: Lights<'a>, history: StoredReservoir) -> StoredReservoir {
        let sample = self.now(history.sample);
        let jacobian = self.jacobian(lights, sample.light, history.sample.light);
        StoredReservoir {
            sample,
            contribution_weight: safe_ratio(history.contribution_weight, jacobian),
            confidence: history.confidence,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::Light;
    use glam::{Affine3A, Mat3, Quat};

    fn place(turn: Quat, scale: Vec3, at: Vec3) -> Affine3A {
        Affine3A::from_scale_rotation_translation(scale, turn, at)
    }

    /// Points of an object, mapped back by hand: previous · current⁻¹ in f64.
    #[test]
    fn points_go_back_to_where_they_were() {
        let pairs = [
            (place(Quat::IDENTITY, Vec3::ONE, Vec3::ZERO), place(Quat::IDENTITY, Vec3::ONE, Vec3::X)),
            (
                place(Quat::from_rotation_y(0.3), Vec3::ONE, Vec3::new(1e4, 2.0, -1e4)),
                place(Quat::from_rotation_y(0.35), Vec3::ONE, Vec3::new(1e4 + 0.1, 2.0, -1e4)),
            ),
            (
                place(Quat::from_rotation_x(1.0), Vec3::new(1.0, 2.0, 0.5), Vec3::new(3.0, 0.0, 1.0)),
                place(Quat::from_rotation_z(2.0), Vec3::new(-1.0, 1.5, 0.7), Vec3::new(-3.0, 1.0, 1.0)),
            ),
        ];
        for (before, now) in pairs {
            let motion = InstanceMotion::between(before, now);
            for i in 0..50 {
                let t = i as f32 / 50.0;
                let object = Vec3::new(t - 0.5, (7.0 * t).sin(), (5.0 * t).cos());
                let world = |place: Affine3A| {
                    place.matrix3.as_dmat3() * object.as_dvec3() + place.translation.as_dvec3()
                };
                let expected = world(before) - world(now);
                let found = motion.displacement(world(now).as_vec3());
                // f32 positions at 1e4 m are good to 1e-3 m; the displacement is a small multiple of it, not of 1e4.
                let ulp = now.translation.abs().max_element().max(1.0) * f32::EPSILON;
                let error = (found.as_dvec3() - expected).abs().max_element();
                let scale = Mat3::from_cols(motion.axis_x, motion.axis_y, motion.axis_z)
                    .to_cols_array()
                    .iter()
                    .fold(1.0f32, |a, b| a.max(b.abs()));
                assert!(error <= f64::from(8.0 * ulp * scale), "{found} instead of {expected}");
            }
        }
    }

    #[test]
    fn still_is_exactly_still() {
        let here = place(Quat::from_rotation_y(0.7), Vec3::splat(2.0), Vec3::new(5.0, -3.0, 100.0));
        let motion = InstanceMotion::between(here, here);
        let point = Vec3::new(4.0, 2.0, 99.0);
        assert!(motion.displacement(point).abs().max_element() < 1e-6);
        assert_eq!(InstanceMotion::default().displacement(point), Vec3::ZERO);
        assert_eq!(InstanceMotion::default().normal(Vec3::Z), Vec3::Z);
        // Flat: no inverse, but a shift.
        let flat = Affine3A::from_scale(Vec3::new(1.0, 0.0, 1.0));
        let moved = Affine3A::from_translation(Vec3::X) * flat;
        assert_eq!(InstanceMotion::between(flat, moved).displacement(Vec3::X), Vec3::NEG_X);
    }

    /// A normal stays at right angles to the tangents, which go with the points.
    #[test]
    fn normals_go_back_with_their_surface() {
        let before = place(Quat::from_rotation_x(1.0), Vec3::new(1.0, 2.0, 0.5), Vec3::ZERO);
        let now = place(Quat::from_rotation_z(2.0), Vec3::new(1.0, 1.5, 0.7), Vec3::ONE);
        let motion = InstanceMotion::between(before, now);
        let [a, b] = [Vec3::new(1.0, 0.3, 0.0), Vec3::new(0.0, 1.0, -0.4)];
        let normal = now.transform_vector3(a).cross(now.transform_vector3(b)).normalize();
        let found = motion.normal(normal);
        assert!((found.length() - 1.0).abs() < 1e-6);
        let expected = before.transform_vector3(a).cross(before.transform_vector3(b)).normalize();
        assert!((found - expected).length() < 1e-5, "{found} instead of {expected}");
        // Negative control: turned as a direction, a normal of a stretched surface is wrong.
        let back = before * now.inverse();
        assert!((back.transform_vector3(normal).normalize() - expected).length() > 0.05);
    }

    fn stored(light: u32) -> StoredReservoir {
        StoredReservoir {
            sample: LightSample { light, uv: 0x8000_4000 },
            contribution_weight: 3.0,
            confidence: 32.0,
        }
    }

    fn square(size: f32) -> Light {
        Light::triangle([Vec3::ZERO, Vec3::X * size, Vec3::Y * size], Vec3::ONE, false)
    }

    /// Four lights; then the first goes and one comes at the end. The triangle, now last but one, doubles its edges.
    #[test]
    fn samples_follow_their_lights() {
        let point = Light::point(Vec3::Y, Vec3::ONE);
        let (before, now) = ([point, point, point, square(1.0)], [point, point, square(2.0), point]);
        let past = PastLights {
            lights: Lights::untextured(&before),
            previous_to_current: &[NO_LIGHT, 0, 1, 2],
            current_to_previous: &[1, 2, 3, NO_LIGHT],
        };
        let lights = Lights::untextured(&now);
        for (light, expected) in [(1, 0), (2, 1)] {
            let carried = past.carried(lights, stored(light));
            assert_eq!(
                carried,
                StoredReservoir {
                    sample: LightSample { light: expected, ..carried.sample },
                    ..stored(light)
                }
            );
            assert_eq!(past.before(carried.sample).light, light);
        }
        // W estimates 1/p, and p on four times the area is a quarter.
        let triangle = past.carried(lights, stored(3));
        assert_eq!((triangle.sample.light, triangle.contribution_weight), (2, 12.0));
        assert_eq!(past.jacobian(lights, 2, 3), 0.25);
        let gone = past.carried(lights, stored(0));
        assert_eq!((gone.contribution_weight, gone.confidence), (0.0, 32.0));
        assert_eq!(past.before(LightSample { light: 3, uv: 0 }).light, NO_LIGHT);
        assert_eq!(
            past.lights.incident(past.before(LightSample { light: 3, uv: 0 }), Vec3::ZERO).irradiance,
            Vec3::ZERO
        );
        // The same place on the light, before and after.
        let [a, b] = [(past.lights, stored(3).sample), (lights, triangle.sample)]
            .map(|(lights, sample)| lights.incident(sample, Vec3::new(0.2, 0.2, 5.0)).position);
        assert!((a * 2.0 - b).length() < 1e-6 && a != b, "{a} {b}");
    }

    #[test]
    fn lights_beyond_a_map_keep_their_index() {
        let lights = [square(1.0); 6];
        let lights = Lights::untextured(&lights);
        let past = PastLights { lights, previous_to_current: &[0, 1], current_to_previous: &[0, 1] };
        for light in 0..6 {
            assert_eq!(past.carried(lights, stored(light)), stored(light));
            assert_eq!(past.before(stored(light).sample).light, light);
        }
    }
}
