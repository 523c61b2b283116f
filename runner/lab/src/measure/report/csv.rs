//! Tables for other programs: points.csv, a line a row of the report's tables, and pictures.csv, a line a picture of a film.

use super::passes;
use crate::measure::statistics::Interval;
use crate::measure::sweep::Results;
use crate::measure::sweep::point::{Judged, Measurement};
use candela::knobs;

/// A file, or why there is none.
pub type Result = csv::Result<Vec<u8>>;

/// Every picture that was judged of every film.
pub fn pictures(results: &Results) -> Result {
    let mut table = csv::Writer::from_writer(Vec::new());
    let place = ["scene", "lights", "camera", "series", "label", "picture", "phase"].map(str::to_owned);
    let errors = ["rel_mse", "smape", "chroma", "energy_ratio"];
    let errors = errors.iter().flat_map(|name| ["", "_low", "_high"].map(|end| format!("{name}{end}")));
    let last = ["flip", "new_points"].map(str::to_owned);
    table.write_record(place.into_iter().chain(errors).chain(last))?;
    for row in &results.rows {
        let film = row.measured.as_ref().and_then(|m| m.film.as_ref());
        for p in film.iter().flat_map(|film| &film.pictures) {
            let lights = row.lights.to_string();
            let mut cells =
                [&row.scene, &lights, &row.camera, &row.series, &row.label].map(String::clone).to_vec();
            cells.extend([p.number.to_string(), format!("{:?}", p.phase).to_lowercase()]);
            cells.extend([p.rel_mse, p.smape, p.chroma, p.energy_ratio].into_iter().flat_map(interval));
            cells.extend([p.flip.to_string(), p.new_points.map_or(String::new(), |share| share.to_string())]);
            table.write_record(cells)?;
        }
    }
    table.into_inner().map_err(|error| error.into_error().into())
}

fn interval(i: Interval) -> [String; 3] {
    [i.mean, i.low, i.high].map(|x| x.to_string())
}

pub fn table(results: &Results) -> Result {
    let passes = passes(results.rows.iter());
    let mut table = csv::Writer::from_writer(Vec::new());
    table.write_record(header(&passes))?;
    for row in &results.rows {
        let lights = row.lights.to_string();
        let mut cells =
            [&row.scene, &lights, &row.camera, &row.series, &row.label].map(String::clone).to_vec();
        match &row.measured {
            Some(m) => cells.extend(numbers(m, &passes)),
            None => cells.extend(vec![String::new(); header(&passes).len() - 6]),
        }
        cells.push(row.error.clone().unwrap_or_default());
        table.write_record(cells)?;
    }
    table.into_inner().map_err(|error| error.into_error().into())
}

fn header(passes: &[String]) -> Vec<String> {
    let place =
        ["scene", "lights", "camera", "series", "label", "triangles", "light_table", "width", "height"];
    let knobs = knobs::ALL.iter().map(|knob| knob.name);
    let times = ["frame_ms", "frame_p95_ms", "frame_spread_ms"];
    let mut names: Vec<String> = place.into_iter().chain(knobs).chain(times).map(str::to_owned).collect();
    names.extend(passes.iter().map(|p| format!("{p}_ms")));
    names.push("steady".into());
    for name in INTERVALS {
        names.extend([name.to_owned(), format!("{name}_low"), format!("{name}_high")]);
    }
    names.extend(REST.iter().chain(&["memory_bytes", "error"]).map(|name| (*name).to_owned()));
    names
}

/// Numbers with a confidence interval, and those without.
const INTERVALS: [&str; 8] =
    ["rel_mse", "rmse_nit", "r_mae", "mape", "smape", "energy_ratio", "bias_nit", "chroma"];
const REST: [&str; 7] =
    ["flip", "lasting_error", "flicker", "temporal_correlation", "not_finite", "truth_error", "truth_capped"];

fn numbers(m: &Measurement, passes: &[String]) -> Vec<String> {
    let [width, height] = m.size;
    let mut cells =
        [m.triangles.to_string(), m.light_count.to_string(), width.to_string(), height.to_string()].to_vec();
    cells.extend(knobs::ALL.iter().map(|knob| knob.value(&m.settings).to_string()));
    cells.extend([m.frame.median, m.frame.p95, m.frame.spread].map(|x| x.to_string()));
    let ms =
        |pass: &String| m.passes.iter().find(|(name, _)| name == pass).map(|(_, t)| t.median.to_string());
    cells.extend(passes.iter().map(|pass| ms(pass).unwrap_or_default()));
    cells.push(m.settled.map_or(String::new(), |settled| settled.steady.to_string()));
    match &m.judged {
        Some(judged) => cells.extend(errors(judged)),
        None => cells.extend(vec![String::new(); 3 * INTERVALS.len() + REST.len()]),
    }
    cells.push(m.memory.to_string());
    cells
}

fn errors(judged: &Judged) -> Vec<String> {
    let (e, stability, truth) = (&judged.error, &judged.stability, &judged.truth);
    let intervals = [e.rel_mse, e.rmse, e.r_mae, e.mape, e.smape, e.energy_ratio, e.bias].map(Some);
    let text = |i: Option<Interval>| i.map_or(Default::default(), interval);
    let mut cells: Vec<String> = intervals.into_iter().chain([e.chroma]).flat_map(text).collect();
    let single = [e.flip, e.lasting_error, stability.flicker, stability.temporal_correlation];
    cells.extend(single.map(|x| x.to_string()));
    cells.extend([e.not_finite.to_string(), truth.error.to_string(), truth.capped.to_string()]);
    cells
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_has_every_column() {
        let passes = ["a".to_owned(), "b".to_owned()];
        for judged in [None, Some(Judged::default())] {
            let cells = numbers(&Measurement { judged, ..Measurement::default() }, &passes).len();
            assert_eq!(header(&passes).len(), 5 + cells + 1);
        }
        for knob in knobs::ALL {
            let mut point = Measurement::default();
            let at = header(&passes).iter().position(|name| name == knob.name).unwrap() - 5;
            for _ in 0..2 {
                knob.toggle(&mut point.settings);
                assert_eq!(numbers(&point, &passes)[at], knob.value(&point.settings).to_string());
            }
        }
    }
}
