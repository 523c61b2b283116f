//! The viewer's mean over frames: one more frame.

use super::At;
use crate::resources::Extent;
use crate::view::running_mean;
use glam::Vec3;

/// The mean with this frame in it, nit.
pub fn accumulate(at: At<'_>, radiance: &[Vec3], mean: Vec3) -> Vec3 {
    running_mean(mean, radiance[at.index(Extent::Pixels)], at.constants.count)
}
