//! Our pictures against Mitsuba 3's, pixel by pixel: the same scenes, a stranger's rays, lights, camera and sums (tools/mitsuba
//! says how they were made and how far they are from converged).
//!
//! Both programs look through the middle of each pixel. Where the rays through a pixel's corners meet another shape, another
//! normal or another texel of the sky than its middle does, or the edge of a hard shadow is within a millimetre, a rounding
//! decides what is seen: those pixels (alpha 0 in the references) are not compared.

use candela::frame::renderer::FrameOptions;
use candela::frame::schedule::Work;
use candela::scene::{PlacedLight, SceneDescription, interchange};
use candela_lab::measure::mean::Mean;
use candela_lab::measure::metrics::{metrics, with_flip};
use glam::{Affine3A, DAffine3, IVec2, UVec2, Vec3, Vec4};
use shared::camera::Camera;
use shared::frame::{Settings, indirect, mode};
use shared::interface::UNBOUNDED;
use shared::light::kind;
use shared::material::slot;
use shared::math::luminance;
use std::path::{Path, PathBuf};
use tests::failure;
use tests::gpu::{
    Gpu, assert_no_validation_messages, device, options, reference, renderer, restir, small, what_bounced,
};
use tests::outside::{SIZE, all, bounced, named};
use tests::statistics::{largest_z, mean_and_error};

/// Of the mean of the picture away from edges.
const MEAN_TOLERANCE: f64 = 3e-3;
/// Of a pixel: relative, and as a fraction of the picture's mean. Mitsuba's own standard error is below 0.3 %.
const PIXEL_TOLERANCE: (f64, f64) = (1e-2, 1e-3);
/// Standard errors of our own mean that a pixel may be off besides: its own or a neighbor's, as a pixel that saw nothing of a
/// lamp in any frame has no spread of its own. Seeds are fixed: a false alarm comes now or never.
const SIGMAS: f64 = 5.0;

/// What Mitsuba rendered, and where it may be compared.
struct Truth {
    radiance: Vec<Vec3>,
    away_from_edges: Vec<bool>,
}

impl Truth {
    fn read(name: &str) -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("references").join(name).with_extension("exr");
        let picture = image::open(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display())).into_rgba32f();
        assert_eq!(UVec2::from(picture.dimensions()), SIZE, "{}", path.display());
        Truth {
            radiance: picture.pixels().map(|p| Vec3::from_slice(&p.0)).collect(),
            away_from_edges: picture.pixels().map(|p| p.0[3] > 0.5).collect(),
        }
    }
}

/// For each pixel the largest value of it and its eight neighbors.
fn largest_around(values: &[f64], size: UVec2) -> Vec<f64> {
    let size = size.as_ivec2();
    let value = |p: IVec2| {
        let inside = p.cmpge(IVec2::ZERO).all() && p.cmplt(size).all();
        if inside { values[(p.y * size.x + p.x) as usize] } else { 0.0 }
    };
    let around = |p: IVec2| (0..9).map(|i| value(p + IVec2::new(i % 3 - 1, i / 3 - 1))).fold(0.0, f64::max);
    (0..size.x * size.y).map(|i| around(IVec2::new(i % size.x, i / size.x))).collect()
}

/// A picture against the truth, away from edges.
struct Comparison {
    /// Mean luminance over the truth's.
    mean_ratio: f64,
    /// See [`candela_lab::measure::metrics::Metrics`].
    relative_mse: f64,
    flip: f64,
    /// Largest error of a pixel's channel in units of what is allowed, and where.
    worst: (f64, UVec2),
    /// Largest relative error of a pixel's luminance above a hundredth of the mean.
    largest_relative: f64,
    pixels: usize,
}

