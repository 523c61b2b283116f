//! The truth: the picture that errors are measured against.
//!
//! Where the sum over all lights is affordable it is the truth: of a scene with nothing but points, spots and parallel light,
//! and nothing transparent, one pass is exact. Else passes with other random numbers are averaged until their own standard
//! error is small enough: at first by what the plan says, then, when points are known, by the smallest of their errors. Where there are too many lights for a sum, independent frames of plain resampling take its place: no
//! temporal, no spatial, no visibility reuse, no tiles, no cells, whose mean is the same (the tests hold them against the sum).

use super::plan::TruthPlan;
use crate::measure::mean::Mean;
use crate::measure::metrics::rel_mse_of_errors;
use candela::error::Result;
use candela::frame::renderer::{FrameOptions, Renderer};
use candela::frame::schedule::{Primary, Work};
use candela::gpu_scene::GpuScene;
use glam::{UVec2, Vec3};
use serde::{Deserialize, Serialize};
use shared::camera::Camera;
use shared::frame::features::{self, light_kind};
use shared::frame::{Settings, indirect, mode};
use shared::light::{KINDS, KindFacts};

#[derive(Clone, Debug)]
pub struct Truth {
    pub size: UVec2,
    /// nit, linear RGB, rows from the top.
    pub radiance: Vec<Vec3>,
    pub about: AboutTruth,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct AboutTruth {
    pub key: String,
    pub method: Method,
    /// Passes or frames.
    pub samples: u32,
    /// Of light that bounces, a pixel of each of them.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub paths: u32,
    /// √relMSE that the truth itself is expected to have; 0 where it is exact.
    pub error: f64,
    /// It has the most samples that the plan allows, and its error is still above the wanted part of the point's smallest.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub capped: bool,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    #[default]
    SumOverLights,
    IndependentFrames,
}

fn is_zero(number: &u32) -> bool {
    *number == 0
}

/// Paths of a pixel in one frame: short enough that no driver's watchdog bites, many enough to read few pictures back.
pub const PATHS_A_FRAME: u32 = 8;

/// Such frames beside one sum over all lights.
const PATH_FRAMES: u32 = 4;

/// Candidates of a frame that stands in for the sum.
const CANDIDATES: u32 = 128;

/// Far from the seeds of what is judged.
const SEED: u32 = 0x7275_7468;

/// Does one pass give the truth of a scene with these lights and features?
pub struct Lighting {
    pub lights: u32,
    /// Nothing has an extent: no triangles, no environment.
    pub points_only: bool,
    pub features: u32,
    /// As in the pictures that are judged: pixels on edges see the same side.
    pub primary: Primary,
    /// How often light may bounce on its way to what a pixel sees.
    pub bounces: u32,
}

impl Lighting {
    /// Direct light alone.
    pub fn new(scene: &GpuScene, primary: Primary) -> Self {
        let (lights, features) = (scene.light_count(), scene.features());
        let is_there = |kind: &KindFacts| features & light_kind(kind.kind) != 0;
        let points_only = KINDS.iter().filter(|kind| is_there(kind)).all(|kind| !kind.has_extent);
        Self { lights, points_only, features, primary, bounces: 0 }
    }

