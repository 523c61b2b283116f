//! Passes of a frame: the whole body of each, run by the GPU's entry points, by tests, by `explain` and by the roofline.
//!
//! A body computes what one thread writes, from the buffers that the pass reads: values in, values out. What needs a ray is asked of
//! a [`Visibility`]; every candidate, target, weight and choice is told to a [`Witness`], which is nothing on the GPU.

pub mod accumulate;
pub mod antialias;
pub mod cells;
#[cfg(not(target_arch = "spirv"))]
mod declared;
pub mod denoise;
pub mod indirect;
pub mod initial;
pub mod learn;
pub mod observe;
pub mod pair_merge;
pub mod pair_targets;
pub mod paths;
pub mod points;
pub mod presample;
pub mod reference;
pub mod resolve;
pub mod roofline;
pub mod shade;
pub mod spatial;
pub mod statistics;
mod table;
pub mod temporal;
pub mod tonemap;
pub mod view;
mod visibility;
mod witness;

pub use accumulate::accumulate;
pub use antialias::antialias;
pub use cells::{cells, mark_cells, pools};
#[cfg(not(target_arch = "spirv"))]
pub use declared::{Access, Body, Output, Pass, Rays, Stage, run};
pub use denoise::{denoise_spatial, denoise_temporal, denoise_variance, resolve_denoised};
pub use indirect::{
    indirect_further, indirect_initial, indirect_pair_merge, indirect_pair_targets, indirect_shade,
    indirect_shade_parts, indirect_temporal,
};
pub use initial::{initial, initial_met};
pub use learn::{learn_beliefs, learn_lists};
pub use observe::observe;
pub use pair_merge::pair_merge;
pub use pair_targets::pair_targets;
pub use paths::{paths, paths_parts};
pub use points::{aim, land, scatter};
pub use presample::presample;
pub use reference::{reference, reference_parts};
pub use resolve::{resolve, resolve_indirect};
pub use roofline::{roofline_copy, roofline_shadow};
pub use shade::{shade, shade_parts};
pub use spatial::spatial;
pub use statistics::statistics;
pub use temporal::{temporal, temporal as temporal_hops};
pub use tonemap::tonemap;
pub use view::view;
pub use visibility::{Assumed, Question, Visibility};
pub use witness::{Silent, Technique, Witness};

use crate::alias_table::AliasEntry;
use crate::cells::Cell;
use crate::cells::belief::{BELIEFS, Beliefs};
use crate::cells::list::{LIST, ListEntry};
use crate::cells::pool::Sources;
use crate::cells::{self as world_cells, ROW};
use crate::frame::FrameConstants;
use crate::interface::PassConstants;
use crate::light::tile::{TILE_SIZE, TILES};
use crate::light::tree::{LightTree, TreeNode};
use crate::light::{Light, LightTable, Lights};
use crate::resampling::reservoir_index;
use crate::resources::Extent;
use crate::rng::{Rng, Stream};
use crate::statistics::BLOCK;
use crate::surface::{GBufferTexel, Surface};
use glam::{UVec2, UVec3};

/// Bits of a pass's specialisation: variants of one body that a pipeline is compiled for.
pub mod variant {
    /// Reuse is weighed by pairwise MIS, not by 1/M.
    pub const UNBIASED: u32 = 1;
    /// Something has moved since the previous frame: set 2 is read.
    pub const MOVING: u32 = 2;
    /// Candidates come from light tiles.
    pub const TILED: u32 = 4;
    /// Candidates come from the pools of cells.
    pub const CELLS: u32 = 8;
    /// Points of the previous frame fell into the pixels of this one.
    pub const LASTING: u32 = 16;
    /// Neither camera nor scene has changed since the previous frame.
    pub const RESTS: u32 = 32;
    /// There is light that bounced.
    pub const BOUNCED: u32 = 64;
    /// The previous frame was denoised too.
    pub const DENOISED: u32 = 128;
    /// Paths begin along the BSDF rays of `initial_met`.
    pub const MET: u32 = 256;
    /// Points of a picture at rest take one place in their pixels after the other.
    pub const WANDERS: u32 = 512;
    /// The previous frame was antialiased too.
    pub const ANTIALIASED: u32 = 1024;
}

/// One thread of a pass, and what is the same for all of them.
#[derive(Clone, Copy)]
pub struct At<'a> {
    /// Constants of the frame.
    pub frame: &'a FrameConstants,
    /// Of this pass.
    pub constants: PassConstants,
    /// [`crate::frame::features`] of the scene.
    pub features: u32,
    /// [`variant`]
    pub variant: u32,
    /// Of the launch: the pixel, of passes that cover pixels.
    pub pixel: UVec2,
    /// Which of the pixel's reservoirs.
    pub lane: u32,
}

