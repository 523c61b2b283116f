//! What cells know in the estimator's tests: learned by the passes of the GPU, or made up.

use crate::passes::Frame;
use crate::plant::Plant;
use shared::cells::belief::{self, BELIEFS};
use shared::cells::list::{self, LIST, ListEntry};
use shared::cells::{self, Cell, cell_of};
use shared::counters::Counters;
use shared::glam::{UVec2, UVec4};
use shared::light::Light;
use shared::light::tile::TileEntry;
use shared::light::tree::{self, Tree};
use shared::motion::NO_LIGHT;
use shared::passes;
use shared::reservoir::StoredReservoir;
use shared::resources::{Buffers, Extent};
use shared::rng::{hash, unit_f32};
use std::collections::BTreeSet;

/// [`shared::frame::Settings::cells`] in these tests: what cells know before each frame.
pub mod known {
    /// What frames taught them.
    pub const LEARNED: u32 = 1;
    /// Beliefs and lists by chance, others in each frame.
    pub const RANDOM: u32 = 2;
    /// Of every second light, in turns, that no ray ever arrives, of the others that all do; lists hold one light.
    pub const ADVERSARIAL: u32 = 3;
}

/// The buffers of cells.
struct Tables {
    marks: Vec<u32>,
    cells: Vec<Cell>,
    beliefs: Vec<u32>,
    observations: Vec<u32>,
    lists: Vec<ListEntry>,
    findings: Vec<u32>,
    pool_entries: Vec<TileEntry>,
    pool_points: Vec<u32>,
}

impl Tables {
    fn zeroed(size: UVec2) -> Self {
        let count = cells::most(size);
        let samples = cells::samples(size).element_product() as usize;
        Tables {
            marks: vec![0; count as usize],
            cells: vec![Cell::default(); count as usize],
            beliefs: vec![0; (count * BELIEFS) as usize],
            observations: vec![0; (count * BELIEFS) as usize],
            lists: vec![ListEntry::default(); (count * LIST) as usize],
            findings: vec![0; (count * LIST) as usize],
            pool_entries: vec![TileEntry::default(); samples],
            pool_points: vec![0; samples],
        }
    }
}

/// The places of a cell's list.
fn list_of(cell: u32) -> std::ops::Range<usize> {
    (cell * LIST) as usize..((cell + 1) * LIST) as usize
}

/// What is known between frames.
pub struct Knowledge {
    tables: Tables,
    /// Which beliefs and cells are touched.
    beliefs: BTreeSet<usize>,
    cells: BTreeSet<u32>,
}

impl Knowledge {
    /// Of nothing, for pictures of `size`.
    pub fn new(size: UVec2) -> Self {
        Knowledge { tables: Tables::zeroed(size), beliefs: BTreeSet::new(), cells: BTreeSet::new() }
    }

    /// With what `initial` reads.
    pub fn buffers<'a>(&'a self, buffers: Buffers<'a>) -> Buffers<'a> {
        let Tables { cells, lists, beliefs, pool_entries, pool_points, .. } = &self.tables;
        Buffers { cells, lists, beliefs, pool_entries, pool_points, ..buffers }
    }

    /// Learns from the frame before, and draws the pools of this one.
    pub fn ready(&mut self, frame: &Frame<'_>) {
        let b = frame.buffers;
        let mut places = BTreeSet::new();
        for pixel in frame.pixels() {
            let at = frame.at(pixel, 0, 0);
            passes::mark_cells(at, b.gbuffer, Counters::new(&mut self.tables.marks));
            places.insert(cell_of(at.frame, &at.surface(&at.texel(b.gbuffer)), pixel));
        }
        self.cells.extend(&places);
        match frame.constants.settings.cells {
            known::LEARNED => self.learn(frame),
            known => self.make_up(frame, known == known::ADVERSARIAL),
        }
        let Tables { marks, cells, beliefs, lists, pool_entries, pool_points, .. } = &mut self.tables;
        let stale = if frame.is(Plant::StaleBound) { stale_tree(b.lights) } else { Tree::default() };
        let before = if frame.is(Plant::TableWritten) { lists.clone() } else { Vec::new() };
        let row = passes::threads(Extent::Cells, UVec2::ONE).x;
        let (pool, columns) = (cells::pool(frame.constants), cells::samples(frame.constants.size).x);
        for place in places {
            if frame.is(Plant::TableWritten) {
                exchange_weights(&mut lists[list_of(place)]);
            }
            let at = frame.at(UVec2::new(place % row, place / row), 0, 0);
            let mark = std::mem::take(&mut marks[place as usize]);
            cells[place as usize] = passes::cells(at, b.gbuffer, lists, beliefs, mark).1;
            for entry in 0..pool {
                let i = place * pool + entry;
                let at = frame.at(UVec2::new(i % columns, i / columns), 0, 0);
                let nodes = if frame.is(Plant::StaleBound) { &stale.nodes } else { b.tree_nodes };
                let (mut drawn, point) = passes::pools(
                    at,
                    b.lights,
                    b.alias,
                    nodes,
                    b.tree_lights,
                    b.tree_leaves,
                    cells,
                    lists,
                    beliefs,
                );
                let light = drawn.light();
                // Word 6 of an entry is its density.
                let words: &mut [f32; 8] = bytemuck::cast_mut(&mut drawn);
                if frame.is(Plant::ListShare) && entry < pool / 4 {
                    words[6] *= 0.5;
                }
                if (frame.is(Plant::StaleBound) || frame.is(Plant::TableWritten)) && words[6] > 0.0 {
                    let lists = if frame.is(Plant::TableWritten) { &before } else { &*lists };
                    let table = at.light_table(b.lights, b.alias);
                    let tree = at.light_tree(b.tree_nodes, b.tree_lights, b.tree_leaves);
                    words[6] = at.sources(table, tree, cells, lists, beliefs, place).pdf(light).0;
                }
                (pool_entries[i as usize], pool_points[i as usize]) = (drawn, point);
            }
        }
    }

