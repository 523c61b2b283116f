//! Candela's host: scenes, Vulkan, passes, commands.
pub mod error;
pub mod scene;
pub mod vulkan;
