//! Every knob of the estimator: its words, its steps, and the presets.

use crate::settings_file::{
    BSDF_CANDIDATES, CANDIDATES, ITERATIONS, Mode, NEIGHBORS, RESERVOIRS, SettingsFile, Tiles,
};
use std::ops::RangeInclusive;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Knob {
    Candidates,
    BsdfCandidates,
    Visibility,
    Temporal,
    Spatial,
    Iterations,
    Neighbors,
    DepthThreshold,
    NormalThreshold,
    Mode,
    Reservoirs,
    Radius,
    ConfidenceCap,
    Tiles,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    Down,
    Up,
}

/// What a tooltip says of a knob.
pub struct About {
    pub name: &'static str,
    pub unit: &'static str,
    pub meaning: &'static str,
    /// What more of it does, and less; for switches on and off.
    pub higher: &'static str,
    pub lower: &'static str,
    pub bias: &'static str,
}

const DEPTHS: RangeInclusive<f32> = 0.02..=1.0;
const ANGLES: RangeInclusive<f64> = 5.0..=180.0;
const RADII: RangeInclusive<f32> = 5.0..=200.0;
const CAPS: RangeInclusive<f32> = 1.0..=100.0;

impl Knob {
    /// In the order of the panel: the thesis's first.
    pub const ALL: [Knob; 14] = [
        Knob::Candidates,
        Knob::Visibility,
        Knob::Temporal,
        Knob::Spatial,
        Knob::Iterations,
        Knob::Neighbors,
        Knob::DepthThreshold,
        Knob::NormalThreshold,
        Knob::Mode,
        Knob::Reservoirs,
        Knob::Radius,
        Knob::ConfidenceCap,
        Knob::BsdfCandidates,
        Knob::Tiles,
    ];

    /// One step up or down, within the knob's range; switches go on and off.
    pub fn step(self, s: &mut SettingsFile, step: Step) {
        let up = step == Step::Up;
        match self {
            // Doubled and halved, as the thesis has it.
            Knob::Candidates => {
                let next = if up { s.candidates.saturating_mul(2) } else { s.candidates / 2 };
                s.candidates = next.clamp(*CANDIDATES.start(), *CANDIDATES.end());
            }
            Knob::BsdfCandidates => count(&mut s.bsdf_candidates, up, &BSDF_CANDIDATES),
            Knob::Visibility => s.visibility = up,
            Knob::Temporal => s.temporal = up,
            Knob::Spatial => s.spatial = up,
            Knob::Iterations => count(&mut s.iterations, up, &ITERATIONS),
            Knob::Neighbors => count(&mut s.neighbors, up, &NEIGHBORS),
            Knob::DepthThreshold => amount(&mut s.depth_threshold, up, 0.02, &DEPTHS),
            Knob::NormalThreshold => {
                let next = s.normal_threshold + if up { 5.0 } else { -5.0 };
                s.normal_threshold = next.clamp(*ANGLES.start(), *ANGLES.end());
            }
            Knob::Mode => s.mode = if up { Mode::Unbiased } else { Mode::Biased },
            Knob::Reservoirs => count(&mut s.reservoirs, up, &RESERVOIRS),
            Knob::Radius => amount(&mut s.radius, up, 5.0, &RADII),
            Knob::ConfidenceCap => amount(&mut s.confidence_cap, up, 5.0, &CAPS),
            Knob::Tiles => {
                s.tiles = match (s.tiles, up) {
                    (Tiles::Off, true) | (Tiles::On, false) => Tiles::Auto,
                    (_, true) => Tiles::On,
                    (_, false) => Tiles::Off,
                }
            }
        }
    }

    /// A step that changes something: up, or from the top down.
    pub fn toggle(self, s: &mut SettingsFile) {
        let before = s.clone();
        self.step(s, Step::Up);
        if *s == before {
            self.step(s, Step::Down);
        }
    }

    pub fn value(self, s: &SettingsFile) -> String {
        let switch = |on: bool| if on { "on" } else { "off" }.to_string();
        match self {
            Knob::Candidates => s.candidates.to_string(),
            Knob::BsdfCandidates => s.bsdf_candidates.to_string(),
            Knob::Visibility => switch(s.visibility),
            Knob::Temporal => switch(s.temporal),
            Knob::Spatial => switch(s.spatial),
            Knob::Iterations => s.iterations.to_string(),
            Knob::Neighbors => s.neighbors.to_string(),
            Knob::DepthThreshold => format!("{:.2}", s.depth_threshold),
            Knob::NormalThreshold => format!("{:.0}°", s.normal_threshold),
            Knob::Mode => if s.mode == Mode::Unbiased { "unbiased" } else { "biased" }.into(),
            Knob::Reservoirs => s.reservoirs.to_string(),
            Knob::Radius => format!("{:.0} px", s.radius),
            Knob::ConfidenceCap => format!("{:.0}", s.confidence_cap),
            Knob::Tiles => match s.tiles {
                Tiles::Auto => "auto",
                Tiles::On => "on",
                Tiles::Off => "off",
            }
            .into(),
        }
    }

