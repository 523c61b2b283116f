//! What commands leave behind: the picture, and a verdict of the validation layer.

use super::accumulation::Accumulation;
use super::args::PictureArgs;
use crate::error::{Error, Result};
use crate::exposure;
use crate::frame::renderer::Renderer;
use crate::image_io::{self, PictureFormat};
use crate::vulkan::Device;
use glam::Vec3;
use shared::camera::Camera;
use shared::tonemap;
use std::path::Path;

/// Checks, before any work is done, that the picture can be written to `path` as it was asked for.
pub fn check(path: &Path, args: &PictureArgs) -> Result<PictureFormat> {
    let format = image_io::format_of(path)?;
    if args.layers && format != PictureFormat::Exr {
        let path = path.display();
        return Err(Error::Usage(format!(
            "{path}: only .exr files have layers: name it so, or leave --layers out"
        )));
    }
    image_io::check_writable(path)
}

/// A picture to write.
pub struct Picture<'a> {
    pub frames: &'a Accumulation,
    /// Has rendered them, from `camera`.
    pub renderer: &'a Renderer,
    pub camera: Camera,
    pub format: PictureFormat,
}

impl Picture<'_> {
    /// Writes it as it was asked for, under the exposure that was metered, or by itself.
    pub fn write(&self, args: &PictureArgs, metered: Option<f32>) -> Result<()> {
        let exposure = match metered {
            Some(exposure) => exposure * args.exposure.exp2(),
            None => exposure::automatic(&self.frames.radiance(), args.exposure),
        };
        self.write_exposed(&args.output, exposure)?;
        println!("wrote {}", args.output.display());
        Ok(())
    }

    /// Writes it to `path`. `exposure`: factor to display values, where the format has such.
    pub fn write_exposed(&self, path: &Path, exposure: f32) -> Result<()> {
        match self.format {
            PictureFormat::Exr => self.frames.write_exr(path, self.renderer, self.camera),
            PictureFormat::Png => {
                let pixel = |&radiance: &Vec3| tonemap::pack_rgba8(tonemap::display(radiance, exposure));
                let display: Vec<u32> = self.frames.radiance().iter().map(pixel).collect();
                image_io::write_png(path, self.renderer.size(), &display)
            }
        }
    }
}

/// Under `--validate`, a message of the layer is an error.
pub fn check_validation(device: &Device) -> Result<()> {
    let messages = device.validation_messages();
    match messages.first() {
        None => Ok(()),
        Some(first) => {
            Err(Error::Check(format!("{} validation messages, the first: {first}", messages.len())))
        }
    }
}
