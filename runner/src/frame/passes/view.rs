//! One of the viewer's views in place of the tone-mapped picture.

use crate::frame::pass::{Access, Extent, Pass, Role, Stage};

pub const PASS: Pass = Pass {
    stem: "view",
    stage: Stage::Compute,
    uses: &[
        (Role::GBuffer, Access::Read),
        (Role::ReservoirsIn, Access::Read),
        (Role::Radiance, Access::Read),
        (Role::Display, Access::Write),
        (Role::Mean, Access::Read),
        (Role::Reference, Access::Read),
    ],
    extent: Extent::Pixels,
    past: false,
};
