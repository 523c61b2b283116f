//! The state that a user can change, and its changes by input. No window, no device.

mod motion;
mod pointer;

use super::camera::{Rig, Style};
use super::input::{Command, Input, KeyCode, command};
use super::presets::Preset;
use super::timeline::Timeline;
use super::views::{Split, View};
use candela::knobs::Knobs;
use candela::knobs::{self, Step};
use candela::scene::animation::Thing;
use candela::scene::{SceneCamera, SceneDescription};
use glam::{UVec2, Vec3};
use pointer::Pointer;
use std::collections::HashSet;
use std::path::PathBuf;

/// What state alone can't do.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    Load(PathBuf),
    Screenshot,
    CopyCamera,
    /// Replay the picked pixel on the CPU.
    Explain,
    CopyExplanation,
    NextPresentMode,
    /// By what is seen now.
    Expose,
    Quit,
}

pub struct State {
    /// Of the left side, which is the whole window unless it is split, and of the right side.
    pub settings: [Knobs; 2],
    /// What `Reset` goes back to.
    initial: Knobs,
    /// Which settings the knobs change.
    pub side: usize,
    pub selected: usize,
    pub view: View,
    pub split: Split,
    /// The divider's place, 0..=1 of the width.
    pub divider: f32,
    /// Show the mean of all frames since something changed.
    pub accumulate: bool,
    /// Show frames without their noise, where neither their mean nor their error nor a view of their parts is asked for.
    pub denoise: bool,
    /// Compare with the reference.
    pub error: bool,
    /// Stops from the automatic exposure.
    pub stops: f32,
    pub rig: Rig,
    pub cameras: Vec<SceneCamera>,
    camera: usize,
    /// Those that move with the scene.
    moving_cameras: Vec<usize>,
    /// The camera goes where the chosen one goes.
    pub follow: bool,
    pub timeline: Timeline,
    pub fullscreen: bool,
    pub panels: bool,
    pub help: bool,
    /// The pixel that is inspected.
    pub picked: Option<UVec2>,
    /// Where that pixel's surface is, once it is known.
    pub picked_point: Option<Vec3>,
    /// Orbits go around the picked point once it is known.
    pub center_on_pick: bool,
    /// Counts up when accumulation has to start again by command.
    pub restarts: u32,
    /// Pixels of the picture.
    pub size: UVec2,
    /// Pixels a point: 2 on a display of twice the usual density.
    pub scale: f32,
    held: HashSet<KeyCode>,
    pointer: Pointer,
}

impl State {
    pub fn new(scene: &SceneDescription, first: &SceneCamera, settings: Knobs, size: UVec2) -> Self {
        State {
            settings: [settings.clone(), settings.clone()],
            initial: settings,
            side: 0,
            selected: 0,
            view: View::Final,
            split: Split::Off,
            divider: 0.5,
            accumulate: false,
            denoise: true,
            error: false,
            stops: 0.0,
            rig: rig(scene, first),
            cameras: cameras(scene),
            camera: 0,
            moving_cameras: moving_cameras(scene),
            follow: false,
            timeline: timeline(scene),
            fullscreen: false,
            panels: true,
            help: false,
            picked: None,
            picked_point: None,
            center_on_pick: false,
            restarts: 0,
            size,
            scale: 1.0,
            held: HashSet::new(),
            pointer: Pointer::default(),
        }
    }

    /// Another scene: its cameras; all knobs stay.
    pub fn enter(&mut self, scene: &SceneDescription) {
        self.cameras = cameras(scene);
        self.camera = 0;
        let style = self.rig.style;
        self.rig = rig(scene, &self.cameras[0]);
        self.rig.style = style;
        self.moving_cameras = moving_cameras(scene);
        self.follow = false;
        self.timeline = timeline(scene);
        self.picked = None;
        self.picked_point = None;
    }

    /// The settings that the knobs change.
    pub fn edited(&mut self) -> &mut Knobs {
        &mut self.settings[self.side]
    }

    /// Does anything on screen need the reference?
    pub fn needs_reference(&self) -> bool {
        self.error || self.split == Split::Reference || self.view.needs_reference()
    }

    pub fn apply(&mut self, input: Input) -> Option<Action> {
        match input {
            Input::Key { key, pressed } => return self.key(key, pressed),
            Input::Cursor(at) => self.cursor_moved(at),
            Input::Button { button, pressed } => self.button(button, pressed),
            Input::Scroll(notches) => self.hand().scroll(notches),
            Input::Pinch(change) => self.hand().zoom(1.0 / (1.0 + change).clamp(0.5, 2.0)),
            Input::Unfocused => {
                self.held.clear();
                self.pointer.let_go();
            }
            Input::Scale(scale) => self.scale = scale,
            Input::Dropped(path) => return Some(Action::Load(path)),
            Input::Command(command) => return self.command(command),
        }
        None
    }

