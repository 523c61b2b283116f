//! Steps and expectations of a script, for tests.

use super::Running;
use crate::input::Input;
use crate::script::Event;
use candela::error::{Error, Result};
use glam::UVec2;
use winit::dpi::PhysicalSize;
use winit::event_loop::ActiveEventLoop;

impl Running {
    pub(super) fn follow_script(&mut self, event_loop: &ActiveEventLoop) -> Result<()> {
        loop {
            let busy = self.loader.is_busy() || self.explaining.is_some() || self.asked;
            let Running { script, .. } = self;
            let Some(event) = script.next(busy) else { return Ok(()) };
            match event {
                Event::Input(input) => self.input(event_loop, input)?,
                Event::Resize(size) => {
                    let _ = self.window.request_inner_size(PhysicalSize::new(size.x, size.y));
                }
                Event::Scale(scale) => {
                    self.input(event_loop, Input::Scale(scale))?;
                    if let Some(gui) = self.screen.gui() {
                        gui.context.set_zoom_factor(scale);
                    }
                }
                Event::Minimise => self.resized(UVec2::ZERO),
                Event::Say(text) => println!("{text}"),
                Event::Expect(what) => self.expect(&what).map_err(Error::Check)?,
                Event::Await(what) => {
                    if self.expect(&what).is_err() {
                        self.script.again(Event::Await(what))?;
                        return Ok(());
                    }
                }
                Event::Save(directory) => {
                    self.screenshot(&directory)?;
                }
                Event::FailUpload(error) => self.planted = Some(error),
                Event::Fail(error) => return Err(error),
                Event::Close => event_loop.exit(),
            }
        }
    }

    /// A script's check: what is to be found, and what part of it.
    fn expect(&self, what: &str) -> Result<(), String> {
        let (key, value) = what.split_once(' ').unwrap_or((what, ""));
        let state = &self.state;
        let yes = |yes: bool| if yes { "yes" } else { "" }.to_string();
        let found = match key {
            "scene" => self.scene.name.clone(),
            "source" => self.source.arguments(),
            "error" => self.notices.last_error().unwrap_or_default().to_string(),
            "size" => format!("{}x{}", state.size.x, state.size.y),
            "scale" => state.scale.to_string(),
            "mode" => format!("{:?}", self.screen.mode()),
            "fullscreen" => yes(self.window.fullscreen().is_some()),
            "reference" => yes(self.facts.counts.1.is_some()),
            "compared" => yes(self.readings.error.is_some_and(|it| it.error > 0.0 && it.error < 10.0)),
            "trail" => yes(!self.readings.trail.points().is_empty()),
            "whole" => yes(self.readings.trail.is_whole()),
            "candidates" => state.settings[0].candidates.to_string(),
            "time" => state.timeline.time().map_or(String::new(), |time| format!("{time:.4}")),
            "camera" => format!("{:.4}", state.rig.position),
            "explanation" => self.answer.as_ref().map_or(String::new(), |answer| answer.text()),
            other => return Err(format!("script: can't expect '{other}'")),
        };
        if found.contains(value) && value.is_empty() == found.is_empty() {
            return Ok(());
        }
        Err(format!("script: expected {key} '{value}', found '{found}'"))
    }
}
