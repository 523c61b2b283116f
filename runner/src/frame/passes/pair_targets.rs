//! What each pixel makes of its partner's sample: at most one shadow ray a reservoir.

use crate::frame::pass::{Access, Extent, Pass, Rays, Role, Stage};

pub const PASS: Pass = Pass {
    stem: "pair_targets",
    stage: Stage::RayTracing(Rays::Shadow),
    uses: &[
        (Role::GBuffer, Access::Read),
        (Role::ReservoirsIn, Access::Read),
        (Role::PairTargets, Access::Write),
    ],
    extent: Extent::Reservoirs,
    past: false,
};
