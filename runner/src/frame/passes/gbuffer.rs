//! What each pixel sees: one primary ray.

use crate::frame::pass::{Access, Extent, Pass, Rays, Role, Stage};

pub const PASS: Pass = Pass {
    stem: "gbuffer",
    stage: Stage::RayTracing(Rays::Primary),
    uses: &[(Role::GBuffer, Access::Write), (Role::Radiance, Access::Write)],
    extent: Extent::Pixels,
    past: false,
};
