//! Where light ends on a low-poly sphere, against a sphere of many triangles.

use candela::scene::{Material, PointLight, Primitive, SceneDescription};
use glam::{UVec2, Vec3};
use shared::camera::Camera;
use shared::frame::{Settings, features};
use std::f32::consts::{PI, TAU};
use tests::gpu::{Gpu, assert_no_validation_messages, device, reference, renderer, restir};
use tests::scenes::scene;

const SIZE: UVec2 = UVec2::new(96, 96);

/// A sphere of radius 1 around (0, 3, 0), smooth by its normals: so many triangles around, and half as many from pole to pole.
fn sphere(around: u32, material: usize) -> Primitive {
    let rings = around / 2;
    let normals: Vec<Vec3> = (0..=rings)
        .flat_map(|ring| {
            let (sin, cos) = (PI * ring as f32 / rings as f32).sin_cos();
            (0..=around).map(move |i| {
                let turn = TAU * (i % around) as f32 / around as f32;
                Vec3::new(sin * turn.cos(), cos, -sin * turn.sin())
            })
        })
        .collect();
    let quad = |ring: u32, i: u32| {
        let at = |ring: u32, i: u32| ring * (around + 1) + i;
        [at(ring, i), at(ring + 1, i), at(ring + 1, i + 1), at(ring, i), at(ring + 1, i + 1), at(ring, i + 1)]
    };
    Primitive {
        material,
        positions: normals.iter().map(|n| Vec3::Y * 3.0 + *n).collect(),
        uvs: vec![glam::Vec2::ZERO; normals.len()],
        normals,
        indices: (0..rings).flat_map(|ring| (0..around).flat_map(move |i| quad(ring, i))).collect(),
        ..Primitive::default()
    }
}

/// The sphere, lit from its left, where a camera sees lit and dark half.
fn lit(around: u32, hard_terminator: bool) -> SceneDescription {
    let light =
        PointLight { position: Vec3::new(-40.0, 3.0, 4.0), intensity: Vec3::splat(5000.0), radius: 0.0 };
    let scene = scene(vec![sphere(around, 1)], vec![Material::default()], vec![light]);
    SceneDescription { hard_terminator, ..scene }
}

fn camera() -> Camera {
    Camera::new(Vec3::new(0.0, 3.0, 8.0), -Vec3::Z, Vec3::Y, 0.3, SIZE)
}

fn picture(device: &Gpu, scene: &SceneDescription) -> Vec<Vec3> {
    reference(&mut renderer(device, scene, SIZE, 0), camera(), 1)
}

/// Means of the columns of the picture's middle, where the sphere fills every column but for the outermost.
fn profile(picture: &[Vec3]) -> Vec<f32> {
    let rows = SIZE.y / 4..3 * SIZE.y / 4;
    let column = |x: u32| rows.clone().map(|y| picture[(y * SIZE.x + x) as usize].x).sum::<f32>();
    (0..SIZE.x).map(|x| column(x) / rows.len() as f32).collect()
}

/// Light of a sphere of 12 x 6 quads fades out where that of one of 192 x 96 does, and is as much. Without curved surfaces it ends at
/// edges of triangles, and a part of it is missing: that is what the limits would see.
#[test]
fn light_fades_out_as_on_a_sphere() {
    let Some(device) = device() else { return };
    let truth = profile(&picture(&device, &lit(192, true)));
    let brightest = truth.iter().fold(0.0f32, |a, b| a.max(*b));
    // Right of the middle: the terminator, and not the outline, which is a polygon's.
    let columns = 40..80;
    let errors = |scene: &SceneDescription| {
        let found = profile(&picture(&device, scene));
        let off = columns.clone().map(|x| (found[x] - truth[x]).abs()).fold(0.0, f32::max);
        let [light, all] = [&found, &truth].map(|of| of[columns.clone()].iter().sum::<f32>());
        (off / brightest, light / all)
    };
    let (smooth, hard) = (errors(&lit(12, false)), errors(&lit(12, true)));
    println!("largest error and share of the light: {smooth:?}, hard {hard:?}");
    assert!(smooth.0 < 0.02 && (smooth.1 - 1.0).abs() < 0.02, "{smooth:?}");
    assert!(hard.0 > 0.05 && hard.1 < 0.96, "the fault was not seen: {hard:?}");
    // Many triangles are nearly the sphere, either way.
    let fine = errors(&lit(192, false));
    assert!(fine.0 < 0.01 && (fine.1 - 1.0).abs() < 0.01, "{fine:?}");
    assert_no_validation_messages(&device);
}

/// One light leaves nothing to chance: frames show the reference's picture, reuse or not, at rest and in motion.
#[test]
fn frames_agree_with_the_reference() {
    let Some(device) = device() else { return };
    let scene = lit(12, false);
    let truth = picture(&device, &scene);
    let mut renderer = renderer(&device, &scene, SIZE, 1);
    assert!(renderer.scene().features() & features::SMOOTH != 0);
    let found = restir(&mut renderer, camera(), Settings::default(), 3, 1);
    let off = found.iter().zip(&truth).map(|(a, b)| (*a - *b).abs().max_element()).fold(0.0, f32::max);
    assert!(off < 1e-4 * truth.iter().map(|c| c.x).fold(0.0, f32::max), "{off}");
}

/// Scenes without curved surfaces do not pay for them, nor do scenes that do not want them.
#[test]
fn flat_scenes_have_none() {
    let Some(device) = device() else { return };
    let features = |scene: &SceneDescription| renderer(&device, scene, SIZE, 0).scene().features();
    assert!(features(&lit(12, true)) & features::SMOOTH == 0);
    assert!(features(&scene(vec![], vec![], vec![])) & features::SMOOTH == 0);
}
