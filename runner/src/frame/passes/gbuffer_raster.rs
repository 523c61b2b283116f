//! What each pixel sees, from the triangle that `visibility` has drawn there.

use crate::frame::pass::{Access, Extent, Pass, Role, Stage};

pub const PASS: Pass = Pass {
    stem: "gbuffer_raster",
    stage: Stage::Compute,
    uses: &[
        (Role::GBuffer, Access::Write),
        (Role::Radiance, Access::Write),
        (Role::Visibility, Access::Read),
    ],
    extent: Extent::Pixels,
    past: false,
};
