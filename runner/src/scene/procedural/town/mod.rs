//! A town at night, about a kilometre wide: streets, a square, parks, towers; some thousand to some million lights.

mod cameras;
mod cars;
mod dice;
mod facade;
mod garlands;
mod glow;
mod green;
mod ground;
mod houses;
mod lamps;
mod lights;
mod lots;
mod materials;
mod plan;
mod roofs;
mod room;
mod signs;
#[cfg(test)]
mod solids;
mod square;
mod textures;
mod towers;
mod traffic;

use super::kit::Kit;
use crate::scene::SceneDescription;
use glam::{Affine3A, Quat, Vec2, Vec3};
use lights::Town;
use plan::{KERB, Plan};

/// Lights of the town where nothing else is said.
pub const DEFAULT_LIGHT_COUNT: usize = 20_000;

/// The town with `light_count` lights: emissive triangles, parts of textured ones, points and spots together. The same count gives
/// the same scene; a greater one lights more of the town, from the square outward, then more densely.
pub fn town(light_count: usize) -> SceneDescription {
    let plan = Plan::new();
    let textures = textures::textures();
    let posters: Vec<usize> = (0..textures::POSTERS).map(|i| textures::FIRST_POSTER + i).collect();
    let scene = SceneDescription {
        name: "town".into(),
        materials: materials::materials(&posters),
        textures,
        cameras: cameras::cameras(&plan),
        ..SceneDescription::default()
    };
    let mut kit = Kit { scene };
    ground::add(&mut kit, &plan);
    let mut town = Town::build(&mut kit, plan);
    greenery(&mut kit, &town);
    lights::add(&mut kit, &mut town, light_count);
    kit.scene
}

/// Trees, hedges, benches.
fn greenery(kit: &mut Kit, town: &Town) {
    let trees: Vec<usize> =
        (0..green::TREES).map(|i| kit.mesh(&format!("tree-{i}"), green::tree(i))).collect();
    for tree in &town.trees {
        kit.place(trees[tree.mesh], tree.transform());
    }
    let bench = kit.mesh("bench", green::bench());
    let hedge = kit.mesh("hedge", green::hedge());
    let standing = |at: Vec2, turn: f32| {
        Affine3A::from_rotation_translation(Quat::from_rotation_y(turn), Vec3::new(at.x, KERB, at.y))
    };
    for (mesh, places) in [(bench, green::benches(&town.plan)), (hedge, green::hedges(&town.plan))] {
        for (at, turn) in places {
            kit.place(mesh, standing(at, turn));
        }
    }
}

#[cfg(test)]
mod tests;
