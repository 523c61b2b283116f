//! Scenes whose radiance is known in closed form.

use candela::scene::{Instance, Material, Mesh, PointLight, Primitive, SceneDescription};
use glam::{Affine3A, DVec3, UVec2, Vec2, Vec3, Vec4};
use shared::camera::Camera;

/// The floor's color in all of these scenes; rough and no metal.
pub const FLOOR: Vec3 = Vec3::new(0.8, 0.5, 0.3);

/// A camera that looks down on the floor around the origin.
pub fn camera(size: UVec2) -> Camera {
    Camera::new(Vec3::new(0.0, 4.0, 5.0), Vec3::new(0.0, -4.0, -5.0), Vec3::Y, 0.7, size)
}

/// A square in the plane through `center` with half-edges `u`, `v`; its front is on the side of u x v.
pub fn square(center: Vec3, u: Vec3, v: Vec3, material: usize) -> Primitive {
    let normal = u.cross(v).normalize();
    Primitive {
        material,
        positions: vec![center - u - v, center + u - v, center + u + v, center - u + v],
        normals: vec![normal; 4],
        uvs: vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y],
        indices: vec![0, 1, 2, 0, 2, 3],
        ..Primitive::default()
    }
}

/// A floor of 20 m x 20 m at y = 0, and what else is given.
pub fn scene(
    others: Vec<Primitive>,
    mut materials: Vec<Material>,
    lights: Vec<PointLight>,
) -> SceneDescription {
    let floor = Material { base_color: FLOOR.extend(1.0), name: "floor".into(), ..Material::default() };
    materials.insert(0, floor);
    let mut primitives = vec![square(Vec3::ZERO, Vec3::Z * 10.0, Vec3::X * 10.0, 0)];
    primitives.extend(others);
    SceneDescription {
        name: "test".into(),
        meshes: vec![Mesh { name: "test".into(), primitives }],
        instances: vec![Instance { name: "test".into(), mesh: 0, transform: Affine3A::IDENTITY }],
        materials,
        point_lights: lights,
        ..SceneDescription::default()
    }
}

/// A material that emits `radiance` nit.
pub fn emitter(radiance: Vec3) -> Material {
    Material { emission: radiance, base_color: Vec4::new(0.5, 0.5, 0.5, 1.0), ..Material::default() }
}

/// The point of the floor that the middle of `pixel` sees, in f64; none above the horizon.
pub fn floor_point(camera: &Camera, pixel: UVec2, size: UVec2) -> Option<DVec3> {
    let ndc = (pixel.as_dvec2() + 0.5) / size.as_dvec2() * 2.0 - 1.0;
    let direction =
        camera.forward.as_dvec3() + ndc.x * camera.right.as_dvec3() - ndc.y * camera.up.as_dvec3();
    let eye = camera.position.as_dvec3();
    let t = -eye.y / direction.y;
    let point = eye + t * direction;
    (t > 0.0 && point.abs().max_element() < 10.0).then_some(point)
}

/// Radiance that the floor reflects to `eye` from a point light, unshadowed.
pub fn floor_radiance(x: DVec3, eye: DVec3, light: &PointLight) -> DVec3 {
    let to_light = light.position.as_dvec3() - x;
    let wi = to_light.normalize();
    floor_bsdf(wi, (eye - x).normalize()) * light.intensity.as_dvec3() * wi.y / to_light.length_squared()
}

/// The floor's BSDF: glTF 2.0 appendix B in f64, for a rough dielectric (metallic 0, roughness 1).
pub fn floor_bsdf(wi: DVec3, wo: DVec3) -> DVec3 {
    use std::f64::consts::PI;
    let h = (wi + wo).normalize();
    // α = 1: D = 1/π, Λ(c) = (1/c - 1)/2.
    let g = 2.0 / (1.0 / wi.y + 1.0 / wo.y);
    let f = 0.04 + 0.96 * (1.0 - wi.dot(h)).powi(5);
    (1.0 - f) * FLOOR.as_dvec3() / PI + f / PI * g / (4.0 * wi.y * wo.y)
}
