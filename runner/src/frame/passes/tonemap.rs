//! Radiance to display values.

use crate::frame::pass::{Access, Extent, Pass, Role, Stage};

pub const PASS: Pass = Pass {
    stem: "tonemap",
    stage: Stage::Compute,
    uses: &[(Role::Radiance, Access::Read), (Role::Display, Access::Write)],
    extent: Extent::Pixels,
    past: false,
};
