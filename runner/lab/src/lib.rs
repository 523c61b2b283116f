//! Measurements for Candela: error metrics, sweeps and their reports, rooflines ([`measure`]), and pixels replayed on the CPU
//! ([`explain`]).

pub mod explain;
pub mod measure;
