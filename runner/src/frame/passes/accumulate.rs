//! The viewer's mean over frames.

use crate::frame::pass::{Access, Extent, Pass, Role, Stage};

pub const PASS: Pass = Pass {
    stem: "accumulate",
    stage: Stage::Compute,
    uses: &[(Role::Radiance, Access::Read), (Role::Mean, Access::ReadWrite)],
    extent: Extent::Pixels,
    past: false,
};