    /// Is it a choice between two?
    pub fn is_switch(self) -> bool {
        matches!(self, Knob::Visibility | Knob::Temporal | Knob::Spatial | Knob::Mode)
    }

    pub fn about(self) -> About {
        match self {
            Knob::Candidates => About {
                name: "Light samples",
                unit: "candidates a reservoir, 1 to 1024, doubled or halved",
                meaning: "Lights that each pixel draws before it keeps one.",
                higher: "less noise; time grows with it",
                lower: "faster, noisier",
                bias: "none",
            },
            Knob::BsdfCandidates => About {
                name: "BSDF samples",
                unit: "rays a reservoir, 0 to 4",
                meaning: "Rays along the reflection that look for triangles and the environment.",
                higher: "less noise in smooth surfaces; a ray each",
                lower: "faster; 0: mirrors show specks",
                bias: "none; they act with visibility reuse only",
            },
            Knob::Visibility => About {
                name: "Visibility reuse",
                unit: "on or off",
                meaning: "A shadow ray drops a hidden sample before others reuse it.",
                higher: "far less noise in shadow; one more ray a reservoir",
                lower: "hidden lights spread and are found dark only when shaded",
                bias: "biased mode darkens near shadow edges; unbiased mode has none",
            },
            Knob::Temporal => About {
                name: "Temporal reuse",
                unit: "on or off",
                meaning: "Merges the reservoir that this surface had in the last frame.",
                higher: "the samples of many frames for the price of one",
                lower: "every frame by itself",
                bias: "biased mode: some where surfaces come into view; unbiased: none",
            },
            Knob::Spatial => About {
                name: "Spatial reuse",
                unit: "on or off",
                meaning: "Merges the reservoirs of neighboring pixels.",
                higher: "many times the samples; noise turns into blotches",
                lower: "every pixel by itself",
                bias: "biased mode darkens where neighbors see other lights; unbiased: none",
            },
            Knob::Iterations => About {
                name: "Spatial iterations",
                unit: "passes, 1 to 8",
                meaning: "How often the neighbors are merged.",
                higher: "samples come from further away; time grows with it",
                lower: "faster",
                bias: "biased mode: grows with it; unbiased: none",
            },
            Knob::Neighbors => About {
                name: "Neighbors",
                unit: "pixels each pass, 1 to 32",
                meaning: "How many neighbors each spatial pass asks.",
                higher: "less noise; time grows with it",
                lower: "faster",
                bias: "biased mode: grows with it; unbiased: none",
            },
            Knob::DepthThreshold => About {
                name: "Depth threshold",
                unit: "fraction of the distance to the camera",
                meaning: "How much nearer or further a neighbor may be.",
                higher: "more neighbors pass, also of other surfaces",
                lower: "fewer neighbors, more alike",
                bias: "biased mode: grows with it; unbiased: none",
            },
            Knob::NormalThreshold => About {
                name: "Normal threshold",
                unit: "degrees between normals",
                meaning: "How much a neighbor's normal may be turned.",
                higher: "more neighbors pass, also around corners",
                lower: "fewer neighbors, more alike",
                bias: "biased mode: grows with it; unbiased: none",
            },
            Knob::Mode => About {
                name: "Mode",
                unit: "biased or unbiased",
                meaning: "How reused reservoirs are weighted: 1/M, or pairwise MIS with the neighbors' visibility.",
                higher: "unbiased: the right mean, more rays",
                lower: "biased: faster, too dark where neighbors disagree",
                bias: "this is the choice",
            },
            Knob::Reservoirs => About {
                name: "Reservoirs",
                unit: "a pixel, 1 to 4",
                meaning: "Independent reservoirs, averaged by shading.",
                higher: "less noise; time and memory grow with it",
                lower: "faster",
                bias: "none",
            },
            Knob::Radius => About {
                name: "Radius",
                unit: "pixels",
                meaning: "Neighbors are drawn from a disk this large.",
                higher: "neighbors repeat less, but are less alike",
                lower: "neighbors more alike, blotches smaller and stronger",
                bias: "biased mode: grows with it; unbiased: none",
            },
            Knob::ConfidenceCap => About {
                name: "Confidence cap",
                unit: "times the light samples",
                meaning: "How many new samples a history may weigh at most.",
                higher: "smoother, slower to follow changes",
                lower: "follows changes at once, noisier",
                bias: "none in the mean; errors of neighboring frames are alike",
            },
            Knob::Tiles => About {
                name: "Light tiles",
                unit: "auto (from 4,096 lights on), on or off",
                meaning: "Draws light samples from small presampled lists.",
                higher: "faster with very many lights",
                lower: "each pixel draws from all lights",
                bias: "none; neighboring pixels share samples",
            },
        }
    }
}

