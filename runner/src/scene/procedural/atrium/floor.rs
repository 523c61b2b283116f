//! The inlaid stone floor of the hall.

use super::materials::{Finish, Part};
use super::plan::{BAY, HALF_LENGTH, NAVE, WALL};
use crate::scene::procedural::kit::Kit;
use crate::scene::procedural::shapes::{Shape, bevelled_slab, polygon};
use glam::{Vec2, Vec3};
use std::f32::consts::TAU;

/// Depth and width of the bevel at a stone's edge, m.
const DEPTH: f32 = 0.004;
const BEVEL: f32 = 0.006;
/// Half of the gap between stones.
const GAP: f32 = 0.0015;
/// Half-width of the nave's field of diamonds, of the border around it and of the strip under the columns.
const FIELD: f32 = 3.5;
const STRIP: [f32; 2] = [3.85, 4.95];
/// The medallions lie on top of the field.
const RAISED: f32 = 0.006;

pub fn add(kit: &mut Kit) {
    let mut part = Part::of(Finish::Grout, grout());
    field(&mut part);
    for side in [-1.0, 1.0] {
        border(&mut part, side);
        aisle(&mut part, side);
    }
    kit.single("floor", part);
    let medallion = kit.mesh("medallion", medallion());
    for x in [-3.0 * BAY, 0.0, 3.0 * BAY] {
        kit.place_at(medallion, Vec3::new(x, 0.0, 0.0));
    }
}

fn grout() -> Shape {
    let (x, z) = (HALF_LENGTH, WALL);
    let corners = [(-x, -z), (x, -z), (x, z), (-x, z)].map(|(x, z)| Vec3::new(x, -DEPTH, z));
    polygon(&corners, Vec3::Y)
}

fn stone(part: &mut Part, finish: Finish, outline: &[Vec2]) {
    let center = outline.iter().copied().sum::<Vec2>() / outline.len() as f32;
    let shrunk: Vec<Vec2> = outline.iter().map(|&p| p + (center - p).normalize_or_zero() * GAP).collect();
    part.add(finish, &bevelled_slab(&shrunk, 0.0, DEPTH, BEVEL));
}

fn rectangle(min: Vec2, max: Vec2) -> [Vec2; 4] {
    [min, Vec2::new(max.x, min.y), max, Vec2::new(min.x, max.y)]
}

/// Squares of 1.4 m, each a light diamond between four darker corners.
fn field(part: &mut Part) {
    const CELL: f32 = 1.4;
    let columns = (2.0 * HALF_LENGTH / CELL).round() as usize;
    let rows = (2.0 * FIELD / CELL).round() as usize;
    for i in 0..columns {
        for j in 0..rows {
            let center = Vec2::new((i as f32 + 0.5) * CELL - HALF_LENGTH, (j as f32 + 0.5) * CELL - FIELD);
            let tip = |k: usize| center + 0.5 * CELL * [Vec2::X, Vec2::Y, Vec2::NEG_X, Vec2::NEG_Y][k % 4];
            let diamond = if (i + j) % 2 == 0 { Finish::WhiteMarble } else { Finish::Travertine };
            stone(part, diamond, &[0, 1, 2, 3].map(tip));
            let corner_finish = if (i + j) % 2 == 0 { Finish::RedMarble } else { Finish::GreenMarble };
            for k in 0..4 {
                let (a, b) = (tip(k), tip(k + 1));
                stone(part, corner_finish, &[a, a + b - center, b]);
            }
        }
    }
}

/// A dark band beside the field and large slabs under the columns.
fn border(part: &mut Part, side: f32) {
    let across = |a: f32, b: f32| if side > 0.0 { [a, b] } else { [-b, -a] };
    let mut run = |finish, [low, high]: [f32; 2], length: f32| {
        for i in 0..(2.0 * HALF_LENGTH / length).round() as usize {
            let x = i as f32 * length - HALF_LENGTH;
            stone(part, finish, &rectangle(Vec2::new(x, low), Vec2::new(x + length, high)));
        }
    };
    run(Finish::BlackMarble, across(FIELD, STRIP[0]), 0.7);
    run(Finish::Travertine, across(STRIP[0], NAVE), 1.4);
    run(Finish::Travertine, across(NAVE, STRIP[1]), 1.4);
}

/// A checkered aisle with a dark edge along the wall.
fn aisle(part: &mut Part, side: f32) {
    let rows = 4;
    let size = (WALL - 0.25 - STRIP[1]) / rows as f32;
    let columns = (2.0 * HALF_LENGTH / size).round() as usize;
    let length = 2.0 * HALF_LENGTH / columns as f32;
    let across = |a: f32, b: f32| if side > 0.0 { [a, b] } else { [-b, -a] };
    for i in 0..columns {
        let x = i as f32 * length - HALF_LENGTH;
        for j in 0..rows {
            let [low, high] = across(STRIP[1] + j as f32 * size, STRIP[1] + (j + 1) as f32 * size);
            let finish = if (i + j) % 2 == 0 { Finish::Travertine } else { Finish::GreenMarble };
            stone(part, finish, &rectangle(Vec2::new(x, low), Vec2::new(x + length, high)));
        }
        let [low, high] = across(WALL - 0.25, WALL);
        stone(part, Finish::BlackMarble, &rectangle(Vec2::new(x, low), Vec2::new(x + length, high)));
    }
}

/// A round of coloured marbles: a sixteen-pointed star in rings.
fn medallion() -> Part {
    const POINTS: usize = 16;
    let on = |r: f32, k: f32| r * Vec2::from_angle(TAU * k / POINTS as f32);
    let mut part = Part::default();
    let mut put = |finish, outline: &[Vec2]| {
        part.add(finish, &bevelled_slab(outline, RAISED, 0.003, 0.004));
    };
    for k in 0..POINTS {
        let k = k as f32;
        let star = if k % 2.0 == 0.0 { Finish::GreenMarble } else { Finish::RedMarble };
        put(star, &[on(0.5, k - 0.5), on(1.5, k), on(0.5, k + 0.5)]);
        put(Finish::WhiteMarble, &[on(0.5, k + 0.5), on(1.5, k), on(1.5, k + 1.0)]);
        put(Finish::BlackMarble, &[on(1.5, k), on(1.72, k), on(1.72, k + 1.0), on(1.5, k + 1.0)]);
        put(Finish::Travertine, &[on(1.72, k), on(1.95, k), on(1.95, k + 1.0), on(1.72, k + 1.0)]);
    }
    let center: Vec<Vec2> = (0..POINTS).map(|k| on(0.5, k as f32 + 0.5)).collect();
    put(Finish::BlackMarble, &center);
    // The bed of the stones, and its edge above the floor.
    let bed: Vec<Vec2> = (0..POINTS).map(|k| on(1.955, k as f32)).collect();
    part.add(Finish::Grout, &bevelled_slab(&bed, RAISED - 0.002, RAISED, 0.001));
    part
}
