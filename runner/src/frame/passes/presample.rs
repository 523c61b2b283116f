//! Light tiles: what `initial_tiled` draws from.

use crate::frame::pass::{Access, Extent, Pass, Role, Stage};

pub const PASS: Pass = Pass {
    stem: "presample",
    stage: Stage::Compute,
    uses: &[(Role::TileEntries, Access::Write), (Role::TilePoints, Access::Write)],
    extent: Extent::Tiles,
    past: false,
};
