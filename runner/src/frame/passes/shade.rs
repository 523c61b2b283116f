//! Adds the light of the survivors: at most one shadow ray a reservoir.

use crate::frame::pass::{Access, Extent, Pass, Rays, Role, Stage};

pub const PASS: Pass = Pass {
    stem: "shade",
    stage: Stage::RayTracing(Rays::Shadow),
    uses: &[
        (Role::GBuffer, Access::Read),
        (Role::ReservoirsIn, Access::Read),
        (Role::Radiance, Access::ReadWrite),
    ],
    extent: Extent::Pixels,
    past: false,
};
