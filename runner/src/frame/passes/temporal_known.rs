//! Unbiased temporal reuse that needs no ray: works in place.

use crate::frame::pass::{Access, Extent, Pass, Role, Stage};

pub const PASS: Pass = Pass {
    stem: "temporal_known",
    stage: Stage::Compute,
    uses: &[
        (Role::GBuffer, Access::Read),
        (Role::PreviousGBuffer, Access::Read),
        (Role::ReservoirsOut, Access::ReadWrite),
        (Role::ReservoirsHistory, Access::Read),
    ],
    extent: Extent::Reservoirs,
    past: false,
};
