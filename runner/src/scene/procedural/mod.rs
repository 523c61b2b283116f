//! Scenes and parts of scenes that are computed, not loaded.

pub mod atrium;
mod kit;
pub mod knot;
mod noise;
mod path;
pub mod scatter;
pub mod shapes;
pub mod town;
