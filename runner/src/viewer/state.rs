//! All that a user can change, and how input changes it. No window, no device.

use super::camera::{Rig, Style};
use super::input::{Button, Command, Input, KeyCode, command};
use super::knobs::{Knob, Preset, Step};
use super::views::{Split, View};
use crate::scene::{SceneCamera, SceneDescription};
use crate::settings_file::SettingsFile;
use glam::{UVec2, Vec2, Vec3};
use std::collections::HashSet;
use std::path::PathBuf;

/// A press that moves less than this, in pixels, is a click.
const CLICK: f32 = 4.0;
/// Pixels around the divider that take hold of it.
const GRIP: f32 = 6.0;
/// The longest step of a flight, seconds: a slow frame must not carry through walls.
const LONGEST_STEP: f32 = 0.1;

/// What state alone can't do.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    Load(PathBuf),
    Screenshot,
    CopyCamera,
    NextPresentMode,
    /// By what is seen now.
    Expose,
    Quit,
}

pub struct State {
    /// Of the left side, which is the whole window unless it is split, and of the right side.
    pub settings: [SettingsFile; 2],
    /// What `Reset` goes back to.
    initial: SettingsFile,
    /// Which settings the knobs change.
    pub side: usize,
    pub selected: usize,
    pub view: View,
    pub split: Split,
    /// The divider's place, 0..=1 of the width.
    pub divider: f32,
    /// Show the mean of all frames since something changed.
    pub accumulate: bool,
    /// Compare with the reference.
    pub error: bool,
    /// Stops from the automatic exposure.
    pub stops: f32,
    pub rig: Rig,
    pub cameras: Vec<SceneCamera>,
    camera: usize,
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
    held: HashSet<KeyCode>,
    cursor: Vec2,
    drag: Option<Drag>,
}

struct Drag {
    button: Button,
    from: Vec2,
    moved: bool,
    /// It moves the divider.
    divider: bool,
}

impl State {
    pub fn new(scene: &SceneDescription, first: &SceneCamera, settings: SettingsFile, size: UVec2) -> Self {
        State {
            settings: [settings.clone(), settings.clone()],
            initial: settings,
            side: 0,
            selected: 0,
            view: View::Final,
            split: Split::Off,
            divider: 0.5,
            accumulate: false,
            error: false,
            stops: 0.0,
            rig: rig(scene, first),
            cameras: cameras(scene),
            camera: 0,
            fullscreen: false,
            panels: true,
            help: false,
            picked: None,
            picked_point: None,
            center_on_pick: false,
            restarts: 0,
            size,
            held: HashSet::new(),
            cursor: Vec2::ZERO,
            drag: None,
        }
    }

    /// Another scene: its cameras; all knobs stay.
    pub fn enter(&mut self, scene: &SceneDescription) {
        self.cameras = cameras(scene);
        self.camera = 0;
        let style = self.rig.style;
        self.rig = rig(scene, &self.cameras[0]);
        self.rig.style = style;
        self.picked = None;
        self.picked_point = None;
    }

    /// The settings that the knobs change.
    pub fn edited(&mut self) -> &mut SettingsFile {
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
            Input::Scroll(notches) => self.rig.scroll(notches),
            Input::Pinch(change) => self.rig.zoom(1.0 / (1.0 + change).clamp(0.5, 2.0)),
            Input::Unfocused => {
                self.held.clear();
                self.drag = None;
            }
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
        let steps = matches!(command, Command::Step(..) | Command::StepSelected(_) | Command::SelectKnob(_));
        (steps || !repeated).then(|| self.command(command)).flatten()
    }

    pub fn command(&mut self, command: Command) -> Option<Action> {
        match command {
            Command::Step(knob, step) => knob.step(self.edited(), step),
            Command::Toggle(knob) => knob.toggle(self.edited()),
            Command::SelectKnob(step) => {
                let count = Knob::ALL.len();
                self.selected =
                    if step == Step::Up { self.selected + 1 } else { self.selected + count - 1 } % count;
            }
            Command::StepSelected(step) => Knob::ALL[self.selected].step(self.edited(), step),
            Command::Preset(preset) => self.preset(preset),
            Command::Reset => *self.edited() = self.initial.clone(),
            Command::Accumulate => self.accumulate = !self.accumulate,
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
                    self.rig.focus(point);
                }
            }
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

    /// Takes the place of one of the scene's cameras.
    pub fn look_through(&mut self, camera: usize) {
        if let Some(chosen) = self.cameras.get(camera) {
            self.camera = camera;
            self.rig.look_through(chosen);
        }
    }

