//! Meshes that change their shape from frame to frame: skins and morph targets on the device.

use candela::frame::renderer::Renderer;
use candela::frame::schedule::Work;
use candela::scene::animation::{Channel, Curve, Interpolation, Local, Node, Track};
use candela::scene::deform::{Bends, Deformed, Influences, Joint, JointPlace, Skin, Target};
use candela::scene::{Instance, Material, Mesh, PointLight, Primitive, SceneDescription};
use glam::{Affine3A, DAffine3, DQuat, DVec3, DVec4, UVec2, Vec3};
use peak_alloc::PeakAlloc;
use shared::frame::{Settings, mode};
use tests::gpu::{assert_no_validation_messages, device, options, pose, reference, renderer};
use tests::scenes::{camera, emitter, scene, square};
use tests::statistics::{assert_means, largest_z, replicas};

#[global_allocator]
static HEAP: PeakAlloc = PeakAlloc;

const SIZE: UVec2 = UVec2::new(32, 24);
const REPLICAS: u32 = 48;
/// As in `motion.rs`: a false alarm in 1e-4 of all runs a case.
const Z_LIMIT: f64 = 5.9;
const SECONDS: f32 = 3.0;

fn track<T>(from: T, to: T) -> Track<T> {
    Track { interpolation: Interpolation::Linear, times: vec![0.0, SECONDS], values: vec![from, to] }
}

/// Adds a mesh of its own that bends.
fn add(scene: &mut SceneDescription, rest: Primitive, morph: Option<usize>, skin: Option<Skin>) {
    scene.meshes.push(Mesh { name: String::new(), primitives: vec![] });
    let mesh = scene.meshes.len() - 1;
    scene.instances.push(Instance { name: String::new(), mesh, transform: Affine3A::IDENTITY });
    scene.deformed.push(Deformed { mesh, rest: vec![rest], weights: vec![0.0], morph, skin });
}

