//! Passes of [`crate::denoise`].

mod spatial;
mod temporal;

pub use spatial::{denoise_spatial, denoise_variance, resolve_denoised};
pub use temporal::denoise_temporal;
