//! Points that last: where the camera moves, pixels keep what they shade, and each has the mean of the sum over all lights there.

use candela::frame::renderer::{FrameOptions, Renderer};
use candela::frame::schedule::{Primary, Work};
use candela::frame::targets::Target;
use glam::{UVec2, Vec3};
use shared::camera::Camera;
use shared::frame::{Settings, mode};
use shared::math::{CENTER, luminance};
use shared::passes::points::TURNS;
use shared::points::Aim;
use shared::resources::Resource;
use shared::surface::GBufferTexel;
use tests::gpu::{assert_no_validation_messages, device, options, reference, renderer};
use tests::scenes::{camera, many_lights, occluded};
use tests::statistics::compare_pixels;

const SIZE: UVec2 = UVec2::new(48, 32);
const RUNS: u32 = 96;
/// Of each run: the last one is judged.
const FRAMES: u32 = 5;

fn settings() -> Settings {
    Settings { pixel_centers: 0, radius: 8.0, mode: mode::UNBIASED, ..Settings::default() }
}

/// Strafes by a fraction of a pixel, goes nearer, and turns.
fn walking(frame: u32) -> Camera {
    let t = frame as f32;
    let position = camera(SIZE).position + Vec3::new(0.05, 0.02, -0.04) * t;
    Camera::new(position, Vec3::new(0.02 * t, -4.0, -5.0), Vec3::Y, 0.7, SIZE)
}

fn render(renderer: &mut Renderer, camera: Camera, settings: Settings, seed: u32) -> Vec<Vec3> {
    renderer.render(camera, &options(Work::Restir(settings), seed)).expect("the frame renders");
    renderer.radiance().expect("the picture is read back")
}

/// The picture of a walk's last frame.
fn walk(renderer: &mut Renderer, settings: Settings, seed: u32) -> Vec<Vec3> {
    renderer.restart();
    let pictures = (0..FRAMES).map(|frame| render(renderer, walking(frame), settings, seed));
    pictures.last().expect("there are frames")
}

fn truth(renderer: &mut Renderer, seed: u32) -> Vec<Vec3> {
    let lights = renderer.scene().light_count();
    renderer.render(walking(FRAMES - 1), &options(Work::Truth { lights }, seed)).expect("the sum renders");
    renderer.radiance().expect("the picture is read back")
}

fn luminances(picture: Vec<Vec3>) -> Vec<f64> {
    picture.into_iter().map(|c| f64::from(luminance(c))).collect()
}

/// Behind occluders, under a camera that moves: no bias at the points. A false alarm in at most 2.4 % of all runs, as in
/// `tests/pixels.rs`. Negative control: the sum at the centers of the pixels is another one, and the test sees it.
#[test]
fn pixels_have_the_mean_of_their_points() {
    let Some(device) = device() else { return };
    let mut renderer = renderer(&device, &occluded(many_lights()), SIZE, 2);
    for (name, settings) in [
        ("default", settings()),
        ("two reservoirs, tiles", Settings { reservoirs: 2, tiles: 1, cells: 0, ..settings() }),
    ] {
        let (mut runs, mut truths) = (Vec::new(), Vec::new());
        for seed in 1..=RUNS {
            runs.push(luminances(walk(&mut renderer, settings, seed)));
            truths.extend([0, 1].map(|i| luminances(truth(&mut renderer, 5000 + 2 * seed + i))));
        }
        let test = compare_pixels(&runs, &truths, SIZE);
        println!("{name}: {} pixels fail, largest cluster {}", test.failing, test.largest_cluster);
        assert!(test.passes(), "{name}: {} pixels fail, cluster {}", test.failing, test.largest_cluster);
        let centers: Vec<_> = (0..2 * RUNS)
            .map(|i| luminances(reference(&mut renderer, walking(FRAMES - 1), 5000 + i)))
            .collect();
        assert!(!compare_pixels(&runs, &centers, SIZE).passes(), "{name}: points are not at the centers");
    }
    assert_no_validation_messages(&device);
}

/// A truth disturbs nothing: the frame after it has the same bits.
#[test]
fn a_truth_leaves_no_trace() {
    let Some(device) = device() else { return };
    let mut renderer = renderer(&device, &occluded(many_lights()), SIZE, 1);
    for pixel_centers in [0, 1] {
        let settings = Settings { pixel_centers, ..settings() };
        let mut next = |looks: bool| {
            walk(&mut renderer, settings, 7);
            if looks {
                truth(&mut renderer, 8);
            }
            render(&mut renderer, walking(FRAMES), settings, 7)
        };
        assert_eq!(next(false), next(true));
    }
}

