//! Primary visibility by the graphics pipeline and by rays, against an oracle that asks every triangle in f64.
//!
//! Where a pixel's center is not within 1/128 pixel of an edge, and no two surfaces are nearer together than 1e-4 of their
//! distance, the triangle that is seen must be the oracle's. Elsewhere it must be one of those that meet there.

use candela::frame::renderer::{FrameOptions, Renderer};
use candela::frame::schedule::{Primary, Work};
use candela::scene::animation::{Channel, Curve, Interpolation, Local, Node, Thing, Track};
use candela::scene::{
    self, AlphaMode, Illumination, Instance, Material, Mesh, Primitive, SceneDescription, SceneSource,
};
use glam::{Affine3A, DAffine3, DQuat, DVec3, Quat, UVec2, Vec3, Vec3A, Vec4};
use shared::alpha::primary_key;
use shared::camera::Camera;
use shared::frame::{FrameConstants, Settings};
use shared::math::CENTER;
use shared::raster::triangle;
use shared::resources::Resource;
use shared::surface::GBufferTexel;
use tests::gpu::{assert_no_validation_messages, device, renderer};
use tests::primary::{Candidate, Oracle, Planted, possible};
use tests::scenes::{pane, scene, square};

const SIZE: UVec2 = UVec2::new(96, 64);
const SEED: u32 = 3;

/// What pixels show: instance, triangle (where that is known), and the G-buffer.
struct Seen {
    gbuffer: Vec<GBufferTexel>,
    triangles: Vec<Option<(u32, u32)>>,
}

fn see(renderer: &mut Renderer, camera: Camera, primary: Primary) -> Seen {
    renderer.restart();
    let options = FrameOptions::new(Work::Reference { lights: 0 }, primary, SEED);
    renderer.render(camera, &options).expect("the frame renders");
    let gbuffer = renderer.gbuffer().expect("it is read back");
    let triangles = match primary {
        Primary::Raster => {
            let stored: Vec<UVec2> = renderer.read(Resource::visibility).expect("it is read back");
            stored.into_iter().map(triangle).collect()
        }
        _ => vec![None; gbuffer.len()],
    };
    Seen { gbuffer, triangles }
}

/// The key of the stochastic alpha of a pixel's primary ray in frame 0.
fn alpha_key(pixel: UVec2) -> u32 {
    let camera = look(Vec3::ZERO, Vec3::X, 1.0);
    let frame = FrameConstants {
        place: CENTER,
        camera,
        previous_camera: camera,
        size: SIZE,
        index: 0,
        seed: SEED,
        settings: Settings::default(),
        exposure: 1.0,
        background: Vec3::ZERO,
        environment_size: UVec2::ZERO,
        first_environment_light: 0,
        tree_lights: 0,
    };
    primary_key(&frame, pixel)
}

/// Pixels that show what they may not, and pixels where the oracle leaves a choice.
#[derive(Clone, Copy, Debug, Default)]
struct Verdict {
    wrong: usize,
    open: usize,
    covered: usize,
}

fn judge(seen: &Seen, oracle: &Oracle, camera: Camera) -> Verdict {
    let mut verdict = Verdict::default();
    for i in 0..SIZE.element_product() {
        let pixel = UVec2::new(i % SIZE.x, i / SIZE.x);
        let candidates = oracle.candidates(pixel, alpha_key(pixel));
        let (shown, background) = possible(&candidates);
        verdict.open += usize::from(shown.len() + usize::from(background) != 1);
        let texel = seen.gbuffer[i as usize];
        if texel.is_empty() {
            verdict.wrong += usize::from(!background);
            continue;
        }
        verdict.covered += 1;
        let fits = |c: &Candidate| {
            let named = match seen.triangles[i as usize] {
                Some(named) => named == (c.instance, c.primitive),
                None => true,
            };
            named && c.instance == texel.instance() && is_at(c, texel.distance(), camera)
        };
        verdict.wrong += usize::from(!shown.iter().any(fits));
    }
    verdict
}

