//! Records the frames of one scene into command buffers; whoever submits them decides when to wait.

use super::history::History;
use super::pass::{Step, barriers};
use super::pipelines::{PassPipeline, Pipelines, SHADERS, draw, reads_past};
use super::rays;
use super::schedule::{Conditions, Points, Primary, Rotation, Work, looks, schedule};
use super::targets::Target;
use crate::error::{Error, Result};
use crate::gpu_scene::GpuScene;
use crate::scene::SceneDescription;
use crate::scene::animation::Pose;
use crate::scene::lights::LightEdits;
use crate::vulkan::{Buffer, Device, Memory, PushSet, Timestamps, debug_label, memory_barrier};
use ash::vk;
use glam::Vec3;
use shared::camera::Camera;
use shared::frame::{FrameConstants, Settings, features};
use shared::interface::PassConstants;
use shared::math::CENTER;
use shared::passes::Pass;
use shared::passes::points::TURNS;
use shared::resources::{Resource, set};

use vk::{AccessFlags as Access, PipelineStageFlags as PipelineStage};

/// Stages that read a frame's constants.
const READERS: PipelineStage = PipelineStage::from_raw(
    SHADERS.as_raw() | PipelineStage::VERTEX_SHADER.as_raw() | PipelineStage::FRAGMENT_SHADER.as_raw(),
);

/// What a frame is made with, beside its camera.
///
/// ```
/// use candela::frame::renderer::FrameOptions;
/// use candela::frame::schedule::{Primary, Work};
/// use candela::knobs::Knobs;
///
/// // A frame of ReSTIR in a scene of 500 lights, for the eye; and the sum over all lights, as the truth.
/// let settings = Knobs { candidates: 16, ..Knobs::default() }.settings(500);
/// let frame = FrameOptions { exposure: 0.5, ..FrameOptions::new(Work::Restir(settings), Primary::Auto, 0).finished() };
/// let truth = FrameOptions::new(Work::Reference { lights: 500 }, Primary::Auto, 0);
/// assert!(frame.denoise && frame.antialias && !truth.denoise);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct FrameOptions {
    /// What is rendered.
    pub work: Work,
    /// How primary visibility is found.
    pub primary: Primary,
    /// Of the random numbers: the same one gives the same frame.
    pub seed: u32,
    /// Factor from nit to display values.
    pub exposure: f32,
    /// Radiance of what lies behind the scene, nit.
    pub background: Vec3,
    /// Are direct diffuse, direct specular and emission kept apart until they are resolved? Radiance is the same but for rounding.
    pub parts: bool,
    /// Is what is shown denoised ([`shared::denoise`])? For the eye: radiance is not that of the estimator.
    pub denoise: bool,
    /// Is what is denoised antialiased too ([`shared::antialias`])? Not with `pixel_centers`.
    pub antialias: bool,
    /// Place in its pixel that each looks through, packed ([`shared::math::pack_place`]): the center. Points of frames through other
    /// places do not last.
    pub place: u32,
}

impl FrameOptions {
    /// Before black, whole, at an exposure of 1.
    pub fn new(work: Work, primary: Primary, seed: u32) -> Self {
        FrameOptions {
            work,
            primary,
            seed,
            exposure: 1.0,
            background: Vec3::ZERO,
            parts: false,
            denoise: false,
            antialias: false,
            place: CENTER,
        }
    }

    /// Denoised and antialiased.
    pub fn finished(self) -> Self {
        FrameOptions { denoise: true, antialias: true, ..self }
    }
}

/// A frame before it is recorded.
struct Plan {
    constants: FrameConstants,
    steps: Vec<Step>,
    next: Rotation,
    /// Version of the scene that it shows.
    now: u64,
    points: Points,
    denoises: bool,
    antialiases: bool,
    /// It looks at the frame before, and no frame follows it.
    looks_back: bool,
}

impl Plan {
    /// The frame, seen by `camera`, was recorded.
    fn advance(&self, history: &mut History, camera: Camera) {
        if !self.looks_back {
            history.advance(camera, self.next, self.now);
            history.points = self.points;
            history.place = self.constants.place;
            history.rested = if self.points == Points::Returning { history.rested + 1 } else { 0 };
            history.paths = self.constants.settings.indirect;
            history.denoised = self.denoises;
            history.antialiased = self.antialiases;
        }
    }
}

