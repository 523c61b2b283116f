//! What is rendered for the window: one history of frames, or two side by side, and the reference where it is asked for.

use super::error::ErrorSlot;
use super::probe::{Probe, ProbeSlot};
use super::reference::Reference;
use super::state::State;
use super::views::{Split, View};
use crate::error::Result;
use crate::exposure;
use crate::frame::history::History;
use crate::frame::pass::{BufferId, Pass};
use crate::frame::passes;
use crate::frame::recorder::{FrameOptions, Recorder};
use crate::frame::renderer::{MAX_TIMESTAMPS, StepTimes};
use crate::frame::schedule::Work;
use crate::gpu_scene::GpuScene;
use crate::settings_file::SettingsFile;
use crate::vulkan::{Buffer, Device, Timestamps};
use ash::vk;
use glam::{UVec2, Vec3};
use shared::camera::Camera;
use shared::interface::PassConstants;
use shared::view::kind;

/// The scene and what its frames need. Nothing may be in flight when it is dropped or fitted.
pub struct Frames {
    device: Device,
    recorder: Recorder,
    left: Side,
    right: Option<Side>,
    reference: Option<Reference>,
    slots: Vec<Slot>,
    /// Camera and commands that the means stand for.
    seen: Option<(Camera, u32)>,
    /// Factor from nit to display values, without the user's stops; 0 until a first frame has been seen.
    exposure: f32,
    /// Of the scene, m.
    radius: f32,
}

/// Frames of one settings.
struct Side {
    history: History,
    /// What the mean stands for, and how many frames it has.
    settings: Option<SettingsFile>,
    count: u32,
}

/// What a frame in flight has for itself.
struct Slot {
    left: Timestamps,
    right: Timestamps,
    reference: Timestamps,
    probe: ProbeSlot,
    error: ErrorSlot,
    /// The slot has been used: there are times to read.
    used: bool,
}

/// What is on screen.
pub struct Shown<'a> {
    pub left: &'a Buffer,
    /// Right of the divider.
    pub right: Option<&'a Buffer>,
}

impl Side {
    fn new(device: &Device, size: UVec2, reservoirs: u32) -> Result<Side> {
        Ok(Side { history: History::new(device, size, reservoirs)?, settings: None, count: 0 })
    }

    fn fits(&self, state: &State, side: usize, size: UVec2) -> bool {
        self.history.size() == size
            && self.history.reservoirs() >= state.settings[side].reservoirs
            && (self.history.has_mean() || !looks_closer(state))
    }

    fn fit(&mut self, device: &Device, state: &State, side: usize, size: UVec2) -> Result<()> {
        let reservoirs = state.settings[side].reservoirs;
        if self.history.size() != size || self.history.reservoirs() < reservoirs {
            *self = Side::new(device, size, reservoirs)?;
        }
        if looks_closer(state) { self.history.make_mean(device) } else { Ok(()) }
    }

    /// The mean starts anew with other settings.
    fn follow(&mut self, settings: &SettingsFile) {
        if self.settings.as_ref() != Some(settings) {
            self.settings = Some(settings.clone());
            self.count = 0;
        }
    }

    /// Passes after the frame: its mean, and what is shown instead of it.
    fn looks(&mut self, state: &State, radius: f32) -> Vec<(&'static Pass, PassConstants)> {
        let mut looks = Vec::new();
        self.count = if state.accumulate { self.count + 1 } else { 0 };
        let constants = PassConstants { count: self.count, scale: radius, ..PassConstants::default() };
        if state.accumulate {
            looks.push((&passes::accumulate::PASS, constants));
        }
        let mean = (state.accumulate && state.view == View::Final).then_some(kind::MEAN);
        if let Some(view) = state.view.kind().or(mean) {
            looks.push((&passes::view::PASS, PassConstants { view, ..constants }));
        }
        looks
    }
}

/// Does any pass follow the frame that needs a mean or sums?
fn looks_closer(state: &State) -> bool {
    state.accumulate || state.error || state.view.kind().is_some()
}

