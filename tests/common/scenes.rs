//! Scenes whose radiance is known in closed form, and scenes with every kind of light for statistics.

use candela::scene::{
    AlphaMode, DirectionalLight, Environment, Instance, Material, Mesh, PointLight, Primitive,
    SceneDescription, SpotLight,
};
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
        lights: lights.into_iter().map(Into::into).collect(),
        ..SceneDescription::default()
    }
}

/// Lets half of the light through, reflects nothing, and is seen from both sides.
pub fn pane() -> Material {
    Material {
        alpha: AlphaMode::Blend,
        base_color: Vec4::new(0.0, 0.0, 0.0, 0.5),
        double_sided: true,
        ..Material::default()
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

/// `open` with three squares in between: shadows everywhere, and pixels that see them from above.
pub fn occluded(mut open: SceneDescription) -> SceneDescription {
    let squares = [(-0.8, 0.6, 0.2), (0.7, 0.4, 0.5), (0.1, 0.8, -0.9)]
        .map(|(x, y, z)| square(Vec3::new(x, y, z), Vec3::Z * 0.45, Vec3::X * 0.45, 0));
    open.meshes[0].primitives.extend(squares);
    open
}

/// Point lights under emissive triangles that face the floor; strengths over four orders of magnitude.
pub fn many_lights() -> SceneDescription {
    let strength = |i: i32| 10f32.powi(i % 5 - 2);
    let lights = (0..20)
        .map(|i| {
            let angle = i as f32 * 2.4;
            let radius = 0.25 * i as f32;
            let position = Vec3::new(radius * angle.cos(), 1.0 + (i % 3) as f32 * 0.5, radius * angle.sin());
            PointLight { position, intensity: Vec3::new(1.0, 0.8, 0.5) * 5.0 * strength(i), radius: 0.0 }
        })
        .collect();
    let triangles = (0..6).map(|i| {
        let center = Vec3::new(i as f32 - 2.5, 3.0, (i % 2) as f32 - 1.0);
        Primitive {
            material: 1 + i as usize % 2,
            // Counter-clockwise from below.
            positions: vec![center, center + Vec3::X * 0.6, center + Vec3::Z * 0.7],
            normals: vec![-Vec3::Y; 3],
            indices: vec![0, 1, 2],
            ..Primitive::default()
        }
    });
    scene(triangles.collect(), vec![emitter(Vec3::splat(40.0)), emitter(Vec3::new(0.1, 0.5, 2.0))], lights)
}

/// Spots of unequal strength whose cones reach every pixel: all supports agree.
pub fn spots() -> SceneDescription {
    let spot = |i: i32| {
        let (x, z) = ((i % 3) as f32 - 1.0, (i / 3) as f32 - 1.0);
        SpotLight {
            position: Vec3::new(2.0 * x, 2.5, 2.0 * z),
            axis: Vec3::new(0.2 * z, -1.0, 0.1 * x).normalize(),
            intensity: Vec3::new(0.3, 0.8, 1.0) * 3f32.powi(i % 4),
            inner_angle: 0.1 * i as f32,
            outer_angle: 1.35,
            radius: 0.0,
        }
    };
    SceneDescription { lights: (0..9).map(spot).map(Into::into).collect(), ..scene(vec![], vec![], vec![]) }
}

pub fn suns() -> SceneDescription {
    let sun = |i: i32| DirectionalLight {
        direction: Vec3::new(i as f32 - 2.0, 2.0, (i % 2) as f32).normalize(),
        illuminance: Vec3::new(1.0, 0.9, 0.7) * 4f32.powi(i % 3),
    };
    SceneDescription { lights: (0..5).map(sun).map(Into::into).collect(), ..scene(vec![], vec![], vec![]) }
}

/// A sky with a bright spot; black below the horizon, where no pixel could be lit from.
pub fn sky() -> SceneDescription {
    let size = UVec2::new(16, 8);
    let radiance = |i: u32| match (i % 16, i / 16) {
        (5, 2) => Vec3::new(300.0, 200.0, 100.0),
        (x, y @ 0..4) => Vec3::new(1.0, 2.0, 3.0) * (1 + x % 3 + y) as f32,
        _ => Vec3::ZERO,
    };
    let environment = Some(Environment { size, radiance: (0..128).map(radiance).collect() });
    SceneDescription { environment, ..scene(vec![], vec![], vec![]) }
}

/// Every kind alone, and all of them together.
pub fn kinds() -> Vec<(&'static str, SceneDescription)> {
    let lights = [many_lights(), spots(), suns()].into_iter().flat_map(|scene| scene.lights).collect();
    let together = SceneDescription { lights, environment: sky().environment, ..many_lights() };
    let triangles = SceneDescription { lights: vec![], ..many_lights() };
    let mut points = many_lights();
    points.meshes[0].primitives.truncate(1);
    vec![
        ("points", points),
        ("triangles", triangles),
        ("spots", spots()),
        ("suns", suns()),
        ("sky", sky()),
        ("together", together),
    ]
}
