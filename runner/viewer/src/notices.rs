//! Short messages over the picture: errors stay until they are closed, the rest goes by itself.

use candela::error::Error;
use std::time::{Duration, Instant};

/// How long a message stays.
const STAY: Duration = Duration::from_secs(8);
/// More than this many lines hide the picture.
const MOST: usize = 8;

#[derive(Default)]
pub struct Notices(Vec<Notice>);

pub struct Notice {
    pub text: String,
    pub is_error: bool,
    since: Instant,
}

impl Notices {
    pub fn say(&mut self, text: String) {
        self.add(text, false);
    }

    /// An error that the viewer survives.
    pub fn fail(&mut self, error: Error) {
        eprintln!("error: {error}");
        self.add(error.to_string(), true);
    }

    fn add(&mut self, text: String, is_error: bool) {
        if self.0.len() == MOST {
            self.0.remove(0);
        }
        self.0.push(Notice { text, is_error, since: Instant::now() });
    }

    /// What is to be seen now.
    pub fn current(&mut self) -> &[Notice] {
        self.0.retain(|notice| notice.is_error || notice.since.elapsed() < STAY);
        &self.0
    }

    pub fn close(&mut self, index: usize) {
        if index < self.0.len() {
            self.0.remove(index);
        }
    }

    pub fn last_error(&self) -> Option<&str> {
        self.0.iter().rev().find(|notice| notice.is_error).map(|notice| notice.text.as_str())
    }
}
