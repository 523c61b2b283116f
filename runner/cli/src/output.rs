//! Output of commands: the picture, and messages of the validation layer.

use super::accumulation::Content;
use super::args::PictureArgs;
use candela::error::{Error, Result};
use candela::exposure;
use candela::image_io::{self, PictureFormat};
use candela::vulkan::Device;
use std::path::Path;

/// Checks, before any work is done, that the picture can be written to `path` as it was asked for.
pub fn check(path: &Path, args: &PictureArgs) -> Result<PictureFormat> {
    let format = image_io::format_of(path)?;
    if args.layers && format != PictureFormat::Exr {
        let path = path.display();
        return Err(Error::Usage(format!(
            "{path}: layers need an .exr: rename the picture, or leave --layers out"
        )));
    }
    image_io::check_writable(path)
}

/// Writes a picture as it was asked for, under the exposure that was metered, or by itself.
pub fn write(
    content: Content,
    format: PictureFormat,
    args: &PictureArgs,
    metered: Option<f32>,
) -> Result<()> {
    let exposure = match metered {
        Some(exposure) => exposure * args.exposure.exp2(),
        None => exposure::automatic(content.radiance(), args.exposure),
    };
    image_io::replace(&args.output, &content.encode(format, exposure)?)?;
    println!("wrote {}", args.output.display());
    Ok(())
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
