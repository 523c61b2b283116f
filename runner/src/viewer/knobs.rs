//! Every knob of the estimator: its words and its steps. A new one is a `static` and its name in [`ALL`].

use crate::frame::schedule::Primary;
use crate::settings_file::{self, Mode, SettingsFile, Tiles};
use std::ops::RangeInclusive;

/// A knob as panels, keys and scripts see it.
#[derive(Debug)]
pub struct Knob {
    pub name: &'static str,
    pub unit: &'static str,
    pub meaning: &'static str,
    /// What more of it does, and less; for switches on and off.
    pub higher: &'static str,
    pub lower: &'static str,
    pub bias: &'static str,
    kind: Kind,
}

/// The setting behind a knob, and the steps that it takes.
#[derive(Debug)]
enum Kind {
    Switch(fn(&mut SettingsFile) -> &mut bool),
    Count(fn(&mut SettingsFile) -> &mut u32, RangeInclusive<u32>),
    /// Doubled and halved, as the thesis has it.
    Doubled(fn(&mut SettingsFile) -> &mut u32, RangeInclusive<u32>),
    /// In steps of 0.02.
    Fraction(fn(&mut SettingsFile) -> &mut f32, RangeInclusive<f32>),
    /// In steps of 5.
    Amount(fn(&mut SettingsFile) -> &mut f32, RangeInclusive<f32>),
    /// In steps of 5.
    Degrees(fn(&mut SettingsFile) -> &mut f64, RangeInclusive<f64>),
    Mode,
    Tiles,
    Primary,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    Down,
    Up,
}

/// In the order of the panel: the thesis's first.
pub static ALL: &[&Knob] = &[
    &CANDIDATES,
    &VISIBILITY,
    &TEMPORAL,
    &SPATIAL,
    &ITERATIONS,
    &NEIGHBORS,
    &DEPTH_THRESHOLD,
    &NORMAL_THRESHOLD,
    &MODE,
    &RESERVOIRS,
    &RADIUS,
    &CONFIDENCE_CAP,
    &BSDF_CANDIDATES,
    &TILES,
    &PAIRS,
    &PRIMARY,
];

pub static CANDIDATES: Knob = Knob {
    name: "Light samples",
    unit: "candidates a reservoir, 1 to 1024, doubled or halved",
    meaning: "Lights that each pixel draws before it keeps one.",
    higher: "less noise; time grows with it",
    lower: "faster, noisier",
    bias: "none",
    kind: Kind::Doubled(|s| &mut s.candidates, settings_file::CANDIDATES),
};

pub static VISIBILITY: Knob = Knob {
    name: "Visibility reuse",
    unit: "on or off",
    meaning: "A shadow ray drops a hidden sample before others reuse it.",
    higher: "far less noise in shadow; one more ray a reservoir",
    lower: "hidden lights spread and are found dark only when shaded",
    bias: "biased mode darkens near shadow edges; unbiased mode has none",
    kind: Kind::Switch(|s| &mut s.visibility),
};

pub static TEMPORAL: Knob = Knob {
    name: "Temporal reuse",
    unit: "on or off",
    meaning: "Merges the reservoir that this surface had in the last frame.",
    higher: "the samples of many frames for the price of one",
    lower: "every frame by itself",
    bias: "biased mode: some where surfaces come into view; unbiased: none",
    kind: Kind::Switch(|s| &mut s.temporal),
};

pub static SPATIAL: Knob = Knob {
    name: "Spatial reuse",
    unit: "on or off",
    meaning: "Merges the reservoirs of neighboring pixels.",
    higher: "many times the samples; noise turns into blotches",
    lower: "every pixel by itself",
    bias: "biased mode darkens where neighbors see other lights; unbiased: none",
    kind: Kind::Switch(|s| &mut s.spatial),
};

pub static ITERATIONS: Knob = Knob {
    name: "Spatial iterations",
    unit: "passes, 1 to 8",
    meaning: "How often the neighbors are merged.",
    higher: "samples come from further away; time grows with it",
    lower: "faster",
    bias: "biased mode: grows with it; unbiased: none",
    kind: Kind::Count(|s| &mut s.iterations, settings_file::ITERATIONS),
};

pub static NEIGHBORS: Knob = Knob {
    name: "Neighbors",
    unit: "pixels each pass, 1 to 32",
    meaning: "How many neighbors each spatial pass asks, in biased mode or without pairs.",
    higher: "less noise; time grows with it",
    lower: "faster",
    bias: "biased mode: grows with it; unbiased: none",
    kind: Kind::Count(|s| &mut s.neighbors, settings_file::NEIGHBORS),
};

pub static DEPTH_THRESHOLD: Knob = Knob {
    name: "Depth threshold",
    unit: "fraction of the distance to the camera",
    meaning: "How much nearer or further a neighbor may be.",
    higher: "more neighbors pass, also of other surfaces",
    lower: "fewer neighbors, more alike",
    bias: "biased mode: grows with it; unbiased: none",
    kind: Kind::Fraction(|s| &mut s.depth_threshold, 0.02..=1.0),
};

