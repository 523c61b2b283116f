//! Antialiased frames on the device, against pictures of many times their pixels.

use candela::frame::renderer::FrameOptions;
use candela::frame::schedule::{Primary, Work};
use glam::{UVec2, Vec2, Vec3};
use shared::antialias::{PixelFilter, filter};
use shared::camera::Camera;
use shared::frame::Settings;
use shared::math::{CENTER, luminance};
use tests::gpu::{assert_no_validation_messages, device, options, reference, render, renderer};
use tests::scenes::{camera, kinds, many_lights, occluded};

const SIZE: UVec2 = UVec2::new(64, 40);
/// Pixels of the fine picture in one of the coarse one, each way.
const FINE: u32 = 8;

fn settings() -> Settings {
    Settings::default().for_a_mean()
}

/// `fine` behind the filter.
fn filtered(fine: &[Vec3]) -> Vec<Vec3> {
    let (columns, reach) = (FINE * SIZE.x, FINE as i32);
    let pixel = |pixel: UVec2| {
        let corner = (pixel * FINE).as_ivec2() - reach;
        let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
        for y in corner.y.max(0)..(corner.y + 3 * reach).min((FINE * SIZE.y) as i32) {
            for x in corner.x.max(0)..(corner.x + 3 * reach).min(columns as i32) {
                let at = (Vec2::new(x as f32, y as f32) + 0.5) / FINE as f32;
                let weight = filter(at - pixel.as_vec2() - 0.5);
                sum += weight * fine[(y as u32 * columns + x as u32) as usize];
                weights += weight;
            }
        }
        sum / weights
    };
    (0..SIZE.y).flat_map(|y| (0..SIZE.x).map(move |x| UVec2::new(x, y))).map(pixel).collect()
}

/// Pixels whose filtered value is not that behind their centers, by more than a tenth.
fn edges(truth: &[Vec3], centers: &[Vec3]) -> Vec<usize> {
    let differs = |&i: &usize| (luminance(truth[i]) / luminance(centers[i]) - 1.0).abs() > 0.1;
    (0..truth.len()).filter(differs).collect()
}

/// Mean relative difference of luminance of `pixels`.
fn error(picture: &[Vec3], truth: &[Vec3], pixels: &[usize]) -> f32 {
    let off =
        |&i: &usize| (luminance(picture[i]) - luminance(truth[i])).abs() / luminance(truth[i]).max(1e-3);
    pixels.iter().map(off).sum::<f32>() / pixels.len() as f32
}

/// At rest, and under a camera that moves by part of a pixel a frame, edges are nearer to their filtered values than in frames that
/// are denoised alone; and light stays.
#[test]
fn edges_are_smooth() {
    let Some(device) = device() else { return };
    let scene = occluded(many_lights());
    let last = camera(SIZE);
    let fine = FINE * SIZE;
    let mut large = renderer(&device, &scene, fine, 0);
    let truth = filtered(&reference(&mut large, camera(fine), 3));
    let mut renderer = renderer(&device, &scene, SIZE, 1);
    let centers = reference(&mut renderer, last, 3);
    let edges = edges(&truth, &centers);
    assert!(edges.len() > 40, "{} edges", edges.len());
    let moving: Vec<_> = (0..40)
        .rev()
        .map(|i| Camera { position: last.position + Vec3::new(0.002, 0.001, 0.0) * i as f32, ..last })
        .collect();
    for (cameras, most) in [(vec![last; 128], 0.35), (moving, 0.75)] {
        let finished = options(Work::Restir(settings()), 3).finished();
        let denoised = render(&mut renderer, &cameras, &FrameOptions { antialias: false, ..finished });
        let aliased = error(&denoised, &truth, &edges);
        let picture = render(&mut renderer, &cameras, &finished);
        let antialiased = error(&picture, &truth, &edges);
        assert!(antialiased < most * aliased, "{} frames: {antialiased} for {aliased}", cameras.len());
        let light = |picture: &[Vec3]| picture.iter().map(|&c| f64::from(luminance(c))).sum::<f64>();
        let kept = light(&picture) / light(&truth);
        assert!((kept - 1.0).abs() < 0.03, "{kept} of the light");
    }
    assert_no_validation_messages(&device);
}

/// Frames through places that are drawn like the filter: their mean is the filtered picture, drawn or traced, summed or resampled. Negative
/// control: without edges' places it is not.
#[test]
fn means_are_the_filtered_picture() {
    let Some(device) = device() else { return };
    let scene = occluded(many_lights());
    let fine = FINE * SIZE;
    let mut large = renderer(&device, &scene, fine, 0);
    let truth = filtered(&reference(&mut large, camera(fine), 3));
    let mut renderer = renderer(&device, &scene, SIZE, 1);
    let lights = renderer.scene().light_count();
    let edges = edges(&truth, &reference(&mut renderer, camera(SIZE), 3));
    let mut mean = |work: Work, primary: Primary, frames: u32, place: fn(u32) -> u32| {
        renderer.restart();
        let mut mean = vec![Vec3::ZERO; truth.len()];
        for frame in 0..frames {
            let options = FrameOptions { place: place(frame), ..FrameOptions::new(work, primary, 3) };
            renderer.render(camera(SIZE), &options).expect("the frame renders");
            let picture = renderer.radiance().expect("the picture is read back");
            mean.iter_mut().zip(picture).for_each(|(mean, light)| *mean += light / frames as f32);
        }
        mean
    };
    let (sum, resampled) = (Work::Reference { lights }, Work::Restir(settings()));
    for primary in [Primary::Raster, Primary::Rays] {
        let exact = mean(sum, primary, 64, |frame| PixelFilter::Gaussian.place(frame));
        assert!(error(&exact, &truth, &edges) < 0.04, "{primary:?}: {}", error(&exact, &truth, &edges));
        let centers = mean(sum, primary, 1, |_| CENTER);
        assert!(error(&centers, &truth, &edges) > 0.2);
        let resampled = mean(resampled, primary, 64, |frame| PixelFilter::Gaussian.place(frame));
        let off = error(&resampled, &truth, &edges);
        assert!(off < 0.12, "{primary:?}: {off}");
    }
    assert_no_validation_messages(&device);
}

/// Through the centers of pixels nothing is antialiased: the picture is that of a frame which is denoised alone. And without the denoiser nothing is.
#[test]
fn centers_stay_as_they_are() {
    let Some(device) = device() else { return };
    let (_, scene) = kinds().pop().expect("scenes");
    let mut renderer = renderer(&device, &scene, SIZE, 1);
    let cameras = [camera(SIZE); 4];
    let plain = |pixel_centers| options(Work::Restir(Settings { pixel_centers, ..settings() }), 3);
    let mut picture = |options: FrameOptions| render(&mut renderer, &cameras, &options);
    let denoised = picture(FrameOptions { denoise: true, ..plain(1) });
    assert_eq!(picture(plain(1).finished()), denoised);
    assert_ne!(picture(plain(0).finished()), denoised, "negative control");
    assert_eq!(picture(FrameOptions { antialias: true, ..plain(0) }), picture(plain(0)));
    assert_no_validation_messages(&device);
}
