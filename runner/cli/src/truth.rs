//! `candela render --truth`: the sum over all lights at the points of a picture.

use super::render::RenderArgs;
use candela::error::{Error, Result};
use candela::frame::renderer::{FrameOptions, Renderer};
use candela::frame::schedule::Work;
use candela::image_io::{self, PictureFormat};
use candela_lab::measure::mean::Mean;
use candela_lab::measure::sweep::truth::{Lighting, PATHS_A_FRAME};
use shared::camera::Camera;
use shared::frame::indirect;
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

/// Writes the sum over all lights at the points that the last frame of `renderer`, seen from `camera`, shaded; with light that bounces
/// if that frame has it. Where lights have an
/// extent or something is transparent, the mean of `samples` such sums. The frame after it knows nothing of it.
pub fn write(
    path: &Path,
    samples: u32,
    renderer: &mut Renderer,
    camera: Camera,
    options: &FrameOptions,
) -> Result<()> {
    let bounces = match options.work {
        Work::Restir(settings) => indirect::bounces(settings.indirect),
        _ => 0,
    };
    let lighting = Lighting { bounces, ..Lighting::new(renderer.scene(), options.primary) };
    let mut mean = Mean::new(renderer.size());
    for sample in 0..if lighting.is_exact() { 1 } else { samples } {
        let seed = options.seed.wrapping_add(SEED + sample);
        let mut frame = |work| {
            renderer.render(camera, &FrameOptions { work, seed, parts: false, ..*options })?;
            renderer.radiance()
        };
        let mut radiance = frame(Work::Truth { lights: lighting.lights })?;
        if bounces > 0 {
            let paths = frame(Work::TruthPaths { bounces, paths: PATHS_A_FRAME })?;
            radiance.iter_mut().zip(paths).for_each(|(sum, paths)| *sum += paths);
        }
        mean.add(&radiance);
    }
    image_io::write_exr(path, renderer.size(), &mean.radiance())
}

/// Far from the seed of what is judged.
const SEED: u32 = 0x7472_7574;
