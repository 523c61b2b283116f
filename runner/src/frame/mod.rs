//! A frame: its passes, their order, their buffers, and how they are recorded.

pub mod follow;
pub mod history;
pub mod pass;
pub mod picture;
pub mod pipelines;
pub mod rays;
pub mod recorder;
pub mod renderer;
pub mod schedule;
pub mod targets;
