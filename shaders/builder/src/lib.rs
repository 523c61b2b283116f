//! Compiles the `shaders` crate to one .spv an entry point, and writes down what they were made from.

pub mod manifest;

use anyhow::{Context, Result, bail};
use manifest::{Manifest, Toolchain};
use spirv_builder::{Capability, ShaderPanicStrategy, SpirvBuilder, SpirvMetadata};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// SPIR-V 1.5 for Vulkan 1.2.
pub const TARGET: &str = "spirv-unknown-vulkan1.2";

const CAPABILITIES: [Capability; 4] = [
    Capability::RayTracingKHR,
    Capability::RuntimeDescriptorArray,
    Capability::ShaderNonUniform,
    Capability::ImageQuery,
];
const EXTENSIONS: [&str; 1] = ["SPV_KHR_ray_tracing"];

/// Every choice that changes the output and is no source file.
pub fn options() -> String {
    format!("{TARGET} {CAPABILITIES:?} {EXTENSIONS:?} scalar_block_layout metadata=none panic=silent-exit")
}

/// Compiles all entry points in memory: name -> SPIR-V. A warning of the validator or the optimiser is an error.
pub fn compile(workspace: &Path, toolchain: &Toolchain) -> Result<BTreeMap<String, Vec<u8>>> {
    let mut builder = SpirvBuilder::new(workspace.join("shaders"), TARGET)
        .multimodule(true)
        .deny_warnings(true)
        .spirv_metadata(SpirvMetadata::None)
        .shader_panic_strategy(ShaderPanicStrategy::SilentExit)
        .scalar_block_layout(true);
    builder.capabilities = CAPABILITIES.to_vec();
    builder.extensions = EXTENSIONS.iter().map(|e| e.to_string()).collect();
    builder.rustc_codegen_spirv_location = Some(toolchain.backend.clone());
    builder.toolchain_overwrite = Some(toolchain.name.clone());
    builder.build_script.defaults = false;
    let result = builder.build().context("the shaders do not compile")?;
    let mut modules = BTreeMap::new();
    for (entry, path) in result.module.unwrap_multi() {
        let code = std::fs::read(path).with_context(|| format!("can't read {}", path.display()))?;
        modules.insert(entry.clone(), code);
    }
    if modules.is_empty() {
        bail!("the compiler gave no entry point");
    }
    Ok(modules)
}

/// Writes the modules and their manifest to `assets/shaders`, and removes modules that no longer exist.
pub fn write(workspace: &Path, modules: &BTreeMap<String, Vec<u8>>, manifest: &Manifest) -> Result<()> {
    let directory = shader_directory(workspace);
    std::fs::create_dir_all(&directory)?;
    for entry in std::fs::read_dir(&directory)? {
        let path = entry?.path();
        let stem = path.file_stem().and_then(|s| s.to_str()).unwrap_or_default().to_string();
        if path.extension().is_some_and(|e| e == "spv") && !modules.contains_key(&stem) {
            std::fs::remove_file(&path)?;
        }
    }
    for (name, code) in modules {
        replace(&directory.join(format!("{name}.spv")), code)?;
    }
    replace(&directory.join(manifest::FILE), manifest.to_json()?.as_bytes())
}

/// Where the compiled shaders live.
pub fn shader_directory(workspace: &Path) -> PathBuf {
    workspace.join("assets/shaders")
}

/// Writes beside and renames, so that nobody reads half a file.
fn replace(path: &Path, bytes: &[u8]) -> Result<()> {
    let partial = path.with_extension("partial");
    std::fs::write(&partial, bytes).with_context(|| format!("can't write {}", partial.display()))?;
    std::fs::rename(&partial, path).with_context(|| format!("can't write {}", path.display()))
}
