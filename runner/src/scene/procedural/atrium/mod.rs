//! The atrium: a two-storey arcaded hall, generated.

mod arcade;
mod columns;
mod curtains;
mod floor;
mod furnishings;
mod gallery;
mod lamps;
mod lights;
mod materials;
mod plan;
mod textures;
mod vault;
mod walk;
mod wall;
mod walls;

use super::kit;
use crate::scene::{SceneCamera, SceneDescription};
use glam::Vec3;

/// Lights of the hall where nothing else is said: one for each lamp.
pub const DEFAULT_LIGHT_COUNT: usize = 500;

/// A hall of 30 m x 12 m x 18 m (x, y up, z) with about 262,000 triangles, lit by `light_count` point lights of the same
/// total intensity for any count. The same count gives the same scene.
pub fn atrium(light_count: usize) -> SceneDescription {
    let cameras = cameras();
    let walker = cameras.len() - 1;
    let mut scene = SceneDescription {
        name: "atrium".into(),
        materials: materials::materials(),
        textures: textures::textures(),
        lights: lights::lights(light_count).into_iter().map(Into::into).collect(),
        cameras,
        ..SceneDescription::default()
    };
    walk::add(&mut scene, walker);
    let mut kit = kit::Kit { scene };
    for add in [
        floor::add,
        columns::add,
        arcade::add,
        gallery::add,
        walls::add,
        vault::add,
        curtains::add,
        lamps::add,
        furnishings::add,
    ] {
        add(&mut kit);
    }
    kit.scene
}

/// The first is the one to start with, the last one moves; [`walk`] adds more.
fn cameras() -> Vec<SceneCamera> {
    let camera = |name: &str, position: Vec3, target: Vec3, degrees: f32| SceneCamera {
        name: name.into(),
        position,
        forward: (target - position).normalize(),
        up: Vec3::Y,
        fov_y: degrees.to_radians(),
    };
    let (eyes, ahead) = walk::start();
    vec![
        camera("nave", Vec3::new(-13.2, 2.1, 0.8), Vec3::new(3.0, 4.2, -0.4), 60.0),
        camera("gallery", Vec3::new(-11.9, 7.25, 4.2), Vec3::new(1.5, 5.2, -3.2), 56.0),
        camera("detail", Vec3::new(-8.1, 1.5, 1.4), Vec3::new(-5.0, 1.55, 4.6), 50.0),
        camera("walk", eyes, eyes + ahead, 60.0),
    ]
}

#[cfg(test)]
mod tests;