impl<'a> At<'a> {
    /// Thread `id` of a launch.
    pub fn new(
        frame: &'a FrameConstants,
        constants: PassConstants,
        features: u32,
        variant: u32,
        id: UVec3,
    ) -> Self {
        At { frame, constants, features, variant, pixel: id.truncate(), lane: id.z }
    }

    /// The thread of the pixel that is picked of block `id` ([`indirect::Level`]).
    pub fn picked(
        frame: &'a FrameConstants,
        constants: PassConstants,
        features: u32,
        variant: u32,
        id: UVec3,
    ) -> Self {
        let pixel = constants.level.picked(frame, constants.iteration, id.truncate());
        At { frame, constants, features, variant, pixel, lane: id.z }
    }

    /// Does the pass run as `variant`, one of [`variant`]?
    pub fn is(&self, variant: u32) -> bool {
        self.variant & variant != 0
    }

    /// Threads in x and y of a pass over `extent`.
    pub fn threads(&self, extent: Extent) -> UVec2 {
        threads(extent, self.frame.size)
    }

    /// Place of this thread's elements in buffers of `extent`.
    pub fn index(&self, extent: Extent) -> usize {
        match extent {
            Extent::Reservoirs => reservoir_index(self.frame, self.pixel, self.lane) as usize,
            _ => (self.pixel.y * self.threads(extent).x + self.pixel.x) as usize,
        }
    }

    /// Random numbers of this pixel and reservoir.
    pub fn rng(&self, stream: Stream) -> Rng {
        self.lane_rng(stream, self.lane)
    }

    /// The same of a pass that a frame repeats.
    pub fn repeated_rng(&self, stream: Stream) -> Rng {
        self.lane_rng(stream, self.repetition())
    }

    /// Random numbers of this pixel, for any `lane`.
    pub fn lane_rng(&self, stream: Stream, lane: u32) -> Rng {
        Rng::new(self.pixel, self.frame.index, self.frame.seed, stream, lane)
    }

    /// Number of a repeated pass: of its reservoir and iteration.
    pub fn repetition(&self) -> u32 {
        self.lane + self.frame.settings.reservoirs * self.constants.iteration
    }

    /// What this pixel sees; its texel must not be empty.
    pub fn surface(&self, texel: &GBufferTexel) -> Surface {
        texel.unpack(self.features, &self.frame.camera, self.pixel, self.frame.size)
    }

    /// What this pixel sees.
    pub fn texel(&self, gbuffer: &[GBufferTexel]) -> GBufferTexel {
        gbuffer[self.frame.pixel_index(self.pixel) as usize]
    }

    /// With the features of the scene.
    pub fn lights<'b>(&self, lights: &'b [Light]) -> Lights<'b> {
        Lights { lights, features: self.features }
    }

    /// With the number of its lights.
    pub fn light_tree<'b>(
        &self,
        nodes: &'b [TreeNode],
        lights: &'b [u32],
        leaves: &'b [u32],
    ) -> LightTree<'b> {
        LightTree { nodes, lights, leaves, count: self.frame.tree_lights }
    }

    /// What the cell at `place` believes.
    pub fn beliefs<'b>(&self, table: &'b [u32], place: u32) -> Beliefs<'b> {
        Beliefs { table, cells: world_cells::most(self.frame.size), cell: place }
    }

    /// What lights of the cell at `place` of `cells` are drawn from.
    pub fn sources<'b>(
        &self,
        table: LightTable<'b>,
        tree: LightTree<'b>,
        cells: &[Cell],
        lists: &'b [ListEntry],
        beliefs: &'b [u32],
        place: u32,
    ) -> Sources<'b> {
        let beliefs = self.beliefs(beliefs, place);
        let pool = world_cells::pool(self.frame);
        Sources { table, tree, lists, beliefs, place, cell: cells[place as usize], pool }
    }

    /// With the features of the scene.
    pub fn light_table<'b>(&self, lights: &'b [Light], alias: &'b [AliasEntry]) -> LightTable<'b> {
        LightTable { lights: self.lights(lights), alias }
    }
}

/// Threads in x and y of a pass over `extent` in a picture of `size`.
pub fn threads(extent: Extent, size: UVec2) -> UVec2 {
    match extent {
        Extent::Scene | Extent::Pixels | Extent::Reservoirs | Extent::List => size,
        Extent::Tiles => UVec2::new(TILE_SIZE, TILES),
        Extent::Cells => UVec2::new(ROW, world_cells::most(size) / ROW),
        Extent::Lists => UVec2::new(LIST, world_cells::most(size)),
        Extent::Beliefs => UVec2::new(BELIEFS, world_cells::most(size)),
        Extent::Pools => world_cells::samples(size),
        Extent::Blocks => UVec2::new(size.x.div_ceil(BLOCK), size.y.div_ceil(BLOCK)),
    }
}
