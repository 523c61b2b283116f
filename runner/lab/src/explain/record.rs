//! The record of a replayed pixel. Units as everywhere: m, nit; arrays are x, y, z or r, g, b.

use super::compare::Difference;
use super::rays::Hit;
use serde::Serialize;

/// One pixel of one frame, step by step. Its [`std::fmt::Display`] is for people, its `Serialize` for scripts.
#[derive(Clone, Debug, Serialize)]
pub struct Explanation {
    pub device: String,
    pub scene: String,
    pub pixel: [u32; 2],
    pub size: [u32; 2],
    pub frame: u32,
    pub seed: u32,
    /// `biased` or `unbiased`.
    pub mode: &'static str,
    pub lights: u32,
    /// What the CPU's own primary ray meets; it follows the eye's ray through masks and stochastic alpha as the GPU's does.
    pub seen: Option<Hit>,
    /// None where there is nothing to light: no surface, or an unlit one.
    pub surface: Option<SurfaceReport>,
    /// Radiance without lighting: emission, or what lies behind the scene.
    pub emission: [f32; 3],
    /// In the order of the frame, reservoir by reservoir.
    pub passes: Vec<PassReport>,
    pub shading: Option<Shading>,
    /// What the GPU computed for the pixel.
    pub radiance: [f32; 3],
    /// Of it, light that bounced, nit; it is not replayed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub indirect: Option<[f32; 3]>,
}

/// The G-buffer's entry of the pixel, unpacked.
#[derive(Clone, Debug, Serialize)]
pub struct SurfaceReport {
    pub position: [f32; 3],
    pub distance: f32,
    /// How far above its triangle light arrives, on the curved surface that the triangle stands for, m.
    pub lift: f32,
    /// Between the GPU's and that of the CPU's primary ray (f64, rounded), if both met the same geometry.
    pub distance_ulps: Option<u64>,
    pub geometric_normal: [f32; 3],
    pub normal: [f32; 3],
    pub diffuse: [f32; 3],
    pub f0: [f32; 3],
    pub roughness: f32,
}

/// One pass over one reservoir.
#[derive(Clone, Debug, Default, Serialize)]
pub struct PassReport {
    /// Stem of the pass.
    pub pass: &'static str,
    pub iteration: u32,
    /// Which of the pixel's reservoirs.
    pub reservoir: u32,
    /// Of `initial`: the cell of the world whose pool they come from, if any.
    pub cell: Option<u32>,
    /// Of `initial`: the tile they come from, if any.
    pub tile: Option<Tile>,
    pub candidates: Vec<Candidate>,
    /// Of the others: the pixel's own reservoir ...
    pub canonical: Option<Merged>,
    /// ... and those it is merged with; the history is one.
    pub others: Vec<Neighbor>,
    /// Of `initial`: how its BSDF candidates were looked for.
    pub bsdf_rays: Vec<BsdfRay>,
    pub rays: Vec<Ray>,
    /// What the pass ends with, as the CPU has it.
    pub cpu: Survivor,
    pub gpu: Survivor,
    pub difference: Difference,
}

#[derive(Clone, Debug, Default, Serialize)]
pub struct Survivor {
    /// None: an empty reservoir.
    pub light: Option<u32>,
    pub kind: &'static str,
    /// The point on the light, packed.
    pub uv: u32,
    /// W
    pub contribution_weight: f32,
    /// M
    pub confidence: f32,
}

#[derive(Clone, Debug, Serialize)]
pub struct Tile {
    pub tile: u32,
    /// Entries among the candidates that the CPU draws with the same light and point.
    pub equal_entries: u32,
}

#[derive(Clone, Debug, Serialize)]
pub struct Candidate {
    /// `table`, `tile` or `bsdf`: where it comes from; of a cell's pool `list`, `tree` or `table`.
    pub by: &'static str,
    pub light: u32,
    pub kind: &'static str,
    /// p of all techniques together, in the light's measure: 1/m², 1/sr, or 1.
    pub source_pdf: f32,
    /// The fraction of its light that its cell believes to arrive, which is in p̂; 1 where nothing is believed.
    pub believed: f32,
    /// p̂
    pub target: f32,
    /// w = p̂/p
    pub weight: f32,
    /// Σw with it.
    pub weight_sum: f32,
    /// It took the reservoir; a later one may take it again.
    pub chosen: bool,
}

/// What became of a reservoir in a merge.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Merged {
    pub reservoir: Survivor,
    /// p̂ at this pixel.
    pub target: f32,
    /// m; of the 1/M weights M_i/M.
    pub mis_weight: f32,
    pub weight: f32,
    pub chosen: bool,
}

/// Another pixel's reservoir, or the history.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Neighbor {
    /// None: outside the image, or there is no past.
    pub pixel: Option<[u32; 2]>,
    /// Why it was not merged.
    pub rejected: Option<&'static str>,
    pub merged: Option<Merged>,
    /// p̂ of its survivor at its own pixel; unbiased mode.
    pub target_there: Option<f32>,
    /// p̂ of the canonical survivor at its pixel; unbiased mode.
    pub canonical_there: Option<f32>,
    /// What the canonical MIS weight gains should that pixel not see the canonical survivor; unbiased spatial reuse.
    pub pending: Option<f32>,
    /// It was drawn to answer for all; a later one may be drawn in its place.
    pub asked: bool,
}

#[derive(Clone, Debug, Serialize)]
pub struct Ray {
    pub purpose: &'static str,
    pub origin: [f32; 3],
    /// To its end: t runs from 0 to 1.
    pub direction: [f32; 3],
    /// The CPU's answer.
    pub visible: bool,
    pub blocker: Option<Hit>,
    /// Only the opposite answer explains what the GPU computed: the ray passes an edge too closely for both to agree.
    pub gpu_disagrees: bool,
}

/// A BSDF ray.
#[derive(Clone, Debug, Serialize)]
pub struct BsdfRay {
    pub origin: [f32; 3],
    /// Unit.
    pub direction: [f32; 3],
    /// What the CPU's ray meets.
    pub hit: Option<Hit>,
    /// The light there, and the point on it, packed.
    pub light: Option<u32>,
    pub uv: u32,
    /// The GPU found another light there, which the lines follow.
    pub gpu_disagrees: bool,
}

#[derive(Clone, Debug, Serialize)]
pub struct Shading {
    /// By reservoir: f Le G W.
    pub contributions: Vec<[f32; 3]>,
    /// None where visibility is known.
    pub rays: Vec<Ray>,
    pub cpu: [f32; 3],
    pub ulps: [u64; 3],
}
