//! Two-dimensional outlines: what a lathe turns and a sweep pulls along.

use glam::Vec2;
use std::f32::consts::PI;

/// Neighboring edges that turn by less than 40 degrees are shaded as one curve.
const CREASE_COS: f32 = 0.766;

/// A polyline under construction, m.
#[derive(Clone, Debug, Default)]
pub struct Outline(pub Vec<Vec2>);

impl Outline {
    pub fn from(x: f32, y: f32) -> Self {
        Outline(vec![Vec2::new(x, y)])
    }

    /// A straight edge to (x, y).
    pub fn to(mut self, x: f32, y: f32) -> Self {
        self.0.push(Vec2::new(x, y));
        self
    }

    /// An edge to the start of an arc, then the arc. Angles in half turns, counter-clockwise from +x.
    pub fn arc(mut self, center: (f32, f32), radius: f32, (from, to): (f32, f32), steps: usize) -> Self {
        for i in 0..=steps {
            let angle = PI * (from + (to - from) * i as f32 / steps as f32);
            let p = Vec2::from(center) + radius * Vec2::from_angle(angle);
            if self.0.last().is_none_or(|last| last.distance(p) > 1e-4) {
                self.0.push(p);
            }
        }
        self
    }

    pub fn open(&self) -> Profile {
        Profile::new(&self.0, false)
    }

    /// Closed back to its start.
    pub fn closed(&self) -> Profile {
        Profile::new(&self.0, true)
    }
}

/// An outline with normals: its surface is on the right of its direction.
#[derive(Clone, Debug)]
pub struct Profile {
    /// Position, unit normal, length from the start (m). A crease has two vertices.
    pub vertices: Vec<(Vec2, Vec2, f32)>,
    /// Pairs of vertices.
    pub edges: Vec<[u32; 2]>,
}

impl Profile {
    /// Consecutive points must differ.
    pub fn new(points: &[Vec2], closed: bool) -> Self {
        let n = points.len();
        let edge_count = if closed { n } else { n - 1 };
        let directions: Vec<Vec2> =
            (0..edge_count).map(|i| (points[(i + 1) % n] - points[i]).normalize()).collect();
        // The normal at one end of an edge: shared with the neighbor across that end unless there is a crease.
        let normal = |edge: usize, neighbor: Option<usize>| {
            let own = directions[edge];
            let tangent = match neighbor.map(|i| directions[i]) {
                Some(other) if own.dot(other) > CREASE_COS => (own + other).normalize(),
                _ => own,
            };
            Vec2::new(tangent.y, -tangent.x)
        };
        let mut profile = Profile { vertices: Vec::new(), edges: Vec::new() };
        let mut length = 0.0;
        for i in 0..edge_count {
            let before = if i > 0 { Some(i - 1) } else { closed.then_some(edge_count - 1) };
            let after = if i + 1 < edge_count { Some(i + 1) } else { closed.then_some(0) };
            let (a, b) = (points[i], points[(i + 1) % n]);
            let start = (a, normal(i, before), length);
            length += a.distance(b);
            let first = match profile.vertices.last() {
                Some(last) if last.1.distance(start.1) < 1e-6 => profile.vertices.len() as u32 - 1,
                _ => {
                    profile.vertices.push(start);
                    profile.vertices.len() as u32 - 1
                }
            };
            profile.vertices.push((b, normal(i, after), length));
            profile.edges.push([first, profile.vertices.len() as u32 - 1]);
        }
        profile
    }
}
