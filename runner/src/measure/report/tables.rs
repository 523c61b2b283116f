//! Tables as cells, for pages of either kind.

use super::verdict::{Arm, arms, error_at};
use super::{Group, passes, significant};
use crate::measure::statistics::Interval;
use crate::measure::sweep::Row;

/// The first row is the header.
pub type Table = Vec<Vec<String>>;

/// Times and errors of a series.
pub fn series(rows: &[&Row]) -> Table {
    let stems = passes(rows.iter().copied());
    let mut header = vec!["".to_owned()];
    header.extend(stems.iter().map(|stem| stem.replace('_', " ")));
    let rest = [
        "frame, ms",
        "p95",
        "relMSE",
        "SMAPE",
        "R-MAE",
        "FLIP",
        "energy",
        "lasting",
        "flicker",
        "correlation",
    ];
    header.extend(rest.map(str::to_owned));
    let mut table = vec![header];
    for row in rows {
        let mut cells = vec![row.label.clone()];
        let Some(m) = &row.measured else {
            cells.push(format!("failed: {}", row.error.as_deref().unwrap_or("no reason given")));
            table.push(cells);
            continue;
        };
        let ms = |stem: &String| m.passes.iter().find(|(name, _)| name == stem).map(|(_, t)| time(t.median));
        cells.extend(stems.iter().map(|stem| ms(stem).unwrap_or_default()));
        let e = &m.error;
        cells.extend([time(m.frame.median), time(m.frame.p95)]);
        cells.extend([
            with_error(&e.rel_mse),
            with_error(&e.smape),
            significant(e.r_mae.mean),
            significant(e.flip),
        ]);
        cells.extend([format!("{:.3}", e.energy_ratio.mean), significant(e.lasting_error)]);
        cells.extend([significant(m.stability.flicker), format!("{:.2}", m.stability.temporal_correlation)]);
        table.push(cells);
    }
    table
}

/// What the columns of [`series`] mean.
pub const COLUMNS: &str = "Medians of GPU times, ms, by pass and for the frame (p95: 95 % of the frames take no longer). Errors are of a single \
    frame against the truth; ± is half the 95 % confidence interval over independent runs. energy: total light over the \
    truth's. lasting: √relMSE that no number of runs would average away (bias). flicker: RMS change from frame to frame over the mean. \
    correlation: the share of the noise that survives into the next frame.";

/// ms to each error target, an arm a row.
pub(super) fn equal_time(group: &Group, targets: &[f64]) -> Option<Table> {
    let arms = arms(group, targets);
    if arms.is_empty() {
        return None;
    }
    let mut header = vec!["ms to relMSE".to_owned()];
    header.extend(targets.iter().map(f64::to_string));
    header.push("at the end".into());
    let row = |arm: &Arm| {
        let mut cells = vec![arm.row.label.clone()];
        cells.extend(arm.times.iter().map(|t| t.map_or("not reached".into(), significant)));
        let last = arm.row.measured.as_ref().and_then(|m| m.curve.last());
        cells.push(last.map_or(String::new(), |p| {
            format!("{} after {} ms, {} frames", significant(p.rel_mse.mean), significant(p.ms), p.frames)
        }));
        cells
    };
    Some(std::iter::once(header).chain(arms.iter().map(row)).collect())
}

/// relMSE after parts of the time that all arms have, an arm a row.
pub(super) fn error_after(group: &Group) -> Option<Table> {
    let arms = arms(group, &[]);
    let curves: Vec<_> = arms.iter().filter_map(|arm| arm.row.measured.as_ref().map(|m| &m.curve)).collect();
    let all = curves.iter().filter_map(|c| c.last()).map(|p| p.ms).reduce(f64::min)?;
    let times = [1.0 / 64.0, 1.0 / 16.0, 1.0 / 4.0, 1.0].map(|part| part * all);
    let mut header = vec!["relMSE after ms".to_owned()];
    header.extend(times.map(significant));
    let row = |(arm, curve): (&Arm, &&Vec<_>)| {
        let cells = times.map(|ms| error_at(curve, ms).map_or("no frame yet".into(), significant));
        std::iter::once(arm.row.label.clone()).chain(cells).collect()
    };
    Some(std::iter::once(header).chain(arms.iter().zip(&curves).map(row)).collect())
}

fn time(ms: f64) -> String {
    if ms < 100.0 { format!("{ms:.3}") } else { format!("{ms:.1}") }
}

fn with_error(i: &Interval) -> String {
    let half = 0.5 * (i.high - i.low);
    if half > 0.0 { format!("{} ± {}", significant(i.mean), significant(half)) } else { significant(i.mean) }
}