impl Frames {
    /// `radius`: of the scene, m.
    pub fn new(device: &Device, scene: GpuScene, size: UVec2, slots: usize, radius: f32) -> Result<Frames> {
        let timestamps = || Timestamps::new(device, MAX_TIMESTAMPS);
        let slot = |_| {
            Ok(Slot {
                left: timestamps()?,
                right: timestamps()?,
                reference: timestamps()?,
                probe: ProbeSlot::new(device)?,
                error: ErrorSlot::default(),
                used: false,
            })
        };
        Ok(Frames {
            recorder: Recorder::new(device, scene)?,
            left: Side::new(device, size, 1)?,
            right: None,
            reference: None,
            slots: (0..slots).map(slot).collect::<Result<_>>()?,
            seen: None,
            exposure: 0.0,
            radius,
            device: device.clone(),
        })
    }

    pub fn size(&self) -> UVec2 {
        self.left.history.size()
    }

    /// Device memory of the picture-sized buffers, bytes.
    pub fn bytes(&self) -> u64 {
        let right = self.right.as_ref().map_or(0, |side| side.history.bytes());
        let reference = self.reference.as_ref().map_or(0, |reference| reference.history.bytes());
        self.left.history.bytes() + right + reference
    }

    /// Frames in the mean, and whole sums in the reference's.
    pub fn counts(&self) -> (u32, Option<u32>) {
        (self.left.count, self.reference.as_ref().map(|reference| reference.count))
    }

    /// Are the buffers there that the next frame of `state` needs, and no more? Else `fit` has to make them first.
    pub fn fits(&self, state: &State, size: UVec2) -> bool {
        let right = match state.split {
            Split::Settings => self.right.as_ref().is_some_and(|right| right.fits(state, 1, size)),
            _ => self.right.is_none(),
        };
        let reference = match &self.reference {
            Some(reference) => state.needs_reference() && reference.history.size() == size,
            None => !state.needs_reference(),
        };
        self.left.fits(state, 0, size) && right && reference
    }

    /// Makes the buffers that the next frames of `state` need. Nothing may be in flight.
    pub fn fit(&mut self, state: &State, size: UVec2) -> Result<()> {
        let device = &self.device;
        self.left.fit(device, state, 0, size)?;
        if state.split != Split::Settings {
            self.right = None;
        } else {
            if self.right.is_none() {
                self.right = Some(Side::new(device, size, state.settings[1].reservoirs)?);
            }
            if let Some(right) = &mut self.right {
                right.fit(device, state, 1, size)?;
            }
        }
        let kept = self.reference.take();
        let kept = kept.filter(|reference| state.needs_reference() && reference.history.size() == size);
        self.reference = match kept {
            None if state.needs_reference() => Some(Reference::new(device, size)?),
            kept => kept,
        };
        Ok(())
    }

    /// Milliseconds of the passes of the left side, of the frame that used `slot` last and is done by now.
    pub fn times(&self, slot: usize) -> Result<Option<StepTimes>> {
        if self.slots[slot].used { self.slots[slot].left.read() } else { Ok(None) }
    }

    /// What the frame that used `slot` last, and is done by now, had at the picked pixel.
    pub fn probe(&self, slot: usize) -> Result<Option<Probe>> {
        self.slots[slot].probe.read()
    }

    /// The error of the frame that used `slot` last, relative; none without a reference.
    pub fn error(&self, slot: usize) -> Result<Option<f64>> {
        self.slots[slot].error.read()
    }

