//! Scenes that Mitsuba has rendered too (tools/mitsuba): balls and a box on a floor, lit by one kind of light each.

use crate::scenes::{self, emitter};
use candela::scene::procedural::shapes::{Shape, cuboid, polygon, sphere};
use candela::scene::{
    DirectionalLight, Environment, Filter, Image, Instance, Material, Mesh, Mips, PanelLight, PanelShape,
    PointLight, SceneCamera, SceneDescription, SpotLight, Texture, Workflow, Wrap, fixtures,
};
use glam::{Affine3A, UVec2, Vec2, Vec3, Vec3Swizzles};
use shared::interface::UNBOUNDED;
use shared::material::{UvMap, slot};
use std::sync::Arc;

pub const SIZE: UVec2 = UVec2::new(64, 48);

/// Every scene, by the name of its reference in tests/references.
pub fn all() -> Vec<SceneDescription> {
    let mut all = vec![
        diffuse(),
        metal(),
        dielectric(),
        point(),
        spot(),
        directional(),
        triangle(),
        environment(),
        textured(),
        extended(),
    ];
    // As files: a room under a lamp; instances turned, stretched and mirrored, with vertex colors.
    let files = fixtures::all().into_iter().filter(|(name, _)| ["cornell-box", "instances"].contains(name));
    all.extend(files.map(|(_, scene)| scene));
    all.into_iter().map(of_triangles).collect()
}

/// Mitsuba has light arrive at triangles.
fn of_triangles(scene: SceneDescription) -> SceneDescription {
    SceneDescription { hard_terminator: true, ..scene }
}

/// Scenes whose bounced light Mitsuba has rendered, and how many bounces of it: [`UNBOUNDED`] for all.
pub fn bounced() -> Vec<(SceneDescription, Vec<u32>)> {
    let all = vec![
        (named("cornell-box"), vec![1, 2, UNBOUNDED]),
        (environment(), vec![2]),
        (in_a_room("metal-room", metal()), vec![1, UNBOUNDED]),
        (in_a_room("dielectric-room", dielectric()), vec![2]),
        (textured_room(), vec![1, 2, UNBOUNDED]),
    ];
    all.into_iter().map(|(scene, bounces)| (of_triangles(scene), bounces)).collect()
}

/// The scene called `name`.
pub fn named(name: &str) -> SceneDescription {
    all().into_iter().find(|scene| scene.name == name).expect("a scene of this name")
}

fn add(scene: &mut SceneDescription, shape: Shape, transform: Affine3A, material: Material) {
    let primitive = shape.into_primitive(scene.materials.len(), false);
    let mesh = scene.meshes.len();
    scene.materials.push(material);
    scene.meshes.push(Mesh { name: scene.name.clone(), primitives: vec![primitive] });
    scene.instances.push(Instance { name: scene.name.clone(), mesh, transform });
}

/// A ball, a box that stands askew, and a smaller ball, each of its own material, on a rough floor.
fn stage(name: &str, materials: [Material; 3]) -> SceneDescription {
    let mut scene = scenes::scene(vec![], vec![], vec![]);
    scene.name = name.into();
    let [left, middle, right] = materials;
    let moved = |x: f32, y: f32, z: f32| Affine3A::from_translation(Vec3::new(x, y, z));
    add(&mut scene, sphere(0.6, 48), moved(-1.1, 0.6, 0.0), left);
    let half = Vec3::new(0.25, 0.5, 0.35);
    add(&mut scene, cuboid(-half, half), moved(0.1, 0.5, -0.4) * Affine3A::from_rotation_y(0.5), middle);
    add(&mut scene, sphere(0.4, 48), moved(1.1, 0.4, 0.3), right);
    let position = Vec3::new(0.3, 2.2, 4.2);
    scene.cameras.push(SceneCamera {
        name: "front".into(),
        position,
        forward: (Vec3::new(0.0, 0.35, 0.0) - position).normalize(),
        up: Vec3::Y,
        fov_y: 0.7,
    });
    scene
}

