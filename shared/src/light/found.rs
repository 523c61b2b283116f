//! Which light a ray found: from where it ended to the index of the light there.

use crate::environment::{EnvironmentTexel, texel_of};
use crate::frame::{FrameConstants, features};
use crate::geometry::InstanceGeometry;
use crate::interface::HitPayload;
use crate::motion::NO_LIGHT;
use glam::{UVec2, Vec3};

/// What of a scene leads to its lights.
#[derive(Clone, Copy)]
pub struct Emitters<'a> {
    /// Which triangles are lights.
    pub instances: &'a [InstanceGeometry],
    /// Which texels are.
    pub environment: &'a [EnvironmentTexel],
    /// Texels; 0 without an environment.
    pub environment_size: UVec2,
    /// Index of the first lit texel's light.
    pub first_environment_light: u32,
    /// [`features`]
    pub features: u32,
}

impl<'a> Emitters<'a> {
    /// Of the frame's scene.
    pub fn new(
        frame: &FrameConstants,
        features: u32,
        instances: &'a [InstanceGeometry],
        environment: &'a [EnvironmentTexel],
    ) -> Self {
        let FrameConstants { environment_size, first_environment_light, .. } = *frame;
        Emitters { instances, environment, environment_size, first_environment_light, features }
    }

    /// The light where a ray along `direction` (unit) ended; [`NO_LIGHT`] for none, or one that rays can't find. That a triangle
    /// may be met from its dark side is left to who evaluates it.
    pub fn light_at(self, hit: HitPayload, direction: Vec3) -> u32 {
        if hit.hit != 0 {
            return nth(self.instances[hit.instance as usize].first_light, hit.primitive);
        }
        if self.features & features::ENVIRONMENT == 0 {
            return NO_LIGHT;
        }
        let texel = self.environment[texel_of(direction, self.environment_size) as usize];
        nth(texel.light, self.first_environment_light)
    }
}

fn nth(base: u32, offset: u32) -> u32 {
    if base == NO_LIGHT { NO_LIGHT } else { base + offset }
}
