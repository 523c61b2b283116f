//! Declarations of all passes, one file each, named as their shaders are.

pub mod accumulate;
pub mod gbuffer;
pub mod initial;
pub mod initial_tiled;
pub mod presample;
pub mod reference;
pub mod shade;
pub mod spatial;
pub mod spatial_unbiased;
pub mod statistics;
pub mod temporal;
pub mod temporal_unbiased;
pub mod tonemap;
pub mod view;

use super::pass::Pass;

/// All passes. A frame takes either the biased or the unbiased pair of reuse passes; `reference` stands in for all from `initial`
/// to `shade`. The last three are the viewer's: they follow where it asks for them.
pub const ALL: [&Pass; 14] = [
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
    &accumulate::PASS,
    &view::PASS,
    &statistics::PASS,
];
