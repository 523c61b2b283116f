//! What to measure: a TOML document, expanded to points. Its syntax is docs/measuring.md.

use super::steady::SteadyPlan;
use candela::error::{Error, Result};
use candela::files;
use candela::knobs::Knobs;
use candela::scene::lights::MAX_LIGHTS;
use candela_assets::PLANS;
use glam::UVec2;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// Most points of a plan: lists of knobs multiply.
const MAX_POINTS: usize = 100_000;

#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plan {
    pub title: String,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Times alone: no truth, no errors, no pictures. Such points are measured anew by each sweep.
    #[serde(default)]
    pub times_only: bool,
    /// Load before each run, until the time of a frame stands still.
    #[serde(default)]
    pub steady: SteadyPlan,
    /// Frames of a run before the timed ones: histories fill.
    #[serde(default = "default_warm_up")]
    pub warm_up: u32,
    /// Timed frames of a run; the last one is judged.
    #[serde(default = "default_frames")]
    pub frames: u32,
    /// Independent runs: what confidence intervals come from.
    #[serde(default = "default_replicas")]
    pub replicas: u32,
    #[serde(default)]
    pub seed: u32,
    /// Knobs of all points.
    #[serde(default)]
    pub settings: Table,
    #[serde(rename = "scene")]
    pub scenes: Vec<PlanScene>,
    pub series: Vec<Series>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub accumulate: Option<Accumulate>,
    /// Films in place of frames at rest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion: Option<MotionPlan>,
    #[serde(default)]
    pub truth: TruthPlan,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlanScene {
    pub name: String,
    /// As on the command line; a file's path starts at the plan.
    pub source: PathBuf,
    #[serde(default = "default_lights")]
    pub lights: Vec<usize>,
    /// By name, number or position; the scene's first one if there are none. Of a motion: one that moves, one that stands while
    /// things move, or `from > to`, a cut.
    #[serde(default)]
    pub cameras: Vec<String>,
    /// Of a motion: point lights go round circles of this radius, m.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub moving_lights: f64,
}

/// Points that stand together in a table.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Series {
    pub name: String,
    /// Names of scenes; all if there are none.
    #[serde(default)]
    pub scenes: Vec<String>,
    /// Knobs of this series; a list is an axis, and several axes give every combination.
    #[serde(default)]
    pub settings: Table,
    /// Named rows in place of axes.
    #[serde(default, rename = "arm")]
    pub arms: Vec<Arm>,
}

#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Arm {
    pub name: String,
    #[serde(default)]
    pub settings: Table,
    /// Judge what is denoised.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub denoise: bool,
}

/// A film: at rest, in motion, at rest again; see [`super::film`].
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MotionPlan {
    /// Pictures a second.
    pub fps: f32,
    /// Frames at rest before the motion, the last one of which is judged.
    pub rest: u32,
    /// Frames in motion; of a cut there are none.
    pub moving: u32,
    /// Frames after the stop or the cut.
    pub after: u32,
    /// Every so many pictures in motion one is judged, and the one after it.
    pub every: u32,
    /// So many pictures from the beginning of the motion on are judged as a film.
    pub film: u32,
    /// Points drawn on each light with an extent, of a picture's truth.
    pub truth_samples: u32,
}

impl Default for MotionPlan {
    fn default() -> Self {
        MotionPlan { fps: 60.0, rest: 33, moving: 48, after: 33, every: 8, film: 0, truth_samples: 16 }
    }
}

impl MotionPlan {
    /// The first mistake, in one line.
    fn check(&self) -> Result<(), String> {
        let MotionPlan { fps, rest, moving, after, every, truth_samples, .. } = *self;
        if !(fps > 0.0 && fps <= 1000.0) || [rest, after, truth_samples].contains(&0) {
            return Err(
                "motion: fps is above 0 and at most 1000; rest, after and truth_samples are above 0".into()
            );
        }
        if every < 2 || [rest, moving, after].iter().any(|frames| *frames > 100_000) {
            return Err("motion: every is at least 2; rest, moving and after are at most 100000".into());
        }
        Ok(())
    }
}

fn is_zero(number: &f64) -> bool {
    *number == 0.0
}

/// Means of more and more frames: what is reached after so many ms.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Accumulate {
    /// Ends a run: ms of passes, or frames, whichever comes first.
    pub ms: f64,
    #[serde(default = "default_accumulated")]
    pub frames: u32,
    /// relMSE to reach.
    #[serde(default = "default_targets")]
    pub targets: Vec<f64>,
}

