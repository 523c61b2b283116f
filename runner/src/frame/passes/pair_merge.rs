//! Merges the reservoirs of partners, from one buffer to another.

use crate::frame::pass::{Access, Extent, Pass, Role, Stage};

pub const PASS: Pass = Pass {
    stem: "pair_merge",
    stage: Stage::Compute,
    uses: &[
        (Role::ReservoirsIn, Access::Read),
        (Role::ReservoirsOut, Access::Write),
        (Role::PairTargets, Access::Read),
    ],
    extent: Extent::Reservoirs,
    past: false,
};
