//! What stays the same for all pixels of a frame: cameras, size, seed and every knob.

use crate::camera::Camera;
use bytemuck::{Pod, Zeroable};
use glam::UVec2;

/// Every knob of the estimator.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Settings {
    /// Candidates a reservoir is filled with in `initial`, 1..=1024. More: less noise, more time. No bias.
    pub candidates: u32,
    /// Candidates that the surface's own reflectance looks for beside those, by a ray each, 0..=4: smooth surfaces need them.
    /// They act where visibility reuse is on and rays can find lights ([`features::TRACEABLE`]). No bias.
    pub bsdf_candidates: u32,
    /// 1: a shadow ray kills the reservoir of an occluded sample before it is reused (Bitterli et al. 2020, Alg. 5).
    /// Biased mode darkens near shadow edges for it, and is far less noisy.
    pub visibility_reuse: u32,
    /// 1: merge the reprojected reservoir of the previous frame.
    pub temporal: u32,
    /// 1: merge reservoirs of neighboring pixels.
    pub spatial: u32,
    /// Spatial passes n, 1..=8.
    pub spatial_iterations: u32,
    /// Neighbors k of each spatial pass, 1..=32.
    pub neighbors: u32,
    /// Neighbors are drawn from a disk of this radius, in pixels.
    pub radius: f32,
    /// A neighbor's distance to the camera may differ by this fraction.
    pub depth_threshold: f32,
    /// A neighbor's normal may differ by the angle with this cosine.
    pub normal_threshold: f32,
    /// A history stands for at most this many times the candidates of a new reservoir (Bitterli et al.: 20).
    pub confidence_cap: f32,
    /// Reservoirs a pixel N, 1..=4; `shade` averages them.
    pub reservoirs: u32,
    /// One of [`mode`].
    pub mode: u32,
    /// 1: candidates come from presampled tiles ([`crate::light::tile`]). Faster with many lights; neighboring pixels share
    /// candidates. No bias.
    pub tiles: u32,
    /// 1: unbiased spatial reuse merges pairs of pixels that chose each other ([`crate::resampling::pairs`]), not `neighbors`.
    pub pairs: u32,
}

/// How reused reservoirs are weighted.
pub mod mode {
    /// 1/M (Bitterli et al. 2020, Alg. 4).
    pub const BIASED: u32 = 0;
    /// Pairwise MIS, with the neighbor's visibility where visibility reuse is on.
    pub const UNBIASED: u32 = 1;
}

impl Settings {
    /// Does every reservoir between passes hold a sample that no opaque surface hides, or none?
    pub fn visibility_is_known(&self) -> bool {
        self.mode == mode::UNBIASED && self.visibility_reuse != 0
    }

    /// Are neighbors merged in pairs?
    pub fn in_pairs(&self) -> bool {
        self.pairs != 0 && self.mode == mode::UNBIASED
    }

    /// t of [`crate::resampling::pairwise`] for neighbors. With a history all reservoirs stand for many candidates, but neighbors'
    /// for other targets than the pixel's own: together they count as much as that. Measured in docs/performance.md.
    pub fn neighbor_trust(&self) -> f32 {
        let neighbors = if self.in_pairs() { 1 } else { self.neighbors };
        if self.temporal != 0 { 1.0 / (neighbors * self.spatial_iterations) as f32 } else { 1.0 }
    }

    /// BSDF candidates of each reservoir in a scene with `features`. A ray finds visible samples only, so hidden ones have to be
    /// dropped too, or their weights would be wrong: visibility reuse does that.
    pub fn bsdf_candidates(&self, features: u32) -> u32 {
        let acts = self.visibility_reuse != 0 && features & features::TRACEABLE != 0;
        if acts { self.bsdf_candidates } else { 0 }
    }

    /// Shading asks again where visibility is not known, or where something is transparent: reuse sees opaque surfaces
    /// only. `features`: of the scene.
    pub fn shading_needs_rays(&self, features: u32) -> bool {
        !self.visibility_is_known() || features & features::ALPHA != 0
    }
}

/// The least error in the least time on measured scenes (docs/results.md); not the thesis's knobs in two: it has 1/M weights
/// and two spatial passes.
impl Default for Settings {
    fn default() -> Self {
        Settings {
            candidates: 32,
            bsdf_candidates: 1,
            visibility_reuse: 1,
            temporal: 1,
            spatial: 1,
            spatial_iterations: 1,
            neighbors: 4,
            radius: 8.0,
            depth_threshold: 0.1,
            // cos 25°, as Bitterli et al. have it.
            normal_threshold: 0.906,
            confidence_cap: 20.0,
            reservoirs: 1,
            mode: mode::UNBIASED,
            tiles: 0,
            pairs: 1,
        }
    }
}

/// Constants of one frame, the same for all of its passes.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct FrameConstants {
    pub camera: Camera,
    /// The camera of the previous frame; equal to `camera` in the first.
    pub previous_camera: Camera,
    /// Image size in pixels.
    pub size: UVec2,
    /// Number of the frame since the start of its history: 0 has no past.
    pub index: u32,
    /// Seed of the run.
    pub seed: u32,
    pub settings: Settings,
    /// Factor from cd/m² to display values.
    pub exposure: f32,
    /// Radiance of what lies behind the scene, nit, linear RGB; an environment map takes its place.
    pub background: glam::Vec3,
    /// Texels of the environment map; 0 without one.
    pub environment_size: UVec2,
    /// Index of the light of the map's first lit texel.
    pub first_environment_light: u32,
}

impl FrameConstants {
    pub fn pixels(&self) -> u32 {
        self.size.x * self.size.y
    }

    /// Place of `pixel` in the frame's buffers (rows from the top).
    pub fn pixel_index(&self, pixel: UVec2) -> u32 {
        pixel.y * self.size.x + pixel.x
    }
}

/// What a scene contains, as bits: pipelines are specialised with them.
pub mod features {
    /// At least one material has a texture.
    pub const TEXTURES: u32 = 1;
    /// At least one material has a normal map.
    pub const NORMAL_MAPS: u32 = 2;
    /// At least one texture has a transform or reads the second uv set.
    pub const UV_MAPS: u32 = 4;
    /// At least one material is masked or blended: any-hit shaders run on its triangles.
    pub const ALPHA: u32 = 8;
    /// A ray may end where a light is known: there is an environment map, or a triangle that rays can find.
    pub const TRACEABLE: u32 = 16;
    /// There is an environment map.
    pub const ENVIRONMENT: u32 = 1 << 16;
    /// There are lights of [`crate::light::kind`] k where bit k above this one is set.
    pub const FIRST_LIGHT_KIND: u32 = 24;

    /// All those bits.
    pub const LIGHT_KINDS: u32 = u32::MAX << FIRST_LIGHT_KIND;

    /// The bit that lights of `kind` set.
    pub const fn light_kind(kind: u32) -> u32 {
        1 << (FIRST_LIGHT_KIND + kind)
    }
}
