//! What the committed shaders were made from: a stale .spv is impossible to miss.

use anyhow::{Context, Result, bail};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

pub const FILE: &str = "manifest.json";

/// Crates of the lock file whose versions change what the shaders become.
const SHADER_DEPENDENCIES: [&str; 12] = [
    "bytemuck",
    "bytemuck_derive",
    "glam",
    "libm",
    "num-traits",
    "spirv-builder",
    "spirv-std",
    "spirv-std-macros",
    "spirv-std-types",
    "bitflags",
    "rustc_codegen_spirv-types",
    "rustc_codegen_spirv-target-specs",
];

/// The rust-gpu compiler: a rustup toolchain and its code generator.
#[derive(Clone, Debug)]
pub struct Toolchain {
    /// Name that rustup knows it by.
    pub name: String,
    /// librustc_codegen_spirv.so
    pub backend: PathBuf,
}

/// `assets/shaders/manifest.json`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Manifest {
    /// `rustc --version` of the toolchain and the SHA-256 of its code generator.
    pub compiler: String,
    pub backend: String,
    /// Target, capabilities, everything that is no file.
    pub options: String,
    /// Path from the workspace -> SHA-256.
    pub sources: BTreeMap<String, String>,
    /// Crate -> version, as locked.
    pub dependencies: BTreeMap<String, String>,
    /// Entry point (and file stem) -> SHA-256 of its .spv.
    pub modules: BTreeMap<String, String>,
}

impl Toolchain {
    /// From `RUST_GPU_TOOLCHAIN` and `RUST_GPU_BACKEND`.
    pub fn from_environment() -> Result<Self> {
        let variable = |name| {
            std::env::var(name).with_context(|| format!("{name} is not set; run `cargo xtask shaders`"))
        };
        Ok(Toolchain { name: variable("RUST_GPU_TOOLCHAIN")?, backend: variable("RUST_GPU_BACKEND")?.into() })
    }

    fn version(&self) -> Result<String> {
        let toolchain = format!("+{}", self.name);
        let output =
            Command::new("rustc").args([&toolchain, "--version"]).output().context("can't run rustc")?;
        if !output.status.success() {
            bail!("rustup has no toolchain '{}'", self.name);
        }
        Ok(String::from_utf8_lossy(&output.stdout).trim().to_string())
    }
}

impl Manifest {
    /// The manifest of `modules`, compiled from the sources as they are now.
    pub fn new(workspace: &Path, toolchain: &Toolchain, modules: &BTreeMap<String, Vec<u8>>) -> Result<Self> {
        let backend = std::fs::read(&toolchain.backend)
            .with_context(|| format!("can't read {}", toolchain.backend.display()))?;
        Ok(Manifest {
            compiler: toolchain.version()?,
            backend: sha256(&backend),
            options: crate::options(),
            sources: source_hashes(workspace)?,
            dependencies: locked_versions(workspace)?,
            modules: modules.iter().map(|(name, code)| (name.clone(), sha256(code))).collect(),
        })
    }

    pub fn read(workspace: &Path) -> Result<Self> {
        let path = crate::shader_directory(workspace).join(FILE);
        let text =
            std::fs::read_to_string(&path).with_context(|| format!("can't read {}", path.display()))?;
        serde_json::from_str(&text).with_context(|| format!("{} is no manifest", path.display()))
    }

    pub fn to_json(&self) -> Result<String> {
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }

    /// What differs between this manifest and the workspace as it is now: one line each; empty when all is fresh.
    pub fn stale(&self, workspace: &Path) -> Result<Vec<String>> {
        let mut lines = differences("source", &self.sources, &source_hashes(workspace)?);
        lines.extend(differences("dependency", &self.dependencies, &locked_versions(workspace)?));
        if self.options != crate::options() {
            lines.push("compiler options changed".into());
        }
        let mut present = BTreeMap::new();
        for path in files(&crate::shader_directory(workspace), "spv")? {
            let stem = path.file_stem().and_then(|s| s.to_str()).unwrap_or_default().to_string();
            present.insert(stem, sha256(&std::fs::read(&path)?));
        }
        lines.extend(differences("module", &self.modules, &present));
        Ok(lines)
    }

    /// Is `toolchain` the one that the committed modules were compiled with, so that a rebuild must give the same bytes?
    pub fn is_made_by(&self, toolchain: &Toolchain) -> Result<bool> {
        let backend = std::fs::read(&toolchain.backend)
            .with_context(|| format!("can't read {}", toolchain.backend.display()))?;
        Ok(self.compiler == toolchain.version()? && self.backend == sha256(&backend))
    }
}

fn differences(
    what: &str,
    recorded: &BTreeMap<String, String>,
    now: &BTreeMap<String, String>,
) -> Vec<String> {
    let mut names: Vec<_> = recorded.keys().chain(now.keys()).collect();
    names.sort();
    names.dedup();
    let changed = |name: &&&String| recorded.get(**name) != now.get(**name);
    names
        .iter()
        .filter(changed)
        .map(|name| format!("{what} {name} changed since the shaders were compiled"))
        .collect()
}

fn source_hashes(workspace: &Path) -> Result<BTreeMap<String, String>> {
    let mut paths = vec![workspace.join("shaders/Cargo.toml"), workspace.join("shared/Cargo.toml")];
    for directory in ["shaders/src", "shared/src"] {
        paths.extend(files(&workspace.join(directory), "rs")?);
    }
    let mut hashes = BTreeMap::new();
    for path in paths {
        let text = std::fs::read(&path).with_context(|| format!("can't read {}", path.display()))?;
        let name = path.strip_prefix(workspace)?.to_string_lossy().replace('\\', "/");
        hashes.insert(name, sha256(&text));
    }
    Ok(hashes)
}

/// All files below `directory` with this extension.
fn files(directory: &Path, extension: &str) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    let entries =
        std::fs::read_dir(directory).with_context(|| format!("can't read {}", directory.display()))?;
    for entry in entries {
        let path = entry?.path();
        if path.is_dir() {
            found.extend(files(&path, extension)?);
        } else if path.extension().is_some_and(|e| e == extension) {
            found.push(path);
        }
    }
    Ok(found)
}

/// Versions of [`SHADER_DEPENDENCIES`] in Cargo.lock.
fn locked_versions(workspace: &Path) -> Result<BTreeMap<String, String>> {
    let lock = std::fs::read_to_string(workspace.join("Cargo.lock")).context("can't read Cargo.lock")?;
    let mut versions = BTreeMap::new();
    let mut name = None;
    for line in lock.lines() {
        let value = |key: &str| line.strip_prefix(key).map(|v| v.trim_matches('"').to_string());
        if let Some(found) = value("name = ") {
            name = Some(found).filter(|n| SHADER_DEPENDENCIES.contains(&n.as_str()));
        } else if let (Some(version), Some(name)) = (value("version = "), name.take()) {
            versions.insert(name, version);
        }
    }
    Ok(versions)
}

pub fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}
