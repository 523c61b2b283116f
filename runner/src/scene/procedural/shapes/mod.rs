//! Shapes as triangles: the vocabulary of generated scenes. Counter-clockwise fronts, unit normals, uvs in metres.

mod curved;
mod flat;
mod profile;

pub use curved::{lathe, patch, planar_tube, sphere, sweep, tube, tube_section};
pub use flat::{bevelled_cuboid, bevelled_slab, cuboid, polygon, square_turned};
pub use profile::{Outline, Profile};

use crate::scene::Primitive;
use glam::{Affine3A, Mat3, Vec2, Vec3, Vec4};

/// Triangles below this area (m²) are left out: poles of turned shapes, folded tips.
const MIN_AREA: f32 = 1e-8;

/// A surface of one material. The vertex vectors are equally long; three indices a triangle.
#[derive(Clone, Debug, Default)]
pub struct Shape {
    pub positions: Vec<Vec3>,
    pub normals: Vec<Vec3>,
    pub uvs: Vec<Vec2>,
    pub indices: Vec<u32>,
}

impl Shape {
    /// Adds a vertex, returns its index.
    pub fn vertex(&mut self, position: Vec3, normal: Vec3, uv: Vec2) -> u32 {
        self.positions.push(position);
        self.normals.push(normal);
        self.uvs.push(uv);
        self.positions.len() as u32 - 1
    }

    /// Adds a triangle, unless it has no area.
    pub fn triangle(&mut self, corners: [u32; 3]) {
        let [a, b, c] = corners.map(|i| self.positions[i as usize]);
        if 0.5 * (b - a).cross(c - a).length() > MIN_AREA {
            self.indices.extend(corners);
        }
    }

    /// Adds the quad a, b, c, d (counter-clockwise).
    pub fn quad(&mut self, [a, b, c, d]: [u32; 4]) {
        self.triangle([a, b, c]);
        self.triangle([a, c, d]);
    }

    pub fn append(&mut self, other: &Shape) {
        let base = self.positions.len() as u32;
        self.positions.extend(&other.positions);
        self.normals.extend(&other.normals);
        self.uvs.extend(&other.uvs);
        self.indices.extend(other.indices.iter().map(|i| i + base));
    }

    /// This and `other`.
    pub fn with(mut self, other: Shape) -> Shape {
        self.append(&other);
        self
    }

    /// The shape under `transform`; a mirror turns the triangles, so that they still face outward.
    pub fn moved(mut self, transform: Affine3A) -> Shape {
        let linear = Mat3::from(transform.matrix3);
        let of_normals = linear.inverse().transpose();
        for (p, n) in self.positions.iter_mut().zip(&mut self.normals) {
            *p = transform.transform_point3(*p);
            *n = (of_normals * *n).normalize();
        }
        if linear.determinant() < 0.0 {
            self.indices.chunks_exact_mut(3).for_each(|t| t.swap(1, 2));
        }
        self
    }

    pub fn shifted(self, by: Vec3) -> Shape {
        self.moved(Affine3A::from_translation(by))
    }

    /// The same surface seen from its other side.
    pub fn flipped(mut self) -> Shape {
        self.normals.iter_mut().for_each(|n| *n = -*n);
        self.indices.chunks_exact_mut(3).for_each(|t| t.swap(1, 2));
        self
    }

    /// As a primitive; `tangents`: its material has a normal map.
    pub fn into_primitive(self, material: usize, tangents: bool) -> Primitive {
        Primitive {
            material,
            tangents: if tangents { self.tangents() } else { Vec::new() },
            positions: self.positions,
            normals: self.normals,
            uvs: self.uvs,
            indices: self.indices,
            ..Primitive::default()
        }
    }

    /// Tangents along +u, with the handedness of the uvs (Lengyel 2001, summed over the triangles of a vertex).
    fn tangents(&self) -> Vec<Vec4> {
        let mut sums = vec![(Vec3::ZERO, Vec3::ZERO); self.positions.len()];
        for t in self.indices.chunks_exact(3) {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| i as usize);
            let (e1, e2) = (self.positions[b] - self.positions[a], self.positions[c] - self.positions[a]);
            let (d1, d2) = (self.uvs[b] - self.uvs[a], self.uvs[c] - self.uvs[a]);
            // The sign of the determinant is enough: its size only weighs the triangles.
            let sign = d1.perp_dot(d2).signum();
            let (along_u, along_v) = (sign * (e1 * d2.y - e2 * d1.y), sign * (e2 * d1.x - e1 * d2.x));
            for i in [a, b, c] {
                sums[i].0 += along_u;
                sums[i].1 += along_v;
            }
        }
        let tangent = |(&n, &(u, v)): (&Vec3, &(Vec3, Vec3))| {
            let t = (u - n * n.dot(u)).try_normalize().unwrap_or_else(|| n.any_orthonormal_vector());
            t.extend(if n.cross(t).dot(v) < 0.0 { -1.0 } else { 1.0 })
        };
        self.normals.iter().zip(&sums).map(tangent).collect()
    }
}
