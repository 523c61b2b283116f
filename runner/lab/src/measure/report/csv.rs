//! points.csv: one line a row of the tables, every number.

use super::passes;
use crate::measure::sweep::Results;
use crate::measure::sweep::point::{Judged, Measurement};
use candela::knobs;

pub fn table(results: &Results) -> csv::Result<Vec<u8>> {
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
const INTERVALS: [&str; 7] = ["rel_mse", "rmse_nit", "r_mae", "mape", "smape", "energy_ratio", "bias_nit"];
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
    let intervals = [e.rel_mse, e.rmse, e.r_mae, e.mape, e.smape, e.energy_ratio, e.bias];
    let mut cells: Vec<String> =
        intervals.iter().flat_map(|i| [i.mean, i.low, i.high].map(|x| x.to_string())).collect();
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
