//! What is rendered for the window: one history of frames, or two side by side, or one beside the reference.

use super::probe::{Probe, ProbeSlot};
use super::state::State;
use super::views::Split;
use crate::error::Result;
use crate::exposure;
use crate::frame::history::History;
use crate::frame::pass::BufferId;
use crate::frame::recorder::{FrameOptions, Recorder};
use crate::frame::renderer::{MAX_TIMESTAMPS, StepTimes};
use crate::frame::schedule::Work;
use crate::gpu_scene::GpuScene;
use crate::vulkan::{Buffer, Device, Timestamps};
use ash::vk;
use glam::{UVec2, Vec3};
use shared::camera::Camera;

/// The scene and what its frames need. Nothing may be in flight when it is dropped or resized.
pub struct Frames {
    device: Device,
    recorder: Recorder,
    left: History,
    right: Option<History>,
    slots: Vec<Slot>,
    /// Factor from nit to display values, without the user's stops; 0 until a first frame has been seen.
    exposure: f32,
}

/// What a frame in flight has for itself.
struct Slot {
    left: Timestamps,
    right: Timestamps,
    probe: ProbeSlot,
    /// The slot has been used: there are times to read.
    used: bool,
}

/// What is on screen.
pub struct Shown<'a> {
    pub left: &'a Buffer,
    /// Right of the divider.
    pub right: Option<&'a Buffer>,
}

impl Frames {
    pub fn new(device: &Device, scene: GpuScene, size: UVec2, slots: usize) -> Result<Frames> {
        let timestamps = || Timestamps::new(device, MAX_TIMESTAMPS);
        let slot = |_| {
            Ok(Slot {
                left: timestamps()?,
                right: timestamps()?,
                probe: ProbeSlot::new(device)?,
                used: false,
            })
        };
        Ok(Frames {
            recorder: Recorder::new(device, scene)?,
            left: History::new(device, size, 1)?,
            right: None,
            slots: (0..slots).map(slot).collect::<Result<_>>()?,
            exposure: 0.0,
            device: device.clone(),
        })
    }

    pub fn size(&self) -> UVec2 {
        self.left.size()
    }

    /// Device memory of the picture-sized buffers, bytes.
    pub fn bytes(&self) -> u64 {
        self.left.bytes() + self.right.as_ref().map_or(0, History::bytes)
    }

    /// Does the next frame of `state` need buffers that are not there? Then `fit` has to make them first.
    pub fn fits(&self, state: &State, size: UVec2) -> bool {
        let fits = |history: &History, side: usize| {
            history.size() == size && history.reservoirs() >= state.settings[side].reservoirs
        };
        let right = match state.split {
            Split::Settings => self.right.as_ref().is_some_and(|right| fits(right, 1)),
            _ => self.right.is_none(),
        };
        fits(&self.left, 0) && right
    }

    /// Makes the buffers that the next frames of `state` need. Nothing may be in flight.
    pub fn fit(&mut self, state: &State, size: UVec2) -> Result<()> {
        let reservoirs = |side: usize| state.settings[side].reservoirs;
        if self.left.size() != size || self.left.reservoirs() < reservoirs(0) {
            self.left = History::new(&self.device, size, reservoirs(0))?;
        }
        if state.split != Split::Settings {
            self.right = None;
        } else if !self.right.as_ref().is_some_and(|r| r.size() == size && r.reservoirs() >= reservoirs(1)) {
            self.right = Some(History::new(&self.device, size, reservoirs(1))?);
        }
        Ok(())
    }

    /// Milliseconds of the passes of the left side, of the frame that used `slot` last and is done by now.
    pub fn times(&self, slot: usize) -> Result<Option<StepTimes>> {
        if self.slots[slot].used { self.slots[slot].left.read() } else { Ok(None) }
    }

    /// The pass that a lost frame was in, as far as the device has told.
    pub fn last_pass(&self) -> Option<&'static str> {
        self.slots.iter().find_map(|slot| slot.left.unfinished().or(slot.right.unfinished()))
    }

    /// Records the next frame of each side.
    pub fn record(&mut self, cmd: vk::CommandBuffer, slot: usize, state: &State) -> Result<Shown<'_>> {
        let camera = camera(state, self.size());
        let exposure = self.exposure * state.stops.exp2();
        let lights = self.recorder.scene().light_count();
        let work = |side: usize| Work::Restir(state.settings[side].settings(lights));
        let options = |work| FrameOptions { work, seed: 0, exposure, background: Vec3::ZERO };
        let Slot { left, right, probe, used } = &mut self.slots[slot];
        *used = true;
        self.recorder.record(cmd, &mut self.left, camera, &options(work(0)), left)?;
        probe.record(&self.device, cmd, &self.left, camera, state.picked)?;
        if let Some(history) = &mut self.right {
            self.recorder.record(cmd, history, camera, &options(work(1)), right)?;
        }
        Ok(Shown {
            left: self.left.target(BufferId::Display),
            right: self.right.as_ref().map(|history| history.target(BufferId::Display)),
        })
    }

    /// What the frame that used `slot` last, and is done by now, had at the picked pixel.
    pub fn probe(&self, slot: usize) -> Result<Option<Probe>> {
        self.slots[slot].probe.read()
    }

    pub fn needs_exposure(&self) -> bool {
        self.exposure == 0.0
    }

    /// Chooses the exposure by the last frame, which is done.
    pub fn expose(&mut self) -> Result<()> {
        self.exposure = exposure::automatic(&self.left.radiance()?, 0.0);
        Ok(())
    }

    /// Radiance of the left side's last frame, nit; waits for it.
    pub fn radiance(&self) -> Result<Vec<Vec3>> {
        self.left.radiance()
    }

    /// The exposure of the picture, 1/nit.
    pub fn exposure(&self, state: &State) -> f32 {
        self.exposure * state.stops.exp2()
    }
}

/// The camera of `state` for a picture of `size`.
pub fn camera(state: &State, size: UVec2) -> Camera {
    let rig = &state.rig;
    Camera::new(rig.position, rig.forward, rig.up, rig.fov_y, size)
}