/// How the truth is found; see [`super::truth`].
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TruthPlan {
    /// The sum over all lights, if it needs at most so many rays; else a mean of independent frames.
    pub max_rays: f64,
    /// Standard error to begin with, as √relMSE of the truth.
    pub error: f64,
    /// Wanted standard error, as a part of the smallest error that is judged by it: the truth goes on until it is there.
    pub part: f64,
    /// Frames, or sums, to stop at.
    pub max_samples: u32,
}

fn default_warm_up() -> u32 {
    10
}
fn default_frames() -> u32 {
    10
}
fn default_replicas() -> u32 {
    4
}
fn default_lights() -> Vec<usize> {
    vec![500]
}
fn default_accumulated() -> u32 {
    4096
}
fn default_targets() -> Vec<f64> {
    vec![0.3, 0.1, 0.03, 0.01]
}

impl Default for TruthPlan {
    fn default() -> Self {
        TruthPlan { max_rays: 4e9, error: 0.01, part: 0.1, max_samples: 4096 }
    }
}

/// One row of a table: what is measured, and where it stands.
#[derive(Clone, Debug)]
pub struct PointSpec {
    /// Index of the plan's scene.
    pub scene: usize,
    pub lights: usize,
    pub camera: Option<String>,
    pub series: String,
    /// Arm and values of the axes.
    pub label: String,
    pub settings: Knobs,
    /// What is judged is denoised.
    pub denoise: bool,
}

impl Plan {
    /// A built-in plan by its name, or a file; with the folder that its paths start at.
    pub fn read(path: &Path) -> Result<(Plan, PathBuf)> {
        if let Some((_, text)) = PLANS.iter().find(|(name, _)| path.as_os_str() == *name) {
            return Ok((Plan::parse(text, path)?, PathBuf::new()));
        }
        let text = files::read_text(path)?;
        Ok((Plan::parse(&text, path)?, path.parent().unwrap_or(Path::new("")).into()))
    }

    fn parse(text: &str, path: &Path) -> Result<Plan> {
        let plan: Plan = toml::from_str(text).map_err(|e| {
            let line = e.span().map_or(0, |span| text[..span.start].matches('\n').count() + 1);
            let message = e.message().replace('\n', " ");
            Error::input(path)(format!("line {line}: {message}"))
        })?;
        plan.check().map_err(Error::input(path))?;
        Ok(plan)
    }

    /// The first mistake, in one line.
    pub fn check(&self) -> Result<(), String> {
        if self.size.iter().any(|side| !(1..=16384).contains(side)) {
            return Err("size: width and height go from 1 to 16384".into());
        }
        if self.frames < 2 || self.replicas < 1 {
            return Err("frames: at least 2; replicas: at least 1".into());
        }
        // Results are JSON, which has no others.
        if !self.numbers().all(f64::is_finite) {
            return Err("a plan can't have inf or nan".into());
        }
        self.steady.check()?;
        if let Some(motion) = &self.motion {
            motion.check()?;
            if self.times_only || self.accumulate.is_some() {
                return Err("motion: neither with times_only nor with accumulate".into());
            }
        }
        if self.times_only && self.accumulate.is_some() {
            return Err("times_only: there is nothing to accumulate without errors".into());
        }
        if self.truth.part <= 0.0 || self.truth.max_samples == 0 {
            return Err("truth: part and max_samples are above 0".into());
        }
        let names: Vec<_> = self.scenes.iter().map(|s| s.name.as_str()).collect();
        for series in &self.series {
            if let Some(unknown) = series.scenes.iter().find(|s| !names.contains(&s.as_str())) {
                let known = names.join(", ");
                return Err(format!("series '{}': no scene '{unknown}' (there are {known})", series.name));
            }
        }
        if let Some(accumulate) = &self.accumulate
            && (accumulate.ms <= 0.0 || accumulate.frames == 0)
        {
            return Err("accumulate: ms and frames are above 0".into());
        }
        if let Some(lights) = self.scenes.iter().flat_map(|s| &s.lights).find(|&&n| n > MAX_LIGHTS) {
            return Err(format!("lights: {lights} are more than {MAX_LIGHTS}"));
        }
        // Before there are any: they may be more than memory holds.
        match self.count() {
            0 => return Err("it has no points: add a [[scene]] and a [[series]]".into()),
            count if count > MAX_POINTS => {
                return Err(format!("its lists multiply to more than {MAX_POINTS} points; split it"));
            }
            _ => self.points()?,
        };
        Ok(())
    }

