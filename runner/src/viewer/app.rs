//! winit's events in, frames out.

use super::Start;
use super::frames::Frames;
use super::input::{Button, Input};
use super::loader::{Loader, Source};
use super::notices::Notices;
use super::panels::{self, Info};
use super::probe::Probe;
use super::screen::{FRAMES, Part, Screen};
use super::script::{Event, Script};
use super::state::{Action, State};
use super::timings::Timings;
use crate::error::{Error, Result};
use crate::gpu_scene::GpuScene;
use crate::scene::SceneDescription;
use crate::vulkan::{CommandRing, Device};
use ash::vk;
use glam::{UVec2, Vec2};
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;
use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::{ElementState, MouseButton, MouseScrollDelta, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow};
use winit::keyboard::PhysicalKey;
use winit::window::{Fullscreen, Window, WindowId};

/// Pixels of a touchpad's scrolling that count as a notch of a wheel.
const NOTCH_PIXELS: f32 = 40.0;

/// The viewer before and after its window is there.
pub struct App {
    start: Option<Start>,
    running: Option<Running>,
    /// Why the window closed, if not by the user.
    pub failure: Option<Error>,
}

impl App {
    pub fn new(start: Start) -> App {
        App { start: Some(start), running: None, failure: None }
    }

    fn check(&mut self, event_loop: &ActiveEventLoop, result: Result<()>) {
        let Err(error) = result else { return };
        let pass = self.running.as_ref().and_then(|running| running.frames.last_pass());
        self.failure.get_or_insert(match (error, pass) {
            (Error::DeviceLost(_), Some(pass)) => Error::DeviceLost(pass.into()),
            (error, _) => error,
        });
        event_loop.exit();
    }
}

impl ApplicationHandler for App {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        let Some(start) = self.start.take() else { return };
        match Running::new(event_loop, start) {
            Ok(running) => self.running = Some(running),
            Err(error) => self.check(event_loop, Err(error)),
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(running) = &mut self.running else { return };
        let result = running.event(event_loop, event);
        self.check(event_loop, result);
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        let Some(running) = &self.running else { return };
        if running.hidden {
            event_loop.set_control_flow(ControlFlow::Wait);
        } else {
            event_loop.set_control_flow(ControlFlow::Poll);
            running.window.request_redraw();
        }
    }
}

/// Fields drop in this order: what uses the device first, the window last.
struct Running {
    ring: CommandRing,
    frames: Frames,
    screen: Screen,
    loader: Loader,
    state: State,
    script: Script,
    notices: Notices,
    timings: Timings,
    probe: Option<Probe>,
    error: Option<f64>,
    scene: SceneFacts,
    source: Source,
    /// Nothing of the window can be seen: no frames.
    hidden: bool,
    last_frame: Instant,
    device: Device,
    window: Arc<Window>,
}

/// What the panels say of a scene.
pub struct SceneFacts {
    pub name: String,
    pub triangles: usize,
    pub lights: u32,
}

impl SceneFacts {
    fn new(scene: &SceneDescription, gpu: &GpuScene) -> Self {
        SceneFacts { name: scene.name.clone(), triangles: scene.triangle_count(), lights: gpu.light_count() }
    }
}

impl Running {
    fn new(event_loop: &ActiveEventLoop, start: Start) -> Result<Running> {
        let size = PhysicalSize::new(start.size.x, start.size.y);
        let attributes = Window::default_attributes()
            .with_title(title(&start.scene.name))
            .with_inner_size(size)
            .with_min_inner_size(PhysicalSize::new(64, 64));
        let window = event_loop.create_window(attributes).map_err(|e| {
            Error::Usage(format!("can't open a window: {e}; candela render works without one"))
        })?;
        let (device, window) = (start.device, Arc::new(window));
        let screen = Screen::new(&device, window.clone(), vk::PresentModeKHR::FIFO)?;
        let gpu_scene = GpuScene::new(&device, &start.scene)?;
        let scene = SceneFacts::new(&start.scene, &gpu_scene);
        let mut state = State::new(&start.scene, &start.camera, start.settings, start.size);
        state.stops = start.stops;
        let mut notices = Notices::default();
        start.scene.warnings.iter().for_each(|warning| notices.say(warning.clone()));
        Ok(Running {
            ring: CommandRing::new(&device, FRAMES)?,
            frames: Frames::new(&device, gpu_scene, start.size, FRAMES, start.scene.bounds().radius())?,
            screen,
            loader: Loader::default(),
            state,
            script: start.script,
            notices,
            timings: Timings::default(),
            probe: None,
            error: None,
            scene,
            source: start.source,
            hidden: false,
            last_frame: Instant::now(),
            device,
            window,
        })
    }

