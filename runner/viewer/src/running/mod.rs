//! A window that is open: events change the state, frames show it.

mod actions;
mod checks;

use super::Start;
use super::app::Pace;
use super::events::translate;
use super::explaining::{Answer, Explaining};
use super::frames::{First, FrameFacts, Frames};
use super::input::Input;
use super::loader::Loader;
use super::notices::Notices;
use super::panels::{self, Info};
use super::readings::Readings;
use super::screen::{FRAMES, Part, Screen};
use super::script::Script;
use super::source::Source;
use super::state::{Action, State};
use ash::vk;
use candela::error::{Error, Result};
use candela::scene::SceneDescription;
use candela::vulkan::{CommandRing, Device};
use glam::UVec2;
use std::sync::Arc;
use std::time::Instant;
use winit::dpi::PhysicalSize;
use winit::event::WindowEvent;
use winit::event_loop::ActiveEventLoop;
use winit::window::{Fullscreen, Window};

/// Fields drop in this order: what uses the device first, the window last.
pub struct Running {
    explaining: Option<Explaining>,
    ring: CommandRing,
    /// None while a pixel is being explained.
    frames: Option<Frames>,
    screen: Screen,
    loader: Loader<Frames>,
    state: State,
    script: Script,
    notices: Notices,
    readings: Readings,
    answer: Option<Answer>,
    /// Explain the picked pixel after the next frame.
    asked: bool,
    scene: SceneFacts,
    facts: FrameFacts,
    source: Source,
    hidden: Hidden,
    /// The last frame had nothing to draw on.
    stalled: bool,
    /// For tests: the next upload fails so.
    planted: Option<Error>,
    last_frame: Instant,
    device: Device,
    window: Arc<Window>,
}

/// Why nothing of the window can be seen.
#[derive(Default)]
struct Hidden {
    minimised: bool,
    occluded: bool,
}

impl Hidden {
    fn is_so(&self) -> bool {
        self.minimised || self.occluded
    }
}

/// What the panels say of a scene.
pub struct SceneFacts {
    pub name: String,
    pub triangles: usize,
    pub lights: u32,
}

impl SceneFacts {
    fn new(scene: &SceneDescription, lights: u32) -> Self {
        SceneFacts { name: scene.name.clone(), triangles: scene.triangle_count(), lights }
    }
}

impl Running {
    pub fn new(event_loop: &ActiveEventLoop, start: Start) -> Result<Running> {
        let size = PhysicalSize::new(start.size.x, start.size.y);
        let attributes = Window::default_attributes()
            .with_title(title(&start.scene.name))
            .with_inner_size(size)
            .with_min_inner_size(PhysicalSize::new(64, 64));
        let window = event_loop.create_window(attributes).map_err(|e| {
            Error::Unsupported(format!("can't open a window: {e}; candela render works without one"))
        })?;
        let (device, window) = (start.device, Arc::new(window));
        let screen = Screen::new(&device, window.clone(), vk::PresentModeKHR::FIFO)?;
        let mut state = State::new(&start.scene, &start.camera, start.settings.clone(), start.size);
        state.stops = start.stops;
        state.scale = window.scale_factor() as f32;
        start.time.into_iter().for_each(|time| state.timeline.seek(time));
        let mut notices = Notices::default();
        start.scene.warnings.iter().for_each(|warning| notices.say(warning.clone()));
        let first = First {
            size: start.size,
            camera: start.camera,
            settings: start.settings,
            time: state.timeline.time(),
        };
        let frames = Frames::new(&device, start.scene, FRAMES, &first, &mut |_| Ok(()))?;
        Ok(Running {
            explaining: None,
            ring: CommandRing::new(&device, FRAMES)?,
            scene: SceneFacts::new(frames.scene(), frames.light_count()),
            frames: Some(frames),
            screen,
            loader: Loader::default(),
            state,
            script: start.script,
            notices,
            readings: Readings::default(),
            answer: None,
            asked: false,
            facts: FrameFacts::default(),
            source: start.source,
            hidden: Hidden::default(),
            stalled: false,
            planted: None,
            last_frame: Instant::now(),
            device,
            window,
        })
    }

    pub fn pace(&self) -> Pace {
        // Not every window system takes a minimised window's area away.
        if self.hidden.is_so() || self.window.is_minimized() == Some(true) {
            return Pace::Sleep;
        }
        if self.stalled { Pace::Retry } else { Pace::Draw }
    }

    pub fn redraw(&self) {
        self.window.request_redraw();
    }

