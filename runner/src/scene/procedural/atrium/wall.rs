//! Walls with arched openings: the geometry that arcades, niches, doors and windows share.

use crate::scene::procedural::shapes::{Profile, Shape, patch, polygon, sweep};
use glam::{Affine3A, Mat3, Vec2, Vec3};
use std::f32::consts::PI;

/// An opening with a semicircular head, centered on x = 0 of a wall in the plane z = 0 that faces +z.
#[derive(Clone, Copy)]
pub struct Opening {
    pub half_width: f32,
    pub sill: f32,
    pub springing: f32,
}

/// A wall of `width` from `bottom` to `top` around `opening`; `steps` along its arch.
pub fn arched_wall(opening: &Opening, width: f32, [bottom, top]: [f32; 2], steps: usize) -> Shape {
    let (w, a) = (0.5 * width, opening.half_width);
    let rectangle = |x: [f32; 2], y: [f32; 2]| {
        let corners = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(i, j)| Vec3::new(x[i], y[j], 0.0));
        polygon(&corners, Vec3::Z)
    };
    let mut shape = Shape::default();
    if opening.sill > bottom {
        shape.append(&rectangle([-w, w], [bottom, opening.sill]));
    }
    if opening.springing > opening.sill {
        shape.append(&rectangle([-w, -a], [opening.sill, opening.springing]));
        shape.append(&rectangle([a, w], [opening.sill, opening.springing]));
    }
    // Rays from the middle of the arch to the outline, also through its corners.
    let rise = top - opening.springing;
    let corner = rise.atan2(w);
    let mut angles: Vec<f32> = (0..=steps).map(|i| PI * i as f32 / steps as f32).collect();
    angles.extend([corner, PI - corner]);
    angles.sort_by(f32::total_cmp);
    let on_outline = |angle: f32| {
        let d = Vec2::from_angle(angle);
        let reach = (w / d.x.abs().max(1e-6)).min(rise / d.y.max(1e-6));
        d * reach
    };
    for pair in angles.windows(2) {
        let [near_a, near_b] = [pair[0], pair[1]].map(|t| a * Vec2::from_angle(t));
        let [far_a, far_b] = [pair[0], pair[1]].map(on_outline);
        let corners = [near_a, far_a, far_b, near_b].map(|p| Vec3::new(p.x, p.y + opening.springing, 0.0));
        shape.append(&polygon(&corners, Vec3::Z));
    }
    shape
}

/// Frames along the edge of `opening`, up the left jamb, over the arch and down: x points away from the opening, y out
/// of the wall. A profile on them has its outer edge first.
pub fn opening_frames(opening: &Opening, steps: usize) -> Vec<Affine3A> {
    let frame = |angle: f32, y: f32| {
        let (sin, cos) = angle.sin_cos();
        let away = Vec3::new(cos, sin, 0.0);
        let turn = Mat3::from_cols(away, Vec3::Z, away.cross(Vec3::Z));
        Affine3A::from_mat3_translation(turn, Vec3::new(0.0, y, 0.0) + opening.half_width * away)
    };
    let mut frames = Vec::new();
    if opening.sill < opening.springing {
        frames.push(frame(PI, opening.sill));
    }
    frames.extend((0..=steps).map(|i| frame(PI * (1.0 - i as f32 / steps as f32), opening.springing)));
    if opening.sill < opening.springing {
        frames.push(frame(0.0, opening.sill));
    }
    frames
}

/// A moulded frame around `opening`.
pub fn surround(opening: &Opening, profile: &Profile, steps: usize) -> Shape {
    sweep(profile, &opening_frames(opening, steps))
}

/// How far mouldings around openings reach into the wall, m.
pub const MOULDING: f32 = 0.03;

/// The half-round hollow of a niche, `depth` deep, with a fluted shell as its head.
pub fn niche(opening: &Opening, depth: f32) -> Shape {
    let (a, height) = (opening.half_width, opening.springing - opening.sill);
    let hollow = patch([1, 14], |p| {
        let (sin, cos) = (PI * p.y).sin_cos();
        Vec3::new(a * cos, opening.sill + height * p.x, -depth * sin)
    });
    let shell = patch([4, 18], |p| {
        let (sin_a, cos_a) = (PI * p.y).sin_cos();
        let (sin_b, cos_b) = (0.5 * PI * p.x).sin_cos();
        let flute = 1.0 - 0.07 * (2.0 * sin_b * cos_b) * (PI * 7.0 * p.y).sin().abs();
        let shape = Vec3::new(a * cos_a, a * sin_a * cos_b, -depth * sin_a * sin_b);
        Vec3::new(0.0, opening.springing, 0.0) + shape * flute
    });
    let floor: Vec<Vec3> = (0..=14)
        .map(|i| PI * i as f32 / 14.0)
        .map(|t| Vec3::new(a * t.cos(), opening.sill, -depth * t.sin()))
        .collect();
    hollow.with(shell.flipped()).with(polygon(&floor, Vec3::Y))
}

/// The reveal of `opening`: its jambs and soffit, from the inner edge of its moulding to `depth` in the wall, and its
/// sill.
pub fn reveal(opening: &Opening, depth: f32, steps: usize) -> Shape {
    let into_wall = Profile::new(&[Vec2::new(0.0, -MOULDING), Vec2::new(0.0, -depth)], false);
    let a = opening.half_width;
    let sill = [(-a, 0.0), (a, 0.0), (a, -depth), (-a, -depth)].map(|(x, z)| Vec3::new(x, opening.sill, z));
    surround(opening, &into_wall, steps).with(polygon(&sill, Vec3::Y))
}

/// A flat leaf that fills `opening` at depth z.
pub fn panel(opening: &Opening, z: f32, steps: usize) -> Shape {
    let a = opening.half_width;
    let arc = (0..=steps).map(|i| PI * i as f32 / steps as f32);
    let head = arc.map(|t| Vec3::new(a * t.cos(), opening.springing + a * t.sin(), z));
    let feet = [Vec3::new(-a, opening.sill, z), Vec3::new(a, opening.sill, z)];
    polygon(&head.chain(feet).collect::<Vec<_>>(), Vec3::Z)
}
