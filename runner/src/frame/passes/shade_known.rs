//! Adds the light of survivors that are known to be visible: no ray.

use crate::frame::pass::{Access, Extent, Pass, Role, Stage};

pub const PASS: Pass = Pass {
    stem: "shade_known",
    stage: Stage::Compute,
    uses: &[
        (Role::GBuffer, Access::Read),
        (Role::ReservoirsIn, Access::Read),
        (Role::Radiance, Access::ReadWrite),
    ],
    extent: Extent::Pixels,
    past: false,
};
