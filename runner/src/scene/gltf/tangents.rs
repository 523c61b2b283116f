//! Tangents from texture coordinates, where a file has none.

use super::geometry::gather;
use crate::scene::Primitive;
use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use glam::{Vec2, Vec3, Vec4};
use shared::math::normalize_or;
use std::collections::HashMap;

/// Computes `primitive.tangents` for normal maps that lie by `uvs` (one a vertex; v grows downwards), as glTF 2.0
/// (3.7.2.1) wants it: by MikkTSpace (Mikkelsen 2008, "Simulation of Wrinkled Surfaces Revisited"). Vertices whose
/// triangles disagree, as at mirrored seams, are split.
pub fn compute(primitive: &mut Primitive, uvs: &[Vec2]) {
    let corners = vec![Vec4::ZERO; primitive.indices.len()];
    let mut mesh = Corners { primitive, uvs, tangents: corners };
    // Its error type has no value.
    let Ok(()) = generate_tangents(&mut mesh) else { return };
    let tangents = mesh.tangents;
    split(primitive, &tangents);
}

/// Gives each different (vertex, tangent) among the corners a vertex of its own.
fn split(primitive: &mut Primitive, tangents: &[Vec4]) {
    let mut places: HashMap<(u32, [u32; 4]), u32> = HashMap::new();
    let (mut order, mut kept) = (Vec::new(), Vec::new());
    for (index, &tangent) in primitive.indices.iter_mut().zip(tangents) {
        let key = (*index, tangent.to_array().map(f32::to_bits));
        let place = *places.entry(key).or_insert_with(|| {
            order.push(*index);
            kept.push(tangent);
            order.len() as u32 - 1
        });
        *index = place;
    }
    gather(primitive, &order);
    primitive.tangents = kept;
}

/// A primitive as MikkTSpace asks for it, corner by corner.
struct Corners<'a> {
    primitive: &'a Primitive,
    uvs: &'a [Vec2],
    tangents: Vec<Vec4>,
}

impl Corners<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.primitive.indices[3 * face + corner] as usize
    }
}

impl Geometry for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.primitive.indices.len() / 3
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.primitive.positions[self.vertex(face, corner)].to_array()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        self.primitive.normals[self.vertex(face, corner)].to_array()
    }

    /// v is turned upwards: green of a glTF normal map points to the top of its image.
    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        let uv = self.uvs[self.vertex(face, corner)];
        [uv.x, 1.0 - uv.y]
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        let [x, y, z, w] = space.map_or([0.0, 0.0, 0.0, 1.0], |space| space.tangent_encoded());
        let normal = self.primitive.normals[self.vertex(face, corner)];
        let tangent = Vec3::new(x, y, z);
        // Where the uvs have no extent, any tangent will do.
        let across = normalize_or(tangent - normal * normal.dot(tangent), normal.any_orthonormal_vector());
        self.tangents[3 * face + corner] = across.extend(w);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A triangle in the xy plane that faces +z.
    fn triangle() -> Primitive {
        Primitive {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            normals: vec![Vec3::Z; 3],
            indices: vec![0, 1, 2],
            ..Primitive::default()
        }
    }

    /// Its texture upright; then mirrored, turned, and without an extent.
    #[test]
    fn tangents_follow_the_texture() {
        let tangent = |uvs: [Vec2; 3]| {
            let mut primitive = triangle();
            compute(&mut primitive, &uvs);
            primitive.tangents[0]
        };
        // uv of the origin, of +x and of +y; v grows downwards.
        let (o, u, v) = (Vec2::ZERO, Vec2::X, Vec2::Y);
        assert_eq!(tangent([v, u + v, o]), Vec4::new(1.0, 0.0, 0.0, 1.0));
        assert_eq!(tangent([u + v, v, u]), Vec4::new(-1.0, 0.0, 0.0, -1.0));
        assert_eq!(tangent([o, v, u]), Vec4::new(0.0, 1.0, 0.0, 1.0));
        let degenerate = tangent([o, o, o]);
        assert!(degenerate.truncate().is_normalized() && degenerate.z == 0.0, "{degenerate}");
    }

    /// Two triangles that share an edge where the texture is mirrored: its vertices get a tangent for each side.
    #[test]
    fn mirrored_seams_are_split() {
        let mut primitive = triangle();
        primitive.positions.push(-Vec3::X);
        primitive.normals.push(Vec3::Z);
        primitive.indices.extend([0, 2, 3]);
        let uvs = [Vec2::Y, Vec2::ONE, Vec2::ZERO, Vec2::ONE];
        compute(&mut primitive, &uvs);
        assert_eq!(primitive.positions.len(), 6);
        let right = Vec4::new(1.0, 0.0, 0.0, 1.0);
        let left = Vec4::new(-1.0, 0.0, 0.0, -1.0);
        assert_eq!(primitive.tangents, [right, right, right, left, left, left]);
    }

    /// Where all agree, vertices stay shared.
    #[test]
    fn smooth_meshes_stay_welded() {
        let mut primitive = triangle();
        primitive.positions.push(Vec3::new(1.0, 1.0, 0.0));
        primitive.normals.push(Vec3::Z);
        primitive.indices.extend([1, 3, 2]);
        let uvs = [Vec2::Y, Vec2::ONE, Vec2::ZERO, Vec2::X];
        compute(&mut primitive, &uvs);
        assert_eq!((primitive.positions.len(), primitive.indices), (4, vec![0, 1, 2, 1, 3, 2]));
    }
}
