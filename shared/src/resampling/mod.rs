//! The three steps of ReSTIR DI, each a pair of pure functions around a ray, and what they share.

pub mod initial;
pub mod moving;
pub mod pairs;
pub mod pairwise;
pub mod spatial;
pub mod temporal;

use crate::frame::{FrameConstants, Settings};
use crate::light::LightTable;
use crate::reservoir::StoredReservoir;
use crate::shadow::ShadowRay;
use crate::surface::{GBufferTexel, Surface};
use crate::target::target_function;
use glam::{UVec2, Vec3};
use pairwise::CrossTargets;

/// The reservoirs and surfaces of one frame, rows from the top; reservoir `lane` of a pixel lies a whole image after
/// reservoir `lane - 1`.
#[derive(Clone, Copy)]
pub struct Pixels<'a> {
    pub gbuffer: &'a [GBufferTexel],
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

pub fn is_similar_distance(settings: &Settings, distance: f32, texel: &GBufferTexel) -> bool {
    (texel.distance() - distance).abs() <= settings.depth_threshold * distance
}

pub fn is_similar_normal(settings: &Settings, normal: Vec3, texel: &GBufferTexel) -> bool {
    texel.normal().dot(normal) >= settings.normal_threshold
}

/// p̂ of a reservoir's survivor at `surface`; 0 for a reservoir without one.
pub fn target_of(surface: &Surface, lights: LightTable<'_>, reservoir: StoredReservoir) -> f32 {
    if reservoir.contribution_weight <= 0.0 {
        return 0.0;
    }
    target_function(surface, &lights.incident(reservoir.sample, surface.position))
}

/// Another pixel's reservoir about to be merged, and the ray that asks whether that pixel could have found the canonical
/// sample.
#[derive(Clone, Copy, Debug, Default)]
pub struct CrossProposal {
    pub neighbor: StoredReservoir,
    pub targets: CrossTargets,
    pub ray: ShadowRay,
    /// 1: both pixels see the same point, and what one sees, the other does. (rust-gpu takes no bool in an Option.)
    pub same_point: u32,
}

impl CrossProposal {
    /// Reservoir `neighbor` of a pixel that sees `there`, against `canonical` of one that sees `here`.
    pub fn new(
        lights: LightTable<'_>,
        here: &Surface,
        canonical: StoredReservoir,
        there: &Surface,
        neighbor: StoredReservoir,
    ) -> Self {
        let incident = lights.incident(canonical.sample, there.position);
        let sees_canonical = canonical.contribution_weight > 0.0;
        CrossProposal {
            neighbor,
            targets: CrossTargets {
                neighbor_at_canonical: target_of(here, lights, neighbor),
                neighbor_at_neighbor: target_of(there, lights, neighbor),
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
