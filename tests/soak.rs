//! Thousands of frames on end of a scene whose things, lights and camera all move: every pixel is finite, the light stays that
//! of the sum over all lights at the same points, and memory what it was.

use candela::frame::renderer::Renderer;
use candela::frame::schedule::Work;
use candela::gpu_scene::GpuScene;
use candela::scene::{SceneDescription, gltf};
use glam::{UVec2, Vec3};
use peak_alloc::PeakAlloc;
use shared::frame::{Settings, mode};
use shared::math::luminance;
use std::path::Path;
use tests::gpu::{assert_no_validation_messages, device, options, pose};
use tests::statistics::mean_and_error;

#[global_allocator]
static HEAP: PeakAlloc = PeakAlloc;

const SIZE: UVec2 = UVec2::new(32, 18);
/// A round of the animation, whose end jumps back to its start.
const FRAMES: u32 = 25;
const SECONDS: f64 = 2.0;
/// Rounds in which allocators and caches come to rest.
const WARM_UP: usize = 4;
/// Student's t of 15 degrees of freedom: each of the two tests of a run alarms falsely in 1e-4 of all runs where rounds are
/// independent. Over 400 rounds neighbors are correlated by -0.02.
const T_LIMIT: f64 = 5.2;
/// What a run may leave on the heap, bytes, and in the process, driver included.
const HEAP_SLACK: usize = 16 << 10;
const PROCESS_SLACK: usize = 16 << 20;

/// What is seen of a round.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Round {
    /// Mean luminance of all its pixels, nit.
    light: f64,
    not_finite: usize,
    /// Bytes at its end: of the device, of the heap, and of the whole process (0 where that is not looked at).
    device: u64,
    heap: usize,
    process: usize,
}

/// Resident memory, bytes; 0 where the system does not say, and under validation, whose layer keeps some 17 kB of each frame.
fn process() -> usize {
    if std::env::var("CANDELA_NO_VALIDATION").as_deref() != Ok("1") {
        return 0;
    }
    let pages = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    pages.split(' ').nth(1).and_then(|pages| pages.parse::<usize>().ok()).unwrap_or(0) * 4096
}

fn mean(picture: &[Vec3]) -> f64 {
    picture.iter().map(|&c| f64::from(luminance(c))).sum::<f64>() / picture.len() as f64
}

/// Shows `frame` every place of a round in turn.
fn round(
    renderer: &mut Renderer,
    scene: &mut SceneDescription,
    mut frame: impl FnMut(&mut Renderer, shared::camera::Camera),
) {
    for i in 0..FRAMES {
        pose(renderer, scene, SECONDS * f64::from(i) / f64::from(FRAMES));
        let camera = scene.camera(None).expect("it has one").seen_in(SIZE);
        frame(renderer, camera);
    }
}

/// Also the light that its pixels should have, at the very points that they shade: one sample of each light.
fn look(renderer: &mut Renderer, scene: &mut SceneDescription, settings: Settings) -> (Round, f64) {
    let lights = renderer.scene().light_count();
    let (mut truth, mut seed) = (0.0, 100);
    let mut seen = Round { light: 0.0, not_finite: 0, device: 0, heap: 0, process: 0 };
    round(renderer, scene, |renderer, camera| {
        renderer.render(camera, &options(Work::Restir(settings), 1)).expect("the frame renders");
        let picture = renderer.radiance().expect("the picture is read back");
        seen.light += mean(&picture) / f64::from(FRAMES);
        seen.not_finite += picture.iter().filter(|c| !c.is_finite()).count();
        renderer.render(camera, &options(Work::Truth { lights }, seed)).expect("the truth renders");
        truth += mean(&renderer.radiance().expect("it is read back")) / f64::from(FRAMES);
        seed += 1;
    });
    (seen, truth)
}

