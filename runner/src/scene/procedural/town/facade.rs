//! Facades of houses: walls with windows, doors and shops.

use super::materials::{Finish, Part};
use crate::scene::procedural::shapes::{Shape, cuboid, polygon};
use glam::{Vec2, Vec3};

/// How far panes lie behind the wall, m.
pub const RECESS: f32 = 0.22;
/// How far lit panes lie before dark ones, m: more than the offset of rays at the town's edge.
const GLOW: f32 = 0.02;

/// An upright plane: seen from outside, `along` goes to the right, y up.
#[derive(Clone, Copy, Debug)]
pub struct Face {
    /// Its lower left corner.
    pub origin: Vec3,
    /// Unit, level.
    pub along: Vec3,
}

/// A rectangle that may glow, in the space of its house.
#[derive(Clone, Copy, Debug)]
pub struct Pane {
    face: Face,
    u: [f32; 2],
    v: [f32; 2],
    depth: f32,
}

/// A hole in a wall: its sides and its sill and head, m.
#[derive(Clone, Copy, Debug)]
pub struct Opening {
    pub u: [f32; 2],
    pub v: [f32; 2],
}

/// How windows look.
#[derive(Clone, Copy, Debug)]
pub struct Window {
    pub size: Vec2,
    pub sill: bool,
    pub cross: bool,
}

impl Face {
    pub fn new(origin: Vec3, along: Vec3) -> Self {
        Face { origin, along }
    }

    /// Unit, out of the wall.
    pub fn normal(&self) -> Vec3 {
        self.along.cross(Vec3::Y)
    }

    /// `depth` behind the plane.
    pub fn at(&self, u: f32, v: f32, depth: f32) -> Vec3 {
        self.origin + self.along * u + Vec3::Y * v - self.normal() * depth
    }

    /// Seen from outside.
    pub fn quad(&self, u: [f32; 2], v: [f32; 2], depth: f32) -> Shape {
        let at = |u, v| self.at(u, v, depth);
        polygon(&[at(u[0], v[0]), at(u[1], v[0]), at(u[1], v[1]), at(u[0], v[1])], self.normal())
    }

    /// A box whose front lies `out` before the plane and whose back `depth` behind it.
    pub fn block(&self, u: [f32; 2], v: [f32; 2], [out, depth]: [f32; 2]) -> Shape {
        let (a, b) = (self.at(u[0], v[0], -out), self.at(u[1], v[1], depth));
        cuboid(a.min(b), a.max(b))
    }

    /// The four sides of a hole, from the plane to `depth` behind it.
    fn reveal(&self, hole: &Opening, depth: f32) -> Shape {
        let ([l, r], [b, t]) = (hole.u, hole.v);
        let at = |u, v, d| self.at(u, v, d);
        let side = |p: [f32; 2], q: [f32; 2], inward: Vec3| {
            let (p0, p1) = (at(p[0], p[1], 0.0), at(p[0], p[1], depth));
            let (q0, q1) = (at(q[0], q[1], 0.0), at(q[0], q[1], depth));
            polygon(&[p0, q0, q1, p1], inward)
        };
        side([l, b], [r, b], Vec3::Y)
            .with(side([l, t], [r, t], Vec3::NEG_Y))
            .with(side([l, b], [l, t], self.along))
            .with(side([r, b], [r, t], -self.along))
    }
}

impl Pane {
    /// In the glass of `hole`.
    pub fn of(face: Face, hole: &Opening, depth: f32) -> Self {
        Pane { face, u: hole.u, v: hole.v, depth: depth - GLOW }
    }

    /// The part of it between these shares of its width and height.
    pub fn shape(&self, [l, r]: [f32; 2], [b, t]: [f32; 2]) -> Shape {
        let u = |s: f32| self.u[0] + (self.u[1] - self.u[0]) * s;
        let v = |s: f32| self.v[0] + (self.v[1] - self.v[0]) * s;
        self.face.quad([u(l), u(r)], [v(b), v(t)], self.depth)
    }
}

