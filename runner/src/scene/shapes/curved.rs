//! Curved surfaces: sweeps of a profile, patches of a function.

use super::{Profile, Shape};
use glam::{Affine3A, Mat3, Vec2, Vec3};
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

/// The surface `position(u, v)`, u and v in 0..=1, in `steps` quads; its front has normal dP/du x dP/dv.
pub fn patch(steps: [usize; 2], position: impl Fn(Vec2) -> Vec3) -> Shape {
    const H: f32 = 1.0 / 512.0;
    let [nu, nv] = steps;
    let mut shape = Shape::default();
    // Differences stay inside the domain, which also keeps them away from poles on its border.
    let derivatives = |uv: Vec2| {
        let c = uv.clamp(Vec2::splat(H), Vec2::splat(1.0 - H));
        let (du, dv) = (Vec2::new(H, 0.0), Vec2::new(0.0, H));
        (position(c + du) - position(c - du), position(c + dv) - position(c - dv))
    };
    let (along_u, along_v) = derivatives(Vec2::splat(0.5));
    let size = Vec2::new(along_u.length(), along_v.length()) / (2.0 * H);
    for j in 0..=nv {
        for i in 0..=nu {
            let uv = Vec2::new(i as f32 / nu as f32, j as f32 / nv as f32);
            let (along_u, along_v) = derivatives(uv);
            shape.vertex(position(uv), along_u.cross(along_v).normalize_or(Vec3::Y), uv * size);
        }
    }
    let row = nu as u32 + 1;
    for j in 0..nv as u32 {
        for i in 0..nu as u32 {
            let a = j * row + i;
            shape.quad([a, a + 1, a + 1 + row, a + row]);
        }
    }
    shape
}

/// A closed tube around `curve` (x, y; v in 0..=1) of elliptic section: half-axes in the plane and along z by `radii`.
/// `steps`: along, around.
pub fn planar_tube(steps: [usize; 2], curve: impl Fn(f32) -> Vec2, radii: impl Fn(f32) -> Vec2) -> Shape {
    patch(steps, |uv| {
        let h = 1e-3;
        let tangent = (curve(uv.x + h) - curve(uv.x - h)).normalize_or(Vec2::Y);
        // Around by v, whose ends meet with the very same bits.
        let (sin, cos) = if uv.y == 1.0 { (0.0, 1.0) } else { (TAU * uv.y).sin_cos() };
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
