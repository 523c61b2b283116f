//! The truth: every light with a shadow ray each, a range of lights at a time. No alias table and no reservoir, so that it can't
//! share their faults.

use super::{At, Question, Visibility, Witness};
use crate::alpha;
use crate::light::{Light, LightSample, Lights};
use crate::math::safe_ratio;
use crate::reflected::{Parts, Reflected};
use crate::rng::Stream;
use crate::shading::Contribution;
use crate::surface::{GBufferTexel, Surface};
use glam::Vec3;

/// `radiance`: of what was added before, nit.
pub fn reference(
    at: At<'_>,
    rays: impl Visibility,
    _: impl Witness,
    lights: &[Light],
    gbuffer: &[GBufferTexel],
    radiance: Vec3,
) -> Vec3 {
    radiance + lit::<Vec3>(at, rays, at.lights(lights), gbuffer)
}

/// The same light in [`Parts`]. `diffuse`, `specular`: of what was added before, nit; the first range starts anew.
pub fn reference_parts(
    at: At<'_>,
    rays: impl Visibility,
    _: impl Witness,
    lights: &[Light],
    gbuffer: &[GBufferTexel],
    diffuse: Vec3,
    specular: Vec3,
) -> (Vec3, Vec3) {
    let is_first = at.constants.first_light == 0;
    let mut sum = if is_first { Parts::default() } else { Parts { diffuse, specular } };
    sum += lit(at, rays, at.lights(lights), gbuffer);
    sum.apart()
}

/// What a range of lights brings to the pixel's surface.
fn lit<L: Reflected>(
    at: At<'_>,
    mut rays: impl Visibility,
    lights: Lights<'_>,
    gbuffer: &[GBufferTexel],
) -> L {
    let texel = at.texel(gbuffer);
    if texel.is_empty() {
        return L::default();
    }
    let surface = at.surface(&texel);
    let first = at.constants.first_light;
    let mut rng = at.lane_rng(Stream::Reference, first);
    let mut sum = L::default();
    let mut light = first;
    while light < first + at.constants.light_count {
        let random = rng.next_u32x4();
        let shaded = contribution::<L>(&surface, lights, light, random.x);
        let key = alpha::key(random.y);
        if !shaded.is_dark() && rays.sees(Question::Light, shaded.ray, key) {
            sum += shaded.radiance;
        }
        light += 1;
    }
    sum
}

/// The contribution of one light: exact for a delta light, an unbiased one-sample estimate for an area or a solid angle.
/// `random`: the point.
///
/// Equation (3): Bitterli (3); thesis (4.3), thesis (4.4), thesis (4.6), thesis (4.7), thesis (4.8), thesis (4.14).
fn contribution<L: Reflected>(
    surface: &Surface,
    lights: Lights<'_>,
    light: u32,
    random: u32,
) -> Contribution<L> {
    let incident = lights.incident(LightSample { light, uv: random }, surface.position);
    Contribution::new(surface, &incident, safe_ratio(1.0, lights.pdf_li(light).0))
}
