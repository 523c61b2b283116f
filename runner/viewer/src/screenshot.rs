//! Screenshots: picture, radiance and settings as files.

use super::frames::Frames;
use super::state::State;
use candela::error::{Error, Result};
use candela::image_io;
use shared::tonemap;
use std::path::{Path, PathBuf};

/// Writes NAME.png (as shown), NAME.exr (radiance, nit) and NAME.json (for `render --settings`) of the left side's last
/// frame, which must be done. Gives NAME: the first candela-001, -002, ... that is free.
pub fn save(directory: &Path, frames: &Frames, state: &State) -> Result<String> {
    let radiance = frames.radiance(state)?;
    let exposure = frames.exposure(state);
    let display: Vec<u32> =
        radiance.iter().map(|&c| tonemap::pack_rgba8(tonemap::display(c, exposure))).collect();
    let path = free_path(directory);
    image_io::write_png(&path.with_extension("png"), frames.size(), &display)?;
    image_io::write_exr(&path.with_extension("exr"), frames.size(), &radiance)?;
    let json = state.settings[0].to_json();
    image_io::replace(&path.with_extension("json"), json.as_bytes())?;
    path.file_name()
        .map(|name| name.to_string_lossy().into_owned())
        .ok_or_else(|| Error::Internal("the screenshot has no name".into()))
}

fn free_path(directory: &Path) -> PathBuf {
    let path = |n: u32| directory.join(format!("candela-{n:03}"));
    let taken = |path: &PathBuf| ["png", "exr", "json"].iter().any(|e| path.with_extension(e).exists());
    (1..).map(path).find(|path| !taken(path)).unwrap_or_else(|| path(0))
}
