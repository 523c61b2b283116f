//! Numbers about pictures and frames.

pub mod flip;
pub mod heatmap;
pub mod mean;
pub mod metrics;
pub mod report;
pub mod roofline;
pub mod statistics;
pub mod sweep;
pub mod times;
