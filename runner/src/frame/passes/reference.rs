//! The truth: every light, one shadow ray each, a range of lights at a time.

use crate::frame::pass::{Access, Extent, Pass, Rays, Role, Stage};

pub const PASS: Pass = Pass {
    stem: "reference",
    stage: Stage::RayTracing(Rays::Shadow),
    uses: &[(Role::GBuffer, Access::Read), (Role::Radiance, Access::ReadWrite)],
    extent: Extent::Pixels,
    past: false,
};
