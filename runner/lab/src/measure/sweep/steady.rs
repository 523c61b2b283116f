//! Warm-up before timing: until frame times have stabilized. A device at rest has a slow clock, and the first frames of a
//! pipeline fill caches.

use crate::measure::times::median;
use serde::{Deserialize, Serialize};

/// What to wait for, in ms of the host's clock.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SteadyPlan {
    /// Load before frames are looked at.
    pub ms: f64,
    /// Length of a window, at least [`FRAMES`] frames.
    pub window_ms: f64,
    /// The medians of two consecutive windows differ by no more than this fraction.
    pub within: f64,
    /// Ends the wait whatever the frames do.
    pub max_ms: f64,
}

/// Of the shortest window: the fewest whose median drops one outlier.
const FRAMES: usize = 3;

impl Default for SteadyPlan {
    fn default() -> Self {
        SteadyPlan { ms: 300.0, window_ms: 50.0, within: 0.01, max_ms: 5000.0 }
    }
}

impl SteadyPlan {
    /// The first mistake, in one line.
    pub fn check(&self) -> Result<(), String> {
        let SteadyPlan { ms, window_ms, within, max_ms } = *self;
        let fine = [ms, window_ms, max_ms].iter().all(|x| *x >= 0.0) && within > 0.0;
        if fine {
            Ok(())
        } else {
            Err("steady: ms, window_ms and max_ms are 0 or more, within is above 0".into())
        }
    }
}

/// How a wait ended.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settled {
    /// Frames before the timed run.
    pub frames: u32,
    /// The time they took, by the host's clock.
    pub ms: f64,
    /// False: `max_ms` came first.
    pub steady: bool,
    /// Between the medians of the last two windows, as a fraction; none if there were not two.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub change: Option<f64>,
}

impl Settled {
    /// The worse of two waits in each respect.
    pub fn worst(self, other: Settled) -> Settled {
        Settled {
            frames: self.frames.max(other.frames),
            ms: self.ms.max(other.ms),
            steady: self.steady && other.steady,
            change: self.change.zip(other.change).map(|(a, b)| a.max(b)),
        }
    }
}

/// Looks at the frames of a load until it is steady.
pub struct Watch {
    plan: SteadyPlan,
    window: Vec<f64>,
    /// When the window began.
    began: f64,
    /// Median of the window before.
    last: Option<f64>,
    settled: Settled,
}

impl Watch {
    pub fn new(plan: SteadyPlan) -> Self {
        let settled = Settled { frames: 0, ms: 0.0, steady: false, change: None };
        Watch { plan, window: Vec::new(), began: 0.0, last: None, settled }
    }

    /// One more frame took `frame_ms`; the wait has lasted `elapsed` ms. Gives how it ended, if this was the last frame.
    pub fn add(&mut self, frame_ms: f64, elapsed: f64) -> Option<Settled> {
        self.settled.frames += 1;
        self.settled.ms = elapsed;
        if elapsed < self.plan.ms {
            self.began = elapsed;
        } else {
            self.window.push(frame_ms);
            if self.window.len() >= FRAMES && elapsed - self.began >= self.plan.window_ms {
                self.close(elapsed);
            }
        }
        (self.settled.steady || elapsed >= self.plan.max_ms).then_some(self.settled)
    }

    fn close(&mut self, elapsed: f64) {
        let now = median(&self.window);
        self.settled.change = self.last.map(|last| (now / last - 1.0).abs());
        self.settled.steady = self.settled.change.is_some_and(|change| change <= self.plan.within);
        (self.last, self.began) = (Some(now), elapsed);
        self.window.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Frames one after another, without a pause.
    fn wait(plan: SteadyPlan, frame_ms: impl Fn(u32) -> f64) -> Settled {
        let (mut watch, mut elapsed) = (Watch::new(plan), 0.0);
        for frame in 0.. {
            elapsed += frame_ms(frame);
            if let Some(settled) = watch.add(frame_ms(frame), elapsed) {
                return settled;
            }
        }
        unreachable!()
    }

    const PLAN: SteadyPlan = SteadyPlan { ms: 100.0, window_ms: 20.0, within: 0.01, max_ms: 10_000.0 };

    #[test]
    fn a_steady_load_takes_its_time_and_two_windows() {
        let settled = wait(PLAN, |_| 1.0);
        assert_eq!(settled, Settled { frames: 139, ms: 139.0, steady: true, change: Some(0.0) });
        // Long frames: three a window, whatever the window's length; the load ends with the second frame.
        assert_eq!(wait(PLAN, |_| 50.0).frames, 1 + 6);
    }

    /// A clock that climbs: frames get 0.5 % shorter each, then stay. Within 1 % between windows of about 20 frames only after that.
    #[test]
    fn a_climbing_clock_is_waited_for() {
        let ms = |frame: u32| 2.0 * 0.995f64.powi(frame.min(300) as i32);
        let settled = wait(PLAN, ms);
        assert!(settled.steady && settled.frames > 300, "{settled:?}");
        // The planted fault: with the load alone, timing would start on the way up.
        let eager = wait(SteadyPlan { within: f64::INFINITY, ..PLAN }, ms);
        assert!(eager.frames < 150, "{eager:?}");
    }

    #[test]
    fn restless_frames_end_at_the_bound() {
        let settled = wait(PLAN, |frame| 1.02f64.powi(frame as i32));
        assert!(!settled.steady && settled.ms >= 10_000.0 && settled.change > Some(0.01), "{settled:?}");
        let none = wait(SteadyPlan { max_ms: 0.0, ..PLAN }, |_| 1.0);
        assert_eq!((none.frames, none.steady, none.change), (1, false, None));
    }

    #[test]
    fn the_worst_of_two_waits() {
        let a = Settled { frames: 3, ms: 5.0, steady: true, change: Some(0.002) };
        let b = Settled { frames: 2, ms: 9.0, steady: false, change: Some(0.1) };
        assert_eq!(a.worst(b), Settled { frames: 3, ms: 9.0, steady: false, change: Some(0.1) });
        assert_eq!(a.worst(Settled { change: None, ..b }).change, None);
    }
}
