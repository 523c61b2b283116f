//! Tables as cells, for pages of either kind.

use super::verdict::{Arm, arms, error_at};
use super::{Group, passes, significant};
use crate::measure::statistics::Interval;
use crate::measure::sweep::Row;
use crate::measure::sweep::film::JudgedPicture;
use crate::measure::sweep::point::{Judged, Measurement};
use shared::passes::Pass;

/// The first row is the header.
pub type Table = Vec<Vec<String>>;

/// Times and errors of a series.
pub fn series(rows: &[&Row]) -> Table {
    let stems = passes(rows.iter().copied());
    let judged = rows.iter().any(|row| row.measured.as_ref().is_some_and(|m| m.judged.is_some()));
    let mut header = vec!["".to_owned()];
    header.extend(stems.iter().map(|stem| stem.replace('_', " ")));
    header.extend(["frame, ms", "p95"].map(str::to_owned));
    if judged {
        header.extend(ERRORS.map(str::to_owned));
    }
    let mut table = vec![header];
    for row in rows {
        let mut cells = vec![row.label.clone()];
        let Some(m) = &row.measured else {
            cells.push(format!("failed: {}", row.error.as_deref().unwrap_or("no reason given")));
            table.push(cells);
            continue;
        };
        cells.extend(stems.iter().map(|stem| pass_ms(m, stem).map_or(String::new(), time)));
        cells.extend([time(m.frame.median), time(m.frame.p95)]);
        cells.extend(m.judged.iter().flat_map(error_cells));
        table.push(cells);
    }
    without_empty_columns(table)
}

/// Without columns that have a header alone: a pass or a number that older results don't have.
fn without_empty_columns(mut table: Table) -> Table {
    for column in (1..table[0].len()).rev() {
        if table[1..].iter().all(|row| row.get(column).is_none_or(String::is_empty)) {
            table.iter_mut().filter(|row| column < row.len()).for_each(|row| drop(row.remove(column)));
        }
    }
    table
}

const ERRORS: [&str; 9] =
    ["relMSE", "SMAPE", "chroma", "R-MAE", "FLIP", "energy", "lasting", "flicker", "correlation"];

fn error_cells(judged: &Judged) -> [String; 9] {
    let (e, stability) = (&judged.error, &judged.stability);
    [
        with_error(&e.rel_mse),
        with_error(&e.smape),
        e.chroma.map_or(String::new(), |chroma| significant(chroma.mean)),
        significant(e.r_mae.mean),
        significant(e.flip),
        format!("{:.3}", e.energy_ratio.mean),
        significant(e.lasting_error),
        significant(stability.flicker),
        format!("{:.2}", stability.temporal_correlation),
    ]
}

fn pass_ms(m: &Measurement, stem: &str) -> Option<f64> {
    m.passes.iter().find(|(name, _)| name == stem).map(|(_, t)| t.median)
}

/// `temporal` of `temporal_traced`: variants of a pass, of which a frame has one.
fn family(stem: &str) -> &str {
    stem.split('_').next().unwrap_or(stem)
}

fn family_ms(m: &Measurement, name: &str) -> Option<f64> {
    m.passes.iter().find(|(stem, _)| family(stem) == name).map(|(_, t)| t.median)
}

/// All points in one table: what is changed of the first one's command, the passes, the frame, and the frame over the first.
pub fn bench(rows: &[Row]) -> Table {
    let mut families: Vec<&str> = Vec::new();
    for pass in Pass::ALL.iter().map(|pass| family(pass.stem())) {
        let used = rows.iter().any(|r| r.measured.as_ref().is_some_and(|m| family_ms(m, pass).is_some()));
        if used && !families.contains(&pass) {
            families.push(pass);
        }
    }
    let mut header = vec!["".to_owned(), "change".into()];
    header.extend(families.iter().map(|&name| name.to_owned()));
    header.extend(["frame, ms", "spread", "over the first"].map(str::to_owned));
    let mut table = vec![header];
    let first = rows.first().and_then(|row| Some((row, row.measured.as_ref()?)));
    for row in rows {
        let mut cells = vec![row.label.clone()];
        let Some(m) = &row.measured else {
            cells.push(format!("failed: {}", row.error.as_deref().unwrap_or("no reason given")));
            table.push(cells);
            continue;
        };
        let lights =
            first.filter(|(r, _)| r.lights != row.lights).map(|_| format!("--lights {}", row.lights));
        let change = first.map(|(_, f)| m.settings.options(&f.settings)).unwrap_or_default();
        cells.push(lights.into_iter().chain(change).collect::<Vec<_>>().join(" "));
        cells.extend(families.iter().map(|name| family_ms(m, name).map_or(String::new(), time)));
        let unsteady = if m.settled.is_some_and(|s| !s.steady) { " (not steady)" } else { "" };
        cells.extend([time(m.frame.median) + unsteady, time(m.frame.spread)]);
        cells.push(first.map_or(String::new(), |(_, f)| format!("{:.3}", m.frame.median / f.frame.median)));
        table.push(cells);
    }
    table
}

