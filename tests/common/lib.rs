//! What the tests share: a device, scenes with known answers, statistics, pictures of what went wrong.

pub mod docs;
pub mod equations;
pub mod failure;
pub mod gpu;
pub mod outside;
pub mod primary;
pub mod scenes;
pub mod spirv;
pub mod statistics;
