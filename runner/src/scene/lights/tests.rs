use super::*;
use crate::scene::{Filter, Image, Mesh, PointLight, Texture, Wrap};
use glam::Affine3A;
use shared::light::kind;
use shared::math::luminance;
use std::f32::consts::PI;
use std::sync::Arc;

/// A box of 2 x 4 x 6 m by its diagonal triangle, and one light triangle of 2 m² in the xy plane that faces +z.
pub(super) fn scene() -> SceneDescription {
    let triangles = |positions: Vec<Vec3>, material| Primitive {
        material,
        indices: (0..positions.len() as u32).collect(),
        normals: vec![Vec3::Z; positions.len()],
        positions,
        ..Primitive::default()
    };
    let wall = triangles(vec![Vec3::ZERO, Vec3::new(2.0, 4.0, 0.0), Vec3::new(0.0, 4.0, 6.0)], 0);
    let corners = [Vec3::ZERO, Vec3::X * 2.0, Vec3::Y * 2.0];
    // The second one has no area.
    let glow = triangles([corners, [Vec3::ZERO, Vec3::X, Vec3::X * 2.0], corners].concat(), 1);
    let glowing = Material { emission: Vec3::new(1.0, 2.0, 3.0), ..Material::default() };
    SceneDescription {
        meshes: vec![
            Mesh { name: "wall".into(), primitives: vec![wall.clone()] },
            Mesh { name: "glow".into(), primitives: vec![wall, glow.clone(), glow] },
        ],
        instances: [(0, Vec3::ONE), (1, Vec3::splat(0.5)), (1, Vec3::new(-0.5, 0.5, 0.5))]
            .map(|(mesh, scale)| Instance {
                name: String::new(),
                mesh,
                transform: Affine3A::from_scale(scale),
            })
            .to_vec(),
        materials: vec![Material::default(), glowing],
        lights: vec![PointLight { position: Vec3::Y, intensity: Vec3::splat(7.0), radius: 0.0 }.into()],
        ..SceneDescription::default()
    }
}

#[test]
fn lights_come_in_order() {
    let table = LightTable::new(&scene());
    assert_eq!(table.lights.len(), 1 + 2 * 2 * 3);
    assert_eq!(table.lights[0].kind, kind::POINT);
    assert!(table.lights[1..].iter().all(|light| light.kind == kind::TRIANGLE));
}

#[test]
fn power_is_that_of_lambertian_triangles() {
    let table = LightTable::new(&scene());
    assert!((table.lights[0].power - 4.0 * PI * 7.0).abs() < 1e-4);
    // 2 m² at half the scale: 0.5 m².
    let power = PI * 0.5 * (0.2126 + 2.0 * 0.7152 + 3.0 * 0.0722);
    for (i, light) in table.lights.iter().enumerate().skip(1) {
        let expected = if i % 3 == 2 { 0.0 } else { power };
        assert!((light.power - expected).abs() < 1e-5, "light {i}: {} lm", light.power);
    }
    // Those without power are never drawn.
    assert_eq!((table.alias[2].pmf, table.alias[1].pmf > 0.0), (0.0, true));
}

#[test]
fn both_sides_emit_twice_the_power() {
    let mut scene = scene();
    let single = LightTable::new(&scene).lights[1].power;
    scene.materials[1].double_sided = true;
    assert!((LightTable::new(&scene).lights[1].power - 2.0 * single).abs() < 1e-5);
}

/// The triangle faces +z; a mirror along x must not turn it, a mirror along z must.
#[test]
fn mirrors_keep_the_emitting_side_outward() {
    let mut scene = scene();
    for (scale, side) in
        [(Vec3::new(-1.0, 1.0, 1.0), 1.0), (Vec3::new(1.0, 1.0, -1.0), -1.0), (Vec3::ONE, 1.0)]
    {
        scene.instances[1].transform = Affine3A::from_scale(scale);
        let light = LightTable::new(&scene).lights[1];
        let irradiance = |z: f32| light.sample_li(Vec2::splat(0.5), Vec3::new(0.0, 0.0, z)).irradiance.x;
        assert!(irradiance(side) > 0.0 && irradiance(-side) == 0.0, "scale {scale}");
    }
}

