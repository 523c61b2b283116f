//! The whole estimator on the CPU, against the sum over all lights in closed form.
//!
//! Scene: a floor under point lights. With nothing in between, every light reaches every pixel, so the biased 1/M weights
//! have no bias, and the mean over independent runs must be the sum; with a screen in between, the unbiased mode's must.

use shared::alias_table::AliasEntry;
use shared::camera::Camera;
use shared::frame::{FrameConstants, Settings, mode};
use shared::geometry::SurfacePoint;
use shared::glam::{DVec3, UVec2, Vec2, Vec3};
use shared::light::{Light, LightTable, Lights, build_alias_table};
use shared::material::Reflectance;
use shared::math::luminance;
use shared::resampling::{Pixels, initial, reservoir_index, spatial, temporal};
use shared::reservoir::StoredReservoir;
use shared::rng::{Rng, Stream};
use shared::shading;
use shared::shadow::ShadowRay;
use shared::surface::GBufferTexel;
use shared::surface::Surface;

const SIZE: UVec2 = UVec2::new(16, 12);
const SEEDS: u32 = 400;
/// Two-sided quantile of Student's t with SEEDS - 1 degrees of freedom at a false alarm rate of 1e-4 a case.
const T_LIMIT: f64 = 3.93;

struct Scene {
    lights: Vec<Light>,
    alias: Vec<AliasEntry>,
    gbuffer: Vec<GBufferTexel>,
    camera: Camera,
    /// A square screen at y = 0.25, |x| < 0.6, |z| < 0.6, seen by shadow rays only.
    screen: bool,
    /// Planted error: neighbors claim to see every canonical sample.
    deaf: bool,
}

impl Scene {
    fn visible(&self, from: DVec3, to: DVec3) -> bool {
        let at = from + (to - from) * ((0.25 - from.y) / (to.y - from.y));
        !(self.screen && to.y > 0.25 && at.x.abs() < 0.6 && at.z.abs() < 0.6)
    }

    fn trace(&self, ray: ShadowRay) -> bool {
        self.visible(ray.origin.as_dvec3(), (ray.origin + ray.direction).as_dvec3())
    }
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
    Scene { lights, alias, gbuffer, camera, screen: false, deaf: false }
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
        let lit = scene.lights.iter().filter(|light| scene.visible(x, light.position.as_dvec3()));
        let sum: DVec3 = lit.map(|light| reflected(&surface.reflectance, x, wo, light)).sum();
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
            let reuse = settings.visibility_reuse != 0;
            let fresh = initial::accept(proposal, !reuse || scene.trace(proposal.ray));
            let previous = Pixels { gbuffer: &scene.gbuffer, reservoirs: &history };
            reservoirs[i] =
                reuse_history(scene, &frame, lights, &surface(pixel), fresh, previous, lane, pixel);
        }
        for iteration in 0..settings.spatial_iterations * settings.spatial {
            let input = Pixels { gbuffer: &scene.gbuffer, reservoirs: &reservoirs };
            reservoirs = all()
                .map(|(pixel, lane)| {
                    let rng = Rng::new(pixel, index, seed, Stream::Spatial, lane + lanes * iteration);
                    reuse_neighbors(scene, &frame, lights, &surface(pixel), input, lane, pixel, rng)
                })
                .collect();
        }
        image = pixels()
            .map(|pixel| {
                f64::from(luminance(shaded(scene, &frame, lights, &surface(pixel), &reservoirs, pixel)))
            })
            .sum();
        history = reservoirs;
    }
    image / f64::from(SIZE.x * SIZE.y)
}

