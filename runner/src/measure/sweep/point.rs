//! One point of a sweep: its times, its errors, what accumulation makes of it.

use super::plan::Plan;
use super::truth::{AboutTruth, Truth};
use crate::error::Result;
use crate::exposure;
use crate::frame::renderer::{FrameOptions, Renderer, StepTimes};
use crate::frame::schedule::Work;
use crate::measure::mean::Mean;
use crate::measure::metrics::{self, Metrics, Stability};
use crate::measure::statistics::{Interval, Times};
use crate::measure::times::PassTimes;
use crate::settings_file::SettingsFile;
use glam::{UVec2, Vec3};
use serde::{Deserialize, Serialize};
use shared::camera::Camera;
use shared::math::luminance;
use std::time::Instant;

/// Everything that is known about a point.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Measurement {
    pub key: String,
    pub scene: String,
    pub triangles: usize,
    /// In the light table: also triangles and texels.
    pub light_count: u32,
    pub camera: String,
    pub size: [u32; 2],
    pub settings: SettingsFile,
    pub warm_up: u32,
    pub frames: u32,
    pub replicas: u32,
    /// What the times are read from.
    pub clock: Clock,
    /// ms of each pass, in frame order.
    pub passes: Vec<(String, Times)>,
    /// ms of whole frames.
    pub frame: Times,
    /// Of the last frame, over the runs.
    pub error: Errors,
    pub stability: Stability,
    /// Means of the first frames of a history.
    pub curve: Vec<CurvePoint>,
    pub truth: AboutTruth,
    /// Device memory of scene and targets, bytes.
    pub memory: u64,
    /// A part of the last frame of the first run, as a JPEG in Base64.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub picture: String,
    /// The same part of the truth.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub reference_picture: String,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Clock {
    /// Timestamps on the device, between passes.
    #[default]
    Gpu,
    /// The host's clock around whole frames: the device has no timestamps.
    Wall,
}

/// [`Metrics`] over independent runs.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    pub rel_mse: Interval,
    pub rmse: Interval,
    pub r_mae: Interval,
    pub mape: Interval,
    pub smape: Interval,
    pub energy_ratio: Interval,
    pub bias: Interval,
    /// Of the first run.
    pub flip: f64,
    /// √relMSE of the mean over all runs, less what its variance adds: what no number of runs brings to zero.
    pub lasting_error: f64,
    pub not_finite: usize,
}

/// The mean of the first `frames` frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CurvePoint {
    pub frames: u32,
    /// All passes of all of these frames, mean over the runs.
    pub ms: f64,
    pub rel_mse: Interval,
    pub r_mae: Interval,
    pub energy_ratio: Interval,
}

/// Largest part of a picture that reports show, pixels.
const SHOWN: UVec2 = UVec2::new(640, 360);

/// Frames that [`measure`] renders, about.
pub fn frames_of(plan: &Plan) -> u64 {
    let accumulated = plan.accumulate.as_ref().map_or(0, |a| a.frames.min(256));
    u64::from(plan.replicas) * u64::from(plan.warm_up + plan.frames + accumulated)
}

/// Fills times, errors, stability, curve and picture. `tick` is called after each frame.
pub fn measure(
    renderer: &mut Renderer,
    camera: Camera,
    plan: &Plan,
    settings: &SettingsFile,
    truth: &Truth,
    mut tick: impl FnMut(),
) -> Result<Measurement> {
    let lights = renderer.scene().light_count();
    let mut run = Run { renderer, camera, work: Work::Restir(settings.settings(lights)), clock: Clock::Gpu };
    let mut point =
        Measurement { settings: settings.clone(), truth: truth.about.clone(), ..Measurement::default() };
    let mut times = PassTimes::default();
    let (mut all, mut pairs, mut mean) = (Vec::new(), Vec::new(), Mean::new(truth.size));
    for replica in 0..plan.replicas {
        let last = run.history(plan, replica, &mut times, &mut tick)?;
        let judged = if replica == 0 {
            point.picture = encode_part(&last[1], truth)?;
            point.reference_picture = encode_part(&truth.radiance, truth)?;
            metrics::with_flip(&last[1], &truth.radiance, truth.size).0
        } else {
            metrics::metrics(&last[1], &truth.radiance)
        };
        all.push(judged);
        mean.add(&last[1]);
        pairs.push(last.map(|frame| frame.iter().map(|&c| luminance(c)).collect::<Vec<f32>>()));
    }
    point.error = errors(&all, &mean, &truth.radiance);
    point.stability = metrics::stability(&pairs);
    point.passes = times.passes().into_iter().map(|(stem, t)| (stem.to_owned(), t)).collect();
    point.frame = times.frames();
    point.curve = run.curve(plan, truth, &mut tick)?;
    point.clock = run.clock;
    Ok(point)
}

