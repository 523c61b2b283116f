//! The truth: a sum over every light, with no alias table and no reservoir, so that it can't share their faults.

use crate::light::{Light, LightSample};
use crate::math::safe_ratio;
use crate::shading::Proposal;
use crate::shadow::ShadowRay;
use crate::surface::Surface;
use crate::target::unshadowed;

/// The contribution of one light: exact for a point, an unbiased one-sample estimate for an area. `random`: the point.
pub fn propose(surface: &Surface, light: &Light, random: u32) -> Proposal {
    let square = LightSample { light: 0, uv: random }.square();
    let incident = light.sample_li(square, surface.position);
    Proposal {
        radiance: unshadowed(surface, &incident) * safe_ratio(1.0, light.pdf_li().0),
        ray: ShadowRay::new(surface, &incident),
    }
}
