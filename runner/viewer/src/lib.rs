//! The viewer: a window on a scene. Reading order: `input`, `knobs`, `views`, `camera`, `timeline` and `state` know no window
//! and no device; `frames` says what is rendered, `loader` makes those of another scene and `explaining` replays a pixel
//! beside the window; `readings` is what frames tell; `gui` and `screen` show them, `panels` lay out the interface;
//! `running` is the window, `app` and `events` tie it to winit.

mod app;
mod camera;
mod error;
mod events;
mod explaining;
mod frames;
mod gui;
mod input;
mod loader;
mod notices;
mod panels;
mod presets;
mod probe;
mod readings;
mod reference;
mod running;
mod screen;
mod screenshot;
mod script;
mod source;
mod state;
mod surface;
mod swapchain;
mod timeline;
mod timings;
mod trail;
mod views;

pub use script::Script;
pub use source::Source;

use crate::surface::window_extensions;
use candela::error::{Error, Result};
use candela::knobs::Knobs;
use candela::scene::{SceneCamera, SceneDescription};
use candela::vulkan::{Device, DeviceOptions};
use glam::UVec2;
use winit::event_loop::EventLoop;

/// What the window starts with.
pub struct Start {
    pub device: Device,
    pub scene: SceneDescription,
    pub source: Source,
    pub camera: SceneCamera,
    pub settings: Knobs,
    /// Of the scene's animations, s; none: at rest.
    pub time: Option<f64>,
    /// Of the window, pixels.
    pub size: UVec2,
    /// Stops from the automatic exposure.
    pub stops: f32,
    pub script: Script,
}

/// A connection to the display, and a device that can draw to it.
pub struct Display {
    event_loop: EventLoop<()>,
    pub device: Device,
}

impl Display {
    pub fn open(options: DeviceOptions) -> Result<Display> {
        let event_loop = EventLoop::new().map_err(|_| {
            Error::Unsupported("no display to open a window on; candela render works without one".into())
        })?;
        let window_extensions = window_extensions(&event_loop)?;
        let device = Device::new(&DeviceOptions { window_extensions, ..options })?;
        Ok(Display { event_loop, device })
    }

    /// Shows the window until it is closed.
    pub fn run(self, start: Start) -> Result<()> {
        let mut app = app::App::new(start);
        self.event_loop
            .run_app(&mut app)
            .map_err(|e| Error::Platform(format!("the window system failed: {e}")))?;
        app.failure.take().map_or(Ok(()), Err)
    }
}