/// The point of a kept pixel is in the world where it was; of another's point (the negative control) that is not so. Nearly all
/// pixels keep theirs.
#[test]
fn kept_points_stay_in_the_world() {
    let Some(device) = device() else { return };
    let mut renderer = renderer(&device, &occluded(many_lights()), SIZE, 1);
    let (mut kept, mut pixels, mut apart) = (0, 0, 0);
    for frame in 0..8u32 {
        render(&mut renderer, walking(frame), settings(), 1);
        let copy = |copy| Target { resource: Resource::gbuffer, copy };
        let now: Vec<GBufferTexel> = renderer.read(copy(frame as usize % 2)).expect("it is read back");
        if frame == 0 {
            assert!(now.iter().all(|texel| texel.place() == CENTER), "the first points");
            continue;
        }
        let before: Vec<GBufferTexel> = renderer.read(copy(1 - frame as usize % 2)).expect("it is read back");
        let aims: Vec<Aim> = renderer.read(Resource::aims).expect("it is read back");
        let pixel = |i: usize| UVec2::new(i as u32 % SIZE.x, i as u32 / SIZE.x);
        for (i, texel) in now.iter().enumerate().filter(|(_, texel)| !texel.is_empty()) {
            pixels += 1;
            let Some(source) = aims[i].source().map(|source| source as usize) else { continue };
            kept += 1;
            let here = texel.unpack(u32::MAX, &walking(frame), pixel(i), SIZE);
            let from = |i: usize| before[i].unpack(u32::MAX, &walking(frame - 1), pixel(i), SIZE).position;
            // A place is good to 1/4096 of a pixel of 1/45 rad, here and there, on floors seen from some 40 degrees.
            let near = 4e-5 * here.distance;
            assert!(here.position.distance(from(source)) < near, "frame {frame}, pixel {i}");
            apart += usize::from(here.position.distance(from((source + 1) % now.len())) > 10.0 * near);
        }
    }
    println!("{kept} of {pixels} pixels keep their point");
    assert!(kept * 100 > pixels * 93, "{kept} of {pixels} pixels keep their point");
    assert!(apart * 100 > kept * 95, "{apart} of {kept}");
}

/// At rest a picture is that of pixels' centers, bit by bit; after a walk points return there.
#[test]
fn at_rest_points_are_at_the_centers() {
    let Some(device) = device() else { return };
    let mut renderer = renderer(&device, &occluded(many_lights()), SIZE, 1);
    let mut still = |pixel_centers| {
        renderer.restart();
        let settings = Settings { pixel_centers, ..settings() };
        (0..3).map(|_| render(&mut renderer, camera(SIZE), settings, 3)).collect::<Vec<_>>()
    };
    assert_eq!(still(0), still(1));
    walk(&mut renderer, settings(), 3);
    let mut off_center = || -> usize {
        render(&mut renderer, walking(FRAMES - 1), settings(), 3);
        let gbuffer = renderer.gbuffer().expect("it is read back");
        gbuffer.iter().filter(|texel| texel.place() != CENTER).count()
    };
    let counts: Vec<usize> = (0..=TURNS).map(|_| off_center()).collect();
    println!("off their centers: {counts:?}");
    assert!(counts[0] > 1000 && counts[TURNS as usize] == 0, "{counts:?}");
    assert!(counts.windows(2).all(|pair| pair[1] <= pair[0]), "{counts:?}");
}

/// The same seed gives the same bits, and where the scene is to be drawn, points are those of centers.
#[test]
fn walks_repeat() {
    let Some(device) = device() else { return };
    let mut renderer = renderer(&device, &occluded(many_lights()), SIZE, 1);
    let [a, b] = [(); 2].map(|()| walk(&mut renderer, settings(), 9));
    assert_eq!(a, b);
    let mut drawn = |pixel_centers| {
        renderer.restart();
        let work = Work::Restir(Settings { pixel_centers, ..settings() });
        for frame in 0..FRAMES {
            let options = FrameOptions::new(work, Primary::Raster, 9);
            renderer.render(walking(frame), &options).expect("the frame renders");
        }
        renderer.radiance().expect("the picture is read back")
    };
    assert_eq!(drawn(0), drawn(1));
}
