//! Fresh candidates from light tiles: a ray for each BSDF candidate, and at most one shadow ray a reservoir.

use crate::frame::pass::{Access, Extent, Pass, Rays, Role, Stage};

pub const PASS: Pass = Pass {
    stem: "initial_tiled",
    stage: Stage::RayTracing(Rays::Both),
    uses: &[
        (Role::GBuffer, Access::Read),
        (Role::ReservoirsOut, Access::Write),
        (Role::TileEntries, Access::Read),
        (Role::TilePoints, Access::Read),
    ],
    extent: Extent::Reservoirs,
    past: false,
};