/// Is a surface at `distance` from the eye the candidate's, but for what f32 leaves of it? Positions of the world are rounded
/// to ulp of their size.
fn is_at(c: &Candidate, distance: f32, camera: Camera) -> bool {
    let [least, most] = c.distance;
    let size = most + f64::from(camera.position.abs().max_element());
    let tolerance = 16.0 * f64::from(f32::EPSILON) * size / c.cosine.max(1e-3);
    (least - tolerance..=most + tolerance).contains(&f64::from(distance))
}

struct Case {
    name: &'static str,
    scene: SceneDescription,
    camera: Camera,
    /// Errors that this scene shows when they are planted in the oracle.
    planted: &'static [Planted],
    /// Largest share of pixels where there is a choice.
    open: f64,
    /// Rays are held against the oracle too.
    rays: bool,
}

fn look(eye: Vec3, at: Vec3, fov_y: f32) -> Camera {
    Camera::new(eye, at - eye, Vec3::Y, fov_y, SIZE)
}

fn loaded(source: SceneSource) -> (SceneDescription, Camera) {
    let scene = scene::load(&source, &Illumination::points(4)).expect("the scene loads");
    let view = scene.cameras[0].clone();
    let camera = Camera::new(view.position, view.forward, view.up, view.fov_y, SIZE);
    (scene, camera)
}

/// A tetrahedron whose faces look outwards, lopsided.
fn tetrahedron(material: usize) -> Primitive {
    let p = [
        Vec3::new(-0.4, 0.0, -0.3),
        Vec3::new(0.5, 0.0, -0.2),
        Vec3::new(0.0, 0.0, 0.6),
        Vec3::new(0.1, 0.9, 0.0),
    ];
    let faces = [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]];
    let corners = faces.iter().flatten().map(|&i| p[i]);
    Primitive {
        material,
        positions: corners.clone().collect(),
        normals: vec![Vec3::Y; 12],
        indices: (0..12).collect(),
        ..Primitive::default()
    }
}

/// Tetrahedra, plain, stretched, mirrored once, twice and thrice, squeezed to a line and to a point; one open box of
/// squares that is seen from behind, one from behind and double-sided.
fn mirrors() -> SceneDescription {
    let double = Material { double_sided: true, ..Material::default() };
    let mut scene = scene(vec![], vec![Material::default(), double], vec![]);
    let wall = |material| square(Vec3::new(0.0, 0.5, 0.0), Vec3::Y * 0.5, Vec3::X * 0.4, material);
    let meshes = [vec![tetrahedron(1)], vec![wall(1)], vec![wall(2)], vec![tetrahedron(1), wall(2)]];
    for primitives in meshes {
        scene.meshes.push(Mesh { name: String::new(), primitives });
    }
    let scales = [
        Vec3::ONE,
        Vec3::new(-1.0, 1.0, 1.0),
        Vec3::new(-0.7, -1.3, 1.0),
        Vec3::new(-1.0, -1.0, -1.0),
        Vec3::new(1.0, 0.3, 1.5),
        Vec3::new(1.0, 0.0, 0.0),
        Vec3::ZERO,
        Vec3::new(1.0, 1.0, -1.2),
    ];
    for (i, scale) in scales.into_iter().enumerate() {
        for mesh in 1..=4 {
            let place = Vec3::new(1.1 * (i as f32 - 3.5), 1.0 - scale.y.min(0.0), 1.5 - 1.3 * mesh as f32);
            let turn = Quat::from_rotation_y(0.3 * i as f32 - 0.9 + 0.2 * mesh as f32);
            let transform = Affine3A::from_scale_rotation_translation(scale, turn, place);
            scene.instances.push(Instance { name: String::new(), mesh, transform });
        }
    }
    scene
}

/// Panes over panes: half transparent, and masked by their corners' colors.
fn panes() -> SceneDescription {
    let mask = Material { alpha: AlphaMode::Mask { cutoff: 0.4 }, ..Material::default() };
    let single = Material { double_sided: false, ..pane() };
    let at =
        |x: f32, y: f32, material| square(Vec3::new(x, y, 0.3 * x), Vec3::Z * 0.9, Vec3::X * 0.8, material);
    let masked = Primitive {
        colors: vec![Vec4::ONE, Vec4::new(1.0, 1.0, 1.0, 0.0), Vec4::ONE, Vec4::new(1.0, 1.0, 1.0, 0.2)],
        ..at(1.2, 1.1, 2)
    };
    let below = square(Vec3::new(-1.5, 0.8, -0.9), Vec3::X * 0.7, Vec3::Z * 0.7, 3);
    scene(
        vec![at(-1.0, 0.5, 1), at(-0.6, 1.0, 1), at(0.2, 1.6, 3), masked, below],
        vec![pane(), mask, single],
        vec![],
    )
}

