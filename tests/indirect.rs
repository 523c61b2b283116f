//! Resampled light that bounces on the device: its mean is that of the path tracer, in a box with a pane, by every way of reuse.

use candela::frame::renderer::{FrameOptions, Renderer};
use candela::frame::schedule::Work;
use candela::scene::animation::{Channel, Curve, Interpolation, Local, Node, Thing, Track};
use candela::scene::lights::LightEdits;
use candela::scene::{Instance, Mesh, PointLight, SceneDescription, fixtures};
use glam::{Affine3A, DAffine3, DQuat, DVec3, UVec2, Vec3, Vec4};
use shared::camera::Camera;
use shared::frame::{Settings, indirect};
use tests::gpu::{assert_no_validation_messages, device, options, pose, renderer, what_bounced};
use tests::scenes::{pane, square};
use tests::statistics::{assert_means, largest_z, replicas};

const SIZE: UVec2 = UVec2::new(32, 24);
const REPLICAS: u32 = 32;
/// Over 12 blocks with Student's t of some 40 degrees of freedom: a false alarm in 1e-4 of all runs a case (Sidak).
const Z_LIMIT: f64 = 5.2;

fn cornell_box() -> SceneDescription {
    let (_, scene) = fixtures::all().into_iter().find(|(name, _)| *name == "cornell-box").expect("a box");
    scene
}

/// With a pane before its back wall.
fn box_with_pane() -> SceneDescription {
    let mut scene = cornell_box();
    let material = scene.materials.len();
    scene.materials.push(pane());
    let pane = square(Vec3::new(0.0, 0.5, -0.3), Vec3::X * 0.25, Vec3::Y * 0.25, material);
    scene.instances.push(Instance {
        name: "pane".into(),
        mesh: scene.meshes.len(),
        transform: Affine3A::IDENTITY,
    });
    scene.meshes.push(Mesh { name: "pane".into(), primitives: vec![pane] });
    scene
}

/// Two cameras, half a pixel from one another.
fn cameras(scene: &SceneDescription) -> [Camera; 2] {
    let view = scene.camera(None).expect("a camera");
    let camera = view.seen_in(SIZE);
    let beside = Camera { position: camera.position + camera.right.normalize() * 0.05, ..camera };
    [camera, beside]
}

/// What bounced in the last of `frames` frames of a fresh history; every second one is seen by the other camera, where there is one.
fn bounced(
    renderer: &mut Renderer,
    cameras: &[Camera],
    settings: Settings,
    frames: usize,
    seed: u32,
) -> Vec<Vec3> {
    renderer.restart();
    let seen: Vec<Camera> = (0..frames).rev().map(|frame| cameras[frame % cameras.len()]).collect();
    last(renderer, &seen, settings, seed)
}

/// What bounced in the last of the next frames, one a camera.
fn last(renderer: &mut Renderer, cameras: &[Camera], settings: Settings, seed: u32) -> Vec<Vec3> {
    let options = FrameOptions { parts: true, ..options(Work::Restir(settings), seed) };
    for camera in cameras {
        renderer.render(*camera, &options).expect("the frame renders");
    }
    what_bounced(renderer)
}

fn paths(renderer: &mut Renderer, camera: Camera, bounces: u32, seed: u32) -> Vec<Vec3> {
    renderer.restart();
    let work = Work::Paths { bounces, paths: 32 };
    renderer.render(camera, &options(work, seed)).expect("the frame renders");
    renderer.radiance().expect("the picture is read back")
}

#[test]
fn resampled_paths_have_the_mean_of_the_path_tracer() {
    let Some(device) = device() else { return };
    let scene = box_with_pane();
    let cameras = cameras(&scene);
    let mut renderer = renderer(&device, &scene, SIZE, 1);
    let mut truths = Vec::new();
    for mode in [indirect::ONE, indirect::FULL] {
        let truth = replicas(REPLICAS, SIZE, |seed| {
            paths(&mut renderer, cameras[0], indirect::bounces(mode), 1000 + seed)
        });
        let all = Settings { indirect: mode, candidates: 4, radius: 8.0, ..Settings::default() };
        let fresh = Settings { temporal: 0, spatial: 0, ..all };
        let twice = Settings { spatial: 1, spatial_iterations: 2, ..fresh };
        for (name, cameras, settings, frames) in [
            ("fresh", &cameras[..1], fresh, 1),
            ("pairs, 2 times", &cameras[..1], twice, 1),
            ("history and pairs, at rest", &cameras[..1], all, 4),
            ("history and pairs, moving", &cameras, all, 4),
        ] {
            let run = |seed| bounced(&mut renderer, cameras, settings, frames, seed);
            let means = replicas(REPLICAS, SIZE, run);
            assert_means(&format!("{name}, mode {mode}"), &means, &truth, Z_LIMIT);
        }
        truths.push(truth);
    }
    // Negative control: the bounces after the first left out.
    assert!(largest_z(&truths[0], &truths[1]).0 > Z_LIMIT, "later bounces were not seen");
    assert_no_validation_messages(&device);
}

