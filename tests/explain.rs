//! `candela explain`: the CPU's replay of single pixels comes to what the GPU computed, and says so when it does not.

use candela::frame::rays;
use candela::frame::renderer::{FrameOptions, Renderer};
use candela::frame::schedule::{Primary, Work};
use candela::scene::{AlphaMode, Material, PointLight, Primitive, SceneDescription, gltf};
use candela::vulkan::Device;
use candela_lab::explain::record::{Merged, PassReport};
use candela_lab::explain::{Explanation, World, check_pixel, next_frame};
use glam::{UVec2, Vec3, Vec4};
use shared::camera::Camera;
use shared::frame::{Settings, mode};
use shared::resources::Resource;
use std::collections::HashMap;
use std::path::Path;
use tests::gpu::{assert_no_validation_messages, device, renderer};
use tests::scenes::{camera, emitter, scene, square};

/// A frame with these `settings`.
fn frame_options(settings: Settings) -> FrameOptions {
    FrameOptions::new(Work::Restir(settings), Primary::default(), 5)
}

const SIZE: UVec2 = UVec2::new(48, 32);
/// Shadow edges, penumbrae, open floor, the top of a screen.
const PIXELS: [UVec2; 6] = [
    UVec2::new(24, 16),
    UVec2::new(17, 11),
    UVec2::new(30, 20),
    UVec2::new(5, 27),
    UVec2::new(40, 8),
    UVec2::new(22, 23),
];
/// lavapipe divides and takes roots as the CPU does; it fuses some multiplications with additions and has its own sine, cosine
/// and powers of two. 2 ulp were seen at most; weights are single-signed sums and products, so half an ulp each does not grow.
const ULPS: u64 = 8;

/// Point lights and emitters over the floor, screens in between, one of them half transparent.
fn lit_screens() -> SceneDescription {
    let point = |i: i32| {
        let angle = i as f32 * 2.4;
        let position =
            Vec3::new(angle.cos() * 0.3 * i as f32, 1.0 + (i % 3) as f32, angle.sin() * 0.3 * i as f32);
        PointLight { position, intensity: Vec3::new(1.0, 0.8, 0.5) * 4f32.powi(i % 4), radius: 0.0 }
    };
    let emitters = (0..3).map(|i| {
        let center = Vec3::new(i as f32 - 1.0, 2.5, 0.3 * i as f32);
        Primitive {
            material: 1,
            positions: vec![center, center + Vec3::X * 0.5, center + Vec3::Z * 0.6],
            normals: vec![-Vec3::Y; 3],
            indices: vec![0, 1, 2],
            ..Primitive::default()
        }
    });
    let screens = [(-0.8, 0.6, 0.2, 0), (0.7, 0.4, 0.5, 2), (0.1, 0.8, -0.9, 3)]
        .map(|(x, y, z, material)| square(Vec3::new(x, y, z), Vec3::Z * 0.45, Vec3::X * 0.45, material));
    let glass = Material {
        base_color: Vec4::new(0.5, 0.5, 0.9, 0.5),
        alpha: AlphaMode::Blend,
        name: "glass".into(),
        ..Material::default()
    };
    let mesh = Material { alpha: AlphaMode::Mask { cutoff: 0.3 }, name: "mesh".into(), ..glass.clone() };
    scene(
        emitters.chain(screens).collect(),
        vec![emitter(Vec3::new(20.0, 30.0, 40.0)), glass, mesh],
        (0..12).map(point).collect(),
    )
}

fn cases() -> Vec<(&'static str, Settings)> {
    let base = Settings {
        candidates: 8,
        radius: 6.0,
        reservoirs: 2,
        spatial_iterations: 2,
        mode: mode::BIASED,
        pairs: 0,
        ..Settings::default()
    };
    let unbiased = Settings { mode: mode::UNBIASED, ..base };
    vec![
        ("biased", base),
        ("biased, tiles", Settings { tiles: 1, ..base }),
        ("unbiased", unbiased),
        ("unbiased, tiles", Settings { tiles: 1, ..unbiased }),
        ("unbiased, pairs", Settings { pairs: 1, ..unbiased }),
        ("unbiased, cells", Settings { cells: 1, ..unbiased }),
        ("unbiased, no visibility reuse", Settings { visibility_reuse: 0, ..unbiased }),
    ]
}

fn lit_renderer(device: &Device) -> Renderer {
    renderer(device, &lit_screens(), SIZE, 2)
}

