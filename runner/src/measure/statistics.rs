//! Means with confidence, and times in a few numbers.

use super::times::median;
use serde::{Deserialize, Serialize};

/// A mean over independent runs and its 95 % confidence interval (Student's t).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    pub mean: f64,
    /// Equal to the mean for a single run.
    pub low: f64,
    pub high: f64,
}

impl Interval {
    pub fn of(values: &[f64]) -> Self {
        let n = values.len();
        let mean = values.iter().sum::<f64>() / n.max(1) as f64;
        if n < 2 {
            return Interval { mean, low: mean, high: mean };
        }
        let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1) as f64;
        let half = student_t(n - 1) * (variance / n as f64).sqrt();
        Interval { mean, low: mean - half, high: mean + half }
    }
}

/// 97.5 % quantile of Student's t; for more than 30 degrees of freedom from the expansion of Cornish and Fisher (1938).
fn student_t(degrees: usize) -> f64 {
    const TABLE: [f64; 30] = [
        12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201, 2.179, 2.160, 2.145,
        2.131, 2.120, 2.110, 2.101, 2.093, 2.086, 2.080, 2.074, 2.069, 2.064, 2.060, 2.056, 2.052, 2.048,
        2.045, 2.042,
    ];
    let z = 1.959_964_f64;
    TABLE.get(degrees.saturating_sub(1)).copied().unwrap_or(z + (z.powi(3) + z) / (4.0 * degrees as f64))
}

/// Times in ms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Times {
    pub median: f64,
    /// 95 % of the frames take no longer.
    pub p95: f64,
    /// Between the first and the third quartile.
    pub spread: f64,
}

impl Times {
    pub fn of(values: &[f64]) -> Self {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        // The smallest value that this fraction of all does not exceed.
        let quantile = |q: f64| {
            let rank = (q * sorted.len() as f64).ceil() as usize;
            sorted.get(rank.max(1) - 1).copied().unwrap_or_default()
        };
        Times { median: median(values), p95: quantile(0.95), spread: quantile(0.75) - quantile(0.25) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values 1, 2, 3: mean 2, variance 1, t of 2 degrees 4.303.
    #[test]
    fn interval_by_hand() {
        let i = Interval::of(&[1.0, 2.0, 3.0]);
        let half = 4.303 / 3f64.sqrt();
        assert!(
            (i.mean - 2.0).abs() < 1e-12
                && (i.high - 2.0 - half).abs() < 1e-9
                && (2.0 - i.low - half).abs() < 1e-9
        );
        assert_eq!(Interval::of(&[5.0]), Interval { mean: 5.0, low: 5.0, high: 5.0 });
    }

    #[test]
    fn student_t_goes_to_the_normal() {
        // Tables: 2.021 at 40, 1.984 at 100.
        assert!((student_t(40) - 2.021).abs() < 2e-3 && (student_t(100) - 1.984).abs() < 1e-3);
        assert!(student_t(31) < student_t(30));
    }

    #[test]
    fn times_by_hand() {
        let values: Vec<f64> = (1..=20).map(f64::from).collect();
        assert_eq!(Times::of(&values), Times { median: 10.5, p95: 19.0, spread: 10.0 });
        assert_eq!(Times::of(&[]), Times::default());
    }
}
