//! Fresh candidates for a reservoir, from the lights and along the reflectance: streaming RIS (Bitterli et al. 2020, Alg. 3); and
//! visibility reuse (Alg. 5).

use super::{At, Question, Technique, Visibility, Witness, variant};
use crate::alias_table::AliasEntry;
use crate::alpha::SURE_HITS_ONLY;
use crate::cells::list::ListEntry;
use crate::cells::{self as world_cells, Cell, cell_of};
use crate::environment::EnvironmentTexel;
use crate::geometry::InstanceGeometry;
use crate::light::Light;
use crate::light::found::Emitters;
use crate::light::tile::{TileEntry, Tiles, tile_of};
use crate::light::tree::TreeNode;
use crate::motion::NO_LIGHT;
use crate::points::ScenePoint;
use crate::resampling::initial::{
    BsdfRay, Fresh, Techniques, candidate, candidate_at_place, numbers_from_tile, place_in_pool,
    place_in_tile,
};
use crate::reservoir::StoredReservoir;
use crate::rng::Stream;
use crate::surface::GBufferTexel;
use glam::UVec4;

/// The pass, and what it gives of its reservoir and of what its last BSDF ray met.
macro_rules! fresh {
    ($(#[$doc:meta])* $name:ident -> $out:ty = |$reservoir:ident, $met:ident| $result:expr) => {
        $(#[$doc])*
        #[allow(clippy::too_many_arguments)]
        pub fn $name(
            at: At<'_>,
            rays: impl Visibility,
            note: impl Witness,
            lights: &[Light],
            alias: &[AliasEntry],
            tree_nodes: &[TreeNode],
            tree_lights: &[u32],
            tree_leaves: &[u32],
            instances: &[InstanceGeometry],
            environment: &[EnvironmentTexel],
            gbuffer: &[GBufferTexel],
            tile_entries: &[TileEntry],
            tile_points: &[u32],
            cells: &[Cell],
            lists: &[ListEntry],
            beliefs: &[u32],
            pool_entries: &[TileEntry],
            pool_points: &[u32],
        ) -> $out {
            let ($reservoir, $met) = filled(
                at, rays, note, lights, alias, tree_nodes, tree_lights, tree_leaves, instances, environment, gbuffer, tile_entries,
                tile_points, cells, lists, beliefs, pool_entries, pool_points,
            );
            $result
        }
    };
}

fresh! {
    /// A reservoir of fresh candidates.
    initial -> StoredReservoir = |reservoir, _met| reservoir
}

fresh! {
    /// The same, and what its BSDF ray met: light that bounces comes along it too.
    initial_met -> (StoredReservoir, ScenePoint) = |reservoir, met| (reservoir, met)
}

#[allow(clippy::too_many_arguments)]
fn filled(
    at: At<'_>,
    mut rays: impl Visibility,
    mut note: impl Witness,
    lights: &[Light],
    alias: &[AliasEntry],
    tree_nodes: &[TreeNode],
    tree_lights: &[u32],
    tree_leaves: &[u32],
    instances: &[InstanceGeometry],
    environment: &[EnvironmentTexel],
    gbuffer: &[GBufferTexel],
    tile_entries: &[TileEntry],
    tile_points: &[u32],
    cells: &[Cell],
    lists: &[ListEntry],
    beliefs: &[u32],
    pool_entries: &[TileEntry],
    pool_points: &[u32],
) -> (StoredReservoir, ScenePoint) {
    let texel = at.texel(gbuffer);
    if texel.is_empty() {
        return Default::default();
    }
    let surface = at.surface(&texel);
    let table = at.light_table(lights, alias);
    let settings = &at.frame.settings;
    let techniques = Techniques::new(settings, at.features);
    let mut rng = at.rng(Stream::Initial);
    let mut fresh = Fresh::default();
    let mut place = 0;
    if at.is(variant::CELLS) {
        place = cell_of(at.frame, &surface, at.pixel);
        note.tile(place);
        let pool_size = world_cells::pool(at.frame);
        let pool = Tiles { entries: pool_entries, points: pool_points };
        for i in 0..techniques.lights {
            let random = rng.next_u32x4();
            let entry = place_in_pool(place, pool_size, i, techniques, random.x);
            let mut drawn = candidate_at_place(&surface, table, techniques, pool, entry, random.y);
            note.draws(Technique::Pool, &mut drawn);
            let stays = fresh.add(drawn);
            note.candidate(Technique::Pool, &drawn, &fresh, stays);
        }
        fresh = fresh.looked_up(pool);
    } else if at.is(variant::TILED) {
        let tiles = Tiles { entries: tile_entries, points: tile_points };
        let tile = tile_of(at.frame, at.pixel, at.lane);
        note.tile(tile);
        let mut random = UVec4::ZERO;
        for i in 0..techniques.lights {
            random = numbers_from_tile(i, random, &mut rng);
            let entry = place_in_tile(tile, random.x);
            let mut drawn = candidate_at_place(&surface, table, techniques, tiles, entry, random.y);
            note.draws(Technique::Tile, &mut drawn);
            let stays = fresh.add(drawn);
            note.candidate(Technique::Tile, &drawn, &fresh, stays);
        }
        fresh = fresh.looked_up(tiles);
    } else {
        for _ in 0..techniques.lights {
            let mut drawn = candidate(&surface, table, techniques, &mut rng);
            note.draws(Technique::Table, &mut drawn);
            let stays = fresh.add(drawn);
            note.candidate(Technique::Table, &drawn, &fresh, stays);
        }
    }
    let emitters = Emitters::new(at.frame, at.features, instances, environment);
    let mut met = ScenePoint::default();
    // Around a trace, see `Visibility`.
    let mut i = 0;
    while i < techniques.bsdf {
        let ray = BsdfRay::new(&surface, &mut rng);
        if ray.is_worth_tracing(&surface) {
            let hit = rays.nearest(ray.origin, ray.direction, SURE_HITS_ONLY);
            met = hit.into();
            let light = emitters.light_at(hit, ray.direction);
            note.bsdf_ray(&ray, hit, light);
            let source_pdf = if at.is(variant::CELLS) {
                let tree = at.light_tree(tree_nodes, tree_lights, tree_leaves);
                at.sources(table, tree, cells, lists, beliefs, place).pdf(light)
            } else {
                table.pdf(light)
            };
            let mut found = ray.candidate(&surface, table, techniques, light, source_pdf);
            note.draws(Technique::Bsdf, &mut found);
            let stays = fresh.add_found(found);
            note.candidate(Technique::Bsdf, &found, &fresh, stays);
        }
        i += 1;
    }
    let mut survivor = fresh.finish(&surface, table);
    if at.is(variant::CELLS) && fresh.reservoir.weight_sum <= 0.0 {
        // Nothing was found: not to be taken for a hidden light.
        survivor.reservoir.sample.light = NO_LIGHT;
    }
    let visible = settings.visibility_reuse == 0
        || survivor.is_certain()
        || rays.sees(Question::Survivor, survivor.ray, SURE_HITS_ONLY);
    (survivor.kept(visible), met)
}
