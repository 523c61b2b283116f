//! Radiance to display values.

use super::At;
use crate::resources::Extent;
use crate::tonemap::{display, pack_rgba8};
use glam::Vec3;

/// RGBA8, red lowest.
pub fn tonemap(at: At<'_>, radiance: &[Vec3]) -> u32 {
    pack_rgba8(display(radiance[at.index(Extent::Pixels)], at.frame.exposure))
}