    fn event(&mut self, event_loop: &ActiveEventLoop, event: WindowEvent) -> Result<()> {
        let consumed = match self.screen.gui() {
            Some(gui) => gui.window_state.on_window_event(&self.window, &event).consumed,
            None => false,
        };
        match &event {
            WindowEvent::CloseRequested => event_loop.exit(),
            WindowEvent::Resized(size) => {
                self.hidden = size.width == 0 || size.height == 0;
                self.screen.resize(UVec2::new(size.width, size.height));
            }
            WindowEvent::Occluded(occluded) => self.hidden = *occluded,
            WindowEvent::RedrawRequested => return self.frame(event_loop),
            _ => {}
        }
        // What egui took is not for the camera, but a button that was pressed outside must come up.
        match translate(&event) {
            Some(Input::Key { pressed: true, .. } | Input::Button { pressed: true, .. }) if consumed => {
                Ok(())
            }
            Some(Input::Scroll(_) | Input::Pinch(_)) if consumed => Ok(()),
            Some(input) => self.input(event_loop, input),
            None => Ok(()),
        }
    }

    fn input(&mut self, event_loop: &ActiveEventLoop, input: Input) -> Result<()> {
        match self.state.apply(input) {
            Some(action) => self.act(event_loop, action),
            None => Ok(()),
        }
    }

    fn act(&mut self, event_loop: &ActiveEventLoop, action: Action) -> Result<()> {
        match action {
            Action::Quit => event_loop.exit(),
            Action::Load(path) => {
                let started = self.source.with_file(&path).and_then(|source| self.loader.start(source));
                started.unwrap_or_else(|error| self.notices.fail(error));
            }
            Action::Expose => {
                self.ring.wait()?;
                self.frames.expose()?;
            }
            Action::NextPresentMode => self.screen.next_mode()?,
            Action::CopyCamera => {
                let line =
                    format!("candela {} --camera={}", self.source.arguments(), self.state.rig.argument());
                println!("{line}");
                self.notices.say(format!("copied: {line}"));
                if let Some(gui) = self.screen.gui() {
                    gui.window_state.set_clipboard_text(line);
                }
            }
            Action::Screenshot => {
                self.ring.wait()?;
                let saved = self.screenshot(Path::new("."));
                match saved {
                    Ok(name) => self.notices.say(format!("saved {name}.png, .exr and .json")),
                    Err(error) => self.notices.fail(error),
                }
            }
        }
        Ok(())
    }

    fn frame(&mut self, event_loop: &ActiveEventLoop) -> Result<()> {
        self.take_loaded()?;
        self.follow_script(event_loop)?;
        let seconds = self.last_frame.elapsed().as_secs_f32();
        self.last_frame = Instant::now();
        self.state.advance(seconds);
        self.follow_window();
        if !self.screen.refresh(&mut self.ring)? {
            return Ok(());
        }
        let Some(size) = self.screen.size() else { return Ok(()) };
        self.state.resize(size);
        for action in self.interface() {
            self.act(event_loop, action)?;
        }
        if !self.frames.fits(&self.state, size) {
            self.ring.wait()?;
            self.frames.fit(&self.state, size)?;
            self.screen.forget_picture();
        }
        self.draw(size)?;
        if self.frames.needs_exposure() {
            self.ring.wait()?;
            self.frames.expose()?;
        }
        self.script.frame_done();
        Ok(())
    }

    /// Lays out the panels; what they ask for beyond the state.
    fn interface(&mut self) -> Vec<Action> {
        let mut actions = Vec::new();
        let info = Info {
            scene: &self.scene,
            device: &self.device,
            timings: &self.timings,
            probe: self.probe.as_ref(),
            error: self.error,
            counts: self.frames.counts(),
            mode: self.screen.mode(),
            picture_bytes: self.frames.bytes(),
            loading: self.loader.progress(),
            notices: &mut self.notices,
        };
        let (state, window) = (&mut self.state, &self.window);
        if let Some(gui) = self.screen.gui() {
            let mut info = info;
            gui.run(window, |ui| panels::show(ui, state, &mut info, &mut actions));
        }
        actions
    }

    /// Renders and shows one frame. Waits only for the frame that used the slot before, and for the window's image.
    fn draw(&mut self, size: UVec2) -> Result<()> {
        let Running { ring, frames, screen, state, timings, probe, error, .. } = self;
        if let Some(gui) = screen.gui() {
            gui.upload(ring)?;
        }
        let commands = ring.begin()?;
        let (cmd, slot) = (commands.cmd(), commands.slot());
        if let Some(times) = frames.times(slot)? {
            timings.add(&times);
        }
        let found = frames.probe(slot)?.filter(|found| Some(found.pixel) == state.picked);
        state.found(found.as_ref().and_then(Probe::position));
        *probe = found;
        *error = frames.error(slot)?;
        let Some(image) = screen.acquire(slot)? else { return Ok(()) };
        let divider = (state.divider * size.x as f32) as u32;
        let shown = frames.record(cmd, slot, state)?;
        let mut parts = vec![Part { display: shown.left, from: 0 }];
        parts.extend(shown.right.map(|display| Part { display, from: divider }));
        screen.record(cmd, slot, &image, size, &parts)?;
        commands.submit(&[(image.ready, vk::PipelineStageFlags::TRANSFER)], &[image.rendered])?;
        screen.present(&image)
    }

