//! A frame: its passes, their order, their buffers, and how they are recorded.

#[doc(hidden)]
pub mod follow;
pub mod history;
#[doc(hidden)]
pub mod pass;
pub mod picture;
#[doc(hidden)]
pub mod pipelines;
#[doc(hidden)]
pub mod rays;
pub mod recorder;
pub mod renderer;
pub mod schedule;
#[doc(hidden)]
pub mod targets;
