//! Sweeps: every point of a plan measured, whatever happens to single ones, and nothing measured twice.

pub mod about;
pub mod film;
pub mod pictures;
pub mod plan;
pub mod point;
pub mod steady;
pub mod store;
pub mod truth;

use crate::measure::mean::Mean;
use about::About;
use candela::error::{Error, Result};
use candela::frame::renderer::Renderer;
use candela::frame::schedule::Primary;
use candela::gpu_scene::GpuScene;
use candela::knobs::Indirect;
use candela::scene::{self, Illumination, SceneDescription, SceneSource};
use candela::vulkan::{Device, DeviceOptions};
use plan::{Plan, PointSpec};
use point::Measurement;
use serde::{Deserialize, Serialize};
use shared::camera::Camera;
use shared::frame::indirect;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use store::Store;
use truth::{Lighting, Truth};

/// Changes with every change of what a number means: older results are then measured again.
const METHOD: u32 = 3;

/// What a sweep leaves behind.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Results {
    pub about: About,
    pub plan: Plan,
    pub rows: Vec<Row>,
}

/// A row of a table.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Row {
    pub scene: String,
    pub lights: usize,
    pub camera: String,
    pub series: String,
    pub label: String,
    /// None where measuring failed.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub measured: Option<Measurement>,
    /// Why it failed.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub error: Option<String>,
}

pub struct Sweep<'a> {
    pub plan: &'a Plan,
    /// Folder that the plan's paths start at.
    pub base: PathBuf,
    pub points: Vec<PointSpec>,
    pub store: Store,
    pub device: DeviceOptions,
    pub progress: &'a dyn Progress,
}

/// Who wants to know how far a sweep is.
pub trait Progress {
    /// So many frames more are rendered, or need not be.
    fn advance(&self, frames: u64);
    /// It goes on.
    fn tick(&self);
    /// What is done now.
    fn enter(&self, stage: &'static str);
    /// One line for each finished point.
    fn say(&self, line: &str);
}

impl PointSpec {
    /// What `--only` looks at.
    pub fn name(&self, plan: &Plan) -> String {
        let camera = self.camera.as_deref().map_or(String::new(), |c| format!(" {c}"));
        let scene = &plan.scenes[self.scene].name;
        format!("{scene} {}{camera} / {} / {}", self.lights, self.series, self.label)
    }
}

/// A scene under one number of lights, and what it needs on the device once something must be measured.
struct Bench<'a> {
    scene: SceneDescription,
    scene_key: String,
    reservoirs: u32,
    device: &'a mut Option<Device>,
    renderer: Option<Renderer>,
}