/// A texture that is bright to the left and dark to the right, on a triangle, far from the origin and mirrored: the
/// lights cover its left part, face outward, and have the whole of its power.
#[test]
fn textured_lights_are_where_the_texture_is_bright() {
    let mut scene = scene();
    let texels = [[255; 4], [0; 4]].concat();
    let image = Arc::new(Image { name: String::new(), width: 2, height: 1, texels });
    scene.textures = vec![Texture { image, srgb: true, wrap: [Wrap::Repeat; 2], filter: Filter::NEAREST }];
    scene.materials[1].emissive_texture = Some(0);
    let glow = &mut scene.meshes[1].primitives[1];
    // u grows along x: bright from 0 to 1 m of 2.
    glow.uvs = glow.positions.iter().map(|p| Vec2::new(p.x / 2.0, p.y / 2.0)).collect();
    glow.indices.truncate(3);
    scene.meshes[1].primitives.truncate(2);
    let place = Vec3::new(4096.0, -2000.0, 1000.0);
    for mirror in [1.0, -1.0] {
        let scale = Affine3A::from_scale(Vec3::new(mirror, 1.0, 1.0));
        scene.instances = vec![Instance {
            name: String::new(),
            mesh: 1,
            transform: Affine3A::from_translation(place) * scale,
        }];
        let lights = LightTable::new(&scene).lights[1..].to_vec();
        // Of 2 m², 1.5 m² lie at x < 1.
        let power: f64 = lights.iter().map(|light| f64::from(light.power)).sum();
        let exact = std::f64::consts::PI * 1.5 * f64::from(luminance(Vec3::new(1.0, 2.0, 3.0)));
        assert!((power / exact - 1.0).abs() < 1e-5, "{power} instead of {exact} lm");
        for light in &lights {
            let middle = light.position + (light.edge1 + light.edge2) / 3.0 - place;
            assert!((0.0..1.0).contains(&(mirror * middle.x)), "{middle}");
            assert!(light.edge1.cross(light.edge2).z > 0.0, "it faces +z");
        }
    }
}

#[test]
fn black_textures_are_no_light() {
    let mut scene = scene();
    scene.lights.clear();
    assert!(is_lit(&scene));
    let image = Arc::new(Image { name: String::new(), width: 1, height: 1, texels: vec![0, 0, 0, 255] });
    scene.textures = vec![Texture { image, srgb: true, wrap: [Wrap::Repeat; 2], filter: Filter::LINEAR }];
    scene.materials[1].emissive_texture = Some(0);
    assert!(!is_lit(&scene) && LightTable::new(&scene).lights.is_empty());
}

#[test]
fn a_dark_scene_has_no_lights() {
    let table = LightTable::new(&SceneDescription::default());
    assert!(table.lights.is_empty() && table.alias.is_empty());
}

/// What rays can find: opaque triangles of even radiance.
#[test]
fn rays_find_opaque_even_triangles() {
    let mut scene = scene();
    let table = LightTable::new(&scene);
    assert_eq!(
        [(0, 0), (1, 0), (1, 1), (2, 2)].map(|(i, p)| table.traceable(i, p)),
        [None, None, Some(1), Some(10)]
    );
    assert_eq!(table.first_environment, table.lights.len());
    scene.materials[1].alpha = AlphaMode::Blend;
    let table = LightTable::new(&scene);
    assert_eq!(table.traceable(1, 1), None);
    assert!(table.lights[1..].iter().all(|light| light.flags & UNTRACEABLE != 0));
    scene.materials[1].alpha = AlphaMode::Opaque;
    let image = Arc::new(Image { name: String::new(), width: 1, height: 1, texels: vec![255; 4] });
    scene.textures = vec![Texture { image, srgb: true, wrap: [Wrap::Repeat; 2], filter: Filter::NEAREST }];
    scene.materials[1].emissive_texture = Some(0);
    assert_eq!(LightTable::new(&scene).traceable(1, 1), None);
}