    /// Index of the scene's camera that was chosen last.
    pub fn chosen_camera(&self) -> usize {
        self.camera
    }

    fn cursor_moved(&mut self, at: Vec2) {
        let delta = (at - self.cursor) / self.size.y.max(1) as f32;
        self.cursor = at;
        let width = self.size.x.max(1) as f32;
        let Some(drag) = &mut self.drag else { return };
        drag.moved |= at.distance(drag.from) >= CLICK;
        if drag.divider {
            self.divider = (at.x / width).clamp(0.0, 1.0);
        } else if drag.moved {
            match drag.button {
                Button::Left => self.rig.turn(delta),
                Button::Middle | Button::Right => self.rig.pan(delta),
            }
        }
    }

    fn button(&mut self, button: Button, pressed: bool) {
        if pressed {
            let line = self.divider * self.size.x as f32;
            let divider =
                self.split != Split::Off && button == Button::Left && (self.cursor.x - line).abs() <= GRIP;
            self.drag = Some(Drag { button, from: self.cursor, moved: false, divider });
            return;
        }
        let Some(drag) = self.drag.take().filter(|drag| drag.button == button) else { return };
        if button == Button::Left && !drag.moved && !drag.divider {
            self.pick(self.cursor);
        }
    }

    fn pick(&mut self, at: Vec2) {
        let inside = at.cmpge(Vec2::ZERO).all() && at.cmplt(self.size.as_vec2()).all();
        if inside {
            self.picked = Some(at.as_uvec2());
            self.picked_point = None;
            self.center_on_pick = true;
        }
    }