impl Comparison {
    fn new(mean: &Mean, truth: &Truth) -> Self {
        let (ours, errors) = (mean.radiance(), largest_around(&mean.standard_errors(), SIZE));
        let compared: Vec<usize> = (0..ours.len()).filter(|&i| truth.away_from_edges[i]).collect();
        let l = |picture: &[Vec3], i: usize| f64::from(luminance(picture[i]));
        let sum = |of: &dyn Fn(usize) -> f64| compared.iter().map(|&i| of(i)).sum::<f64>();
        let count = compared.len() as f64;
        let bright = sum(&|i| l(&truth.radiance, i)) / count;
        let excess = |i: usize| {
            let brightest = f64::from(truth.radiance[i].max_element());
            // Of the brightest channel, as all have the same lights' noise.
            let noise = errors[i] * brightest / l(&truth.radiance, i).max(f64::MIN_POSITIVE);
            let allowed = PIXEL_TOLERANCE.0 * brightest + PIXEL_TOLERANCE.1 * bright + SIGMAS * noise;
            f64::from((ours[i] - truth.radiance[i]).abs().max_element()) / allowed
        };
        let relative = |i: usize| {
            let (a, b) = (l(&ours, i), l(&truth.radiance, i));
            if b > 0.01 * bright { (a - b).abs() / b } else { 0.0 }
        };
        // Edges count as equal: FLIP looks at neighborhoods.
        let or_truth = |i: usize| if truth.away_from_edges[i] { ours[i] } else { truth.radiance[i] };
        let without_edges: Vec<Vec3> = (0..ours.len()).map(or_truth).collect();
        let pick = |picture: &[Vec3]| compared.iter().map(|&i| picture[i]).collect::<Vec<_>>();
        let (worst, at) = compared
            .iter()
            .map(|&i| (excess(i), i))
            .fold((0.0, 0), |best, next| if next.0 > best.0 { next } else { best });
        Comparison {
            mean_ratio: sum(&|i| l(&ours, i)) / count / bright,
            relative_mse: metrics(&pick(&ours), &pick(&truth.radiance)).rel_mse,
            flip: with_flip(&without_edges, &truth.radiance, SIZE).0.flip.unwrap_or(f64::NAN),
            worst: (worst, UVec2::new(at as u32 % SIZE.x, at as u32 / SIZE.x)),
            largest_relative: compared.iter().map(|&i| relative(i)).fold(0.0, f64::max),
            pixels: compared.len(),
        }
    }

    fn mean_agrees(&self) -> bool {
        (self.mean_ratio - 1.0).abs() < MEAN_TOLERANCE
    }

    fn agrees(&self) -> bool {
        self.mean_agrees() && self.worst.0 < 1.0
    }
}

impl std::fmt::Display for Comparison {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "| {:.4} | {:.1e} | {:.5} | {:.2} % | {:.2} at {} | {} |",
            self.mean_ratio,
            self.relative_mse,
            self.flip,
            100.0 * self.largest_relative,
            self.worst.0,
            self.worst.1,
            self.pixels
        )
    }
}

fn camera(scene: &SceneDescription) -> Camera {
    let view = &scene.cameras[0];
    Camera::new(view.position, view.forward, view.up, view.fov_y, SIZE)
}

/// The mean of as many frames of the reference as its kinds of light need: points are exact with one.
fn our_reference(device: &Gpu, scene: &SceneDescription) -> Mean {
    let frames = match candela::scene::lights::LightTable::new(scene).lights {
        lights if lights.iter().any(|l| l.kind == kind::ENVIRONMENT) => 48,
        lights if lights.iter().any(|l| l.has_extent()) => 256,
        _ => 1,
    };
    let mut renderer = renderer(device, scene, SIZE, 0);
    let mut mean = Mean::new(SIZE);
    for seed in 0..frames {
        mean.add(&reference(&mut renderer, camera(scene), seed));
    }
    mean
}

