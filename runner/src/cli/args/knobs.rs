//! Every knob of the estimator on the command line.

use super::values::positive;
use crate::error::{Error, Result};
use crate::frame::schedule::Primary;
use crate::settings_file::{
    BSDF_CANDIDATES, CANDIDATES, ITERATIONS, Mode, NEIGHBORS, RESERVOIRS, SettingsFile, Tiles,
};
use clap::Args;
use std::ops::RangeInclusive;
use std::path::PathBuf;

/// Every knob of the estimator: of `--settings`, changed by what else is said. See [`SettingsFile`].
#[derive(Args, Clone, Debug, Default)]
pub struct KnobArgs {
    /// A JSON document of knobs; the options below change single ones.
    #[arg(long, value_name = "FILE")]
    pub settings: Option<PathBuf>,
    #[arg(long, value_parser = count(&CANDIDATES), help = knob("Light candidates a reservoir: more is less noise and more time", |d| d.candidates))]
    pub candidates: Option<u32>,
    #[arg(long, value_parser = count(&BSDF_CANDIDATES), help = knob("Candidates that rays along the reflectance find, where triangles or an environment shine: smooth surfaces need them", |d| d.bsdf_candidates))]
    pub bsdf_candidates: Option<u32>,
    #[arg(long, value_parser = count(&NEIGHBORS), help = knob("Neighbors of each spatial pass; acts with --no-pairs and in biased mode", |d| d.neighbors))]
    pub neighbors: Option<u32>,
    #[arg(long, value_parser = count(&ITERATIONS), help = knob("Spatial passes", |d| d.iterations))]
    pub iterations: Option<u32>,
    #[arg(long, value_parser = positive, help = knob("Radius of the neighborhood, pixels; side of the squares in which pairs are found, a power of two from there on", |d| d.radius))]
    pub radius: Option<f32>,
    #[arg(long, value_parser = count(&RESERVOIRS), help = knob("Reservoirs a pixel", |d| d.reservoirs))]
    pub reservoirs: Option<u32>,
    #[arg(long, value_parser = positive, help = knob("A history weighs at most this many times the new candidates", |d| d.confidence_cap))]
    pub confidence_cap: Option<f32>,
    /// Reuse the previous frame (on by default).
    #[arg(long, overrides_with = "no_temporal")]
    pub temporal: bool,
    #[arg(long, overrides_with = "temporal")]
    pub no_temporal: bool,
    /// Reuse neighboring pixels (on by default).
    #[arg(long, overrides_with = "no_spatial")]
    pub spatial: bool,
    #[arg(long, overrides_with = "spatial")]
    pub no_spatial: bool,
    /// Test the survivor's visibility before it is reused (on by default).
    #[arg(long, overrides_with = "no_visibility")]
    pub visibility: bool,
    #[arg(long, overrides_with = "visibility")]
    pub no_visibility: bool,
    #[arg(long, value_parser = positive, help = knob("Largest difference in distance between neighbors, as a fraction", |d| d.depth_threshold))]
    pub depth_threshold: Option<f32>,
    #[arg(long, value_parser = positive, help = knob("Largest angle between normals of neighbors, degrees", |d| d.normal_threshold))]
    pub normal_threshold: Option<f32>,
    /// Draw candidates from presampled light tiles (by default from 4,096 lights on).
    #[arg(long, overrides_with = "no_tiles")]
    pub tiles: bool,
    #[arg(long, overrides_with = "tiles")]
    pub no_tiles: bool,
    /// Merge pairs of pixels that chose each other, not neighbors (the default; acts in unbiased mode).
    #[arg(long, overrides_with = "no_pairs")]
    pub pairs: bool,
    #[arg(long, overrides_with = "pairs")]
    pub no_pairs: bool,
    /// How reused reservoirs are weighted [default: unbiased].
    #[arg(long, value_enum)]
    pub mode: Option<Mode>,
    /// How a frame finds what its pixels see [default: auto].
    #[arg(long, value_enum)]
    pub primary: Option<Primary>,
}

impl KnobArgs {
    /// The settings file, or the defaults, with the changes of the command line.
    pub fn document(&self) -> Result<SettingsFile> {
        let file = self.settings.as_deref().map(SettingsFile::read).transpose()?.unwrap_or_default();
        let switch = |on: bool, off: bool, default: bool| (default || on) && !off;
        let document = SettingsFile {
            mode: self.mode.unwrap_or(file.mode),
            candidates: self.candidates.unwrap_or(file.candidates),
            bsdf_candidates: self.bsdf_candidates.unwrap_or(file.bsdf_candidates),
            visibility: switch(self.visibility, self.no_visibility, file.visibility),
            temporal: switch(self.temporal, self.no_temporal, file.temporal),
            spatial: switch(self.spatial, self.no_spatial, file.spatial),
            iterations: self.iterations.unwrap_or(file.iterations),
            neighbors: self.neighbors.unwrap_or(file.neighbors),
            radius: self.radius.unwrap_or(file.radius),
            reservoirs: self.reservoirs.unwrap_or(file.reservoirs),
            confidence_cap: self.confidence_cap.unwrap_or(file.confidence_cap),
            depth_threshold: self.depth_threshold.unwrap_or(file.depth_threshold),
            normal_threshold: self.normal_threshold.map_or(file.normal_threshold, f64::from),
            tiles: match (self.tiles, self.no_tiles) {
                (true, _) => Tiles::On,
                (_, true) => Tiles::Off,
                _ => file.tiles,
            },
            primary: self.primary.unwrap_or(file.primary),
            pairs: switch(self.pairs, self.no_pairs, file.pairs),
        };
        document.check().map_err(Error::Usage)?;
        Ok(document)
    }
}

/// Parser of a count in `range`.
fn count(range: &RangeInclusive<u32>) -> clap::builder::RangedI64ValueParser<u32> {
    clap::value_parser!(u32).range(i64::from(*range.start())..=i64::from(*range.end()))
}

/// A knob's help with its default.
fn knob<T: std::fmt::Display>(help: &str, default: impl Fn(&SettingsFile) -> T) -> String {
    format!("{help} [default: {}]", default(&SettingsFile::default()))
}