/// Explains frame 2 of the scene at each of `pixels`; `told` is what the replay takes for the scene.
fn explain(
    renderer: &mut Renderer,
    told: &SceneDescription,
    settings: Settings,
    camera: Camera,
    pixels: &[UVec2],
) -> Vec<Explanation> {
    let world = World::new(told).expect("the scene fits");
    let options = frame_options(settings);
    let explanations = pixels.iter().map(|&pixel| {
        renderer.restart();
        for _ in 0..2 {
            renderer.render(camera, &options).expect("the frame renders");
        }
        let (recorder, history) = renderer.parts();
        next_frame(recorder, history, &world, camera, &options, pixel).expect("the frame is explained")
    });
    explanations.collect()
}

#[test]
fn the_replay_comes_to_the_gpus_result() {
    let Some(device) = device() else { return };
    let mut renderer = lit_renderer(&device);
    for (name, settings) in cases() {
        let explanations = explain(&mut renderer, &lit_screens(), settings, camera(SIZE), &PIXELS);
        for e in &explanations {
            println!("{name}, {:?}: {}", e.pixel, e.verdict());
            assert_same(name, e);
        }
        if name == "unbiased" {
            assert_telling(&explanations);
        }
    }
    assert_no_validation_messages(&device);
}

/// Screens that slide and lights that swing, under a camera that moves: the history is looked up where things were, among
/// what hid them then. Negative control: a replay that takes the past for the present differs.
#[test]
fn the_replay_follows_what_moves() {
    let Some(device) = device() else { return };
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/scenes/moving.glb");
    let rest = gltf::load(&path).expect("the fixture loads");
    let (mut histories, mut rays, mut wrong) = (0, 0, 0);
    for (name, settings) in cases() {
        let ways: &[bool] = if name == "unbiased" { &[true, false] } else { &[true] };
        for &follows in ways {
            for e in explain_moving(&device, &rest, settings, follows) {
                if follows {
                    println!("{name}, {:?}: {}", e.pixel, e.verdict());
                    assert!(
                        e.is_explained() && e.worst_ulps() <= ULPS,
                        "{name}: {} ulp\n{e}",
                        e.worst_ulps()
                    );
                    assert_eq!(e.disagreeing_rays(), 0, "{name}:\n{e}");
                    let temporal = || e.passes.iter().filter(|pass| pass.pass.starts_with("temporal"));
                    histories +=
                        temporal().flat_map(|pass| &pass.others).filter(|o| o.merged.is_some()).count();
                    rays += temporal().flat_map(|pass| &pass.rays).count();
                } else {
                    wrong += usize::from(!e.is_explained() || e.disagreeing_rays() > 0);
                }
            }
        }
    }
    assert!(histories > 20 && rays > 5, "{histories} histories, {rays} rays: too few to tell");
    assert!(wrong > 0, "the planted error was not seen: {wrong}");
    assert_no_validation_messages(&device);
}

/// Frame 5 of the scene in motion. Not `follows`: the replay's things move, but its past is its present.
fn explain_moving(
    device: &Device,
    rest: &SceneDescription,
    settings: Settings,
    follows: bool,
) -> Vec<Explanation> {
    let options = frame_options(settings);
    let mut renderer = renderer(device, rest, SIZE, settings.reservoirs);
    let explanations = PIXELS.iter().map(|&pixel| {
        let (mut scene, mut world) = (rest.clone(), World::new(rest).expect("the scene fits"));
        renderer.restart();
        let mut set = |frame: u32, renderer: &mut Renderer, world: &mut World<'_>| {
            let pose = scene.pose(0.2 + f64::from(frame) / 24.0);
            scene.apply(&pose);
            renderer.update_scene(&scene, &pose).expect("the scene moves");
            world.follow(&scene, &pose);
            if !follows {
                world.follow(&scene, &pose);
            }
            let view = &scene.cameras[0];
            Camera::new(view.position, view.forward, view.up, view.fov_y, SIZE)
        };
        for frame in 0..5 {
            let camera = set(frame, &mut renderer, &mut world);
            renderer.render(camera, &options).expect("the frame renders");
        }
        let camera = set(5, &mut renderer, &mut world);
        let (recorder, history) = renderer.parts();
        next_frame(recorder, history, &world, camera, &options, pixel).expect("the frame is explained")
    });
    explanations.collect()
}

