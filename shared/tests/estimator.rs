//! The whole estimator on the CPU, against the sum over all lights in closed form.
//!
//! Scene: a floor under point lights, nothing in between. Every light reaches every pixel, so the biased 1/M weights
//! have no bias here, and the mean over independent runs must be the sum.

use shared::alias_table::AliasEntry;
use shared::camera::Camera;
use shared::frame::{FrameConstants, Settings};
use shared::geometry::SurfacePoint;
use shared::glam::{DVec3, UVec2, Vec2, Vec3};
use shared::light::{Light, LightTable, Lights, build_alias_table};
use shared::material::Reflectance;
use shared::math::luminance;
use shared::resampling::{Pixels, initial, reservoir_index, spatial, temporal};
use shared::reservoir::StoredReservoir;
use shared::rng::{Rng, Stream};
use shared::shading;
use shared::surface::GBufferTexel;

const SIZE: UVec2 = UVec2::new(16, 12);
const SEEDS: u32 = 400;
/// Two-sided quantile of Student's t with SEEDS - 1 degrees of freedom at a false alarm rate of 1e-4 a case.
const T_LIMIT: f64 = 3.93;

struct Scene {
    lights: Vec<Light>,
    alias: Vec<AliasEntry>,
    gbuffer: Vec<GBufferTexel>,
    camera: Camera,
}

fn pixels() -> impl Iterator<Item = UVec2> {
    (0..SIZE.x * SIZE.y).map(|i| UVec2::new(i % SIZE.x, i / SIZE.x))
}

fn scene(lights: Vec<Light>) -> Scene {
    let camera = Camera::new(Vec3::new(0.0, 3.0, 3.0), Vec3::new(0.0, -1.0, -0.9), Vec3::Y, 0.8, SIZE);
    let gbuffer = pixels()
        .map(|pixel| {
            let direction = camera.direction(pixel.as_vec2() + 0.5, SIZE);
            let position = camera.position - direction * (camera.position.y / direction.y);
            let point = SurfacePoint {
                position,
                geometric_normal: Vec3::Y,
                normal: Vec3::Y,
                tangent: Vec3::X,
                tangent_sign: 1.0,
                uv: Vec2::ZERO,
                color: Vec3::ONE,
            };
            let reflectance = Reflectance::from_metallic_roughness(Vec3::new(0.8, 0.5, 0.3), 0.2, 0.6);
            GBufferTexel::new(&point, Vec3::Y, reflectance, 0, camera.position)
        })
        .collect();
    let alias = build_alias_table(&lights);
    Scene { lights, alias, gbuffer, camera }
}

/// Lights whose power differs by six orders of magnitude, near and far.
fn uneven_lights() -> Vec<Light> {
    (0..37)
        .map(|i| {
            let angle = i as f32 * 2.4;
            let place =
                Vec3::new(angle.cos() * i as f32 * 0.2, 0.3 + (i % 5) as f32, angle.sin() * i as f32 * 0.2);
            Light::point(place, Vec3::new(1.0, 0.7, 0.4) * 10f32.powf((i % 7) as f32 - 3.0))
        })
        .collect()
}

/// Mean luminance of the image as the sum over all lights, in f64 from the formulas of glTF's appendix B.
fn truth(scene: &Scene) -> f64 {
    let of_pixel = |pixel: UVec2| {
        let texel = &scene.gbuffer[(pixel.y * SIZE.x + pixel.x) as usize];
        let surface = texel.unpack(&scene.camera, pixel, SIZE);
        let x = surface.position.as_dvec3();
        let wo = (scene.camera.position.as_dvec3() - x).normalize();
        let sum: DVec3 = scene.lights.iter().map(|light| reflected(&surface.reflectance, x, wo, light)).sum();
        sum.dot(DVec3::new(0.2126, 0.7152, 0.0722))
    };
    pixels().map(of_pixel).sum::<f64>() / f64::from(SIZE.x * SIZE.y)
}

