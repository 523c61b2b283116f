//! A copy of the G-buffer: what moving the bytes of a pass takes.

use crate::frame::pass::{Access, Extent, Pass, Role, Stage};

pub const PASS: Pass = Pass {
    stem: "floor_copy",
    stage: Stage::Compute,
    uses: &[(Role::GBuffer, Access::Read), (Role::PreviousGBuffer, Access::Write)],
    extent: Extent::Pixels,
    past: false,
};
