//! A scene in code, lit by a million lights: `cargo run --release --example many_lights -- 1000000 many_lights.png`.

use candela::exposure;
use candela::frame::renderer::{FrameOptions, Renderer};
use candela::frame::schedule::{Primary, Work};
use candela::gpu_scene::GpuScene;
use candela::image_io;
use candela::knobs::Knobs;
use candela::scene::{Instance, Material, Mesh, PointLight, Primitive, SceneDescription};
use candela::shared::camera::Camera;
use candela::shared::glam::{Affine3A, UVec2, Vec2, Vec3};
use candela::vulkan::{Device, DeviceOptions};
use std::env::args;
use std::path::Path;

fn main() -> candela::error::Result<()> {
    let count = args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(1_000_000);
    let output = args().nth(2).unwrap_or("many_lights.png".into());
    let size = UVec2::new(640, 360);
    let scene = field(count);
    let eye = Vec3::new(0.0, 9.0, 55.0);
    let camera = Camera::new(eye, Vec3::new(0.0, 1.0, 0.0) - eye, Vec3::Y, 0.7, size);

    let device = Device::new(&DeviceOptions::default())?;
    let gpu_scene = GpuScene::new(&device, &scene)?;
    let settings = Knobs::default().settings(gpu_scene.lights());
    let mut renderer = Renderer::new(&device, gpu_scene, size, settings.reservoirs)?;
    let frame = FrameOptions::new(Work::Restir(settings), Primary::Auto, 0);
    for _ in 0..16 {
        renderer.render(camera, &frame)?;
    }
    let radiance = renderer.radiance()?;
    image_io::write_tone_mapped(Path::new(&output), size, &radiance, exposure::automatic(&radiance, 0.0))
}

/// A floor with rows of pillars, and a spiral of small lights of all hues over it: 20,000 cd in all.
fn field(lights: u32) -> SceneDescription {
    let material = |name: &str, color: Vec3| Material {
        name: name.into(),
        base_color: color.extend(1.0),
        roughness: 0.6,
        ..Material::default()
    };
    let mesh = |name: &str, primitives| Mesh { name: name.into(), primitives };
    let floor = square(Vec3::ZERO, Vec3::Z * 60.0, Vec3::X * 60.0, 0);
    let sides = [Vec3::X, Vec3::Z, -Vec3::X, -Vec3::Z];
    let pillar =
        sides.map(|side| square(side * 0.5 + Vec3::Y * 2.0, side.cross(Vec3::Y) * -0.5, Vec3::Y * 2.0, 1));
    let at = |mesh, place: Vec3| Instance {
        name: format!("{place}"),
        mesh,
        transform: Affine3A::from_translation(place),
    };
    let rows =
        (0..100).map(|i| at(1, Vec3::new((i % 10) as f32 * 8.0 - 36.0, 0.0, (i / 10) as f32 * 8.0 - 36.0)));
    let light = |i: u32| {
        let share = (i as f32 + 0.5) / lights as f32;
        let (turn, hue) = (i as f32 * 2.399_963, share * 20.0);
        let place = Vec2::from_angle(turn) * share.sqrt() * 50.0;
        let color = Vec3::new(hue.sin(), (hue + 2.1).sin(), (hue + 4.2).sin()) * 0.4 + 0.6;
        PointLight {
            position: Vec3::new(place.x, 0.3 + 3.0 * (0.5 + 0.5 * (7.0 * turn).sin()), place.y),
            intensity: color * 20_000.0 / lights as f32,
            radius: 0.0,
        }
        .into()
    };
    SceneDescription {
        name: "field".into(),
        meshes: vec![mesh("floor", vec![floor]), mesh("pillar", pillar.to_vec())],
        instances: std::iter::once(at(0, Vec3::ZERO)).chain(rows).collect(),
        materials: vec![material("floor", Vec3::splat(0.5)), material("pillar", Vec3::new(0.7, 0.65, 0.6))],
        lights: (0..lights).map(light).collect(),
        ..SceneDescription::default()
    }
}

/// With half-edges `u` and `v`; its front is on the side of u x v.
fn square(center: Vec3, u: Vec3, v: Vec3, material: usize) -> Primitive {
    Primitive {
        material,
        positions: vec![center - u - v, center + u - v, center + u + v, center - u + v],
        normals: vec![u.cross(v).normalize(); 4],
        uvs: vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y],
        indices: vec![0, 1, 2, 0, 2, 3],
        ..Primitive::default()
    }
}
