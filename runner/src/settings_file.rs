//! Every knob of the estimator as a document: JSON files, plans, screenshots.

use crate::error::{Error, Result};
use crate::frame::schedule::Primary;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use shared::frame::{Settings, mode};
use std::fmt::Display;
use std::ops::RangeInclusive;
use std::path::Path;

/// What each counting knob takes.
pub const CANDIDATES: RangeInclusive<u32> = 1..=1024;
pub const BSDF_CANDIDATES: RangeInclusive<u32> = 0..=4;
pub const ITERATIONS: RangeInclusive<u32> = 1..=8;
pub const NEIGHBORS: RangeInclusive<u32> = 1..=32;
pub const RESERVOIRS: RangeInclusive<u32> = 1..=4;

/// Lights from which tiles are used by themselves. Measured on an H100 (docs/performance.md): equal at 500 lights, faster
/// from some thousands on.
const TILES_FROM: u32 = 4096;

/// [`Settings`] with readable values. A field that is missing has its default; one that does not exist is an error.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SettingsFile {
    /// How reused reservoirs are weighted.
    pub mode: Mode,
    /// Light candidates a reservoir, 1..=1024.
    pub candidates: u32,
    /// Candidates found by rays along the reflectance, 0..=4; they act with `visibility`, where triangles or an environment shine.
    pub bsdf_candidates: u32,
    /// Test the survivor's visibility before it is reused.
    pub visibility: bool,
    /// Reuse the previous frame.
    pub temporal: bool,
    /// Reuse neighboring pixels.
    pub spatial: bool,
    /// Spatial passes, 1..=8.
    pub iterations: u32,
    /// Neighbors of each spatial pass, 1..=32.
    pub neighbors: u32,
    /// Radius of the neighborhood, pixels, above 0.
    pub radius: f32,
    /// Reservoirs a pixel, 1..=4.
    pub reservoirs: u32,
    /// A history weighs at most this many times the new candidates; above 0.
    pub confidence_cap: f32,
    /// Largest difference in distance between neighbors, as a fraction, above 0.
    pub depth_threshold: f32,
    /// Largest angle between normals of neighbors, degrees, above 0, at most 180.
    pub normal_threshold: f64,
    /// Draw candidates from presampled light tiles.
    pub tiles: Tiles,
    /// How a frame finds what its pixels see; no knob of the estimator, which starts from there.
    pub primary: Primary,
    /// Merge pairs of pixels that chose each other in place of `neighbors`; acts in unbiased mode.
    pub pairs: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Mode {
    /// 1/M weights (Bitterli et al. 2020, Alg. 4): fast, darkens where neighbors disagree.
    Biased,
    /// Pairwise MIS with the neighbors' visibility: the right mean, more rays.
    Unbiased,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Tiles {
    /// From 4,096 lights on.
    Auto,
    On,
    Off,
}

impl Default for SettingsFile {
    fn default() -> Self {
        SettingsFile {
            normal_threshold: 25.0,
            tiles: Tiles::Auto,
            ..SettingsFile::from(&Settings::default())
        }
    }
}

impl From<&Settings> for SettingsFile {
    /// [`SettingsFile::settings`] gives exactly these settings back.
    fn from(settings: &Settings) -> Self {
        // All fields by name: a new knob does not compile until it has its place here.
        let &Settings {
            candidates,
            bsdf_candidates,
            visibility_reuse,
            temporal,
            spatial,
            spatial_iterations,
            neighbors,
            radius,
            depth_threshold,
            normal_threshold,
            confidence_cap,
            reservoirs,
            mode,
            tiles,
            pairs,
        } = settings;
        SettingsFile {
            mode: if mode == mode::UNBIASED { Mode::Unbiased } else { Mode::Biased },
            candidates,
            bsdf_candidates,
            visibility: visibility_reuse != 0,
            temporal: temporal != 0,
            spatial: spatial != 0,
            iterations: spatial_iterations,
            neighbors,
            radius,
            reservoirs,
            confidence_cap,
            depth_threshold,
            normal_threshold: degrees(normal_threshold),
            tiles: if tiles != 0 { Tiles::On } else { Tiles::Off },
            primary: Primary::default(),
            pairs: pairs != 0,
        }
    }
}

impl SettingsFile {
    /// Reads a JSON document.
    pub fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).map_err(Error::read(path))?;
        let file: SettingsFile = serde_json::from_str(&text).map_err(Error::input(path))?;
        file.check().map_err(Error::input(path))?;
        Ok(file)
    }

    /// As a JSON document that [`SettingsFile::read`] takes.
    pub fn to_json(&self) -> String {
        // Numbers, words and truth values: nothing in them can fail.
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }

    /// What the command line says to get these knobs from `base`.
    pub fn options(&self, base: &SettingsFile) -> Vec<String> {
        let knobs = |file: &SettingsFile| match serde_json::to_value(file) {
            Ok(Value::Object(knobs)) => knobs,
            // It is a document of named knobs.
            _ => Map::new(),
        };
        let base = knobs(base);
        let changed = knobs(self).into_iter().filter(|(name, value)| base.get(name) != Some(value));
        let option = |(name, value): (String, Value)| {
            let name = name.replace('_', "-");
            match &value {
                Value::Bool(true) => format!("--{name}"),
                Value::Bool(false) => format!("--no-{name}"),
                Value::String(word) if word == "on" => format!("--{name}"),
                Value::String(word) if word == "off" => format!("--no-{name}"),
                Value::String(word) => format!("--{name} {word}"),
                number => format!("--{name} {number}"),
            }
        };
        changed.map(option).collect()
    }

    /// The first knob that is out of its range, in one line.
    pub fn check(&self) -> Result<(), String> {
        within("candidates", self.candidates, CANDIDATES)?;
        within("bsdf_candidates", self.bsdf_candidates, BSDF_CANDIDATES)?;
        within("iterations", self.iterations, ITERATIONS)?;
        within("neighbors", self.neighbors, NEIGHBORS)?;
        within("reservoirs", self.reservoirs, RESERVOIRS)?;
        above_zero("radius", self.radius)?;
        above_zero("confidence_cap", self.confidence_cap)?;
        above_zero("depth_threshold", self.depth_threshold)?;
        above_zero("normal_threshold", self.normal_threshold as f32)?;
        if self.normal_threshold > 180.0 {
            return Err(format!("normal_threshold: {} is more than 180 degrees", self.normal_threshold));
        }
        Ok(())
    }

    /// For a scene of so many lights: tiles pay where the light table outgrows the caches.
    pub fn settings(&self, lights: u32) -> Settings {
        let tiles = match self.tiles {
            Tiles::Auto => lights >= TILES_FROM,
            Tiles::On => true,
            Tiles::Off => false,
        };
        Settings {
            candidates: self.candidates,
            bsdf_candidates: self.bsdf_candidates,
            visibility_reuse: self.visibility.into(),
            temporal: self.temporal.into(),
            spatial: self.spatial.into(),
            spatial_iterations: self.iterations,
            neighbors: self.neighbors,
            radius: self.radius,
            depth_threshold: self.depth_threshold,
            normal_threshold: cosine(self.normal_threshold),
            confidence_cap: self.confidence_cap,
            reservoirs: self.reservoirs,
            mode: match self.mode {
                Mode::Biased => mode::BIASED,
                Mode::Unbiased => mode::UNBIASED,
            },
            tiles: tiles.into(),
            pairs: self.pairs.into(),
        }
    }
}

