//! A single object, as scanned or sculpted models are: a trefoil knot of worn metal before a backdrop, about 23,000 triangles.

use super::path::add_camera;
use super::shapes::{Shape, patch, polygon};
use crate::scene::{Instance, Material, Mesh, SceneCamera, SceneDescription};
use glam::{Affine3A, DQuat, DVec3, Vec2, Vec3, Vec4};
use std::f32::consts::TAU;
use std::f64::consts::FRAC_PI_4;

/// Along the knot, around its tube: 22,800 triangles.
const STEPS: [usize; 2] = [300, 38];

/// The knot, without lights.
pub fn knot() -> SceneDescription {
    let metal = Material {
        name: "worn copper".into(),
        base_color: Vec4::new(0.95, 0.64, 0.54, 1.0),
        metallic: 1.0,
        roughness: 0.35,
        ..Material::default()
    };
    let plaster =
        Material { name: "stage".into(), base_color: Vec4::new(0.5, 0.5, 0.5, 1.0), ..Material::default() };
    let corner = |x: f32, y: f32, z: f32| Vec3::new(3.0 * x, 4.5 * y, 3.0 * z);
    let ground =
        [corner(-1.0, 0.0, -1.0), corner(-1.0, 0.0, 1.0), corner(1.0, 0.0, 1.0), corner(1.0, 0.0, -1.0)];
    let back =
        [corner(-1.0, 0.0, -1.0), corner(1.0, 0.0, -1.0), corner(1.0, 1.0, -1.0), corner(-1.0, 1.0, -1.0)];
    let stage = polygon(&ground, Vec3::Y).with(polygon(&back, Vec3::Z));
    let mesh = |name: &str, shape: Shape, material| Mesh {
        name: name.into(),
        primitives: vec![shape.into_primitive(material, false)],
    };
    let instance = |name: &str, mesh| Instance { name: name.into(), mesh, transform: Affine3A::IDENTITY };
    let (position, target) = (Vec3::new(0.0, 2.6, 4.6), Vec3::new(0.0, 1.2, 0.0));
    let mut scene = SceneDescription {
        name: "knot".into(),
        meshes: vec![mesh("knot", tube(), 0), mesh("stage", stage, 1)],
        instances: vec![instance("knot", 0), instance("stage", 1)],
        materials: vec![metal, plaster],
        cameras: vec![SceneCamera {
            name: "front".into(),
            position,
            forward: (target - position).normalize(),
            up: Vec3::Y,
            fov_y: 45f32.to_radians(),
        }],
        ..SceneDescription::default()
    };
    // A quarter of the way round, at 0.8 m/s.
    let (eye, center) = (position.as_dvec3(), target.as_dvec3());
    add_camera(&mut scene, "orbit", 45f32.to_radians(), 9.0, |t| {
        (DQuat::from_rotation_y(FRAC_PI_4 * (0.8 / 4.6 / FRAC_PI_4 * t).sin()) * eye, center)
    });
    // Past it.
    add_camera(&mut scene, "strafe", 45f32.to_radians(), 4.0, |t| {
        let step = (0.8 * t - 1.6) * DVec3::X;
        (eye + step, center + 0.5 * step)
    });
    scene
}

/// A tube of radius 0.27 m, slightly fluted, around the trefoil.
fn tube() -> Shape {
    patch(STEPS, |Vec2 { x: u, y: v }| {
        let (center, next) = (trefoil(u), trefoil(u + 1e-3));
        let tangent = (next - center).normalize();
        let out = (center - Vec3::Y * 1.35).reject_from(tangent).normalize();
        let side = out.cross(tangent);
        let angle = TAU * v;
        let radius = 0.27 + 0.012 * (6.0 * angle + 9.0 * TAU * u).sin();
        center + radius * (angle.cos() * out + angle.sin() * side)
    })
}

/// Upright, 2.7 m tall; u in 0..=1, once around.
fn trefoil(u: f32) -> Vec3 {
    let t = TAU * u;
    let flat = Vec2::new(t.sin() + 2.0 * (2.0 * t).sin(), t.cos() - 2.0 * (2.0 * t).cos());
    Vec3::new(0.37 * flat.x, 1.45 + 0.37 * flat.y, -0.42 * (3.0 * t).sin())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The size of the model it stands in for; closed and facing outward: by the divergence theorem the volume is that of
    /// the tube, π r² times its length.
    #[test]
    fn is_a_closed_tube_of_23_000_triangles() {
        let scene = knot();
        let count = scene.triangle_count();
        assert!((22_000..24_000).contains(&count), "{count} triangles");
        let tube = &scene.meshes[0].primitives[0];
        let volume: f32 = tube
            .indices
            .chunks_exact(3)
            .map(|t| {
                let [a, b, c] = [t[0], t[1], t[2]].map(|i| tube.positions[i as usize]);
                a.dot(b.cross(c)) / 6.0
            })
            .sum();
        let length: f32 =
            (0..1000).map(|i| trefoil(i as f32 / 1e3).distance(trefoil((i + 1) as f32 / 1e3))).sum();
        let expected = 0.5 * TAU * 0.27 * 0.27 * length;
        assert!((volume / expected - 1.0).abs() < 0.1, "{volume} m³ against {expected} m³");
        assert!(scene.bounds().min.y >= 0.0);
    }
}
