//! Numbers about pictures and frames.

pub mod mean;
pub mod times;