/// A scene with the pipelines that its frames need.
///
/// ```
/// use candela::frame::history::History;
/// use candela::frame::picture::Picture;
/// use candela::frame::recorder::{FrameOptions, Recorder};
/// # use candela::frame::schedule::{Primary, Work};
/// # use candela::gpu_scene::GpuScene;
/// # use candela::knobs::Knobs;
/// # use candela::scene::{Illumination, SceneSource, load};
/// # use candela::shared::glam::UVec2;
/// # use candela::vulkan::{Device, DeviceOptions, Timestamps};
///
/// # let size = UVec2::new(32, 18);
/// # let scene = load(&SceneSource::Knot, &Illumination::points(30))?;
/// # let camera = scene.camera(None)?.seen_in(size);
/// # let device = Device::new(&DeviceOptions::default())?;
/// # let gpu_scene = GpuScene::new(&device, &scene)?;
/// # let settings = Knobs::default().settings(gpu_scene.lights());
/// # let options = FrameOptions::new(Work::Restir(settings), Primary::Auto, 0);
/// let mut recorder = Recorder::new(&device, gpu_scene)?;
/// let mut history = History::new(&device, size, settings.reservoirs)?;
/// let mut timestamps = Timestamps::new(&device, 64)?;
/// let picture = Picture::new(&device, size)?;
///
/// // `cmd` is any command buffer that records; this one is submitted and waited for.
/// device.submit_once("frame", |cmd| {
///     recorder.record(cmd, &mut history, camera, &options, &mut timestamps)?;
///     picture.record(cmd, &history)
/// })?;
/// assert_eq!(history.index(), 1);
/// assert_eq!(history.radiance()?.len(), 32 * 18);
/// # Ok::<(), candela::error::Error>(())
/// ```
pub struct Recorder {
    device: Device,
    scene: GpuScene,
    pipelines: Pipelines,
    constants: Buffer,
    pub(super) ignores_motion: bool,
}

/// Whose buffers stand behind the roles of a step.
#[derive(Clone, Copy)]
struct Seen<'a> {
    history: &'a History,
    reference: Option<&'a History>,
}

impl<'a> Seen<'a> {
    fn buffer(self, target: Target) -> &'a Buffer {
        if target.resource != Resource::reference {
            return self.history.target(target);
        }
        // The mean of the history that shows the reference, where there is one.
        self.reference.unwrap_or(self.history).target(Resource::mean)
    }
}

impl Recorder {
    /// Pipelines are made when a frame first needs them.
    pub fn new(device: &Device, scene: GpuScene) -> Result<Self> {
        let usage = vk::BufferUsageFlags::UNIFORM_BUFFER;
        let bytes = size_of::<FrameConstants>() as u64;
        Ok(Recorder {
            pipelines: Pipelines::new(device, scene.set().layout(), scene.features())?,
            constants: Buffer::new(device, "frame constants", bytes, usage, Memory::Device)?,
            ignores_motion: false,
            device: device.clone(),
            scene,
        })
    }

    /// That the scene is on.
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// The next frame shows what `pose` moved, where `scene` has it: call [`SceneDescription::apply`] first. Histories
    /// follow; frames before which nothing moved cost nothing more. At most two frames may be in flight.
    pub fn update_scene(&mut self, scene: &SceneDescription, pose: &Pose) -> Result<()> {
        self.scene.update(&self.device, scene, pose)
    }

    /// The next frame has the lights that `scene` has now, see [`GpuScene::replace_lights`]. Waits for frames in flight.
    pub fn replace_lights(&mut self, scene: &SceneDescription, edits: &LightEdits) -> Result<()> {
        self.scene.replace_lights(&self.device, scene, edits)
    }

    /// Rays a pixel of a frame of this scene, at most: see [`rays::most`].
    pub fn most_rays(&self, settings: &Settings, primary: Primary) -> u64 {
        rays::most(settings, primary.draws(&self.device), self.scene.features())
    }

    /// What it renders.
    pub fn scene(&self) -> &GpuScene {
        &self.scene
    }

    /// Records the next frame of `history`. Commands of earlier frames, submitted or recorded before, come first; later
    /// copies see the results. The scene and the history must outlive the commands.
    pub fn record(
        &mut self,
        cmd: vk::CommandBuffer,
        history: &mut History,
        camera: Camera,
        options: &FrameOptions,
        timestamps: &mut Timestamps,
    ) -> Result<()> {
        let plan = self.plan(history, camera, options)?;
        self.record_constants(cmd, &plan.constants);
        timestamps.begin(cmd);
        if self.scene.has_changed() {
            debug_label(&self.device, cmd, "update", || self.scene.record_changes(&self.device, cmd))?;
            timestamps.write(cmd, "update");
        }
        let seen = Seen { history, reference: None };
        self.record_steps(cmd, seen, &plan.constants.settings, &plan.steps, timestamps)?;
        plan.advance(history, camera);
        Ok(())
    }

