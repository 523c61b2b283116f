//! Light that bounces, by resampling: the passes of direct light once more, with paths for samples ([`crate::bounced`]).

mod initial;
mod reuse;
mod shade;

use super::pair_targets::PairTargets;
use super::{At, Visibility, Witness};
use crate::alias_table::AliasEntry;
use crate::bounced::Bounced;
use crate::environment::EnvironmentTexel;
use crate::geometry::{InstanceGeometry, VertexAttributes};
use crate::light::Light;
use crate::material::Material;
use crate::points::Aim;
use crate::reservoir::StoredPath;
use crate::scene::Scene;
use crate::surface::GBufferTexel;
use crate::textures::Texels;
use glam::{Vec2, Vec3};

pub use initial::LONGEST;
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
    /// A fresh path for each pixel, along the reflectance of what it sees.
    indirect_initial(gbuffer: &[GBufferTexel]) -> StoredPath = initial::initial
}

bounces! {
    /// Merges the path with which the same surface point ended the previous frame, in a scene that has not moved since. `current`: as
    /// `indirect_initial` left it.
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

/// Random numbers of [`crate::rng::Stream::Indirect`].
mod lane {
    pub const INITIAL: u32 = 0;
    pub const TEMPORAL: u32 = 1;
    /// And one for each iteration after it.
    pub const PAIRS: u32 = 2;
}
