//! What the passes of ReSTIR are made of: of direct light, and of light that bounces.

pub mod confidence;
pub mod initial;
pub mod moving;
pub mod pairs;
pub mod pairwise;
pub mod reprojection;
pub mod spatial;

use crate::frame::{FrameConstants, Settings};
use crate::light::{Incident, LightSample, LightTable};
use crate::reservoir::{Reservoir, Stored, StoredReservoir};
use crate::shadow::ShadowRay;
use crate::surface::{GBufferTexel, Surface};
use crate::target::target_function;
use glam::{UVec2, Vec3};
use pairwise::{CrossTargets, Weighed};

/// The reservoirs and surfaces of one frame, rows from the top; reservoir `lane` of a pixel lies a whole image after
/// reservoir `lane - 1`.
#[derive(Clone, Copy)]
pub struct Pixels<'a> {
    /// What pixels see.
    pub gbuffer: &'a [GBufferTexel],
    /// Their reservoirs.
    pub reservoirs: &'a [StoredReservoir],
}

/// Place of reservoir `lane` of `pixel` in a reservoir buffer.
pub fn reservoir_index(frame: &FrameConstants, pixel: UVec2, lane: u32) -> u32 {
    lane * frame.pixels() + frame.pixel_index(pixel)
}

/// Is what `texel` holds like a surface with this normal at this distance? Relative distance and angle, as in
/// Bitterli et al. 2020, section 5.
fn is_similar(settings: &Settings, distance: f32, normal: Vec3, texel: &GBufferTexel) -> bool {
    !texel.is_empty()
        && is_similar_distance(settings, distance, texel)
        && is_similar_normal(settings, normal, texel)
}

/// Is `texel` at nearly this distance (m)?
pub fn is_similar_distance(settings: &Settings, distance: f32, texel: &GBufferTexel) -> bool {
    (texel.distance() - distance).abs() <= settings.depth_threshold * distance
}

/// Has `texel` nearly this normal (unit)?
pub fn is_similar_normal(settings: &Settings, normal: Vec3, texel: &GBufferTexel) -> bool {
    texel.normal().dot(normal) >= settings.normal_threshold
}

/// What samples mean: light that comes from a point, as a receiver sees it. The example `custom_light` implements it for a kind of
/// light of its own.
pub trait Source: Copy {
    /// What a reservoir keeps.
    type Sample: Copy + Default + PartialEq;

    /// `sample` as seen from `receiver` (world space, m), unshadowed; dark for a sample of nothing.
    fn incident(self, sample: Self::Sample, receiver: Vec3) -> Incident;
}

impl Source for LightTable<'_> {
    type Sample = LightSample;

    fn incident(self, sample: LightSample, receiver: Vec3) -> Incident {
        self.lights.incident(sample, receiver)
    }
}

/// p̂ of a reservoir's survivor at `surface`; 0 for a reservoir without one.
pub fn target_of<S: Source>(surface: &Surface, source: S, reservoir: Stored<S::Sample>) -> f32 {
    if reservoir.contribution_weight <= 0.0 {
        return 0.0;
    }
    target_function(surface, &source.incident(reservoir.sample, surface.position))
}

/// Another pixel's reservoir about to be merged, and the ray that asks whether that pixel could have found the canonical
/// sample.
#[derive(Clone, Copy, Debug, Default)]
pub struct CrossProposal<S = LightSample> {
    /// The other pixel's, to be merged.
    pub neighbor: Stored<S>,
    /// But for the answer of the ray.
    pub targets: CrossTargets,
    /// From the other pixel to the canonical sample.
    pub ray: ShadowRay,
    /// 1: both pixels see the same point, and what one sees, the other does. (rust-gpu takes no bool in an Option.)
    pub same_point: u32,
}

impl<S: Copy + Default + PartialEq> CrossProposal<S> {
    /// Reservoir `neighbor` of a pixel that sees `there`, against `canonical` of one that sees `here`.
    pub fn new(
        source: impl Source<Sample = S>,
        here: &Surface,
        canonical: Stored<S>,
        there: &Surface,
        neighbor: Stored<S>,
    ) -> Self {
        let incident = source.incident(canonical.sample, there.position);
        let sees_canonical = canonical.contribution_weight > 0.0;
        CrossProposal {
            neighbor,
            targets: CrossTargets {
                neighbor_at_canonical: target_of(here, source, neighbor),
                neighbor_at_neighbor: target_of(there, source, neighbor),
                canonical_at_neighbor: if sees_canonical { target_function(there, &incident) } else { 0.0 },
            },
            ray: ShadowRay::new(there, &incident),
            same_point: 0,
        }
    }

    /// No ray is worth tracing for nothing, or twice.
    pub fn is_certain(&self) -> bool {
        self.same_point != 0 || self.targets.canonical_at_neighbor == 0.0
    }

    /// The targets once the ray has answered.
    pub fn seen(self, visible: bool) -> CrossTargets {
        let canonical_at_neighbor = if visible { self.targets.canonical_at_neighbor } else { 0.0 };
        CrossTargets { canonical_at_neighbor, ..self.targets }
    }
}

/// A finished reservoir, and the ray of visibility reuse that may still empty it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Survivor<S = LightSample> {
    /// Finished.
    pub reservoir: Stored<S>,
    /// To its sample.
    pub ray: ShadowRay,
    /// An earlier ray has shown the sample to be visible.
    pub seen: bool,
}

impl<S: Copy + Default + PartialEq> Survivor<S> {
    /// `reservoir`, filled at `surface`.
    pub fn new(surface: &Surface, source: impl Source<Sample = S>, reservoir: Stored<S>) -> Self {
        let ray = ShadowRay::new(surface, &source.incident(reservoir.sample, surface.position));
        Survivor { reservoir, ray, seen: false }
    }

    /// A merge at `surface`, which sees the sample of `canonical`.
    pub fn merged(
        surface: &Surface,
        source: impl Source<Sample = S>,
        canonical: Stored<S>,
        reservoir: Stored<S>,
    ) -> Self {
        let seen = canonical.shares_sample_with(reservoir);
        Survivor { seen, ..Survivor::new(surface, source, reservoir) }
    }

    /// Visibility reuse (Bitterli et al. 2020, Alg. 5, line 6): the reservoir, or an empty one where its sample is hidden.
    pub fn kept(self, visible: bool) -> Stored<S> {
        if visible { self.reservoir } else { self.reservoir.occluded() }
    }

    /// No ray is worth tracing for nothing, or twice.
    pub fn is_certain(&self) -> bool {
        self.seen || self.reservoir.contribution_weight == 0.0
    }
}

/// Merges reservoirs by 1/M (Bitterli et al. 2020, Alg. 4).
#[derive(Clone, Copy, Debug, Default)]
pub struct UniformMerge(Reservoir);

impl UniformMerge {
    /// Adds a reservoir with `target` p̂ at the pixel that merges; `u` in [0, 1). MIS weights are known at the end only.
    pub fn add(&mut self, reservoir: StoredReservoir, target: f32, u: f32) -> Weighed {
        let survives = self.0.merge(reservoir, target, u);
        Weighed { mis_weight: 0.0, weight: reservoir.merged_weight(target), survives }
    }

    /// The merged reservoir.
    pub fn finish(self) -> StoredReservoir {
        self.0.finish(self.0.confidence)
    }
}
