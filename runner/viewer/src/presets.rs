//! Named settings.

use candela::knobs::{Auto, Knobs, Mode};

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
            Preset::Fast => "8 light samples, reuse over time alone: the right mean with the fewest rays",
            Preset::Thesis => {
                "32 light samples, two spatial passes of 4 neighbors within 30 pixels, 1/M weights: too dark in shadows"
            }
            Preset::Unbiased => {
                "the defaults: pairs of near pixels merged once, pairwise MIS, the right mean"
            }
            Preset::Reference => "every light of every pixel, accumulated: the truth",
        }
    }

    /// None: the reference has no knobs.
    pub fn settings(self) -> Option<Knobs> {
        let unbiased = Knobs::default();
        match self {
            Preset::Fast => Some(Knobs { candidates: 8, spatial: false, ..unbiased }),
            Preset::Thesis => {
                Some(Knobs { cells: Auto::Off, mode: Mode::Biased, iterations: 2, radius: 30.0, ..unbiased })
            }
            Preset::Unbiased => Some(unbiased),
            Preset::Reference => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_are_allowed_and_differ() {
        let all: Vec<_> = Preset::ALL.iter().filter_map(|p| p.settings()).collect();
        assert!(all.iter().all(|s| s.check().is_ok()));
        assert!(all[0] != all[1] && all[1] != all[2] && all[0] != all[2]);
    }
}