    fn key(&mut self, key: KeyCode, pressed: bool) -> Option<Action> {
        if !pressed {
            self.held.remove(&key);
            return None;
        }
        let repeated = !self.held.insert(key);
        let shift = self.is_held(KeyCode::ShiftLeft) || self.is_held(KeyCode::ShiftRight);
        let command = command(key, shift)?;
        // Held keys repeat steps, not switches.
        let steps = matches!(
            command,
            Command::Step(..) | Command::StepSelected(_) | Command::SelectKnob(_) | Command::StepTime(_)
        );
        (steps || !repeated).then(|| self.command(command)).flatten()
    }

    pub fn command(&mut self, command: Command) -> Option<Action> {
        match command {
            Command::Step(knob, step) => knob.step(self.edited(), step),
            Command::Toggle(knob) => knob.toggle(self.edited()),
            Command::SelectKnob(step) => {
                let count = knobs::ALL.len();
                self.selected =
                    if step == Step::Up { self.selected + 1 } else { self.selected + count - 1 } % count;
            }
            Command::StepSelected(step) => knobs::ALL[self.selected].step(self.edited(), step),
            Command::Preset(preset) => self.preset(preset),
            Command::Reset => *self.edited() = self.initial.clone(),
            Command::Accumulate => self.accumulate = !self.accumulate,
            Command::Denoise => self.denoise = !self.denoise,
            Command::Restart => self.restarts += 1,
            Command::View(view) => self.view = view,
            Command::NextView(step) => self.view = self.view.step(step),
            Command::Split => self.set_split(self.split.next()),
            Command::OtherSide => self.side = if self.split == Split::Settings { 1 - self.side } else { 0 },
            Command::Error => self.error = !self.error,
            Command::Exposure(step) => self.stops += if step == Step::Up { 0.5 } else { -0.5 },
            Command::AutoExposure => {
                self.stops = 0.0;
                return Some(Action::Expose);
            }
            Command::OrbitOrFly => {
                self.rig.style = if self.rig.style == Style::Orbit { Style::Fly } else { Style::Orbit };
            }
            Command::NextCamera(step) => {
                let count = self.cameras.len();
                let next = if step == Step::Up { self.camera + 1 } else { self.camera + count - 1 } % count;
                self.look_through(next);
            }
            Command::Focus => {
                if let Some(point) = self.picked_point {
                    self.hand().focus(point);
                }
            }
            Command::Play => self.timeline.play_or_pause(),
            Command::StepTime(step) => self.timeline.step(step),
            Command::Follow => self.set_follow(!self.follow),
            Command::Explain if self.picked.is_some() => return Some(Action::Explain),
            Command::Explain => {}
            Command::CopyExplanation => return Some(Action::CopyExplanation),
            Command::Fullscreen => self.fullscreen = !self.fullscreen,
            Command::Panels => self.panels = !self.panels,
            Command::Help => self.help = !self.help,
            Command::PresentMode => return Some(Action::NextPresentMode),
            Command::CopyCamera => return Some(Action::CopyCamera),
            Command::Screenshot => return Some(Action::Screenshot),
            Command::Quit if self.help => self.help = false,
            Command::Quit => return Some(Action::Quit),
        }
        None
    }

    fn preset(&mut self, preset: Preset) {
        match preset.settings() {
            Some(settings) => {
                *self.edited() = settings;
                if self.view == View::Reference {
                    self.view = View::Final;
                }
            }
            None => self.view = View::Reference,
        }
    }

    pub fn set_split(&mut self, split: Split) {
        self.split = split;
        if split != Split::Settings {
            self.side = 0;
        }
    }

    fn is_held(&self, key: KeyCode) -> bool {
        self.held.contains(&key)
    }

    /// The picture's new size.
    pub fn resize(&mut self, size: UVec2) {
        if size != self.size {
            self.size = size;
            self.picked = None;
        }
    }
}

fn rig(scene: &SceneDescription, camera: &SceneCamera) -> Rig {
    let bounds = scene.bounds();
    let middle = if bounds.extent().min_element() >= 0.0 { bounds.center() } else { Vec3::ZERO };
    let mut rig = Rig::new(camera, middle, bounds.radius());
    rig.origin = scene.origin;
    rig
}

/// The file's cameras, or one around the scene.
fn cameras(scene: &SceneDescription) -> Vec<SceneCamera> {
    if scene.cameras.is_empty() { vec![scene.camera_fitted()] } else { scene.cameras.clone() }
}

fn moving_cameras(scene: &SceneDescription) -> Vec<usize> {
    (0..scene.cameras.len()).filter(|&i| scene.animation.moves(Thing::Camera(i))).collect()
}

fn timeline(scene: &SceneDescription) -> Timeline {
    Timeline::new(scene.animation.duration().into(), None)
}

#[cfg(test)]
mod tests;
