//! Candela's host: scenes, Vulkan, passes, commands.

#[macro_use]
pub mod stdout;

pub mod cli;
pub mod error;
pub mod explain;
pub mod exposure;
pub mod files;
pub mod frame;
pub mod gpu_scene;
pub mod image_io;
pub mod knobs;
pub mod measure;
pub mod parallel;
pub mod scene;
pub mod shader_library;
pub mod startup;
pub mod viewer;
pub mod vulkan;
