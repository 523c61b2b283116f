//! ReSTIR against the reference on the device, over independent runs of the whole frame sequence.
//!
//! The mean of every 8 x 8 block must be the reference's: for the biased 1/M weights where nothing stands between lights and
//! floor and every light reaches every pixel, for the unbiased mode everywhere.

use candela::scene::{DirectionalLight, Environment, PointLight, Primitive, SceneDescription, SpotLight};
use glam::{UVec2, Vec3};
use shared::frame::{Settings, mode};
use tests::gpu::{assert_no_validation_messages, device, reference, renderer, restir};
use tests::scenes::{camera, emitter, scene, square};
use tests::statistics::{block_means, largest_z, mean_and_error};

const SIZE: UVec2 = UVec2::new(64, 48);
const REPLICAS: u32 = 48;
/// Over 48 blocks with Student's t of 47 degrees of freedom: a false alarm in 1e-4 of all runs a case (Sidak).
const Z_LIMIT: f64 = 5.9;

/// As [`many_lights`], with three squares in between: shadows everywhere, and pixels that see them from above.
fn occluded_lights() -> SceneDescription {
    let mut open = many_lights();
    let squares = [(-0.8, 0.6, 0.2), (0.7, 0.4, 0.5), (0.1, 0.8, -0.9)].map(|(x, y, z)| {
        let mut square = square(Vec3::new(x, y, z), Vec3::Z * 0.45, Vec3::X * 0.45, 0);
        square.material = 0;
        square
    });
    open.meshes[0].primitives.extend(squares);
    open
}

/// Point lights under emissive triangles that face the floor; strengths over four orders of magnitude.
fn many_lights() -> SceneDescription {
    let strength = |i: i32| 10f32.powi(i % 5 - 2);
    let lights = (0..20)
        .map(|i| {
            let angle = i as f32 * 2.4;
            let radius = 0.25 * i as f32;
            let position = Vec3::new(radius * angle.cos(), 1.0 + (i % 3) as f32 * 0.5, radius * angle.sin());
            PointLight { position, intensity: Vec3::new(1.0, 0.8, 0.5) * 5.0 * strength(i) }
        })
        .collect();
    let triangles = (0..6).map(|i| {
        let center = Vec3::new(i as f32 - 2.5, 3.0, (i % 2) as f32 - 1.0);
        Primitive {
            material: 1 + i as usize % 2,
            // Counter-clockwise from below.
            positions: vec![center, center + Vec3::X * 0.6, center + Vec3::Z * 0.7],
            normals: vec![-Vec3::Y; 3],
            indices: vec![0, 1, 2],
            ..Primitive::default()
        }
    });
    scene(triangles.collect(), vec![emitter(Vec3::splat(40.0)), emitter(Vec3::new(0.1, 0.5, 2.0))], lights)
}

/// Spots of unequal strength whose cones reach every pixel: all supports agree.
fn spots() -> SceneDescription {
    let spot = |i: i32| {
        let (x, z) = ((i % 3) as f32 - 1.0, (i / 3) as f32 - 1.0);
        SpotLight {
            position: Vec3::new(2.0 * x, 2.5, 2.0 * z),
            axis: Vec3::new(0.2 * z, -1.0, 0.1 * x).normalize(),
            intensity: Vec3::new(0.3, 0.8, 1.0) * 3f32.powi(i % 4),
            inner_angle: 0.1 * i as f32,
            outer_angle: 1.35,
        }
    };
    SceneDescription { spot_lights: (0..9).map(spot).collect(), ..scene(vec![], vec![], vec![]) }
}

fn suns() -> SceneDescription {
    let sun = |i: i32| DirectionalLight {
        direction: Vec3::new(i as f32 - 2.0, 2.0, (i % 2) as f32).normalize(),
        illuminance: Vec3::new(1.0, 0.9, 0.7) * 4f32.powi(i % 3),
    };
    SceneDescription { directional_lights: (0..5).map(sun).collect(), ..scene(vec![], vec![], vec![]) }
}