fn colored(color: [f32; 3], roughness: f32) -> Material {
    Material { base_color: Vec3::from(color).extend(1.0), roughness, ..Material::default() }
}

fn plain(name: &str) -> SceneDescription {
    stage(name, [[0.7, 0.2, 0.1], [0.8, 0.8, 0.8], [0.1, 0.3, 0.6]].map(|color| colored(color, 1.0)))
}

const KEY: PointLight =
    PointLight { position: Vec3::new(1.5, 3.0, 2.0), intensity: Vec3::new(100.0, 90.0, 80.0), radius: 0.0 };

/// A square of 1 m that faces the stage from above, as two triangles.
fn add_lamp(scene: &mut SceneDescription, radiance: Vec3) {
    let corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)];
    let lamp = polygon(&corners.map(|(x, y)| Vec3::new(x, y, 0.0)), Vec3::Z);
    let to_stage = glam::Quat::from_rotation_arc(Vec3::Z, Vec3::new(0.5, -0.8, -0.4).normalize());
    let transform = Affine3A::from_rotation_translation(to_stage, Vec3::new(-1.2, 2.2, 1.2));
    add(scene, lamp, transform, emitter(radiance));
}

/// No specular reflection at normal incidence.
fn diffuse() -> SceneDescription {
    let mut scene = plain("diffuse");
    scene.materials.iter_mut().for_each(|material| material.specular = Vec3::ZERO);
    scene.lights.push(KEY.into());
    scene
}

fn metal() -> SceneDescription {
    let metal = |color, roughness| Material { metallic: 1.0, ..colored(color, roughness) };
    let metals =
        [metal([1.0, 0.77, 0.34], 0.5), metal([0.95, 0.64, 0.54], 0.75), metal([0.9, 0.9, 0.9], 0.25)];
    let mut scene = stage("metal", metals);
    scene.lights.push(KEY.into());
    add_lamp(&mut scene, Vec3::new(40.0, 50.0, 60.0));
    scene
}

/// Both workflows, an index of refraction of 2.4, and half a metal.
fn dielectric() -> SceneDescription {
    let mut scene = stage(
        "dielectric",
        [
            Material { specular: Vec3::splat(0.17), ..colored([0.5, 0.1, 0.1], 0.3) },
            Material { metallic: 0.5, ..colored([0.2, 0.6, 0.3], 0.6) },
            Material {
                workflow: Workflow::SpecularGlossiness,
                specular: Vec3::new(0.3, 0.2, 0.1),
                ..colored([0.1, 0.2, 0.7], 0.45)
            },
        ],
    );
    scene.lights.push(KEY.into());
    add_lamp(&mut scene, Vec3::new(40.0, 50.0, 60.0));
    scene
}

/// Textures larger than pixels under both workflows and filters: color, metal and roughness, specular color and gloss; one of them turned.
fn textured() -> SceneDescription {
    let mut scene = plain("textured");
    // Without any symmetry.
    let texel = |i: u32, channel: u32| (40 + (i * 67 + channel * 41 + i * channel * 23) % 200) as u8;
    let image = |name: &str| {
        let texels = (0..8).flat_map(|i| [0, 1, 2, 3].map(|channel| texel(i, channel))).collect();
        Arc::new(Image { name: name.into(), width: 4, height: 2, texels })
    };
    let (color, data) = (image("color"), image("data"));
    let texture = |image: &Arc<Image>, srgb, linear, wrap| Texture {
        image: image.clone(),
        srgb,
        wrap: [wrap; 2],
        filter: Filter { magnify_linear: linear, minify_linear: linear, mips: Mips::None },
    };
    scene.textures = vec![
        texture(&color, true, true, Wrap::Repeat),
        texture(&data, false, true, Wrap::MirroredRepeat),
        texture(&color, true, false, Wrap::Repeat),
    ];
    let [floor, left, middle, right, ..] = &mut scene.materials[..] else {
        panic!("a floor and three things")
    };
    floor.base_color_texture = Some(0);
    let turned = UvMap { u: Vec3::new(8.0, 6.0, 0.1), v: Vec3::new(-6.0, 8.0, 0.3), set: 0 };
    floor.uv_maps[slot::BASE_COLOR] = turned;
    left.base_color_texture = Some(2);
    left.reflectance_texture = Some(1);
    left.metallic = 0.8;
    middle.reflectance_texture = Some(0);
    middle.workflow = Workflow::SpecularGlossiness;
    middle.specular = Vec3::new(0.9, 0.6, 0.4);
    middle.roughness = 0.3;
    right.base_color_texture = Some(0);
    scene.lights.push(KEY.into());
    scene
}

