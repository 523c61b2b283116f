//! Explanation of a pixel in a thread, which owns the frames meanwhile: the picture stands still.

use super::frames::{Frames, Question};
use candela::error::{Error, Result};
use glam::UVec2;
use std::sync::mpsc::channel;
use std::thread::JoinHandle;
use std::time::Instant;

/// What the panel shows of the pixel that was explained last.
pub struct Answer {
    pub pixel: UVec2,
    /// As `candela explain` prints it, or why there is none; line by line.
    pub lines: Vec<String>,
}

impl Answer {
    pub fn new(pixel: UVec2, text: &str) -> Answer {
        Answer { pixel, lines: text.lines().map(str::to_owned).collect() }
    }

    pub fn text(&self) -> String {
        self.lines.join("\n")
    }
}

/// The frames come back with what was found.
type Found = (Frames, Result<String>);

pub struct Explaining {
    thread: Option<JoinHandle<Option<Found>>>,
    pixel: UVec2,
    since: Instant,
}

impl Explaining {
    /// Nothing of `frames` may be in flight. Without a thread they come back at once.
    pub fn start(frames: Frames, question: Question) -> Result<Explaining, Box<(Frames, Error)>> {
        let pixel = question.pixel;
        let (give, take) = channel::<Frames>();
        let work = move || {
            let mut frames = take.recv().ok()?;
            let answer = frames.explain(&question);
            Some((frames, answer))
        };
        match std::thread::Builder::new().name("explain".into()).spawn(work) {
            Ok(thread) => {
                let _ = give.send(frames);
                Ok(Explaining { thread: Some(thread), pixel, since: Instant::now() })
            }
            Err(source) => {
                let error = Error::NoThread { to: "explain a pixel", source };
                Err(Box::new((frames, error)))
            }
        }
    }

    pub fn pixel(&self) -> UVec2 {
        self.pixel
    }

    pub fn seconds(&self) -> f32 {
        self.since.elapsed().as_secs_f32()
    }

    pub fn is_done(&self) -> bool {
        self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }

    /// The frames and the answer, waited for. Errors: the thread has died, and the frames with it.
    pub fn finish(mut self) -> Result<Found> {
        let died = || Error::Internal("explaining the pixel failed unexpectedly".into());
        self.thread.take().and_then(|thread| thread.join().ok().flatten()).ok_or_else(died)
    }
}

impl Drop for Explaining {
    /// The device must not go while the thread uses it.
    fn drop(&mut self) {
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}