/// A sky with a bright spot; black below the horizon, where no pixel could be lit from.
fn sky() -> SceneDescription {
    let size = UVec2::new(16, 8);
    let radiance = |i: u32| match (i % 16, i / 16) {
        (5, 2) => Vec3::new(300.0, 200.0, 100.0),
        (x, y @ 0..4) => Vec3::new(1.0, 2.0, 3.0) * (1 + x % 3 + y) as f32,
        _ => Vec3::ZERO,
    };
    let environment = Some(Environment { size, radiance: (0..128).map(radiance).collect() });
    SceneDescription { environment, ..scene(vec![], vec![], vec![]) }
}

/// Every kind alone, and all of them together.
fn kinds() -> Vec<(&'static str, SceneDescription)> {
    let SceneDescription { spot_lights, .. } = spots();
    let SceneDescription { directional_lights, .. } = suns();
    let SceneDescription { environment, .. } = sky();
    let together = SceneDescription { spot_lights, directional_lights, environment, ..many_lights() };
    let triangles = SceneDescription { point_lights: vec![], ..many_lights() };
    let mut points = many_lights();
    points.meshes[0].primitives.truncate(1);
    vec![
        ("points", points),
        ("triangles", triangles),
        ("spots", spots()),
        ("suns", suns()),
        ("sky", sky()),
        ("together", together),
    ]
}

fn cases() -> Vec<(&'static str, Settings, u32)> {
    let base = Settings { candidates: 8, radius: 8.0, temporal: 0, spatial: 0, ..Settings::default() };
    vec![
        ("RIS", base, 1),
        (
            "RIS, two reservoirs, no visibility reuse",
            Settings { reservoirs: 2, visibility_reuse: 0, ..base },
            1,
        ),
        ("spatial", Settings { spatial: 1, ..base }, 1),
        ("temporal", Settings { temporal: 1, ..base }, 4),
        ("temporal and spatial", Settings { temporal: 1, spatial: 1, ..base }, 4),
        ("tiles", Settings { tiles: 1, ..base }, 1),
        ("tiles, temporal and spatial", Settings { tiles: 1, temporal: 1, spatial: 1, ..base }, 4),
    ]
}

/// Every combination of reuse in the mode that must be right among shadows, with and without visibility reuse.
fn unbiased_cases() -> Vec<(&'static str, Settings, u32)> {
    let base =
        Settings { candidates: 8, radius: 8.0, temporal: 0, mode: mode::UNBIASED, ..Settings::default() };
    let temporal = Settings { temporal: 1, spatial: 0, ..base };
    vec![
        ("unbiased spatial", base, 1),
        ("unbiased spatial without visibility reuse", Settings { visibility_reuse: 0, ..base }, 1),
        ("unbiased temporal", temporal, 4),
        ("unbiased temporal without visibility reuse", Settings { visibility_reuse: 0, ..temporal }, 4),
        ("unbiased temporal and spatial, two reservoirs", Settings { temporal: 1, reservoirs: 2, ..base }, 4),
        ("unbiased, tiles", Settings { temporal: 1, tiles: 1, ..base }, 4),
    ]
}

fn replicas(run: impl FnMut(u32) -> Vec<Vec3>) -> Vec<(f64, f64)> {
    let samples: Vec<_> = (1..=REPLICAS).map(run).map(|image| block_means(&image, SIZE)).collect();
    mean_and_error(&samples)
}

#[test]
fn reuse_has_the_mean_of_the_reference() {
    let Some(device) = device() else { return };
    let camera = camera(SIZE);
    let mut renderer = renderer(&device, &many_lights(), SIZE, 2);
    let truth = replicas(|seed| reference(&mut renderer, camera, 1000 + seed));
    for (name, settings, frames) in cases() {
        let means = replicas(|seed| restir(&mut renderer, camera, settings, frames, seed));
        let (z, block) = largest_z(&means, &truth);
        println!("{name}: largest z {z:.2} in block {block}");
        assert!(
            z < Z_LIMIT,
            "{name}: block {block} is off by {z} standard errors: {:?} {:?}",
            means[block],
            truth[block]
        );
    }
    assert_no_validation_messages(&device);
}