/// `scene` without its lights in a closed room: a textured wall, a red one, a metal one.
fn in_a_room(name: &str, mut scene: SceneDescription) -> SceneDescription {
    scene.name = name.into();
    scene.lights.clear();
    let (min, max) = (Vec3::new(-2.2, 0.0, -1.6), Vec3::new(2.2, 2.8, 4.8));
    let wall = |outward: Vec3| {
        // The face of the room's box on that side.
        let (center, half) = (0.5 * (min + max), 0.5 * (max - min));
        let (u, v) = (outward.yzx().abs(), outward.zxy().abs());
        let at = |a: f32, b: f32| center + half * (outward + a * u + b * v);
        polygon(&[at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)], -outward)
    };
    let mut picture = colored([0.9, 0.9, 0.9], 0.8);
    if !scene.textures.is_empty() {
        picture.base_color_texture = Some(0);
    }
    let metal = Material { metallic: 1.0, ..colored([0.9, 0.85, 0.8], 0.5) };
    let walls = [
        (-Vec3::Z, picture),
        (-Vec3::X, colored([0.7, 0.15, 0.1], 1.0)),
        (Vec3::X, metal),
        (Vec3::Y, colored([0.8, 0.8, 0.8], 1.0)),
        (Vec3::Z, colored([0.6, 0.6, 0.6], 0.5)),
    ];
    for (outward, material) in walls {
        add(&mut scene, wall(outward), Affine3A::IDENTITY, material);
    }
    scene
}

/// Textures on things, on a wall and in the lamp.
fn textured_room() -> SceneDescription {
    let mut scene = in_a_room("textured-room", textured());
    add_lamp(&mut scene, Vec3::new(40.0, 50.0, 60.0));
    scene.materials.last_mut().expect("the lamp's").emissive_texture = Some(2);
    // Mitsuba draws points of such a lamp within the texture's square alone.
    let lamp = &mut scene.meshes.last_mut().expect("the lamp").primitives[0];
    lamp.uvs.iter_mut().for_each(|uv| *uv += 0.5);
    scene
}

fn point() -> SceneDescription {
    let light = |position: [f32; 3], intensity: [f32; 3]| {
        PointLight { position: position.into(), intensity: intensity.into(), radius: 0.0 }.into()
    };
    let mut scene = plain("point");
    scene.lights = vec![
        light([-0.4, 0.3, 1.0], [3.0, 1.0, 0.5]),
        light([0.6, 1.6, -1.2], [5.0, 10.0, 20.0]),
        light([2.0, 2.5, 1.5], [40.0, 40.0, 40.0]),
    ];
    scene
}

