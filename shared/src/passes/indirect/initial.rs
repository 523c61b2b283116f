//! Fresh paths: a ray along the reflectance, and resampled light where it ends.

use super::lane;
use super::light::arriving;
use crate::bounced::{Bounced, PathKey, PathPoint, PathSample, Reflector};
use crate::bsdf;
use crate::math::safe_ratio;
use crate::passes::{At, Visibility, Witness, variant};
use crate::pdf::PdfSolidAngle;
use crate::points::ScenePoint;
use crate::resampling::initial::BsdfRay;
use crate::reservoir::{Reservoir, StoredPath};
use crate::rng::{Stream, unit_f32};
use crate::surface::{GBufferTexel, Surface};
use crate::textures::Texels;

/// The path of a pixel. Where x2 is known its sample tells it, also where no light arrives there.
///
/// Equation (36).
pub fn initial<T: Texels>(
    at: At<'_>,
    mut rays: impl Visibility,
    mut note: impl Witness,
    source: Bounced<'_, T>,
    gbuffer: &[GBufferTexel],
    met: &[ScenePoint],
) -> StoredPath {
    let texel = at.texel(gbuffer);
    if texel.is_empty() {
        return StoredPath::default();
    }
    let first = at.surface(&texel);
    // A path that finds nothing is one that was drawn.
    let mut paths = Reservoir::<PathSample> { confidence: 1.0, ..Reservoir::default() };
    let mut rng = at.lane_rng(Stream::Indirect, lane::INITIAL);
    let random = rng.next_u32x4();
    let key = PathKey::new(random.x);
    let mut hit = ScenePoint::default();
    if at.is(variant::MET) {
        hit = met[at.frame.pixel_index(at.pixel) as usize];
    } else {
        let ray = BsdfRay::new(&first, &mut rng);
        if ray.is_worth_tracing(&first) {
            hit = rays.nearest(ray.origin, ray.direction, key.to_surface()).into();
        }
    }
    let point = PathPoint::new(hit, key);
    if point.is_none() {
        return paths.finish(1.0);
    }
    let reflector = source.reflector(point, first.position);
    let found = area_found(&first, &reflector);
    if found == 0.0 {
        return paths.finish(1.0);
    }
    let Bounced { table, scene, .. } = source;
    let key = key.to_light();
    let light = arriving(at, &mut rays, &mut note, table, scene, &reflector.surface, key, &mut rng);
    let lit = point.lit(light.sample);
    let target = reflector.target(table, &first, lit);
    let u = unit_f32(rng.next_u32x4().x);
    paths.add(lit, target, target * light.contribution_weight * found, 0.0, u);
    StoredPath { sample: lit, ..paths.finish(1.0) }
}

/// 1 / the density, per area of x2, with which a ray along the reflectance of `first` finds `reflector`, m².
pub fn area_found(first: &Surface, reflector: &Reflector) -> f32 {
    let direction = -reflector.surface.wo;
    let PdfSolidAngle(density) = bsdf::pdf(&first.reflectance, first.normal, first.wo, direction);
    safe_ratio(1.0, density * reflector.solid_angle)
}
