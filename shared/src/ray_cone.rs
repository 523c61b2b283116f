//! Which mip level a ray sees: ray cones (Akenine-Möller et al. 2021, "Improved Shader and Texture Level of Detail Using
//! Ray Cones"), for primary rays from a pinhole, whose cones start at width 0.

use crate::camera::Camera;
use crate::math::safe_ratio;
use glam::{UVec2, Vec2, Vec3};
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float;

/// Width of a pixel's cone for each m of distance, at the middle of an image of `size` (their eq. 30, small angles).
pub fn spread(camera: &Camera, size: UVec2) -> f32 {
    2.0 * camera.up.length() / size.y as f32
}

/// Twice the area of the triangle `uvs`, in units of texture coordinates.
pub fn double_area(uvs: [Vec2; 3]) -> f32 {
    (uvs[1] - uvs[0]).perp_dot(uvs[2] - uvs[0]).abs()
}

/// A cone where it meets a triangle.
#[derive(Clone, Copy, Debug)]
pub struct Footprint {
    /// Side of the patch that it covers on the surface, m.
    pub side: f32,
    /// Twice the triangle's area, m².
    pub double_area: f32,
}

impl Footprint {
    /// Of a ray without width: it sees the finest level.
    pub const POINT: Self = Footprint { side: 0.0, double_area: 1.0 };

    /// For a cone of `spread` that has run `distance` m along `direction`, to a surface with normal `normal` (both unit).
    pub fn new(spread: f32, distance: f32, direction: Vec3, normal: Vec3, double_area: f32) -> Self {
        let width = spread * distance;
        Footprint { side: safe_ratio(width, direction.dot(normal).abs()), double_area }
    }

    /// Mip level (>= 0) of a texture of `size` texels, where the triangle covers `uv_double_area` (twice its area in
    /// units of the texture): log2 of the texels that the footprint's side spans.
    pub fn lod(&self, size: UVec2, uv_double_area: f32) -> f32 {
        let texels = uv_double_area * size.x as f32 * size.y as f32;
        let squared = safe_ratio(texels, self.double_area) * self.side * self.side;
        if squared > 1.0 { 0.5 * squared.min(f32::MAX).log2() } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: the texels between the hits of neighboring pixels' rays, on a plane that carries a texel grid.
    #[test]
    fn levels_follow_the_distance_between_neighboring_rays() {
        let size = UVec2::new(64, 64);
        let camera = Camera::new(Vec3::ZERO, -Vec3::Z, Vec3::Y, 0.1, size);
        // Texels of 1 mm: a texture of 1024 on a right triangle whose legs span its whole uv square of 1.024 m.
        let (texture, leg) = (UVec2::splat(1024), 1.024);
        let hit = |pixel: Vec2, distance: f32, normal: Vec3| {
            let d = camera.direction(pixel, size);
            d * (-distance * normal.z) / d.dot(normal)
        };
        for distance in [0.5, 2.0, 10.0, 50.0] {
            for tilt in [0.0f32, 0.5, 1.2] {
                let normal = Vec3::new(0.0, tilt.sin(), tilt.cos());
                let (center, up) = (Vec2::splat(32.0), Vec2::new(32.0, 31.0));
                let step = (hit(up, distance, normal) - hit(center, distance, normal)).length();
                let d = camera.direction(center, size);
                let footprint = Footprint::new(spread(&camera, size), distance, d, normal, leg * leg);
                let uvs = [Vec2::ZERO, Vec2::X, Vec2::Y];
                let lod = footprint.lod(texture, double_area(uvs));
                let expected = (step / 1e-3).log2().max(0.0);
                assert!(
                    (lod - expected).abs() < 0.02,
                    "{lod} instead of {expected} at {distance} m, {tilt} rad"
                );
            }
        }
    }

    #[test]
    fn odd_triangles_have_a_level() {
        for double_area in [0.0, 1e-38, 1.0] {
            for uv_area in [0.0, 1e30] {
                let footprint = Footprint::new(1e-3, 1e20, Vec3::X, Vec3::Y, double_area);
                let lod = footprint.lod(UVec2::splat(16384), uv_area);
                assert!(lod.is_finite() && lod >= 0.0);
            }
        }
    }
}
