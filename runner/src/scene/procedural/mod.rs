//! Scenes and parts of scenes that are computed, not loaded.

pub mod atrium;
pub mod knot;
pub mod scatter;
pub mod shapes;
