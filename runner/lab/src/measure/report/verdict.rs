//! Whether reuse pays: the time of each arm to an error, compared with arms without reuse.

use super::{Group, significant};
use crate::measure::sweep::point::CurvePoint;
use crate::measure::sweep::{Results, Row};

/// ms after which the error of the mean is `target` or less: between checkpoints along a straight line in logarithms; none
/// where the curve ends above it. An error that comes back above the target later on still counts as reached.
pub fn time_to(curve: &[CurvePoint], target: f64) -> Option<f64> {
    let at = curve.iter().position(|p| p.rel_mse.mean <= target)?;
    let here = &curve[at];
    let Some(before) = at.checked_sub(1).map(|i| &curve[i]) else { return Some(here.ms) };
    let (e0, e1) = (before.rel_mse.mean.ln(), here.rel_mse.mean.max(f64::MIN_POSITIVE).ln());
    let t = (e0 - target.ln()) / (e0 - e1);
    Some((before.ms.ln() + t * (here.ms / before.ms).ln()).exp())
}

/// relMSE of the mean of what is done after `ms`, along the same lines; none before the first frame ends and after the last.
pub fn error_at(curve: &[CurvePoint], ms: f64) -> Option<f64> {
    let at = curve.iter().position(|p| p.ms >= ms)?;
    let here = &curve[at];
    if here.ms == ms {
        return Some(here.rel_mse.mean);
    }
    let before = &curve[at.checked_sub(1)?];
    let t = (ms / before.ms).ln() / (here.ms / before.ms).ln();
    Some(before.rel_mse.mean * (here.rel_mse.mean / before.rel_mse.mean.max(f64::MIN_POSITIVE)).powf(t))
}

/// One arm's way to each target.
pub(super) struct Arm<'a> {
    pub row: &'a Row,
    pub times: Vec<Option<f64>>,
}

/// Arms with curves, in their order.
pub(super) fn arms<'a>(group: &Group<'a>, targets: &[f64]) -> Vec<Arm<'a>> {
    let arm = |row: &'a Row| {
        let curve = &row.measured.as_ref()?.judged.as_ref()?.curve;
        let times = targets.iter().map(|&t| time_to(curve, t)).collect();
        (!curve.is_empty()).then_some(Arm { row, times })
    };
    group.rows.iter().filter_map(|&row| arm(row)).collect()
}

/// One sentence a target: the fastest arm that reuses, against the fastest that does not.
pub(super) fn sentences(results: &Results, group: &Group) -> Vec<String> {
    let Some(accumulate) = &results.plan.accumulate else { return Vec::new() };
    let arms = arms(group, &accumulate.targets);
    let judges =
        |arm: &Arm| arm.row.measured.as_ref().is_some_and(|m| !m.settings.temporal && !m.settings.spatial);
    if arms.iter().all(judges) || !arms.iter().any(judges) {
        return Vec::new();
    }
    let sentence = |(i, target): (usize, &f64)| {
        let fastest = |judging: bool| {
            let reached = arms.iter().filter(|arm| judges(arm) == judging);
            let timed = reached.filter_map(|arm| Some((arm.row.label.as_str(), arm.times[i]?)));
            timed.min_by(|a, b| a.1.total_cmp(&b.1))
        };
        let error = format!("relMSE {target}");
        match (fastest(false), fastest(true)) {
            (Some((arm, a)), Some((judge, b))) => {
                let verdict = if a < b {
                    format!("reuse pays, {} times as fast", significant(b / a))
                } else {
                    format!("reuse does not pay, {} times as slow", significant(a / b))
                };
                format!("{error}: {verdict} ({arm} {} ms, {judge} {} ms).", significant(a), significant(b))
            }
            (Some((arm, a)), None) => {
                format!("{error}: reuse pays, only {arm} gets there, after {} ms.", significant(a))
            }
            (None, Some((judge, b))) => {
                format!("{error}: reuse does not pay, only {judge} gets there, after {} ms.", significant(b))
            }
            (None, None) => format!("{error}: no arm gets there in the time given."),
        }
    };
    accumulate.targets.iter().enumerate().map(sentence).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::statistics::Interval;

    fn curve(points: &[(f64, f64)]) -> Vec<CurvePoint> {
        let point = |&(ms, error): &(f64, f64)| CurvePoint {
            ms,
            rel_mse: Interval { mean: error, low: error, high: error },
            ..CurvePoint::default()
        };
        points.iter().map(point).collect()
    }

    /// Error 1/t: the time to an error is its inverse, also between checkpoints.
    #[test]
    fn times_lie_on_the_line_between_checkpoints() {
        let curve = curve(&[(1.0, 1.0), (2.0, 0.5), (8.0, 0.125)]);
        for target in [0.9, 0.5, 0.2, 0.125] {
            let t = time_to(&curve, target).unwrap();
            assert!((t - 1.0 / target).abs() < 1e-9, "{target}: {t}");
        }
        for ms in [1.0, 1.5, 4.0, 8.0] {
            assert!((error_at(&curve, ms).unwrap() - 1.0 / ms).abs() < 1e-9);
        }
        assert_eq!((error_at(&curve, 0.9), error_at(&curve, 8.1)), (None, None));
        assert_eq!(time_to(&curve, 3.0), Some(1.0));
        assert_eq!(time_to(&curve, 0.1), None);
        assert_eq!(time_to(&[], 1.0), None);
    }
}
