//! What only many frames show: drift, lost energy, and how fast light comes and goes.

use crate::matrix::base;
use crate::passes::Sequence;
use crate::truth;
use crate::world::{self, World};
use shared::frame::{Settings, mode};
use shared::glam::{UVec2, Vec3};
use shared::light::Light;
use shared::math::luminance;

/// With one cap for all histories.
fn settings(mode: u32) -> Settings {
    let base = Settings { history_cap: 20.0, ..base() };
    Settings { mode, visibility_reuse: 1, temporal: 1, spatial: 1, spatial_iterations: 1, ..base }
}

/// Short ones for other points; pairs of long ones leave each other alone from 12 frames on.
fn with_long_histories() -> Settings {
    Settings { pairs: 1, confidence_cap: 4.0, history_cap: 24.0, ..settings(mode::UNBIASED) }
}

/// Mean luminance of a picture.
fn brightness(picture: &[Vec3]) -> f64 {
    picture.iter().map(|&c| f64::from(luminance(c))).sum::<f64>() / picture.len() as f64
}

fn true_brightness(world: &World) -> f64 {
    let of_view = |i| {
        brightness(&truth::picture(world, &world.view(i)).iter().map(|c| c.as_vec3()).collect::<Vec<_>>())
    };
    (of_view(0) + of_view(1)) / 2.0
}

/// Mean and its standard error from batches of 50 frames: one outlives a history (capped at 20 or 24 frames' candidates, and
/// moved from pixel to pixel), so that batches are nearly independent.
fn batched(frames: &[f64]) -> (f64, f64) {
    let batches: Vec<f64> = frames.chunks(50).map(|b| b.iter().sum::<f64>() / b.len() as f64).collect();
    let n = batches.len() as f64;
    let mean = batches.iter().sum::<f64>() / n;
    let variance = batches.iter().map(|b| (b - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

/// Student's t, 19 degrees of freedom, exceeded by chance in 1e-4 of all cases.
const T_LIMIT: f64 = 4.9;

/// 10,000 frames: all finite, and the last 1,000 as bright as the first 1,000, and as the truth.
#[test]
fn ten_thousand_frames_keep_their_energy() {
    for settings in [settings(mode::BIASED), settings(mode::UNBIASED), with_long_histories()] {
        let mode = settings.mode;
        let mut world = World::new(world::together().everywhere);
        if mode == mode::UNBIASED {
            world = World::new(world::together().somewhere).behind_a_screen();
        }
        if settings.history_cap > settings.confidence_cap {
            world.eyes = [world.eyes[0]; 2];
        }
        world.size = UVec2::new(5, 4);
        let views = [world.view(0), world.view(1)];
        let mut sequence = Sequence::new(&world, &views, settings, 1, None);
        let frames: Vec<f64> = (0..10_000)
            .map(|frame| {
                let picture = sequence.next_frame();
                assert!(picture.iter().all(|c| c.is_finite()), "mode {mode}: frame {frame}");
                brightness(&picture)
            })
            .collect();
        let truth = true_brightness(&world);
        let (first, last) = (batched(&frames[..1000]), batched(&frames[9000..]));
        let error = first.1.hypot(last.1);
        println!("mode {mode}: first {first:?}, last {last:?}, truth {truth}");
        assert!((last.0 - first.0).abs() < T_LIMIT * error, "mode {mode} drifts: {first:?} {last:?}");
        let (mean, error) = batched(&frames);
        assert!((mean - truth).abs() < T_LIMIT * error, "mode {mode}: {mean} ± {error}, truth {truth}");
        // Negative control: a loss of one part in a thousand a frame is seen.
        let leaking: Vec<f64> =
            frames.iter().enumerate().map(|(i, f)| f * 0.9999f64.powi(i as i32)).collect();
        let (first, last) = (batched(&leaking[..1000]), batched(&leaking[9000..]));
        assert!((last.0 - first.0).abs() > T_LIMIT * first.1.hypot(last.1), "a leak was not seen");
    }
}

/// Mean brightness of each frame after a change of lights in frame 30, over independent runs.
fn after_change(before: &World, after: &World, mode: u32, frames: usize) -> Vec<f64> {
    const RUNS: u32 = 200;
    let views = [before.view(0), before.view(1)];
    let mut means = vec![0.0; frames];
    for seed in 0..RUNS {
        let mut sequence = Sequence::new(before, &views, settings(mode), seed, None);
        for _ in 0..30 {
            sequence.next_frame();
        }
        sequence.set_lights(after);
        for mean in &mut means {
            *mean += brightness(&sequence.next_frame()) / f64::from(RUNS);
        }
    }
    means
}

fn with_and_without() -> (World, World) {
    let mut lights = world::points().everywhere;
    lights.push(Light::point(Vec3::new(0.3, 1.5, 0.5), Vec3::splat(60.0)));
    let mut on = World::new(lights.clone());
    on.eyes = [on.eyes[0]; 2];
    on.size = UVec2::new(8, 6);
    lights.last_mut().expect("a light").emission = Vec3::ZERO;
    let last = lights.len() - 1;
    lights[last] = Light::point(lights[last].position, Vec3::ZERO);
    let off = on.clone().with_lights(lights);
    (on, off)
}

/// Frames until 90 % of a light's energy is gone after it was switched off: the very next one shows none of it, for every sample
/// is evaluated anew, and the other lights keep theirs.
#[test]
fn a_light_switched_off_is_gone() {
    let (on, off) = with_and_without();
    let (bright, dark) = (true_brightness(&on), true_brightness(&off));
    for mode in [mode::BIASED, mode::UNBIASED] {
        let left: Vec<f64> =
            after_change(&on, &off, mode, 20).iter().map(|mean| (mean - dark) / (bright - dark)).collect();
        println!("mode {mode}: {left:.3?}");
        assert!(
            left.iter().all(|left| left.abs() < 0.1),
            "mode {mode}: of its energy there is left {left:.3?}"
        );
    }
}

/// A light switched on fades in, in both modes: histories that could not have found it still count as if they had. The frames that
/// it takes to 90 % of its energy, with a cap of 20.
#[test]
fn a_light_switched_on_arrives() {
    let (on, off) = with_and_without();
    let (bright, dark) = (true_brightness(&on), true_brightness(&off));
    for (mode, stated) in [(mode::BIASED, 64), (mode::UNBIASED, 28)] {
        let there: Vec<f64> =
            after_change(&off, &on, mode, 80).iter().map(|mean| (mean - dark) / (bright - dark)).collect();
        println!("mode {mode}: {there:.3?}");
        assert!(there[stated..].iter().all(|&there| there > 0.9), "mode {mode}: {there:.3?}");
        assert!(there.iter().all(|&there| there < 1.1), "mode {mode}: {there:.3?}");
    }
}
