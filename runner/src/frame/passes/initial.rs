//! Fresh candidates: a ray for each BSDF candidate, and at most one shadow ray a reservoir.

use crate::frame::pass::{Access, Extent, Pass, Rays, Role, Stage};

pub const PASS: Pass = Pass {
    stem: "initial",
    stage: Stage::RayTracing(Rays::Both),
    uses: &[(Role::GBuffer, Access::Read), (Role::ReservoirsOut, Access::Write)],
    extent: Extent::Reservoirs,
    past: false,
};
