//! Cameras that move: a visitor walks through the nave and looks about, passes the columns, goes round one of them.

use super::plan::NAVE;
use crate::scene::SceneDescription;
use crate::scene::animation::Thing;
use crate::scene::procedural::path::{add_camera, follow};
use glam::{DQuat, DVec3, Vec3};

/// s
const DURATION: f64 = 6.0;
/// Keys a second.
const RATE: f64 = 20.0;
/// m/s
const SPEED: f64 = 1.5;
/// The fastest turn of the head, radians a second.
const TURN: f64 = 30.0 * std::f64::consts::PI / 180.0;
/// Furthest from straight ahead, radians.
const SWING: f64 = 0.35;

const START: DVec3 = DVec3::new(-12.5, 1.7, 0.8);

/// Vertical field of view of the cameras added here, radians.
const FOV: f32 = 60.0 * std::f32::consts::PI / 180.0;

/// Where the visitor's eyes start, and which way they look.
pub fn start() -> (Vec3, Vec3) {
    (START.as_vec3(), Vec3::X)
}

/// Moves camera number `camera`, and adds two that move.
pub fn add(scene: &mut SceneDescription, camera: usize) {
    // A camera looks along -z: a quarter turn to the right is straight ahead.
    let ahead = -std::f64::consts::FRAC_PI_2;
    let key = |key: u32| {
        let time = f64::from(key) / RATE;
        let turn = DQuat::from_rotation_y(ahead + SWING * (TURN / SWING * time).sin());
        (time as f32, START + SPEED * time * DVec3::X, turn)
    };
    let node = follow(&mut scene.animation, (0..=(DURATION * RATE) as u32).map(key));
    scene.animation.attached.push((Thing::Camera(camera), node));

    // Along the nave, looking across it: columns pass before the aisle.
    add_camera(scene, "strafe", FOV, DURATION, |t| {
        let eye = DVec3::new(SPEED * t - 7.0, 1.7, -2.0);
        (eye, eye + DVec3::new(0.5, 0.0, 2.0))
    });
    // Round a column, forth and back: it hides and shows all that is behind it.
    let column = DVec3::new(0.0, 1.6, f64::from(NAVE));
    add_camera(scene, "orbit", FOV, DURATION, |t| {
        let angle = SWING * 3.0 * (SPEED / 1.8 / (SWING * 3.0) * t).sin();
        (column - 1.8 * DVec3::new(angle.sin(), 0.0, angle.cos()), column)
    });
}
