//! Which triangle each pixel sees, drawn by the graphics pipeline.

use crate::frame::pass::{Access, Extent, Pass, Role, Stage};

pub const PASS: Pass = Pass {
    stem: "visibility",
    stage: Stage::Raster,
    uses: &[(Role::Visibility, Access::Write)],
    extent: Extent::Pixels,
    past: false,
};