fn spot() -> SceneDescription {
    let spot = |position: Vec3, target: Vec3, intensity: Vec3, inner_angle: f32, outer_angle: f32| {
        let axis = (target - position).normalize();
        SpotLight { position, axis, intensity, inner_angle, outer_angle, radius: 0.0 }.into()
    };
    let mut scene = plain("spot");
    scene.lights = vec![
        spot(Vec3::new(-2.0, 3.0, 1.5), Vec3::new(-0.8, 0.2, 0.2), Vec3::new(120.0, 90.0, 60.0), 0.1, 0.45),
        spot(Vec3::new(2.5, 2.0, 1.0), Vec3::new(0.3, 0.2, 0.0), Vec3::new(40.0, 60.0, 90.0), 0.0, 0.6),
    ];
    scene
}

fn directional() -> SceneDescription {
    let direction = Vec3::new(2.0, 3.0, 1.5).normalize();
    let mut scene = plain("directional");
    let illuminance = Vec3::new(60.0, 55.0, 45.0);
    scene.lights = vec![DirectionalLight { direction, illuminance }.into()];
    scene
}

/// A square and a lone triangle.
fn triangle() -> SceneDescription {
    let mut scene = plain("triangle");
    add_lamp(&mut scene, Vec3::new(60.0, 50.0, 40.0));
    let corners = [Vec3::new(1.4, 0.9, -1.2), Vec3::new(2.2, 0.9, -1.0), Vec3::new(1.6, 1.7, -1.4)];
    add(
        &mut scene,
        polygon(&corners, Vec3::new(-0.5, -0.2, 1.0)),
        Affine3A::IDENTITY,
        emitter(Vec3::new(5.0, 15.0, 40.0)),
    );
    scene
}

/// A sphere, a rectangle and a disk, out of sight: Mitsuba's are shapes.
fn extended() -> SceneDescription {
    let mut scene = stage(
        "extended",
        [
            Material { metallic: 1.0, ..colored([1.0, 0.77, 0.34], 0.5) },
            colored([0.8, 0.8, 0.8], 1.0),
            colored([0.1, 0.3, 0.6], 0.4),
        ],
    );
    let panel = |position: Vec3, target: Vec3, size: Vec2, shape, radiance| {
        let axis = (target - position).normalize();
        let up = Vec3::new(0.2, 1.0, 0.1).reject_from_normalized(axis).normalize();
        PanelLight { position, axis, up, size, shape, radiance }
    };
    let (left, right) = (Vec3::new(-2.6, 1.2, 0.8), Vec3::new(2.4, 1.9, -0.6));
    let warm = Vec3::new(30.0, 18.0, 9.0);
    let cold = Vec3::new(10.0, 20.0, 40.0);
    scene.lights = vec![
        PointLight {
            position: Vec3::new(0.8, 2.9, 1.2),
            intensity: Vec3::new(14.0, 12.0, 9.0),
            radius: 0.35,
        }
        .into(),
        panel(left, Vec3::new(-0.3, 0.2, 0.0), Vec2::new(1.2, 0.5), PanelShape::Rectangle, warm).into(),
        panel(right, Vec3::new(0.5, 0.3, 0.2), Vec2::splat(0.8), PanelShape::Disk, cold).into(),
    ];
    scene
}

/// A sky without symmetry: a gradient, a sun of one texel, ground of another color.
fn environment() -> SceneDescription {
    let size = UVec2::new(16, 8);
    let radiance = |i: u32| match (i % 16, i / 16) {
        (10, 2) => Vec3::new(150.0, 120.0, 90.0),
        (x, y @ 0..4) => Vec3::new(1.0, 2.0, 4.0) * (1.0 + 0.1 * x as f32 + 0.3 * y as f32),
        (x, _) => Vec3::new(0.6, 0.5, 0.3) * (1 + x % 4) as f32,
    };
    let environment = Some(Environment { size, radiance: (0..128).map(radiance).collect() });
    let mut scene = SceneDescription { environment, ..plain("environment") };
    // Low, so that the sky is seen.
    let camera = &mut scene.cameras[0];
    camera.position = Vec3::new(0.3, 0.9, 4.2);
    camera.forward = (Vec3::new(0.0, 0.75, 0.0) - camera.position).normalize();
    scene
}
