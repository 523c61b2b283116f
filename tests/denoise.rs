//! Denoised frames on the device: nearer to the truth, with all of its light, and the estimator does not notice.

use candela::frame::renderer::{FrameOptions, Renderer};
use candela::frame::schedule::Work;
use candela::frame::targets::Target;
use candela::scene::fixtures;
use glam::{UVec2, Vec3};
use shared::camera::Camera;
use shared::frame::{Settings, indirect};
use shared::math::luminance;
use shared::resources::Resource;
use tests::gpu::{assert_no_validation_messages, device, options, render, renderer};
use tests::scenes::{camera, kinds, many_lights, occluded};

const SIZE: UVec2 = UVec2::new(64, 40);

fn settings() -> Settings {
    Settings::default().for_a_mean()
}

/// Mean relative difference of channels.
fn error(picture: &[Vec3], truth: &[Vec3]) -> f64 {
    let mean = truth.iter().map(|&c| f64::from(luminance(c))).sum::<f64>() / truth.len() as f64;
    let pixel = |(p, t): (&Vec3, &Vec3)| {
        f64::from((*p - *t).abs().element_sum()) / (f64::from(luminance(*t)) + 0.1 * mean)
    };
    picture.iter().zip(truth).map(pixel).sum::<f64>() / truth.len() as f64
}

fn light(picture: &[Vec3]) -> f64 {
    picture.iter().map(|&c| f64::from(luminance(c))).sum()
}

/// After 12 frames at rest, and under a camera that moves by part of a pixel a frame.
#[test]
fn denoised_frames_are_nearer_to_the_truth() {
    let Some(device) = device() else { return };
    let mut renderer = renderer(&device, &occluded(many_lights()), SIZE, 1);
    let lights = renderer.scene().light_count();
    let last = camera(SIZE);
    let moving: Vec<_> = (0..12)
        .rev()
        .map(|i| Camera { position: last.position + Vec3::X * 0.002 * i as f32, ..last })
        .collect();
    let truth = render(&mut renderer, &[last], &options(Work::Reference { lights }, 3));
    for cameras in [vec![last; 12], moving] {
        // Pixel centers: the truth's.
        let work = Work::Restir(Settings { pixel_centers: 1, ..settings() });
        let plain = options(work, 3);
        let noisy = render(&mut renderer, &cameras, &plain);
        let denoised = render(&mut renderer, &cameras, &FrameOptions { denoise: true, ..plain });
        let (before, after) = (error(&noisy, &truth), error(&denoised, &truth));
        assert!(after < 0.7 * before, "{after} was {before}");
        let kept = light(&denoised) / light(&truth);
        assert!((kept - 1.0).abs() < 0.03, "{kept} of the light");
    }
    assert_no_validation_messages(&device);
}

/// Reservoirs are those of frames that nobody denoises, bit by bit; a frame that is not denoised is as ever.
#[test]
fn the_estimator_does_not_notice() {
    let Some(device) = device() else { return };
    let (_, scene) = kinds().pop().expect("scenes");
    let mut renderer = renderer(&device, &scene, SIZE, 1);
    let cameras = [camera(SIZE); 3];
    let plain = options(Work::Restir(settings()), 3);
    let reservoirs = |renderer: &Renderer| {
        (0..3)
            .map(|copy| {
                let target = Target { resource: Resource::reservoirs, copy };
                renderer.read::<u32>(target).expect("they are read back")
            })
            .collect::<Vec<_>>()
    };
    let radiance = render(&mut renderer, &cameras, &plain);
    let without = reservoirs(&renderer);
    let denoised = render(&mut renderer, &cameras, &FrameOptions { denoise: true, ..plain });
    assert_eq!(reservoirs(&renderer), without);
    assert_ne!(denoised, radiance, "negative control: it was denoised");
    assert_eq!(render(&mut renderer, &cameras, &plain), radiance);
}

/// Light that bounces is denoised with the rest: the box has it at every other point.
#[test]
fn light_that_bounces_is_in_it() {
    let Some(device) = device() else { return };
    let (_, scene) = fixtures::all().into_iter().find(|(name, _)| *name == "cornell-box").expect("a box");
    let cameras = [scene.camera(None).expect("a camera").seen_in(SIZE); 8];
    let mut renderer = renderer(&device, &scene, SIZE, 1);
    let mut light_of = |indirect| {
        let plain = options(Work::Restir(Settings { indirect, ..settings() }), 3);
        let noisy = light(&render(&mut renderer, &cameras, &plain));
        (noisy, light(&render(&mut renderer, &cameras, &FrameOptions { denoise: true, ..plain })))
    };
    let ((direct, direct_denoised), (all, all_denoised)) = (light_of(indirect::OFF), light_of(indirect::ONE));
    assert!(all > 1.1 * direct, "the scene has light that bounces: {all} and {direct}");
    let (bounced, denoised) = (all - direct, all_denoised - direct_denoised);
    assert!((denoised / bounced - 1.0).abs() < 0.15, "{denoised} of {bounced}");
    assert_no_validation_messages(&device);
}
