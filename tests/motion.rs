//! Scenes that move: the history follows instances and lights, and the unbiased mode keeps the reference's mean.

use candela::frame::renderer::Renderer;
use candela::frame::schedule::{Conditions, Rotation, Work, schedule};
use candela::frame::targets::Target;
use candela::scene::animation::{Animation, Channel, Curve, Interpolation, Local, Node, Thing, Track};
use candela::scene::lights::LightEdits;
use candela::scene::{Environment, Instance, Material, Mesh, PointLight, Primitive, SceneDescription};
use glam::{Affine3A, DAffine3, DQuat, DVec3, DVec4, UVec2, Vec3};
use shared::camera::Camera;
use shared::frame::{Settings, mode};
use shared::passes::variant;
use shared::reservoir::StoredReservoir;
use shared::resources::Resource;
use shared::surface::GBufferTexel;
use tests::gpu::{assert_no_validation_messages, device, options, pose, reference, renderer};
use tests::scenes::{camera, emitter, scene, square};
use tests::statistics::{assert_means, largest_z, mean_and_error, replicas};

const SIZE: UVec2 = UVec2::new(64, 48);
const REPLICAS: u32 = 48;
/// Over 48 blocks with Student's t of 47 degrees of freedom: a false alarm in 1e-4 of all runs a case (Sidak).
const Z_LIMIT: f64 = 5.9;

fn line(from: DVec3, to: DVec3) -> Track<DVec3> {
    Track { interpolation: Interpolation::Linear, times: vec![0.0, 3.0], values: vec![from, to] }
}

/// Adds a mesh of its own, and a node that carries it.
fn add(scene: &mut SceneDescription, primitive: Primitive) -> usize {
    scene.meshes.push(Mesh { name: String::new(), primitives: vec![primitive] });
    let mesh = scene.meshes.len() - 1;
    scene.instances.push(Instance { name: String::new(), mesh, transform: Affine3A::IDENTITY });
    node(scene, Thing::Instance(scene.instances.len() - 1))
}

fn node(scene: &mut SceneDescription, thing: Thing) -> usize {
    let rest = Local::Trs { translation: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: DVec3::ONE };
    scene.animation.nodes.push(Node { parent: None, base: DAffine3::IDENTITY, rest });
    let node = scene.animation.nodes.len() - 1;
    scene.animation.attached.push((thing, node));
    node
}

/// Over the floor, within 3 s: a screen that runs 1.5 m, a point light that runs the other way, and an emissive quad that
/// runs, turns and grows to nine times its area; some lights rest.
fn moving() -> SceneDescription {
    let lights = [(-1.5, 2.0, -0.5), (1.0, 1.5, 0.8), (0.2, 2.5, -1.5)].map(|(x, y, z)| PointLight {
        position: Vec3::new(x, y, z),
        intensity: Vec3::new(9.0, 8.0, 6.0),
        radius: 0.0,
    });
    let mut scene = scene(vec![], vec![Material::default(), emitter(Vec3::splat(60.0))], lights.to_vec());
    let screen = add(&mut scene, square(Vec3::ZERO, Vec3::Z * 0.6, Vec3::X * 0.5, 1));
    let quad = add(&mut scene, square(Vec3::ZERO, Vec3::X * 0.2, Vec3::Z * 0.2, 2));
    let lamp = node(&mut scene, Thing::Light(2));
    let (start, turned) = (DVec4::new(1.0, 0.0, 0.0, 0.0), DVec4::new(0.8, 0.0, 0.6, 0.0));
    let turn =
        Track { interpolation: Interpolation::Linear, times: vec![0.0, 3.0], values: vec![start, turned] };
    scene.animation.channels = vec![
        Channel {
            node: screen,
            curve: Curve::Translation(line(DVec3::new(-0.9, 0.5, 0.3), DVec3::new(0.6, 0.5, 0.3))),
        },
        Channel {
            node: quad,
            curve: Curve::Translation(line(DVec3::new(1.2, 1.6, -1.0), DVec3::new(0.0, 1.2, -0.6))),
        },
        Channel { node: quad, curve: Curve::Scale(line(DVec3::ONE, DVec3::splat(3.0))) },
        Channel { node: quad, curve: Curve::Rotation(turn) },
        Channel {
            node: lamp,
            curve: Curve::Translation(line(DVec3::new(0.2, 2.5, -1.5), DVec3::new(1.5, 1.0, 0.5))),
        },
    ];
    scene
}

fn render(renderer: &mut Renderer, camera: Camera, settings: Settings, seed: u32) {
    let options = options(Work::Restir(settings), seed);
    renderer.render(camera, &options).expect("the frame renders");
}