    /// Those that a plan may give as anything, knobs aside.
    fn numbers(&self) -> impl Iterator<Item = f64> {
        let SteadyPlan { ms, window_ms, within, max_ms } = self.steady;
        let TruthPlan { max_rays, error, part, .. } = self.truth;
        let moving = self.scenes.iter().map(|scene| scene.moving_lights);
        let accumulated = self.accumulate.iter().flat_map(|a| a.targets.iter().copied().chain([a.ms]));
        [ms, window_ms, within, max_ms, max_rays, error, part].into_iter().chain(accumulated).chain(moving)
    }

    pub fn size(&self) -> UVec2 {
        UVec2::from(self.size)
    }

    /// How many points there are.
    fn count(&self) -> usize {
        let values = |knobs: &Table| {
            knobs.values().map(|v| v.as_array().map_or(1, Vec::len)).fold(1, usize::saturating_mul)
        };
        let rows = |series: &Series| {
            series.arms().iter().map(|arm| values(&self.knobs(series, arm))).fold(0, usize::saturating_add)
        };
        let of_scene = |place: &PlanScene| {
            let drawn = self.series.iter().filter(|series| series.draws(place)).map(rows);
            let views = place.lights.len().saturating_mul(place.cameras.len().max(1));
            drawn.fold(0, usize::saturating_add).saturating_mul(views)
        };
        self.scenes.iter().map(of_scene).fold(0, usize::saturating_add)
    }

    /// What an arm sets, lists of values among it.
    fn knobs(&self, series: &Series, arm: &Arm) -> Table {
        let mut knobs = self.settings.clone();
        knobs.extend(series.settings.clone());
        knobs.extend(arm.settings.clone());
        knobs
    }

    /// Every point; scene by scene, lights by lights, camera by camera.
    pub fn points(&self) -> Result<Vec<PointSpec>, String> {
        let mut points = Vec::new();
        for (scene, place) in self.scenes.iter().enumerate() {
            for &lights in &place.lights {
                let cameras: Vec<Option<String>> = match &place.cameras[..] {
                    [] => vec![None],
                    names => names.iter().cloned().map(Some).collect(),
                };
                for camera in cameras {
                    for series in &self.series {
                        if series.draws(place) {
                            for (label, settings, denoise) in self.rows(series)? {
                                let (camera, series) = (camera.clone(), series.name.clone());
                                let spec =
                                    PointSpec { scene, lights, camera, series, label, settings, denoise };
                                points.push(spec);
                            }
                        }
                    }
                }
            }
        }
        Ok(points)
    }

    /// (label, settings, denoised) of a series.
    fn rows(&self, series: &Series) -> Result<Vec<(String, Knobs, bool)>, String> {
        let mut rows = Vec::new();
        for arm in series.arms().iter() {
            for (values, knobs) in combinations(&self.knobs(series, arm)) {
                let name = (!arm.name.is_empty()).then(|| arm.name.clone());
                let label = name.into_iter().chain(values).collect::<Vec<_>>().join(", ");
                let label = if label.is_empty() { series.name.clone() } else { label };
                let wrong = |reason: String| format!("series '{}', {label}: {reason}", series.name);
                let settings: Knobs =
                    knobs.try_into().map_err(|e: toml::de::Error| wrong(e.message().replace('\n', " ")))?;
                settings.check().map_err(wrong)?;
                rows.push((label, settings, arm.denoise));
            }
        }
        Ok(rows)
    }
}

impl Series {
    /// Its arms, or the one that sets nothing.
    fn arms(&self) -> Cow<'_, [Arm]> {
        match self.arms.is_empty() {
            true => vec![Arm::default()].into(),
            false => self.arms.as_slice().into(),
        }
    }

    fn draws(&self, place: &PlanScene) -> bool {
        self.scenes.is_empty() || self.scenes.contains(&place.name)
    }
}

