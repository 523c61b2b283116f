//! One point of a sweep: its times, its errors, and those of its accumulated mean.

use super::film::{self, Film};
use super::pictures;
use super::plan::{Plan, PointSpec};
use super::steady::{Settled, Watch};
use super::truth::{AboutTruth, Truth};
use crate::measure::mean::Mean;
use crate::measure::metrics::{self, Metrics, Stability};
use crate::measure::statistics::{Interval, Times};
use crate::measure::times::PassTimes;
use candela::error::Result;
use candela::frame::renderer::{FrameOptions, Renderer, StepTimes};
use candela::frame::schedule::Work;
use candela::knobs::Knobs;
use glam::Vec3;
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
    pub settings: Knobs,
    pub warm_up: u32,
    pub frames: u32,
    pub replicas: u32,
    /// What the times are read from.
    pub clock: Clock,
    /// How the waits before the runs ended; the worst of them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub settled: Option<Settled>,
    /// ms of each pass, in frame order.
    pub passes: Vec<(String, Times)>,
    /// ms of whole frames.
    pub frame: Times,
    /// None where times alone were asked for.
    #[serde(flatten)]
    pub judged: Option<Judged>,
    /// In place of `judged` where a plan has a motion; times are then those of frames in motion.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub film: Option<Film>,
    /// Device memory of scene and targets, bytes.
    pub memory: u64,
    /// A part of the last frame of the first run, as a JPEG in Base64.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub picture: String,
    /// The same part of the truth.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub reference_picture: String,
    /// FLIP over that part, at half its size.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub error_map: String,
}

/// What is known of a point's errors.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Judged {
    /// Of the last frame, over the runs.
    pub error: Errors,
    pub stability: Stability,
    /// Means of the first frames of a history.
    pub curve: Vec<CurvePoint>,
    pub truth: AboutTruth,
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
    /// None in results from before it was measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub chroma: Option<Interval>,
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
    /// All passes of all of these frames, as the timed runs had them: nothing is read back between those.
    pub ms: f64,
    pub rel_mse: Interval,
    pub r_mae: Interval,
    pub energy_ratio: Interval,
}

/// Frames that [`measure`] renders, about.
pub fn frames_of(plan: &Plan) -> u64 {
    if let Some(motion) = &plan.motion {
        return film::frames_of(motion, plan.replicas);
    }
    let accumulated = plan.accumulate.as_ref().map_or(0, |a| a.frames.min(256));
    u64::from(plan.replicas) * [plan.warm_up, plan.frames, accumulated].map(u64::from).iter().sum::<u64>()
}

/// Fills times and, with a `truth`, errors, stability, curve and pictures. `tick` is called after each frame.
pub fn measure(
    renderer: &mut Renderer,
    camera: Camera,
    plan: &Plan,
    spec: &PointSpec,
    truth: Option<&Truth>,
    mut tick: impl FnMut(),
) -> Result<Measurement> {
    let mut run = Run { camera, ..Run::new(renderer, spec) };
    let mut point = Measurement { settings: spec.settings.clone(), ..Measurement::default() };
    let mut times = Timed::default();
    let mut frames = Vec::new();
    for replica in 0..plan.replicas {
        let settled = run.settle(plan)?;
        point.settled = Some(point.settled.map_or(settled, |before| before.worst(settled)));
        frames.extend(run.history(plan, replica, &mut times, truth.is_some(), &mut tick)?);
    }
    point.passes = times.passes.passes().into_iter().map(|(stem, t)| (stem.to_owned(), t)).collect();
    point.frame = times.passes.frames();
    if let Some(truth) = truth {
        let mut judged = point.judge(&frames, truth)?;
        drop(frames);
        judged.curve = run.curve(plan, truth, &times.costs(plan), &mut tick)?;
        point.judged = Some(judged);
    }
    point.clock = run.clock;
    Ok(point)
}