/// Same survivors, the same numbers but for `ULPS`.
fn assert_same(name: &str, e: &Explanation) {
    // Two reservoirs: initial, temporal, two times spatial.
    assert_eq!(e.passes.len(), 8, "{name}");
    assert!(e.shading.is_some() && e.radiance.iter().all(|c| c.is_finite()));
    assert_eq!(e.disagreeing_rays(), 0, "{name}:\n{e}");
    for pass in &e.passes {
        assert_eq!(pass.cpu.light, pass.gpu.light, "{name}:\n{e}");
        assert!(pass.difference.is_rounding(), "{name}:\n{e}");
        if let Some(tile) = &pass.tile {
            assert_eq!(tile.equal_entries, 8, "{name}:\n{e}");
        }
    }
    assert!(e.is_explained() && e.worst_ulps() <= ULPS, "{name}: {} ulp\n{e}", e.worst_ulps());
    let distance_ulps = e.surface.as_ref().and_then(|surface| surface.distance_ulps);
    assert!(distance_ulps.is_some_and(|ulps| ulps <= ULPS), "{name}:\n{e}");
}

/// All that a frame does is told, as text and as JSON.
fn assert_telling(explanations: &[Explanation]) {
    let all = explanations.iter().map(Explanation::to_string).collect::<Vec<_>>().join("\n");
    for word in [
        "initial, reservoir 1",
        "spatial_traced 1",
        "not merged",
        "hidden at t",
        "material 'glass'",
        "visible",
        "p̂",
        " ?",
        "BSDF ray",
        "bsdf ",
    ] {
        assert!(all.contains(word), "no '{word}' in\n{all}");
    }
    let passes = || explanations.iter().flat_map(|e| &e.passes);
    assert!(passes().any(|pass| pass.candidates.iter().any(|c| c.chosen)));
    assert!(
        passes()
            .any(|pass| pass.others.iter().any(|other| other.pending.is_some_and(|pending| pending > 0.0)))
    );
    let merged = |pass: &PassReport| {
        pass.canonical.iter().chain(pass.others.iter().filter_map(|o| o.merged.as_ref())).cloned().collect()
    };
    let merged: Vec<Merged> = passes().flat_map::<Vec<Merged>, _>(merged).collect();
    assert!(merged.len() > 20 && merged.iter().all(|m| (0.0..=1.0 + 1e-5).contains(&m.mis_weight)));
    let json = serde_json::to_value(&explanations[0]).expect("all of it is data");
    assert_eq!((json["pixel"][0].as_u64(), json["mode"].as_str()), (Some(24), Some("unbiased")));
    assert!(json["passes"][0]["candidates"][0]["source_pdf"].as_f64().is_some_and(|p| p > 0.0));
}

/// The most rays of a frame is no less than the replay traces at any pixel, and each pass comes to its part of it somewhere:
/// one less would be too few.
#[test]
fn no_pixel_traces_more_rays_than_announced() {
    let Some(device) = device() else { return };
    let mut renderer = lit_renderer(&device);
    let features = renderer.scene().features();
    let (scene, now) = (lit_screens(), camera(SIZE));
    let world = World::new(&scene).expect("the scene fits");
    // From elsewhere: what was visible there need not be here.
    let before = Camera { position: now.position + Vec3::X * 0.05, ..now };
    for (name, settings) in cases() {
        // Every pixel has another point than before.
        let settings = Settings { pixel_centers: 1, ..settings };
        let most = rays::most(&settings, Primary::default().draws(&device), features);
        let options = frame_options(settings);
        let explanations = PIXELS.map(|pixel| {
            renderer.restart();
            for _ in 0..2 {
                renderer.render(before, &options).expect("the frame renders");
            }
            let (recorder, history) = renderer.parts();
            next_frame(recorder, history, &world, now, &options, pixel).expect("the frame is explained")
        });
        // Of a pass over one reservoir, of any.
        let mut reached: HashMap<&str, usize> = HashMap::new();
        let mut passes = Vec::new();
        for e in &explanations {
            let shading = e.shading.iter().map(|shading| ("shade", shading.rays.len()));
            // What the partner traces is told too.
            let own =
                |p: &PassReport| p.rays.iter().filter(|r| !r.purpose.contains("the partner to")).count();
            let of_pass = |p: &PassReport| (p.pass, own(p) + p.bsdf_rays.len());
            let rays: Vec<_> = e.passes.iter().map(of_pass).chain(shading).collect();
            let all: usize = rays.iter().map(|(_, rays)| rays).sum();
            // The eye has no ray: what it sees is drawn.
            assert!(all as u64 <= most, "{name}: {rays:?} of {most}");
            for &(pass, rays) in &rays {
                reached.entry(pass).and_modify(|most| *most = rays.max(*most)).or_insert(rays);
            }
            passes = rays.into_iter().map(|(pass, _)| pass).collect();
        }
        let all: usize = passes.iter().map(|pass| reached[pass]).sum();
        assert_eq!(all as u64, most, "{name}: {reached:?}");
    }
}

