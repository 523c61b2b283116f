//! Light that bounces, by resampling: the passes of direct light once more, with paths for samples ([`crate::bounced`]).

mod further;
mod initial;
mod light;
mod reuse;
mod shade;

use super::pair_targets::PairTargets;
use super::{At, Visibility, Witness};
use crate::alias_table::AliasEntry;
use crate::bounced::Bounced;
use crate::environment::EnvironmentTexel;
use crate::frame::FrameConstants;
use crate::geometry::{InstanceGeometry, VertexAttributes};
use crate::light::Light;
use crate::material::Material;
use crate::points::{Aim, ScenePoint};
use crate::reservoir::StoredPath;
use crate::rng::{Rng, Stream};
use crate::scene::Scene;
use crate::surface::GBufferTexel;
use crate::textures::Texels;
use bytemuck::{Pod, Zeroable};
use glam::{UVec2, Vec2, Vec3};

pub use reuse::indirect_pair_merge;

/// A pass that evaluates paths: its buffers but for those of the lights and of the scene, and the function that computes it.
macro_rules! bounces {
    ($(#[$doc:meta])* $name:ident($($last:ident: $last_type:ty),*) -> $out:ty = $body:path) => {
        $(#[$doc])*
        #[allow(clippy::too_many_arguments)]
        pub fn $name(
            at: At<'_>,
            rays: impl Visibility,
            note: impl Witness,
            lights: &[Light],
            alias: &[AliasEntry],
            instances: &[InstanceGeometry],
            positions: &[Vec3],
            attributes: &[VertexAttributes],
            indices: &[u32],
            materials: &[Material],
            second_uvs: &[Vec2],
            environment: &[EnvironmentTexel],
            textures: impl Texels,
            $($last: $last_type,)*
        ) -> $out {
            let features = at.features;
            let scene =
                Scene { features, instances, positions, attributes, indices, materials, second_uvs, environment };
            $body(at, rays, note, Bounced { table: at.light_table(lights, alias), scene, textures }, $($last),*)
        }
    };
}

bounces! {
    /// A fresh path for each pixel, along the reflectance of what it sees. `met`: what such a ray met, of the variant that has it.
    indirect_initial(gbuffer: &[GBufferTexel], met: &[ScenePoint]) -> StoredPath = initial::initial
}

bounces! {
    /// A path that goes on, for the one pixel of a block that is picked. `current`: as `indirect_initial`, or the level before, left it.
    indirect_further(gbuffer: &[GBufferTexel], current: StoredPath) -> StoredPath = further::further
}

bounces! {
    /// Merges the path with which the same surface point ended the previous frame, in a scene that has not moved since. `current`: as
    /// `indirect_initial` and `indirect_further` left it.
    indirect_temporal(
        gbuffer: &[GBufferTexel],
        previous_gbuffer: &[GBufferTexel],
        history: &[StoredPath],
        aims: &[Aim],
        current: StoredPath
    ) -> StoredPath = reuse::temporal
}

bounces! {
    /// What each pixel makes of its partner's path, with at most one ray.
    indirect_pair_targets(gbuffer: &[GBufferTexel], paths: &[StoredPath]) -> PairTargets = reuse::pair_targets
}

bounces! {
    /// The radiance of a pixel with what its path brings, nit.
    indirect_shade(gbuffer: &[GBufferTexel], paths: &[StoredPath], radiance: Vec3) -> Vec3 = shade::whole
}

bounces! {
    /// What its path brings, in parts: diffuse under an albedo of 1, specular, nit.
    indirect_shade_parts(gbuffer: &[GBufferTexel], paths: &[StoredPath]) -> (Vec3, Vec3) = shade::parts
}

/// Random numbers of [`crate::rng::Stream::Indirect`], and of [`crate::rng::Stream::Further`].
mod lane {
    pub const INITIAL: u32 = 0;
    pub const TEMPORAL: u32 = 1;
    /// Which pixel of a block goes on, for each level.
    pub const PICKED: u32 = 0;
    /// And its path.
    pub const LEVELS: u32 = 16;
    /// And one for each iteration after it.
    pub const PAIRS: u32 = 2;
}

/// No path has more points: 0.95^1000 of them would.
#[cfg(not(target_arch = "spirv"))]
const LONGEST: u32 = 1000;

/// Paths that go on, of all lengths together. Light that was reflected often is little and smooth, and a path takes the longer
/// to trace: fewer pixels do. Measured in docs/performance.md.
#[cfg(not(target_arch = "spirv"))]
pub const LEVELS: [Level; 2] =
    [Level { side: 2, first: 1, last: 1 }, Level { side: 4, first: 2, last: LONGEST }];

/// Paths of some lengths, for which one pixel of each block goes on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Level {
    /// Of a block, pixels.
    pub side: u32,
    /// Points behind x2: from this one on light is gathered,
    pub first: u32,
    /// and after this one paths end.
    pub last: u32,
}

impl Level {
    /// The pixel of `block` that goes on, drawn evenly; it may lie beyond the image.
    pub fn picked(self, frame: &FrameConstants, number: u32, block: UVec2) -> UVec2 {
        let lane = lane::PICKED + number;
        let random = Rng::new(block, frame.index, frame.seed, Stream::Further, lane).next_u32x4();
        block * self.side + (UVec2::new(random.x, random.y) >> 16) % self.side
    }
}
