//! `candela render --truth`: the sum over all lights at the points of a picture.

use super::render::RenderArgs;
use candela::error::{Error, Result};
use candela::frame::renderer::{FrameOptions, Renderer};
use candela::image_io::{self, PictureFormat};
use candela_lab::measure::sweep::truth::at_points;
use shared::camera::Camera;
use std::path::Path;

/// Checks, before any work is done, that a truth can be written to `path`, the first of a sequence.
pub fn check(args: &RenderArgs, path: Option<&Path>) -> Result<()> {
    let Some(path) = path else { return Ok(()) };
    let shown = path.display();
    if image_io::check_writable(path)? != PictureFormat::Exr {
        return Err(Error::Usage(format!("--truth {shown}: the truth is written as .exr: rename it")));
    }
    if path == args.picture.output {
        return Err(Error::Usage(format!("--truth {shown}: that is the picture's own file")));
    }
    Ok(())
}

/// Writes [`at_points`] of the last frame of `renderer`, seen from `camera`.
pub fn write(
    path: &Path,
    samples: u32,
    renderer: &mut Renderer,
    camera: Camera,
    options: &FrameOptions,
) -> Result<()> {
    let mean = at_points(renderer, camera, options, samples)?;
    image_io::write_exr(path, renderer.size(), &mean.radiance())
}
