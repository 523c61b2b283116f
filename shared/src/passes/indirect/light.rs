//! Light that arrives at a point of a path: resampled, and seen.

use crate::frame::features;
use crate::light::LightTable;
use crate::light::found::Emitters;
use crate::passes::{At, Question, Technique, Visibility, Witness};
use crate::resampling::initial::{BsdfRay, Fresh, Techniques, candidate};
use crate::reservoir::StoredReservoir;
use crate::rng::Rng;
use crate::scene::Scene;
use crate::surface::Surface;

/// Light candidates at each point of a path.
const CANDIDATES: u32 = 8;

/// A light that lights `surface`, W of which is 0 where it is hidden. `key`: of the rays that ask, for [`crate::alpha`].
#[allow(clippy::too_many_arguments)]
pub fn arriving(
    at: At<'_>,
    rays: &mut impl Visibility,
    note: &mut impl Witness,
    table: LightTable<'_>,
    scene: Scene<'_>,
    surface: &Surface,
    key: u32,
    rng: &mut Rng,
) -> StoredReservoir {
    let aims = at.features & features::TRACEABLE != 0;
    let techniques = Techniques { lights: CANDIDATES, bsdf: if aims { 1 } else { 0 } };
    let mut fresh = Fresh::default();
    for _ in 0..techniques.lights {
        let mut drawn = candidate(surface, table, techniques, rng);
        note.draws(Technique::Table, &mut drawn);
        fresh.add(drawn);
    }
    if aims {
        let ray = BsdfRay::new(surface, rng);
        if ray.is_worth_tracing(surface) {
            let emitters = Emitters::new(at.frame, at.features, scene.instances, scene.environment);
            let hit = rays.nearest(ray.origin, ray.direction, key);
            let light = emitters.light_at(hit, ray.direction);
            let mut found = ray.candidate(surface, table, techniques, light, table.pdf(light));
            note.draws(Technique::Bsdf, &mut found);
            fresh.add_found(found);
        }
    }
    let survivor = fresh.finish(surface, table);
    survivor.kept(survivor.is_certain() || rays.sees(Question::Light, survivor.ray, key))
}