    fn learn(&mut self, frame: &Frame<'_>) {
        let at = frame.at(UVec2::ZERO, 0, 0);
        let Tables { beliefs, observations, lists, findings, .. } = &mut self.tables;
        for &i in &self.beliefs {
            (beliefs[i], observations[i]) = passes::learn_beliefs(at, beliefs[i], observations[i]);
        }
        for i in self.cells.iter().flat_map(|&cell| list_of(cell)) {
            (lists[i], findings[i]) = passes::learn_lists(at, lists[i], findings[i]);
        }
    }

    /// Knows something of every light in every cell that was seen, whatever is true.
    fn make_up(&mut self, frame: &Frame<'_>, adversarial: bool) {
        let b = frame.buffers;
        let (index, seed) = (frame.constants.index, frame.constants.seed);
        for &cell in &self.cells {
            for light in 0..b.lights.len() as u32 {
                let random = hash(UVec4::new(cell, light, index, seed ^ 0x0123_4567));
                let (asked, seen, weight) = if adversarial {
                    let hidden = (light + index).is_multiple_of(2);
                    (2000, if hidden { 0 } else { 2000 }, if light == index % 3 { 1.0 } else { 0.0 })
                } else {
                    let asked = random.x >> 17;
                    let listed = random.z & 1 == 0;
                    let weight = (unit_f32(random.w) * 8.0 - 4.0).exp2();
                    (asked, (unit_f32(random.y) * asked as f32) as u32, if listed { weight } else { 0.0 })
                };
                let beliefs = &mut self.tables.beliefs;
                each_node(frame, light, |node| {
                    let place = belief::place(cells::most(frame.constants.size), cell, node) as usize;
                    self.beliefs.insert(place);
                    // What is above it has its last light's.
                    beliefs[place] = asked << 16 | seen;
                });
                let entry = &mut self.tables.lists[(cell * LIST + list::place(light)) as usize];
                if weight > 0.0 || entry.light == light {
                    *entry = ListEntry { light, weight };
                }
            }
        }
    }

    /// Learns what `fresh`, as `initial` left it, has seen.
    pub fn observe(&mut self, frame: &Frame<'_>, fresh: &[StoredReservoir]) {
        let b = frame.buffers;
        for pixel in frame.pixels() {
            let at = frame.at(pixel, 0, 0);
            let Tables { observations, findings, .. } = &mut self.tables;
            let (observations, findings) = (Counters::new(observations), Counters::new(findings));
            passes::observe(at, b.lights, b.tree_leaves, b.gbuffer, fresh, observations, findings);
            let light = fresh[at.index(Extent::Pixels)].sample.light;
            if light < b.lights.len() as u32 {
                let cell = cell_of(at.frame, &at.surface(&at.texel(b.gbuffer)), pixel);
                each_node(frame, light, |node| {
                    let place = belief::place(cells::most(frame.constants.size), cell, node);
                    self.beliefs.insert(place as usize);
                });
            }
        }
    }
}

/// All that beliefs about `light` are counted for.
fn each_node(frame: &Frame<'_>, light: u32, mut each: impl FnMut(u32)) {
    each(belief::ALL);
    match frame.buffers.tree_leaves[light as usize] {
        NO_LIGHT => each(belief::far_away(light)),
        leaf => tree::path(leaf, frame.constants.tree_lights, each),
    }
}

/// Of lights that were elsewhere.
fn stale_tree(lights: &[Light]) -> Tree {
    let moved = |light: &Light| Light { position: -2.0 * light.position, ..*light };
    let moved: Vec<Light> = lights.iter().map(moved).collect();
    Tree { nodes: tree::build(&moved).nodes, ..tree::build(lights) }
}

/// Each light of a list has the weight of the next one: the same sum.
fn exchange_weights(list: &mut [ListEntry]) {
    let mut listed: Vec<_> = list.iter_mut().filter(|entry| entry.weight > 0.0).collect();
    let weights: Vec<f32> = listed.iter().map(|entry| entry.weight).collect();
    let next = weights.iter().cycle().skip(1);
    listed.iter_mut().zip(next).for_each(|(entry, weight)| entry.weight = *weight);
}