/// Each choice of one value from every list: ("knob value" of the lists, knobs).
fn combinations(knobs: &Table) -> Vec<(Vec<String>, Table)> {
    let mut all = vec![(Vec::new(), Table::new())];
    for (name, value) in knobs {
        let Value::Array(values) = value else {
            all.iter_mut().for_each(|(_, knobs)| drop(knobs.insert(name.clone(), value.clone())));
            continue;
        };
        let with = |(labels, knobs): &(Vec<String>, Table), value: &Value| {
            let (mut labels, mut knobs) = (labels.clone(), knobs.clone());
            labels.push(match value {
                Value::Boolean(on) => format!("{name} {}", if *on { "on" } else { "off" }),
                Value::String(text) => format!("{name} {text}"),
                Value::Integer(number) => format!("{name} {number}"),
                Value::Float(number) => format!("{name} {number}"),
                other => format!("{name} {other:?}"),
            });
            knobs.insert(name.clone(), value.clone());
            (labels, knobs)
        };
        all = all.iter().flat_map(|row| values.iter().map(|v| with(row, v)).collect::<Vec<_>>()).collect();
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use candela::knobs::Mode;

    const SMALL: &str = r#"
        title = "small"
        size = [8, 8]
        settings = { candidates = 4 }
        [[scene]]
        name = "a"
        source = "knot"
        lights = [1, 2]
        [[scene]]
        name = "b"
        source = "b.glb"
        cameras = ["0", "1"]
        [[series]]
        name = "axes"
        scenes = ["a"]
        settings = { candidates = [8, 16], temporal = [true, false] }
        [[series]]
        name = "arms"
        [[series.arm]]
        name = "right"
        settings = { mode = "unbiased" }
        [[series.arm]]
        name = "plain"
    "#;

    fn parse(text: &str) -> Result<Plan, String> {
        Plan::parse(text, Path::new("p.toml")).map_err(|e| e.to_string())
    }

    #[test]
    fn lists_are_axes_and_arms_are_rows() {
        let points = parse(SMALL).unwrap().points().unwrap();
        // a: 2 counts x (4 + 2); b: 2 cameras x 2.
        assert_eq!(points.len(), 2 * 6 + 2 * 2);
        let labels: Vec<_> = points[..6].iter().map(|p| p.label.as_str()).collect();
        let expected = [
            "candidates 8, temporal on",
            "candidates 8, temporal off",
            "candidates 16, temporal on",
            "candidates 16, temporal off",
            "right",
            "plain",
        ];
        assert_eq!(labels, expected);
        assert_eq!((points[1].settings.candidates, points[1].settings.temporal), (8, false));
        assert_eq!((points[4].settings.mode, points[4].settings.candidates), (Mode::Unbiased, 4));
        assert_eq!((points[6].lights, points[12].camera.as_deref()), (2, Some("0")));
    }

    #[test]
    fn built_in_plans_are_whole() {
        for (name, _) in PLANS {
            let (plan, _) = Plan::read(Path::new(name)).unwrap();
            println!("{name}: {} points", plan.points().unwrap().len());
        }
    }

    #[test]
    fn mistakes_are_one_line_that_names_them() {
        // Settings that would fit no memory: they are counted, not made.
        let numbers = format!("{:?}", vec![1; 1 << 20]);
        for (from, to, words) in [
            ("title = \"small\"", "titel = 1", "unknown field `titel`"),
            ("candidates = 4", "candidate = 4", "unknown field `candidate`"),
            ("candidates = [8, 16]", "candidates = [8, 2000]", "candidates 2000"),
            ("scenes = [\"a\"]", "scenes = [\"c\"]", "no scene 'c' (there are a, b)"),
            ("size = [8, 8]", "size = [8, 0]", "size"),
            ("lights = [1, 2]", "lights = [1, 99999999]", "99999999 are more than"),
            (
                "candidates = [8, 16]",
                &format!("candidates = {numbers}, neighbors = {numbers}"),
                "100000 points",
            ),
            ("size = [8, 8]", "size = [8, ", "line 4"),
            ("size = [8, 8]", "size = [8, 8]\naccumulate = { ms = 0 }", "above 0"),
            ("size = [8, 8]", "size = [8, 8]\ntruth = { part = 0.0 }", "above 0"),
            ("size = [8, 8]", "size = [8, 8]\nsteady = { within = 0.0 }", "within"),
            ("size = [8, 8]", "size = [8, 8]\ntruth = { error = nan }", "inf or nan"),
            ("size = [8, 8]", "size = [8, 8]\naccumulate = { ms = inf }", "inf or nan"),
            ("size = [8, 8]", "size = [8, 8]\naccumulate = { ms = 1, targets = [nan] }", "inf or nan"),
            ("size = [8, 8]", "size = [8, 8]\ntimes_only = true\naccumulate = { ms = 1 }", "times_only"),
        ] {
            assert!(SMALL.contains(from), "{from}");
            let error = parse(&SMALL.replacen(from, to, 1)).unwrap_err();
            assert!(
                error.contains(words) && error.contains("p.toml") && !error.contains('\n'),
                "{to}: {error}"
            );
        }
    }
}
