//! Cars: meshes, where they park, and their lamps.

use super::dice::Dice;
use super::materials::{Finish, Part};
use super::plan::{Plan, SIDES};
use crate::scene::procedural::shapes::{Outline, bevelled_cuboid, cuboid, lathe, polygon};
use crate::scene::{PlacedLight, SpotLight};
use glam::{Affine3A, Quat, Vec2, Vec3};
use std::f32::consts::{FRAC_PI_2, PI};

pub const COLORS: [Finish; 5] =
    [Finish::RedCar, Finish::BlueCar, Finish::SilverCar, Finish::BlackCar, Finish::WhiteCar];
/// Half the length and half the width, m.
pub const HALF: Vec2 = Vec2::new(2.15, 0.9);

/// A car that heads to -z, its wheels on y = 0; its lamps shine or not.
pub fn mesh(color: Finish, lit: bool) -> Part {
    let (l, w) = (HALF.x, HALF.y);
    let mut part = Part::of(color, bevelled_cuboid(Vec3::new(-w, 0.28, -l), Vec3::new(w, 0.86, l), 0.1));
    let sill = 0.86;
    let foot = [(-0.8, -0.85), (0.8, -0.85), (0.8, 1.85), (-0.8, 1.85)].map(|(x, z)| Vec3::new(x, sill, z));
    let head =
        [(-0.62, -0.05), (0.62, -0.05), (0.62, 1.35), (-0.62, 1.35)].map(|(x, z)| Vec3::new(x, 1.42, z));
    let ways = [Vec3::NEG_Z, Vec3::X, Vec3::Z, Vec3::NEG_X];
    for i in 0..4 {
        let j = (i + 1) % 4;
        let pane = [foot[i], foot[j], head[j], head[i]];
        part.add(Finish::Glass, &polygon(&pane, ways[i] + 0.3 * Vec3::Y));
    }
    let roof = bevelled_cuboid(Vec3::new(-0.66, 1.40, -0.1), Vec3::new(0.66, 1.46, 1.4), 0.02);
    part.add(color, &roof);
    let tyre = Outline::from(0.0, -0.1).to(0.31, -0.1).to(0.31, 0.1).to(0.0, 0.1).open();
    let hub = Outline::from(0.2, 0.105).to(0.0, 0.105).open();
    for (x, z) in [(1.0, -1.3), (-1.0, -1.3), (1.0, 1.35), (-1.0, 1.35f32)] {
        let place = Affine3A::from_rotation_translation(
            Quat::from_rotation_z(-FRAC_PI_2 * x),
            Vec3::new(x * (w - 0.08), 0.31, z),
        );
        part.add(Finish::Tyre, &lathe(&tyre, 12).moved(place));
        part.add(Finish::Steel, &lathe(&hub, 8).moved(place));
    }
    let (white, red) =
        if lit { (Finish::WhiteBulb, Finish::TailLens) } else { (Finish::Steel, Finish::RedCloth) };
    for x in [-0.62f32, 0.62] {
        let lens = |z: f32, y: f32| {
            cuboid(Vec3::new(x - 0.16, y - 0.07, z - 0.03), Vec3::new(x + 0.16, y + 0.07, z + 0.03))
        };
        part.add(white, &lens(-l, 0.64));
        part.add(red, &lens(l, 0.7));
    }
    part
}

/// Where the lamps of a car are and the way they shine, in its space.
pub fn lamps() -> [(Vec3, Quat, SpotLight); 4] {
    let spot = |position: Vec3, turn: Quat, intensity: Vec3, [inner_angle, outer_angle]: [f32; 2]| {
        (
            position,
            turn,
            SpotLight {
                position,
                axis: turn * Vec3::NEG_Z,
                intensity,
                inner_angle,
                outer_angle,
                radius: 0.0,
            },
        )
    };
    let head = |x: f32| {
        let down = Quat::from_rotation_x(-0.075);
        spot(Vec3::new(x, 0.64, -HALF.x - 0.06), down, Vec3::new(1.02, 1.0, 0.92) * 900.0, [0.12, 0.42])
    };
    let tail = |x: f32| {
        let back = Quat::from_rotation_y(PI);
        spot(Vec3::new(x, 0.7, HALF.x + 0.06), back, Vec3::new(4.2, 0.12, 0.05) * 4.0, [0.6, 1.4])
    };
    [head(-0.62), head(0.62), tail(-0.62), tail(0.62)]
}

/// A lamp of a car that stands at `place`.
pub fn placed(spot: &SpotLight, place: &Affine3A) -> PlacedLight {
    let axis = place.transform_vector3(spot.axis).normalize();
    SpotLight { position: place.transform_point3(spot.position), axis, ..*spot }.into()
}

/// From the space of a car at `at` on the road that heads along `way` (unit).
pub fn standing(at: Vec2, way: Vec2) -> Affine3A {
    Affine3A::from_rotation_translation(heading(way), Vec3::new(at.x, 0.0, at.y))
}

/// The turn that takes -z to `way`.
pub fn heading(way: Vec2) -> Quat {
    Quat::from_rotation_y((-way.x).atan2(-way.y))
}

/// Parked cars: (color, place). They stand at the kerbs of streets and avenues, not at crossings.
pub fn parked(plan: &Plan) -> Vec<(usize, Affine3A)> {
    let mut cars = Vec::new();
    for (i, block) in plan.blocks.iter().enumerate() {
        let mut dice = Dice::new(70, i);
        for side in SIDES {
            let rank = plan.rank(block, side);
            if rank.parking() == 0.0 {
                continue;
            }
            // Seen from the road, traffic runs to the right of the block's outside: along the edge from right to left.
            let [left, right] = block.curb.edge(side);
            let (length, along) = (left.distance(right), (right - left).normalize());
            let count = ((length - 16.0) / 6.2).max(0.0) as usize;
            for k in 0..count {
                let at = 8.0 + (length - 16.0) * (k as f32 + 0.5) / count as f32 + dice.within(-0.4..0.4);
                if dice.chance(0.42) {
                    let middle =
                        left + at * along + (0.25 + HALF.y + dice.within(0.0..0.12)) * side.outward();
                    cars.push((dice.below(COLORS.len()), standing(middle, -along)));
                }
            }
        }
    }
    cars
}
