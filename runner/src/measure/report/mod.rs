//! What a sweep leaves behind: points.json, points.csv, report.html.

mod csv;
mod html;
pub mod markdown;
mod plot;
mod tables;
pub mod verdict;

use crate::error::{Error, Result};
use crate::image_io;
use crate::measure::sweep::store::to_json;
use crate::measure::sweep::{Results, Row};
use std::path::Path;

/// Writes the three files to `directory`.
pub fn write(directory: &Path, results: &Results) -> Result<()> {
    let mut bare = results.clone();
    for measured in bare.rows.iter_mut().filter_map(|row| row.measured.as_mut()) {
        measured.picture.clear();
        measured.reference_picture.clear();
    }
    image_io::replace(&directory.join("points.json"), &to_json(&bare)?)?;
    image_io::replace(&directory.join("points.csv"), csv::table(&bare).as_bytes())?;
    image_io::replace(&directory.join("report.html"), html::page(results).as_bytes())
}

/// Reads a points.json.
pub fn read(path: &Path) -> Result<Results> {
    let bytes =
        std::fs::read(path).map_err(|source| Error::File { path: path.into(), action: "read", source })?;
    serde_json::from_slice(&bytes).map_err(|e| Error::Usage(format!("{}: {e}", path.display())))
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
        use crate::measure::sweep::truth::Method;
        let Some(measured) = self.rows.iter().find_map(|r| r.measured.as_ref()) else {
            return "Nothing was measured.".into();
        };
        let truth = &measured.truth;
        let how = match truth.method {
            Method::SumOverLights if truth.error == 0.0 => "the sum over all lights, exact".into(),
            Method::SumOverLights => {
                format!("the mean of {} sums over all lights", thousands(truth.samples as usize))
            }
            Method::IndependentFrames => {
                format!("the mean of {} independent frames without reuse", thousands(truth.samples as usize))
            }
        };
        if truth.error == 0.0 {
            return format!("Truth: {how}.");
        }
        let smallest = self.smallest_error();
        let part = truth.error / smallest;
        let verdict = if part <= 0.1 { "a tenth or less" } else { "more than a tenth" };
        let limit = if part <= 0.1 { "" } else { ": errors near it are upper bounds" };
        format!(
            "Truth: {how}; its own √relMSE is {}, {verdict} ({:.0} %) of the smallest one shown{limit}.",
            significant(truth.error),
            100.0 * part
        )
    }

    /// √relMSE
    fn smallest_error(&self) -> f64 {
        let measured = self.rows.iter().filter_map(|r| r.measured.as_ref());
        let errors = measured.flat_map(|m| {
            m.curve.iter().map(|p| p.rel_mse.mean).chain([m.error.rel_mse.mean]).map(f64::sqrt)
        });
        errors.filter(|e| *e > 0.0).fold(f64::INFINITY, f64::min)
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
