//! GPU times of passes over the last frames.

use candela::frame::renderer::StepTimes;
use candela_lab::measure::times::median;
use shared::passes::Pass;
use std::collections::VecDeque;

/// Frames that count.
const WINDOW: usize = 120;

/// Times of each pass, ms, one value a frame; steps with the same stem are summed.
#[derive(Clone, Debug, Default)]
pub struct Timings {
    passes: Vec<(&'static str, VecDeque<f64>)>,
    frames: VecDeque<f64>,
    /// Without what only looks at them.
    rendering: VecDeque<f64>,
}

/// Passes that look at a frame: they are no part of what it costs.
const LOOKS: [Pass; 3] = [Pass::accumulate, Pass::view, Pass::statistics];

/// Time that one frame's steps take without those that look at it, ms.
pub fn rendering(steps: &StepTimes) -> f64 {
    let looks = |stem: &str| LOOKS.iter().any(|pass| pass.stem() == stem);
    steps.iter().filter(|(stem, _)| !looks(stem)).map(|(_, ms)| ms).sum()
}

/// Of one pass over the window, ms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    pub stem: &'static str,
    pub median: f64,
    /// 95 % of the frames took at most this.
    pub p95: f64,
}

impl Timings {
    /// One frame's steps. Passes that it has not are dropped.
    pub fn add(&mut self, steps: &StepTimes) {
        self.passes.retain(|(stem, _)| steps.iter().any(|(name, _)| name == stem));
        for (i, (stem, _)) in steps.iter().enumerate() {
            let first = steps.iter().position(|(name, _)| name == stem) == Some(i);
            if first && !self.passes.iter().any(|(name, _)| name == stem) {
                self.passes.push((stem, VecDeque::new()));
            }
        }
        // Passes in the order of the frame, also those that came later.
        self.passes.sort_by_key(|(stem, _)| steps.iter().position(|(name, _)| name == stem));
        for (stem, times) in &mut self.passes {
            let sum = steps.iter().filter(|(name, _)| name == stem).map(|(_, ms)| ms).sum();
            push(times, sum);
        }
        push(&mut self.frames, steps.iter().map(|(_, ms)| ms).sum());
        push(&mut self.rendering, rendering(steps));
    }

    /// Of each pass, in the order of the frame.
    pub fn passes(&self) -> Vec<Summary> {
        self.passes.iter().map(|(stem, times)| summary(stem, times)).collect()
    }

    /// Of whole frames.
    pub fn frame(&self) -> Option<Summary> {
        (!self.frames.is_empty()).then(|| summary("frame", &self.frames))
    }

    /// Of frames without what only looks at them.
    pub fn rendering(&self) -> Option<Summary> {
        (!self.rendering.is_empty()).then(|| summary("rendering", &self.rendering))
    }
}

fn push(times: &mut VecDeque<f64>, ms: f64) {
    times.push_back(ms);
    if times.len() > WINDOW {
        times.pop_front();
    }
}

fn summary(stem: &'static str, times: &VecDeque<f64>) -> Summary {
    let mut sorted: Vec<f64> = times.iter().copied().collect();
    sorted.sort_by(f64::total_cmp);
    // The smallest value that 95 % do not exceed (nearest rank).
    let rank = (0.95 * sorted.len() as f64).ceil() as usize;
    let p95 = sorted.get(rank.saturating_sub(1)).copied().unwrap_or(0.0);
    Summary { stem, median: median(&sorted), p95 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn median_and_p95_of_known_frames() {
        let mut timings = Timings::default();
        assert_eq!(timings.frame(), None);
        for i in 1..=100 {
            timings.add(&vec![("a", f64::from(i)), ("b", 1.0), ("b", 2.0)]);
        }
        let expected =
            [Summary { stem: "a", median: 50.5, p95: 95.0 }, Summary { stem: "b", median: 3.0, p95: 3.0 }];
        assert_eq!(timings.passes(), expected);
        assert_eq!(timings.frame().map(|f| (f.median, f.p95)), Some((53.5, 98.0)));
    }

    #[test]
    fn old_frames_and_absent_passes_are_forgotten() {
        let mut timings = Timings::default();
        for _ in 0..10 {
            timings.add(&vec![("a", 9.0), ("b", 9.0)]);
        }
        for _ in 0..WINDOW {
            timings.add(&vec![("c", 2.0), ("b", 1.0)]);
        }
        let stems: Vec<_> = timings.passes().iter().map(|s| (s.stem, s.p95)).collect();
        assert_eq!(stems, [("c", 2.0), ("b", 1.0)]);
    }

    #[test]
    fn looks_cost_no_rendering() {
        let mut timings = Timings::default();
        timings.add(&vec![("shade", 2.0), ("accumulate", 8.0), ("view", 1.0), ("tonemap", 1.0)]);
        let medians = [timings.frame(), timings.rendering()].map(|summary| summary.map(|s| s.median));
        assert_eq!(medians, [Some(12.0), Some(3.0)]);
    }
}