fn reflected(r: &Reflectance, x: DVec3, wo: DVec3, light: &Light) -> DVec3 {
    use std::f64::consts::PI;
    let to_light = light.position.as_dvec3() - x;
    let wi = to_light.normalize();
    let (ci, co) = (wi.y, wo.y);
    let h = (wi + wo).normalize();
    let a2 = f64::from(r.roughness).powi(4);
    let d = a2 / (PI * (h.y * h.y * (a2 - 1.0) + 1.0).powi(2));
    let lambda = |c: f64| ((1.0 + a2 * (1.0 / (c * c) - 1.0)).sqrt() - 1.0) / 2.0;
    let g = 1.0 / (1.0 + lambda(ci) + lambda(co));
    let f = r.f0.as_dvec3() + (1.0 - r.f0.as_dvec3()) * (1.0 - wi.dot(h)).powi(5);
    let bsdf = (1.0 - f) * r.diffuse.as_dvec3() / PI + f * d * g / (4.0 * ci * co);
    bsdf * light.emission.as_dvec3() * ci / to_light.length_squared()
}

/// Mean luminance of the last of `frames` frames, as the passes compute it.
fn run(scene: &Scene, settings: Settings, frames: u32, seed: u32) -> f64 {
    let lights = LightTable { lights: Lights::untextured(&scene.lights), alias: &scene.alias };
    let lanes = settings.reservoirs;
    let mut history = vec![StoredReservoir::default(); (SIZE.x * SIZE.y * lanes) as usize];
    let mut image = 0.0;
    for index in 0..frames {
        let frame = FrameConstants {
            camera: scene.camera,
            previous_camera: scene.camera,
            size: SIZE,
            index,
            seed,
            settings,
            exposure: 1.0,
            background: Vec3::ZERO,
            environment_size: UVec2::ZERO,
        };
        let surface =
            |pixel| scene.gbuffer[frame.pixel_index(pixel) as usize].unpack(&scene.camera, pixel, SIZE);
        let all = || (0..lanes).flat_map(|lane| pixels().map(move |pixel| (pixel, lane)));
        let mut reservoirs = vec![StoredReservoir::default(); history.len()];
        for (pixel, lane) in all() {
            let mut rng = Rng::new(pixel, index, seed, Stream::Initial, lane);
            let proposal = initial::propose(&surface(pixel), lights, settings.candidates, &mut rng);
            let i = reservoir_index(&frame, pixel, lane) as usize;
            reservoirs[i] = initial::accept(proposal, true);
            if settings.temporal != 0 {
                let previous = Pixels { gbuffer: &scene.gbuffer, reservoirs: &history };
                let mut rng = Rng::new(pixel, index, seed, Stream::Temporal, lane);
                reservoirs[i] = temporal::biased(
                    &frame,
                    lights,
                    &surface(pixel),
                    reservoirs[i],
                    previous,
                    lane,
                    &mut rng,
                );
            }
        }
        for iteration in 0..settings.spatial_iterations * settings.spatial {
            let input = Pixels { gbuffer: &scene.gbuffer, reservoirs: &reservoirs };
            reservoirs = all()
                .map(|(pixel, lane)| {
                    let mut rng = Rng::new(pixel, index, seed, Stream::Spatial, lane + lanes * iteration);
                    spatial::biased(&frame, lights, &surface(pixel), input, pixel, lane, &mut rng)
                })
                .collect();
        }
        image = pixels()
            .map(|pixel| f64::from(luminance(shaded(&frame, lights, &surface(pixel), &reservoirs, pixel))))
            .sum();
        history = reservoirs;
    }
    image / f64::from(SIZE.x * SIZE.y)
}