/// Where nothing is transparent, paths begin along the rays of direct light: the mean is the same.
#[test]
fn paths_share_the_rays_of_direct_light() {
    let Some(device) = device() else { return };
    let scene = cornell_box();
    let camera = cameras(&scene)[0];
    let mut renderer = renderer(&device, &scene, SIZE, 1);
    let settings =
        Settings { indirect: indirect::FULL, candidates: 4, temporal: 0, spatial: 0, ..Settings::default() };
    let own = Settings { bsdf_candidates: 0, ..settings };
    let [shared, own] = [settings, own].map(|settings| {
        replicas(REPLICAS, SIZE, |seed| bounced(&mut renderer, &[camera], settings, 1, seed))
    });
    assert_means("shared rays", &shared, &own, Z_LIMIT);
    let truth = replicas(REPLICAS, SIZE, |seed| {
        paths(&mut renderer, camera, indirect::bounces(indirect::FULL), 1000 + seed)
    });
    assert_means("shared rays and paths", &shared, &truth, Z_LIMIT);
    assert_no_validation_messages(&device);
}

/// A red and a green lamp in the box; the red one is switched off. In that very frame no red light bounces, by histories of lights or
/// of paths, and the green light that bounces has the mean of the path tracer's.
#[test]
fn light_that_bounces_goes_with_its_lamp() {
    let Some(device) = device() else { return };
    let light = |x: f32, intensity| PointLight { position: Vec3::new(x, 0.8, 0.3), intensity, radius: 0.0 };
    let mut both = cornell_box();
    both.instances.retain(|instance| instance.name != "lamp");
    both.materials.iter_mut().for_each(|material| material.base_color = Vec4::ONE);
    both.lights = [light(-0.3, Vec3::X * 50.0), light(0.3, Vec3::Y * 20.0)].map(Into::into).to_vec();
    let mut left = both.clone();
    *left.lights[0].emission_mut() = Vec3::ZERO;
    let camera = cameras(&both)[0];
    let mut renderer = renderer(&device, &left, SIZE, 1);
    for mode in [indirect::ONE, indirect::FULL] {
        let truth = replicas(REPLICAS, SIZE, |seed| {
            paths(&mut renderer, camera, indirect::bounces(mode), 1000 + seed)
        });
        let settings = Settings { indirect: mode, candidates: 4, radius: 8.0, ..Settings::default() };
        let means = replicas(REPLICAS, SIZE, |seed| {
            renderer.restart();
            renderer.replace_lights(&both, &LightEdits::default()).expect("they come back");
            let before = last(&mut renderer, &[camera; 3], settings, seed);
            assert!(before.iter().map(|c| c.x).sum::<f32>() > 1.0, "red light bounces before");
            renderer.replace_lights(&left, &LightEdits::default()).expect("one is switched off");
            let after = last(&mut renderer, &[camera], settings, seed);
            assert!(after.iter().all(|c| c.x == 0.0), "red light without a red lamp, mode {mode}");
            after
        });
        assert_means(&format!("the green lamp alone, mode {mode}"), &means, &truth, Z_LIMIT);
    }
    assert_no_validation_messages(&device);
}

/// The high block jumps through the box after four frames at rest: what bounces in the frame after it has the mean of the path tracer there. Taking
/// the past for the present has not, and the same test sees it.
#[test]
fn light_that_bounces_is_right_where_things_move() {
    let Some(device) = device() else { return };
    let mut scene = cornell_box();
    let block = scene.instances.iter().position(|i| i.name == "high block").expect("a block");
    let rest = Local::Trs { translation: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: DVec3::ONE };
    scene.animation.nodes.push(Node { parent: None, base: DAffine3::IDENTITY, rest });
    scene.animation.attached.push((Thing::Instance(block), 0));
    let values = vec![DVec3::new(-0.1, 0.0, 0.1), DVec3::new(0.35, 0.0, 0.2)];
    let track = Track { interpolation: Interpolation::Linear, times: vec![0.0, 2.0], values };
    scene.animation.channels.push(Channel { node: 0, curve: Curve::Translation(track) });
    let camera = cameras(&scene)[0];
    let mut renderer = renderer(&device, &scene, SIZE, 1);
    pose(&mut renderer, &mut scene, 2.0);
    for mode in [indirect::ONE, indirect::FULL] {
        let truth = replicas(REPLICAS, SIZE, |seed| {
            paths(&mut renderer, camera, indirect::bounces(mode), 1000 + seed)
        });
        let settings =
            Settings { indirect: mode, candidates: 4, radius: 8.0, pixel_centers: 1, ..Settings::default() };
        let mut run = |renderer: &mut Renderer| {
            replicas(REPLICAS, SIZE, |seed| {
                renderer.restart();
                let mut picture = Vec::new();
                for time in [0.0, 0.0, 0.0, 0.0, 2.0] {
                    pose(renderer, &mut scene, time);
                    picture = last(renderer, &[camera], settings, seed);
                }
                picture
            })
        };
        let means = run(&mut renderer);
        assert_means(&format!("behind a moving block, mode {mode}"), &means, &truth, Z_LIMIT);
        renderer.ignore_motion(true);
        let z = largest_z(&run(&mut renderer), &truth).0;
        renderer.ignore_motion(false);
        assert!(z > Z_LIMIT, "the past taken for the present was not seen: {z}, mode {mode}");
    }
    assert_no_validation_messages(&device);
}
