//! Knobs that take one of a few words.

use crate::frame::schedule::Primary;
use serde::{Deserialize, Serialize};
use shared::antialias::PixelFilter;
use shared::frame::{indirect, mode};

/// One of a few words, from the lowest to the highest.
pub trait Choice: Copy + PartialEq + 'static {
    /// From the lowest to the highest.
    const ALL: &'static [Self];
    /// Of each: as people type it, and what it means.
    const WORDS: &'static [(&'static str, &'static str)];

    /// What people type for it.
    fn word(self) -> &'static str {
        Self::ALL.iter().zip(Self::WORDS).find(|(choice, _)| **choice == self).map_or("", |(_, word)| word.0)
    }

    /// The one that `word` stands for.
    fn from_word(word: &str) -> Option<Self> {
        Self::ALL.iter().zip(Self::WORDS).find(|(_, known)| known.0 == word).map(|(&choice, _)| choice)
    }
}

/// How reused reservoirs are weighted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mode {
    /// By 1/M: fast, too dark where pixels disagree.
    Biased,
    /// By pairwise MIS.
    Unbiased,
}

impl Choice for Mode {
    const ALL: &'static [Self] = &[Mode::Biased, Mode::Unbiased];
    const WORDS: &'static [(&'static str, &'static str)] = &[
        ("biased", "1/M weights (Bitterli et al. 2020, Alg. 4): fast, darkens where neighbors disagree"),
        ("unbiased", "Pairwise MIS with the neighbors' visibility: the right mean, more rays"),
    ];
}

/// The field of [`shared::frame::Settings`].
impl From<Mode> for u32 {
    fn from(mode: Mode) -> u32 {
        match mode {
            Mode::Biased => mode::BIASED,
            Mode::Unbiased => mode::UNBIASED,
        }
    }
}

/// Light after one or more reflections.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Indirect {
    /// None.
    Off,
    /// Reflected once.
    One,
    /// Reflected as often as it goes.
    Full,
}

impl Choice for Indirect {
    const ALL: &'static [Self] = &[Indirect::Off, Indirect::One, Indirect::Full];
    const WORDS: &'static [(&'static str, &'static str)] = &[
        ("off", "Direct light alone"),
        ("one", "Light reflected once, as `reference --bounces 1`"),
        ("full", "Light reflected any number of times, as `reference --bounces inf`"),
    ];
}

/// The field of [`shared::frame::Settings`].
impl From<Indirect> for u32 {
    fn from(indirect: Indirect) -> u32 {
        match indirect {
            Indirect::Off => indirect::OFF,
            Indirect::One => indirect::ONE,
            Indirect::Full => indirect::FULL,
        }
    }
}

/// A switch that can decide for itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Auto {
    /// Never.
    Off,
    /// By the number of lights.
    Auto,
    /// Always.
    On,
}

impl Choice for Auto {
    const ALL: &'static [Self] = &[Auto::Off, Auto::Auto, Auto::On];
    const WORDS: &'static [(&'static str, &'static str)] = &[("off", ""), ("auto", ""), ("on", "")];
}

impl Auto {
    /// Is it, where `by_itself` is what the lights decide?
    pub fn is_on(self, by_itself: bool) -> bool {
        match self {
            Auto::Off => false,
            Auto::Auto => by_itself,
            Auto::On => true,
        }
    }
}

impl Choice for PixelFilter {
    const ALL: &'static [Self] = &[PixelFilter::Box, PixelFilter::Gaussian, PixelFilter::BlackmanHarris];
    const WORDS: &'static [(&'static str, &'static str)] = &[
        ("box", "The pixel, evenly"),
        ("gaussian", "A standard deviation of 0.45 pixels, up to 1 pixel away"),
        ("blackman-harris", "Over 1.5 pixels"),
    ];
}

impl Choice for Primary {
    const ALL: &'static [Self] = &[Primary::Rays, Primary::Auto, Primary::Raster];
    const WORDS: &'static [(&'static str, &'static str)] = &[
        ("rays", "A ray a pixel"),
        ("auto", "The faster one, as measured: `raster` on processors, `rays` on other devices"),
        ("raster", "The graphics pipeline draws the scene"),
    ];
}