    /// The picked pixel's surface has been read: its place in the world.
    pub fn found(&mut self, point: Option<Vec3>) {
        self.picked_point = point;
        if let Some(point) = point
            && std::mem::take(&mut self.center_on_pick)
        {
            self.rig.set_center(point);
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

    /// Lets `seconds` pass: held keys fly. Is anything held?
    pub fn advance(&mut self, seconds: f32) -> bool {
        let axis = |plus: KeyCode, minus: KeyCode| {
            f32::from(u8::from(self.is_held(plus))) - f32::from(u8::from(self.is_held(minus)))
        };
        let direction = Vec3::new(
            axis(KeyCode::KeyD, KeyCode::KeyA),
            axis(KeyCode::KeyE, KeyCode::KeyQ),
            axis(KeyCode::KeyW, KeyCode::KeyS),
        );
        if direction == Vec3::ZERO {
            return false;
        }
        let fast = self.is_held(KeyCode::ShiftLeft) || self.is_held(KeyCode::ShiftRight);
        let slow = self.is_held(KeyCode::ControlLeft) || self.is_held(KeyCode::ControlRight);
        let factor = if fast { 4.0 } else { 1.0 } * if slow { 0.25 } else { 1.0 };
        self.rig.walk(direction * factor, seconds.clamp(0.0, LONGEST_STEP));
        true
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

#[cfg(test)]
mod tests {
    use super::*;

    fn state() -> State {
        let scene = SceneDescription::default();
        let camera = scene.camera_fitted();
        State::new(&scene, &camera, SettingsFile::default(), UVec2::new(200, 100))
    }

    fn press(state: &mut State, key: KeyCode) -> Option<Action> {
        let action = state.apply(Input::Key { key, pressed: true });
        assert_eq!(state.apply(Input::Key { key, pressed: false }), None);
        action
    }

    fn drag(state: &mut State, button: Button, from: Vec2, to: Vec2) {
        for input in [
            Input::Cursor(from),
            Input::Button { button, pressed: true },
            Input::Cursor(to),
            Input::Button { button, pressed: false },
        ] {
            assert_eq!(state.apply(input), None);
        }
    }

    /// With four keys alone every knob can be reached and changed.
    #[test]
    fn arrows_reach_every_knob() {
        let mut state = state();
        for knob in Knob::ALL {
            let before = knob.value(&state.settings[0]);
            let mut changed = false;
            for key in [KeyCode::ArrowRight, KeyCode::ArrowLeft] {
                press(&mut state, key);
                changed |= knob.value(&state.settings[0]) != before;
            }
            assert!(changed, "{knob:?}");
            press(&mut state, KeyCode::ArrowDown);
        }
        assert_eq!(state.selected, 0, "around once");
        press(&mut state, KeyCode::Backspace);
        assert_eq!(state.settings[0], SettingsFile::default());
    }

    #[test]
    fn presets_and_the_reference() {
        let mut state = state();
        press(&mut state, KeyCode::Digit3);
        assert_eq!(Some(state.settings[0].clone()), Preset::Unbiased.settings());
        assert!(!state.needs_reference());
        press(&mut state, KeyCode::Digit4);
        assert!(state.view == View::Reference && state.needs_reference());
        press(&mut state, KeyCode::Digit1);
        assert!(state.view == View::Final);
    }

    #[test]
    fn two_settings_are_changed_one_at_a_time() {
        let mut state = state();
        press(&mut state, KeyCode::KeyL);
        assert_eq!(state.side, 0, "there is one side only");
        press(&mut state, KeyCode::KeyB);
        press(&mut state, KeyCode::KeyL);
        press(&mut state, KeyCode::Period);
        assert_eq!((state.settings[0].candidates, state.settings[1].candidates), (32, 64));
        press(&mut state, KeyCode::KeyB);
        assert_eq!((state.split, state.side), (Split::Reference, 0));
    }

    #[test]
    fn a_click_picks_and_a_drag_turns() {
        let mut state = state();
        let at = Vec2::new(50.0, 20.0);
        let before = state.rig.clone();
        drag(&mut state, Button::Left, at, at + 1.0);
        assert_eq!(state.picked, Some(UVec2::new(51, 21)));
        assert_eq!(state.rig, before);
        drag(&mut state, Button::Left, at, at + 30.0);
        assert_ne!(state.rig.forward, before.forward);
        let turned = state.rig.clone();
        drag(&mut state, Button::Right, at, at + 30.0);
        assert_eq!(state.rig.forward, turned.forward);
        assert_ne!(state.rig.position, turned.position);
    }

    #[test]
    fn the_divider_is_dragged() {
        let mut state = state();
        press(&mut state, KeyCode::KeyB);
        let before = state.rig.clone();
        drag(&mut state, Button::Left, Vec2::new(102.0, 50.0), Vec2::new(40.0, 50.0));
        assert_eq!((state.divider, &state.rig, state.picked), (0.2, &before, None));
    }

    #[test]
    fn a_found_point_becomes_the_center_once() {
        let mut state = state();
        let point = state.rig.position + 2.0 * state.rig.forward;
        drag(&mut state, Button::Left, Vec2::new(9.0, 9.0), Vec2::new(9.0, 9.0));
        state.found(Some(point));
        assert!((state.rig.center() - point).length() < 1e-3);
        state.rig.zoom(0.5);
        let center = state.rig.center();
        state.found(Some(point + Vec3::X));
        assert_eq!(state.rig.center(), center);
        press(&mut state, KeyCode::KeyF);
        assert!((state.rig.center() - point - Vec3::X).length() < 1e-3);
    }

    #[test]
    fn held_keys_fly_and_a_lost_keyboard_stops_it() {
        let mut state = state();
        state.apply(Input::Key { key: KeyCode::KeyW, pressed: true });
        let before = state.rig.position;
        assert!(state.advance(0.05));
        let step = state.rig.position.distance(before);
        assert!(step > 0.0);
        state.apply(Input::Key { key: KeyCode::ShiftLeft, pressed: true });
        let before = state.rig.position;
        state.advance(0.05);
        assert!((state.rig.position.distance(before) / step - 4.0).abs() < 1e-3);
        state.apply(Input::Unfocused);
        assert!(!state.advance(0.05));
    }

    #[test]
    fn a_held_switch_does_not_flicker() {
        let mut state = state();
        for _ in 0..3 {
            state.apply(Input::Key { key: KeyCode::KeyP, pressed: true });
        }
        assert!(state.accumulate);
        for _ in 0..3 {
            state.apply(Input::Key { key: KeyCode::Period, pressed: true });
        }
        assert_eq!(state.settings[0].candidates, 256);
    }

    #[test]
    fn what_state_cannot_do_is_asked_for() {
        let mut state = state();
        assert_eq!(press(&mut state, KeyCode::F12), Some(Action::Screenshot));
        let path = PathBuf::from("a.glb");
        assert_eq!(state.apply(Input::Dropped(path.clone())), Some(Action::Load(path)));
        press(&mut state, KeyCode::F1);
        assert_eq!((press(&mut state, KeyCode::Escape), state.help), (None, false));
        assert_eq!(press(&mut state, KeyCode::Escape), Some(Action::Quit));
    }
}
