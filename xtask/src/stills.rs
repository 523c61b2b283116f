//! Tests of `candela denoise` with Open Image Denoise, which PyPI's wheel pyoidn carries.

use crate::{command, models};
use anyhow::{Context, Result};
use std::env::consts::{ARCH, OS};
use std::fs;
use std::path::PathBuf;

const WHEEL: models::Package = models::Package::Wheel("pyoidn", "2.5.1.0");

/// Builds the program with the library and runs its tests; where no wheel can be had they are left out, and it says so.
pub fn test() -> Result<()> {
    let Some(folder) = library()? else { return Ok(()) };
    let mut cargo = command::cargo();
    cargo.args(["test", "--workspace", "--features", "candela-cli/oidn", "--test", "stills"]);
    command::run(cargo.env("OIDN_DIR", &folder).env("LD_LIBRARY_PATH", folder.join("lib")))
}

/// The library's folder, downloaded once; none without a wheel.
fn library() -> Result<Option<PathBuf>> {
    let left_out = |why: &str| println!("stills: tests with Open Image Denoise are left out: {why}");
    if (OS, ARCH) != ("linux", "x86_64") {
        left_out("the wheel is for Linux on x86-64");
        return Ok(None);
    }
    let folder = command::target_dir().join("oidn");
    let (lib, last) = (folder.join("lib"), "libOpenImageDenoise.so");
    if !lib.join(last).exists() {
        let scratch = models::Scratch::new("oidn")?;
        let wheel = match WHEEL.download(&scratch.0) {
            Ok(wheel) => wheel.join("pyoidn/oidn/lib"),
            Err(error) => {
                left_out(&format!("{error:#}"));
                return Ok(None);
            }
        };
        // Not a rename: temporary folders may lie on another disk.
        fs::create_dir_all(&lib).with_context(|| format!("can't create {}", lib.display()))?;
        for file in fs::read_dir(&wheel).context("the wheel has no library")? {
            let file = file?;
            // The name that is looked for comes last.
            if file.path().is_file() && file.file_name() != last {
                fs::copy(file.path(), lib.join(file.file_name()))?;
            }
        }
        fs::copy(wheel.join(last), lib.join(last))?;
    }
    Ok(Some(folder))
}
