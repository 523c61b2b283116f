//! Progress bars that keep quiet where nobody watches.

use crate::measure::sweep::Progress;
use indicatif::{ProgressBar, ProgressStyle};

/// A bar of `length` steps on standard error.
pub fn bar(length: u64, what: &'static str) -> ProgressBar {
    let style = ProgressStyle::with_template("{msg} [{bar:40}] {pos}/{len} {elapsed_precise}, {eta} left")
        .unwrap_or_else(|_| ProgressStyle::default_bar())
        .progress_chars("=> ");
    ProgressBar::new(length).with_style(style).with_message(what)
}

/// Lines go to standard output, above the bar.
impl Progress for ProgressBar {
    fn advance(&self, frames: u64) {
        self.inc(frames);
    }

    fn tick(&self) {
        ProgressBar::tick(self);
    }

    fn enter(&self, stage: &'static str) {
        self.set_message(stage);
    }

    fn say(&self, line: &str) {
        self.suspend(|| println!("{line}"));
    }
}