/// A camera in a room whose floor and walls go on behind it, with a speck before the lens, 20 µm away.
fn room() -> SceneDescription {
    let ceiling = square(Vec3::new(0.0, 2.0, 0.0), Vec3::X * 6.0, Vec3::Z * 6.0, 0);
    let wall = square(Vec3::new(-0.3, 1.0, 0.0), Vec3::Y * 9.0, Vec3::Z * 9.0, 0);
    let speck = square(Vec3::new(0.0, 1.0, 0.2 - 2e-5), Vec3::X * 1e-5, Vec3::Y * 3e-5, 0);
    scene(vec![ceiling, wall, speck], vec![], vec![])
}

fn cases() -> Vec<Case> {
    const FACINGS: &[Planted] = &[Planted::HalfPixel, Planted::NoCulling, Planted::Unturned];
    const PLACES: &[Planted] = &[Planted::HalfPixel];
    let (atrium, in_atrium) = loaded(SceneSource::Atrium);
    let (knot, before_knot) = loaded(SceneSource::Knot);
    let mut far = mirrors();
    let shift = Vec3::new(3e4, -2e4, 5e4);
    far.instances.iter_mut().for_each(|i| i.transform.translation += Vec3A::from(shift));
    let (eye, at) = (Vec3::new(0.3, 2.6, 5.5), Vec3::new(0.0, 0.9, 0.0));
    let case = |name, scene, camera, planted, open| Case { name, scene, camera, planted, open, rays: true };
    let above = look(Vec3::new(0.0, 4.0, 2.5), Vec3::ZERO, 0.8);
    let inside = look(Vec3::new(0.0, 1.0, 0.2), Vec3::new(0.2, 0.9, -1.0), 1.2);
    vec![
        case("atrium", atrium, in_atrium, PLACES, 0.2),
        case("knot", knot, before_knot, PLACES, 0.12),
        case("mirrors", mirrors(), look(eye, at, 0.9), FACINGS, 0.03),
        case("mirrors from behind", mirrors(), look(Vec3::new(-1.0, 1.7, -6.0), at, 0.9), FACINGS, 0.03),
        // Rays are set off in single precision far away, and are not that exact.
        Case { rays: false, ..case("far", far, look(eye + shift, at + shift, 0.9), FACINGS, 0.03) },
        case("panes", panes(), above, &[Planted::Opaque, Planted::HalfPixel], 0.03),
        case("room", room(), inside, PLACES, 0.03),
    ]
}

#[test]
fn pixels_show_the_triangles_that_f64_finds() {
    let Some(device) = device() else { return };
    let pixels = SIZE.element_product() as usize;
    for Case { name, scene, camera, planted, open, rays } in cases() {
        let mut renderer = renderer(&device, &scene, SIZE, 1);
        let oracle = |planted| Oracle::new(&scene, camera, SIZE, planted);
        let right = oracle(Planted::Nothing);
        for primary in [Primary::Raster, Primary::Rays] {
            if primary == Primary::Rays && !rays {
                continue;
            }
            let seen = see(&mut renderer, camera, primary);
            let verdict = judge(&seen, &right, camera);
            println!("{name}, {primary:?}: {verdict:?}");
            assert_eq!(verdict.wrong, 0, "{name}, {primary:?}: {verdict:?}");
            assert!(verdict.covered > pixels / 4, "{name}: {verdict:?}");
            assert!((verdict.open as f64) < open * pixels as f64, "{name}: {verdict:?}");
            for &error in planted {
                let verdict = judge(&seen, &oracle(error), camera);
                println!("{name}, {primary:?}, planted {error:?}: {verdict:?}");
                assert!(verdict.wrong > 20, "{name}, {primary:?}: {error:?} was not seen: {verdict:?}");
            }
        }
    }
    assert_no_validation_messages(&device);
}

