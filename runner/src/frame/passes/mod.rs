//! Declarations of all passes, one file each, named as their shaders are.

pub mod gbuffer;
pub mod initial;
pub mod initial_tiled;
pub mod presample;
pub mod reference;
pub mod shade;
pub mod spatial;
pub mod spatial_unbiased;
pub mod temporal;
pub mod temporal_unbiased;
pub mod tonemap;

use super::pass::Pass;

/// All passes. A frame takes either the biased or the unbiased pair of reuse passes; `reference` stands in for all from `initial`
/// to `shade`.
pub const ALL: [&Pass; 11] = [
    &gbuffer::PASS,
    &initial::PASS,
    &presample::PASS,
    &initial_tiled::PASS,
    &temporal::PASS,
    &spatial::PASS,
    &temporal_unbiased::PASS,
    &spatial_unbiased::PASS,
    &shade::PASS,
    &reference::PASS,
    &tonemap::PASS,
];
