//! Procedural textures, one repeat a metre (wood: a metre along the grain).

use crate::scene::{Filter, Image, Texture, Wrap};
use glam::{Vec2, Vec3};
use std::f32::consts::TAU;
use std::sync::Arc;

pub const MARBLE: usize = 0;
pub const WOOD: usize = 1;
pub const ASHLAR: usize = 2;

const SIZE: u32 = 512;

/// Indexed by the constants above.
pub fn textures() -> Vec<Texture> {
    let marble = |p| marble(p) * Vec3::new(1.0, 0.99, 0.97);
    vec![
        texture("marble", true, texel_centers().map(marble)),
        texture("wood", true, texel_centers().map(wood)),
        texture("ashlar-normal", false, ashlar_normals().into_iter()),
    ]
}

/// uv of each texel, by rows.
fn texel_centers() -> impl Iterator<Item = Vec2> {
    (0..SIZE * SIZE).map(|i| (Vec2::new((i % SIZE) as f32, (i / SIZE) as f32) + 0.5) / SIZE as f32)
}

fn texture(name: &str, srgb: bool, values: impl Iterator<Item = Vec3>) -> Texture {
    let texels =
        values.flat_map(|v| v.extend(1.0).to_array()).map(|c| (c.clamp(0.0, 1.0) * 255.0 + 0.5) as u8);
    let image = Image { name: name.into(), width: SIZE, height: SIZE, texels: texels.collect() };
    Texture { image: Arc::new(image), srgb, wrap: [Wrap::Repeat; 2], filter: Filter::LINEAR }
}

/// A number in 0..1 for each point of an integer lattice.
fn lattice(x: i32, y: i32, salt: u32) -> f32 {
    let mut h = (x as u32).wrapping_mul(0x9e37_79b1) ^ (y as u32).wrapping_mul(0x85eb_ca77);
    h ^= salt.wrapping_mul(0xc2b2_ae3d);
    h = (h ^ (h >> 15)).wrapping_mul(0x2c1b_3c6d);
    h = (h ^ (h >> 12)).wrapping_mul(0x297a_2d39);
    (h >> 8) as f32 / 16_777_216.0
}

/// Value noise in 0..1 that repeats after 1, with `cells` on the way.
fn noise(p: Vec2, cells: [i32; 2], salt: u32) -> f32 {
    let q = p * Vec2::new(cells[0] as f32, cells[1] as f32);
    let corner = q.floor();
    let t = q - corner;
    let t = t * t * (3.0 - 2.0 * t);
    let (x, y) = ((corner.x as i32).rem_euclid(cells[0]), (corner.y as i32).rem_euclid(cells[1]));
    let (x1, y1) = ((x + 1) % cells[0], (y + 1) % cells[1]);
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let low = mix(lattice(x, y, salt), lattice(x1, y, salt), t.x);
    let high = mix(lattice(x, y1, salt), lattice(x1, y1, salt), t.x);
    mix(low, high, t.y)
}

/// Octaves of noise, about 0..1.
fn fractal(p: Vec2, cells: [i32; 2], octaves: u32, salt: u32) -> f32 {
    let mut sum = 0.0;
    for octave in 0..octaves {
        let scale = 1 << octave;
        sum += noise(p, cells.map(|n| n * scale), salt + octave) / scale as f32;
    }
    sum / (2.0 - 2.0 / (1 << octaves) as f32)
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
    let heights: Vec<f32> = texel_centers().map(ashlar_height).collect();
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
