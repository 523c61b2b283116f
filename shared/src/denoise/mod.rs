//! Denoising of a finished frame, for display: never in what is measured.
//!
//! What is filtered is light in parts ([`crate::reflected::Parts`]): diffuse light without its albedo, and specular light.
//! 1. `denoise_temporal`: the mean of each surface point over frames ([`Smoothed`]). Points last while the camera moves
//!    ([`crate::points`]), so a mean is that of a point, not of a pixel: nothing is blurred by resampling, color included.
//! 2. `denoise_variance`: how far light differs from pixel to pixel around ([`Filtered`]). Frames that reuse one another's samples
//!    hardly differ in time, so a variance over time would be far too small.
//! 3. `denoise_spatial`, with steps of 1, 2, 4 and 8 pixels: an à-trous filter (Dammertz et al. 2010) between pixels that see
//!    one surface. *Luminance* is mixed where it differs by less than the variance explains (Schied et al. 2017, SVGF); *color*
//!    wherever the surface goes on. Reuse gives each pixel the right luminance from a single light: its color is that light's
//!    alone, and that noise, which no measure of luminance sees, is most of what the eye sees.
//! 4. `resolve_denoised`: emission + albedo x diffuse + specular.

mod color;
mod guide;
mod smoothed;

pub use color::{colored, pack_color, unpack_color};
pub use guide::{Guide, PackedGuide};
pub use smoothed::{Smoothed, clamped, share};

use bytemuck::{Pod, Zeroable};
use glam::{UVec4, Vec3};

/// Times the spatial filter runs; its step is 2^i pixels.
pub const ITERATIONS: u32 = 4;

/// A pixel between two runs of the spatial filter. 32 bytes, which are loaded by 16: ordered by words, a load would take four times as
/// long. All zero: no surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Filtered {
    /// Luminance of diffuse light, nit, f32 bits | deviation, nit, 16 bits, and plane, 16 bits | normal | depth of [`PackedGuide`].
    surface: UVec4,
    /// Diffuse and specular light, filtered for the sake of their colors, see [`pack_color`].
    colors: UVec4,
}

impl Filtered {
    /// Colors in nit.
    pub fn new(guide: PackedGuide, luminance: f32, diffuse: Vec3, specular: Vec3) -> Self {
        let PackedGuide { normal, plane, depth } = guide;
        let ([a, b], [c, d]) = (pack_color(diffuse), pack_color(specular));
        Filtered {
            surface: UVec4::new(luminance.to_bits(), plane, normal, depth),
            colors: UVec4::new(a, b, c, d),
        }
    }

    /// Does the pixel see nothing that reflects?
    pub fn is_empty(&self) -> bool {
        self.surface.w == 0
    }

    /// What tells whether surfaces go on.
    pub fn guide(&self) -> PackedGuide {
        PackedGuide { normal: self.surface.z, plane: self.surface.y & 0xffff, depth: self.surface.w }
    }

    /// Of diffuse light, nit.
    pub fn luminance(&self) -> f32 {
        f32::from_bits(self.surface.x)
    }

    /// By how much the luminance may differ from a neighbor's, nit; it keeps 8 bits.
    pub fn deviation(&self) -> f32 {
        f32::from_bits(self.surface.y & 0xffff_0000)
    }

    /// The same with another [`Filtered::deviation`], nit.
    pub fn with_deviation(mut self, deviation: f32) -> Self {
        self.surface.y = self.surface.y & 0xffff | deviation.to_bits() & 0xffff_0000;
        self
    }

    /// nit
    pub fn diffuse(&self) -> Vec3 {
        unpack_color([self.colors.x, self.colors.y])
    }

    /// nit
    pub fn specular(&self) -> Vec3 {
        unpack_color([self.colors.z, self.colors.w])
    }
}

#[cfg(test)]
mod tests;
