//! Primary visibility by rasterization: where a triangle's corners fall on the picture, and where a pixel's ray meets the
//! triangle that was drawn there.

use crate::camera::Camera;
use crate::frame::FrameConstants;
use crate::geometry::InstanceGeometry;
use crate::math::{cross, unpack_place};
use glam::{UVec2, Vec2, Vec3, Vec4};

/// Distance of the near plane, m. Depth is `NEAR / distance` (reversed, no far plane), an f32 with the same relative
/// precision at every distance, so a near plane that cuts nothing off costs nothing.
pub const NEAR: f32 = 1e-6;

/// A place that no picture shows.
const OUTSIDE: Vec4 = Vec4::new(2.0, 2.0, 0.0, 1.0);

/// Clip coordinates of a point relative to the camera's position (m): pixel centers lie on the rays of
/// [`Camera::direction`], also where the middle of the picture is not straight ahead. (Cramer's rule for
/// relative = w forward + x right + y up.)
pub fn clip(camera: &Camera, relative: Vec3) -> Vec4 {
    let Camera { right, up, forward, .. } = *camera;
    let (of_x, of_y, of_w) = (up.cross(forward), forward.cross(right), right.cross(up));
    let scale = 1.0 / forward.dot(of_w);
    Vec4::new(relative.dot(of_x) * scale, -relative.dot(of_y) * scale, NEAR, relative.dot(of_w) * scale)
}

/// Clip coordinates under which what pixels see through the frame's place lies at their centers.
pub fn aimed(frame: &FrameConstants, clip: Vec4) -> Vec4 {
    let shift = (0.5 - unpack_place(frame.place)) * 2.0 * clip.w / frame.size.as_vec2();
    clip + shift.extend(0.0).extend(0.0)
}

impl InstanceGeometry {
    /// A point of object space relative to `eye` (m): near points of far scenes keep their digits.
    pub fn relative_to(&self, eye: Vec3, p: Vec3) -> Vec3 {
        self.direction_to_world(p) + (self.translation - eye)
    }

    /// Clip coordinates of a point of object space. What is scaled to less than two dimensions is not drawn.
    pub fn clip(&self, camera: &Camera, p: Vec3) -> Vec4 {
        let areas = self.normal_x.abs() + self.normal_y.abs() + self.normal_z.abs();
        if areas.max_element() == 0.0 { OUTSIDE } else { clip(camera, self.relative_to(camera.position, p)) }
    }
}

/// Vertex number `vertex` of the draw of a geometry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Corner {
    /// Its triangle.
    pub primitive: u32,
    /// Which of the triangle's corners, 0 to 2.
    pub corner: u32,
}

impl Corner {
    /// Three vertices a triangle: in the order of its corners, or turned around under a transform that mirrors, so that the
    /// front (of object space, as rays have it) is counter-clockwise on the picture.
    pub fn new(geometry: &InstanceGeometry, vertex: u32) -> Self {
        let (primitive, corner) = (vertex / 3, vertex % 3);
        Corner { primitive, corner: if geometry.handedness < 0.0 { (3 - corner) % 3 } else { corner } }
    }

    /// Place of its index in the index buffer.
    pub fn index(self, geometry: &InstanceGeometry) -> u32 {
        geometry.first_index + 3 * self.primitive + self.corner
    }

    /// Weights of the second and third corner.
    pub fn barycentrics(self) -> Vec2 {
        Vec2::new((self.corner == 1) as u32 as f32, (self.corner == 2) as u32 as f32)
    }
}

/// What a pixel keeps of the triangle `primitive` of geometry `instance`. All zero: no surface.
pub fn stored(instance: u32, primitive: u32) -> UVec2 {
    UVec2::new(instance + 1, primitive)
}

/// The instance geometry and the triangle of a pixel.
pub fn triangle(stored: UVec2) -> Option<(u32, u32)> {
    if stored.x == 0 { None } else { Some((stored.x - 1, stored.y)) }
}

/// Barycentric coordinates (weights of the second and third corner) of the point where a ray from the eye meets a triangle
/// with these `corners`, relative to the eye (m); never outside the triangle, as a pixel's center may be by a hair
/// (Möller & Trumbore 1997). An edge-on triangle gives one of its points.
pub fn barycentrics(corners: [Vec3; 3], direction: Vec3) -> Vec2 {
    let (e1, e2) = (corners[1] - corners[0], corners[2] - corners[0]);
    let normal = cross(e1, e2);
    let to_ray = cross(corners[0], direction);
    let inverse = 1.0 / normal.dot(direction);
    inside(Vec2::new(to_ray.dot(e2), -to_ray.dot(e1)) * inverse)
}