    /// Renders the next frame of `history`, waits after each of its steps and shows it, with all that it read and wrote.
    pub fn render_stepwise(
        &mut self,
        history: &mut History,
        camera: Camera,
        options: &FrameOptions,
        mut see: impl FnMut(&History, &FrameConstants, &Step) -> Result<()>,
    ) -> Result<()> {
        let plan = self.plan(history, camera, options)?;
        let mut timestamps = Timestamps::new(&self.device, 1)?;
        if self.scene.has_changed() {
            let device = self.device.clone();
            device.submit_once("update", |cmd| self.scene.record_changes(&device, cmd))?;
        }
        for step in &plan.steps {
            let (only, settings) = (std::slice::from_ref(step), &plan.constants.settings);
            self.device.submit_once(step.pass.stem(), |cmd| {
                self.record_constants(cmd, &plan.constants);
                timestamps.begin(cmd);
                let seen = Seen { history, reference: None };
                self.record_steps(cmd, seen, settings, only, &mut timestamps)
            })?;
            see(history, &plan.constants, step)?;
        }
        plan.advance(history, camera);
        Ok(())
    }

    /// What the next frame consists of, its pipelines made.
    fn plan(&mut self, history: &mut History, camera: Camera, options: &FrameOptions) -> Result<Plan> {
        let settings = match options.work {
            Work::Restir(settings) => settings,
            Work::Reference { .. }
            | Work::ReferenceSlice { .. }
            | Work::Truth { .. }
            | Work::TruthPaths { .. }
            | Work::Paths { .. } => Settings { reservoirs: 0, ..Settings::default() },
        };
        if settings.reservoirs > history.reservoirs() {
            let (asked, has) = (settings.reservoirs, history.reservoirs());
            return Err(Error::Internal(format!(
                "{asked} reservoirs a pixel, but the renderer was created for {has}"
            )));
        }
        let now = self.scene.version();
        if history.scene + 1 < now {
            // It missed a change: what it saw is neither the scene nor its past.
            history.restart();
        }
        if settings.cells != 0 {
            self.scene.make_light_tree(&self.device)?;
        }
        let moved = history.index > 0 && history.scene != now && !self.ignores_motion;
        let constants = FrameConstants {
            camera,
            previous_camera: history.previous_camera.unwrap_or(camera),
            size: history.size(),
            index: history.index,
            seed: options.seed,
            settings,
            exposure: options.exposure,
            background: options.background,
            environment_size: self.scene.environment_size(),
            first_environment_light: self.scene.first_environment_light(),
            tree_lights: self.scene.tree_lights(),
            place: options.place,
        };
        let draws = options.primary.draws(&self.device);
        let features = self.scene.features();
        let rests = history.scene == now && history.previous_camera == Some(camera);
        let looks_back = matches!(options.work, Work::Truth { .. } | Work::TruthPaths { .. });
        if looks_back && !rests {
            return Err(Error::Internal("no frame was rendered whose surfaces could be used again".into()));
        }
        let lasting = matches!(options.work, Work::Restir(_))
            && settings.pixel_centers == 0
            && (options.place, history.place) == (CENTER, CENTER)
            && options.primary != Primary::Raster
            && history.index > 0;
        let denoise = options.denoise && matches!(options.work, Work::Restir(_));
        let antialias = denoise && options.antialias && settings.pixel_centers == 0;
        let points = match (lasting, rests) {
            (false, _) => Points::Centers,
            (true, _) if antialias && history.previous_camera == Some(camera) => Points::Wandering,
            (true, false) => Points::Lasting,
            (true, true) if history.points == Points::Centers || history.rested >= TURNS => Points::Centers,
            (true, true) => Points::Returning,
        };
        let same_points = rests
            && options.place == history.place
            && points == Points::Centers
            && history.points == Points::Centers;
        // Stochastic alpha may show another point. The first frame has no history to ask.
        let still =
            !self.ignores_motion && (history.index == 0 || same_points && features & features::ALPHA == 0);
        let has_paths = history.index > 0 && history.paths == settings.indirect;
        let conditions = Conditions {
            draws,
            points,
            features,
            moved,
            still,
            parts: options.parts || denoise,
            denoise,
            denoised: history.index > 0 && history.denoised,
            antialias,
            antialiased: history.index > 0 && history.antialiased,
            has_paths,
        };
        let (steps, next) = schedule(&options.work, conditions, history.rotation);
        for (_, _, target) in steps.iter().flat_map(|step| &step.targets) {
            history.targets.make(&self.device, target.resource)?;
        }
        self.pipelines.prepare(steps.iter().map(|step| (step.pass, step.variant)))?;
        let (denoises, antialiases) = (denoise, antialias);
        Ok(Plan { constants, steps, next, now, points, denoises, antialiases, looks_back })
    }

