//! Candela: scenes, their data on the GPU, and the frames that light them.

pub mod error;
pub mod exposure;
pub mod files;
pub mod frame;
pub mod gpu_scene;
pub mod image_io;
pub mod knobs;
pub mod parallel;
pub mod scene;
pub mod startup;
pub mod vulkan;

// What the library's own types are made of, in the versions that it takes.
pub use ash;
pub use gpu_allocator;
pub use shared;
