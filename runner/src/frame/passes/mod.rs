//! Declarations of all passes, one file each, named as their shaders are.

pub mod accumulate;
pub mod floor_copy;
pub mod floor_primary;
pub mod floor_shadow;
pub mod gbuffer;
pub mod gbuffer_raster;
pub mod initial;
pub mod initial_tiled;
pub mod pair_merge;
pub mod pair_targets;
pub mod presample;
pub mod reference;
pub mod shade;
pub mod shade_known;
pub mod spatial;
pub mod spatial_unbiased;
pub mod statistics;
pub mod temporal;
pub mod temporal_known;
pub mod temporal_moving;
pub mod temporal_unbiased;
pub mod temporal_unbiased_moving;
pub mod tonemap;
pub mod view;
pub mod visibility;

use super::pass::Pass;

/// All passes. Of passes with variants a frame takes one (`frame::schedule`, docs/architecture.md); `reference` stands in for all
/// from `initial` to shading. Those after `tonemap` follow where somebody asks for them: three are the viewer's, three measure floors.
pub const ALL: [&Pass; 25] = [
    &gbuffer::PASS,
    &visibility::PASS,
    &gbuffer_raster::PASS,
    &initial::PASS,
    &presample::PASS,
    &initial_tiled::PASS,
    &temporal::PASS,
    &spatial::PASS,
    &temporal_moving::PASS,
    &temporal_unbiased::PASS,
    &temporal_known::PASS,
    &temporal_unbiased_moving::PASS,
    &spatial_unbiased::PASS,
    &pair_targets::PASS,
    &pair_merge::PASS,
    &shade::PASS,
    &shade_known::PASS,
    &reference::PASS,
    &tonemap::PASS,
    &accumulate::PASS,
    &view::PASS,
    &statistics::PASS,
    &floor_primary::PASS,
    &floor_shadow::PASS,
    &floor_copy::PASS,
];
