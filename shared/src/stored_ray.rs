//! Rays of passes, written down to be traced again without the pass around them.

use crate::shadow::ShadowRay;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// A ray as its pass traced it; the default is none. World space, m. 32 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct StoredRay {
    /// Where it starts.
    pub origin: Vec3,
    /// Of [`crate::alpha`].
    pub key: u32,
    /// To its end, or unit.
    pub direction: Vec3,
    /// 1: there is a ray.
    pub traced: u32,
}

impl StoredRay {
    /// A ray that was traced.
    pub fn new(origin: Vec3, direction: Vec3, key: u32) -> Self {
        StoredRay { origin, key, direction, traced: 1 }
    }

    /// Of a ray that ends at its light.
    pub fn shadow(self) -> ShadowRay {
        ShadowRay { origin: self.origin, direction: self.direction }
    }
}
