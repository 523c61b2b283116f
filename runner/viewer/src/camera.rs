//! The camera that mouse and keys move: around a point, or freely.

use candela::scene::SceneCamera;
use glam::{DVec3, Mat3, Vec2, Vec3};

/// How drags are understood.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Style {
    /// Around the center.
    Orbit,
    /// Around the eye.
    Fly,
}

/// Radians a drag across the whole height of the window turns.
const TURN: f32 = 3.0;
/// The steepest look up or down, radians from the horizon.
const STEEPEST: f32 = 1.55;
/// Scene radii a second.
const SPEED: f32 = 0.5;
/// Each notch of the wheel brings the camera this much nearer.
const NOTCH: f32 = 0.88;
const SPEEDS: std::ops::RangeInclusive<f32> = 1e-3..=1e3;

#[derive(Clone, Debug, PartialEq)]
pub struct Rig {
    pub style: Style,
    /// Of the scene ([`candela::scene::SceneDescription::origin`]), m.
    pub origin: DVec3,
    /// Relative to it, m.
    pub position: Vec3,
    /// Unit.
    pub forward: Vec3,
    /// A file's camera may be tilted; the first turn sets it upright.
    pub up: Vec3,
    /// Radians.
    pub fov_y: f32,
    /// Distance from the eye to the center of orbits, m.
    pub distance: f32,
    /// Radius of the scene, m: the measure of speed.
    radius: f32,
    /// Factor on the speed.
    pub speed: f32,
}

impl Rig {
    /// At a camera of a scene with this middle and radius (m).
    pub fn new(camera: &SceneCamera, middle: Vec3, radius: f32) -> Self {
        let mut rig = Rig {
            style: Style::Orbit,
            origin: DVec3::ZERO,
            position: Vec3::ZERO,
            forward: -Vec3::Z,
            up: Vec3::Y,
            fov_y: 1.0,
            distance: radius,
            radius,
            speed: 1.0,
        };
        rig.look_through(camera);
        // As far as the scene's middle, if that lies ahead.
        let ahead = (middle - rig.position).dot(rig.forward);
        rig.distance = if ahead > 0.05 * radius { ahead } else { 0.5 * radius };
        rig
    }

    /// Takes the place of `camera`.
    pub fn look_through(&mut self, camera: &SceneCamera) {
        self.position = camera.position;
        self.forward = camera.forward.normalize_or(-Vec3::Z);
        self.up = camera.up;
        self.fov_y = camera.fov_y;
    }

    /// As a camera of a scene.
    pub fn camera(&self) -> SceneCamera {
        let Rig { position, forward, up, fov_y, .. } = *self;
        SceneCamera { name: String::new(), position, forward, up, fov_y }
    }

    /// The point around which it orbits.
    pub fn center(&self) -> Vec3 {
        self.position + self.distance * self.forward
    }

    fn right(&self) -> Vec3 {
        self.forward.cross(self.up).normalize_or(Vec3::X)
    }

    /// A drag with the main button: `delta` in heights of the window, right and down.
    pub fn turn(&mut self, delta: Vec2) {
        let center = self.center();
        let orbits = self.style == Style::Orbit;
        // Orbiting, the scene follows the hand; looking around, the gaze does.
        let sign = if orbits { -1.0 } else { 1.0 };
        let yaw = self.forward.x.atan2(-self.forward.z) + sign * TURN * delta.x;
        let pitch = self.forward.y.clamp(-1.0, 1.0).asin() - sign * TURN * delta.y;
        let (pitch_sin, pitch_cos) = pitch.clamp(-STEEPEST, STEEPEST).sin_cos();
        let (yaw_sin, yaw_cos) = yaw.sin_cos();
        self.forward = Vec3::new(yaw_sin * pitch_cos, pitch_sin, -yaw_cos * pitch_cos);
        self.up = Vec3::Y;
        if orbits {
            self.position = center - self.distance * self.forward;
        }
    }

    /// A drag across the picture: what lies at the center's distance stays under the cursor.
    pub fn pan(&mut self, delta: Vec2) {
        let height = 2.0 * self.distance * (0.5 * self.fov_y).tan();
        let up = self.right().cross(self.forward);
        self.position += height * (delta.y * up - delta.x * self.right());
    }

    /// Notches of the wheel, away from the user: nearer when orbiting, faster when flying.
    pub fn scroll(&mut self, notches: f32) {
        match self.style {
            Style::Orbit => self.zoom(NOTCH.powf(notches)),
            Style::Fly => {
                let speed = self.speed * 1.2f32.powf(notches);
                self.speed = speed.clamp(*SPEEDS.start(), *SPEEDS.end());
            }
        }
    }

    /// Makes the distance to the center `factor` times what it is.
    pub fn zoom(&mut self, factor: f32) {
        let center = self.center();
        self.distance = (self.distance * factor).clamp(1e-4 * self.radius, 1e3 * self.radius);
        self.position = center - self.distance * self.forward;
    }

