//! GPU times of passes over many frames.

use super::statistics::Times;
use candela::frame::renderer::StepTimes;

/// Times of each pass, one value a frame; steps with the same stem are summed.
#[derive(Clone, Debug, Default)]
pub struct PassTimes {
    passes: Vec<(&'static str, Vec<f64>)>,
    frames: Vec<f64>,
}

impl PassTimes {
    /// One frame's steps, in ms; nothing where the device has no clock.
    pub fn add(&mut self, steps: Option<StepTimes>) {
        let Some(steps) = steps else { return };
        let frame = self.frames.len();
        self.frames.push(steps.iter().map(|(_, ms)| ms).sum());
        for (stem, ms) in steps {
            let at = self.passes.iter().position(|(name, _)| *name == stem).unwrap_or_else(|| {
                self.passes.push((stem, vec![0.0; frame]));
                self.passes.len() - 1
            });
            let times = &mut self.passes[at].1;
            times.resize(frame + 1, 0.0);
            times[frame] += ms;
        }
    }

    /// (pass, median ms) in frame order.
    pub fn medians(&self) -> Vec<(&'static str, f64)> {
        self.passes.iter().map(|(stem, times)| (*stem, median(times))).collect()
    }

    /// (pass, times) in frame order.
    pub fn passes(&self) -> Vec<(&'static str, Times)> {
        self.passes.iter().map(|(stem, times)| (*stem, Times::of(times))).collect()
    }

    /// Times of whole frames.
    pub fn frames(&self) -> Times {
        Times::of(&self.frames)
    }

    /// Median ms of whole frames.
    pub fn frame_median(&self) -> f64 {
        median(&self.frames)
    }

    /// One line: each pass and the frame, medians in ms.
    pub fn summary(&self) -> String {
        if self.frames.is_empty() {
            return "ms a frame: this device has no clock".into();
        }
        let passes: Vec<_> = self.medians().iter().map(|(stem, ms)| format!("{stem} {ms:.3}")).collect();
        format!("ms a frame (median): {} = {:.3}", passes.join(" + "), self.frame_median())
    }
}

/// The middle value, or the mean of the two; 0 of none.
pub fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    match sorted.len() {
        0 => 0.0,
        n if n % 2 == 1 => sorted[n / 2],
        n => 0.5 * (sorted[n / 2 - 1] + sorted[n / 2]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repeated_steps_are_one_pass() {
        let mut times = PassTimes::default();
        times.add(Some(vec![("a", 1.0), ("b", 2.0), ("b", 3.0)]));
        times.add(Some(vec![("a", 3.0), ("b", 1.0), ("b", 1.0)]));
        times.add(Some(vec![("a", 2.0), ("b", 9.0), ("b", 0.0)]));
        assert_eq!(times.medians(), [("a", 2.0), ("b", 5.0)]);
        assert_eq!(times.frame_median(), 6.0);
        assert!(PassTimes::default().summary().contains("no clock"));
    }

    #[test]
    fn medians() {
        assert_eq!(
            (median(&[]), median(&[4.0]), median(&[4.0, 1.0]), median(&[3.0, 1.0, 2.0])),
            (0.0, 4.0, 2.5, 2.0)
        );
    }
}
