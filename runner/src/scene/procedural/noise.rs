//! Noise, and square images of it for textures of generated scenes.

use crate::scene::{Filter, Image, Texture, Wrap};
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// uv of each texel of a square image, by rows.
pub fn texel_centers(size: u32) -> impl Iterator<Item = Vec2> {
    (0..size * size).map(move |i| (Vec2::new((i % size) as f32, (i / size) as f32) + 0.5) / size as f32)
}

/// A square image of `values` in 0..=1 that repeats.
pub fn texture(name: &str, size: u32, srgb: bool, values: impl Iterator<Item = Vec3>) -> Texture {
    let texels =
        values.flat_map(|v| v.extend(1.0).to_array()).map(|c| (c.clamp(0.0, 1.0) * 255.0 + 0.5) as u8);
    let image = Image { name: name.into(), width: size, height: size, texels: texels.collect() };
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
pub fn noise(p: Vec2, cells: [i32; 2], salt: u32) -> f32 {
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
pub fn fractal(p: Vec2, cells: [i32; 2], octaves: u32, salt: u32) -> f32 {
    let mut sum = 0.0;
    for octave in 0..octaves {
        let scale = 1 << octave;
        sum += noise(p, cells.map(|n| n * scale), salt + octave) / scale as f32;
    }
    sum / (2.0 - 2.0 / (1 << octaves) as f32)
}