#[test]
fn the_reference_agrees_with_mitsuba() {
    let Some(device) = device() else { return };
    let mut failed = Vec::new();
    for scene in all() {
        let truth = Truth::read(&scene.name);
        let mean = our_reference(&device, &scene);
        let comparison = Comparison::new(&mean, &truth);
        println!("| {} {comparison}", scene.name);
        if !comparison.agrees() {
            let name = format!("mitsuba-{}", scene.name);
            let pictures = failure::write(&name, SIZE, &mean.radiance(), &truth.radiance);
            failed.push(format!("{} {comparison} {pictures}", scene.name));
        }
        assert!(comparison.pixels > 2000, "{}: {} pixels are left to compare", scene.name, comparison.pixels);
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
    assert_no_validation_messages(&device);
}

/// Of pictures of light that bounces.
const BOUNCED_SIZE: UVec2 = UVec2::new(32, 24);
/// Paths of ours of each pixel.
const PATHS: u32 = 1024;
const PATHS_A_FRAME: u32 = 32;
/// Of the mean of bounced light, beside [`SIGMAS`] standard errors of both programs.
const BOUNCED_MEAN_TOLERANCE: f64 = 3e-3;

/// Bounced light of ours against Mitsuba's; both are noisy, and say how much.
struct Bounced {
    mean_ratio: f64,
    /// What the ratio's distance from 1 is to be compared with.
    mean_error: f64,
    /// Largest error of a pixel in units of what is allowed, and where.
    worst: (f64, UVec2),
    pixels: usize,
}

impl Bounced {
    fn new(mean: &Mean, truth: &[Vec4]) -> Self {
        let compared: Vec<usize> = (0..truth.len()).filter(|&i| truth[i].w > 0.0).collect();
        let (ours, errors) = (mean.radiance(), mean.standard_errors());
        let l = |c: Vec3| f64::from(luminance(c));
        let error = |i: usize| errors[i].hypot(f64::from(truth[i].w));
        let around = largest_around(&(0..truth.len()).map(error).collect::<Vec<_>>(), BOUNCED_SIZE);
        let sum = |of: &dyn Fn(usize) -> f64| compared.iter().map(|&i| of(i)).sum::<f64>();
        let total = sum(&|i| l(truth[i].truncate()));
        let bright = total / compared.len() as f64;
        let excess = |i: usize| {
            let (a, b) = (l(ours[i]), l(truth[i].truncate()));
            (a - b).abs() / (PIXEL_TOLERANCE.0 * b + PIXEL_TOLERANCE.1 * bright + SIGMAS * around[i])
        };
        let worst = compared.iter().map(|&i| (excess(i), i)).max_by(|a, b| a.0.total_cmp(&b.0));
        let (excess, at) = worst.expect("something to compare");
        Bounced {
            mean_ratio: sum(&|i| l(ours[i])) / total,
            mean_error: sum(&|i| error(i).powi(2)).sqrt() / total,
            worst: (excess, UVec2::new(at as u32 % BOUNCED_SIZE.x, at as u32 / BOUNCED_SIZE.x)),
            pixels: compared.len(),
        }
    }

    fn agrees(&self) -> bool {
        (self.mean_ratio - 1.0).abs() < BOUNCED_MEAN_TOLERANCE + SIGMAS * self.mean_error
            && self.worst.0 < 1.0
    }
}

impl std::fmt::Display for Bounced {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Bounced { mean_ratio, mean_error, worst: (worst, at), pixels } = self;
        write!(f, "| {mean_ratio:.4} | {:.2} % | {worst:.2} at {at} | {pixels} |", 100.0 * mean_error)
    }
}

fn bounced_truth(name: &str) -> Vec<Vec4> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("references").join(name).with_extension("exr");
    let picture = image::open(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display())).into_rgba32f();
    assert_eq!(UVec2::from(picture.dimensions()), BOUNCED_SIZE, "{}", path.display());
    picture.pixels().map(|p| Vec4::from_slice(&p.0)).collect()
}

fn our_paths(device: &Gpu, scene: &SceneDescription, bounces: u32) -> Mean {
    let mut renderer = renderer(device, scene, BOUNCED_SIZE, 0);
    let mut mean = Mean::new(BOUNCED_SIZE);
    let view = &scene.cameras[0];
    let camera = Camera::new(view.position, view.forward, view.up, view.fov_y, BOUNCED_SIZE);
    for _ in 0..PATHS / PATHS_A_FRAME {
        let work = Work::Paths { bounces, paths: PATHS_A_FRAME };
        renderer.render(camera, &options(work, 0)).expect("the frame renders");
        mean.add(&renderer.radiance().expect("the picture is read back"));
    }
    mean
}

