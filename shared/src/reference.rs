//! The truth: a sum over every light, with no alias table and no reservoir, so that it can't share their faults.

use crate::light::{LightSample, Lights};
use crate::math::safe_ratio;
use crate::shading::Proposal;
use crate::shadow::ShadowRay;
use crate::surface::Surface;
use crate::target::unshadowed;

/// The contribution of one light: exact for a delta light, an unbiased one-sample estimate for an area or a solid angle.
/// `random`: the point.
///
/// Equation (3): Bitterli (3); thesis (4.3), thesis (4.4), thesis (4.6), thesis (4.7), thesis (4.8), thesis (4.14).
pub fn propose(surface: &Surface, lights: Lights<'_>, light: u32, random: u32) -> Proposal {
    let incident = lights.incident(LightSample { light, uv: random }, surface.position);
    Proposal {
        radiance: unshadowed(surface, &incident) * safe_ratio(1.0, lights.pdf_li(light).0),
        ray: ShadowRay::new(surface, &incident),
    }
}
