//! Pinhole camera: pixel -> ray and back.

use crate::math::safe_ratio;
use bytemuck::{Pod, Zeroable};
use glam::{UVec2, Vec2, Vec3};

/// A camera for an image of fixed size. 48 bytes.
///
/// ```
/// use candela_shared::camera::Camera;
/// use candela_shared::glam::{UVec2, Vec2, Vec3};
///
/// let size = UVec2::new(640, 360);
/// let camera = Camera::new(Vec3::ZERO, -Vec3::Z, Vec3::Y, 1.0, size);
/// let direction = camera.direction(Vec2::new(500.0, 100.0), size);
/// assert!((camera.project(7.0 * direction, size) - Vec2::new(500.0, 100.0)).length() < 1e-3);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Camera {
    /// World space, m.
    pub position: Vec3,
    /// From the middle of the image plane (at distance 1) to its right edge.
    pub right: Vec3,
    /// From the middle of the image plane to its upper edge.
    pub up: Vec3,
    /// Unit viewing direction.
    pub forward: Vec3,
}

impl Camera {
    /// At `position`, looking along `forward`, with vertical field of view `fov_y` (radians) for an image of `size` pixels.
    #[cfg(not(target_arch = "spirv"))]
    pub fn new(position: Vec3, forward: Vec3, up: Vec3, fov_y: f32, size: UVec2) -> Self {
        let forward = forward.normalize();
        // Looking straight up or down, any horizontal right will do.
        let right = crate::math::normalize_or(forward.cross(up), forward.any_orthonormal_vector());
        let up = right.cross(forward);
        let half_height = (0.5 * fov_y).tan();
        let half_width = half_height * size.x as f32 / size.y as f32;
        Camera { position, right: right * half_width, up: up * half_height, forward }
    }

    /// Unit direction through `pixel` (in pixels, (0, 0) the upper left corner, centers at .5) of an image of `size`.
    pub fn direction(&self, pixel: Vec2, size: UVec2) -> Vec3 {
        let ndc = pixel / size.as_vec2() * 2.0 - Vec2::ONE;
        (self.forward + ndc.x * self.right - ndc.y * self.up).normalize()
    }

    /// Where a point relative to the camera's position (m) falls, in pixels; outside the image (negative) for what lies
    /// behind the camera.
    pub fn project(&self, relative: Vec3, size: UVec2) -> Vec2 {
        let depth = relative.dot(self.forward);
        if depth <= 0.0 {
            return Vec2::splat(-1.0);
        }
        let x = safe_ratio(relative.dot(self.right), depth * self.right.length_squared());
        let y = safe_ratio(relative.dot(self.up), depth * self.up.length_squared());
        Vec2::new(x + 1.0, 1.0 - y) * 0.5 * size.as_vec2()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn projection_inverts_the_ray() {
        let size = UVec2::new(1920, 1080);
        let camera = Camera::new(Vec3::new(1.0, 2.0, 3.0), Vec3::new(0.3, -0.4, -1.0), Vec3::Y, 1.0, size);
        for i in 0..1000u32 {
            let pixel = Vec2::new((i * 37 % 1920) as f32 + 0.5, (i * 91 % 1080) as f32 + 0.5);
            let distance = 10f32.powf((i % 9) as f32 - 3.0);
            let back = camera.project(camera.direction(pixel, size) * distance, size);
            assert!((back - pixel).length() < 2e-3, "{pixel} came back as {back} from {distance} m");
        }
        assert!(camera.project(-camera.forward, size).x < 0.0);
    }

    #[test]
    fn middle_and_corners() {
        let size = UVec2::new(200, 100);
        let camera = Camera::new(Vec3::ZERO, -Vec3::Z, Vec3::Y, core::f32::consts::FRAC_PI_2, size);
        assert!((camera.direction(Vec2::new(100.0, 50.0), size) + Vec3::Z).length() < 1e-6);
        let corner = camera.direction(Vec2::ZERO, size);
        assert!((corner - Vec3::new(-2.0, 1.0, -1.0).normalize()).length() < 1e-6);
        assert_eq!(size_of::<Camera>(), 48);
    }

    #[test]
    fn looking_straight_down_has_axes() {
        let camera = Camera::new(Vec3::Y, -Vec3::Y, Vec3::Y, 1.0, UVec2::new(4, 4));
        assert!(camera.right.is_finite() && camera.right.length() > 0.1 && camera.up.length() > 0.1);
    }
}