    /// A scene that has been read takes the place of the old one; a failure leaves everything as it was.
    fn take_loaded(&mut self) -> Result<()> {
        let Some((source, result)) = self.loader.poll() else { return Ok(()) };
        let entered = result.and_then(|scene| {
            let gpu_scene = GpuScene::new(&self.device, &scene)?;
            let facts = SceneFacts::new(&scene, &gpu_scene);
            let (size, radius) = (self.frames.size(), scene.bounds().radius());
            Ok((Frames::new(&self.device, gpu_scene, size, FRAMES, radius)?, scene, facts))
        });
        let (frames, scene, facts) = match entered {
            Ok(entered) => entered,
            // Nothing renders any more.
            Err(error @ Error::DeviceLost(_)) => return Err(error),
            Err(error) => {
                self.notices.fail(error);
                return Ok(());
            }
        };
        self.ring.wait()?;
        self.frames = frames;
        self.state.enter(&scene);
        self.window.set_title(&title(&scene.name));
        scene.warnings.iter().for_each(|warning| self.notices.say(warning.clone()));
        self.timings.clear();
        (self.scene, self.source) = (facts, source);
        Ok(())
    }

    /// The window is as the state wants it.
    fn follow_window(&self) {
        if self.window.fullscreen().is_some() != self.state.fullscreen {
            self.window.set_fullscreen(self.state.fullscreen.then_some(Fullscreen::Borderless(None)));
        }
    }

    fn follow_script(&mut self, event_loop: &ActiveEventLoop) -> Result<()> {
        while let Some(event) = self.script.next(self.loader.is_busy()) {
            match event {
                Event::Input(input) => self.input(event_loop, input)?,
                Event::Resize(size) => {
                    let _ = self.window.request_inner_size(PhysicalSize::new(size.x, size.y));
                }
                Event::Expect(what) => self.expect(&what)?,
                Event::Save(directory) => {
                    self.ring.wait()?;
                    self.screenshot(&directory)?;
                }
                Event::Fail(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// A script's check: `scene NAME`, `error TEXT`, `size WxH`.
    fn expect(&self, what: &str) -> Result<()> {
        let (key, value) = what.split_once(' ').unwrap_or((what, ""));
        let size = self.frames.size();
        let found = match key {
            "scene" => self.scene.name.clone(),
            "error" => self.notices.last_error().unwrap_or_default().to_string(),
            "size" => format!("{}x{}", size.x, size.y),
            "reference" => self.frames.counts().1.map_or(String::new(), |_| "there".into()),
            "compared" => if self.error.is_some_and(|e| e > 0.0 && e < 10.0) { "yes" } else { "" }.into(),
            "candidates" => self.state.settings[0].candidates.to_string(),
            other => return Err(Error::Usage(format!("script: can't expect '{other}'"))),
        };
        if found.contains(value) && value.is_empty() == found.is_empty() {
            return Ok(());
        }
        Err(Error::Usage(format!("script: expected {key} '{value}', found '{found}'")))
    }

    /// The picture as it is shown, its radiance and its settings; the files' common name.
    fn screenshot(&self, directory: &Path) -> Result<String> {
        super::screenshot::save(directory, &self.frames, &self.state)
    }
}

fn title(scene: &str) -> String {
    format!("{scene} - Candela")
}

/// What a window's event means, if anything.
fn translate(event: &WindowEvent) -> Option<Input> {
    Some(match event {
        WindowEvent::KeyboardInput { event, .. } => {
            let PhysicalKey::Code(key) = event.physical_key else { return None };
            Input::Key { key, pressed: event.state == ElementState::Pressed }
        }
        WindowEvent::CursorMoved { position, .. } => {
            Input::Cursor(Vec2::new(position.x as f32, position.y as f32))
        }
        WindowEvent::MouseInput { state, button, .. } => {
            let button = match button {
                MouseButton::Left => Button::Left,
                MouseButton::Middle => Button::Middle,
                MouseButton::Right => Button::Right,
                _ => return None,
            };
            Input::Button { button, pressed: *state == ElementState::Pressed }
        }
        WindowEvent::MouseWheel { delta, .. } => Input::Scroll(match delta {
            MouseScrollDelta::LineDelta(_, y) => *y,
            MouseScrollDelta::PixelDelta(pixels) => pixels.y as f32 / NOTCH_PIXELS,
        }),
        WindowEvent::PinchGesture { delta, .. } => Input::Pinch(*delta as f32),
        WindowEvent::Focused(false) => Input::Unfocused,
        WindowEvent::DroppedFile(path) => Input::Dropped(path.clone()),
        _ => return None,
    })
}