/// The temporal pass of one pixel, as the shaders have it.
#[allow(clippy::too_many_arguments)]
fn reuse_history(
    scene: &Scene,
    frame: &FrameConstants,
    lights: LightTable<'_>,
    surface: &Surface,
    fresh: StoredReservoir,
    previous: Pixels<'_>,
    lane: u32,
    pixel: UVec2,
) -> StoredReservoir {
    let mut rng = Rng::new(pixel, frame.index, frame.seed, Stream::Temporal, lane);
    if frame.settings.temporal == 0 {
        return fresh;
    }
    if frame.settings.mode == mode::BIASED {
        return temporal::biased(frame, lights, surface, fresh, previous, lane, &mut rng);
    }
    let Some(proposal) = temporal::propose(frame, lights, surface, fresh, previous, lane) else {
        return fresh;
    };
    let blind = !frame.settings.visibility_is_known();
    let visible = blind || scene.trace(proposal.ray);
    let merged = temporal::accept(lights, surface, fresh, proposal, visible, &mut rng);
    initial::accept(merged, blind || scene.trace(merged.ray))
}

/// The spatial pass of one pixel, as the shaders have it.
#[allow(clippy::too_many_arguments)]
fn reuse_neighbors(
    scene: &Scene,
    frame: &FrameConstants,
    lights: LightTable<'_>,
    surface: &Surface,
    pixels: Pixels<'_>,
    lane: u32,
    pixel: UVec2,
    mut rng: Rng,
) -> StoredReservoir {
    if frame.settings.mode == mode::BIASED {
        return spatial::biased(frame, lights, surface, pixels, pixel, lane, &mut rng);
    }
    let blind = !frame.settings.visibility_is_known();
    let proposal = spatial::propose(frame, lights, surface, pixels, pixel, lane, &mut rng);
    let visible = blind || proposal.is_certain() || scene.deaf || scene.trace(proposal.ray);
    let merged = spatial::accept(surface, lights, proposal, visible, &mut rng);
    initial::accept(merged, blind || scene.trace(merged.ray))
}

fn shaded(
    scene: &Scene,
    frame: &FrameConstants,
    lights: LightTable<'_>,
    surface: &Surface,
    reservoirs: &[StoredReservoir],
    pixel: UVec2,
) -> Vec3 {
    let mut average = shading::Average::default();
    for lane in 0..frame.settings.reservoirs {
        let stored = reservoirs[reservoir_index(frame, pixel, lane) as usize];
        let proposal = shading::propose(surface, lights, stored);
        average.add(proposal, scene.trace(proposal.ray));
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

fn unbiased_cases() -> Vec<(&'static str, Settings, u32)> {
    let unbiased = |(name, settings, frames)| (name, Settings { mode: mode::UNBIASED, ..settings }, frames);
    let with_visibility = cases().into_iter().skip(4).map(unbiased);
    let blind = |(name, s, frames)| (name, Settings { visibility_reuse: 0, ..s }, frames);
    with_visibility.clone().chain(with_visibility.map(blind)).collect()
}

#[test]
fn unbiased_reuse_has_the_right_mean_behind_a_screen() {
    let scene = Scene { screen: true, ..scene(uneven_lights()) };
    let truth = truth(&scene);
    for (name, settings, frames) in unbiased_cases() {
        let t = t_statistic(&scene, truth, settings, frames);
        assert!(t.abs() < T_LIMIT, "{name}, visibility reuse {}: t = {t}", settings.visibility_reuse);
    }
}

/// Negative controls for the unbiased mode: 1/M weights, and MIS weights without the neighbors' rays, are seen.
#[test]
fn planted_errors_of_the_unbiased_mode_are_seen() {
    let right = Scene { screen: true, ..scene(uneven_lights()) };
    let truth = truth(&right);
    let biased = Settings { candidates: 32, radius: 4.0, temporal: 0, ..Settings::default() };
    let t = t_statistic(&right, truth, biased, 1);
    assert!(t.abs() > T_LIMIT, "the biased mode's bias was not seen: t = {t}");
    let deaf = Scene { deaf: true, ..right };
    let t = t_statistic(&deaf, truth, Settings { mode: mode::UNBIASED, ..biased }, 1);
    assert!(t.abs() > T_LIMIT, "rays left out of the MIS weights were not seen: t = {t}");
}
