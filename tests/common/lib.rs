//! What the tests share.

pub mod spirv;
