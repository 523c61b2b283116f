//! GPU entry points, one file a pass; in the order of a frame: [`gbuffer`] (or [`visibility`] and [`gbuffer_raster`]),
//! [`initial`], [`temporal`], [`spatial`], [`shade`], [`tonemap`]. An entry loads, calls `shared`, stores: no arithmetic. Rays are traced here and nowhere else.
#![cfg_attr(target_arch = "spirv", no_std)]
// An entry's arguments are its bindings.
#![allow(clippy::too_many_arguments)]

pub mod accumulate;
pub mod floors;
pub mod gbuffer;
pub mod gbuffer_raster;
pub mod hit;
pub mod initial;
pub mod initial_tiled;
pub mod pair_merge;
pub mod pair_targets;
pub mod presample;
pub mod primary;
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
pub mod textures;
pub mod tonemap;
pub mod trace;
pub mod view;
pub mod visibility;
