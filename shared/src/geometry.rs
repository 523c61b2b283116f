//! Scene geometry as the GPU reads it: what a hit's indices point to, and how it becomes a point in space.

use crate::math::{cross, normalize_or, pack_direction, unpack_direction};
use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3};

/// One primitive (glTF) of one instance; the TLAS instance's custom index + the geometry index lead here. 104 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct InstanceGeometry {
    /// Columns of the object-to-world matrix.
    pub axis_x: Vec3,
    /// First of this primitive's indices in the index buffer.
    pub first_index: u32,
    /// Second column.
    pub axis_y: Vec3,
    /// Added to each index.
    pub first_vertex: u32,
    /// Third column.
    pub axis_z: Vec3,
    /// Index of its [`crate::material::Material`].
    pub material: u32,
    /// Last column, m.
    pub translation: Vec3,
    /// -1 for a transform that mirrors, else 1: turns a triangle's winding back.
    pub handedness: f32,
    /// Columns of the inverse transpose, up to a positive factor: they turn normals.
    pub normal_x: Vec3,
    /// Second column.
    pub normal_y: Vec3,
    /// Third column.
    pub normal_z: Vec3,
    /// Index of its first triangle's light, or [`crate::motion::NO_LIGHT`] if rays that hit it find none.
    pub first_light: u32,
}

/// What a vertex has beside its position. 20 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct VertexAttributes {
    /// Object space, packed by [`pack_direction`].
    pub normal: u32,
    /// Object space, packed by [`pack_tangent`].
    pub tangent: u32,
    /// Texture coordinates, glTF's (v down).
    pub uv: Vec2,
    /// Linear RGBA, 8 bits each, red lowest.
    pub color: u32,
}

/// A tangent and its handedness (glTF's w, ±1) in 32 bits: as [`pack_direction`], the sign in the lowest bit.
pub fn pack_tangent(tangent: Vec3, handedness: f32) -> u32 {
    pack_direction(tangent) & !1 | (handedness < 0.0) as u32
}

fn unpack_tangent(bits: u32) -> (Vec3, f32) {
    (unpack_direction(bits & !1), if bits & 1 != 0 { -1.0 } else { 1.0 })
}

/// A triangle's corners: the data of a hit, loaded.
#[derive(Clone, Copy)]
pub struct Triangle {
    /// Object space, m.
    pub positions: [Vec3; 3],
    /// Normals, tangents, uvs and colors of the corners.
    pub attributes: [VertexAttributes; 3],
}

/// The point of a surface that a ray met.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    /// World space, m.
    pub position: Vec3,
    /// Unit normal of the triangle, counter-clockwise front.
    pub geometric_normal: Vec3,
    /// Unit interpolated normal.
    pub normal: Vec3,
    /// Unit tangent and its handedness.
    pub tangent: Vec3,
    /// ±1: which way the bitangent points.
    pub tangent_sign: f32,
    /// Interpolated, of set 0.
    pub uv: Vec2,
    /// Linear RGB of the vertex colors.
    pub color: Vec3,
}

impl InstanceGeometry {
    fn point_to_world(&self, p: Vec3) -> Vec3 {
        self.axis_x * p.x + self.axis_y * p.y + self.axis_z * p.z + self.translation
    }

    pub(crate) fn direction_to_world(&self, v: Vec3) -> Vec3 {
        self.axis_x * v.x + self.axis_y * v.y + self.axis_z * v.z
    }

    fn normal_to_world(&self, n: Vec3) -> Vec3 {
        self.normal_x * n.x + self.normal_y * n.y + self.normal_z * n.z
    }

    /// Places of a triangle's corners in the vertex buffers.
    pub fn corners(&self, indices: &[u32], primitive: u32) -> [usize; 3] {
        let first = (self.first_index + 3 * primitive) as usize;
        [
            (self.first_vertex + indices[first]) as usize,
            (self.first_vertex + indices[first + 1]) as usize,
            (self.first_vertex + indices[first + 2]) as usize,
        ]
    }

    /// Twice the area of a triangle (its corners in object space), m².
    pub fn double_area(&self, p: [Vec3; 3]) -> f32 {
        self.direction_to_world(p[1] - p[0]).cross(self.direction_to_world(p[2] - p[0])).length()
    }

