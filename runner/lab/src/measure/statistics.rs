//! Means with confidence, and times in a few numbers.

use super::times::median;
use serde::{Deserialize, Serialize};
use statrs::distribution::{ContinuousCDF, StudentsT};

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
        let t = StudentsT::new(0.0, 1.0, (n - 1) as f64).map_or(f64::NAN, |t| t.inverse_cdf(0.975));
        let half = t * (variance / n as f64).sqrt();
        Interval { mean, low: mean - half, high: mean + half }
    }
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

    /// Values 1, 2, 3: mean 2, variance 1, t of 2 degrees 4.302653.
    #[test]
    fn interval_by_hand() {
        let i = Interval::of(&[1.0, 2.0, 3.0]);
        let half = 4.302_652_73 / 3f64.sqrt();
        assert!(
            (i.mean - 2.0).abs() < 1e-12
                && (i.high - 2.0 - half).abs() < 1e-6
                && (2.0 - i.low - half).abs() < 1e-6
        );
        assert_eq!(Interval::of(&[5.0]), Interval { mean: 5.0, low: 5.0, high: 5.0 });
    }

    #[test]
    fn times_by_hand() {
        let values: Vec<f64> = (1..=20).map(f64::from).collect();
        assert_eq!(Times::of(&values), Times { median: 10.5, p95: 19.0, spread: 10.0 });
        assert_eq!(Times::of(&[]), Times::default());
    }
}