/// A renderer set on one camera and one work.
struct Run<'a> {
    renderer: &'a mut Renderer,
    camera: Camera,
    work: Work,
    clock: Clock,
}

impl Run<'_> {
    /// One frame's steps and ms.
    fn frame(&mut self, seed: u32) -> Result<(StepTimes, f64)> {
        let start = Instant::now();
        let options = FrameOptions { work: self.work, seed, exposure: 1.0, background: Vec3::ZERO };
        let steps = self.renderer.render(self.camera, &options)?.unwrap_or_else(|| {
            self.clock = Clock::Wall;
            vec![("frame", start.elapsed().as_secs_f64() * 1e3)]
        });
        let ms = steps.iter().map(|(_, ms)| ms).sum();
        Ok((steps, ms))
    }

    /// A fresh history; gives its last two frames.
    fn history(
        &mut self,
        plan: &Plan,
        replica: u32,
        times: &mut PassTimes,
        tick: &mut impl FnMut(),
    ) -> Result<[Vec<Vec3>; 2]> {
        self.renderer.restart();
        let mut before = Vec::new();
        let count = plan.warm_up + plan.frames;
        for frame in 0..count {
            let (steps, _) = self.frame(plan.seed + 1 + replica)?;
            if frame >= plan.warm_up {
                times.add(Some(steps));
            }
            if frame + 2 == count {
                before = self.renderer.radiance()?;
            }
            tick();
        }
        Ok([before, self.renderer.radiance()?])
    }

    /// Errors of means of frames from fresh histories, at frame counts a factor of √2 apart.
    fn curve(&mut self, plan: &Plan, truth: &Truth, tick: &mut impl FnMut()) -> Result<Vec<CurvePoint>> {
        let Some(accumulate) = &plan.accumulate else { return Ok(Vec::new()) };
        let mut runs: Vec<Vec<(u32, f64, Metrics)>> = Vec::new();
        for replica in 0..plan.replicas {
            let mut checkpoints = Vec::new();
            self.renderer.restart();
            let (mut mean, mut ms) = (Mean::new(truth.size), 0.0);
            while mean.count() < accumulate.frames && ms < accumulate.ms {
                ms += self.frame(plan.seed + 1 + replica)?.1;
                mean.add(&self.renderer.radiance()?);
                if is_checkpoint(mean.count()) {
                    let judged = metrics::metrics(&mean.radiance(), &truth.radiance);
                    checkpoints.push((mean.count(), ms, judged));
                }
                tick();
            }
            runs.push(checkpoints);
        }
        Ok(merge(&runs))
    }
}

/// 1, 2, 3, 4, 6, 8, 11, 16, ...: the rounded powers of √2.
fn is_checkpoint(n: u32) -> bool {
    let nearest = (2.0 * f64::from(n).log2()).round();
    (nearest / 2.0).exp2().round() as u32 == n
}

