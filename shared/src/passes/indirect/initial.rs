//! Fresh paths: a ray along the reflectance, resampled light where it ends, and further bounces.

use super::lane;
use crate::alpha;
use crate::bounced::{Bounced, PathKey, PathPoint, PathSample, Reflector, reflected};
use crate::bsdf;
use crate::frame::features;
use crate::interface::HitPayload;
use crate::light::LightTable;
use crate::light::found::Emitters;
use crate::math::safe_ratio;
use crate::passes::{At, Question, Technique, Visibility, Witness, variant};
use crate::pdf::PdfSolidAngle;
use crate::points::ScenePoint;
use crate::resampling::initial::{BsdfRay, Fresh, Techniques, candidate};
use crate::reservoir::{Reservoir, StoredPath, StoredReservoir};
use crate::rng::{Rng, Stream, unit_f32};
use crate::scene::Scene;
use crate::surface::{GBufferTexel, Surface};
use crate::target::{target_function, unshadowed};
use crate::textures::Texels;
use glam::Vec3;

/// Light candidates at each point of a path.
pub const CANDIDATES: u32 = 8;
/// Reflections after which Russian roulette begins, counted from the light that reaches the pixel's surface.
const SURE_BOUNCES: u32 = 2;
/// A path goes on with at most this probability then, also where nothing absorbs.
const MOST_SURVIVAL: f32 = 0.95;
/// No path has more points: 0.95^1000 of them would.
pub const LONGEST: u32 = 1000;

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

/// The path of a pixel.
///
/// Equation (36).
pub fn initial<T: Texels>(
    at: At<'_>,
    mut rays: impl Visibility,
    mut note: impl Witness,
    source: Bounced<'_, T>,
    gbuffer: &[GBufferTexel],
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
    let ray = BsdfRay::new(&first, &mut rng);
    if !ray.is_worth_tracing(&first) {
        return paths.finish(1.0);
    }
    let point = PathPoint::new(rays.nearest(ray.origin, ray.direction, key.to_surface()), key);
    if point.is_none() {
        return paths.finish(1.0);
    }
    let reflector = source.reflector(point, first.position);
    let direction = -reflector.surface.wo;
    let density = bsdf::pdf(&first.reflectance, first.normal, first.wo, direction);
    let PdfSolidAngle(density) = density;
    // Per area of x2.
    let mut found = safe_ratio(1.0, density * reflector.solid_angle);
    note.reaches(&mut found);
    if found == 0.0 {
        return paths.finish(1.0);
    }
    let Bounced { table, scene, textures } = source;
    let emitters = Emitters::new(at.frame, at.features, scene.instances, scene.environment);
    let techniques =
        Techniques { lights: CANDIDATES, bsdf: if at.features & features::TRACEABLE != 0 { 1 } else { 0 } };
    let goes_on = at.is(variant::FURTHER);
    let (mut surface, mut beyond, mut light) =
        (reflector.surface, Beyond::default(), StoredReservoir::default());
    let mut points = 0;
    // Around a trace, see `Visibility`.
    while points < LONGEST {
        let key = if points == 0 { key.to_light() } else { alpha::key(rng.next_u32x4().x) };
        let mut fresh = Fresh::default();
        for _ in 0..techniques.lights {
            let mut drawn = candidate(&surface, table, techniques, &mut rng);
            note.draws(Technique::Table, &mut drawn);
            fresh.add(drawn);
        }
        let ray = BsdfRay::new(&surface, &mut rng);
        let aims = (goes_on | (techniques.bsdf != 0)) && ray.is_worth_tracing(&surface);
        let hit = if aims { rays.nearest(ray.origin, ray.direction, key) } else { HitPayload::default() };
        if aims && techniques.bsdf != 0 {
            let met = emitters.light_at(hit, ray.direction);
            let source_pdf = table.pdf(met);
            let mut candidate = ray.candidate(&surface, table, techniques, met, source_pdf);
            note.draws(Technique::Bsdf, &mut candidate);
            fresh.add_found(candidate);
        }
        let survivor = fresh.finish(&surface, table);
        let visible = survivor.is_certain() || rays.sees(Question::Light, survivor.ray, key);
        let kept = survivor.kept(visible);
        if points == 0 {
            light = kept;
        } else if kept.contribution_weight > 0.0 {
            let incident = table.incident(kept.sample, surface.position);
            beyond.radiance +=
                beyond.weight * unshadowed::<Vec3>(&surface, &incident) * kept.contribution_weight;
        }
        if !goes_on || !aims || hit.hit == 0 {
            break;
        }
        let Some(next) = further(scene, textures, &surface, &ray, ScenePoint::from(hit), points, &mut beyond)
        else {
            break;
        };
        points += 1;
        if points > SURE_BOUNCES && !survives(&mut beyond, &mut note, &mut rng) {
            break;
        }
        surface = next;
    }
    let random = rng.next_u32x4();
    let lit = point.lit(light.sample);
    let target = target_of(table, &first, &reflector, lit);
    paths.add(lit, target, target * light.contribution_weight * found, 0.0, unit_f32(random.x));
    let most = beyond.radiance.max_element();
    if goes_on && most > 0.0 {
        let reflected = point.reflected(beyond.direction, beyond.radiance);
        let target = target_of(table, &first, &reflector, reflected);
        let weight = found * safe_ratio(most, beyond.density);
        paths.add(reflected, target, target * weight, 0.0, unit_f32(random.y));
    }
    paths.finish(1.0)
}

/// p̂ at `first`, which sees `reflector`.
fn target_of(table: LightTable<'_>, first: &Surface, reflector: &Reflector, sample: PathSample) -> f32 {
    target_function(first, &reflector.incident(reflector.radiance(table, sample)))
}

/// The surface at `hit`, where a path goes on from `surface` along `ray`, if light is reflected all that way.
fn further(
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