/// Over the floor, within 3 s: a screen of two bones, whose upper half swings down by a quarter turn, and a lamp that a morph target
/// carries away and makes twice as long.
fn bending() -> SceneDescription {
    let lights = [(-1.5, 2.0, -0.5), (1.0, 1.5, 0.8)].map(|(x, y, z)| PointLight {
        position: Vec3::new(x, y, z),
        intensity: Vec3::new(9.0, 8.0, 6.0),
        radius: 0.0,
    });
    let mut scene = scene(vec![], vec![Material::default(), emitter(Vec3::splat(60.0))], lights.to_vec());
    let node = |parent, y: f64| Node {
        parent,
        base: DAffine3::from_translation(DVec3::new(-0.3, 0.0, 0.2)),
        rest: Local::Trs { translation: DVec3::Y * y, rotation: DQuat::IDENTITY, scale: DVec3::ONE },
    };
    scene.animation.nodes = vec![node(None, 0.0), node(Some(0), 0.5)];
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let turn = track(DVec4::W, DVec4::new(half, 0.0, 0.0, half));
    scene.animation.channels = vec![Channel { node: 1, curve: Curve::Rotation(turn) }];

    // A strip of two squares, 1 m high: its lower edge hangs on the first bone, the others on the second.
    let rows = [(0.0, 0), (0.5, 1), (1.0, 1)];
    let corners = rows.iter().flat_map(|&(y, _)| [Vec3::new(-0.5, y, 0.0), Vec3::new(0.5, y, 0.0)]);
    let influences = rows.iter().flat_map(|&(_, joint)| {
        let influence = Influences::new([joint as f32; 8], [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        [influence; 2]
    });
    let strip = Primitive {
        material: 1,
        positions: corners.collect(),
        normals: vec![Vec3::Z; 6],
        indices: vec![0, 1, 3, 0, 3, 2, 2, 3, 5, 2, 5, 4],
        bends: Bends { influences: influences.collect(), ..Bends::default() },
        ..Primitive::default()
    };
    let joint = |node, y: f64| Joint {
        place: JointPlace::Node(node),
        inverse_bind: DAffine3::from_translation(DVec3::Y * -y),
    };
    let joints = vec![joint(0, 0.0), joint(1, 0.5)];
    add(&mut scene, strip, None, Some(Skin { joints, world: DVec3::ZERO, offset: DVec3::ZERO }));

    let lamp = square(Vec3::new(1.2, 1.6, -1.0), Vec3::X * 0.2, Vec3::Z * 0.2, 2);
    let far = [Vec3::new(-1.0, -0.3, 0.3), Vec3::new(-0.6, -0.3, 0.3)];
    let target = Target { positions: [far[0], far[1], far[1], far[0]].to_vec(), ..Target::default() };
    let lamp = Primitive { bends: Bends { targets: vec![target], ..Bends::default() }, ..lamp };
    scene.animation.morphs = vec![vec![track(0.0, 1.0)]];
    add(&mut scene, lamp, Some(0), None);
    scene.bend(None, |_| true);
    scene
}

fn render(renderer: &mut Renderer, settings: Settings, seed: u32) {
    renderer.render(camera(SIZE), &options(Work::Restir(settings), seed)).expect("the frame renders");
}

/// Where the strip's upper edge is after a quarter turn about the elbow: in the closed form.
#[test]
fn the_strip_bends_by_its_bones() {
    let mut scene = bending();
    assert!(scene.changes() && scene.pose(0.0).places.is_empty());
    scene.apply(&scene.pose(SECONDS.into()));
    let edge = scene.meshes[1].primitives[0].positions[4];
    assert!((edge - Vec3::new(-0.8, 0.5, 0.7)).length() < 1e-5, "{edge}");
    let corner = scene.meshes[2].primitives[0].positions[1];
    assert!((corner - Vec3::new(0.8, 1.3, -0.9)).length() < 1e-5, "{corner}");
}

/// What the device bends is what it has of a scene that was made bent: triangles, normals, lights.
#[test]
fn bent_scenes_are_those_made_so() {
    let Some(device) = device() else { return };
    let mut scene = bending();
    let mut bent = renderer(&device, &scene, SIZE, 1);
    let rest = reference(&mut bent, camera(SIZE), 1);
    let brightest = rest.iter().map(|c| c.max_element()).fold(0.0, f32::max);
    let apart = |a: &[Vec3], b: &[Vec3]| {
        a.iter().zip(b).filter(|(a, b)| (**a - **b).abs().max_element() > 1e-4 * brightest).count()
    };
    for time in [0.4, 3.0, 1.1] {
        pose(&mut bent, &mut scene, time);
        let found = reference(&mut bent, camera(SIZE), 1);
        let expected = reference(&mut renderer(&device, &scene, SIZE, 1), camera(SIZE), 1);
        assert_eq!(apart(&found, &expected), 0, "{time} s");
        // What a frame that is late would be.
        assert!(apart(&rest, &expected) > 20, "{time} s: the shape at rest was not told apart");
    }
    assert_no_validation_messages(&device);
}

/// Unbiased reuse has the mean of the last frame's reference, with a history from what things were like: its rays run among the
/// shapes of the past. Taking the past for the present has not.
#[test]
fn unbiased_reuse_is_right_where_things_bend() {
    let Some(device) = device() else { return };
    let mut scene = bending();
    let mut renderer = renderer(&device, &scene, SIZE, 1);
    let base = Settings {
        candidates: 8,
        radius: 8.0,
        spatial: 0,
        pixel_centers: 1,
        mode: mode::UNBIASED,
        ..Settings::default()
    };
    let run = |renderer: &mut Renderer, scene: &mut SceneDescription, settings: Settings| {
        replicas(REPLICAS, SIZE, |seed| {
            renderer.restart();
            for frame in 0..4 {
                pose(renderer, scene, f64::from(frame));
                render(renderer, settings, seed);
            }
            renderer.radiance().expect("the picture is read back")
        })
    };
    pose(&mut renderer, &mut scene, 3.0);
    let truth = replicas(REPLICAS, SIZE, |seed| reference(&mut renderer, camera(SIZE), 1000 + seed));
    for (name, settings) in [("temporal", base), ("temporal and spatial", Settings { spatial: 1, ..base })] {
        assert_means(name, &run(&mut renderer, &mut scene, settings), &truth, Z_LIMIT);
    }
    renderer.ignore_motion(true);
    let z = largest_z(&run(&mut renderer, &mut scene, base), &truth).0;
    println!("without a past: largest z {z:.2}");
    assert!(z > Z_LIMIT, "the past taken for the present was not seen: {z}");

    // Points that last, against the sum at those very points.
    renderer.ignore_motion(false);
    let lasting = Settings { spatial: 1, pixel_centers: 0, ..base };
    run(&mut renderer, &mut scene, lasting);
    let lights = renderer.scene().light_count();
    let truth = replicas(REPLICAS, SIZE, |seed| {
        let options = options(Work::Truth { lights }, 1000 + seed);
        renderer.render(camera(SIZE), &options).expect("the sum renders");
        renderer.radiance().expect("the picture is read back")
    });
    assert_means("points that last", &run(&mut renderer, &mut scene, lasting), &truth, Z_LIMIT);
    assert_no_validation_messages(&device);
}

/// Two hundred frames of it leave nothing behind, on the device or on the heap.
#[test]
fn memory_is_flat() {
    let Some(device) = device() else { return };
    let mut scene = bending();
    let mut renderer = renderer(&device, &scene, UVec2::new(16, 9), 1);
    let mut used = Vec::with_capacity(16);
    for frame in 0..220 {
        pose(&mut renderer, &mut scene, f64::from(frame % 20) * 0.15);
        let camera = camera(UVec2::new(16, 9));
        let options = options(Work::Restir(Settings::default()), frame);
        renderer.render(camera, &options).expect("the frame renders");
        if frame % 20 == 19 {
            used.push((device.memory_used(), HEAP.current_usage()));
        }
    }
    let [(device_first, heap_first), (device_last, heap_last)] = [used[0], used[used.len() - 1]];
    assert_eq!(device_first, device_last);
    // As in `soak.rs`.
    assert!(heap_last < heap_first + (16 << 10), "{heap_first} to {heap_last} bytes");
    assert!(renderer.radiance().expect("it is read back").iter().all(|c| c.is_finite()));
}
