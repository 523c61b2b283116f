//! The error of the mean of frames, over time.

use super::error::Measured;

/// Two points that are nearer than this factor in time are one: the plot is logarithmic.
const APART: f64 = 1.05;

/// After so much time of the device, ms, the mean had this relative error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    pub ms: f64,
    pub error: f64,
}

/// The points of the mean that is on screen, earliest first; of single frames none.
#[derive(Clone, Debug, Default)]
pub struct Trail {
    points: Vec<Point>,
    /// Of the frames in the mean, ms.
    total: f64,
    /// Frames in it, and in the mean: the same, unless it came later.
    frames: u32,
    count: u32,
}

impl Trail {
    /// A frame has taken `ms`; `count` frames are in the mean with it (0: no mean). `measured`: what was compared.
    pub fn add(&mut self, count: u32, ms: f64, measured: Option<Measured>) {
        if count <= self.count {
            *self = Trail::default();
        }
        self.count = count;
        if count == 0 {
            return;
        }
        self.total += ms;
        self.frames += 1;
        let Some(Measured { error, .. }) = measured.filter(|measured| measured.count == count) else {
            return;
        };
        let point = Point { ms: self.total, error };
        if self.points.last().is_none_or(|last| point.ms >= APART * last.ms) {
            self.points.push(point);
        }
    }

    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// Has it seen every frame of the mean?
    pub fn is_whole(&self) -> bool {
        self.frames == self.count
    }

    /// Time of all frames in the mean, ms.
    pub fn total(&self) -> f64 {
        self.total
    }
}

/// Exponent of the time in the error from the first point to the last: -0.5 for independent frames.
pub fn slope(points: &[Point]) -> Option<f64> {
    let (first, last) = (points.first()?, points.last()?);
    let slope = (last.error / first.error).ln() / (last.ms / first.ms).ln();
    slope.is_finite().then_some(slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(count: u32, error: f64) -> Option<Measured> {
        Some(Measured { count, error })
    }

    /// Independent frames: the error falls with the root of their number.
    #[test]
    fn the_trail_of_independent_frames_has_slope_minus_one_half() {
        let mut trail = Trail::default();
        for count in 1..=1000 {
            trail.add(count, 2.0, measured(count, 0.3 / f64::from(count).sqrt()));
        }
        let points = trail.points();
        assert_eq!((points[0], trail.total()), (Point { ms: 2.0, error: 0.3 }, 2000.0));
        assert!(points.len() < 150 && points.windows(2).all(|p| p[1].ms >= APART * p[0].ms));
        assert!((slope(points).unwrap() + 0.5).abs() < 1e-6);
    }

    #[test]
    fn a_new_mean_starts_a_new_trail() {
        let mut trail = Trail::default();
        for count in [1, 2, 3] {
            trail.add(count, 1.0, measured(count, 0.1));
        }
        trail.add(1, 1.0, None);
        assert_eq!((trail.points(), trail.total()), (&[][..], 1.0));
        trail.add(2, 1.0, measured(2, 0.1));
        assert_eq!(trail.points(), [Point { ms: 2.0, error: 0.1 }]);
        trail.add(3, 1.0, measured(2, 0.1));
        assert_eq!(trail.points().len(), 1, "an error of another frame is not this one's");
        assert!(trail.is_whole());
        trail.add(5, 1.0, None);
        assert!(!trail.is_whole(), "the fourth frame is missing");
        trail.add(0, 1.0, measured(0, 0.1));
        assert_eq!((trail.points().len(), slope(trail.points())), (0, None));
    }
}