/// The weights nearest to `b` that a triangle has; its first corner for what is no number.
fn inside(b: Vec2) -> Vec2 {
    // Infinite weights have no ratio, and what is no number is not above 0.
    let weight = |w: f32| if w > 0.0 { w.min(1e18) } else { 0.0 };
    let b = Vec2::new(weight(b.x), weight(b.y));
    b / (b.x + b.y).max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Affine3A, DVec3};

    const SIZE: UVec2 = UVec2::new(1920, 1080);

    fn camera(position: Vec3) -> Camera {
        Camera::new(position, Vec3::new(0.3, -0.4, -1.0), Vec3::Y, 1.0, SIZE)
    }

    /// A number in [-1, 1) of a fixed sequence.
    fn number(i: u32) -> f32 {
        (i.wrapping_mul(2_654_435_761) >> 8) as f32 / 8_388_608.0 - 1.0
    }

    fn vector(i: u32) -> Vec3 {
        Vec3::new(number(3 * i), number(3 * i + 1), number(3 * i + 2))
    }

    /// The exact weights of the second and third corner, unbounded.
    fn exact(corners: [Vec3; 3], direction: Vec3) -> [f64; 2] {
        let [a, b, c] = corners.map(Vec3::as_dvec3);
        let (e1, e2, d) = (b - a, c - a, direction.as_dvec3());
        let p = d.cross(e2);
        let q = (-a).cross(e1);
        [-a.dot(p) / e1.dot(p), d.dot(q) / e1.dot(p)]
    }

    #[test]
    fn clip_coordinates_are_the_projection() {
        let whole = camera(Vec3::new(1.0, 2.0, 3.0));
        let forward = whole.forward - 0.5 * whole.right + 0.5 * whole.up;
        let quarter = Camera { right: 0.5 * whole.right, up: 0.5 * whole.up, forward, ..whole };
        for i in 0..1000 {
            let camera = if i % 2 == 0 { whole } else { quarter };
            let pixel =
                Vec2::new(number(2 * i), number(2 * i + 1)).mul_add(Vec2::splat(0.5), Vec2::splat(0.5));
            let direction = camera.direction(pixel * SIZE.as_vec2(), SIZE);
            let distance = 10f32.powi(i as i32 % 9 - 3);
            let clip = clip(&camera, direction * distance);
            // Vulkan's viewport: (-1, -1) is the upper left corner.
            let back = (Vec2::new(clip.x, clip.y) / clip.w * 0.5 + 0.5 - pixel) * SIZE.as_vec2();
            assert!(back.abs().max_element() < 2e-3, "off by {back} pixels");
            // Of the plane that the picture lies in, also where that is seen askew.
            let depth = direction.dot(whole.forward) * distance;
            assert!((clip.z / clip.w * depth / NEAR - 1.0).abs() < 1e-5);
        }
    }

    /// 1e5 m from zero a vertex a hand away from the eye keeps its place.
    #[test]
    fn near_points_of_far_scenes_keep_their_digits() {
        let far = Vec3::new(1e5, -5e4, -1e5);
        let geometry = InstanceGeometry::new(Affine3A::from_translation(far), 0, 0, 0);
        let p = Vec3::new(0.012_345, 0.0, -0.1);
        assert_eq!(geometry.relative_to(far + Vec3::Y, p), p - Vec3::Y);
    }

    #[test]
    fn triangles_come_back() {
        assert_eq!(triangle(stored(0, 7)), Some((0, 7)));
        assert_eq!(triangle(UVec2::ZERO), None);
        let geometry = InstanceGeometry::new(Affine3A::IDENTITY, 30, 0, 0);
        let corner = Corner::new(&geometry, 7);
        assert_eq!((corner.primitive, corner.index(&geometry), corner.barycentrics()), (2, 37, Vec2::X));
    }

    #[test]
    fn mirrors_turn_triangles_back_and_flat_things_are_not_drawn() {
        let order = |scale: Vec3| {
            let geometry = InstanceGeometry::new(Affine3A::from_scale(scale), 0, 0, 0);
            [3, 4, 5].map(|vertex| Corner::new(&geometry, vertex).corner)
        };
        assert_eq!(order(Vec3::ONE), [0, 1, 2]);
        assert_eq!(order(Vec3::new(1.0, -1.0, 1.0)), [0, 2, 1]);
        let shown = |scale: Vec3| {
            let geometry = InstanceGeometry::new(Affine3A::from_scale(scale), 0, 0, 0);
            geometry.clip(&camera(Vec3::Z), Vec3::ONE) != OUTSIDE
        };
        assert!(shown(Vec3::new(1.0, 0.0, 1.0)));
        assert!(!shown(Vec3::X) && !shown(Vec3::ZERO));
    }

    /// The point that the weights give is off by a few ulp of the triangle's size, over the cosine that it is seen at:
    /// triangles of 0.1 mm to 10 m, and slivers a thousand times longer than wide, 0.1 to 1000 m away.
    #[test]
    fn weights_are_those_of_f64() {
        let (mut largest, mut control, mut met) = (0f64, 0f64, 0);
        for i in 0..20_000 {
            let distance = 10f32.powi(i as i32 % 5 - 1);
            let edge = 10f32.powi((i / 5) as i32 % 6 - 4).min(distance);
            let sliver = if i % 2 == 0 { 1.0 } else { 1e-3 };
            let direction = vector(7 * i).normalize();
            let (u, v) = (vector(7 * i + 1) * edge, vector(7 * i + 2) * edge * sliver);
            let (s, t) = (0.5 + 0.4 * number(21 * i), 0.5 + 0.4 * number(21 * i + 5));
            let (s, t) = if s + t > 1.0 { (1.0 - s, 1.0 - t) } else { (s, t) };
            let a = direction * distance - u * s - v * t;
            let corners = [a, a + u, a + v];
            let (u, v) = (corners[1] - a, corners[2] - a);
            let cosine = cross(u, v).normalize().dot(direction).abs();
            let (found, [x, y]) = (barycentrics(corners, direction), exact(corners, direction));
            let point = |x: f64, y: f64| -> DVec3 {
                let [a, b, c] = corners.map(Vec3::as_dvec3);
                a * (1.0 - x - y) + b * x + c * y
            };
            let ulp = |b: Vec2| {
                let off = point(f64::from(b.x), f64::from(b.y)) - point(x, y);
                off.length() * f64::from(cosine / u.length().max(v.length()) / f32::EPSILON)
            };
            // The planted error.
            let (normal, to_ray) = (u.cross(v), a.cross(direction));
            let plain = inside(Vec2::new(to_ray.dot(v), -to_ray.dot(u)) / normal.dot(direction));
            // What rounding has left of the smallest and farthest triangles may not be met at all.
            if cosine > 1e-3 && x >= 0.0 && y >= 0.0 && x + y <= 1.0 {
                met += 1;
                largest = largest.max(ulp(found));
                control = control.max(ulp(plain));
            }
        }
        assert!(met > 14_000 && largest < 4.0, "{largest} ulp in {met} triangles");
        assert!(control > 40.0, "plain cross products would do: {control} ulp");
    }

    #[test]
    fn points_outside_come_in_and_nothing_is_no_number() {
        let corners = [Vec3::new(-1.0, -1.0, -2.0), Vec3::new(1.0, -1.0, -2.0), Vec3::new(0.0, 1.0, -2.0)];
        let towards = |x: f32, y: f32| barycentrics(corners, Vec3::new(x, y, -2.0).normalize());
        assert!((towards(0.0, 0.0) - Vec2::new(0.25, 0.5)).length() < 1e-6);
        for (x, y) in [(0.0, -1.01), (0.0, 1.01), (0.8, 0.0), (-0.8, 0.0), (1.01, -1.01)] {
            let b = towards(x, y);
            assert!(b.min_element() >= 0.0 && b.x + b.y <= 1.0 + f32::EPSILON, "{b}");
        }
        // Edge-on, a point, and through the eye.
        let edge_on = [Vec3::new(0.0, -1.0, -2.0), Vec3::new(0.0, -1.0, -3.0), Vec3::new(0.0, 1.0, -2.0)];
        for corners in [edge_on, [Vec3::NEG_Z; 3], [Vec3::X, Vec3::NEG_X, Vec3::Y], [Vec3::ZERO; 3]] {
            let b = barycentrics(corners, Vec3::NEG_Z);
            assert!(b.min_element() >= 0.0 && b.x + b.y <= 1.0 + f32::EPSILON, "{corners:?}: {b}");
        }
    }
}
