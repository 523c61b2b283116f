//! A default camera, for scenes without one.

use super::{SceneCamera, SceneDescription};
use glam::{DVec3, Vec3};
use std::f64::consts::FRAC_PI_4;

/// Air around the scene's box: no triangle touches the frame.
const MARGIN: f64 = 1.05;

impl SceneDescription {
    /// A three-quarter view from above that contains the box around the scene, in any frame at least as wide as high
    /// (16:9 is): vertical field of view 45°. An empty scene is seen as a box of 2 m at the origin.
    pub fn camera_fitted(&self) -> SceneCamera {
        let bounds = self.bounds();
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let (center, half) = if bounds.extent().min_element() >= 0.0 {
            (0.5 * (min + max), 0.5 * (max - min))
        } else {
            (DVec3::ZERO, DVec3::ONE)
        };
        // A scene of one point has no size: stand off somewhere near.
        let half = if half == DVec3::ZERO { DVec3::ONE } else { half };
        let fov_y = FRAC_PI_4;
        let toward_camera = DVec3::new(1.0, 0.6, 1.4).normalize();
        let forward = -toward_camera;
        let right = forward.cross(DVec3::Y).normalize();
        let up = right.cross(forward);
        // From this distance to the center, the frame's edge passes through `corner` (relative to the center).
        let needed = |corner: DVec3| {
            corner.dot(up).abs().max(corner.dot(right).abs()) / (0.5 * fov_y).tan() - corner.dot(forward)
        };
        let sign = |i: i32, bit: i32| if i & bit != 0 { 1.0 } else { -1.0 };
        let corners = (0..8).map(|i| half * DVec3::new(sign(i, 1), sign(i, 2), sign(i, 4)));
        let distance = MARGIN * corners.map(needed).fold(0.0, f64::max);
        SceneCamera {
            name: "fitted".into(),
            position: (center + distance * toward_camera).as_vec3(),
            forward: unit(forward),
            up: unit(up),
            fov_y: fov_y as f32,
        }
    }
}

fn unit(v: DVec3) -> Vec3 {
    v.normalize().as_vec3()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Instance, Mesh, Primitive};
    use glam::Affine3A;

    fn scene(corners: [Vec3; 3]) -> SceneDescription {
        let primitive =
            Primitive { positions: corners.to_vec(), indices: vec![0, 1, 2], ..Primitive::default() };
        SceneDescription {
            meshes: vec![Mesh { name: String::new(), primitives: vec![primitive] }],
            instances: vec![Instance { name: String::new(), mesh: 0, transform: Affine3A::IDENTITY }],
            ..SceneDescription::default()
        }
    }

    /// The corners of the box, projected by hand, must lie in a square frame, and one near its edge.
    #[test]
    fn the_box_is_in_the_frame() {
        for (size, offset) in [(1.0, 0.0), (1e-3, 0.0), (1e3, 0.0), (2.0, 50.0)] {
            let corners = [Vec3::ZERO, Vec3::new(size, 0.2 * size, 0.0), Vec3::new(0.0, size, 3.0 * size)];
            let scene = scene(corners.map(|p| p + Vec3::splat(offset)));
            let camera = scene.camera_fitted();
            assert!(camera.forward.is_normalized() && camera.up.is_normalized());
            assert!(camera.forward.dot(camera.up).abs() < 1e-6);
            let right = camera.forward.cross(camera.up);
            let bounds = scene.bounds();
            let mut farthest = 0f32;
            for i in 0..8 {
                let corner = Vec3::select(
                    glam::BVec3::new(i & 1 != 0, i & 2 != 0, i & 4 != 0),
                    bounds.min,
                    bounds.max,
                ) - camera.position;
                let half_height = corner.dot(camera.forward) * (0.5 * camera.fov_y).tan();
                assert!(half_height > 0.0);
                let place = corner.dot(right).abs().max(corner.dot(camera.up).abs());
                farthest = farthest.max(place / half_height);
            }
            assert!((0.9..1.0).contains(&farthest), "size {size}: up to {farthest} of the frame");
        }
    }

    #[test]
    fn an_empty_scene_has_a_view() {
        let camera = SceneDescription::default().camera_fitted();
        assert!(camera.position.is_finite() && camera.position.length() > 1.0);
        let camera = scene([Vec3::ONE; 3]).camera_fitted();
        assert!(camera.position.is_finite() && camera.forward.is_normalized());
    }
}
