//! The three steps of ReSTIR DI, each a pair of pure functions around a ray, and what they share.

pub mod initial;
pub mod spatial;
pub mod temporal;

use crate::frame::{FrameConstants, Settings};
use crate::reservoir::StoredReservoir;
use crate::surface::GBufferTexel;
use glam::{UVec2, Vec3};

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
        && (texel.distance() - distance).abs() <= settings.depth_threshold * distance
        && texel.normal().dot(normal) >= settings.normal_threshold
}