pub static NORMAL_THRESHOLD: Knob = Knob {
    name: "Normal threshold",
    unit: "degrees between normals",
    meaning: "How much a neighbor's normal may be turned.",
    higher: "more neighbors pass, also around corners",
    lower: "fewer neighbors, more alike",
    bias: "biased mode: grows with it; unbiased: none",
    kind: Kind::Degrees(|s| &mut s.normal_threshold, 5.0..=180.0),
};

pub static MODE: Knob = Knob {
    name: "Mode",
    unit: "biased or unbiased",
    meaning: "How reused reservoirs are weighted: 1/M, or pairwise MIS with the neighbors' visibility.",
    higher: "unbiased: the right mean, more rays",
    lower: "biased: faster, too dark where neighbors disagree",
    bias: "this is the choice",
    kind: Kind::Mode,
};

pub static RESERVOIRS: Knob = Knob {
    name: "Reservoirs",
    unit: "a pixel, 1 to 4",
    meaning: "Independent reservoirs, averaged by shading.",
    higher: "less noise; time and memory grow with it",
    lower: "faster",
    bias: "none",
    kind: Kind::Count(|s| &mut s.reservoirs, settings_file::RESERVOIRS),
};

pub static RADIUS: Knob = Knob {
    name: "Radius",
    unit: "pixels",
    meaning: "Neighbors are drawn from a disk this large, partners from a square.",
    higher: "neighbors repeat less, but are less alike",
    lower: "neighbors more alike, blotches smaller and stronger",
    bias: "biased mode: grows with it; unbiased: none",
    kind: Kind::Amount(|s| &mut s.radius, 4.0..=200.0),
};

pub static CONFIDENCE_CAP: Knob = Knob {
    name: "Confidence cap",
    unit: "times the light samples",
    meaning: "How many new samples a history may weigh at most.",
    higher: "smoother, slower to follow changes",
    lower: "follows changes at once, noisier",
    bias: "none in the mean; errors of neighboring frames are alike",
    kind: Kind::Amount(|s| &mut s.confidence_cap, 1.0..=100.0),
};

pub static BSDF_CANDIDATES: Knob = Knob {
    name: "BSDF samples",
    unit: "rays a reservoir, 0 to 4",
    meaning: "Rays along the reflection that look for triangles and the environment.",
    higher: "less noise in smooth surfaces; a ray each",
    lower: "faster; 0: mirrors show specks",
    bias: "none; they act with visibility reuse only",
    kind: Kind::Count(|s| &mut s.bsdf_candidates, settings_file::BSDF_CANDIDATES),
};

pub static TILES: Knob = Knob {
    name: "Light tiles",
    unit: "auto (from 4,096 lights on), on or off",
    meaning: "Draws light samples from small presampled lists.",
    higher: "faster with very many lights",
    lower: "each pixel draws from all lights",
    bias: "none; neighboring pixels share samples",
    kind: Kind::Tiles,
};

pub static PAIRS: Knob = Knob {
    name: "Pairs",
    unit: "on or off",
    meaning: "Spatial passes merge pairs of pixels that chose each other.",
    higher: "one ray a pixel and pass",
    lower: "several neighbors, two rays",
    bias: "none; acts in unbiased mode only",
    kind: Kind::Switch(|s| &mut s.pairs),
};

pub static PRIMARY: Knob = Knob {
    name: "Primary",
    unit: "auto, raster or rays",
    meaning: "What pixels see is drawn by the graphics pipeline, not traced by a ray each.",
    higher: "raster: no rays from the eye",
    lower: "rays: one a pixel (auto: raster on processors, rays elsewhere)",
    bias: "none; pixels whose center lies on an edge may show its other side",
    kind: Kind::Primary,
};

/// A name is one knob's.
impl PartialEq for Knob {
    fn eq(&self, other: &Knob) -> bool {
        self.name == other.name
    }
}

impl Knob {
    /// One step up or down, within the knob's range; switches go on and off.
    pub fn step(&self, s: &mut SettingsFile, step: Step) {
        let up = step == Step::Up;
        match &self.kind {
            Kind::Switch(of) => *of(s) = up,
            Kind::Count(of, range) => {
                let next = if up { *of(s) + 1 } else { of(s).saturating_sub(1) };
                *of(s) = next.clamp(*range.start(), *range.end());
            }
            Kind::Doubled(of, range) => {
                let next = if up { of(s).saturating_mul(2) } else { *of(s) / 2 };
                *of(s) = next.clamp(*range.start(), *range.end());
            }
            Kind::Fraction(of, range) => amount(of(s), up, 0.02, range),
            Kind::Amount(of, range) => amount(of(s), up, 5.0, range),
            Kind::Degrees(of, range) => {
                *of(s) = (*of(s) + if up { 5.0 } else { -5.0 }).clamp(*range.start(), *range.end());
            }
            Kind::Mode => s.mode = if up { Mode::Unbiased } else { Mode::Biased },
            Kind::Primary => {
                s.primary = match (s.primary, up) {
                    (Primary::Rays, true) | (Primary::Raster, false) => Primary::Auto,
                    (_, true) => Primary::Raster,
                    (_, false) => Primary::Rays,
                }
            }
            Kind::Tiles => {
                s.tiles = match (s.tiles, up) {
                    (Tiles::Off, true) | (Tiles::On, false) => Tiles::Auto,
                    (_, true) => Tiles::On,
                    (_, false) => Tiles::Off,
                }
            }
        }
    }

