//! Rendering for the window: a scene, one history of frames or two side by side, and the reference if needed.

mod explain;
mod side;

pub use explain::Question;

use super::error::ErrorSlot;
use super::probe::ProbeSlot;
use super::readings::Readback;
use super::reference::Reference;
use super::state::State;
use super::views::{Split, View};
use ash::vk;
use candela::error::Result;
use candela::exposure;
use candela::frame::history::History;
use candela::frame::recorder::{FrameOptions, Recorder};
use candela::frame::renderer::MAX_TIMESTAMPS;
use candela::frame::schedule::{Primary, Work};
use candela::gpu_scene::GpuScene;
use candela::knobs::Knobs;
use candela::scene::animation::Pose;
use candela::scene::{SceneCamera, SceneDescription};
use candela::vulkan::{Buffer, Device, Timestamps};
use glam::{UVec2, Vec3};
use shared::camera::Camera;
use shared::frame::Settings;
use shared::interface::PassConstants;
use shared::passes::Pass;
use shared::resources::Resource;
use side::Side;

/// The scene and what its frames need. Nothing may be in flight when it is dropped or fitted.
pub struct Frames {
    device: Device,
    scene: SceneDescription,
    /// The time of the scene's pose, s; none: at rest.
    posed: Option<f64>,
    /// What has moved since the last recorded frame.
    moved: Option<Pose>,
    recorder: Recorder,
    left: Side,
    right: Option<Side>,
    reference: Option<Reference>,
    slots: Vec<Slot>,
    /// What the means stand for.
    seen: Option<Seen>,
    /// Factor from nit to display values, without the user's stops.
    exposure: f32,
    /// Of the scene, m.
    radius: f32,
}

/// What a frame in flight has for itself.
struct Slot {
    left: Timestamps,
    right: Timestamps,
    reference: Timestamps,
    probe: ProbeSlot,
    error: ErrorSlot,
    /// Frames in the mean with the slot's frame; none: there is nothing to read.
    count: Option<u32>,
}

/// Camera, time of the scene, how often the user has said "again", and how surfaces are found.
type Seen = (Camera, Option<f64>, u32, Primary);

/// What the first frame of a scene is made with.
pub struct First {
    /// Pixels.
    pub size: UVec2,
    pub camera: SceneCamera,
    pub settings: Knobs,
    /// Time of the scene, s; none: at rest.
    pub time: Option<f64>,
}

/// What the panels say of the frames.
#[derive(Clone, Copy, Default)]
pub struct FrameFacts {
    /// Frames in the mean, and whole sums in the reference's.
    pub counts: (u32, Option<u32>),
    /// Device memory of the picture-sized buffers, bytes.
    pub picture_bytes: u64,
    /// Rays a pixel and a frame of the left side, at most.
    pub rays: (u64, u64),
}

/// What is on screen.
pub struct Shown<'a> {
    pub left: &'a Buffer,
    /// Right of the divider.
    pub right: Option<&'a Buffer>,
}

impl Slot {
    fn new(device: &Device) -> Result<Slot> {
        let timestamps = || Timestamps::new(device, MAX_TIMESTAMPS);
        Ok(Slot {
            left: timestamps()?,
            right: timestamps()?,
            reference: timestamps()?,
            probe: ProbeSlot::new(device)?,
            error: ErrorSlot::default(),
            count: None,
        })
    }
}