impl Measurement {
    /// Errors of the last two frames of each run; fills the pictures.
    fn judge(&mut self, runs: &[[Vec<Vec3>; 2]], truth: &Truth) -> Result<Judged> {
        let (mut all, mut mean) = (Vec::new(), Mean::new(truth.size));
        for [_, last] in runs {
            all.push(metrics::metrics(last, &truth.radiance));
            mean.add(last);
        }
        if let (Some([_, last]), Some(first)) = (runs.first(), all.first_mut()) {
            let (with_flip, map) = metrics::with_flip(last, &truth.radiance, truth.size);
            *first = with_flip;
            self.picture = pictures::part(last, truth)?;
            self.reference_picture = pictures::part(&truth.radiance, truth)?;
            self.error_map = pictures::error_map(&map, truth.size)?;
        }
        let grey = |frame: &Vec<Vec3>| frame.iter().map(|&c| luminance(c)).collect::<Vec<f32>>();
        let pairs: Vec<_> = runs.iter().map(|run| run.each_ref().map(grey)).collect();
        Ok(Judged {
            error: errors(&all, &mean, &truth.radiance),
            stability: metrics::stability(&pairs),
            curve: Vec::new(),
            truth: truth.about.clone(),
        })
    }
}

impl Judged {
    /// √relMSE of the best picture that is judged; infinite if all are without error.
    pub fn smallest_error(&self) -> f64 {
        let errors =
            self.curve.iter().map(|p| p.rel_mse.mean).chain([self.error.rel_mse.mean]).map(f64::sqrt);
        errors.filter(|e| *e > 0.0).fold(f64::INFINITY, f64::min)
    }
}

/// ms of passes, and of each frame of a run.
#[derive(Default)]
struct Timed {
    passes: PassTimes,
    /// By the frame's number in its run, one value a run; nothing is read back before these frames.
    by_number: Vec<Vec<f64>>,
}

impl Timed {
    /// ms of the first n frames of a history, for n = 1, 2, ..: up to the plan's time. Frames beyond the timed runs take the median.
    fn costs(&self, plan: &Plan) -> Vec<f64> {
        let Some(accumulate) = &plan.accumulate else { return Vec::new() };
        let (mut total, later) = (0.0, self.passes.frames().median);
        let mut costs = Vec::new();
        while costs.len() < accumulate.frames as usize && total < accumulate.ms {
            let known = self.by_number.get(costs.len());
            total += known.map_or(later, |runs| runs.iter().sum::<f64>() / runs.len() as f64);
            costs.push(total);
        }
        costs
    }
}

/// A renderer set on one camera and one work.
pub struct Run<'a> {
    pub renderer: &'a mut Renderer,
    pub camera: Camera,
    /// But for the seed.
    options: FrameOptions,
    clock: Clock,
}

impl<'a> Run<'a> {
    /// From the world's origin.
    pub fn new(renderer: &'a mut Renderer, spec: &PointSpec) -> Self {
        let (knobs, camera) =
            (&spec.settings, Camera::new(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 1.0, renderer.size()));
        let settings = knobs.settings(renderer.scene().lights());
        let settings = if spec.denoise { settings.for_a_mean() } else { settings };
        let options = FrameOptions::new(Work::Restir(settings), knobs.primary, 0);
        let options = FrameOptions { denoise: spec.denoise, ..options };
        Run { renderer, camera, options, clock: Clock::Gpu }
    }
}

