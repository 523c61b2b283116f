//! Values read back from frames in flight, one or two frames late.

use super::error::Measured;
use super::probe::Probe;
use super::state::State;
use super::timings::{Timings, rendering};
use super::trail::Trail;
use candela::frame::renderer::StepTimes;

/// What one frame has left to read.
pub struct Readback {
    /// Of the left side; none: the device has no clock.
    pub times: Option<StepTimes>,
    /// Of the picked pixel.
    pub probe: Option<Probe>,
    pub error: Option<Measured>,
    /// Frames in the mean with this one; 0: no mean.
    pub count: u32,
}

#[derive(Default)]
pub struct Readings {
    pub timings: Timings,
    pub trail: Trail,
    pub probe: Option<Probe>,
    pub error: Option<Measured>,
}

impl Readings {
    /// One more frame; `state` learns where the picked pixel's surface is.
    pub fn take(&mut self, readback: Readback, state: &mut State) {
        if let Some(times) = &readback.times {
            self.timings.add(times);
            self.trail.add(readback.count, rendering(times), readback.error);
        }
        self.probe = readback.probe.filter(|found| Some(found.pixel) == state.picked);
        state.found(self.probe.as_ref().and_then(Probe::position));
        self.error = readback.error;
    }

    /// Another scene: its own times.
    pub fn clear(&mut self) {
        *self = Readings::default();
    }
}
