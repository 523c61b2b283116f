//! What shaders and host must agree on beside [`crate::resources`]: payloads, push constants, indices.

use crate::passes::indirect::Level;
use bytemuck::{Pod, Zeroable};
use glam::Vec2;

/// Payload of primary rays: what was hit. 24 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct HitPayload {
    /// 1: something was hit, and the other fields are valid.
    pub hit: u32,
    /// Index of its [`crate::geometry::InstanceGeometry`].
    pub instance: u32,
    /// Triangle within that geometry.
    pub primitive: u32,
    /// Weights of the second and third corner.
    pub barycentrics: Vec2,
    /// See [`crate::alpha::key`]; set before the trace.
    pub key: u32,
}

/// Payload of shadow rays. Starts at 0; only the miss shader sets it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ShadowPayload {
    /// 1: nothing lies between the ends of the ray.
    pub visible: u32,
    /// See [`crate::alpha::key`]; set before the trace.
    pub key: u32,
}

/// Push constants of a pass; each pass uses what it needs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct PassConstants {
    /// Which iteration of spatial reuse this is, or which level of paths that go on.
    pub iteration: u32,
    /// Reference: the range of lights to add.
    pub first_light: u32,
    /// How many from there on.
    pub light_count: u32,
    /// Paths: how often light is reflected before it reaches what the pixel sees, at most; [`UNBOUNDED`] for no end.
    pub bounces: u32,
    /// How many paths of each pixel.
    pub paths: u32,
    /// View: one of [`crate::view::kind`], and the measure of distances, m.
    pub view: u32,
    /// Of distances, m.
    pub scale: f32,
    /// Frames in the running mean, this one included; 0: there is none.
    pub count: u32,
    /// Paths that go on: which ones, see [`crate::passes::indirect::LEVELS`].
    pub level: Level,
}

/// Of [`PassConstants::bounces`]: Russian roulette alone ends paths.
pub const UNBOUNDED: u32 = u32::MAX;

/// Miss shaders in the order of the shader binding table.
pub mod miss {
    /// A primary ray.
    pub const PRIMARY: u32 = 0;
    /// A shadow ray.
    pub const SHADOW: u32 = 1;
}

/// Hit groups of passes with two kinds of rays, in the order of the shader binding table; other passes have one.
pub mod hit_group {
    /// Any hit ends the ray.
    pub const SHADOW: u32 = 0;
    /// The nearest hit counts.
    pub const NEAREST: u32 = 1;
}

/// Ids of specialisation constants.
pub mod spec_constant {
    /// [`crate::frame::features`] of the scene.
    pub const FEATURES: u32 = 0;
    /// [`crate::passes::variant`] of the pass.
    pub const VARIANT: u32 = 1;
}

/// Threads of a compute pass's workgroup, in x and y.
pub const WORKGROUP: [u32; 2] = [32, 4];