/// What is wrong with `rounds`, whose light should be `truth` (with its standard error).
fn faults(rounds: &[Round], truth: (f64, f64)) -> Vec<String> {
    let mut faults = Vec::new();
    let mut check = |fine: bool, what: String| {
        if !fine {
            faults.push(what);
        }
    };
    let broken: usize = rounds.iter().map(|r| r.not_finite).sum();
    check(broken == 0, format!("pixels: {broken} are not finite"));

    let light: Vec<Vec<f64>> = rounds.iter().map(|r| vec![r.light]).collect();
    let (mean, error) = mean_and_error(&light)[0];
    let t = (mean - truth.0) / error.hypot(truth.1);
    println!("light: {mean} of {} nit, t {t:.2}", truth.0);
    check(t.abs() < T_LIMIT, format!("light: {mean} instead of {} nit, t {t:.1}", truth.0));

    // Least squares: light over the round's number.
    let n = rounds.len() as f64;
    let at = |i: usize| i as f64 - (n - 1.0) / 2.0;
    let squares: f64 = (0..rounds.len()).map(|i| at(i).powi(2)).sum();
    let slope = (0..rounds.len()).map(|i| at(i) * rounds[i].light).sum::<f64>() / squares;
    let rest: f64 = (0..rounds.len()).map(|i| (rounds[i].light - mean - slope * at(i)).powi(2)).sum();
    let t = slope / (rest / (n - 2.0) / squares).sqrt();
    println!("drift: {:.4} % over all rounds, t {t:.2}", 100.0 * slope * n / mean);
    check(t.abs() < T_LIMIT, format!("drift: {slope} nit a round, t {t:.1}"));

    let (warm, last) = (rounds[WARM_UP], rounds[rounds.len() - 1]);
    println!("memory: {warm:?} to {last:?}");
    check(last.device == warm.device, format!("device memory: {} to {} bytes", warm.device, last.device));
    check(last.heap <= warm.heap + HEAP_SLACK, format!("heap: {} to {} bytes", warm.heap, last.heap));
    let process = (warm.process, last.process);
    check(process.1 <= process.0 + PROCESS_SLACK, format!("process: {} to {} bytes", process.0, process.1));
    faults
}

fn soak(rounds: usize, settings: Settings) -> Option<(Vec<Round>, (f64, f64))> {
    let device = device()?;
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/scenes/moving.glb");
    let mut scene = gltf::load(&path).expect("it loads");
    let uploaded = GpuScene::new(&device, &scene).expect("the scene fits");
    let mut renderer = Renderer::new(&device, uploaded, SIZE, 1).expect("the renderer fits");
    // Room for what is noted comes first: it is no leak.
    let (mut seen, mut truth) = (Vec::with_capacity(rounds), Vec::with_capacity(rounds));
    for _ in 0..rounds {
        let (round, light) = look(&mut renderer, &mut scene, settings);
        seen.push(Round {
            device: device.memory_used(),
            heap: HEAP.current_usage(),
            process: process(),
            ..round
        });
        truth.push(vec![light]);
    }
    assert_no_validation_messages(&device);
    Some((seen, mean_and_error(&truth)[0]))
}

/// Small neighborhoods, since the picture is small.
fn settings() -> Settings {
    Settings { radius: 6.0, mode: mode::UNBIASED, ..Settings::default() }
}

/// A slice of what `ten_thousand_frames` does.
#[test]
fn five_hundred_frames() {
    let Some((rounds, truth)) = soak(20, settings()) else { return };
    assert_eq!(faults(&rounds, truth), [""; 0]);
    // The same look sees each of these.
    let plant = |change: fn(usize, &mut Round)| {
        let mut planted = rounds.clone();
        planted.iter_mut().enumerate().for_each(|(i, round)| change(i, round));
        faults(&planted, truth)
    };
    for (what, change) in [
        ("pixels", (|i, round| round.not_finite += usize::from(i == 7)) as fn(usize, &mut Round)),
        ("light", |_, round| round.light *= 0.94),
        ("drift", |i, round| round.light *= 1.0 + 0.01 * (i as f64 - 9.5)),
        ("device memory", |i, round| round.device += 256 * i as u64),
        ("heap", |i, round| round.heap += 64 * (i * FRAMES as usize)),
        ("process", |i, round| round.process += (2 << 20) * i),
    ] {
        let seen = plant(change);
        assert!(!seen.is_empty() && seen.iter().all(|fault| fault.starts_with(what)), "{what}: {seen:?}");
    }
}

/// Half a minute on lavapipe: `CANDELA_NO_VALIDATION=1 cargo test --workspace --test soak -- --ignored --nocapture`.
#[test]
#[ignore = "long, and needs CANDELA_NO_VALIDATION=1 to see what the driver keeps"]
fn ten_thousand_frames() {
    let Some((rounds, truth)) = soak(400, settings()) else { return };
    let light: Vec<f64> = rounds.iter().map(|r| r.light).collect();
    println!("correlation of neighboring rounds: {:.2}", correlation(&light));
    assert_eq!(faults(&rounds, truth), [""; 0]);
}

/// Of values with those after them.
fn correlation(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let product = |a: f64, b: f64| (a - mean) * (b - mean);
    values.windows(2).map(|w| product(w[0], w[1])).sum::<f64>()
        / values.iter().map(|&a| product(a, a)).sum::<f64>()
}
