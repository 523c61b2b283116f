//! Curves that nodes of generated scenes follow.

use crate::scene::animation::{Animation, Channel, Curve, Interpolation, Local, Node, Thing, Track};
use crate::scene::{SceneCamera, SceneDescription};
use glam::{DAffine3, DMat3, DQuat, DVec3, DVec4};

/// Keys a second of a camera's path.
const RATE: f64 = 20.0;

/// Adds a node that goes from key to key, linearly: s, where it is (m), how it is turned. Gives its index.
pub fn follow(animation: &mut Animation, keys: impl IntoIterator<Item = (f32, DVec3, DQuat)>) -> usize {
    let (mut times, mut places, mut turns) = (vec![], vec![], vec![]);
    for (time, place, turn) in keys {
        times.push(time);
        places.push(place);
        turns.push(DVec4::new(turn.x, turn.y, turn.z, turn.w));
    }
    let node = animation.nodes.len();
    let rest = Local::Trs { translation: places[0], rotation: DQuat::from_vec4(turns[0]), scale: DVec3::ONE };
    animation.nodes.push(Node { parent: None, base: DAffine3::IDENTITY, rest });
    let interpolation = Interpolation::Linear;
    let moves = Track { interpolation, times: times.clone(), values: places };
    animation.channels.push(Channel { node, curve: Curve::Translation(moves) });
    let turns = Track { interpolation, times, values: turns };
    animation.channels.push(Channel { node, curve: Curve::Rotation(turns) });
    node
}

/// Adds a camera that moves for `duration` s: `view` gives its eye (m) and a point that it looks at.
pub fn add_camera(
    scene: &mut SceneDescription,
    name: &str,
    fov_y: f32,
    duration: f64,
    view: impl Fn(f64) -> (DVec3, DVec3),
) {
    let key = |key: u32| {
        let time = f64::from(key) / RATE;
        let (eye, target) = view(time);
        (time as f32, eye, facing(target - eye))
    };
    let node = follow(&mut scene.animation, (0..=(duration * RATE) as u32).map(key));
    scene.animation.attached.push((Thing::Camera(scene.cameras.len()), node));
    let (eye, target) = view(0.0);
    let forward = (target - eye).normalize().as_vec3();
    let (position, up) = (eye.as_vec3(), glam::Vec3::Y);
    scene.cameras.push(SceneCamera { name: name.into(), position, forward, up, fov_y });
}

/// Of a camera that looks along `way`, its right side level: cameras look along -z.
fn facing(way: DVec3) -> DQuat {
    let back = -way.normalize();
    let right = DVec3::Y.cross(back).normalize();
    DQuat::from_mat3(&DMat3::from_cols(right, back.cross(right), back))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Between keys too, a camera looks at its target to a part of a pixel, with a level horizon.
    #[test]
    fn cameras_look_at_their_targets() {
        let mut scene = SceneDescription::default();
        let view = |t: f64| (DVec3::new(3.0 * t.cos(), 1.0, 3.0 * t.sin()), DVec3::new(0.0, 1.5, 0.2));
        add_camera(&mut scene, "around", 1.0, 2.0, view);
        for k in 0..=80 {
            let time = f64::from(k) / 40.0;
            let pose = scene.pose(time);
            scene.apply(&pose);
            let camera = &scene.cameras[0];
            let (eye, target) = view(time);
            let off = (target - eye).normalize().angle_between(camera.forward.as_dvec3());
            assert!(off < 1e-3 && camera.position.as_dvec3().distance(eye) < 1e-3, "{off} rad at {time} s");
            assert!(camera.forward.cross(camera.up).y.abs() < 1e-3 && camera.up.y > 0.9);
        }
        assert!(!scene.changes(), "a camera that moves changes nothing that is seen");
    }
}
