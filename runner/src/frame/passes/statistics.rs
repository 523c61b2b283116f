//! Sums over what the viewer shows, for its exposure and its error.

use crate::frame::pass::{Access, Extent, Pass, Role, Stage};

pub const PASS: Pass = Pass {
    stem: "statistics",
    stage: Stage::Compute,
    uses: &[
        (Role::Radiance, Access::Read),
        (Role::Mean, Access::Read),
        (Role::Reference, Access::Read),
        (Role::Statistics, Access::Write),
    ],
    extent: Extent::Blocks,
    past: false,
};