impl Sweep<'_> {
    /// All rows, in the plan's order, and the device that measured the last. `done` is called after each with the rows so far.
    pub fn run(
        &self,
        mut done: impl FnMut(&About, &[Row]) -> Result<()>,
    ) -> Result<(About, Vec<Row>, Option<Device>)> {
        // Without a device nothing can be measured: the one error that ends a sweep at its start.
        let mut device = Some(Device::new(&self.device)?);
        let about = About::new(device.as_ref().map(Device::info));
        let mut rows = Vec::new();
        let same = |a: &PointSpec, b: &PointSpec| (a.scene, a.lights) == (b.scene, b.lights);
        for group in self.points.chunk_by(same) {
            let mut bench = self.bench(&group[0], group, &mut device);
            for spec in group {
                let measured = match &mut bench {
                    Ok(bench) => self.point(bench, spec, &about).map_err(|error| error.to_string()),
                    Err(error) => Err(error.to_string()),
                };
                let row = self.row(spec, measured);
                self.report(&row, rows.len() + 1);
                rows.push(row);
                done(&about, &rows)?;
            }
        }
        Ok((about, rows, device))
    }

    fn bench<'a>(
        &self,
        spec: &PointSpec,
        group: &[PointSpec],
        device: &'a mut Option<Device>,
    ) -> Result<Bench<'a>> {
        let place = &self.plan.scenes[spec.scene];
        let source = match SceneSource::named(&place.source) {
            SceneSource::File(path) => SceneSource::File(self.base.join(path)),
            built_in => built_in,
        };
        let mut scene = scene::load(&source, &Illumination::points(spec.lights))?;
        if self.plan.motion.is_some() && place.moving_lights > 0.0 {
            film::circle_lights(&mut scene, place.moving_lights);
        }
        let scene_key = store::scene_key(&scene);
        let reservoirs = group.iter().map(|p| p.settings.reservoirs).max().unwrap_or(1);
        Ok(Bench { scene, scene_key, reservoirs, device, renderer: None })
    }

    /// From the store, or measured now.
    fn point(&self, bench: &mut Bench, spec: &PointSpec, about: &About) -> Result<Measurement> {
        let plan = self.plan;
        let camera = spec.camera.as_deref();
        let view = match &plan.motion {
            Some(motion) => film::first_camera(motion, camera, &mut bench.scene)?,
            None => bench.scene.camera(camera)?,
        };
        let camera = view.seen_in(plan.size());
        let place =
            (METHOD, &about.device, &about.shaders, &bench.scene_key, bytemuck::bytes_of(&camera), plan.size);
        let runs = (plan.warm_up, plan.frames, plan.replicas, plan.seed, plan.steady);
        let accumulate = plan.accumulate.as_ref().map(|a| (a.ms, a.frames));
        // A truth that must be better goes on from what there is: only its method makes it another.
        let lit = (&place, plan.truth.max_rays, spec.settings.primary);
        let truth_key = match spec.settings.indirect {
            Indirect::Off => store::key(&lit)?,
            bounces => store::key(&(lit, bounces))?,
        };
        let moves =
            plan.motion.as_ref().map(|motion| (motion, &spec.camera, plan.scenes[spec.scene].moving_lights));
        let key = store::key(&(&place, &plan.truth, &spec.settings, spec.denoise, runs, accumulate, moves))?;
        if let Some(known) = self.store.point(&key).filter(|_| !plan.times_only) {
            self.progress.advance(point::frames_of(plan));
            return Ok(known);
        }
        let measure = || self.measure(bench, camera, spec, &truth_key);
        // A bug in one point must not cost the others.
        let outcome = catch_unwind(AssertUnwindSafe(measure)).unwrap_or_else(|panic| {
            let words = panic.downcast_ref::<String>().cloned();
            let words = words.or_else(|| panic.downcast_ref::<&str>().map(|s| (*s).to_owned()));
            Err(Error::Internal(words.unwrap_or_default()))
        });
        if outcome.is_err() {
            // Whatever went wrong, the next point starts with a new device.
            bench.renderer = None;
            *bench.device = None;
        }
        let measured = Measurement {
            key: key.clone(),
            scene: bench.scene.name.clone(),
            triangles: bench.scene.triangle_count(),
            camera: view.name,
            size: plan.size,
            warm_up: plan.warm_up,
            frames: plan.frames,
            replicas: plan.replicas,
            ..outcome?
        };
        if !plan.times_only {
            self.store.save_point(&key, &measured)?;
        }
        Ok(measured)
    }

    fn measure(
        &self,
        bench: &mut Bench,
        camera: Camera,
        spec: &PointSpec,
        truth_key: &str,
    ) -> Result<Measurement> {
        let plan = self.plan;
        let renderer = match &mut bench.renderer {
            Some(renderer) => renderer,
            none => {
                let device = match &mut *bench.device {
                    Some(device) => device,
                    none => none.insert(Device::new(&self.device)?),
                };
                let scene = GpuScene::new(device, &bench.scene)?;
                none.insert(Renderer::new(device, scene, plan.size(), bench.reservoirs)?)
            }
        };
        let tick = || self.progress.advance(1);
        let measured = if let Some(motion) = &plan.motion {
            film::measure(renderer, &mut bench.scene, plan, motion, spec, tick)?
        } else if plan.times_only {
            point::measure(renderer, camera, plan, spec, None, tick)?
        } else {
            self.judged(renderer, camera, spec, truth_key)?
        };
        let light_count = renderer.scene().light_count();
        let memory = renderer.scene().bytes() + renderer.target_bytes();
        Ok(Measurement { light_count, memory, ..measured })
    }

    /// Measured, and again with a better truth for as long as the truth's own error is no small part of the point's smallest.
    fn judged(
        &self,
        renderer: &mut Renderer,
        camera: Camera,
        spec: &PointSpec,
        truth_key: &str,
    ) -> Result<Measurement> {
        let plan = &self.plan.truth;
        let mut wanted = plan.error;
        loop {
            let settings = &spec.settings;
            let about = (truth_key, settings.primary, indirect::bounces(settings.indirect.into()));
            let truth = self.truth(renderer, camera, about, wanted)?;
            let tick = || self.progress.advance(1);
            let mut measured = point::measure(renderer, camera, self.plan, spec, Some(&truth), tick)?;
            let Some(judged) = &mut measured.judged else { return Ok(measured) };
            let enough = plan.part * judged.smallest_error();
            judged.truth.capped = truth.about.error > enough && truth.about.samples >= plan.max_samples;
            if truth.about.error <= enough || judged.truth.capped {
                return Ok(measured);
            }
            // A better truth makes the point's error a little smaller too.
            wanted = 0.95 * enough;
        }
    }

    /// With an error of at most `wanted`, or with all samples that the plan allows.
    fn truth(
        &self,
        renderer: &mut Renderer,
        camera: Camera,
        (key, primary, bounces): (&str, Primary, u32),
        wanted: f64,
    ) -> Result<Truth> {
        let plan = &self.plan.truth;
        let good = |t: &Truth| t.about.error <= wanted || t.about.samples >= plan.max_samples;
        if let Some(known) = self.store.truth(key).filter(good) {
            return Ok(known);
        }
        let lighting = Lighting { bounces, ..Lighting::new(renderer.scene(), primary) };
        self.progress.enter("reference");
        let size = renderer.size();
        let mut mean = self.store.truth_state(key, size).unwrap_or_else(|| Mean::new(size));
        let mut truth =
            truth::converge(renderer, camera, &lighting, plan, wanted, &mut mean, || self.progress.tick())?;
        truth.about.key = key.into();
        self.progress.enter("measuring");
        self.store.save_truth(key, &truth, &mean)?;
        Ok(truth)
    }

    fn row(&self, spec: &PointSpec, measured: Result<Measurement, String>) -> Row {
        let (measured, error) = match measured {
            Ok(measured) => (Some(measured), None),
            Err(error) => (None, Some(error)),
        };
        let camera = measured.as_ref().map(|m| m.camera.clone()).or(spec.camera.clone());
        Row {
            scene: self.plan.scenes[spec.scene].name.clone(),
            lights: spec.lights,
            camera: camera.unwrap_or_default(),
            series: spec.series.clone(),
            label: spec.label.clone(),
            measured,
            error,
        }
    }

    fn report(&self, row: &Row, number: usize) {
        let what = match (&row.measured, &row.error) {
            (Some(m), _) => {
                let error = m.judged.as_ref().map(|j| format!(", relMSE {:.4}", j.error.rel_mse.mean));
                let moving =
                    |film: &film::Film| format!(", SMAPE {:.4} in motion", film.in_motion(|p| p.smape.mean));
                let error = error.or(m.film.as_ref().map(moving));
                format!("{:.3} ms{}", m.frame.median, error.unwrap_or_default())
            }
            (None, error) => format!("FAILED: {}", error.as_deref().unwrap_or_default()),
        };
        let Row { scene, lights, series, label, .. } = row;
        let total = self.points.len();
        self.progress.say(&format!("{number}/{total} {scene} {lights} / {series} / {label}: {what}"));
    }
}