    /// Moves for `seconds` along `direction`: right, up, forward, each -1 to 1.
    pub fn walk(&mut self, direction: Vec3, seconds: f32) {
        let axes = Mat3::from_cols(self.right(), Vec3::Y, self.forward);
        self.position += axes * direction * (SPEED * self.speed * self.radius * seconds);
    }

    /// Orbits around `point` from now on, without moving.
    pub fn set_center(&mut self, point: Vec3) {
        let ahead = (point - self.position).dot(self.forward);
        if ahead > 0.0 {
            self.distance = ahead;
        }
    }

    /// Turns to `point` and stands off a quarter of the distance.
    pub fn focus(&mut self, point: Vec3) {
        let to = point - self.position;
        if let Some(forward) = to.try_normalize() {
            self.forward = forward;
            self.up = Vec3::Y;
            self.distance = 0.25 * to.length();
            self.position = point - self.distance * forward;
        }
    }

    /// As `--camera` takes it: position and target in m, field of view in degrees, in the file's world.
    pub fn argument(&self) -> String {
        let p = self.origin + self.position.as_dvec3();
        let t = p + self.forward.as_dvec3();
        let numbers = [p.x, p.y, p.z, t.x, t.y, t.z, f64::from(self.fov_y.to_degrees())];
        // 6 digits of metres and degrees: below what a pixel shows.
        let text = numbers.map(|n| format!("{n:.6}"));
        let short = text.each_ref().map(|t| t.trim_end_matches('0').trim_end_matches('.'));
        short.join(",")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use candela::scene::viewpoint::parse_view;

    fn rig(style: Style) -> Rig {
        let camera = SceneCamera {
            name: String::new(),
            position: Vec3::new(0.0, 1.0, 5.0),
            forward: Vec3::new(0.0, -0.1, -1.0).normalize(),
            up: Vec3::Y,
            fov_y: 0.9,
        };
        Rig { style, ..Rig::new(&camera, Vec3::ZERO, 2.0) }
    }

    #[test]
    fn orbits_keep_the_center_and_the_distance() {
        let mut rig = rig(Style::Orbit);
        let center = rig.center();
        for i in 0..50 {
            rig.turn(Vec2::new(0.13, if i < 25 { 0.2 } else { -0.2 }));
            assert!((rig.center() - center).length() < 1e-4 && rig.forward.is_normalized());
            assert!((rig.position.distance(center) - rig.distance).abs() < 1e-4);
            assert!(rig.forward.y.abs() < 0.9999, "never straight up or down");
        }
    }

    #[test]
    fn flying_looks_where_the_hand_goes() {
        let mut rig = rig(Style::Fly);
        let position = rig.position;
        rig.turn(Vec2::new(0.1, 0.0));
        assert!(rig.forward.x > 0.0, "to the right");
        rig.turn(Vec2::new(0.0, -0.2));
        assert!(rig.forward.y > 0.0, "up");
        assert_eq!(rig.position, position);
    }

    #[test]
    fn panning_keeps_the_center_under_the_cursor() {
        let mut rig = rig(Style::Orbit);
        let point = rig.center();
        rig.pan(Vec2::new(0.25, 0.1));
        let to = point - rig.position;
        let up = rig.right().cross(rig.forward);
        let half = (0.5 * rig.fov_y).tan() * to.dot(rig.forward);
        let at = 0.5 * Vec2::new(to.dot(rig.right()), -to.dot(up)) / half;
        assert!((at - Vec2::new(0.25, 0.1)).length() < 1e-4, "{at}");
    }

    #[test]
    fn walking_scales_with_the_scene() {
        let mut small = rig(Style::Fly);
        let mut large = Rig { radius: 200.0, ..small.clone() };
        let from = small.position;
        small.walk(Vec3::Z, 1.0);
        large.walk(Vec3::Z, 1.0);
        let (near, far) = (small.position.distance(from), large.position.distance(from));
        assert!((far / near - 100.0).abs() < 1e-2 && near > 0.0);
        small.scroll(3.0);
        assert!(small.speed > 1.0);
    }

    #[test]
    fn focus_brings_the_point_to_the_middle() {
        let mut rig = rig(Style::Orbit);
        let point = Vec3::new(1.0, 0.5, -1.0);
        rig.focus(point);
        assert!((rig.center() - point).length() < 1e-4);
        let before = rig.position;
        rig.set_center(point);
        assert_eq!(rig.position, before);
    }

    #[test]
    fn the_argument_comes_back_as_the_camera() {
        let rig = Rig { origin: DVec3::new(1e5, 0.0, -2e6), ..rig(Style::Fly) };
        let (position, target, fov) = parse_view(&rig.argument()).unwrap().unwrap();
        assert!((position - rig.origin - rig.position.as_dvec3()).length() < 1e-5);
        assert!(((target - position).normalize().as_vec3() - rig.forward).length() < 1e-5);
        assert!((fov.unwrap().to_radians() as f32 - rig.fov_y).abs() < 1e-6);
    }
}
