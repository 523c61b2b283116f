//! Actions of the user beyond the state: load, save, close.

use super::{Running, SceneFacts, title};
use crate::explaining::{Answer, Explaining};
use crate::frames::{First, Frames};
use crate::loader::Progress;
use crate::screen::FRAMES;
use crate::source::Source;
use crate::state::Action;
use candela::error::{Error, Result};
use std::path::Path;
use winit::event_loop::ActiveEventLoop;

impl Running {
    pub(super) fn act(&mut self, event_loop: &ActiveEventLoop, action: Action) -> Result<()> {
        match action {
            Action::Quit => event_loop.exit(),
            Action::Load(path) => {
                let started = self.source.with_file(&path).and_then(|source| self.load(source));
                started.unwrap_or_else(|error| self.notices.fail(error));
            }
            Action::Expose => {
                self.ring.wait()?;
                self.frames.as_mut().map_or(Ok(()), |frames| frames.expose(&self.state))?;
            }
            Action::NextPresentMode => self.screen.next_mode()?,
            Action::CopyCamera => {
                let (camera, time) = (self.state.rig.argument(), self.state.timeline.time());
                let time = time.map_or(String::new(), |time| format!(" --time {time:.4}"));
                let line = format!("candela {} --camera={camera}{time}", self.source.arguments());
                println!("{line}");
                self.notices.say(format!("copied: {line}"));
                self.copy(line);
            }
            Action::CopyExplanation => {
                if let Some(text) = self.answer.as_ref().map(Answer::text) {
                    self.copy(text);
                    self.notices.say("copied: the explanation".into());
                }
            }
            Action::Explain => self.asked = true,
            Action::Screenshot => match self.screenshot(Path::new(".")) {
                Ok(name) => self.notices.say(format!("saved {name}.png, .exr and .json")),
                Err(error @ Error::DeviceLost(_)) => return Err(error),
                Err(error) => self.notices.fail(error),
            },
        }
        Ok(())
    }

    fn copy(&mut self, text: String) {
        if let Some(gui) = self.screen.gui() {
            gui.window_state.set_clipboard_text(text);
        }
    }

    /// The picture as it is shown, its radiance and its settings; the files' common name.
    pub(super) fn screenshot(&mut self, directory: &Path) -> Result<String> {
        self.ring.wait()?;
        match &self.frames {
            Some(frames) => crate::screenshot::save(directory, frames, &self.state),
            None => Err(Error::Usage("no screenshot while a pixel is being explained".into())),
        }
    }

    /// Reads, uploads and first renders `source` in a thread, with a command pool of its own; only submissions take turns.
    fn load(&mut self, source: Source) -> Result<()> {
        let (device, planted) = (self.device.clone(), self.planted.take());
        let (size, settings) = (self.state.size, self.state.settings[0].clone());
        let same = source.scene == self.source.scene;
        let here = same.then(|| (self.state.rig.camera(), self.state.timeline.time()));
        let work = move |source: &Source, progress: &Progress| {
            progress.enter("reading")?;
            let scene = source.load()?;
            let start = || (scene.cameras.first().cloned().unwrap_or_else(|| scene.camera_fitted()), None);
            let (camera, time) = here.unwrap_or_else(start);
            let first = First { size, camera, settings, time };
            let mut planted = planted;
            let mut stage = |stage| {
                progress.enter(stage)?;
                match planted.take_if(|_| stage == "acceleration structures") {
                    Some(error) => Err(error),
                    None => Ok(()),
                }
            };
            Frames::new(&device, scene, FRAMES, &first, &mut stage)
        };
        self.loader.start(source, work)
    }

    /// A scene that is whole takes the place of the old one; a failure leaves everything as it was.
    pub(super) fn take_loaded(&mut self) -> Result<()> {
        // The old one has to come back first.
        if self.explaining.is_some() {
            return Ok(());
        }
        let Some((source, result)) = self.loader.poll() else { return Ok(()) };
        let frames = match result {
            Ok(frames) => frames,
            // Nothing renders any more.
            Err(error @ Error::DeviceLost(_)) => return Err(error),
            Err(error) => {
                self.notices.fail(error);
                return Ok(());
            }
        };
        self.ring.wait()?;
        let scene = frames.scene();
        // Under another sky everything stays where it is.
        if source.scene != self.source.scene {
            self.state.enter(scene);
        }
        self.window.set_title(&title(&scene.name));
        scene.warnings.iter().for_each(|warning| self.notices.say(warning.clone()));
        self.scene = SceneFacts::new(scene, frames.light_count());
        (self.frames, self.source, self.answer) = (Some(frames), source, None);
        self.readings.clear();
        Ok(())
    }

    /// Lends the frames to a thread that explains the picked pixel, if that was asked for.
    pub(super) fn ask(&mut self) -> Result<()> {
        if !std::mem::take(&mut self.asked) {
            return Ok(());
        }
        let Some(mut frames) = self.frames.take() else { return Ok(()) };
        self.ring.wait()?;
        // The window uses the slots meanwhile: they would be read in another order.
        for readback in frames.read_all()? {
            self.readings.take(readback, &mut self.state);
        }
        let started = match frames.question(&self.state) {
            Ok(question) => Explaining::start(frames, question),
            Err(error) => Err(Box::new((frames, error))),
        };
        match started {
            Ok(explaining) => self.explaining = Some(explaining),
            Err(back) => {
                let (frames, error) = *back;
                self.frames = Some(frames);
                let pixel = self.state.picked.unwrap_or_default();
                self.answer = Some(Answer::new(pixel, &error.to_string()));
            }
        }
        Ok(())
    }

    /// The frames come back with the answer.
    pub(super) fn take_explained(&mut self) -> Result<()> {
        let Some(explaining) = self.explaining.take_if(|explaining| explaining.is_done()) else {
            return Ok(());
        };
        let pixel = explaining.pixel();
        let (frames, answer) = explaining.finish()?;
        self.frames = Some(frames);
        let text = match answer {
            Ok(text) => text,
            Err(error @ Error::DeviceLost(_)) => return Err(error),
            Err(error) => error.to_string(),
        };
        self.answer = Some(Answer::new(pixel, &text));
        Ok(())
    }
}