/// A camera that moves with the frames, a little.
fn moving_camera(frame: u32) -> Camera {
    let camera = camera(SIZE);
    Camera { position: camera.position + Vec3::new(0.04, 0.02, 0.0) * frame as f32, ..camera }
}

/// Block means of frame 3 over independent runs of frames 0 to 3, a second each.
fn run(renderer: &mut Renderer, scene: &mut SceneDescription, settings: Settings) -> Vec<(f64, f64)> {
    replicas(REPLICAS, SIZE, |seed| {
        renderer.restart();
        for frame in 0..4 {
            pose(renderer, scene, f64::from(frame));
            render(renderer, moving_camera(frame), settings, seed);
        }
        renderer.radiance().expect("the picture is read back")
    })
}

/// Unbiased reuse has the mean of the last frame's reference, with a history from where things were. Taking the past for the
/// present (rays of the past among the things of today) has not, and the same test sees it.
#[test]
fn unbiased_reuse_is_right_where_things_move() {
    let Some(device) = device() else { return };
    let mut scene = moving();
    let mut renderer = renderer(&device, &scene, SIZE, 1);
    pose(&mut renderer, &mut scene, 3.0);
    let truth = replicas(REPLICAS, SIZE, |seed| reference(&mut renderer, moving_camera(3), 1000 + seed));
    let base = Settings {
        candidates: 8,
        radius: 8.0,
        spatial: 0,
        pixel_centers: 1,
        mode: mode::UNBIASED,
        ..Settings::default()
    };
    for (name, settings) in [
        ("temporal", base),
        ("temporal without visibility reuse", Settings { visibility_reuse: 0, ..base }),
        ("temporal and spatial", Settings { spatial: 1, ..base }),
    ] {
        let means = run(&mut renderer, &mut scene, settings);
        assert_means(name, &means, &truth, Z_LIMIT);
    }
    renderer.ignore_motion(true);
    let z = largest_z(&run(&mut renderer, &mut scene, base), &truth).0;
    println!("without a past: largest z {z:.2}");
    assert!(z > Z_LIMIT, "the past taken for the present was not seen: {z}");
    assert_no_validation_messages(&device);
}

/// The same where pixels keep their points, also those of things that move: against the sum at those very points.
#[test]
fn points_that_last_are_right_where_things_move() {
    let Some(device) = device() else { return };
    let mut scene = moving();
    let mut renderer = renderer(&device, &scene, SIZE, 1);
    let settings = Settings {
        candidates: 8,
        radius: 8.0,
        pixel_centers: 0,
        mode: mode::UNBIASED,
        ..Settings::default()
    };
    run(&mut renderer, &mut scene, settings);
    let lights = renderer.scene().light_count();
    let truth = replicas(REPLICAS, SIZE, |seed| {
        let options = options(Work::Truth { lights }, 1000 + seed);
        renderer.render(moving_camera(3), &options).expect("the sum renders");
        renderer.radiance().expect("the picture is read back")
    });
    assert_means("points that last", &run(&mut renderer, &mut scene, settings), &truth, Z_LIMIT);
    renderer.ignore_motion(true);
    let z = largest_z(&run(&mut renderer, &mut scene, settings), &truth).0;
    println!("without a past: largest z {z:.2}");
    assert!(z > Z_LIMIT, "the past taken for the present was not seen: {z}");
    assert_no_validation_messages(&device);
}

/// A red and a green light; the red one goes, or is switched off. In that very frame nothing red is left, and the green light
/// is neither brighter nor darker for it (mean over the picture, |z| < 5: a false alarm in 1e-6 a case).
#[test]
fn a_light_that_goes_takes_its_energy_along() {
    let Some(device) = device() else { return };
    let light = |x: f32, intensity| PointLight { position: Vec3::new(x, 1.5, 0.0), intensity, radius: 0.0 };
    let (red, green) = (light(-0.5, Vec3::X * 200.0), light(0.5, Vec3::Y * 20.0));
    let both = scene(vec![], vec![], vec![red, green]);
    let dark = PointLight { intensity: Vec3::ZERO, ..red };
    let removed = LightEdits { places: Some(vec![None, Some(0)]) };
    let camera = camera(SIZE);
    let mean = |image: &[Vec3]| image.iter().map(|c| c.as_dvec3()).sum::<DVec3>() / image.len() as f64;
    for (lights, edits) in [(vec![green], removed), (vec![dark, green], LightEdits::default())] {
        let left = SceneDescription { lights: lights.into_iter().map(Into::into).collect(), ..both.clone() };
        let mut renderer = renderer(&device, &left, SIZE, 1);
        let truth = mean(&reference(&mut renderer, camera, 0));
        for mode in [mode::BIASED, mode::UNBIASED] {
            let settings = Settings { candidates: 4, spatial: 0, mode, ..Settings::default() };
            let samples: Vec<Vec<f64>> = (0..20)
                .map(|seed| {
                    renderer.restart();
                    // The lights come back, as new ones.
                    renderer.replace_lights(&both, &LightEdits::default()).unwrap();
                    (0..2).for_each(|_| render(&mut renderer, camera, settings, seed));
                    assert!(mean(&renderer.radiance().unwrap()).x > 1.0, "there is red light before");
                    renderer.replace_lights(&left, &edits).unwrap();
                    render(&mut renderer, camera, settings, seed);
                    let picture = renderer.radiance().unwrap();
                    assert!(picture.iter().all(|c| c.x == 0.0), "red light without a red lamp");
                    vec![mean(&picture).y]
                })
                .collect();
            let (found, error) = mean_and_error(&samples)[0];
            println!("mode {mode}: {found} instead of {} ± {error}", truth.y);
            assert!((found - truth.y).abs() < 5.0 * error + 1e-5 * truth.y, "{found}, {} ± {error}", truth.y);
        }
    }
    assert_no_validation_messages(&device);
}

