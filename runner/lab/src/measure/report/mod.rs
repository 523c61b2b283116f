//! Results of a sweep: points.json, points.csv, report.html; of films pictures.csv too.

mod csv;
mod html;
pub mod markdown;
mod plot;
pub mod tables;
pub mod verdict;

use crate::measure::sweep::point::Judged;
use crate::measure::sweep::store::to_json;
use crate::measure::sweep::truth::Method;
use crate::measure::sweep::{Results, Row};
use candela::error::{Error, Result};
use candela::{files, image_io};
use std::path::Path;

/// Writes the files to `directory`.
pub fn write(directory: &Path, results: &Results) -> Result<()> {
    let mut bare = results.clone();
    for measured in bare.rows.iter_mut().filter_map(|row| row.measured.as_mut()) {
        measured.picture.clear();
        measured.reference_picture.clear();
        measured.error_map.clear();
        let pictures = measured.film.iter_mut().flat_map(|film| &mut film.pictures);
        pictures.for_each(|picture| picture.picture.clear());
    }
    image_io::replace(&directory.join("points.json"), &to_json(&bare)?)?;
    let write = |name: &str, table: csv::Result| {
        let path = directory.join(name);
        let table = table.map_err(|e| Error::Internal(format!("{}: {e}", path.display())))?;
        image_io::replace(&path, &table)
    };
    write("points.csv", csv::table(&bare))?;
    if bare.plan.motion.is_some() {
        write("pictures.csv", csv::pictures(&bare))?;
    }
    image_io::replace(&directory.join("report.html"), html::page(results).as_bytes())
}

/// Reads a points.json.
pub fn read(path: &Path) -> Result<Results> {
    serde_json::from_str(&files::read_text(path)?).map_err(Error::input(path))
}

/// Checks, before any work is done, that results can be written to `directory`.
pub fn check_writable(directory: &Path) -> Result<()> {
    image_io::check_folder(directory)
}

/// Rows under one light in one place: they can be compared.
struct Group<'a> {
    rows: Vec<&'a Row>,
}

impl<'a> Group<'a> {
    fn all(results: &'a Results) -> Vec<Group<'a>> {
        let mut groups: Vec<Group> = Vec::new();
        let place = |row: &'a Row| (&row.scene, row.lights, &row.camera);
        for row in &results.rows {
            match groups.iter_mut().find(|g| place(g.rows[0]) == place(row)) {
                Some(group) => group.rows.push(row),
                None => groups.push(Group { rows: vec![row] }),
            }
        }
        groups
    }

    fn title(&self) -> String {
        let row = self.rows[0];
        let triangles = self.rows.iter().find_map(|r| r.measured.as_ref()).map(|m| thousands(m.triangles));
        let triangles = triangles.map_or(String::new(), |n| format!(", {n} triangles"));
        format!("{}: {} lights{triangles}, camera {}", row.scene, thousands(row.lights), row.camera)
    }

    /// (name, rows) of each series, in order.
    fn series(&self) -> Vec<(&'a str, Vec<&'a Row>)> {
        let mut series: Vec<(&str, Vec<&Row>)> = Vec::new();
        for &row in &self.rows {
            match series.iter_mut().find(|(name, _)| *name == row.series) {
                Some((_, rows)) => rows.push(row),
                None => series.push((&row.series, vec![row])),
            }
        }
        series
    }

    /// One sentence about the truth of this group.
    fn truth(&self) -> String {
        if self.rows.iter().any(|r| r.measured.as_ref().is_some_and(|m| m.film.is_some())) {
            return "Truth: the sum over all lights at the points of each judged picture.".into();
        }
        let judged = self.rows.iter().filter_map(|r| r.measured.as_ref()?.judged.as_ref());
        let part = |j: &Judged| j.truth.error / j.smallest_error();
        // Truths get better from point to point; what counts is the point that has the worst one for what it shows.
        let Some(worst) = judged.max_by(|a, b| part(a).total_cmp(&part(b))) else {
            let some = self.rows.iter().any(|r| r.measured.is_some());
            return if some { "Times alone." } else { "Nothing was measured." }.into();
        };
        let truth = &worst.truth;
        let samples = thousands(truth.samples as usize);
        let how = match truth.method {
            Method::SumOverLights if truth.error == 0.0 => "the sum over all lights, exact".into(),
            Method::SumOverLights => format!("the mean of {samples} sums over all lights"),
            Method::IndependentFrames => format!("the mean of {samples} independent frames without reuse"),
        };
        let how = match truth.paths {
            0 => how,
            paths => format!("{how}, with {paths} paths a pixel each"),
        };
        if truth.error == 0.0 {
            return format!("Truth: {how}.");
        }
        let (verdict, limit) = match (part(worst) <= 0.1, truth.capped) {
            (true, _) => ("a tenth or less", ""),
            (false, false) => ("more than a tenth", ": errors near it are upper bounds"),
            (false, true) => (
                "more than a tenth",
                ": the plan allows no more samples, and errors near it are upper bounds",
            ),
        };
        format!(
            "Truth: {how}; its own √relMSE is {}, {verdict} ({:.0} %) of the smallest one shown{limit}.",
            significant(truth.error),
            100.0 * part(worst)
        )
    }

    /// Which points were timed although their frames had not settled; none if all had.
    fn unsettled(&self) -> Option<String> {
        let unsettled =
            |r: &&&Row| r.measured.as_ref().and_then(|m| m.settled).is_some_and(|settled| !settled.steady);
        let name = |r: &&Row| format!("{}, {}", r.series, r.label);
        let names: Vec<_> = self.rows.iter().filter(unsettled).map(name).collect();
        let all = names.len() == self.rows.len();
        let which = if all { "all points".to_owned() } else { names.join("; ") };
        (!names.is_empty()).then(|| format!("Timed before frame times had stabilized: {which}."))
    }
}

/// Stems of all passes, in the order they are met.
fn passes<'a>(rows: impl Iterator<Item = &'a Row>) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for measured in rows.filter_map(|row| row.measured.as_ref()) {
        let mut at = 0;
        for (name, _) in &measured.passes {
            match names.iter().position(|known| known == name) {
                Some(place) => at = place + 1,
                None => {
                    names.insert(at, name.clone());
                    at += 1;
                }
            }
        }
    }
    names
}

/// Three significant digits.
fn significant(x: f64) -> String {
    match x.abs() {
        0.0 => "0".into(),
        a if !(1e-3..1e5).contains(&a) => format!("{x:.2e}"),
        a => format!("{x:.*}", (2 - a.log10().floor() as i32).max(0) as usize),
    }
}

/// 1234567 -> 1,234,567
fn thousands(n: usize) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let cases = [
            (0.0, "0"),
            (0.01234, "0.0123"),
            (1.0, "1.00"),
            (12.345, "12.3"),
            (1234.5, "1234"),
            (-0.5, "-0.500"),
        ];
        for (x, text) in cases {
            assert_eq!(significant(x), text);
        }
        assert_eq!((significant(1.234e-5), significant(1.234e7)), ("1.23e-5".into(), "1.23e7".into()));
        assert_eq!(
            (thousands(7), thousands(1000), thousands(1234567)),
            ("7".into(), "1,000".into(), "1,234,567".into())
        );
    }
}
