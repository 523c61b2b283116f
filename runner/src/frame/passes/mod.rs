//! Declarations of all passes, one file each, named as their shaders are.

pub mod gbuffer;
pub mod initial;
pub mod reference;
pub mod shade;
pub mod spatial;
pub mod temporal;
pub mod tonemap;

use super::pass::Pass;

/// All passes in the order of a frame; `reference` stands in for the four from `initial` to `shade`.
pub const ALL: [&Pass; 7] = [
    &gbuffer::PASS,
    &initial::PASS,
    &temporal::PASS,
    &spatial::PASS,
    &shade::PASS,
    &reference::PASS,
    &tonemap::PASS,
];