/// Another sky, of another size, with other dark texels: lights, background and what rays along the reflectance find are those of
/// a scene made with it, bit by bit.
#[test]
fn a_sky_is_replaced_whole() {
    let Some(device) = device() else { return };
    let sky = |size: UVec2, dark: u32| {
        let texel = |i: u32| {
            if i.is_multiple_of(dark) { Vec3::ZERO } else { Vec3::new(1.0, 0.5, 0.2) * (i % 5) as f32 }
        };
        Some(Environment { size, radiance: (0..size.x * size.y).map(texel).collect() })
    };
    let with = |environment| SceneDescription { environment, ..scene(vec![], vec![], vec![]) };
    let (first, second) = (with(sky(UVec2::new(16, 8), 3)), with(sky(UVec2::new(8, 4), 2)));
    let camera = camera(SIZE);
    let picture = |renderer: &mut Renderer| {
        renderer.restart();
        render(renderer, camera, Settings::default(), 3);
        renderer.radiance().unwrap()
    };
    let mut changed = renderer(&device, &first, SIZE, 1);
    let before = picture(&mut changed);
    changed.replace_lights(&second, &LightEdits::default()).unwrap();
    let expected = picture(&mut renderer(&device, &second, SIZE, 1));
    assert!(picture(&mut changed) == expected, "the replaced sky is not the new one");
    assert!(before != expected, "the skies are not told apart");
    assert_no_validation_messages(&device);
}

const HALF: f64 = 0.8;
/// Beyond the threshold of normals (25°): who looks where things are now finds another surface.
const STEP: f64 = 0.52;

/// The box's face that a ray meets (axis and side), and where, in the box's own coordinates.
fn face(origin: DVec3, direction: DVec3) -> Option<(usize, bool, DVec3)> {
    let (a, b) = ((DVec3::splat(-HALF) - origin) / direction, (DVec3::splat(HALF) - origin) / direction);
    let (near, far) = (a.min(b), a.max(b));
    let t = near.max_element();
    if t > far.min_element() || t < 0.0 {
        return None;
    }
    let axis = (0..3).find(|&i| near[i] == t)?;
    Some((axis, direction[axis] < 0.0, origin + t * direction))
}

