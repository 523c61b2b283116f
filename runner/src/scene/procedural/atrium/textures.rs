//! Procedural textures, one repeat a metre (wood: a metre along the grain).

use crate::scene::Texture;
use crate::scene::procedural::noise::{fractal, texel_centers, texture};
use glam::{Vec2, Vec3};
use std::f32::consts::TAU;

pub const MARBLE: usize = 0;
pub const WOOD: usize = 1;
pub const ASHLAR: usize = 2;

const SIZE: u32 = 512;

/// Indexed by the constants above.
pub fn textures() -> Vec<Texture> {
    let marble = |p| marble(p) * Vec3::new(1.0, 0.99, 0.97);
    vec![
        texture("marble", SIZE, true, texel_centers(SIZE).map(marble)),
        texture("wood", SIZE, true, texel_centers(SIZE).map(wood)),
        texture("ashlar-normal", SIZE, false, ashlar_normals().into_iter()),
    ]
}

/// Dark veins where a warped field crosses its middle.
fn marble(p: Vec2) -> f32 {
    let warp = Vec2::new(fractal(p, [3, 3], 4, 11), fractal(p, [3, 3], 4, 23)) - 0.5;
    let vein = |cells: i32, salt: u32, sharp: f32| {
        let field = fractal(p + 0.25 * warp, [cells, cells], 4, salt) - 0.5;
        (-(field * sharp).powi(2)).exp()
    };
    let cloud = fractal(p, [4, 4], 3, 71);
    (0.97 - 0.16 * cloud - 0.34 * vein(3, 41, 22.0) - 0.16 * vein(6, 57, 18.0)).clamp(0.2, 1.0)
}

/// Fibres along u.
fn wood(p: Vec2) -> Vec3 {
    let bend = fractal(p, [2, 4], 3, 5);
    let rings = 0.5 + 0.5 * (TAU * (7.0 * p.y + 1.6 * bend)).sin();
    let fibre = fractal(p, [4, 96], 2, 91);
    let shade = 0.62 + 0.22 * rings + 0.26 * (fibre - 0.5);
    Vec3::new(1.0, 0.93, 0.84) * shade * 1.15
}

/// Height of a wall of stone blocks, 4 courses of 2 blocks a metre; 1 at their faces.
fn ashlar_height(p: Vec2) -> f32 {
    let (course, rise) = ((p.y * 4.0).floor(), (p.y * 4.0).fract());
    let along = (p.x * 2.0 + 0.5 * course.rem_euclid(2.0)).fract();
    let in_block = Vec2::new(along, rise);
    // m
    let edge = in_block.min(Vec2::ONE - in_block) * Vec2::new(0.5, 0.25);
    let joint = (edge.min_element() / 0.012).min(1.0);
    joint * joint * (3.0 - 2.0 * joint) + 0.25 * fractal(p, [24, 24], 3, 7)
}

/// Tangent-space normals, encoded: red along u, green along v.
fn ashlar_normals() -> Vec<Vec3> {
    const DEPTH: f32 = 0.010;
    let n = SIZE as usize;
    let heights: Vec<f32> = texel_centers(SIZE).map(ashlar_height).collect();
    let at = |x: usize, y: usize| heights[(y % n) * n + x % n];
    // m/m: the difference spans two texels.
    let slope = |ahead: f32, behind: f32| DEPTH * (ahead - behind) * SIZE as f32 / 2.0;
    let normal = |i: usize| {
        let (x, y) = (i % n, i / n);
        let du = slope(at(x + 1, y), at(x + n - 1, y));
        let dv = slope(at(x, y + 1), at(x, y + n - 1));
        Vec3::new(-du, -dv, 1.0).normalize() * 0.5 + 0.5
    };
    (0..n * n).map(normal).collect()
}
