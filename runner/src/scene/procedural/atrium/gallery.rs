//! Galleries over the aisles: balustrades, floors and timber ceilings.

use super::materials::{Finish, Part};
use super::plan::{AISLE_CEILING, BAY, BAYS, GALLERY_CEILING, GALLERY_FLOOR, HALF_LENGTH, NAVE, RAIL, WALL};
use crate::scene::procedural::kit::Kit;
use crate::scene::procedural::shapes::{
    Outline, Profile, Shape, bevelled_slab, cuboid, lathe, polygon, sweep,
};
use glam::{Affine3A, Mat3, Vec2, Vec3};

/// Balusters between two pedestals.
const BALUSTERS: usize = 4;

pub fn add(kit: &mut Kit) {
    let baluster = kit.mesh("baluster", baluster());
    let half_bay = 0.5 * BAY;
    // Between the pedestals' faces.
    let clear = half_bay - 2.0 * 0.165;
    for i in 0..2 * BAYS {
        for j in 0..BALUSTERS {
            let x = (i as f32 + 0.5) * half_bay + ((j as f32 + 0.5) / BALUSTERS as f32 - 0.5) * clear;
            kit.place_both(baluster, Vec3::new(x - HALF_LENGTH, 0.0, NAVE));
        }
    }
    kit.both_sides("rails", rails());
    kit.both_sides("gallery-floor", boards());
    let beam = kit.mesh("beam", beam());
    for ceiling in [AISLE_CEILING, GALLERY_CEILING] {
        kit.both_sides("ceiling", Part::of(Finish::OakBeams, soffit(ceiling)));
        for i in 0..4 * BAYS {
            kit.place_both(beam, Vec3::new((i as f32 + 0.5) * BAY / 4.0 - HALF_LENGTH, ceiling, 0.0));
        }
    }
}

fn baluster() -> Part {
    let y = GALLERY_FLOOR + 0.15;
    let top = RAIL - 0.14;
    let outline = Outline::from(0.062, y)
        .to(0.062, y + 0.05)
        .to(0.036, y + 0.10)
        .to(0.064, y + 0.19)
        .to(0.064, y + 0.27)
        .to(0.036, y + 0.42)
        .to(0.027, y + 0.52)
        .to(0.046, y + 0.55)
        .to(0.028, top - 0.06)
        .to(0.058, top - 0.03)
        .to(0.058, top)
        .open();
    Part::of(Finish::Limestone, lathe(&outline, 7))
}

/// The plinth under the balusters and the handrail over them.
fn rails() -> Part {
    let y = GALLERY_FLOOR;
    let plinth = Outline::from(0.155, y - 0.01)
        .to(0.155, y + 0.12)
        .to(0.13, y + 0.15)
        .to(-0.13, y + 0.15)
        .to(-0.155, y + 0.12)
        .to(-0.155, y - 0.01);
    let hand = Outline::from(0.10, RAIL - 0.14)
        .to(0.13, RAIL - 0.10)
        .arc((0.12, RAIL - 0.055), 0.035, (-0.4, 0.5), 5)
        .arc((-0.12, RAIL - 0.055), 0.035, (0.5, 1.4), 5)
        .to(-0.13, RAIL - 0.10)
        .to(-0.10, RAIL - 0.14);
    Part::of(Finish::Limestone, along(&plinth.open())).with(Finish::RedMarble, along(&hand.closed()))
}

/// `profile` (towards the nave, up) along the whole column line.
fn along(profile: &Profile) -> Shape {
    let turn = Mat3::from_cols(Vec3::NEG_Z, Vec3::Y, Vec3::X);
    let frame = |x: f32| Affine3A::from_mat3_translation(turn, Vec3::new(x, 0.0, NAVE));
    sweep(profile, &[frame(-HALF_LENGTH), frame(HALF_LENGTH)])
}

/// Long boards with staggered ends.
fn boards() -> Part {
    let (rows, length) = (15, 2.3);
    let (near, far) = (NAVE - 0.15, WALL);
    let width = (far - near) / rows as f32;
    let mut shape = Shape::default();
    for row in 0..rows {
        let z = near + row as f32 * width;
        let mut x = -HALF_LENGTH;
        let mut next = x + length * (0.25 + 0.25 * ((row * 3) % 4) as f32);
        while x < HALF_LENGTH - 0.01 {
            let end = next.min(HALF_LENGTH);
            let gap = 0.001;
            let (a, b) = (Vec2::new(x + gap, z + gap), Vec2::new(end - gap, z + width - gap));
            let outline = [a, Vec2::new(b.x, a.y), b, Vec2::new(a.x, b.y)];
            let mut board = bevelled_slab(&outline, GALLERY_FLOOR, 0.004, 0.003);
            // Every board is another piece of the texture.
            board.uvs.iter_mut().for_each(|uv| *uv += Vec2::new(0.37 * row as f32, 0.31 * (x + row as f32)));
            shape.append(&board);
            (x, next) = (end, end + length);
        }
    }
    let y = GALLERY_FLOOR - 0.004;
    let under = [(-HALF_LENGTH, near), (HALF_LENGTH, near), (HALF_LENGTH, far), (-HALF_LENGTH, far)];
    let under = polygon(&under.map(|(x, z)| Vec3::new(x, y, z)), Vec3::Y);
    Part::of(Finish::Walnut, shape).with(Finish::Soil, under)
}

fn soffit(y: f32) -> Shape {
    let (x, near, far) = (HALF_LENGTH, NAVE - 0.3, WALL);
    let corners = [(-x, near), (x, near), (x, far), (-x, far)].map(|(x, z)| Vec3::new(x, y, z));
    polygon(&corners, Vec3::NEG_Y)
}

/// A ceiling beam across an aisle, below height 0.
fn beam() -> Part {
    let (near, far) = (NAVE + 0.1, WALL + 0.02);
    let mut timber = cuboid(Vec3::new(-0.075, -0.19, near), Vec3::new(0.075, 0.02, far));
    // The grain runs along the beam.
    timber.uvs.iter_mut().zip(&timber.positions).for_each(|(uv, p)| *uv = Vec2::new(p.z, p.x + p.y));
    Part::of(Finish::OakBeams, timber)
}