    /// The pass that a lost frame was in, as far as the device has told.
    pub fn last_pass(&self) -> Option<&'static str> {
        self.frames.as_ref().and_then(Frames::last_pass)
    }

    pub fn event(&mut self, event_loop: &ActiveEventLoop, event: WindowEvent) -> Result<()> {
        let consumed = match self.screen.gui() {
            Some(gui) => gui.window_state.on_window_event(&self.window, &event).consumed,
            None => false,
        };
        match &event {
            WindowEvent::CloseRequested => event_loop.exit(),
            WindowEvent::Resized(size) => self.resized(UVec2::new(size.width, size.height)),
            WindowEvent::Occluded(occluded) => self.hidden.occluded = *occluded,
            WindowEvent::RedrawRequested => return self.frame(event_loop),
            _ => {}
        }
        // What egui took is not for the camera, but a button that was pressed outside must come up.
        match translate(&event, self.state.scale) {
            Some(Input::Key { pressed: true, .. } | Input::Button { pressed: true, .. }) if consumed => {
                Ok(())
            }
            Some(Input::Scroll(_) | Input::Pinch(_)) if consumed => Ok(()),
            Some(input) => self.input(event_loop, input),
            None => Ok(()),
        }
    }

    /// A window without area is minimised.
    fn resized(&mut self, size: UVec2) {
        self.hidden.minimised = size.x == 0 || size.y == 0;
        self.screen.resize(size);
    }

    fn input(&mut self, event_loop: &ActiveEventLoop, input: Input) -> Result<()> {
        match self.state.apply(input) {
            Some(action) => self.act(event_loop, action),
            None => Ok(()),
        }
    }

    fn frame(&mut self, event_loop: &ActiveEventLoop) -> Result<()> {
        if self.hidden.is_so() {
            return Ok(());
        }
        self.take_explained()?;
        self.take_loaded()?;
        self.follow_script(event_loop)?;
        let seconds = self.last_frame.elapsed().as_secs_f32();
        self.last_frame = Instant::now();
        self.state.advance(seconds);
        self.follow_window();
        self.stalled = true;
        if self.hidden.is_so() || !self.screen.refresh(&mut self.ring)? {
            return Ok(());
        }
        let Some(size) = self.screen.size() else { return Ok(()) };
        self.stalled = false;
        self.state.resize(size);
        for action in self.interface() {
            self.act(event_loop, action)?;
        }
        self.prepare(size)?;
        self.draw(size)?;
        self.script.frame_done();
        self.ask()
    }

    /// Lays out the panels; what they ask for beyond the state.
    fn interface(&mut self) -> Vec<Action> {
        let mut actions = Vec::new();
        let mut info = Info {
            scene: &self.scene,
            device: &self.device,
            readings: &self.readings,
            facts: self.facts,
            mode: self.screen.mode(),
            loading: self.loader.progress(),
            explaining: self.explaining.as_ref().map(|it| (it.pixel(), it.seconds())),
            answer: &mut self.answer,
            notices: &mut self.notices,
        };
        let (state, window) = (&mut self.state, &self.window);
        if let Some(gui) = self.screen.gui() {
            gui.run(window, |ui| panels::show(ui, state, &mut info, &mut actions));
        }
        actions
    }

    /// The scene at its time, and buffers for what the state asks for.
    fn prepare(&mut self, size: UVec2) -> Result<()> {
        let Some(frames) = &mut self.frames else { return Ok(()) };
        frames.pose(self.state.timeline.time());
        self.state.cameras_are(&frames.scene().cameras);
        if !frames.fits(&self.state, size) {
            self.ring.wait()?;
            frames.fit(&self.state, size)?;
            self.screen.forget_picture();
        }
        Ok(())
    }

    /// Renders and shows one frame. Waits only for the frame that used the slot before, and for the window's image.
    /// While a pixel is being explained, the last picture stays.
    fn draw(&mut self, size: UVec2) -> Result<()> {
        if self.frames.is_none() && !self.screen.has_picture() {
            return Ok(());
        }
        let Running { ring, frames, screen, state, readings, facts, .. } = self;
        if let Some(gui) = screen.gui() {
            gui.upload(ring)?;
        }
        let commands = ring.begin()?;
        let (cmd, slot) = (commands.cmd(), commands.slot());
        if let Some(readback) = frames.as_mut().map(|frames| frames.read(slot)).transpose()?.flatten() {
            readings.take(readback, state);
        }
        let Some(image) = screen.acquire(slot)? else { return Ok(()) };
        let mut parts = Vec::new();
        if let Some(frames) = frames {
            *facts = frames.facts(state);
            let shown = frames.record(cmd, slot, state)?;
            parts.push(Part { display: shown.left, from: 0 });
            let from = state.divider_column() as u32;
            parts.extend(shown.right.map(|display| Part { display, from }));
        }
        screen.record(cmd, slot, &image, size, &parts)?;
        commands.submit(&[(image.ready, vk::PipelineStageFlags::TRANSFER)], &[image.rendered])?;
        screen.present(&image)
    }

    /// The window is as the state wants it.
    fn follow_window(&self) {
        if self.window.fullscreen().is_some() != self.state.fullscreen {
            self.window.set_fullscreen(self.state.fullscreen.then_some(Fullscreen::Borderless(None)));
        }
    }
}

fn title(scene: &str) -> String {
    format!("{scene} - Candela")
}
