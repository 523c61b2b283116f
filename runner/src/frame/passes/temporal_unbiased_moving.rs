//! As `temporal_unbiased`, after something moved.

use crate::frame::pass::{Access, Extent, Pass, Rays, Role, Stage};

pub const PASS: Pass = Pass {
    stem: "temporal_unbiased_moving",
    stage: Stage::RayTracing(Rays::Shadow),
    uses: &[
        (Role::GBuffer, Access::Read),
        (Role::PreviousGBuffer, Access::Read),
        (Role::ReservoirsOut, Access::ReadWrite),
        (Role::ReservoirsHistory, Access::Read),
    ],
    extent: Extent::Reservoirs,
    past: true,
};