/// Checkpoints that every run has.
fn merge(runs: &[Vec<(u32, f64, Metrics)>]) -> Vec<CurvePoint> {
    let count = runs.iter().map(Vec::len).min().unwrap_or(0);
    let at = |i: usize| {
        let of = |value: &dyn Fn(&(u32, f64, Metrics)) -> f64| {
            Interval::of(&runs.iter().map(|run| value(&run[i])).collect::<Vec<_>>())
        };
        CurvePoint {
            frames: runs[0][i].0,
            ms: of(&|p| p.1).mean,
            rel_mse: of(&|p| p.2.rel_mse),
            r_mae: of(&|p| p.2.r_mae),
            energy_ratio: of(&|p| p.2.energy_ratio),
        }
    };
    (0..count).map(at).collect()
}

fn errors(runs: &[Metrics], mean: &Mean, truth: &[Vec3]) -> Errors {
    let of = |value: &dyn Fn(&Metrics) -> f64| Interval::of(&runs.iter().map(value).collect::<Vec<_>>());
    let of_mean = metrics::metrics(&mean.radiance(), truth).rel_mse;
    let of_noise = metrics::rel_mse_of_errors(&mean.standard_errors(), truth);
    Errors {
        rel_mse: of(&|m| m.rel_mse),
        rmse: of(&|m| m.rmse),
        r_mae: of(&|m| m.r_mae),
        mape: of(&|m| m.mape),
        smape: of(&|m| m.smape),
        energy_ratio: of(&|m| m.energy_ratio),
        bias: of(&|m| m.bias),
        flip: runs.first().and_then(|m| m.flip).unwrap_or(0.0),
        lasting_error: (of_mean - of_noise).max(0.0).sqrt(),
        not_finite: runs.iter().map(|m| m.not_finite).sum(),
    }
}

/// The middle of a picture as reports show it, under the truth's exposure.
pub fn encode_part(radiance: &[Vec3], truth: &Truth) -> Result<String> {
    use base64::Engine;
    let exposure = exposure::automatic(&truth.radiance, 0.0);
    let part = SHOWN.min(truth.size);
    let corner = (truth.size - part) / 2;
    let jpeg = crate::image_io::jpeg(part, |x, y| {
        let c = radiance[((corner.y + y) * truth.size.x + corner.x + x) as usize];
        shared::tonemap::display(if c.is_finite() { c } else { Vec3::ZERO }, exposure)
    })?;
    Ok(base64::engine::general_purpose::STANDARD.encode(jpeg))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checkpoints_are_half_octaves() {
        let points: Vec<u32> = (1..200).filter(|&n| is_checkpoint(n)).collect();
        assert_eq!(points, [1, 2, 3, 4, 6, 8, 11, 16, 23, 32, 45, 64, 91, 128, 181]);
    }

    /// Two runs around a truth of 1: x = 1.5 and 2.5 for one pixel. Their mean 2 is off by 1; its variance is 0.25.
    #[test]
    fn lasting_error_is_what_the_noise_leaves() {
        let truth = [Vec3::ONE];
        let mut mean = Mean::new(UVec2::ONE);
        let runs: Vec<Metrics> = [1.5, 2.5]
            .map(|x| {
                mean.add(&[Vec3::splat(x)]);
                metrics::metrics(&[Vec3::splat(x)], &truth)
            })
            .to_vec();
        let e = errors(&runs, &mean, &truth);
        assert!((e.lasting_error - (0.75f64 / 1.001).sqrt()).abs() < 1e-6, "{}", e.lasting_error);
        assert!((e.rel_mse.mean - (0.25 + 2.25) / 2.0 / 1.001).abs() < 1e-6);
        assert_eq!(e.energy_ratio.mean, 2.0);
    }

    #[test]
    fn curves_end_where_the_shortest_run_ends() {
        let run = |n: u32, x: f64| {
            (1..=n)
                .map(|i| (i, x * f64::from(i), Metrics { rel_mse: x, ..Metrics::default() }))
                .collect::<Vec<_>>()
        };
        let merged = merge(&[run(3, 1.0), run(2, 3.0)]);
        assert_eq!(merged.len(), 2);
        assert_eq!((merged[1].frames, merged[1].ms, merged[1].rel_mse.mean), (2, 4.0, 2.0));
    }
}
