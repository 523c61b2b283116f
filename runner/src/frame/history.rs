//! The history of a sequence of frames: the buffers that one frame leaves for the next.

use super::schedule::{Points, Rotation};
use super::targets::{Target, Targets};
use crate::error::Result;
use crate::vulkan::{Buffer, Device};
use bytemuck::Pod;
use glam::{UVec2, Vec3};
use shared::camera::Camera;
use shared::frame::indirect;
use shared::math::CENTER;
use shared::resources::Resource;
use shared::stored_ray::StoredRay;

/// Targets of one picture size, and which frame they hold. Frames of several histories may take turns on one recorder.
///
/// [`Recorder`](super::recorder::Recorder) has an example.
pub struct History {
    pub(super) targets: Targets,
    pub(super) rotation: Rotation,
    pub(super) index: u32,
    pub(super) previous_camera: Option<Camera>,
    pub(super) points: Points,
    /// [`shared::frame::indirect`]: which paths the last frame left.
    pub(super) paths: u32,
    /// The last frame was denoised.
    pub(super) denoised: bool,
    /// The last frame was antialiased.
    pub(super) antialiased: bool,
    /// [`shared::frame::FrameConstants::place`] of the last frame.
    pub(super) place: u32,
    /// Frames at rest since points last moved in their pixels.
    pub(super) rested: u32,
    /// [`crate::gpu_scene::GpuScene::version`] that the last frame saw.
    pub(super) scene: u64,
    reservoirs: u32,
    size: UVec2,
}

impl History {
    /// `reservoirs`: N a pixel, at most what frames may ask for; 0 for reference frames only.
    pub fn new(device: &Device, size: UVec2, reservoirs: u32) -> Result<Self> {
        Ok(History {
            targets: Targets::new(device, size, reservoirs)?,
            rotation: Rotation::default(),
            index: 0,
            previous_camera: None,
            points: Points::Centers,
            paths: indirect::OFF,
            denoised: false,
            antialiased: false,
            place: CENTER,
            rested: 0,
            scene: 0,
            reservoirs,
            size,
        })
    }

    /// Pixels.
    pub fn size(&self) -> UVec2 {
        self.size
    }

    /// Reservoirs a pixel that there is room for.
    pub fn reservoirs(&self) -> u32 {
        self.reservoirs
    }

    /// Frames since the start.
    pub fn index(&self) -> u32 {
        self.index
    }

    /// Did the last frame show light that bounces?
    pub fn has_paths(&self) -> bool {
        self.paths != indirect::OFF
    }

    /// Did the last frame find its points where those of the frame before it fell?
    pub fn points_last(&self) -> bool {
        self.points == Points::Lasting
    }

    /// Device memory of the picture-sized buffers, bytes.
    pub fn bytes(&self) -> u64 {
        self.targets.bytes()
    }

    /// Forgets the past: the next frame is number 0.
    pub fn restart(&mut self) {
        self.index = 0;
        self.previous_camera = None;
        self.points = Points::Centers;
        self.rested = 0;
    }

    /// Makes room for what passes that look at a frame read and write.
    pub fn make_mean(&mut self, device: &Device) -> Result<()> {
        self.targets.make(device, Resource::mean)?;
        self.targets.make(device, Resource::statistics)
    }

    /// Rays for the passes of the roofline, one a pixel; no frame may be in flight.
    pub fn set_rays(&mut self, device: &Device, rays: &[StoredRay]) -> Result<()> {
        self.targets.set_rays(device, rays)
    }

    /// Is there a mean over frames?
    pub fn has_mean(&self) -> bool {
        self.targets.has(Resource::mean)
    }

    /// The G-buffer of the last frame.
    pub fn gbuffer(&self) -> &Buffer {
        self.target(self.rotation.last_gbuffer())
    }

    /// The reservoirs that the last frame shaded.
    pub fn shaded_reservoirs(&self) -> &Buffer {
        self.target(self.rotation.last_reservoirs())
    }

    /// A frame seen by `camera` was recorded; the one after it starts from `next`.
    pub(super) fn advance(&mut self, camera: Camera, next: Rotation, scene: u64) {
        self.rotation = next;
        self.index += 1;
        self.previous_camera = Some(camera);
        self.scene = scene;
    }

    /// A buffer of the picture, by its name in the table.
    pub fn target(&self, target: impl Into<Target>) -> &Buffer {
        self.targets.get(target.into())
    }

    /// Content of a target after the last frame, which must have run.
    pub fn read<T: Pod>(&self, target: impl Into<Target>) -> Result<Vec<T>> {
        self.target(target).read_vec()
    }

    /// Radiance of the last frame: nit, linear RGB, rows from the top.
    pub fn radiance(&self) -> Result<Vec<Vec3>> {
        self.read(Resource::radiance)
    }
}
