//! The time of a scene that moves.

use candela::knobs::Step;

/// What one step goes, s: a picture of a film.
const STEP: f64 = 1.0 / 24.0;
/// The longest time between two frames that counts, s: what was hidden for a minute goes on where it was.
const LONGEST: f64 = 1.0;

/// Plays from 0 to `duration`, again and again.
#[derive(Clone, Debug, PartialEq)]
pub struct Timeline {
    /// Of the scene's animations, s; 0 where nothing moves.
    duration: f64,
    /// s; none: at rest, as the file has it without its animations.
    time: Option<f64>,
    pub playing: bool,
    /// Seconds of the scene a second.
    pub speed: f64,
}

impl Timeline {
    pub fn new(duration: f64, time: Option<f64>) -> Timeline {
        Timeline { duration, time, playing: false, speed: 1.0 }
    }

    /// s; 0 where nothing moves.
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// Where things stand, s; none: at rest.
    pub fn time(&self) -> Option<f64> {
        self.time
    }

    pub fn seek(&mut self, time: f64) {
        if self.duration > 0.0 {
            self.time = Some(time.clamp(0.0, self.duration));
        }
    }

    pub fn play_or_pause(&mut self) {
        self.playing = !self.playing && self.duration > 0.0;
    }

    /// A picture on or back, and no further by itself.
    pub fn step(&mut self, step: Step) {
        self.playing = false;
        self.go(if step == Step::Up { STEP } else { -STEP });
    }

    /// Lets `seconds` pass.
    pub fn advance(&mut self, seconds: f64) {
        if self.playing {
            self.go(seconds.clamp(0.0, LONGEST) * self.speed);
        }
    }

    fn go(&mut self, seconds: f64) {
        if self.duration > 0.0 {
            self.time = Some((self.time.unwrap_or(0.0) + seconds).rem_euclid(self.duration));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_plays_around_and_around_at_its_speed() {
        let mut timeline = Timeline::new(2.0, None);
        timeline.advance(0.5);
        assert_eq!(timeline.time(), None, "at rest until it is played");
        timeline.play_or_pause();
        timeline.speed = 2.0;
        for expected in [1.0, 0.0, 1.0] {
            timeline.advance(0.5);
            assert_eq!(timeline.time(), Some(expected));
        }
        timeline.advance(60.0);
        assert_eq!(timeline.time(), Some(1.0), "a long absence counts as a second");
        timeline.play_or_pause();
        timeline.advance(0.5);
        assert_eq!(timeline.time(), Some(1.0));
    }

    #[test]
    fn it_is_stepped_and_sought() {
        let mut timeline = Timeline::new(1.0, Some(0.5));
        timeline.play_or_pause();
        timeline.step(Step::Up);
        assert!(!timeline.playing && timeline.time() == Some(0.5 + STEP));
        timeline.seek(0.0);
        timeline.step(Step::Down);
        assert_eq!(timeline.time(), Some(1.0 - STEP));
        timeline.seek(7.0);
        assert_eq!(timeline.time(), Some(1.0));
    }

    #[test]
    fn what_stands_still_has_no_time() {
        let mut timeline = Timeline::new(0.0, None);
        timeline.play_or_pause();
        timeline.advance(1.0);
        timeline.step(Step::Up);
        timeline.seek(1.0);
        assert_eq!((timeline.time(), timeline.playing), (None, false));
    }
}
