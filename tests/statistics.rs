//! ReSTIR against the reference on the device, over independent runs of the whole frame sequence.
//!
//! The mean of every 8 x 8 block must be the reference's: for the biased 1/M weights where nothing stands between lights and
//! floor and every light reaches every pixel, for the unbiased mode everywhere.

use glam::{UVec2, Vec3};
use shared::frame::{Settings, mode};
use tests::gpu::{assert_no_validation_messages, device, reference, renderer, restir, small};
use tests::scenes::{camera, kinds, many_lights, occluded};
use tests::statistics::{assert_means, largest_z};

const SIZE: UVec2 = UVec2::new(64, 48);
const REPLICAS: u32 = 48;
/// Over 48 blocks with Student's t of 47 degrees of freedom: a false alarm in 1e-4 of all runs a case (Sidak).
const Z_LIMIT: f64 = 5.9;

fn cases() -> Vec<(&'static str, Settings, u32)> {
    let base = Settings { temporal: 0, spatial: 0, ..small(mode::BIASED) };
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
    let base = Settings { temporal: 0, pairs: 0, ..small(mode::UNBIASED) };
    let temporal = Settings { temporal: 1, spatial: 0, ..base };
    vec![
        ("unbiased spatial", base, 1),
        ("unbiased spatial without visibility reuse", Settings { visibility_reuse: 0, ..base }, 1),
        ("unbiased temporal", temporal, 4),
        ("unbiased temporal without visibility reuse", Settings { visibility_reuse: 0, ..temporal }, 4),
        ("unbiased temporal and spatial, two reservoirs", Settings { temporal: 1, reservoirs: 2, ..base }, 4),
        ("unbiased, tiles", Settings { temporal: 1, tiles: 1, ..base }, 4),
        ("unbiased pairs", Settings { pairs: 1, ..base }, 1),
        ("unbiased pairs without visibility reuse", Settings { pairs: 1, visibility_reuse: 0, ..base }, 1),
        ("cells that have learned", Settings { temporal: 1, pairs: 1, cells: 1, ..base }, 4),
        ("unbiased temporal and pairs", Settings { temporal: 1, pairs: 1, reservoirs: 2, ..base }, 4),
    ]
}

fn replicas(run: impl FnMut(u32) -> Vec<Vec3>) -> Vec<(f64, f64)> {
    tests::statistics::replicas(REPLICAS, SIZE, run)
}

#[test]
fn reuse_has_the_mean_of_the_reference() {
    let Some(device) = device() else { return };
    let camera = camera(SIZE);
    let mut renderer = renderer(&device, &many_lights(), SIZE, 2);
    let truth = replicas(|seed| reference(&mut renderer, camera, 1000 + seed));
    for (name, settings, frames) in cases() {
        let means = replicas(|seed| restir(&mut renderer, camera, settings, frames, seed));
        assert_means(name, &means, &truth, Z_LIMIT);
    }
    assert_no_validation_messages(&device);
}

/// Among shadows the unbiased mode has the reference's mean, and the biased mode has not: the same test sees its bias.
#[test]
fn unbiased_reuse_is_right_among_shadows() {
    let Some(device) = device() else { return };
    let camera = camera(SIZE);
    let mut renderer = renderer(&device, &occluded(many_lights()), SIZE, 2);
    let truth = replicas(|seed| reference(&mut renderer, camera, 1000 + seed));
    for (name, settings, frames) in unbiased_cases() {
        let means = replicas(|seed| restir(&mut renderer, camera, settings, frames, seed));
        assert_means(name, &means, &truth, Z_LIMIT);
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
    let base = small(mode::BIASED);
    for (kind, scene) in kinds() {
        let mut renderer = renderer(&device, &scene, SIZE, 1);
        let truth = replicas(|seed| reference(&mut renderer, camera, 1000 + seed));
        for (name, settings, frames) in [
            ("RIS", Settings { temporal: 0, spatial: 0, ..base }, 1),
            ("RIS from cells", Settings { temporal: 0, spatial: 0, cells: 1, ..base }, 3),
            ("RIS from tiles", Settings { temporal: 0, spatial: 0, tiles: 1, ..base }, 1),
            ("temporal and spatial", Settings { spatial_iterations: 1, ..base }, 3),
        ] {
            let means = replicas(|seed| restir(&mut renderer, camera, settings, frames, seed));
            assert!(truth.iter().all(|&(mean, _)| mean > 0.0), "{kind}: every block is lit");
            assert_means(&format!("{kind}, {name}"), &means, &truth, Z_LIMIT);
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
    dimmed.lights.iter_mut().for_each(|light| *light.emission_mut() *= 0.9);
    let mut renderer = renderer(&device, &dimmed, SIZE, 1);
    let (name, settings, frames) = cases()[2];
    let means = replicas(|seed| restir(&mut renderer, camera, settings, frames, seed));
    assert!(largest_z(&means, &truth).0 > Z_LIMIT, "{name}: 10 % less light was not seen");
}