    /// Largest number that points of a triangle (its corners in object space) are computed from, m.
    pub fn magnitude(&self, p: [Vec3; 3]) -> f32 {
        let [a, b, c] = [self.point_to_world(p[0]), self.point_to_world(p[1]), self.point_to_world(p[2])];
        a.abs().max(b.abs()).max(c.abs()).max(self.translation.abs()).max_element()
    }

    /// The point with barycentric coordinates `b` = (weight of the second, of the third corner).
    pub fn surface_point(&self, triangle: Triangle, b: Vec2) -> SurfacePoint {
        let Triangle { positions: p, attributes: a } = triangle;
        let weights = Vec3::new(1.0 - b.x - b.y, b.x, b.y);
        let corners = [self.point_to_world(p[0]), self.point_to_world(p[1]), self.point_to_world(p[2])];
        let cross = cross(corners[1] - corners[0], corners[2] - corners[0]) * self.handedness;
        let geometric_normal = normalize_or(cross, Vec3::Y);
        let normal = unpack_direction(a[0].normal) * weights.x
            + unpack_direction(a[1].normal) * weights.y
            + unpack_direction(a[2].normal) * weights.z;
        let (tangent0, tangent_sign) = unpack_tangent(a[0].tangent);
        let tangent = tangent0 * weights.x
            + unpack_tangent(a[1].tangent).0 * weights.y
            + unpack_tangent(a[2].tangent).0 * weights.z;
        SurfacePoint {
            position: corners[0] + b.x * (corners[1] - corners[0]) + b.y * (corners[2] - corners[0]),
            geometric_normal,
            normal: normalize_or(self.normal_to_world(normal), geometric_normal),
            tangent: normalize_or(self.direction_to_world(tangent), Vec3::X),
            tangent_sign: tangent_sign * self.handedness,
            uv: interpolate(triangle.uvs(), b),
            color: color(a[0].color) * weights.x
                + color(a[1].color) * weights.y
                + color(a[2].color) * weights.z,
        }
    }

    /// How far the curved surface that a triangle stands for lies off it at `b`, along the interpolated normal, m; negative
    /// under it.
    ///
    /// That surface is Phong tessellation (Boubekeur & Alexa 2008): the mean of the point's projections onto the corners' tangent
    /// planes. Light that arrives there, not at the triangle, is cut off by the horizon of the smooth surface, not by the
    /// triangle's; Hanika 2021, "Hacking the Shadow Terminator", starts shadow rays there (of corners that the surface bends away from).
    pub fn bulge(&self, triangle: Triangle, b: Vec2) -> f32 {
        let Triangle { positions: p, attributes: a } = triangle;
        let normal = |i: usize| normalize_or(self.normal_to_world(unpack_direction(a[i].normal)), Vec3::ZERO);
        let normals = [normal(0), normal(1), normal(2)];
        let between =
            |i: usize, j: usize| edge_bulge(self.direction_to_world(p[j] - p[i]), normals[j] - normals[i]);
        let w = Vec3::new(1.0 - b.x - b.y, b.x, b.y);
        let off = w.x * w.y * between(0, 1) + w.y * w.z * between(1, 2) + w.z * w.x * between(2, 0);
        off * (normals[0] * w.x + normals[1] * w.y + normals[2] * w.z).length()
    }
}

/// Corners whose normals differ by less than this along their edge, rad, have a flat edge between them.
const FLAT: f32 = 1.0 / 512.0;

/// What an edge adds to the bulge, for one of the product of its corners' weights, m: `edge` (m) from one to the other, and the
/// difference of their normals. 0 where it is flat: rounding bends nothing.
pub fn edge_bulge(edge: Vec3, normals: Vec3) -> f32 {
    let along = edge.dot(normals);
    if along * along > FLAT * FLAT * edge.length_squared() { along } else { 0.0 }
}

impl Triangle {
    /// Of the corners, set 0.
    pub fn uvs(&self) -> [Vec2; 3] {
        [self.attributes[0].uv, self.attributes[1].uv, self.attributes[2].uv]
    }
}

/// The value between three corners' values, at barycentric coordinates `b` as in [`InstanceGeometry::surface_point`].
pub fn interpolate(corners: [Vec2; 3], b: Vec2) -> Vec2 {
    corners[0] * (1.0 - b.x - b.y) + corners[1] * b.x + corners[2] * b.y
}

