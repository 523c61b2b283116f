//! The viewer as winit drives it.

use super::Start;
use super::running::Running;
use candela::error::{Error, Result};
use std::time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::event::{StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow};
use winit::window::WindowId;

/// How long to wait before a window that gave no image is asked again.
const RETRY: Duration = Duration::from_millis(50);

/// What the event loop does until the next event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// Frame after frame.
    Draw,
    /// The window had nothing to draw on.
    Retry,
    /// Nothing can be seen: no frames until an event.
    Sleep,
}

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
        let pass = self.running.as_ref().and_then(|running| running.last_pass());
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
        let pace = running.pace();
        event_loop.set_control_flow(control_flow(pace, Instant::now()));
        if pace == Pace::Draw {
            running.redraw();
        }
    }

    fn new_events(&mut self, _: &ActiveEventLoop, cause: StartCause) {
        if let (Some(running), StartCause::ResumeTimeReached { .. }) = (&self.running, cause) {
            running.redraw();
        }
    }
}

fn control_flow(pace: Pace, now: Instant) -> ControlFlow {
    match pace {
        Pace::Draw => ControlFlow::Poll,
        Pace::Retry => ControlFlow::WaitUntil(now + RETRY),
        Pace::Sleep => ControlFlow::Wait,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Only a window that can be drawn on keeps the loop busy.
    #[test]
    fn a_hidden_window_sleeps() {
        let now = Instant::now();
        assert_eq!(control_flow(Pace::Draw, now), ControlFlow::Poll);
        assert_eq!(control_flow(Pace::Retry, now), ControlFlow::WaitUntil(now + RETRY));
        assert_eq!(control_flow(Pace::Sleep, now), ControlFlow::Wait);
    }
}