/// Where the oracle leaves no choice, both ways fill the G-buffer and the radiance alike.
#[test]
fn surfaces_are_those_of_rays() {
    let Some(device) = device() else { return };
    for Case { name, scene, camera, .. } in cases().into_iter().filter(|case| case.rays) {
        let mut renderer = renderer(&device, &scene, SIZE, 1);
        let oracle = Oracle::new(&scene, camera, SIZE, Planted::Nothing);
        let [raster, rays] = [Primary::Raster, Primary::Rays].map(|primary| {
            let seen = see(&mut renderer, camera, primary);
            (seen.gbuffer, renderer.radiance().expect("it is read back"))
        });
        let clear = |i: &u32| {
            let pixel = UVec2::new(i % SIZE.x, i / SIZE.x);
            let (shown, background) = possible(&oracle.candidates(pixel, alpha_key(pixel)));
            shown.len() + usize::from(background) == 1
        };
        for i in (0..SIZE.element_product()).filter(clear) {
            let [(a, light_a), (b, light_b)] =
                [&raster, &rays].map(|(gbuffer, radiance)| (gbuffer[i as usize], radiance[i as usize]));
            let [off, turned] = [a.normal() - b.normal(), a.geometric_normal() - b.geometric_normal()];
            let colors = (a.diffuse() - b.diffuse()).abs() + (a.f0() - b.f0()).abs();
            let rough = (a.roughness() - b.roughness()).abs();
            let light = (light_a - light_b).abs().max_element();
            assert_eq!(a.is_empty(), b.is_empty(), "{name}, pixel {i}");
            assert!(off.length().max(turned.length()) < 2e-3, "{name}, pixel {i}: {off} {turned}");
            assert!(colors.max_element().max(rough) < 4e-3, "{name}, pixel {i}: {colors} {rough}");
            assert!(light <= 4e-3 * light_b.max_element(), "{name}, pixel {i}: {light_a} {light_b}");
        }
    }
    assert_no_validation_messages(&device);
}

/// An instance that an animation turns inside out: its draws stay, and its front follows.
#[test]
fn things_that_move_are_drawn_where_they_are() {
    let Some(device) = device() else { return };
    let mut scene = scene(vec![], vec![Material::default()], vec![]);
    scene.meshes.push(Mesh { name: String::new(), primitives: vec![tetrahedron(1)] });
    scene.instances.push(Instance { name: String::new(), mesh: 1, transform: Affine3A::IDENTITY });
    let rest = Local::Trs { translation: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: DVec3::ONE };
    scene.animation.nodes = vec![Node { parent: None, base: DAffine3::IDENTITY, rest }];
    scene.animation.attached = vec![(Thing::Instance(1), 0)];
    let line = |from, to| Track {
        interpolation: Interpolation::Linear,
        times: vec![0.0, 2.0],
        values: vec![from, to],
    };
    scene.animation.channels = vec![
        Channel { node: 0, curve: Curve::Scale(line(DVec3::ONE, DVec3::new(-1.0, 1.0, 1.0))) },
        Channel { node: 0, curve: Curve::Translation(line(DVec3::ZERO, DVec3::new(0.5, 0.2, 1.0))) },
    ];
    let camera = look(Vec3::new(0.2, 1.5, 3.0), Vec3::new(0.2, 0.4, 0.0), 0.7);
    let mut renderer = renderer(&device, &scene, SIZE, 1);
    let mut seen = see(&mut renderer, camera, Primary::Raster);
    for time in [0.5, 2.0] {
        let pose = scene.pose(time);
        scene.apply(&pose);
        let oracle = Oracle::new(&scene, camera, SIZE, Planted::Nothing);
        let before = judge(&seen, &oracle, camera);
        assert!(before.wrong > 20, "the planted error, a frame that is late, was not seen: {before:?}");
        renderer.update_scene(&scene, &pose).expect("the scene moves");
        seen = see(&mut renderer, camera, Primary::Raster);
        let verdict = judge(&seen, &oracle, camera);
        assert!(verdict.wrong == 0 && verdict.covered > 1000, "{time} s: {verdict:?}");
    }
    assert_no_validation_messages(&device);
}
