//! Flat-faced shapes: boxes, slabs, mouldings around a square.

use super::{Profile, Shape, sweep};
use glam::{Affine3A, Mat3, Vec2, Vec3};

/// A flat convex polygon that faces `outward`.
pub fn polygon(corners: &[Vec3], outward: Vec3) -> Shape {
    let mut shape = Shape::default();
    let mut area = Vec3::ZERO;
    for pair in corners[1..].windows(2) {
        area += (pair[0] - corners[0]).cross(pair[1] - corners[0]);
    }
    let front = area.dot(outward) >= 0.0;
    let normal = area.normalize_or(outward) * if front { 1.0 } else { -1.0 };
    for &p in corners {
        shape.vertex(p, normal, planar_uv(p, normal));
    }
    for i in 1..corners.len() as u32 - 1 {
        shape.triangle(if front { [0, i, i + 1] } else { [0, i + 1, i] });
    }
    shape
}

/// Metres in the plane that `normal` is nearest to; v is up on walls.
fn planar_uv(p: Vec3, normal: Vec3) -> Vec2 {
    let n = normal.abs();
    if n.y > n.x && n.y > n.z {
        Vec2::new(p.x, p.z)
    } else if n.x > n.z {
        Vec2::new(p.z, p.y)
    } else {
        Vec2::new(p.x, p.y)
    }
}

/// The six faces of a box.
pub fn cuboid(min: Vec3, max: Vec3) -> Shape {
    bevelled_cuboid(min, max, 0.0)
}

/// A box whose edges are cut by `bevel` (m).
pub fn bevelled_cuboid(min: Vec3, max: Vec3, bevel: f32) -> Shape {
    let (center, half) = (0.5 * (min + max), 0.5 * (max - min));
    let inner = half - Vec3::splat(bevel);
    // The corner in octant `s` that belongs to the face of `axis`.
    let corner = |s: Vec3, axis: usize| {
        let mut p = inner * s;
        p[axis] = half[axis] * s[axis];
        center + p
    };
    let mut shape = Shape::default();
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for sign in [-1.0f32, 1.0] {
            let octant = |su: f32, sv: f32| {
                let mut s = Vec3::ZERO;
                (s[axis], s[u], s[v]) = (sign, su, sv);
                s
            };
            let ring = [octant(-1.0, -1.0), octant(1.0, -1.0), octant(1.0, 1.0), octant(-1.0, 1.0)];
            shape.append(&polygon(&ring.map(|s| corner(s, axis)), octant(0.0, 0.0)));
            if bevel > 0.0 {
                // The edge between the faces of `axis` and `u`, one for each of their signs.
                for side in [-1.0f32, 1.0] {
                    let [a, b] = [octant(side, -1.0), octant(side, 1.0)];
                    let edge = [corner(a, axis), corner(b, axis), corner(b, u), corner(a, u)];
                    shape.append(&polygon(&edge, octant(side, 0.0)));
                }
            }
        }
    }
    if bevel > 0.0 {
        for i in 0..8 {
            let s = Vec3::new(sign_of(i & 1), sign_of(i & 2), sign_of(i & 4));
            shape.append(&polygon(&[0, 1, 2].map(|axis| corner(s, axis)), s));
        }
    }
    shape
}

fn sign_of(bit: i32) -> f32 {
    if bit == 0 { -1.0 } else { 1.0 }
}

/// A paving stone: the convex `outline` (x, z) at height `top`, its edge cut by `bevel` and open below `top - depth`.
pub fn bevelled_slab(outline: &[Vec2], top: f32, depth: f32, bevel: f32) -> Shape {
    let center = outline.iter().copied().sum::<Vec2>() / outline.len() as f32;
    let at = |p: Vec2, y: f32| Vec3::new(p.x, y, p.y);
    let inset = |p: Vec2| p + (center - p).normalize_or_zero() * bevel * std::f32::consts::SQRT_2;
    let surface: Vec<Vec3> = outline.iter().map(|&p| at(inset(p), top)).collect();
    let mut shape = polygon(&surface, Vec3::Y);
    for i in 0..outline.len() {
        let (p, q) = (outline[i], outline[(i + 1) % outline.len()]);
        let outward = at(0.5 * (p + q) - center, 0.0).normalize() + Vec3::Y;
        let side = [at(inset(p), top), at(inset(q), top), at(q, top - depth), at(p, top - depth)];
        shape.append(&polygon(&side, outward));
    }
    shape
}

/// `profile` (distance from the axis, height) around a square: plinths, piers, abaci.
pub fn square_turned(profile: &Profile) -> Shape {
    let mut shape = Shape::default();
    for side in 0..4 {
        let turn = Mat3::from_rotation_y(std::f32::consts::FRAC_PI_2 * side as f32);
        // Mitred ends: z grows with the distance from the axis.
        let end = |sign: f32| {
            let x = turn * Vec3::new(1.0, 0.0, sign);
            Affine3A::from_mat3(Mat3::from_cols(x, Vec3::Y, turn * Vec3::Z))
        };
        let mut strip = sweep(profile, &[end(-1.0), end(1.0)]);
        let rows = profile.vertices.len();
        for (i, n) in strip.normals.iter_mut().enumerate() {
            *n = turn * profile.vertices[i % rows].1.extend(0.0);
        }
        shape.append(&strip);
    }
    shape
}
