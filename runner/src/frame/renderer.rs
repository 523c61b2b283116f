//! Records and runs frames of one scene at one picture size.

use super::pass::{BufferId, Step, barriers};
use super::pipelines::Pipelines;
use super::schedule::{Rotation, Work, schedule};
use super::targets::Targets;
use crate::error::{Error, Result};
use crate::gpu_scene::GpuScene;
use crate::vulkan::{Buffer, Device, Memory, PushSet, Timestamps, debug_label, memory_barrier};
use ash::vk;
use bytemuck::Pod;
use glam::{UVec2, Vec3};
use shared::camera::Camera;
use shared::frame::{FrameConstants, Settings};
use shared::interface::frame_binding;

use vk::{AccessFlags as Access, PipelineStageFlags as PipelineStage};

/// Milliseconds of each step of a frame, in order; the same stem may come more than once.
pub type StepTimes = Vec<(&'static str, f64)>;

/// Timestamps a frame has at most; a reference over very many lights has no more.
const MAX_TIMESTAMPS: u32 = 64;

/// What a frame is made with, beside its camera.
#[derive(Clone, Copy, Debug)]
pub struct FrameOptions {
    pub work: Work,
    pub seed: u32,
    /// Factor from nit to display values.
    pub exposure: f32,
    /// Radiance of what lies behind the scene, nit.
    pub background: Vec3,
}

/// Renders frames, one after another, with their history.
pub struct Renderer {
    device: Device,
    scene: GpuScene,
    pipelines: Pipelines,
    targets: Targets,
    reservoirs: u32,
    size: UVec2,
    constants: Buffer,
    timestamps: Timestamps,
    rotation: Rotation,
    index: u32,
    previous_camera: Option<Camera>,
}

impl Renderer {
    /// `reservoirs`: N a pixel, at most what later frames may ask for; 0 for reference frames only.
    pub fn new(device: &Device, scene: GpuScene, size: UVec2, reservoirs: u32) -> Result<Self> {
        let usage = vk::BufferUsageFlags::UNIFORM_BUFFER;
        let bytes = size_of::<FrameConstants>() as u64;
        Ok(Renderer {
            pipelines: Pipelines::new(device, scene.set().layout(), scene.features())?,
            targets: Targets::new(device, size, reservoirs)?,
            reservoirs,
            size,
            constants: Buffer::new(device, "frame constants", bytes, usage, Memory::Device)?,
            timestamps: Timestamps::new(device, MAX_TIMESTAMPS)?,
            rotation: Rotation::default(),
            index: 0,
            previous_camera: None,
            device: device.clone(),
            scene,
        })
    }

    pub fn size(&self) -> UVec2 {
        self.size
    }

    pub fn scene(&self) -> &GpuScene {
        &self.scene
    }

    /// Device memory of the picture-sized buffers, bytes.
    pub fn target_bytes(&self) -> u64 {
        self.targets.bytes()
    }

    /// Forgets the past: the next frame is number 0.
    pub fn restart(&mut self) {
        self.index = 0;
        self.previous_camera = None;
    }

    /// Renders one frame and waits for it. Gives the times of its steps where the device has a clock.
    pub fn render(&mut self, camera: Camera, options: &FrameOptions) -> Result<Option<StepTimes>> {
        let settings = match options.work {
            Work::Restir(settings) => settings,
            Work::Reference { .. } => Settings { reservoirs: 0, ..Settings::default() },
        };
        if settings.reservoirs > self.reservoirs {
            let (asked, has) = (settings.reservoirs, self.reservoirs);
            return Err(Error::Usage(format!(
                "{asked} reservoirs a pixel asked of a renderer made for {has}"
            )));
        }
        let constants = FrameConstants {
            camera,
            previous_camera: self.previous_camera.unwrap_or(camera),
            size: self.size,
            index: self.index,
            seed: options.seed,
            settings,
            exposure: options.exposure,
            background: options.background,
            environment_size: self.scene.environment_size(),
        };
        let (steps, next) = schedule(&options.work, self.rotation);
        for step in &steps {
            self.pipelines.prepare(step.pass)?;
        }
        let device = self.device.clone();
        device.submit_once("frame", |cmd| self.record(cmd, &constants, &steps))?;
        self.rotation = next;
        self.index += 1;
        self.previous_camera = Some(camera);
        self.timestamps.read()
    }

    fn record(&mut self, cmd: vk::CommandBuffer, constants: &FrameConstants, steps: &[Step]) -> Result<()> {
        let shaders = PipelineStage::COMPUTE_SHADER | PipelineStage::RAY_TRACING_SHADER_KHR;
        let device = &self.device;
        // SAFETY: `cmd` is recording, and the buffer has the size of the constants, a multiple of 4 below 64 KiB.
        unsafe { device.cmd_update_buffer(cmd, self.constants.handle(), 0, bytemuck::bytes_of(constants)) };
        let written = (PipelineStage::TRANSFER, Access::TRANSFER_WRITE);
        memory_barrier(device, cmd, written, (shaders, Access::UNIFORM_READ));
        self.timestamps.begin(cmd);
        for (step, wait) in steps.iter().zip(barriers(steps)) {
            if wait {
                let (read, write) = (Access::SHADER_READ, Access::SHADER_WRITE);
                memory_barrier(device, cmd, (shaders, write), (shaders, read | write));
            }
            let stem = step.pass.stem;
            debug_label(device, cmd, stem, || self.record_step(cmd, constants, step))?;
            self.timestamps.write(cmd, stem);
        }
        let copies = (PipelineStage::TRANSFER, Access::TRANSFER_READ);
        memory_barrier(device, cmd, (shaders, Access::SHADER_WRITE), copies);
        Ok(())
    }

    fn record_step(&self, cmd: vk::CommandBuffer, constants: &FrameConstants, step: &Step) -> Result<()> {
        let Some(pass) = self.pipelines.get(step.pass) else {
            return Err(Error::Usage(format!("pass '{}' was not prepared", step.pass.stem)));
        };
        let mut set = PushSet::new().uniform_buffer(frame_binding::CONSTANTS, &self.constants);
        for (&(role, _), &buffer) in step.pass.uses.iter().zip(&step.buffers) {
            set = set.storage_buffer(role.binding(), self.targets.get(buffer));
        }
        let pipeline = pass.pipeline();
        pipeline.bind(cmd);
        pipeline.bind_set(cmd, shared::interface::scene_binding::SET, self.scene.set());
        pipeline.push_set(cmd, frame_binding::SET, &set);
        pipeline.push_constants(cmd, &step.constants);
        pass.launch(cmd, step.pass, self.size, &constants.settings)
    }

    /// Radiance of the last frame: nit, linear RGB, rows from the top.
    pub fn radiance(&self) -> Result<Vec<Vec3>> {
        self.read(BufferId::Radiance)
    }

    /// Display values of the last frame: RGBA8, red lowest, rows from the top.
    pub fn display(&self) -> Result<Vec<u32>> {
        self.read(BufferId::Display)
    }

    /// Content of a target after the last frame.
    pub fn read<T: Pod>(&self, target: BufferId) -> Result<Vec<T>> {
        self.targets.get(target).read_vec()
    }
}