/// Alpha of the vertex colors at `b`.
pub fn vertex_alpha(attributes: [VertexAttributes; 3], b: Vec2) -> f32 {
    let alpha = |i: usize| (attributes[i].color >> 24) as f32 / 255.0;
    alpha(0) * (1.0 - b.x - b.y) + alpha(1) * b.x + alpha(2) * b.y
}

fn color(rgba: u32) -> Vec3 {
    Vec3::new((rgba & 0xff) as f32, (rgba >> 8 & 0xff) as f32, (rgba >> 16 & 0xff) as f32) / 255.0
}

impl SurfacePoint {
    /// The normal that a normal map's texel (RGB in [0, 1]) gives, unit (glTF 2.0, 3.9.3: `scale` multiplies x and y).
    pub fn mapped_normal(&self, texel: Vec3, scale: f32) -> Vec3 {
        let t = texel * 2.0 - Vec3::ONE;
        // Gram-Schmidt: interpolation leaves the tangent off the normal's plane.
        let tangent = self.tangent - self.normal * self.normal.dot(self.tangent);
        let tangent = normalize_or(tangent, Vec3::ZERO);
        let bitangent = self.normal.cross(tangent) * self.tangent_sign;
        let mapped = tangent * (t.x * scale) + bitangent * (t.y * scale) + self.normal * t.z;
        normalize_or(mapped, self.normal)
    }
}

#[cfg(not(target_arch = "spirv"))]
impl InstanceGeometry {
    /// A primitive under `transform` (object to world); indices as in the fields.
    pub fn new(transform: glam::Affine3A, first_index: u32, first_vertex: u32, material: u32) -> Self {
        let m = transform.matrix3.as_dmat3();
        let determinant = m.determinant();
        // The cofactor matrix is the inverse transpose times the determinant; it also exists for flat transforms.
        let sign = if determinant < 0.0 { -1.0 } else { 1.0 };
        let cofactors = [m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis)];
        let largest = cofactors.iter().map(|c| c.abs().max_element()).fold(f64::MIN_POSITIVE, f64::max);
        let [normal_x, normal_y, normal_z] = cofactors.map(|c| (c * sign / largest).as_vec3());
        InstanceGeometry {
            axis_x: transform.matrix3.x_axis.into(),
            first_index,
            axis_y: transform.matrix3.y_axis.into(),
            first_vertex,
            axis_z: transform.matrix3.z_axis.into(),
            material,
            translation: transform.translation.into(),
            handedness: sign as f32,
            normal_x,
            normal_y,
            normal_z,
            first_light: crate::motion::NO_LIGHT,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Affine3A, Quat};

    fn triangle() -> Triangle {
        let attributes = |uv, color| VertexAttributes {
            normal: pack_direction(Vec3::Z),
            tangent: pack_tangent(Vec3::X, 1.0),
            uv,
            color,
        };
        Triangle {
            positions: [Vec3::ZERO, Vec3::X, Vec3::Y],
            attributes: [
                attributes(Vec2::ZERO, 0xff),
                attributes(Vec2::X, 0xff00),
                attributes(Vec2::Y, 0xff0000),
            ],
        }
    }

    #[test]
    fn memory_is_as_documented() {
        assert_eq!(size_of::<InstanceGeometry>(), 104);
        assert_eq!(size_of::<VertexAttributes>(), 20);
    }

