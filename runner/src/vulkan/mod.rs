//! Vulkan, as thin as safety allows. Reading order: `device` (of `features`, `handles`, `limits`, `memory`, `samplers`, `queue`), `buffer`, `image`, `commands`, `upload`,
//! `acceleration`, `descriptors`, `pipeline`, `ray_pipeline`, `draw_target`, `draw_pipeline`, `timing`.
//!
//! Modules that documentation hides serve the frame and this workspace's programs alone.
//!
//! Recording takes raw `vk::CommandBuffer`s: whoever records keeps what the commands use alive until they have run.

#[doc(hidden)]
pub mod acceleration;
#[doc(hidden)]
pub mod bottom_level;
pub mod buffer;
pub mod commands;
mod compaction;
#[doc(hidden)]
pub mod descriptors;
pub mod device;
#[doc(hidden)]
pub mod draw_pipeline;
#[doc(hidden)]
pub mod draw_target;
#[doc(hidden)]
pub mod executables;
mod features;
mod handles;
pub mod image;
mod instance;
mod limits;
mod memory;
mod physical;
#[doc(hidden)]
pub mod pipeline;
pub mod pipeline_cache;
mod queue;
#[doc(hidden)]
pub mod ray_pipeline;
mod samplers;
#[doc(hidden)]
pub mod shader_table;
pub mod timing;
#[doc(hidden)]
pub mod top_level;
#[doc(hidden)]
pub mod upload;

#[cfg(test)]
mod testing;

pub use acceleration::{BlasGeometry, BlasSet, Tlas, TlasInstance};
pub use bottom_level::BlasUpdate;
pub use buffer::{Buffer, Memory};
pub use commands::{CommandRing, FrameCommands, Scope, full_barrier, memory_barrier};
pub use descriptors::{Binding, DescriptorSet, PushSet, SetLayout};
pub use device::{Device, DeviceOptions, RawDevice};
pub use draw_pipeline::{DrawPipeline, DrawPipelineDesc};
pub use draw_target::DrawTarget;
pub use features::Features;
pub use image::{Image, ImageDesc};
pub use limits::Limits;
pub use physical::{DeviceInfo, EXTENSIONS};
pub use pipeline::{ComputePipeline, Interface, Pipeline, Shader};
pub use ray_pipeline::{HitGroup, RayPipeline, RayPipelineDesc};
pub use timing::Timestamps;
pub use top_level::TlasUpdate;
pub use upload::Uploader;

use crate::error::{Error, Result};
use ash::vk;
use std::ffi::CString;

/// Turns a failed call into the project's error; `what` was being done ("create buffer 'lights'").
pub trait Check<T> {
    /// The value, or the error of the call that was to do `what`.
    fn check(self, what: impl std::fmt::Display) -> Result<T>;
}

impl<T> Check<T> for Result<T, vk::Result> {
    fn check(self, what: impl std::fmt::Display) -> Result<T> {
        self.map_err(|result| match result {
            vk::Result::ERROR_DEVICE_LOST => Error::DeviceLost(what.to_string()),
            _ => Error::Vulkan { what: what.to_string(), result },
        })
    }
}

/// The smallest multiple of `alignment` (a power of two) that is at least `value`.
pub(crate) const fn align_up(value: u64, alignment: u64) -> u64 {
    (value + alignment - 1) & !(alignment - 1)
}

/// A C string of `text`; a NUL ends it early.
pub(crate) fn c_string(text: &str) -> CString {
    CString::new(text.split('\0').next().unwrap_or_default()).unwrap_or_default()
}

/// Records `f` inside a label that debuggers and profilers show; only `f` where they are absent.
pub fn debug_label<R>(device: &Device, cmd: vk::CommandBuffer, name: &str, f: impl FnOnce() -> R) -> R {
    let Some(debug) = device.debug_utils() else { return f() };
    let name = c_string(name);
    // SAFETY: `cmd` is recording, and `name` outlives the call.
    unsafe { debug.cmd_begin_debug_utils_label(cmd, &vk::DebugUtilsLabelEXT::default().label_name(&name)) };
    let result = f();
    // SAFETY: ends the label that was begun above.
    unsafe { debug.cmd_end_debug_utils_label(cmd) };
    result
}
