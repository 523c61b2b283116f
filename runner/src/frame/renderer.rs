//! Renders frames of one scene at one picture size, and waits for each.

use super::history::History;
use super::recorder::Recorder;
use super::targets::Target;
use crate::error::Result;
use crate::exposure;
use crate::gpu_scene::GpuScene;
use crate::scene::SceneDescription;
use crate::scene::animation::Pose;
use crate::scene::lights::LightEdits;
use crate::vulkan::{Device, Timestamps};
use bytemuck::Pod;
use glam::{UVec2, Vec3};
use shared::camera::Camera;
use shared::interface::PassConstants;
use shared::passes::Pass;
use shared::resources::Resource;
use shared::surface::GBufferTexel;

pub use super::recorder::FrameOptions;

/// Milliseconds of each step of a frame, in order; the same stem may come more than once.
pub type StepTimes = Vec<(&'static str, f64)>;

/// Timestamps a frame has at most; a reference over very many lights has no more.
pub const MAX_TIMESTAMPS: u32 = 64;

/// Renders frames, one after another, with their history.
///
/// ```
/// use candela::frame::renderer::{FrameOptions, Renderer};
/// use candela::frame::schedule::{Primary, Work};
/// use candela::gpu_scene::GpuScene;
/// use candela::knobs::Knobs;
/// use candela::scene::{Illumination, SceneSource, load};
/// use candela::shared::glam::{UVec2, Vec3};
/// use candela::vulkan::{Device, DeviceOptions};
///
/// let size = UVec2::new(32, 18);
/// let scene = load(&SceneSource::Knot, &Illumination::points(30))?;
/// let camera = scene.camera(None)?.seen_in(size);
/// let device = Device::new(&DeviceOptions::default())?;
/// let gpu_scene = GpuScene::new(&device, &scene)?;
/// let settings = Knobs::default().settings(gpu_scene.lights());
///
/// let mut renderer = Renderer::new(&device, gpu_scene, size, settings.reservoirs)?;
/// let frame = FrameOptions::new(Work::Restir(settings), Primary::Auto, 0);
/// for _ in 0..4 {
///     renderer.render(camera, &frame)?;
/// }
/// let picture: Vec<Vec3> = renderer.radiance()?;
///
/// // The sum over all lights, in the mean 30 frames later.
/// let truth = FrameOptions::new(Work::Reference { lights: 30 }, Primary::Auto, 0);
/// renderer.render(camera, &truth)?;
/// let mean = |picture: &[Vec3]| picture.iter().sum::<Vec3>() / picture.len() as f32;
/// let ratio = mean(&picture) / mean(&renderer.radiance()?);
/// assert!((ratio - 1.0).abs().max_element() < 0.2, "{ratio}");
/// # Ok::<(), candela::error::Error>(())
/// ```
pub struct Renderer {
    device: Device,
    recorder: Recorder,
    history: History,
    timestamps: Timestamps,
}

impl Renderer {
    /// `reservoirs`: N a pixel, at most what later frames may ask for; 0 for reference frames only.
    pub fn new(device: &Device, scene: GpuScene, size: UVec2, reservoirs: u32) -> Result<Self> {
        Ok(Renderer {
            recorder: Recorder::new(device, scene)?,
            history: History::new(device, size, reservoirs)?,
            timestamps: Timestamps::new(device, MAX_TIMESTAMPS)?,
            device: device.clone(),
        })
    }

    /// Pixels.
    pub fn size(&self) -> UVec2 {
        self.history.size()
    }

    /// What it renders.
    pub fn scene(&self) -> &GpuScene {
        self.recorder.scene()
    }

    /// Device memory of the picture-sized buffers, bytes.
    pub fn target_bytes(&self) -> u64 {
        self.history.bytes()
    }

    /// Did the last frame show light that bounces?
    pub fn has_paths(&self) -> bool {
        self.history.has_paths()
    }

    /// Forgets the past: the next frame is number 0.
    pub fn restart(&mut self) {
        self.history.restart();
    }

    /// See [`Recorder::update_scene`].
    pub fn update_scene(&mut self, scene: &SceneDescription, pose: &Pose) -> Result<()> {
        self.recorder.update_scene(scene, pose)
    }

    /// See [`Recorder::replace_lights`].
    pub fn replace_lights(&mut self, scene: &SceneDescription, edits: &LightEdits) -> Result<()> {
        self.recorder.replace_lights(scene, edits)
    }

    /// For tests: temporal reuse takes the past for the present, and does not know that nothing has moved where nothing has.
    #[doc(hidden)]
    pub fn ignore_motion(&mut self, ignore: bool) {
        self.recorder.ignores_motion = ignore;
    }

    /// Renders one frame and waits for it. Gives the times of its steps where the device has a clock.
    pub fn render(&mut self, camera: Camera, options: &FrameOptions) -> Result<Option<StepTimes>> {
        let Renderer { device, recorder, history, timestamps } = self;
        device.submit_once("frame", |cmd| recorder.record(cmd, history, camera, options, timestamps))?;
        self.timestamps.read()
    }

    /// The same, and adds the frame to [`Resource::mean`]: it is number `count`, from 1 on.
    pub fn render_into_mean(
        &mut self,
        camera: Camera,
        options: &FrameOptions,
        count: u32,
    ) -> Result<Option<StepTimes>> {
        let Renderer { device, recorder, history, timestamps } = self;
        history.make_mean(device)?;
        let constants = PassConstants { count, ..PassConstants::default() };
        device.submit_once("frame", |cmd| {
            recorder.record(cmd, history, camera, options, timestamps)?;
            recorder.record_looks(cmd, history, None, &[(Pass::accumulate, constants)], timestamps)
        })?;
        self.timestamps.read()
    }

    /// The exposure for the next frames where unlit surfaces are seen, none where there are none: that of what is lit, under
    /// which white unlit surfaces become display white. Forgets the past.
    pub fn meter(&mut self, camera: Camera, options: &FrameOptions) -> Result<Option<f32>> {
        if !self.scene().has_unlit() {
            return Ok(None);
        }
        // Denoised or not, a picture has one exposure: by a frame as it is.
        let options = &FrameOptions { denoise: false, ..*options };
        // Black does not count.
        self.scene().set_unlit_white(&self.device, 0.0)?;
        self.render(camera, options)?;
        let exposure = exposure::automatic(&self.radiance()?, 0.0);
        self.scene().set_unlit_white(&self.device, 1.0 / exposure)?;
        self.restart();
        Ok(Some(exposure))
    }

    /// What renders, and what it has rendered so far.
    pub fn parts(&mut self) -> (&mut Recorder, &mut History) {
        (&mut self.recorder, &mut self.history)
    }

    /// Radiance of the last frame: nit, linear RGB, rows from the top.
    pub fn radiance(&self) -> Result<Vec<Vec3>> {
        self.history.radiance()
    }

    /// Display values of the last frame: RGBA8, red lowest, rows from the top.
    pub fn display(&self) -> Result<Vec<u32>> {
        self.read(Resource::display)
    }

    /// What each pixel of the last frame saw, rows from the top.
    pub fn gbuffer(&self) -> Result<Vec<GBufferTexel>> {
        self.history.gbuffer().read_vec()
    }

    /// Content of a target after the last frame.
    pub fn read<T: Pod>(&self, target: impl Into<Target>) -> Result<Vec<T>> {
        self.history.read(target)
    }
}
