//! Tangents from texture coordinates, where a file has none.

use crate::scene::Primitive;
use glam::{Vec2, Vec3};
use shared::math::normalize_or;

/// Computes `primitive.tangents` from positions, normals and uvs, none of them empty: the directions of growing u,
/// summed over the triangles of a vertex (Lengyel 2001, "Computing Tangent Space Basis Vectors for an Arbitrary
/// Mesh"). The sign follows glTF: bitangent = w · normal × tangent points to the top of the image.
pub fn compute(primitive: &mut Primitive) {
    let vertices = primitive.positions.len();
    let mut sums = vec![(Vec3::ZERO, Vec3::ZERO); vertices];
    for t in primitive.indices.chunks_exact(3) {
        let corners = [t[0], t[1], t[2]].map(|i| i as usize);
        let (along_u, along_v) =
            gradients(corners.map(|i| primitive.positions[i]), corners.map(|i| primitive.uvs[i]));
        for i in corners {
            sums[i].0 += along_u;
            sums[i].1 += along_v;
        }
    }
    let tangent = |(&normal, &(along_u, along_v)): (&Vec3, &(Vec3, Vec3))| {
        let across = along_u - normal * normal.dot(along_u);
        let direction = normalize_or(across, normal.any_orthonormal_vector());
        // v grows downwards in the image.
        let up = normal.cross(direction).dot(-along_v);
        direction.extend(if up < 0.0 { -1.0 } else { 1.0 })
    };
    primitive.tangents = primitive.normals.iter().zip(&sums).map(tangent).collect();
}

/// Unit directions in which u and v grow on a triangle; 0 where the uvs are degenerate.
fn gradients(p: [Vec3; 3], uv: [Vec2; 3]) -> (Vec3, Vec3) {
    let (edge1, edge2) = (p[1] - p[0], p[2] - p[0]);
    let (d1, d2) = (uv[1] - uv[0], uv[2] - uv[0]);
    let sign = if d1.perp_dot(d2) < 0.0 { -1.0 } else { 1.0 };
    if d1.perp_dot(d2) == 0.0 {
        return (Vec3::ZERO, Vec3::ZERO);
    }
    let along_u = (edge1 * d2.y - edge2 * d1.y) * sign;
    let along_v = (edge2 * d1.x - edge1 * d2.x) * sign;
    (normalize_or(along_u, Vec3::ZERO), normalize_or(along_v, Vec3::ZERO))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec4;

    /// A quad in the xy plane that faces +z, its texture upright; then mirrored, turned, and without an extent.
    #[test]
    fn tangents_follow_the_texture() {
        let tangent = |uvs: [Vec2; 3]| {
            let mut primitive = Primitive {
                positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
                normals: vec![Vec3::Z; 3],
                uvs: uvs.to_vec(),
                indices: vec![0, 1, 2],
                ..Primitive::default()
            };
            compute(&mut primitive);
            primitive.tangents[0]
        };
        // uv of the origin, of +x and of +y; v grows downwards.
        let (o, u, v) = (Vec2::ZERO, Vec2::X, Vec2::Y);
        assert_eq!(tangent([v, u + v, o]), Vec4::new(1.0, 0.0, 0.0, 1.0));
        assert_eq!(tangent([u + v, v, u]), Vec4::new(-1.0, 0.0, 0.0, -1.0));
        assert_eq!(tangent([o, v, u]), Vec4::new(0.0, 1.0, 0.0, 1.0));
        let degenerate = tangent([o, o, o]);
        assert!(degenerate.truncate().is_normalized() && degenerate.z == 0.0 && degenerate.w == 1.0);
    }
}