/// A box that turns 30° a frame keeps the history of each face that was in view: as many pixels as the geometry says (up to 2 %
/// at edges, where centers of pixels differ). Without its motion almost none would find theirs.
#[test]
fn a_turning_box_keeps_its_history() {
    let Some(device) = device() else { return };
    let side = |u: Vec3, v: Vec3| {
        let n = u.cross(v);
        square(n * HALF as f32, u * HALF as f32, v * HALF as f32, 1)
    };
    let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
    let sides = [side(x, y), side(y, x), side(y, z), side(z, y), side(z, x), side(x, z)];
    let light = PointLight { position: Vec3::new(1.0, 3.0, 3.0), intensity: Vec3::splat(50.0), radius: 0.0 };
    let mut scene = scene(vec![], vec![Material::default()], vec![light]);
    let turning = add(&mut scene, sides[0].clone());
    scene.meshes[1].primitives = sides.to_vec();
    let turn = |angle: f64| DQuat::from_rotation_y(angle);
    let keys = [0.0, 1.0].map(|t| DVec4::from(turn(STEP * t)));
    let up = line(DVec3::Y, DVec3::Y);
    let track = Track { interpolation: Interpolation::Linear, times: vec![0.0, 1.0], values: keys.to_vec() };
    scene.animation.channels = vec![
        Channel { node: turning, curve: Curve::Rotation(track) },
        Channel { node: turning, curve: Curve::Translation(up) },
    ];
    let camera = camera(SIZE);
    let place = |angle: f64| DAffine3::from_rotation_translation(turn(angle), DVec3::Y);
    let seen = |pixel: UVec2, angle: f64| {
        let to_box = place(angle).inverse();
        let direction = camera.direction(pixel.as_vec2() + 0.5, SIZE).as_dvec3();
        face(to_box.transform_point3(camera.position.as_dvec3()), to_box.transform_vector3(direction))
    };
    let (mut on_box, mut expected) = (0, 0);
    for i in 0..SIZE.x * SIZE.y {
        let pixel = UVec2::new(i % SIZE.x, i / SIZE.x);
        let Some((axis, positive, at)) = seen(pixel, STEP) else { continue };
        on_box += 1;
        let before = place(0.0).transform_point3(at) - camera.position.as_dvec3();
        let before = camera.project(before.as_vec3(), SIZE).as_uvec2();
        let same = |(a, p, _): (usize, bool, DVec3)| (a, p) == (axis, positive);
        expected += u32::from(seen(before, 0.0).is_some_and(same));
    }
    assert!(on_box > 300 && expected > on_box / 2, "{expected} of {on_box} pixels");
    let settings = Settings { candidates: 8, spatial: 0, pixel_centers: 1, ..Settings::default() };
    for mode in [mode::BIASED, mode::UNBIASED] {
        let settings = Settings { mode, ..settings };
        let mut with_history = |ignore: bool| {
            let mut renderer = renderer(&device, &scene, SIZE, 1);
            renderer.ignore_motion(ignore);
            for frame in 0..2 {
                pose(&mut renderer, &mut scene, f64::from(frame));
                render(&mut renderer, camera, settings, 1);
            }
            // The second frame's.
            let copy = |resource, copy| Target { resource, copy };
            let gbuffer: Vec<GBufferTexel> = renderer.read(copy(Resource::gbuffer, 1)).unwrap();
            let reservoirs: Vec<StoredReservoir> = renderer.read(copy(Resource::reservoirs, 2)).unwrap();
            let box_pixels =
                gbuffer.iter().zip(&reservoirs).filter(|(t, _)| !t.is_empty() && t.instance() > 0);
            box_pixels.filter(|(_, reservoir)| reservoir.confidence > 8.0).count() as f64
        };
        let (found, ignoring) = (with_history(false), with_history(true));
        println!("mode {mode}: {found} of {expected} expected, {ignoring} without motion, {on_box} in all");
        assert!(
            (found / f64::from(expected) - 1.0).abs() < 0.02 + 0.05,
            "{found} pixels instead of {expected}"
        );
        assert!(ignoring < 0.5 * f64::from(expected), "{ignoring} pixels find a history without motion");
    }
    assert_no_validation_messages(&device);
}

/// What stands still pays nothing: no structure or buffer of the past, no pass; and a scene that has moved pays for
/// no frame in which it rests.
#[test]
fn a_still_scene_has_no_past() {
    let Some(device) = device() else { return };
    let mut scene = moving();
    let mut renderer = renderer(&device, &scene, SIZE, 1);
    let camera = camera(SIZE);
    let stems = |moved: bool| {
        let conditions = Conditions { moved, ..Default::default() };
        let (steps, _) = schedule(&Work::Restir(Settings::default()), conditions, Rotation::default());
        steps.iter().map(|step| (step.pass.stem(), step.variant & variant::MOVING != 0)).collect::<Vec<_>>()
    };
    let still = ["gbuffer", "initial", "temporal_traced", "pair_targets", "pair_merge", "shade", "tonemap"];
    assert_eq!(stems(false), still.map(|stem| (stem, false)));
    let moving = still.map(|stem| (stem, stem == "temporal_traced"));
    assert_eq!(stems(true), moving, "motion is a variant of a pass, and adds none");
    render(&mut renderer, camera, Settings::default(), 0);
    render(&mut renderer, camera, Settings::default(), 0);
    let before = renderer.scene().bytes();
    assert_eq!((renderer.scene().past_bytes(), renderer.scene().has_changed()), (0, false));
    pose(&mut renderer, &mut scene, 1.0);
    assert!(renderer.scene().past_bytes() > 0 && renderer.scene().bytes() > before);
    assert!(renderer.scene().has_changed());
    render(&mut renderer, camera, Settings::default(), 0);
    assert!(!renderer.scene().has_changed(), "the next frame is a still one");
    assert!(Animation::default().pose(1.0).places.is_empty());
    assert_no_validation_messages(&device);
}