    /// A triangle in a sphere, with the sphere's normals, against the mean of the point's projections onto the tangent planes. It
    /// bulges out of the sphere; inside out it is as deep; with one normal for all it is flat, however that leans.
    #[test]
    fn spheres_bulge() {
        let corners = [Vec3::X, Vec3::new(0.96, 0.28, 0.0), Vec3::new(0.96, 0.0, 0.28)].map(|c| 3.0 * c);
        let of = |normals: [Vec3; 3]| {
            let attributes =
                normals.map(|n| VertexAttributes { normal: pack_direction(n), ..Default::default() });
            let triangle = Triangle { positions: corners, attributes };
            move |b| InstanceGeometry::new(Affine3A::IDENTITY, 0, 0, 0).bulge(triangle, b)
        };
        let outward = of(corners.map(|c| c / 3.0));
        for b in [Vec2::new(0.5, 0.0), Vec2::new(0.2, 0.7), Vec2::splat(1.0 / 3.0)] {
            let weights = [1.0 - b.x - b.y, b.x, b.y];
            let point: Vec3 = corners.iter().zip(weights).map(|(c, w)| *c * w).sum();
            let off: Vec3 = corners
                .iter()
                .zip(weights)
                .map(|(c, w)| {
                    let n = *c / 3.0;
                    -w * (point - *c).dot(n) * n
                })
                .sum();
            let expected = off.dot(point.normalize());
            assert!((outward(b) / expected - 1.0).abs() < 0.01, "{} for {expected}", outward(b));
            assert!((point.length() + outward(b)) > 3.0, "the tangent planes lie outside");
            assert!((of(corners.map(|c| -c / 3.0))(b) + outward(b)).abs() < 1e-3);
            assert_eq!(of([Vec3::new(0.6, 0.0, 0.8); 3])(b), 0.0);
        }
        assert!(outward(Vec2::ZERO) == 0.0 && outward(Vec2::X) == 0.0 && outward(Vec2::Y) == 0.0);
        let nearly = Vec3::new(0.0005, 0.0, 1.0).normalize();
        assert_eq!(of([Vec3::Z, nearly, nearly])(Vec2::splat(0.3)), 0.0);
    }

    #[test]
    fn a_hit_is_interpolated_and_moved() {
        let transform = Affine3A::from_scale_rotation_translation(
            Vec3::new(2.0, 3.0, 1.0),
            Quat::from_rotation_x(core::f32::consts::FRAC_PI_2),
            Vec3::new(5.0, 0.0, 0.0),
        );
        let point = InstanceGeometry::new(transform, 0, 0, 0).surface_point(triangle(), Vec2::new(0.25, 0.5));
        assert!((point.position - Vec3::new(5.5, 0.0, 1.5)).length() < 1e-5);
        assert!(
            (point.normal + Vec3::Y).length() < 1e-3 && (point.geometric_normal + Vec3::Y).length() < 1e-6
        );
        assert!((point.uv - Vec2::new(0.25, 0.5)).length() < 1e-6);
        assert!((point.color - Vec3::new(0.25, 0.25, 0.5)).length() < 1e-6);
    }

    /// A mirror keeps outside outside, and the bitangent on its side of the texture.
    #[test]
    fn mirrors_keep_normals_outward() {
        let transform = Affine3A::from_scale(Vec3::new(-1.0, 1.0, 1.0));
        let point = InstanceGeometry::new(transform, 0, 0, 0).surface_point(triangle(), Vec2::splat(0.3));
        assert!(point.geometric_normal.dot(Vec3::Z) > 0.999 && point.normal.dot(Vec3::Z) > 0.999);
        let bumped = point.mapped_normal(Vec3::new(0.5, 1.0, 0.5), 1.0);
        assert!((bumped - Vec3::Y).length() < 1e-3, "green points along +v's bitangent: {bumped}");
    }

    #[test]
    fn normals_follow_non_uniform_scale() {
        // A 45° slope squashed to half its height.
        let slope = Vec3::new(1.0, 1.0, 0.0).normalize();
        let geometry = InstanceGeometry::new(Affine3A::from_scale(Vec3::new(1.0, 0.5, 1.0)), 0, 0, 0);
        let turned = geometry.normal_to_world(slope).normalize();
        assert!((turned - Vec3::new(0.5, 1.0, 0.0).normalize()).length() < 1e-6);
        let flat = InstanceGeometry::new(Affine3A::from_scale(Vec3::new(1.0, 0.0, 1.0)), 0, 0, 0);
        assert!(flat.normal_to_world(Vec3::Y).is_finite());
    }

    #[test]
    fn flat_normal_map_changes_nothing() {
        let geometry = InstanceGeometry::new(Affine3A::IDENTITY, 0, 0, 0);
        let point = geometry.surface_point(triangle(), Vec2::splat(0.3));
        assert!((point.mapped_normal(Vec3::new(0.5, 0.5, 1.0), 1.0) - Vec3::Z).length() < 1e-3);
        assert!(point.mapped_normal(Vec3::new(1.0, 0.5, 0.5), 1.0).dot(Vec3::X) > 0.999);
    }
}