/// Among shadows the unbiased mode has the reference's mean, and the biased mode has not: the same test sees its bias.
#[test]
fn unbiased_reuse_is_right_among_shadows() {
    let Some(device) = device() else { return };
    let camera = camera(SIZE);
    let mut renderer = renderer(&device, &occluded_lights(), SIZE, 2);
    let truth = replicas(|seed| reference(&mut renderer, camera, 1000 + seed));
    for (name, settings, frames) in unbiased_cases() {
        let means = replicas(|seed| restir(&mut renderer, camera, settings, frames, seed));
        let (z, block) = largest_z(&means, &truth);
        println!("{name}: largest z {z:.2} in block {block}");
        assert!(
            z < Z_LIMIT,
            "{name}: block {block} is off by {z} standard errors: {:?} {:?}",
            means[block],
            truth[block]
        );
    }
    let (_, settings, frames) = unbiased_cases()[4];
    let biased = Settings { mode: mode::BIASED, ..settings };
    let means = replicas(|seed| restir(&mut renderer, camera, biased, frames, seed));
    let z = largest_z(&means, &truth).0;
    assert!(z > Z_LIMIT, "the biased mode's bias was not seen: {z}");
    assert_no_validation_messages(&device);
}

#[test]
fn each_kind_of_light_has_the_mean_of_the_reference() {
    let Some(device) = device() else { return };
    let camera = camera(SIZE);
    let base = Settings { candidates: 8, radius: 8.0, ..Settings::default() };
    for (kind, scene) in kinds() {
        let mut renderer = renderer(&device, &scene, SIZE, 1);
        let truth = replicas(|seed| reference(&mut renderer, camera, 1000 + seed));
        for (name, settings, frames) in [
            ("RIS", Settings { temporal: 0, spatial: 0, ..base }, 1),
            ("RIS from tiles", Settings { temporal: 0, spatial: 0, tiles: 1, ..base }, 1),
            ("temporal and spatial", Settings { spatial_iterations: 1, ..base }, 3),
        ] {
            let means = replicas(|seed| restir(&mut renderer, camera, settings, frames, seed));
            let (z, block) = largest_z(&means, &truth);
            println!("{kind}, {name}: largest z {z:.2} in block {block}");
            assert!(truth.iter().all(|&(mean, _)| mean > 0.0), "{kind}: every block is lit");
            assert!(z < Z_LIMIT, "{kind}, {name}: block {block}: {:?} {:?}", means[block], truth[block]);
        }
    }
    assert_no_validation_messages(&device);
}

/// Negative control: lights whose stored power is 10 % off what they emit shift the mean, and that is seen.
#[test]
fn a_planted_bias_is_seen() {
    let Some(device) = device() else { return };
    let camera = camera(SIZE);
    let mut truth_renderer = renderer(&device, &many_lights(), SIZE, 1);
    let truth = replicas(|seed| reference(&mut truth_renderer, camera, 1000 + seed));
    let mut dimmed = many_lights();
    dimmed.point_lights.iter_mut().for_each(|light| light.intensity *= 0.9);
    let mut renderer = renderer(&device, &dimmed, SIZE, 1);
    let (name, settings, frames) = cases()[2];
    let means = replicas(|seed| restir(&mut renderer, camera, settings, frames, seed));
    assert!(largest_z(&means, &truth).0 > Z_LIMIT, "{name}: 10 % less light was not seen");
}

/// The same seed gives the same bits; another seed gives others.
#[test]
fn pictures_repeat_bit_for_bit() {
    let Some(device) = device() else { return };
    let camera = camera(SIZE);
    let settings = Settings { reservoirs: 2, ..Settings::default() };
    let picture = |seed| {
        let mut renderer = renderer(&device, &many_lights(), SIZE, 2);
        restir(&mut renderer, camera, settings, 3, seed)
    };
    let bits = |image: &[Vec3]| image.iter().flat_map(|c| c.to_array().map(f32::to_bits)).collect::<Vec<_>>();
    let (first, again, other) = (picture(7), picture(7), picture(8));
    assert!(bits(&first) == bits(&again), "the same seed gave two pictures");
    assert!(bits(&first) != bits(&other), "another seed gave the same picture");
    assert!(first.iter().all(|c| c.is_finite()));
}