    /// A step that changes something: up, or from the top down.
    pub fn toggle(&self, s: &mut SettingsFile) {
        let before = s.clone();
        self.step(s, Step::Up);
        if *s == before {
            self.step(s, Step::Down);
        }
    }

    pub fn value(&self, s: &SettingsFile) -> String {
        let mut s = s.clone();
        match &self.kind {
            Kind::Switch(of) => if *of(&mut s) { "on" } else { "off" }.into(),
            Kind::Count(of, _) | Kind::Doubled(of, _) => of(&mut s).to_string(),
            Kind::Fraction(of, _) => format!("{:.2}", of(&mut s)),
            Kind::Amount(of, _) => format!("{:.0}", of(&mut s)),
            Kind::Degrees(of, _) => format!("{:.0}°", of(&mut s)),
            Kind::Mode => if s.mode == Mode::Unbiased { "unbiased" } else { "biased" }.into(),
            Kind::Primary => match s.primary {
                Primary::Auto => "auto",
                Primary::Raster => "raster",
                Primary::Rays => "rays",
            }
            .into(),
            Kind::Tiles => match s.tiles {
                Tiles::Auto => "auto",
                Tiles::On => "on",
                Tiles::Off => "off",
            }
            .into(),
        }
    }

    /// Is it a choice between two?
    pub fn is_switch(&self) -> bool {
        matches!(self.kind, Kind::Switch(_) | Kind::Mode)
    }
}

/// On multiples of `step`, so that what was typed on the command line comes back onto the grid.
fn amount(value: &mut f32, up: bool, step: f32, range: &RangeInclusive<f32>) {
    let at = *value / step;
    let next = if up { (at + 1e-3).floor() + 1.0 } else { (at - 1e-3).ceil() - 1.0 };
    *value = (next * step).clamp(*range.start(), *range.end());
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All the way down and up again: every value is allowed, and both ends are reached.
    #[test]
    fn knobs_stay_in_their_ranges() {
        for &knob in ALL {
            let mut settings = SettingsFile::default();
            for step in [Step::Down, Step::Up, Step::Down] {
                for _ in 0..100 {
                    knob.step(&mut settings, step);
                    settings.check().unwrap();
                }
                let end = settings.clone();
                knob.step(&mut settings, step);
                assert_eq!(settings, end, "{} has an end", knob.name);
            }
        }
    }

    #[test]
    fn each_knob_changes_its_own_setting_only() {
        let default = SettingsFile::default();
        let mut seen = Vec::new();
        for &knob in ALL {
            let mut settings = default.clone();
            knob.toggle(&mut settings);
            let changed: Vec<_> =
                ALL.iter().copied().filter(|k| k.value(&settings) != k.value(&default)).collect();
            assert_eq!(changed, [knob]);
            seen.push(settings);
        }
        assert!((1..seen.len()).all(|i| !seen[..i].contains(&seen[i])));
    }

    #[test]
    fn light_samples_double_and_halve() {
        let mut s = SettingsFile::default();
        let mut down = Vec::new();
        for _ in 0..6 {
            CANDIDATES.step(&mut s, Step::Down);
            down.push(s.candidates);
        }
        assert_eq!(down, [16, 8, 4, 2, 1, 1]);
        for _ in 0..11 {
            CANDIDATES.step(&mut s, Step::Up);
        }
        assert_eq!(s.candidates, 1024);
    }

    #[test]
    fn amounts_come_back_onto_their_grid() {
        let mut s = SettingsFile { radius: 32.0, ..SettingsFile::default() };
        RADIUS.step(&mut s, Step::Up);
        assert_eq!(s.radius, 35.0);
        RADIUS.step(&mut s, Step::Down);
        RADIUS.step(&mut s, Step::Down);
        assert_eq!(s.radius, 25.0);
    }

    /// A setting without a knob, or a knob of nothing, is a mistake.
    #[test]
    fn every_setting_has_its_knob() {
        let document: serde_json::Value = serde_json::from_str(&SettingsFile::default().to_json()).unwrap();
        assert_eq!(document.as_object().map(|fields| fields.len()), Some(ALL.len()));
    }
}