impl Frames {
    /// Uploads `scene` and renders its first frame: its pipelines are made and its exposure is chosen then. `stage` hears
    /// what is being done, and may end it by an error.
    pub fn new(
        device: &Device,
        scene: SceneDescription,
        slots: usize,
        first: &First,
        stage: &mut dyn FnMut(&'static str) -> Result<()>,
    ) -> Result<Frames> {
        let gpu_scene = GpuScene::staged(device, &scene, stage)?;
        stage("first frame")?;
        let slots = (0..slots).map(|_| Slot::new(device)).collect::<Result<_>>()?;
        let mut frames = Frames {
            recorder: Recorder::new(device, gpu_scene)?,
            left: Side::new(device, first.size, first.settings.reservoirs)?,
            right: None,
            reference: None,
            slots,
            seen: None,
            exposure: 0.0,
            radius: scene.bounds().radius(),
            posed: None,
            moved: None,
            scene,
            device: device.clone(),
        };
        frames.render_first(first)?;
        Ok(frames)
    }

    fn render_first(&mut self, first: &First) -> Result<()> {
        self.pose(first.time);
        self.move_scene()?;
        let view = &first.camera;
        let camera = Camera::new(view.position, view.forward, view.up, view.fov_y, first.size);
        self.meter(camera, &first.settings)
    }

    /// Renders a frame and chooses the exposure by what is lit in it, under which white unlit surfaces are display white.
    fn meter(&mut self, camera: Camera, settings: &Knobs) -> Result<()> {
        let options = self.options(settings, 1.0);
        let Frames { device, recorder, left, slots, .. } = self;
        let Some(slot) = slots.first_mut() else { return Ok(()) };
        // Black does not count.
        recorder.scene().set_unlit_white(device, 0.0)?;
        device.submit_once("frame to expose by", |cmd| {
            recorder.record(cmd, &mut left.history, camera, &options, &mut slot.left)
        })?;
        self.exposure = exposure::automatic(&self.left.history.radiance()?, 0.0);
        self.recorder.scene().set_unlit_white(&self.device, 1.0 / self.exposure)
    }

    pub fn scene(&self) -> &SceneDescription {
        &self.scene
    }

    pub fn light_count(&self) -> u32 {
        self.recorder.scene().light_count()
    }

    /// `file` for this scene.
    fn settings(&self, file: &Knobs) -> Settings {
        file.settings(self.recorder.scene().lights())
    }

    /// A frame of `file` for this scene. One seed: frames differ by their index.
    fn options(&self, file: &Knobs, exposure: f32) -> FrameOptions {
        let (work, primary) = (Work::Restir(self.settings(file)), file.primary);
        FrameOptions { exposure, ..FrameOptions::new(work, primary, 0) }
    }

    /// A frame of one side of the window.
    fn options_of(&self, state: &State, side: usize, exposure: f32) -> FrameOptions {
        let options = self.options(&state.settings[side], exposure);
        let denoise = state.denoise && !state.accumulate && !state.error && state.view == View::Final;
        match options.work {
            Work::Restir(settings) if state.accumulate || denoise => {
                let options = FrameOptions { work: Work::Restir(settings.for_a_mean()), ..options };
                if denoise { options.finished() } else { options }
            }
            _ => options,
        }
    }

    /// The next frame shows the scene as it is at `time`, s; none: as it is.
    pub fn pose(&mut self, time: Option<f64>) {
        let Some(time) = time.filter(|&time| self.posed != Some(time)) else { return };
        let pose = self.scene.pose(time);
        self.scene.apply(&pose);
        self.posed = Some(time);
        if self.scene.changes() {
            self.moved = Some(pose);
        }
    }

    /// Brings what has moved to the device.
    fn move_scene(&mut self) -> Result<()> {
        match self.moved.take() {
            Some(pose) => self.recorder.update_scene(&self.scene, &pose),
            None => Ok(()),
        }
    }

    pub fn size(&self) -> UVec2 {
        self.left.history.size()
    }

    /// What the panels say of the next frame of `state`.
    pub fn facts(&self, state: &State) -> FrameFacts {
        let reference = self.reference.as_ref();
        let histories =
            [Some(&self.left), self.right.as_ref()].into_iter().flatten().map(|side| &side.history);
        let histories = histories.chain(reference.map(|reference| &reference.history));
        let settings = self.settings(&state.settings[0]);
        let rays = self.recorder.most_rays(&settings, state.settings[0].primary);
        FrameFacts {
            counts: (self.left.count, reference.map(|reference| reference.count)),
            picture_bytes: histories.map(History::bytes).sum(),
            rays: (rays, rays * u64::from(self.size().x) * u64::from(self.size().y)),
        }
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

    /// What the frame that used `slot` last, and is done by now, has left; once.
    pub fn read(&mut self, slot: usize) -> Result<Option<Readback>> {
        let slot = &mut self.slots[slot];
        let Some(count) = slot.count.take() else { return Ok(None) };
        let (times, probe, error) = (slot.left.read()?, slot.probe.read()?, slot.error.read()?);
        Ok(Some(Readback { times, probe, error, count }))
    }

    /// What all frames have left that are not read yet, earliest first; they must be done.
    pub fn read_all(&mut self) -> Result<Vec<Readback>> {
        let mut all = Vec::new();
        for slot in 0..self.slots.len() {
            all.extend(self.read(slot)?);
        }
        all.sort_by_key(|readback| readback.count);
        Ok(all)
    }

    /// The pass that a lost frame was in, as far as the device has told.
    pub fn last_pass(&self) -> Option<&'static str> {
        let unfinished =
            |slot: &Slot| slot.reference.unfinished().or(slot.left.unfinished()).or(slot.right.unfinished());
        self.slots.iter().find_map(unfinished)
    }

    /// Means and reference start again where the camera has moved or the user has said so.
    fn follow(&mut self, state: &State, camera: Camera) {
        let seen = Some((camera, self.posed, state.restarts, state.settings[0].primary));
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
        self.move_scene()?;
        let exposure = self.exposure(state);
        let budget = reference_rays(self.device.info().kind);
        let [first, second] = [0, 1].map(|side| self.options_of(state, side, exposure));

        let Frames { device, recorder, left, right, reference, slots, radius, .. } = self;
        let slot = &mut slots[slot];
        if let Some(reference) = reference {
            reference.record(cmd, recorder, camera, &first, budget, &mut slot.reference)?;
        }
        let truth = reference.as_ref().map(|reference| &reference.history);
        recorder.record(cmd, &mut left.history, camera, &first, &mut slot.left)?;
        let mut looks = left.looks(state, *radius);
        slot.count = Some(left.count);
        let compared = state.error && reference.as_ref().is_some_and(|reference| reference.count > 0);
        if compared {
            let constants = PassConstants { count: left.count, ..PassConstants::default() };
            looks.push((Pass::statistics, constants));
        }
        if !looks.is_empty() {
            recorder.record_looks(cmd, &left.history, truth, &looks, &mut slot.left)?;
        }
        slot.probe.record(device, cmd, &left.history, camera, state.picked)?;
        slot.error.record(device, cmd, &left.history, compared.then_some(left.count))?;
        if let Some(right) = right {
            recorder.record(cmd, &mut right.history, camera, &second, &mut slot.right)?;
            let looks = right.looks(state, *radius);
            if !looks.is_empty() {
                recorder.record_looks(cmd, &right.history, truth, &looks, &mut slot.right)?;
            }
        }
        Ok(self.shown(state))
    }

    fn shown(&self, state: &State) -> Shown<'_> {
        let truth = self.reference.as_ref().map(|reference| reference.history.target(Resource::display));
        let left = self.left.history.target(Resource::display);
        Shown {
            left: truth.filter(|_| state.view == View::Reference).unwrap_or(left),
            right: match state.split {
                Split::Off => None,
                Split::Settings => self.right.as_ref().map(|side| side.history.target(Resource::display)),
                Split::Reference => truth,
            },
        }
    }

    /// Chooses the exposure by the last frame, which is done, or by one more where something is unlit.
    pub fn expose(&mut self, state: &State) -> Result<()> {
        if self.recorder.scene().has_unlit() {
            return self.meter(camera(state, self.size()), &state.settings[0]);
        }
        self.exposure = exposure::automatic(&self.left.history.radiance()?, 0.0);
        Ok(())
    }

    /// Radiance that the left side shows, nit, of the last frame or the mean; waits for it.
    pub fn radiance(&self, state: &State) -> Result<Vec<Vec3>> {
        match &self.reference {
            Some(reference) if state.view == View::Reference && reference.count > 0 => {
                reference.history.read(Resource::mean)
            }
            _ if state.accumulate && self.left.count > 0 => self.left.history.read(Resource::mean),
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