fn cosine(degrees: f64) -> f32 {
    degrees.to_radians().cos() as f32
}

/// The angle with this cosine, in the fewest decimals that give the same cosine back.
fn degrees(cosine_of: f32) -> f64 {
    let angle = f64::from(cosine_of).acos().to_degrees();
    let rounded = |digits: i32| (angle * 10f64.powi(digits)).round() / 10f64.powi(digits);
    (0..12).map(rounded).find(|&angle| cosine(angle) == cosine_of).unwrap_or(angle)
}

fn within<T: PartialOrd + Display>(name: &str, value: T, range: RangeInclusive<T>) -> Result<(), String> {
    let (start, end) = (range.start(), range.end());
    if range.contains(&value) { Ok(()) } else { Err(format!("{name}: {value} is not in {start}..={end}")) }
}

fn above_zero(name: &str, value: f32) -> Result<(), String> {
    if value.is_finite() && value > 0.0 {
        Ok(())
    } else {
        Err(format!("{name}: {value} is not a number above 0"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<SettingsFile, String> {
        let file: SettingsFile = serde_json::from_str(text).map_err(|e| e.to_string())?;
        file.check().map(|()| file)
    }

    #[test]
    fn missing_knobs_have_their_defaults() {
        assert_eq!(parse("{}").unwrap(), SettingsFile::default());
        let one = parse(r#"{"candidates": 8}"#).unwrap();
        assert_eq!(one, SettingsFile { candidates: 8, ..SettingsFile::default() });
    }

    /// Settings -> document -> text -> document -> settings: the same bits, wherever each value comes from.
    #[test]
    fn settings_come_back_as_they_were() {
        let odd = Settings {
            candidates: 7,
            bsdf_candidates: 3,
            visibility_reuse: 0,
            temporal: 0,
            spatial: 0,
            spatial_iterations: 3,
            neighbors: 9,
            radius: 12.3,
            depth_threshold: 0.07,
            normal_threshold: 0.123_456_79,
            confidence_cap: 3.7,
            reservoirs: 2,
            mode: mode::UNBIASED,
            tiles: 1,
            pairs: 1,
        };
        for settings in [odd, Settings::default()] {
            let text = SettingsFile::from(&settings).to_json();
            assert_eq!(parse(&text).unwrap().settings(1_000_000), settings, "{text}");
        }
        let text = SettingsFile::default().to_json();
        assert_eq!(parse(&text).unwrap(), SettingsFile::default());
    }

    #[test]
    fn angles_are_short_and_exact() {
        assert_eq!(degrees(cosine(25.0)), 25.0);
        assert_eq!(degrees(cosine(33.5)), 33.5);
        assert_eq!(degrees(-1.0), 180.0);
        for cosine_of in [0.906, 0.5, 0.123_456_79, -0.3] {
            assert_eq!(cosine(degrees(cosine_of)), cosine_of);
        }
    }

    /// What is said is what the command line takes, and gives the document again.
    #[test]
    fn options_lead_from_one_document_to_another() {
        use clap::Parser;
        #[derive(Parser)]
        struct Line {
            #[command(flatten)]
            knobs: crate::cli::args::KnobArgs,
        }
        let base = SettingsFile::default();
        let other = SettingsFile {
            mode: Mode::Unbiased,
            candidates: 7,
            visibility: false,
            radius: 12.5,
            confidence_cap: 3.0,
            normal_threshold: 33.5,
            tiles: Tiles::Off,
            primary: Primary::Rays,
            pairs: true,
            ..SettingsFile::default()
        };
        let line = other.options(&base).join(" ");
        let parsed = Line::try_parse_from(["candela"].into_iter().chain(line.split(' '))).unwrap();
        assert_eq!(parsed.knobs.document().unwrap(), other, "{line}");
        assert!(base.options(&base).is_empty());
        assert_eq!(SettingsFile { visibility: true, ..other.clone() }.options(&other), ["--visibility"]);
    }

    #[test]
    fn tiles_come_with_many_lights() {
        let tiles = |tiles, lights| SettingsFile { tiles, ..SettingsFile::default() }.settings(lights).tiles;
        assert_eq!((tiles(Tiles::Auto, 4095), tiles(Tiles::Auto, 4096)), (0, 1));
        assert_eq!((tiles(Tiles::On, 1), tiles(Tiles::Off, 1_000_000)), (1, 0));
    }

    #[test]
    fn mistakes_are_one_line_that_names_them() {
        for (text, word) in [
            (r#"{"candidate": 8}"#, "unknown field `candidate`"),
            (r#"{"candidates": 0}"#, "candidates: 0 is not in 1..=1024"),
            (r#"{"candidates": -3}"#, "-3"),
            (r#"{"bsdf_candidates": 5}"#, "bsdf_candidates: 5 is not in 0..=4"),
            (r#"{"iterations": 9}"#, "iterations"),
            (r#"{"radius": 0}"#, "radius: 0 is not a number above 0"),
            (r#"{"radius": 1e99}"#, "radius"),
            (r#"{"normal_threshold": 181}"#, "normal_threshold"),
            (r#"{"mode": "magic"}"#, "magic"),
            (r#"{"primary": "guess"}"#, "guess"),
            (r#"{"temporal": 1}"#, "boolean"),
            ("[1", "line 1"),
        ] {
            let error = parse(text).unwrap_err();
            assert!(error.contains(word) && !error.contains('\n'), "{text}: {error}");
        }
    }
}
