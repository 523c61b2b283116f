//! What a pass's rays and bytes need of the hardware, without the pass: stored rays traced again, and a copy.

use super::{At, Question, Visibility, Witness};
use crate::resources::Extent;
use crate::stored_ray::StoredRay;
use crate::surface::GBufferTexel;

/// 1 where a stored shadow ray meets anything.
pub fn roofline_shadow(at: At<'_>, mut rays: impl Visibility, _: impl Witness, stored: &[StoredRay]) -> u32 {
    let ray = stored[at.index(Extent::Pixels)];
    u32::from(ray.traced != 0 && !rays.sees(Question::Shade, ray.shadow(), ray.key))
}

/// The G-buffer, copied to that of the previous frame.
pub fn roofline_copy(at: At<'_>, gbuffer: &[GBufferTexel]) -> GBufferTexel {
    gbuffer[at.index(Extent::Pixels)]
}
