//! Unbiased spatial reuse: from one buffer to another, at most k + 1 shadow rays a reservoir.

use crate::frame::pass::{Access, Extent, Pass, Rays, Role, Stage};

pub const PASS: Pass = Pass {
    stem: "spatial_unbiased",
    stage: Stage::RayTracing(Rays::Shadow),
    uses: &[
        (Role::GBuffer, Access::Read),
        (Role::ReservoirsIn, Access::Read),
        (Role::ReservoirsOut, Access::Write),
    ],
    extent: Extent::Reservoirs,
    past: false,
};
