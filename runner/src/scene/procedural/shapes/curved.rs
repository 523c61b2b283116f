//! Curved surfaces: sweeps of a profile, patches of a function.

use super::{Profile, Shape};
use glam::{Affine3A, Mat3, Vec2, Vec3};
use std::collections::HashMap;
use std::f32::consts::{PI, TAU};

/// The surface of `profile` carried along `frames`. A frame maps the profile's plane (x, y, 0) to space and its z axis
/// is the direction of travel.
pub fn sweep(profile: &Profile, frames: &[Affine3A]) -> Shape {
    let mut shape = Shape::default();
    let middle = profile.vertices[profile.vertices.len() / 2].0.extend(0.0);
    let (mut travelled, mut last) = (0.0, frames[0].transform_point3(middle));
    for frame in frames {
        let of_normals = Mat3::from(frame.matrix3).inverse().transpose();
        let here = frame.transform_point3(middle);
        travelled += here.distance(last);
        last = here;
        for &(p, n, length) in &profile.vertices {
            let normal = (of_normals * n.extend(0.0)).normalize();
            shape.vertex(frame.transform_point3(p.extend(0.0)), normal, Vec2::new(travelled, length));
        }
    }
    let row = profile.vertices.len() as u32;
    for j in 0..frames.len() as u32 - 1 {
        for [a, b] in &profile.edges {
            shape.quad([j * row + a, j * row + b, (j + 1) * row + b, (j + 1) * row + a]);
        }
    }
    shape
}

/// `profile` (radius, height) turned around the y axis.
pub fn lathe(profile: &Profile, segments: usize) -> Shape {
    let frame = |i: usize| {
        // The seam closes with the very same bits.
        let (sin, cos) = (TAU * (i % segments) as f32 / segments as f32).sin_cos();
        let radial = Vec3::new(cos, 0.0, sin);
        Affine3A::from_mat3(Mat3::from_cols(radial, Vec3::Y, radial.cross(Vec3::Y)))
    };
    sweep(profile, &(0..=segments).map(frame).collect::<Vec<_>>())
}

/// The surface `position(u, v)`, u and v in 0..=1, in `steps` quads; its front has normal dP/du x dP/dv. Normals are
/// those of its triangles, averaged at each place (also across a seam that closes), so they suit coarse steps too.
pub fn patch(steps: [usize; 2], position: impl Fn(Vec2) -> Vec3) -> Shape {
    let [nu, nv] = steps;
    let at = |i: usize, j: usize| Vec2::new(i as f32 / nu as f32, j as f32 / nv as f32);
    let length_u: f32 = (1..=nu).map(|i| position(at(i, nv / 2)).distance(position(at(i - 1, nv / 2)))).sum();
    let length_v: f32 = (1..=nv).map(|j| position(at(nu / 2, j)).distance(position(at(nu / 2, j - 1)))).sum();
    let mut shape = Shape::default();
    for j in 0..=nv {
        for i in 0..=nu {
            shape.vertex(position(at(i, j)), Vec3::ZERO, at(i, j) * Vec2::new(length_u, length_v));
        }
    }
    let row = nu as u32 + 1;
    for j in 0..nv as u32 {
        for i in 0..nu as u32 {
            let a = j * row + i;
            shape.quad([a, a + 1, a + 1 + row, a + row]);
        }
    }
    average_normals(&mut shape);
    shape
}

/// Sets each normal to the mean, by area, of the triangles at its position.
fn average_normals(shape: &mut Shape) {
    let place = |p: Vec3| p.to_array().map(|x| (x + 0.0).to_bits());
    let mut sums: HashMap<[u32; 3], Vec3> = HashMap::new();
    for t in shape.indices.chunks_exact(3) {
        let [a, b, c] = [t[0], t[1], t[2]].map(|i| shape.positions[i as usize]);
        let normal = (b - a).cross(c - a);
        for p in [a, b, c] {
            *sums.entry(place(p)).or_default() += normal;
        }
    }
    for (n, &p) in shape.normals.iter_mut().zip(&shape.positions) {
        *n = sums.get(&place(p)).map_or(Vec3::Y, |sum| sum.normalize_or(Vec3::Y));
    }
}

/// A closed tube around `curve` (x, y; v in 0..=1) of elliptic section: half-axes in the plane and along z by `radii`.
/// `steps`: along, around.
pub fn planar_tube(steps: [usize; 2], curve: impl Fn(f32) -> Vec2, radii: impl Fn(f32) -> Vec2) -> Shape {
    tube_section(steps, curve, radii, [0.0, 2.0])
}

/// As [`planar_tube`], but only the part of the section in `turn` (half turns, from the right of the curve).
pub fn tube_section(
    steps: [usize; 2],
    curve: impl Fn(f32) -> Vec2,
    radii: impl Fn(f32) -> Vec2,
    [from, to]: [f32; 2],
) -> Shape {
    patch(steps, |uv| {
        let h = 1e-3;
        let tangent = (curve(uv.x + h) - curve(uv.x - h)).normalize_or(Vec2::Y);
        // A whole turn ends with the very bits that it starts with.
        let (sin, cos) = (PI * ((from + (to - from) * uv.y) % 2.0)).sin_cos();
        let r = radii(uv.x);
        let p = curve(uv.x) + r.x * cos * Vec2::new(tangent.y, -tangent.x);
        p.extend(r.y * sin)
    })
}

/// A straight round rod from `a` to `b`, without caps.
pub fn tube(a: Vec3, b: Vec3, radius: f32, segments: usize) -> Shape {
    let axis = (b - a).normalize();
    let (x, y) = axis.any_orthonormal_pair();
    let turn = Mat3::from_cols(x, y, axis);
    let turn = if turn.determinant() < 0.0 { Mat3::from_cols(y, x, axis) } else { turn };
    let circle: Vec<Vec2> =
        (0..segments).map(|i| radius * Vec2::from_angle(TAU * i as f32 / segments as f32)).collect();
    let mut profile = Profile::new(&circle, true);
    for vertex in &mut profile.vertices {
        vertex.1 = vertex.0.normalize();
    }
    sweep(&profile, &[a, b].map(|p| Affine3A::from_mat3_translation(turn, p)))
}

/// A ball around the origin.
pub fn sphere(radius: f32, segments: usize) -> Shape {
    let rings = segments / 2;
    let points: Vec<Vec2> = (0..=rings)
        .map(|i| radius * Vec2::from_angle(PI * (i as f32 / rings as f32 - 0.5)))
        .map(|p| Vec2::new(p.x.max(0.0), p.y))
        .collect();
    let mut profile = Profile::new(&points, false);
    for vertex in &mut profile.vertices {
        vertex.1 = vertex.0.normalize();
    }
    lathe(&profile, segments)
}
