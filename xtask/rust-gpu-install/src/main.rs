//! `rust-gpu-install <shader crate>`: installs the rust-gpu release of the crate's `spirv-std` unless it is there,
//! and prints what the shader builder has to know as `NAME=value` lines.

use anyhow::{Context, Result};
use cargo_gpu_install::install::Install;

fn main() -> Result<()> {
    let shaders = std::env::args_os().nth(1).context("usage: rust-gpu-install <shader crate>")?;
    let backend = Install::from_shader_crate(shaders.into()).run()?;
    println!("RUST_GPU_TOOLCHAIN={}", backend.toolchain_channel);
    println!("RUST_GPU_BACKEND={}", backend.rustc_codegen_spirv_location.display());
    Ok(())
}
