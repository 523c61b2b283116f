//! Light that bounced more than once: paths that go on behind x2, of one pixel of each block of pixels, which answers for all.

use super::initial::area_found;
use super::lane;
use super::light::arriving;
use crate::alpha;
use crate::bounced::{Bounced, PathSample, reflected};
use crate::bsdf;
use crate::math::safe_ratio;
use crate::passes::{At, Visibility, Witness};
use crate::pdf::PdfSolidAngle;
use crate::points::ScenePoint;
use crate::resampling::initial::BsdfRay;
use crate::reservoir::{Reservoir, StoredPath};
use crate::rng::{Rng, Stream, unit_f32};
use crate::scene::Scene;
use crate::surface::{GBufferTexel, Surface};
use crate::target::unshadowed;
use crate::textures::Texels;
use glam::Vec3;

/// A path goes on with at most this probability, also where nothing absorbs.
const MOST_SURVIVAL: f32 = 0.95;

/// What a path gathers beyond x2.
#[derive(Clone, Copy, Default)]
struct Beyond {
    /// Direction from x2, unit, and its density, 1/sr.
    direction: Vec3,
    density: f32,
    /// Of what leaves the path's present point, the share that arrives at x2.
    weight: Vec3,
    /// What arrives at x2, nit.
    radiance: Vec3,
}

/// Shows the reservoir of a pixel that was picked a path which goes on behind its x2. `current`: as `indirect_initial`, or the level
/// before, left it.
///
/// Equation (37).
pub fn further<T: Texels>(
    at: At<'_>,
    mut rays: impl Visibility,
    mut note: impl Witness,
    source: Bounced<'_, T>,
    gbuffer: &[GBufferTexel],
    current: StoredPath,
) -> StoredPath {
    let point = current.sample.point();
    if point.is_none() {
        return current;
    }
    let level = at.constants.level;
    let first = at.surface(&at.texel(gbuffer));
    let reflector = source.reflector(point, first.position);
    let Bounced { table, scene, textures } = source;
    let mut rng = at.lane_rng(Stream::Further, lane::LEVELS + at.constants.iteration);
    let (mut surface, mut beyond) = (reflector.surface, Beyond::default());
    let mut points = 0;
    // Around a trace, see `Visibility`.
    while points < level.last {
        let key = alpha::key(rng.next_u32x4().x);
        let ray = BsdfRay::new(&surface, &mut rng);
        if !ray.is_worth_tracing(&surface) {
            break;
        }
        let hit = rays.nearest(ray.origin, ray.direction, key);
        if hit.hit == 0 {
            break;
        }
        let Some(next) = next(scene, textures, &surface, &ray, ScenePoint::from(hit), points, &mut beyond)
        else {
            break;
        };
        points += 1;
        surface = next;
        if points >= level.first {
            let light = arriving(at, &mut rays, &mut note, table, scene, &surface, key, &mut rng);
            if light.contribution_weight > 0.0 {
                let incident = table.incident(light.sample, surface.position);
                beyond.radiance +=
                    beyond.weight * unshadowed::<Vec3>(&surface, &incident) * light.contribution_weight;
            }
            if points < level.last && !survives(&mut beyond, &mut note, &mut rng) {
                break;
            }
        }
    }
    let most = beyond.radiance.max_element();
    if most <= 0.0 {
        return current;
    }
    let mut paths = Reservoir::<PathSample> { confidence: current.confidence, ..Reservoir::default() };
    let target = reflector.target(table, &first, current.sample);
    paths.add(current.sample, target, target * current.contribution_weight, 0.0, 0.0);
    let mut pixels = (level.side * level.side) as f32;
    note.answers(&mut pixels);
    let reflected = point.reflected(beyond.direction, beyond.radiance);
    let target = reflector.target(table, &first, reflected);
    let weight = pixels * area_found(&first, &reflector) * safe_ratio(most, beyond.density);
    paths.add(reflected, target, target * weight, 0.0, unit_f32(rng.next_u32x4().x));
    let finished = paths.finish(1.0);
    // x2 stays known.
    if finished.contribution_weight > 0.0 { finished } else { current }
}

/// The surface at `hit`, where a path goes on from `surface` along `ray`, if light is reflected all that way.
fn next(
    scene: Scene<'_>,
    textures: impl Texels,
    surface: &Surface,
    ray: &BsdfRay,
    hit: ScenePoint,
    points: u32,
    beyond: &mut Beyond,
) -> Option<Surface> {
    let Surface { reflectance, normal, wo, .. } = surface;
    let PdfSolidAngle(density) = bsdf::pdf(reflectance, *normal, *wo, ray.direction);
    let met = scene.met(textures, hit);
    if density <= 0.0 || !met.seen.reflects(-ray.direction) {
        return None;
    }
    if points == 0 {
        // f at x2 is the receiver's.
        *beyond = Beyond { direction: ray.direction, density, weight: Vec3::ONE, radiance: Vec3::ZERO };
    } else {
        beyond.weight *= reflected(surface, ray.direction) * safe_ratio(1.0, density);
    }
    Some(met.seen.surface(-ray.direction, met.magnitude))
}

/// Russian roulette (Arvo & Kirk 1990), by what no pixel has a part in.
fn survives(beyond: &mut Beyond, note: &mut impl Witness, rng: &mut Rng) -> bool {
    let mut survival = beyond.weight.max_element().min(MOST_SURVIVAL);
    if rng.next_f32() >= survival {
        return false;
    }
    note.survives(&mut survival);
    beyond.weight /= survival;
    true
}
