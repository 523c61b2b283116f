//! A view of a scene whose file has none.

use super::{SceneCamera, SceneDescription};
use glam::{DVec3, Vec3};
use std::f64::consts::FRAC_PI_4;

/// Air around the bounding sphere: no triangle touches the frame.
const MARGIN: f64 = 1.02;

impl SceneDescription {
    /// A three-quarter view from above that contains the sphere around the scene's bounds, in any frame at least as
    /// wide as high (16:9 is): vertical field of view 45°. An empty scene is seen as a unit sphere at the origin.
    pub fn camera_fitted(&self) -> SceneCamera {
        let bounds = self.bounds();
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let (center, radius) = if bounds.extent().min_element() >= 0.0 {
            (0.5 * (min + max), 0.5 * (max - min).length())
        } else {
            (DVec3::ZERO, 1.0)
        };
        // A scene of one point has a radius of 0: stand off somewhere near.
        let radius = if radius > 0.0 { radius } else { 1.0 };
        let fov_y = FRAC_PI_4;
        let toward_camera = DVec3::new(1.0, 0.6, 1.4).normalize();
        // The edge rays of the frame touch the sphere from this distance.
        let distance = MARGIN * radius / (0.5 * fov_y).sin();
        let forward = -toward_camera;
        let right = forward.cross(DVec3::Y).normalize();
        SceneCamera {
            name: "fitted".into(),
            position: (center + distance * toward_camera).as_vec3(),
            forward: unit(forward),
            up: unit(right.cross(forward)),
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

    /// Points all over the bounding sphere, projected by hand, must lie in the frame, and some near its edge.
    #[test]
    fn the_bounding_sphere_is_in_the_frame() {
        for (size, offset) in [(1.0, 0.0), (1e-3, 0.0), (1e3, 0.0), (2.0, 50.0)] {
            let corners = [Vec3::ZERO, Vec3::new(size, 0.2 * size, 0.0), Vec3::new(0.0, size, 3.0 * size)];
            let scene = scene(corners.map(|p| p + Vec3::splat(offset)));
            let camera = scene.camera_fitted();
            assert!(camera.forward.is_normalized() && camera.up.is_normalized());
            assert!(camera.forward.dot(camera.up).abs() < 1e-6);
            let right = camera.forward.cross(camera.up);
            let radius = 0.5 * scene.bounds().extent().length();
            let mut highest = 0f32;
            for i in 0..2000 {
                let z = 1.0 - 2.0 * (i as f32 + 0.5) / 2000.0;
                let (sin, cos) = (i as f32 * 2.399_963_2).sin_cos();
                let r = (1.0 - z * z).sqrt();
                let p = scene.bounds().center() + radius * Vec3::new(r * cos, r * sin, z) - camera.position;
                let depth = p.dot(camera.forward);
                let half_height = depth * (0.5 * camera.fov_y).tan();
                assert!(depth > 0.0 && p.dot(right).abs() < half_height * 16.0 / 9.0);
                highest = highest.max(p.dot(camera.up).abs() / half_height);
            }
            assert!((0.9..1.0).contains(&highest), "size {size}: up to {highest} of the frame's height");
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