    pub fn is_exact(&self) -> bool {
        self.points_only && self.features & features::ALPHA == 0 && self.bounces == 0
    }
}

/// Goes on from `mean` until the standard error is `wanted` (√relMSE), or there are `plan.max_samples`. `tick` is called after
/// each sample.
pub fn converge(
    renderer: &mut Renderer,
    camera: Camera,
    lighting: &Lighting,
    plan: &TruthPlan,
    wanted: f64,
    mean: &mut Mean,
    mut tick: impl FnMut(),
) -> Result<Truth> {
    let size = renderer.size();
    let rays = f64::from(size.x) * f64::from(size.y) * f64::from(lighting.lights);
    let by_sum = rays <= plan.max_rays;
    let work = if by_sum { Work::Reference { lights: lighting.lights } } else { Work::Restir(independent()) };
    let exact = by_sum && lighting.is_exact();
    let most = if exact { 1 } else { plan.max_samples.max(FEWEST) };
    // A stretch of samples has a seed of its own: the renderer counts its frames from 0 again.
    let seed = SEED.wrapping_add(mean.count());
    let mut error = error_of(mean, exact);
    renderer.restart();
    while error > wanted && mean.count() < most {
        for _ in mean.count()..next_look(mean.count(), error / wanted).min(most) {
            let mut frame = |work| {
                renderer.render(camera, &FrameOptions::new(work, lighting.primary, seed))?;
                renderer.radiance()
            };
            let mut radiance = frame(work)?;
            for _ in 0..if lighting.bounces > 0 { PATH_FRAMES } else { 0 } {
                let paths = frame(Work::Paths { bounces: lighting.bounces, paths: PATHS_A_FRAME })?;
                radiance.iter_mut().zip(paths).for_each(|(sum, paths)| *sum += paths / PATH_FRAMES as f32);
            }
            mean.add(&radiance);
            tick();
        }
        error = error_of(mean, exact);
    }
    let method = if by_sum { Method::SumOverLights } else { Method::IndependentFrames };
    let paths = if lighting.bounces > 0 { PATH_FRAMES * PATHS_A_FRAME } else { 0 };
    let about = AboutTruth { method, samples: mean.count(), paths, error, ..AboutTruth::default() };
    Ok(Truth { size, radiance: mean.radiance(), about })
}

/// Sums over all lights at the points that the last frame of `renderer`, made with `options`, shaded; with light that bounces if that
/// frame has it. `samples` of them where lights have an extent or something is transparent. The frame after it knows nothing of
/// them.
pub fn at_points(
    renderer: &mut Renderer,
    camera: Camera,
    options: &FrameOptions,
    samples: u32,
) -> Result<Mean> {
    let bounces = match options.work {
        Work::Restir(settings) => indirect::bounces(settings.indirect),
        _ => 0,
    };
    let lighting = Lighting { bounces, ..Lighting::new(renderer.scene(), options.primary) };
    let mut mean = Mean::new(renderer.size());
    for sample in 0..if lighting.is_exact() { 1 } else { samples } {
        let seed = options.seed.wrapping_add(AT_POINTS + sample);
        let mut frame = |work| {
            renderer.render(camera, &FrameOptions { work, seed, parts: false, ..*options })?;
            renderer.radiance()
        };
        let mut radiance = frame(Work::Truth { lights: lighting.lights })?;
        if bounces > 0 {
            let paths = frame(Work::TruthPaths { bounces, paths: PATHS_A_FRAME })?;
            radiance.iter_mut().zip(paths).for_each(|(sum, paths)| *sum += paths);
        }
        mean.add(&radiance);
    }
    Ok(mean)
}

/// Far from the seed of the frame.
const AT_POINTS: u32 = 0x7472_7574;

/// Fewer say nothing about their spread.
const FEWEST: u32 = 4;

fn error_of(mean: &Mean, exact: bool) -> f64 {
    match mean.count() {
        0 => f64::INFINITY,
        _ if exact => 0.0,
        count if count < FEWEST => f64::INFINITY,
        _ => rel_mse_of_errors(&mean.standard_errors(), &mean.radiance()).sqrt(),
    }
}

/// How many samples to have before the error is looked at again, which costs about as much as one: where it is expected to be
/// small enough, but soon enough to learn whether that was right. `times`: how often too large the error is.
fn next_look(count: u32, times: f64) -> u32 {
    let n = f64::from(count);
    let expected = (n * times * times).clamp(n * 1.1, n * 2.0);
    (expected.ceil() as u32).max(FEWEST)
}

fn independent() -> Settings {
    Settings {
        candidates: CANDIDATES,
        visibility_reuse: 0,
        temporal: 0,
        spatial: 0,
        mode: mode::UNBIASED,
        tiles: 0,
        cells: 0,
        reservoirs: 1,
        ..Settings::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn looks_come_where_the_error_is_expected_to_be_right() {
        assert_eq!(next_look(0, f64::INFINITY), FEWEST);
        assert_eq!(next_look(4, f64::INFINITY), 8);
        // 20 % too large: 44 % more samples.
        assert_eq!(next_look(100, 1.2), 144);
        assert_eq!((next_look(100, 1.001), next_look(100, 50.0)), (111, 200));
    }

    #[test]
    fn errors_of_few_samples_are_unknown() {
        let mut mean = Mean::new(UVec2::ONE);
        assert_eq!(error_of(&mean, true), f64::INFINITY);
        for i in 0..4 {
            assert_eq!(error_of(&mean, false), f64::INFINITY, "{i} samples");
            mean.add(&[Vec3::splat(1.0 + i as f32)]);
        }
        // Mean 2.5, standard error √(5/3/4).
        let expected = (5.0f64 / 12.0 / (6.25 * 1.001)).sqrt();
        assert!((error_of(&mean, false) - expected).abs() < 1e-9);
        assert_eq!(error_of(&mean, true), 0.0);
    }
}