impl Run<'_> {
    pub fn clock(&self) -> Clock {
        self.clock
    }

    pub fn options(&self, seed: u32) -> FrameOptions {
        FrameOptions { seed, ..self.options }
    }

    /// One frame's steps and ms.
    pub fn frame(&mut self, seed: u32) -> Result<(StepTimes, f64)> {
        let start = Instant::now();
        let options = self.options(seed);
        let steps = self.renderer.render(self.camera, &options)?.unwrap_or_else(|| {
            self.clock = Clock::Wall;
            vec![("frame", start.elapsed().as_secs_f64() * 1e3)]
        });
        let ms = steps.iter().map(|(_, ms)| ms).sum();
        Ok((steps, ms))
    }

    /// Renders until the time of a frame stands still.
    pub fn settle(&mut self, plan: &Plan) -> Result<Settled> {
        let (start, mut watch) = (Instant::now(), Watch::new(plan.steady));
        loop {
            let (_, ms) = self.frame(plan.seed)?;
            if let Some(settled) = watch.add(ms, start.elapsed().as_secs_f64() * 1e3) {
                return Ok(settled);
            }
        }
    }

    /// A fresh history; gives its last two frames if they are `read`.
    fn history(
        &mut self,
        plan: &Plan,
        replica: u32,
        times: &mut Timed,
        read: bool,
        tick: &mut impl FnMut(),
    ) -> Result<Option<[Vec<Vec3>; 2]>> {
        self.renderer.restart();
        let mut before = Vec::new();
        let count = plan.warm_up + plan.frames;
        times.by_number.resize(count as usize - 1, Vec::new());
        for frame in 0..count {
            let (steps, ms) = self.frame(plan.seed + 1 + replica)?;
            if let Some(runs) = times.by_number.get_mut(frame as usize) {
                runs.push(ms);
            }
            if frame >= plan.warm_up {
                times.passes.add(Some(steps));
            }
            if read && frame + 2 == count {
                before = self.renderer.radiance()?;
            }
            tick();
        }
        read.then(|| Ok([before, self.renderer.radiance()?])).transpose()
    }

    /// Errors of means of frames from fresh histories, at frame counts a factor of √2 apart. `costs`: ms of the first frames.
    fn curve(
        &mut self,
        plan: &Plan,
        truth: &Truth,
        costs: &[f64],
        tick: &mut impl FnMut(),
    ) -> Result<Vec<CurvePoint>> {
        let mut checkpoints: Vec<(u32, Vec<Metrics>)> = Vec::new();
        for replica in 0..plan.replicas {
            self.renderer.restart();
            let (mut mean, mut next) = (Mean::new(truth.size), 0);
            for _ in costs {
                self.frame(plan.seed + 1 + replica)?;
                mean.add(&self.renderer.radiance()?);
                if is_checkpoint(mean.count()) {
                    checkpoints.resize(checkpoints.len().max(next + 1), (mean.count(), Vec::new()));
                    checkpoints[next].1.push(metrics::metrics(&mean.radiance(), &truth.radiance));
                    next += 1;
                }
                tick();
            }
        }
        Ok(checkpoints.iter().map(|(frames, runs)| CurvePoint::new(*frames, costs, runs)).collect())
    }
}

/// 1, 2, 3, 4, 6, 8, 11, 16, ...: the rounded powers of √2.
pub fn is_checkpoint(n: u32) -> bool {
    let nearest = (2.0 * f64::from(n).log2()).round();
    (nearest / 2.0).exp2().round() as u32 == n
}

impl CurvePoint {
    fn new(frames: u32, costs: &[f64], runs: &[Metrics]) -> Self {
        let of = |value: &dyn Fn(&Metrics) -> f64| Interval::of(&runs.iter().map(value).collect::<Vec<_>>());
        CurvePoint {
            frames,
            ms: costs[frames as usize - 1],
            rel_mse: of(&|m| m.rel_mse),
            r_mae: of(&|m| m.r_mae),
            energy_ratio: of(&|m| m.energy_ratio),
        }
    }
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
        chroma: Some(of(&|m| m.chroma)),
        energy_ratio: of(&|m| m.energy_ratio),
        bias: of(&|m| m.bias),
        flip: runs.first().and_then(|m| m.flip).unwrap_or(0.0),
        lasting_error: (of_mean - of_noise).max(0.0).sqrt(),
        not_finite: runs.iter().map(|m| m.not_finite).sum(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec2;

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

    /// Two runs of 3 frames (the last one of each is not counted: a read came before it), then the median.
    #[test]
    fn a_curve_costs_what_frames_without_reads_cost() {
        let text = "title = 'x'\nsize = [1, 1]\naccumulate = { ms = 12, frames = 9 }\n[[scene]]\nname = 'a'\nsource = 'knot'\n\
                    [[series]]\nname = 's'";
        let mut plan: Plan = toml::from_str(text).unwrap();
        let mut times = Timed { by_number: vec![vec![1.0, 3.0], vec![4.0, 6.0]], ..Timed::default() };
        for ms in [3.0, 4.0, 2.0] {
            times.passes.add(Some(vec![("pass", ms)]));
        }
        assert_eq!(times.costs(&plan), [2.0, 7.0, 10.0, 13.0]);
        plan.accumulate.as_mut().unwrap().frames = 3;
        assert_eq!(times.costs(&plan), [2.0, 7.0, 10.0]);
        plan.accumulate = None;
        assert!(times.costs(&plan).is_empty());
    }

    /// Results keep one form: what is judged lies beside the rest, and may be missing.
    #[test]
    fn points_are_read_as_they_were_written() {
        let mut point = Measurement { settled: None, ..Measurement::default() };
        for judged in [None, Some(Judged::default())] {
            point.judged = judged;
            let value = serde_json::to_value(&point).unwrap();
            assert_eq!(value.get("error").is_some(), point.judged.is_some());
            let read: Measurement = serde_json::from_value(value).unwrap();
            assert_eq!(read.judged.is_some(), point.judged.is_some());
        }
    }
}
