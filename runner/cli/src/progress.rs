//! Progress on standard error: a bar on a terminal; elsewhere, as in a log, a line now and then.

use candela_lab::measure::sweep::Progress;
use indicatif::{ProgressBar, ProgressStyle};
use std::time::Duration;

/// A bar of `length` steps, which nobody sees but on a terminal.
pub fn bar(length: u64, what: &'static str) -> ProgressBar {
    let style = ProgressStyle::with_template("{msg} [{bar:40}] {pos}/{len} {elapsed_precise}, {eta} left")
        .unwrap_or_else(|_| ProgressStyle::default_bar())
        .progress_chars("=> ");
    ProgressBar::new(length).with_style(style).with_message(what)
}

/// The bar of a sweep: lines go to standard output, above it.
pub struct Sweeping(pub ProgressBar);

impl Progress for Sweeping {
    fn advance(&self, frames: u64) {
        self.0.inc(frames);
    }

    fn tick(&self) {
        self.0.tick();
    }

    fn enter(&self, stage: &'static str) {
        self.0.set_message(stage);
    }

    fn say(&self, line: &str) {
        self.0.suspend(|| println!("{line}"));
    }
}

/// A bar, or lines in its place.
pub struct Steps {
    bar: ProgressBar,
    next_line: Duration,
}

impl Steps {
    pub fn new(length: u64, what: &'static str) -> Self {
        Self { bar: bar(length, what), next_line: FIRST_LINE }
    }

    /// One step is done.
    pub fn step(&mut self) {
        self.bar.inc(1);
        let (bar, elapsed) = (&self.bar, self.bar.elapsed());
        if bar.is_hidden() && elapsed >= self.next_line {
            let (done, all, seconds) = (bar.position(), bar.length().unwrap_or(0), elapsed.as_secs());
            eprintln!("{}: {done} of {all} after {seconds} s", bar.message());
            self.next_line = line_after(elapsed);
        }
    }

    pub fn end(&self) {
        self.bar.finish_and_clear();
    }
}

const FIRST_LINE: Duration = Duration::from_secs(10);

/// When the line after one at `elapsed` is due: ever more rarely, but every five minutes.
fn line_after(elapsed: Duration) -> Duration {
    elapsed + elapsed.min(Duration::from_secs(300))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_few() {
        let lines = std::iter::successors(Some(FIRST_LINE), |&t| Some(line_after(t)));
        let of_an_hour: Vec<u64> = lines.map(|t| t.as_secs()).take_while(|&t| t <= 3600).collect();
        assert_eq!(of_an_hour[..7], [10, 20, 40, 80, 160, 320, 620]);
        assert_eq!(of_an_hour.len(), 16);
    }
}