/// Films of a series.
pub fn films(rows: &[&Row]) -> Option<Table> {
    let row = |row: &&Row| {
        let m = row.measured.as_ref()?;
        let film = m.film.as_ref()?;
        let mut cells = vec![row.label.clone(), time(film.rest_frame.median), time(m.frame.median)];
        cells.push(format!("{:.2}", m.frame.median / film.rest_frame.median));
        let numbers: [fn(&JudgedPicture) -> f64; 3] =
            [|p| p.smape.mean, |p| p.rel_mse.mean, |p| p.chroma.mean];
        for number in numbers {
            let (rest, moving) = (film.at_rest().map_or(0.0, number), film.in_motion(number));
            cells.extend([significant(rest), significant(moving), format!("{:.2}", moving / rest)]);
        }
        cells.push(significant(film.in_motion(|p| p.flip)));
        cells.push(format!("{:.3}", film.in_motion(|p| p.energy_ratio.mean)));
        let new = film.pictures.iter().filter_map(|p| p.new_points);
        let (sum, count) = new.fold((0.0, 0), |(sum, count), share| (sum + share, count + 1));
        cells.push(if count > 0 {
            format!("{:.1} %", 100.0 * sum / f64::from(count))
        } else {
            String::new()
        });
        let count = |times| film.pictures_to(times).map_or("more".into(), |n| n.to_string());
        cells.extend([count(1.1), count(1.5)]);
        cells.extend(
            film.correlation.map(|c| if film.has_motion() { format!("{c:.2}") } else { String::new() }),
        );
        cells.push(film.jod.map_or(String::new(), |jod| format!("{jod:.2}")));
        Some(cells)
    };
    let table: Table = rows.iter().filter_map(row).collect();
    let header = FILMS.map(str::to_owned).to_vec();
    (!table.is_empty()).then(|| without_empty_columns(std::iter::once(header).chain(table).collect()))
}

const FILMS: [&str; 21] = [
    "",
    "rest, ms",
    "moving, ms",
    "ratio",
    "SMAPE, rest",
    "moving",
    "ratio",
    "relMSE, rest",
    "moving",
    "ratio",
    "chroma, rest",
    "moving",
    "ratio",
    "FLIP",
    "energy",
    "new points",
    "to 1.1",
    "to 1.5",
    "lag 1",
    "lag n",
    "JOD",
];

/// What the columns of [`films`] mean.
pub const FILM_COLUMNS: &str = "Medians of GPU times of a frame at rest and in motion, ms. Errors against the sum over all lights at the points that a \
    picture shaded: of the last picture at rest, and the mean over pictures in motion (after a cut, over those after it, at \
    rest the last of them), and the second over the first. new points: share of pixels whose point no pixel had in the frame \
    before. to 1.1, to 1.5: judged pictures after the stop or the cut until SMAPE is so many times that at rest. lag 1, lag n: \
    correlation of errors of the same surface points in pictures 1 and n apart. JOD: quality of the film, 10 is the truth's.";

/// What the columns of [`series`] mean.
pub const COLUMNS: &str = "Medians of GPU times, ms, by pass and for the frame (p95: 95 % of the frames take no longer). Errors are of a single \
    frame against the truth; ± is half the 95 % confidence interval over independent runs. chroma: error of colors of luminance 1. energy: total light over the \
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
        let last = arm.row.measured.as_ref().and_then(|m| m.judged.as_ref()?.curve.last());
        cells.push(last.map_or(String::new(), |p| {
            format!("{} after {} ms, {} frames", significant(p.rel_mse.mean), significant(p.ms), p.frames)
        }));
        cells
    };
    Some(std::iter::once(header).chain(arms.iter().map(row)).collect())
}

/// relMSE after parts of the time that all arms have, an arm a row.
pub(super) fn error_after<'a>(group: &Group<'a>) -> Option<Table> {
    let arms = arms(group, &[]);
    let curve = |arm: &Arm<'a>| Some(&arm.row.measured.as_ref()?.judged.as_ref()?.curve);
    let curves: Vec<_> = arms.iter().filter_map(curve).collect();
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::statistics::Times;
    use candela::knobs::{Knobs, Mode};

    #[test]
    fn bench_rows_say_what_they_change_and_cost() {
        let row = |label: &str, lights, settings: Knobs, ms: f64| Row {
            label: label.into(),
            lights,
            measured: Some(Measurement {
                settings,
                passes: vec![("shade".into(), Times { median: ms / 2.0, ..Times::default() })],
                frame: Times { median: ms, ..Times::default() },
                ..Measurement::default()
            }),
            ..Row::default()
        };
        let biased = Knobs { mode: Mode::Biased, temporal: false, ..Knobs::default() };
        let failed = Row { label: "lost".into(), error: Some("no device".into()), ..Row::default() };
        let rows = [row("first", 500, Knobs::default(), 4.0), row("other", 9, biased, 5.0), failed];
        let table = bench(&rows);
        assert_eq!(table[0], ["", "change", "shade", "frame, ms", "spread", "over the first"]);
        assert_eq!(table[1], ["first", "", "2.000", "4.000", "0.000", "1.000"]);
        let change = "--lights 9 --no-temporal --mode biased";
        assert_eq!(table[2], ["other", change, "2.500", "5.000", "0.000", "1.250"]);
        assert_eq!(table[3], ["lost", "failed: no device"]);
    }
}