/// A wall from u = 0 to `width` between two heights, with holes (from left to right, apart from each other).
pub fn wall(face: &Face, width: f32, [bottom, top]: [f32; 2], holes: &[Opening]) -> Shape {
    let mut shape = Shape::default();
    let mut left = 0.0;
    for hole in holes {
        shape.append(&face.quad([left, hole.u[0]], [bottom, top], 0.0));
        for v in [[bottom, hole.v[0]], [hole.v[1], top]] {
            if v[1] - v[0] > 1e-3 {
                shape.append(&face.quad(hole.u, v, 0.0));
            }
        }
        left = hole.u[1];
    }
    shape.with(face.quad([left, width], [bottom, top], 0.0))
}

/// `count` windows side by side, in the middles of bays of `bay`, their sills at `sill`.
pub fn windows(count: usize, bay: f32, sill: f32, size: Vec2) -> Vec<Opening> {
    let hole = |i: usize| {
        let middle = (i as f32 + 0.5) * bay;
        Opening { u: [middle - 0.5 * size.x, middle + 0.5 * size.x], v: [sill, sill + size.y] }
    };
    (0..count).map(hole).collect()
}

/// Reveal, dark glass, bars and sill of a window.
pub fn glaze(part: &mut Part, face: &Face, hole: &Opening, wall: Finish, window: &Window) -> Pane {
    let ([l, r], [b, t]) = (hole.u, hole.v);
    part.add(wall, &face.reveal(hole, RECESS));
    part.add(Finish::Glass, &face.quad(hole.u, hole.v, RECESS));
    let bar = |u, v| face.quad(u, v, RECESS - 0.05);
    let (w, middle) = (0.035, 0.5 * (l + r));
    let rail = b + 0.68 * (t - b);
    part.add(Finish::Frame, &bar([middle - w, middle + w], [b, t]));
    if window.cross {
        part.add(Finish::Frame, &bar([l, middle - w], [rail - w, rail + w]));
        part.add(Finish::Frame, &bar([middle + w, r], [rail - w, rail + w]));
    }
    if window.sill {
        part.add(Finish::Stone, &face.block([l - 0.08, r + 0.08], [b - 0.1, b], [0.1, 0.02]));
    }
    Pane::of(*face, hole, RECESS)
}

/// A closed door with a light over it.
pub fn door(part: &mut Part, face: &Face, hole: &Opening, wall: Finish) -> Pane {
    let head = hole.v[0] + 2.3;
    part.add(wall, &face.reveal(hole, RECESS));
    part.add(Finish::Door, &face.quad(hole.u, [hole.v[0], head], RECESS));
    part.add(Finish::Frame, &face.quad(hole.u, [head, head + 0.08], RECESS - 0.05));
    part.add(Finish::Glass, &face.quad(hole.u, [head, hole.v[1]], RECESS));
    let light = Opening { u: hole.u, v: [head + 0.08, hole.v[1]] };
    Pane::of(*face, &light, RECESS)
}

/// The sides of an open hole, through a wall of `thickness`.
pub fn pierce(part: &mut Part, face: &Face, hole: &Opening, finish: Finish, thickness: f32) {
    part.add(finish, &face.reveal(hole, thickness));
}

/// The inside of a box: floor, ceiling, back and two sides, without its front (+z).
pub fn alcove(min: Vec3, max: Vec3) -> [Shape; 3] {
    let at = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
    let (a, b) = (min, max);
    let floor =
        polygon(&[at(a.x, a.y, a.z), at(a.x, a.y, b.z), at(b.x, a.y, b.z), at(b.x, a.y, a.z)], Vec3::Y);
    let ceiling =
        polygon(&[at(a.x, b.y, a.z), at(a.x, b.y, b.z), at(b.x, b.y, b.z), at(b.x, b.y, a.z)], Vec3::NEG_Y);
    let back =
        polygon(&[at(a.x, a.y, a.z), at(b.x, a.y, a.z), at(b.x, b.y, a.z), at(a.x, b.y, a.z)], Vec3::Z);
    let left =
        polygon(&[at(a.x, a.y, a.z), at(a.x, a.y, b.z), at(a.x, b.y, b.z), at(a.x, b.y, a.z)], Vec3::X);
    let right =
        polygon(&[at(b.x, a.y, a.z), at(b.x, a.y, b.z), at(b.x, b.y, b.z), at(b.x, b.y, a.z)], Vec3::NEG_X);
    [floor, ceiling, back.with(left).with(right)]
}