fn count(value: &mut u32, up: bool, range: &RangeInclusive<u32>) {
    let next = if up { *value + 1 } else { value.saturating_sub(1) };
    *value = next.clamp(*range.start(), *range.end());
}

/// On multiples of `step`, so that what was typed on the command line comes back onto the grid.
fn amount(value: &mut f32, up: bool, step: f32, range: &RangeInclusive<f32>) {
    let at = *value / step;
    let next = if up { (at + 1e-3).floor() + 1.0 } else { (at - 1e-3).ceil() - 1.0 };
    *value = (next * step).clamp(*range.start(), *range.end());
}

/// Settings that are known by a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preset {
    Fast,
    Thesis,
    Unbiased,
    /// All lights of all pixels: the truth, accumulated.
    Reference,
}

impl Preset {
    pub const ALL: [Preset; 4] = [Preset::Fast, Preset::Thesis, Preset::Unbiased, Preset::Reference];

    pub fn name(self) -> &'static str {
        match self {
            Preset::Fast => "Fast",
            Preset::Thesis => "Thesis",
            Preset::Unbiased => "Unbiased",
            Preset::Reference => "Reference",
        }
    }

    pub fn about(self) -> &'static str {
        match self {
            Preset::Fast => "8 light samples, one spatial pass of 2 neighbors, biased",
            Preset::Thesis => "32 light samples, two spatial passes of 4 neighbors, 1/M weights",
            Preset::Unbiased => "the same with pairwise MIS: the right mean",
            Preset::Reference => "every light of every pixel, accumulated: the truth",
        }
    }

    /// None: the reference has no knobs.
    pub fn settings(self) -> Option<SettingsFile> {
        let thesis = SettingsFile::default();
        match self {
            Preset::Fast => Some(SettingsFile { candidates: 8, iterations: 1, neighbors: 2, ..thesis }),
            Preset::Thesis => Some(thesis),
            Preset::Unbiased => Some(SettingsFile { mode: Mode::Unbiased, ..thesis }),
            Preset::Reference => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All the way down and up again: every value is allowed, and both ends are reached.
    #[test]
    fn knobs_stay_in_their_ranges() {
        for knob in Knob::ALL {
            let mut settings = SettingsFile::default();
            for step in [Step::Down, Step::Up, Step::Down] {
                for _ in 0..100 {
                    knob.step(&mut settings, step);
                    settings.check().unwrap();
                }
                let end = settings.clone();
                knob.step(&mut settings, step);
                assert_eq!(settings, end, "{knob:?} has an end");
            }
        }
    }

    #[test]
    fn each_knob_changes_its_own_setting_only() {
        let default = SettingsFile::default();
        let mut seen = Vec::new();
        for knob in Knob::ALL {
            let mut settings = default.clone();
            knob.toggle(&mut settings);
            let changed: Vec<_> =
                Knob::ALL.into_iter().filter(|k| k.value(&settings) != k.value(&default)).collect();
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
            Knob::Candidates.step(&mut s, Step::Down);
            down.push(s.candidates);
        }
        assert_eq!(down, [16, 8, 4, 2, 1, 1]);
        for _ in 0..11 {
            Knob::Candidates.step(&mut s, Step::Up);
        }
        assert_eq!(s.candidates, 1024);
    }

    #[test]
    fn amounts_come_back_onto_their_grid() {
        let mut s = SettingsFile { radius: 32.0, ..SettingsFile::default() };
        Knob::Radius.step(&mut s, Step::Up);
        assert_eq!(s.radius, 35.0);
        Knob::Radius.step(&mut s, Step::Down);
        Knob::Radius.step(&mut s, Step::Down);
        assert_eq!(s.radius, 25.0);
    }

    #[test]
    fn presets_are_allowed_and_differ() {
        let all: Vec<_> = Preset::ALL.iter().filter_map(|p| p.settings()).collect();
        assert!(all.iter().all(|s| s.check().is_ok()));
        assert!(all[0] != all[1] && all[1] != all[2] && all[0] != all[2]);
    }
}