#[test]
fn light_that_bounces_agrees_with_mitsuba() {
    let Some(device) = device() else { return };
    let mut failed = Vec::new();
    let depths = |(scene, depths): (SceneDescription, Vec<u32>)| {
        depths.into_iter().map(move |bounces| (scene.clone(), bounces))
    };
    for (scene, bounces) in bounced().into_iter().flat_map(depths) {
        let depth = if bounces == UNBOUNDED { "inf".into() } else { bounces.to_string() };
        let name = format!("{}-bounces-{depth}", scene.name);
        let comparison = Bounced::new(&our_paths(&device, &scene, bounces), &bounced_truth(&name));
        println!("| {name} {comparison}");
        if !comparison.agrees() {
            failed.push(format!("{name} {comparison}"));
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
    // Planted errors, which the same comparison must refuse.
    let cornell = named("cornell-box");
    let mut bright = cornell.clone();
    bright.materials.iter_mut().for_each(|material| material.base_color *= 1.03);
    let planted = [
        ("a bounce too many", &cornell, 2, "cornell-box-bounces-1"),
        ("walls 3 % brighter", &bright, UNBOUNDED, "cornell-box-bounces-inf"),
    ];
    for (error, scene, bounces, truth) in planted {
        let comparison = Bounced::new(&our_paths(&device, scene, bounces), &bounced_truth(truth));
        println!("| {error} {comparison}");
        assert!(!comparison.agrees(), "{error} was not seen: {comparison}");
    }
    assert_no_validation_messages(&device);
}

/// Independent runs of three frames.
const BOUNCED_RUNS: u32 = 96;

/// Light that bounces in the last of three frames with histories and pairs.
fn our_resampled_paths(device: &Gpu, scene: &SceneDescription, bounces: u32) -> Mean {
    let mut renderer = renderer(device, scene, BOUNCED_SIZE, 1);
    let mut mean = Mean::new(BOUNCED_SIZE);
    let camera = scene.cameras[0].seen_in(BOUNCED_SIZE);
    let indirect = if bounces == 1 { indirect::ONE } else { indirect::FULL };
    let settings = Settings { indirect, candidates: 8, radius: 8.0, ..Settings::default() };
    for seed in 0..BOUNCED_RUNS {
        renderer.restart();
        let options = FrameOptions { parts: true, ..options(Work::Restir(settings), seed) };
        (0..3).for_each(|_| drop(renderer.render(camera, &options).expect("the frame renders")));
        mean.add(&what_bounced(&renderer));
    }
    mean
}

/// Resampled paths against Mitsuba's: as [`light_that_bounces_agrees_with_mitsuba`], of frames. They are noisier than paths: means have
/// standard errors of some 1 %.
#[test]
fn resampled_light_that_bounces_agrees_with_mitsuba() {
    let Some(device) = device() else { return };
    let truths =
        [("cornell-box", 1, "1"), ("cornell-box", UNBOUNDED, "inf"), ("metal-room", UNBOUNDED, "inf")];
    let scene = |name: &str| {
        bounced()
            .into_iter()
            .map(|(scene, _)| scene)
            .find(|scene| scene.name == name)
            .expect("a scene of this name")
    };
    let mut failed = Vec::new();
    for (name, bounces, depth) in truths {
        let truth = bounced_truth(&format!("{name}-bounces-{depth}"));
        let comparison = Bounced::new(&our_resampled_paths(&device, &scene(name), bounces), &truth);
        println!("| {name}, {depth} {comparison}");
        if !comparison.agrees() {
            failed.push(format!("{name}, {depth} {comparison}"));
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
    // The planted error: one bounce in place of all of them.
    let truth = bounced_truth("cornell-box-bounces-inf");
    let comparison = Bounced::new(&our_resampled_paths(&device, &scene("cornell-box"), 1), &truth);
    assert!(!comparison.agrees(), "a bounce alone was not seen: {comparison}");
    assert_no_validation_messages(&device);
}

/// Planted errors, each of which the same comparison must see: in our scene, or in Mitsuba's picture.
#[test]
fn planted_errors_are_seen() {
    let Some(device) = device() else { return };
    let against = |name: &str, truth: &str, change: &dyn Fn(&mut SceneDescription)| {
        let mut scene = named(name);
        change(&mut scene);
        Comparison::new(&our_reference(&device, &scene), &Truth::read(truth))
    };
    type Change = fn(&mut SceneDescription);
    let planted: [(&str, &str, &str, Change); 10] = [
        ("1 % more light", "point", "point", |s| s.lights.iter_mut().for_each(|l| *l.emission_mut() *= 1.01)),
        ("a light off by 2 cm", "point", "point", |s| {
            let beside =
                DAffine3::from_translation((s.lights[0].position().unwrap() + 0.02 * Vec3::X).as_dvec3());
            s.lights[0].place(&beside);
        }),
        ("a box 4 % too large", "point", "point", |s| {
            s.instances[2].transform *= Affine3A::from_scale(Vec3::splat(1.04))
        }),
        ("Smith's G of both sides multiplied", "metal", "metal-separable-smith", |_| ()),
        ("roughness off by 0.02", "metal", "metal", |s| s.materials[1].roughness += 0.02),
        ("F0 0.06 instead of 0.04", "dielectric", "dielectric", |s| {
            s.materials[0].specular = Vec3::splat(0.06)
        }),
        ("Mitsuba's own falloff of spots", "spot", "spot-mitsuba-spot", |_| ()),
        ("a sun off by half a degree", "directional", "directional", |s| {
            let turn = glam::Quat::from_rotation_y(0.5f32.to_radians());
            let PlacedLight::Directional(sun) = &mut s.lights[0] else { panic!("{:?}", s.lights) };
            sun.direction = turn * sun.direction;
        }),
        ("a texture off by a tenth of its width", "textured", "textured", |s| {
            s.materials[0].uv_maps[slot::BASE_COLOR].u.z += 0.1
        }),
        ("a mirrored sky", "environment", "environment", |s| {
            s.environment
                .iter_mut()
                .for_each(|map| map.radiance.chunks_exact_mut(16).for_each(<[_]>::reverse))
        }),
    ];
    for (error, name, truth, change) in planted {
        let comparison = against(name, truth, &change);
        println!("| {error} {comparison}");
        assert!(!comparison.agrees(), "{error} was not seen: {comparison}");
    }
    assert_no_validation_messages(&device);
}

/// Means over what is compared of each block of 8 x 8 pixels; 0 where nothing is.
fn block_means(picture: &[Vec3], truth: &Truth) -> Vec<f64> {
    let blocks = SIZE / 8;
    let mut sums = vec![(0.0, 0.0); (blocks.x * blocks.y) as usize];
    for i in (0..picture.len()).filter(|&i| truth.away_from_edges[i]) {
        let pixel = UVec2::new(i as u32 % SIZE.x, i as u32 / SIZE.x);
        let (sum, count) = &mut sums[(pixel.y / 8 * blocks.x + pixel.x / 8) as usize];
        *sum += f64::from(luminance(picture[i]));
        *count += 1.0;
    }
    sums.iter().map(|(sum, count)| sum / f64::max(*count, 1.0)).collect()
}

/// Many runs of ReSTIR against the truth.
struct Runs {
    comparison: Comparison,
    /// Largest error of a block's mean over its standard error (0.3 % of the truth counted as one more) and where.
    largest_z: (f64, usize),
}

fn runs_of_restir(device: &Gpu, scene: &SceneDescription, settings: Settings, truth: &Truth) -> Runs {
    let mut renderer = renderer(device, scene, SIZE, 1);
    let mut mean = Mean::new(SIZE);
    let mut blocks = Vec::new();
    for seed in 1..=RUNS {
        let picture = restir(&mut renderer, camera(scene), settings, 2, seed);
        blocks.push(block_means(&picture, truth));
        mean.add(&picture);
    }
    let exact: Vec<_> =
        block_means(&truth.radiance, truth).into_iter().map(|mean| (mean, MEAN_TOLERANCE * mean)).collect();
    Runs { comparison: Comparison::new(&mean, truth), largest_z: largest_z(&mean_and_error(&blocks), &exact) }
}

const RUNS: u32 = 20;
/// Over 48 blocks of 10 scenes with Student's t of 19 degrees of freedom: a false alarm in 1 % of all choices of seeds.
const Z_LIMIT: f64 = 5.9;

/// Temporal and spatial reuse with pairwise MIS, many runs of two frames: the mean is Mitsuba's within 1 %, and each block
/// of 8 x 8 pixels within its own interval. The biased mode's loss among shadows is seen.
#[test]
fn unbiased_resampling_agrees_with_mitsuba() {
    let Some(device) = device() else { return };
    let settings = small(mode::UNBIASED);
    let agrees = |runs: &Runs| (runs.comparison.mean_ratio - 1.0).abs() < 0.01 && runs.largest_z.0 < Z_LIMIT;
    let mut failed = Vec::new();
    for scene in all() {
        let truth = Truth::read(&scene.name);
        let runs = runs_of_restir(&device, &scene, settings, &truth);
        let said = format!("{} {} z {:?}", scene.name, runs.comparison, runs.largest_z);
        println!("| {said}");
        if !agrees(&runs) {
            failed.push(said);
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
    let biased = Settings { mode: mode::BIASED, ..settings };
    let runs = runs_of_restir(&device, &named("point"), biased, &Truth::read("point"));
    println!("| point, biased {} z {:?}", runs.comparison, runs.largest_z);
    assert!(!agrees(&runs), "the biased mode's loss was not seen");
    assert_no_validation_messages(&device);
}

/// Writes the scenes for tools/mitsuba to out/outside-truth.
#[test]
#[ignore = "writes to out/outside-truth"]
fn export_scenes() {
    let out: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../out/outside-truth");
    for scene in all().into_iter().chain(bounced().into_iter().map(|(scene, _)| scene)) {
        interchange::write(&scene, &scene.cameras[0], &out.join(&scene.name)).expect("the scene is written");
    }
}