    /// Records passes that look at the frame of `history` that was recorded just before, and at the mean of `reference`.
    pub fn record_looks(
        &mut self,
        cmd: vk::CommandBuffer,
        history: &History,
        reference: Option<&History>,
        passes: &[(Pass, PassConstants)],
        timestamps: &mut Timestamps,
    ) -> Result<()> {
        let steps = looks(passes, history.rotation);
        self.pipelines.prepare(steps.iter().map(|step| (step.pass, step.variant)))?;
        let settings = Settings::default();
        self.record_steps(cmd, Seen { history, reference }, &settings, &steps, timestamps)
    }

    fn record_constants(&self, cmd: vk::CommandBuffer, constants: &FrameConstants) {
        let device = &self.device;
        // The frame before may still read its constants, or be copied from.
        let readers = (READERS | PipelineStage::TRANSFER, Access::empty());
        memory_barrier(device, cmd, readers, readers);
        // SAFETY: `cmd` is recording, and the buffer has the size of the constants, a multiple of 4 below 64 KiB.
        unsafe { device.cmd_update_buffer(cmd, self.constants.handle(), 0, bytemuck::bytes_of(constants)) };
        let written = (PipelineStage::TRANSFER, Access::TRANSFER_WRITE);
        memory_barrier(device, cmd, written, (READERS, Access::UNIFORM_READ));
    }

    fn record_steps(
        &self,
        cmd: vk::CommandBuffer,
        seen: Seen<'_>,
        settings: &Settings,
        steps: &[Step],
        timestamps: &mut Timestamps,
    ) -> Result<()> {
        let device = &self.device;
        for (step, wait) in steps.iter().zip(barriers(steps)) {
            if wait {
                let (read, write) = (Access::SHADER_READ, Access::SHADER_WRITE);
                memory_barrier(device, cmd, (SHADERS, write), (SHADERS, read | write));
            }
            let stem = step.pass.stem();
            debug_label(device, cmd, stem, || self.record_step(cmd, seen, settings, step))?;
            timestamps.write(cmd, stem);
        }
        let copies = (PipelineStage::TRANSFER, Access::TRANSFER_READ);
        memory_barrier(device, cmd, (SHADERS, Access::SHADER_WRITE), copies);
        Ok(())
    }

    fn record_step(
        &self,
        cmd: vk::CommandBuffer,
        seen: Seen<'_>,
        settings: &Settings,
        step: &Step,
    ) -> Result<()> {
        let Some(pass) = self.pipelines.get(step.pass, step.variant) else {
            return Err(Error::Internal(format!("pass '{}' was not prepared", step.pass.stem())));
        };
        let mut resources = PushSet::new().uniform_buffer(set::CONSTANTS, &self.constants);
        for &(binding, _, target) in &step.targets {
            resources = resources.storage_buffer(binding.number(), seen.buffer(target));
        }
        let pipeline = pass.pipeline();
        pipeline.bind(cmd);
        pipeline.bind_set(cmd, set::SCENE, self.scene.set());
        pipeline.push_set(cmd, set::FRAME, &resources);
        if reads_past(step.pass) {
            pipeline.bind_set(cmd, set::PAST, self.scene.past_set());
        }
        pipeline.push_constants(cmd, &step.constants);
        let (PassPipeline::Raster(pipelines), Some(target)) = (pass, seen.history.targets.drawn()) else {
            return pass.launch(cmd, step.pass, seen.history.size(), settings);
        };
        let buffer = seen.buffer(step.targets[0].2);
        draw(&self.device, cmd, pipelines, self.scene.draws(), target, buffer);
        Ok(())
    }
}
