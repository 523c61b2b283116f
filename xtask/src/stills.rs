//! Tests of `candela denoise` with Open Image Denoise, which PyPI's wheel pyoidn carries.

use crate::{command, models};
use anyhow::{Context, Result};
use std::env::consts::{ARCH, OS};
use std::fs;
use std::path::PathBuf;

const WHEEL: models::Package = models::Package::Wheel("pyoidn", "2.5.1.0");

/// Builds the program with the library and runs its tests; without a wheel for this machine they are left out, and it says so.
pub fn test() -> Result<()> {
    let folder = match library() {
        Ok(folder) => folder,
        Err(error) => {
            println!("stills: tests with Open Image Denoise are left out: {error:#}");
            return Ok(());
        }
    };
    let mut cargo = command::cargo();
    cargo.args(["test", "--workspace", "--features", "candela-cli/oidn", "--test", "stills"]);
    command::run(cargo.env("OIDN_DIR", &folder).env("LD_LIBRARY_PATH", folder.join("lib")))
}

/// The library's folder, downloaded once.
fn library() -> Result<PathBuf> {
    anyhow::ensure!((OS, ARCH) == ("linux", "x86_64"), "the wheel is for Linux on x86-64");
    let to = command::target_dir().join("oidn");
    let folder = to.join("pyoidn/oidn");
    if !folder.join("lib/libOpenImageDenoise.so").exists() {
        let scratch = models::Scratch::new("oidn")?;
        let from = WHEEL.download(&scratch.0)?;
        // Not a rename: temporary folders may lie on another disk.
        fs::create_dir_all(folder.join("lib"))
            .with_context(|| format!("can't create {}", folder.display()))?;
        for file in fs::read_dir(from.join("pyoidn/oidn/lib")).context("the wheel has no library")? {
            let file = file?;
            let name = file.file_name();
            // The name that is looked for comes last.
            if name != "libOpenImageDenoise.so" {
                fs::copy(file.path(), folder.join("lib").join(name))?;
            }
        }
        let last = "lib/libOpenImageDenoise.so";
        fs::copy(from.join("pyoidn/oidn").join(last), folder.join(last))?;
    }
    Ok(folder)
}
