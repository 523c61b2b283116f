//! The truth: every light with a shadow ray each, a range of lights at a time. No alias table and no reservoir, so that it can't
//! share their faults.

use super::{At, Question, Visibility, Witness};
use crate::alpha;
use crate::light::{Light, LightSample, Lights};
use crate::math::safe_ratio;
use crate::rng::Stream;
use crate::shading::Contribution;
use crate::shadow::ShadowRay;
use crate::surface::{GBufferTexel, Surface};
use crate::target::unshadowed;
use glam::Vec3;

/// `radiance`: of what was added before, nit.
pub fn reference(
    at: At<'_>,
    mut rays: impl Visibility,
    _: impl Witness,
    lights: &[Light],
    gbuffer: &[GBufferTexel],
    radiance: Vec3,
) -> Vec3 {
    let texel = at.texel(gbuffer);
    if texel.is_empty() {
        return radiance;
    }
    let surface = at.surface(&texel);
    let lights = at.lights(lights);
    let first = at.constants.first_light;
    let mut rng = at.lane_rng(Stream::Reference, first);
    let mut sum = Vec3::ZERO;
    let mut light = first;
    while light < first + at.constants.light_count {
        let random = rng.next_u32x4();
        let shaded = contribution(&surface, lights, light, random.x);
        let key = alpha::key(random.y);
        if !shaded.is_dark() && rays.sees(Question::Light, shaded.ray, key) {
            sum += shaded.radiance;
        }
        light += 1;
    }
    radiance + sum
}

/// The contribution of one light: exact for a delta light, an unbiased one-sample estimate for an area or a solid angle.
/// `random`: the point.
///
/// Equation (3): Bitterli (3); thesis (4.3), thesis (4.4), thesis (4.6), thesis (4.7), thesis (4.8), thesis (4.14).
fn contribution(surface: &Surface, lights: Lights<'_>, light: u32, random: u32) -> Contribution {
    let incident = lights.incident(LightSample { light, uv: random }, surface.position);
    Contribution {
        radiance: unshadowed(surface, &incident) * safe_ratio(1.0, lights.pdf_li(light).0),
        ray: ShadowRay::new(surface, &incident),
    }
}
