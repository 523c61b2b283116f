//! Merges neighbors; once an iteration, from one buffer to another.

use crate::frame::pass::{Access, Extent, Pass, Role, Stage};

pub const PASS: Pass = Pass {
    stem: "spatial",
    stage: Stage::Compute,
    uses: &[
        (Role::GBuffer, Access::Read),
        (Role::ReservoirsIn, Access::Read),
        (Role::ReservoirsOut, Access::Write),
    ],
    extent: Extent::Reservoirs,
    past: false,
};
