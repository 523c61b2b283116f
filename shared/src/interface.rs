//! What shaders and host must agree on: payloads, bindings, indices. (rust-gpu wants literals in its attributes;
//! a test reads the .spv files and compares them with these.)

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
    /// Spatial: which iteration this is.
    pub iteration: u32,
    /// Reference: the range of lights to add.
    pub first_light: u32,
    pub light_count: u32,
    /// View: one of [`crate::view::kind`], and the measure of distances, m.
    pub view: u32,
    pub scale: f32,
    /// Frames in the running mean, this one included; 0: there is none.
    pub count: u32,
}

/// Miss shaders in the order of the shader binding table.
pub mod miss {
    pub const PRIMARY: u32 = 0;
    pub const SHADOW: u32 = 1;
}

/// Hit groups of passes with two kinds of rays, in the order of the shader binding table; other passes have one.
pub mod hit_group {
    pub const SHADOW: u32 = 0;
    pub const NEAREST: u32 = 1;
}

/// Ids of specialisation constants.
pub mod spec_constant {
    /// [`crate::frame::features`] of the scene.
    pub const FEATURES: u32 = 0;
}

/// Descriptor set 0: the scene, the same for all frames.
pub mod scene_binding {
    pub const SET: u32 = 0;
    pub const TLAS: u32 = 0;
    pub const INSTANCES: u32 = 1;
    pub const POSITIONS: u32 = 2;
    pub const ATTRIBUTES: u32 = 3;
    pub const INDICES: u32 = 4;
    pub const MATERIALS: u32 = 5;
    pub const LIGHTS: u32 = 6;
    pub const ALIAS: u32 = 7;
    pub const SECOND_UVS: u32 = 8;
    pub const ENVIRONMENT: u32 = 9;
    /// The last one: its length varies.
    pub const TEXTURES: u32 = 10;
}

/// Descriptor set 1: the buffers of a frame, pushed for each pass.
pub mod frame_binding {
    pub const SET: u32 = 1;
    pub const CONSTANTS: u32 = 0;
    pub const GBUFFER: u32 = 1;
    pub const PREVIOUS_GBUFFER: u32 = 2;
    pub const RESERVOIRS_IN: u32 = 3;
    pub const RESERVOIRS_OUT: u32 = 4;
    pub const RESERVOIRS_HISTORY: u32 = 5;
    pub const RADIANCE: u32 = 6;
    pub const DISPLAY: u32 = 7;
    pub const TILE_ENTRIES: u32 = 8;
    pub const TILE_POINTS: u32 = 9;
    /// The viewer's: mean over frames, the reference's, sums over blocks of pixels.
    pub const MEAN: u32 = 10;
    pub const REFERENCE: u32 = 11;
    pub const STATISTICS: u32 = 12;
    /// Of the floors: rays to trace again, and whether each met anything.
    pub const RAYS: u32 = 13;
    pub const HITS: u32 = 14;
    /// Which triangle each pixel sees, see [`crate::raster`].
    pub const VISIBILITY: u32 = 15;
    /// See [`crate::resampling::pairs`].
    pub const PAIR_TARGETS: u32 = 16;
}

/// Descriptor set 2: the scene as it was in the previous frame, for passes that ask for it.
pub mod past_binding {
    pub const SET: u32 = 2;
    pub const TLAS: u32 = 0;
    pub const LIGHTS: u32 = 1;
    /// [`crate::motion::InstanceMotion`], one for each of the scene's instance geometries.
    pub const MOTIONS: u32 = 2;
    pub const PREVIOUS_TO_CURRENT: u32 = 3;
    pub const CURRENT_TO_PREVIOUS: u32 = 4;
}

/// Threads of a compute pass's workgroup, in x and y.
pub const WORKGROUP: [u32; 2] = [32, 4];
