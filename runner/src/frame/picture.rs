//! What a frame shows as an image, for an application that samples it or copies it to its window.

use super::history::History;
use crate::error::{Error, Result};
use crate::vulkan::{Device, Image, ImageDesc};
use ash::vk;
use glam::UVec2;
use shared::resources::Resource;

/// Display values of a frame, 8 bits a channel. The view decodes sRGB: samplers read linear values from 0 to 1.
///
/// [`Recorder`](super::recorder::Recorder) has an example.
pub struct Picture {
    image: Image,
    size: UVec2,
}

impl Picture {
    /// `size`: that of the histories, pixels.
    pub fn new(device: &Device, size: UVec2) -> Result<Picture> {
        use vk::ImageUsageFlags as Usage;
        let usage = Usage::TRANSFER_DST | Usage::TRANSFER_SRC | Usage::SAMPLED;
        let (width, height, format) = (size.x, size.y, vk::Format::R8G8B8A8_SRGB);
        let desc = ImageDesc { name: "picture", width, height, format, usage, mips: false };
        Ok(Picture { image: Image::new(device, &desc)?, size })
    }

    /// Records the copy of the frame of `history` that was recorded before it. Later commands find the image in
    /// `SHADER_READ_ONLY_OPTIMAL`.
    ///
    /// # Errors
    /// The history has another size.
    pub fn record(&self, cmd: vk::CommandBuffer, history: &History) -> Result<()> {
        if history.size() != self.size {
            return Err(Error::Internal(format!(
                "a picture of {} is to show a frame of {}",
                self.size,
                history.size()
            )));
        }
        self.image.record_fill(cmd, history.target(Resource::display));
        Ok(())
    }

    /// To bind as a sampled image.
    pub fn view(&self) -> vk::ImageView {
        self.image.view()
    }

    /// To copy or blit from.
    pub fn image(&self) -> &Image {
        &self.image
    }
}
