//! Shadow rays from a buffer, and nothing else.

use crate::frame::pass::{Access, Extent, Pass, Rays, Role, Stage};

pub const PASS: Pass = Pass {
    stem: "floor_shadow",
    stage: Stage::RayTracing(Rays::Shadow),
    uses: &[(Role::Rays, Access::Read), (Role::Hits, Access::Write)],
    extent: Extent::Pixels,
    past: false,
};