/// Where the camera has moved: pixels that kept their points, and those that are listed because they have new ones.
#[test]
fn the_replay_follows_a_camera() {
    let Some(device) = device() else { return };
    let mut renderer = lit_renderer(&device);
    let (scene, now) = (lit_screens(), camera(SIZE));
    let world = World::new(&scene).expect("the scene fits");
    let before = Camera { position: now.position + Vec3::new(0.1, 0.05, 0.2), ..now };
    let options = frame_options(Settings { candidates: 8, ..Settings::default() });
    let start = |renderer: &mut Renderer| {
        renderer.restart();
        (0..2).for_each(|_| drop(renderer.render(before, &options).expect("the frame renders")));
    };
    start(&mut renderer);
    renderer.render(now, &options).expect("the frame renders");
    let hops: Vec<u32> = renderer.read(Resource::hops).expect("the list is read back");
    let new: Vec<UVec2> =
        hops[1..][..hops[0] as usize].iter().map(|p| UVec2::new(p & 0xffff, p >> 16)).collect();
    let all = SIZE.element_product() as usize;
    assert!((10..all / 2).contains(&new.len()), "{} of {all} points are new", new.len());
    let kept = (0..SIZE.x).map(|x| UVec2::new(x, SIZE.y / 2)).filter(|pixel| !new.contains(pixel)).take(6);
    let mut merged = [0, 0];
    for pixel in new.iter().copied().step_by(new.len() / 10).chain(kept) {
        start(&mut renderer);
        let (recorder, history) = renderer.parts();
        let e = next_frame(recorder, history, &world, now, &options, pixel).expect("the frame is explained");
        let is_new = new.contains(&pixel);
        for pass in &e.passes {
            assert!(
                pass.difference.is_rounding(),
                "{pixel}, new: {is_new}, {}: {:?}",
                pass.pass,
                pass.difference
            );
            let temporal = if is_new { "temporal_hops" } else { "temporal" };
            merged[usize::from(is_new)] += usize::from(pass.pass == temporal && pass.canonical.is_some());
        }
    }
    assert!(merged[0] > 2 && merged[1] > 2, "{merged:?} have a history");
}

/// Negative controls: a replay of another scene is noticed, and of which kind the difference is.
#[test]
fn planted_differences_are_seen() {
    let Some(device) = device() else { return };
    let mut renderer = lit_renderer(&device);
    let settings = cases()[2].1;
    let mut told = |scene: &SceneDescription| explain(&mut renderer, scene, settings, camera(SIZE), &PIXELS);
    let mut dimmed = lit_screens();
    dimmed.lights.iter_mut().for_each(|light| *light.emission_mut() *= 0.999);
    assert!(told(&dimmed).iter().any(|e| !e.is_explained()), "0.1 % less light was not seen");
    let mut other_order = lit_screens();
    other_order.lights.swap(3, 7);
    assert!(
        told(&other_order).iter().any(|e| e.verdict().contains("DIFFERS")),
        "swapped lights were not seen"
    );
    let mut open = lit_screens();
    open.meshes[0].primitives.truncate(4);
    let flipped: usize = told(&open).iter().map(Explanation::disagreeing_rays).sum();
    assert!(flipped > 0, "no ray of the GPU was blocked by the screens that the CPU does not have");

    let up = Camera::new(Vec3::Y, Vec3::Y, Vec3::Z, 0.3, SIZE);
    let nothing = &explain(&mut renderer, &lit_screens(), settings, up, &[UVec2::ZERO])[0];
    assert!(nothing.surface.is_none() && nothing.passes.is_empty() && nothing.shading.is_none());
    let text = nothing.to_string();
    assert!(text.contains("sees      nothing") && text.contains("nothing to light"), "{text}");
}

/// Refused before anything is loaded, in one line.
#[test]
fn pixels_outside_the_picture_are_refused() {
    for (x, y) in [(64, 0), (0, 48), (4_000_000_000, 4_000_000_000)] {
        let error = check_pixel(UVec2::new(x, y), UVec2::new(64, 48)).unwrap_err().to_string();
        assert!(error.contains("outside the picture of 64x48") && error.lines().count() == 1, "{error}");
    }
}