fn shaded(
    frame: &FrameConstants,
    lights: LightTable<'_>,
    surface: &shared::surface::Surface,
    reservoirs: &[StoredReservoir],
    pixel: UVec2,
) -> Vec3 {
    let mut average = shading::Average::default();
    for lane in 0..frame.settings.reservoirs {
        let stored = reservoirs[reservoir_index(frame, pixel, lane) as usize];
        average.add(shading::propose(surface, lights, stored), true);
    }
    average.radiance()
}

/// Student's t of the mean over SEEDS independent runs against the truth.
fn t_statistic(scene: &Scene, truth: f64, settings: Settings, frames: u32) -> f64 {
    let runs: Vec<f64> = (0..SEEDS).map(|seed| run(scene, settings, frames, seed + 1)).collect();
    let n = f64::from(SEEDS);
    let mean = runs.iter().sum::<f64>() / n;
    let variance = runs.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
    println!(
        "mean {mean}, truth {truth}, relative {:+.4}, noise {:.4}",
        mean / truth - 1.0,
        variance.sqrt() / truth
    );
    (mean - truth) / (variance / n).sqrt()
}

fn cases() -> Vec<(&'static str, Settings, u32)> {
    let base =
        Settings { candidates: 4, radius: 4.0, neighbors: 3, spatial: 0, temporal: 0, ..Settings::default() };
    let spatial = Settings { spatial: 1, spatial_iterations: 1, ..base };
    let temporal = Settings { temporal: 1, ..base };
    vec![
        ("RIS, M = 1", Settings { candidates: 1, ..base }, 1),
        ("RIS, M = 4", base, 1),
        ("RIS, M = 32", Settings { candidates: 32, ..base }, 1),
        ("three reservoirs", Settings { reservoirs: 3, ..base }, 1),
        ("spatial", spatial, 1),
        ("spatial, twice", Settings { spatial_iterations: 2, ..spatial }, 1),
        ("temporal", temporal, 5),
        ("temporal, cap 1", Settings { confidence_cap: 1.0, ..temporal }, 5),
        ("everything", Settings { temporal: 1, spatial_iterations: 2, reservoirs: 2, ..spatial }, 5),
    ]
}

#[test]
fn every_combination_of_reuse_has_the_right_mean() {
    let scene = scene(uneven_lights());
    let truth = truth(&scene);
    for (name, settings, frames) in cases() {
        let t = t_statistic(&scene, truth, settings, frames);
        assert!(t.abs() < T_LIMIT, "{name}: t = {t}");
    }
}

/// Negative controls: what the test above must not let through.
#[test]
fn planted_errors_are_seen() {
    let settings = Settings { candidates: 32, temporal: 0, spatial: 0, ..Settings::default() };
    let right = scene(uneven_lights());
    let truth = truth(&right);
    let mut wrong_pmf = scene(uneven_lights());
    for entry in &mut wrong_pmf.alias {
        entry.pmf *= 1.05;
        entry.alias_pmf *= 1.05;
    }
    let mut lost_light = scene(uneven_lights());
    lost_light.lights[20].emission = Vec3::ZERO;
    let mut missing_threshold = scene(uneven_lights());
    for entry in &mut missing_threshold.alias {
        entry.threshold = u32::MAX;
    }
    for (name, planted) in
        [("pmf 5 % off", wrong_pmf), ("a light lost", lost_light), ("thresholds ignored", missing_threshold)]
    {
        let t = t_statistic(&planted, truth, settings, 1);
        assert!(t.abs() > T_LIMIT, "{name} was not seen: t = {t}");
    }
}

/// One light leaves nothing to chance: RIS gives the exact answer in every pixel, up to the f32 of the evaluation.
#[test]
fn a_single_light_is_exact() {
    let scene = scene(vec![Light::point(Vec3::new(0.5, 2.0, 0.3), Vec3::splat(100.0))]);
    for (name, settings, frames) in cases() {
        let error = run(&scene, settings, frames, 3) / truth(&scene) - 1.0;
        assert!(error.abs() < 1e-4, "{name}: relative error {error}");
    }
}
