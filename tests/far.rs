//! A scene far from the zero of its file looks as it does near.

use candela::scene::{SceneDescription, gltf};
use glam::{DAffine3, DVec3, UVec2, Vec3};
use serde_json::{Value, json};
use shared::camera::Camera;
use std::path::{Path, PathBuf};
use tests::failure;
use tests::gpu::{assert_no_validation_messages, device, reference, renderer, restir};

const SIZE: UVec2 = UVec2::new(96, 64);
/// Share of pixels: edges may fall into the next one.
const TOLERANCE: f64 = 0.01;
const FAR: DVec3 = DVec3::new(1e5, -5e4, -1e5);

fn fixture() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/scenes/cornell-box.glb")
}

/// The fixture under a root node at `place`.
fn moved(place: DVec3) -> SceneDescription {
    let bytes = std::fs::read(fixture()).expect("the fixture is there");
    let length = u32::from_le_bytes(bytes[12..16].try_into().expect("four bytes")) as usize;
    let (text, bin) = (&bytes[20..20 + length], &bytes[20 + length..]);
    let mut json: Value = serde_json::from_slice(text).expect("the fixture is JSON");
    let roots = json["scenes"][0]["nodes"].take();
    let nodes = json["nodes"].as_array_mut().expect("it has nodes");
    nodes.push(json!({"translation": place.to_array(), "children": roots}));
    json["scenes"][0]["nodes"] = json!([nodes.len() - 1]);
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut glb = b"glTF\x02\0\0\0".to_vec();
    glb.extend(((20 + text.len() + bin.len()) as u32).to_le_bytes());
    glb.extend((text.len() as u32).to_le_bytes());
    glb.extend(b"JSON");
    glb.extend(text);
    glb.extend(bin);
    let path = std::env::temp_dir().join(format!("candela-far-{}-{}.glb", std::process::id(), place.x));
    std::fs::write(&path, glb).expect("the file is written");
    let scene = gltf::load(&path);
    std::fs::remove_file(&path).expect("the file is removed");
    scene.expect("the scene loads")
}

fn camera(scene: &SceneDescription) -> Camera {
    let view = scene.camera_fitted();
    Camera::new(view.position, view.forward, view.up, view.fov_y, SIZE)
}

/// Share of pixels that differ by more than 1 %.
fn differing(a: &[Vec3], b: &[Vec3]) -> f64 {
    let differs =
        |(a, b): &(&Vec3, &Vec3)| (**a - **b).abs().max_element() > 0.01 * b.max_element().max(1e-6);
    a.iter().zip(b).filter(differs).count() as f64 / a.len() as f64
}

#[test]
fn far_scenes_look_like_near_ones() {
    let Some(device) = device() else { return };
    let (near, far) = (moved(DVec3::ZERO), moved(FAR));
    assert!(near.origin == DVec3::ZERO && (far.origin - FAR).length() < 10.0, "{}", far.origin);
    let unbiased = shared::frame::Settings { mode: shared::frame::mode::UNBIASED, ..Default::default() };
    let pictures = |scene: &SceneDescription| {
        let mut renderer = renderer(&device, scene, SIZE, 1);
        let camera = camera(scene);
        [reference(&mut renderer, camera, 1), restir(&mut renderer, camera, unbiased, 4, 1)]
    };
    let expected = pictures(&near);
    for (name, (image, expected)) in
        ["far-reference", "far-unbiased"].into_iter().zip(pictures(&far).iter().zip(&expected))
    {
        let share = differing(image, expected);
        assert!(
            share < TOLERANCE,
            "{name}: {share} of pixels; {}",
            failure::write(name, SIZE, image, expected)
        );
    }
    // Negative control: the same places in f32 around zero.
    let mut rounded = near.clone();
    let shift = FAR.as_vec3();
    rounded.instances.iter_mut().for_each(|i| i.transform.translation += glam::Vec3A::from(shift));
    for light in &mut rounded.lights {
        let place = light.position().unwrap() + shift;
        light.place(&DAffine3::from_translation(place.as_dvec3()));
    }
    let share = differing(&pictures(&rounded)[0], &expected[0]);
    assert!(share > TOLERANCE, "the planted error was not seen: {share} of pixels");
    assert_no_validation_messages(&device);
}