    /// The pass that a lost frame was in, as far as the device has told.
    pub fn last_pass(&self) -> Option<&'static str> {
        let unfinished =
            |slot: &Slot| slot.reference.unfinished().or(slot.left.unfinished()).or(slot.right.unfinished());
        self.slots.iter().find_map(unfinished)
    }

    /// Means and reference start again where the camera has moved or the user has said so.
    fn follow(&mut self, state: &State, camera: Camera) {
        let seen = Some((camera, state.restarts));
        if self.seen != seen {
            self.seen = seen;
            self.left.count = 0;
            if let Some(right) = &mut self.right {
                right.count = 0;
            }
            if let Some(reference) = &mut self.reference {
                reference.restart();
            }
        }
        self.left.follow(&state.settings[0]);
        if let Some(right) = &mut self.right {
            right.follow(&state.settings[1]);
        }
    }

    /// Records the next frame of each side, and a slice of the reference before them.
    pub fn record(&mut self, cmd: vk::CommandBuffer, slot: usize, state: &State) -> Result<Shown<'_>> {
        let camera = camera(state, self.size());
        self.follow(state, camera);
        let exposure = self.exposure(state);
        let budget = reference_rays(self.device.info().kind);
        let lights = self.recorder.scene().light_count();
        let work = |side: usize| Work::Restir(state.settings[side].settings(lights));
        let options = |work| FrameOptions { work, seed: 0, exposure, background: Vec3::ZERO };

        let Frames { device, recorder, left, right, reference, slots, radius, .. } = self;
        let slot = &mut slots[slot];
        slot.used = true;
        if let Some(reference) = reference {
            reference.record(cmd, recorder, camera, exposure, budget, &mut slot.reference)?;
        }
        let truth = reference.as_ref().map(|reference| &reference.history);
        recorder.record(cmd, &mut left.history, camera, &options(work(0)), &mut slot.left)?;
        let mut looks = left.looks(state, *radius);
        let compared = state.error && reference.as_ref().is_some_and(|reference| reference.count > 0);
        if compared {
            let constants = PassConstants { count: left.count, ..PassConstants::default() };
            looks.push((&passes::statistics::PASS, constants));
        }
        if !looks.is_empty() {
            recorder.record_looks(cmd, &left.history, truth, &looks, &mut slot.left)?;
        }
        slot.probe.record(device, cmd, &left.history, camera, state.picked)?;
        slot.error.record(device, cmd, &left.history, compared)?;
        if let Some(right) = right {
            recorder.record(cmd, &mut right.history, camera, &options(work(1)), &mut slot.right)?;
            let looks = right.looks(state, *radius);
            if !looks.is_empty() {
                recorder.record_looks(cmd, &right.history, truth, &looks, &mut slot.right)?;
            }
        }
        Ok(self.shown(state))
    }

    fn shown(&self, state: &State) -> Shown<'_> {
        let truth = self.reference.as_ref().map(|reference| reference.history.target(BufferId::Display));
        let left = self.left.history.target(BufferId::Display);
        Shown {
            left: truth.filter(|_| state.view == View::Reference).unwrap_or(left),
            right: match state.split {
                Split::Off => None,
                Split::Settings => self.right.as_ref().map(|side| side.history.target(BufferId::Display)),
                Split::Reference => truth,
            },
        }
    }

    pub fn needs_exposure(&self) -> bool {
        self.exposure == 0.0
    }

    /// Chooses the exposure by the last frame, which is done.
    pub fn expose(&mut self) -> Result<()> {
        self.exposure = exposure::automatic(&self.left.history.radiance()?, 0.0);
        Ok(())
    }

    /// Radiance that the left side shows, nit, of the last frame or the mean; waits for it.
    pub fn radiance(&self, state: &State) -> Result<Vec<Vec3>> {
        match &self.reference {
            Some(reference) if state.view == View::Reference && reference.count > 0 => {
                reference.history.read(BufferId::Mean)
            }
            _ if state.accumulate && self.left.count > 0 => self.left.history.read(BufferId::Mean),
            _ => self.left.history.radiance(),
        }
    }

    /// The exposure of the picture, 1/nit.
    pub fn exposure(&self, state: &State) -> f32 {
        self.exposure * state.stops.exp2()
    }
}

/// Rays that the reference may add to a frame, by the kind of device.
fn reference_rays(kind: &str) -> u64 {
    match kind {
        "cpu" => 1 << 20,
        "discrete" => 1 << 26,
        _ => 1 << 24,
    }
}

/// The camera of `state` for a picture of `size`.
pub fn camera(state: &State, size: UVec2) -> Camera {
    let rig = &state.rig;
    Camera::new(rig.position, rig.forward, rig.up, rig.fov_y, size)
}
