//! The cells of the world that a frame sees, and the light samples that are drawn for each: see [`crate::cells`].

use super::At;
use crate::alias_table::AliasEntry;
use crate::cells::list::{LIST, ListEntry};
use crate::cells::{self, Cell, belief, cell_of};
use crate::counters::Counters;
use crate::light::tile::TileEntry;
use crate::light::tree::{Draw, TreeNode};
use crate::light::{Light, LightSample};
use crate::motion::NO_LIGHT;
use crate::resources::Extent;
use crate::rng::{Rng, Stream};
use crate::surface::GBufferTexel;
use glam::UVec2;

/// Marks the cells that pixels have: of each by its first pixel, as the number of pixels from there to the last.
pub fn mark_cells(at: At<'_>, gbuffer: &[GBufferTexel], mut marks: Counters<'_>) {
    let texel = at.texel(gbuffer);
    if !texel.is_empty() {
        marks.max(
            cell_of(at.frame, &at.surface(&texel), at.pixel),
            at.frame.pixels() - at.frame.pixel_index(at.pixel),
        );
    }
}

/// A cell as the pixel that marked it sees it; and no mark.
pub fn cells(
    at: At<'_>,
    gbuffer: &[GBufferTexel],
    lists: &[ListEntry],
    beliefs: &[u32],
    mark: u32,
) -> (u32, Cell) {
    if mark == 0 {
        return (0, Cell::default());
    }
    let frame = at.frame;
    let pixel = frame.pixels() - mark;
    let pixel = UVec2::new(pixel % frame.size.x, pixel / frame.size.x);
    let place = at.index(Extent::Cells) as u32;
    let mut sum = 0.0;
    let mut i = 0;
    while i < LIST {
        sum += lists[(place * LIST + i) as usize].weight;
        i += 1;
    }
    let texel = gbuffer[frame.pixel_index(pixel) as usize];
    let surface = texel.unpack(at.features, &frame.camera, pixel, frame.size);
    let visibility = at.beliefs(beliefs, place).of(belief::ALL, 1.0);
    (0, Cell::of(frame, &surface, pixel, sum, visibility))
}

/// A sample of a cell's pool.
#[allow(clippy::too_many_arguments)]
pub fn pools(
    at: At<'_>,
    lights: &[Light],
    alias: &[AliasEntry],
    tree_nodes: &[TreeNode],
    tree_lights: &[u32],
    tree_leaves: &[u32],
    cells: &[Cell],
    lists: &[ListEntry],
    beliefs: &[u32],
) -> (TileEntry, u32) {
    let (index, pool) = (at.index(Extent::Pools) as u32, cells::pool(at.frame));
    let (place, entry) = (index / pool, index % pool);
    if place >= cells::count(at.frame) || cells[place as usize].is_empty() {
        return (TileEntry::default(), 0);
    }
    let table = at.light_table(lights, alias);
    let tree = at.light_tree(tree_nodes, tree_lights, tree_leaves);
    let sources = at.sources(table, tree, cells, lists, beliefs, place);
    let mut rng = Rng::new(UVec2::new(entry, place), at.frame.index, at.frame.seed, Stream::Pools, 0);
    let Draw { light, pmf, visibility } = sources.sample(entry, &mut rng);
    if light == NO_LIGHT {
        return (TileEntry::default(), 0);
    }
    let sample = LightSample { light, uv: rng.next_u32x4().x };
    let source_pdf = pmf.and_on_light(table.lights.pdf_li(light));
    (TileEntry::new(table, sample, source_pdf).believed(belief::weight(visibility)), sample.uv)
}
