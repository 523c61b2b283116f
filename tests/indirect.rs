//! Resampled light that bounces on the device: its mean is that of the path tracer, in a box with a pane, by every way of reuse.

use candela::frame::renderer::{FrameOptions, Renderer};
use candela::frame::schedule::Work;
use candela::scene::{Instance, Mesh, SceneDescription, fixtures};
use glam::{Affine3A, UVec2, Vec3};
use shared::camera::Camera;
use shared::frame::{Settings, indirect};
use shared::resources::Resource;
use tests::gpu::{assert_no_validation_messages, device, options, renderer};
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
    let options = FrameOptions { parts: true, ..options(Work::Restir(settings), seed) };
    for frame in (0..frames).rev() {
        renderer.render(cameras[frame % cameras.len()], &options).expect("the frame renders");
    }
    let read = |resource| renderer.read::<Vec3>(resource).expect("it is read back");
    let (diffuse, specular) = (read(Resource::indirect_diffuse), read(Resource::indirect_specular));
    let gbuffer = renderer.gbuffer().expect("it is read back");
    let parts = diffuse.iter().zip(&specular).zip(&gbuffer);
    parts.map(|((&diffuse, &specular), texel)| texel.diffuse() * diffuse + specular).collect()
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
