//! Procedural textures of the town; how many metres each covers says [`super::materials::Finish`].

use crate::parallel;
use crate::scene::procedural::noise::{fractal, noise, texel_centers, texture};
use crate::scene::{Filter, Texture};
use glam::{Vec2, Vec3};
use std::f32::consts::TAU;

pub const ASPHALT: usize = 0;
pub const ASPHALT_GLOSS: usize = 1;
pub const BRICK: usize = 2;
pub const PLASTER: usize = 3;
pub const CONCRETE: usize = 4;
pub const PAVING: usize = 5;
pub const TILES: usize = 6;
/// The first of [`POSTERS`] pictures that shine.
pub const FIRST_POSTER: usize = 7;
pub const POSTERS: usize = 4;

/// Texels of a poster's side: each is some decimetres of light.
const POSTER_SIZE: u32 = 16;

/// Indexed by the constants above.
pub fn textures() -> Vec<Texture> {
    type Paint = fn(Vec2) -> Vec3;
    let painted: [(&str, u32, bool, Paint); 11] = [
        ("asphalt", 512, true, asphalt),
        ("asphalt-gloss", 256, false, asphalt_gloss),
        ("brick", 256, true, brick),
        ("plaster", 256, true, plaster),
        ("concrete", 256, true, concrete),
        ("paving", 256, true, paving),
        ("tiles", 128, true, tiles),
        ("poster-sun", POSTER_SIZE, true, sun),
        ("poster-cup", POSTER_SIZE, true, cup),
        ("poster-waves", POSTER_SIZE, true, waves),
        ("poster-heart", POSTER_SIZE, true, heart),
    ];
    let mut all = parallel::map(&painted, |&(name, size, srgb, paint)| {
        texture(name, size, srgb, texel_centers(size).map(paint))
    });
    all[FIRST_POSTER..].iter_mut().for_each(|poster| poster.filter = Filter::NEAREST);
    all
}

/// How wet it is, 0..1: puddles where a slow noise is high.
fn wetness(p: Vec2) -> f32 {
    let slow = fractal(p, [4, 4], 4, 31);
    ((slow - 0.52) / 0.06).clamp(0.0, 1.0)
}

fn asphalt(p: Vec2) -> Vec3 {
    let grain = noise(p, [220, 220], 3);
    let patches = fractal(p, [5, 5], 4, 17);
    let dry = 0.72 + 0.28 * grain * (0.6 + 0.8 * patches);
    Vec3::splat(dry * (1.0 - 0.45 * wetness(p)))
}

/// Roughness in green, as glTF has it.
fn asphalt_gloss(p: Vec2) -> Vec3 {
    let dry = 0.62 + 0.25 * (fractal(p, [9, 9], 3, 5) - 0.5);
    Vec3::new(0.0, dry + (0.10 - dry) * wetness(p), 0.0)
}

/// 8 courses a metre over 2 m.
fn brick(p: Vec2) -> Vec3 {
    let q = Vec2::new(8.0 * p.x, 24.0 * p.y);
    let course = q.y.floor();
    let along = q.x + 0.5 * course.rem_euclid(2.0);
    let inside = Vec2::new(along.fract() * 3.0, q.y.fract());
    let joint = inside.x.min(3.0 - inside.x).min(inside.y.min(1.0 - inside.y)) < 0.09;
    let tone = noise(Vec2::new((along.floor() + 0.5) / 8.0, (course + 0.5) / 24.0), [8, 24], 9);
    let weather = 0.8 + 0.4 * (fractal(p, [3, 3], 3, 2) - 0.5);
    if joint {
        Vec3::new(0.86, 0.84, 0.80) * 0.72
    } else {
        Vec3::new(1.0, 0.92, 0.88) * (0.62 + 0.38 * tone) * weather
    }
}

fn plaster(p: Vec2) -> Vec3 {
    let stains = fractal(p, [3, 2], 4, 71);
    let grain = noise(p, [128, 128], 8);
    Vec3::new(1.0, 0.985, 0.96) * (0.82 + 0.14 * stains + 0.05 * grain)
}

fn concrete(p: Vec2) -> Vec3 {
    let cloud = fractal(p, [4, 4], 5, 43);
    Vec3::splat(0.68 + 0.34 * cloud)
}

/// Slabs of 0.5 m over 2 m.
fn paving(p: Vec2) -> Vec3 {
    let q = 4.0 * p + Vec2::new(0.5 * (4.0 * p.y).floor().rem_euclid(2.0), 0.0);
    let edge = q.fract().min(Vec2::ONE - q.fract()).min_element();
    let tone = noise((q.floor() + 0.5) / 4.0, [4, 4], 4);
    let joint = if edge < 0.025 { 0.5 } else { 1.0 };
    Vec3::splat((0.70 + 0.24 * tone + 0.1 * (fractal(p, [16, 16], 2, 6) - 0.5)) * joint)
}

/// Rows of 0.25 m over 2 m.
fn tiles(p: Vec2) -> Vec3 {
    let row = 8.0 * p.y;
    let along = 8.0 * p.x + 0.5 * row.floor().rem_euclid(2.0);
    let shade = 0.6 + 0.4 * row.fract();
    let tone = noise(Vec2::new((along.floor() + 0.5) / 8.0, (row.floor() + 0.5) / 8.0), [8, 8], 12);
    let gap = if along.fract() < 0.08 { 0.55 } else { 1.0 };
    Vec3::splat(shade * (0.72 + 0.28 * tone) * gap)
}

fn sun(p: Vec2) -> Vec3 {
    let d = p.distance(Vec2::new(0.5, 0.62));
    if d < 0.27 {
        Vec3::new(1.0, 0.85, 0.35)
    } else if p.y > 0.68 {
        Vec3::new(0.25, 0.35, 0.75)
    } else {
        Vec3::new(0.85, 0.38, 0.22)
    }
}

fn cup(p: Vec2) -> Vec3 {
    let body = (p.x - 0.44).abs() < 0.22 && (p.y - 0.62).abs() < 0.2;
    let handle = (p.distance(Vec2::new(0.68, 0.60)) - 0.12).abs() < 0.045;
    let steam = p.y < 0.36 && (p.x - 0.44 - 0.05 * (TAU * 2.0 * p.y).sin()).abs() < 0.07;
    if body || handle {
        Vec3::new(1.0, 0.94, 0.82)
    } else if steam {
        Vec3::splat(0.62)
    } else {
        Vec3::new(0.36, 0.12, 0.05)
    }
}

fn waves(p: Vec2) -> Vec3 {
    let level = 0.45 + 0.12 * (TAU * p.x).sin();
    let band = ((p.y - level) * 5.0).floor();
    if p.y < level {
        Vec3::new(0.05, 0.12, 0.35)
    } else if band < 1.0 {
        Vec3::new(0.2, 0.9, 0.95)
    } else {
        Vec3::new(0.08, 0.45, 0.75)
    }
}

fn heart(p: Vec2) -> Vec3 {
    let q = Vec2::new((p.x - 0.5).abs() / 0.36, (0.58 - p.y) / 0.36);
    let inside = (q.x * q.x + q.y * q.y - 0.9).powi(3) < q.x * q.x * q.y.powi(3);
    if inside { Vec3::new(1.0, 0.16, 0.30) } else { Vec3::new(0.80, 0.76, 0.70) }
}
