//! Cameras of the town.

use super::plan::{KERB, Plan};
use super::{room, traffic};
use crate::scene::SceneCamera;
use glam::Vec3;

/// The first is the one to start with; the last one moves.
pub fn cameras(plan: &Plan) -> Vec<SceneCamera> {
    let mut cameras = vec![
        camera("street", Vec3::new(117.4, 1.7, 107.0), Vec3::new(116.2, 4.9, 20.0), 54.0),
        camera("roofs", Vec3::new(-118.0, 38.0, 128.0), Vec3::new(60.0, 8.0, -95.0), 50.0),
        camera("square", Vec3::new(9.5, KERB + 1.75, 43.5), Vec3::new(-3.0, 9.0, 0.0), 60.0),
    ];
    if let Some(place) = room::transform(plan) {
        let [position, target] = room::CAMERA.map(|p| place.transform_point3(p));
        cameras.push(camera("room", position, target, 62.0));
    }
    let (position, way) = traffic::driver(&traffic::drive(), 0.0);
    cameras.push(camera("drive", position, position + Vec3::new(way.x, 0.0, way.y), 56.0));
    cameras
}

fn camera(name: &str, position: Vec3, target: Vec3, degrees: f32) -> SceneCamera {
    SceneCamera {
        name: name.into(),
        position,
        forward: (target - position).normalize(),
        up: Vec3::Y,
        fov_y: degrees.to_radians(),
    }
}
