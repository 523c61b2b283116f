//! Merges the reservoirs of neighboring pixels: by 1/M (Bitterli et al. 2020, Alg. 4), or by pairwise MIS with up to one ray from a
//! neighbor to the canonical sample and one from this pixel to the survivor.

use super::{At, Question, Visibility, Witness, variant};
use crate::alias_table::AliasEntry;
use crate::alpha::SURE_HITS_ONLY;
use crate::light::Light;
use crate::resampling::spatial::{OneRayMerge, confidence_of_neighbors, next_neighbor};
use crate::resampling::{
    CrossProposal, Pixels, Survivor, UniformMerge, confidence, reservoir_index, target_of,
};
use crate::reservoir::StoredReservoir;
use crate::rng::Stream;
use crate::surface::GBufferTexel;

/// The pixel's reservoir, merged with those of neighbors.
#[allow(clippy::too_many_arguments)]
pub fn spatial<V: Visibility>(
    at: At<'_>,
    mut rays: V,
    mut note: impl Witness,
    lights: &[Light],
    alias: &[AliasEntry],
    gbuffer: &[GBufferTexel],
    reservoirs: &[StoredReservoir],
) -> StoredReservoir {
    let (frame, pixel) = (at.frame, at.pixel);
    let settings = &frame.settings;
    let texel = at.texel(gbuffer);
    if texel.is_empty() {
        return StoredReservoir::default();
    }
    let surface = at.surface(&texel);
    let table = at.light_table(lights, alias);
    let pixels = Pixels { gbuffer, reservoirs };
    let mut rng = at.repeated_rng(Stream::Spatial);
    let canonical = reservoirs[reservoir_index(frame, pixel, at.lane) as usize];
    let target = target_of(&surface, table, canonical);
    // Without rays there is no other way.
    if !V::TRACES || !at.is(variant::UNBIASED) {
        let mut merge = UniformMerge::default();
        note.merged_canonical(canonical, target, merge.add(canonical, target, rng.next_f32()));
        for _ in 0..settings.neighbors {
            let (place, [u, _]) = next_neighbor(frame, &surface, gbuffer, pixel, &mut rng, &mut note);
            if let Some(place) = place {
                let neighbor = reservoirs[reservoir_index(frame, place, at.lane) as usize];
                let target = target_of(&surface, table, neighbor);
                note.merged(neighbor, target, merge.add(neighbor, target, u));
            }
        }
        return merge.finish();
    }
    let others = confidence_of_neighbors(frame, &surface, pixels, pixel, at.lane, rng);
    let mut merge = OneRayMerge::new(settings, canonical, target, others);
    for _ in 0..settings.neighbors {
        let (place, [u, v]) = next_neighbor(frame, &surface, gbuffer, pixel, &mut rng, &mut note);
        if let Some(place) = place {
            let neighbor = reservoirs[reservoir_index(frame, place, at.lane) as usize];
            let neighbor = confidence::of_neighbor(settings, neighbor);
            let texel = gbuffer[frame.pixel_index(place) as usize];
            let there = texel.unpack(at.features, &frame.camera, place, frame.size);
            let mut cross = CrossProposal::new(table, &surface, canonical, &there, neighbor);
            note.cross(&mut cross);
            let added = merge.add(cross, u, v);
            note.merged(neighbor, cross.targets.neighbor_at_canonical, added.weighed);
            note.pending(added.pending, added.asked);
        }
    }
    let asks = settings.visibility_is_known();
    let seen = !asks || merge.is_certain() || rays.sees(Question::Neighbor, merge.ray, SURE_HITS_ONLY);
    let mut merge = merge.resolved(seen);
    note.merged_canonical(canonical, target, merge.add_canonical(rng.next_f32()));
    let merged = confidence::with_neighbors(settings, canonical.confidence, merge.finish());
    let survivor = Survivor::merged(&surface, table, canonical, merged);
    let visible =
        !asks || survivor.is_certain() || rays.sees(Question::Survivor, survivor.ray, SURE_HITS_ONLY);
    survivor.kept(visible)
}
