//! A visitor walks through the nave and looks about.

use crate::scene::animation::{Animation, Channel, Curve, Interpolation, Local, Node, Thing, Track};
use glam::{DAffine3, DQuat, DVec3, DVec4, Vec3};

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

/// Where the visitor's eyes start, and which way they look.
pub fn start() -> (Vec3, Vec3) {
    (START.as_vec3(), Vec3::X)
}

/// Moves camera number `camera`.
pub fn walk(camera: usize) -> Animation {
    let keys = (DURATION * RATE) as u32;
    let times: Vec<f64> = (0..=keys).map(|key| f64::from(key) / RATE).collect();
    let places = times.iter().map(|t| START + SPEED * t * DVec3::X).collect();
    // A camera looks along -z: a quarter turn to the right is straight ahead.
    let ahead = -std::f64::consts::FRAC_PI_2;
    let turn = |t: &f64| {
        let q = DQuat::from_rotation_y(ahead + SWING * (TURN / SWING * t).sin());
        DVec4::new(q.x, q.y, q.z, q.w)
    };
    let turns = times.iter().map(turn).collect();
    let times: Vec<f32> = times.iter().map(|&t| t as f32).collect();
    let interpolation = Interpolation::Linear;
    let rest = Local::Trs { translation: START, rotation: DQuat::from_rotation_y(ahead), scale: DVec3::ONE };
    Animation {
        nodes: vec![Node { parent: None, base: DAffine3::IDENTITY, rest }],
        attached: vec![(Thing::Camera(camera), 0)],
        morphs: vec![],
        channels: vec![
            Channel {
                node: 0,
                curve: Curve::Translation(Track { interpolation, times: times.clone(), values: places }),
            },
            Channel { node: 0, curve: Curve::Rotation(Track { interpolation, times, values: turns }) },
        ],
    }
}
