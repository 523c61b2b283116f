//! The window's side of a frame: its images, the picture that is copied to them, the interface on top.

use super::gui::Gui;
use crate::surface::Surface;
use crate::swapchain::{Acquired, Swapchain};
use ash::vk;
use candela::error::Result;
use candela::vulkan::{Buffer, CommandRing, Device, Image, ImageDesc};
use glam::UVec2;
use std::sync::Arc;
use winit::window::Window;

/// Frames that may be on their way at once.
pub const FRAMES: usize = 2;

/// Display values, and from which column on they are shown.
pub struct Part<'a> {
    pub display: &'a Buffer,
    pub from: u32,
}

pub struct Screen {
    device: Device,
    gui: Option<Gui>,
    swapchain: Option<Swapchain>,
    picture: Option<Image>,
    surface: Surface,
    mode: vk::PresentModeKHR,
    /// Of the window, pixels.
    size: UVec2,
    /// The window has changed since the swapchain was made.
    stale: bool,
    window: Arc<Window>,
}

impl Screen {
    pub fn new(device: &Device, window: Arc<Window>, mode: vk::PresentModeKHR) -> Result<Screen> {
        let size = window.inner_size();
        Ok(Screen {
            device: device.clone(),
            gui: None,
            swapchain: None,
            picture: None,
            surface: Surface::new(device, &*window)?,
            mode,
            size: UVec2::new(size.width, size.height),
            stale: true,
            window,
        })
    }

    pub fn gui(&mut self) -> Option<&mut Gui> {
        self.gui.as_mut()
    }

    /// Pixels of the window's images; `None` while it has none.
    pub fn size(&self) -> Option<UVec2> {
        let extent = self.swapchain.as_ref()?.extent();
        Some(UVec2::new(extent.width, extent.height))
    }

    pub fn mode(&self) -> vk::PresentModeKHR {
        self.swapchain.as_ref().map_or(self.mode, Swapchain::mode)
    }

    /// The window's new size.
    pub fn resize(&mut self, size: UVec2) {
        self.stale |= size != self.size;
        self.size = size;
    }

    /// The next of the present modes that the surface has.
    pub fn next_mode(&mut self) -> Result<()> {
        let modes = self.surface.present_modes()?;
        let at = modes.iter().position(|&mode| mode == self.mode()).map_or(0, |at| at + 1);
        if let Some(&mode) = modes.get(at % modes.len().max(1)) {
            self.mode = mode;
            self.stale = true;
        }
        Ok(())
    }

    /// Makes the swapchain anew where the window has changed. False: there is nothing to draw on now.
    pub fn refresh(&mut self, ring: &mut CommandRing) -> Result<bool> {
        if !self.stale {
            return Ok(self.swapchain.is_some());
        }
        ring.wait()?;
        self.device.wait_idle()?;
        let old = self.swapchain.take();
        let size = self.size.to_array();
        self.swapchain = Swapchain::new(&self.device, &self.surface, size, self.mode, FRAMES, old)?;
        let Some(swapchain) = &self.swapchain else { return Ok(false) };
        self.stale = false;
        match &mut self.gui {
            Some(gui) => gui.retarget(swapchain)?,
            None => self.gui = Some(Gui::new(&self.device, &self.window, swapchain, FRAMES)?),
        }
        Ok(true)
    }

    /// Has a picture been shown since its size last changed?
    pub fn has_picture(&self) -> bool {
        self.picture.is_some()
    }

    /// The next image, for the frame in flight `slot`; `None`: leave this frame out.
    pub fn acquire(&mut self, slot: usize) -> Result<Option<Acquired>> {
        let Some(swapchain) = &self.swapchain else { return Ok(None) };
        let image = swapchain.acquire(slot)?;
        self.stale |= image.is_none();
        Ok(image)
    }

    /// Copies the parts (RGBA8, `size` pixels each, first columns first) to the window's image, then draws the interface.
    /// Without parts the last picture stays.
    pub fn record(
        &mut self,
        cmd: vk::CommandBuffer,
        slot: usize,
        image: &Acquired,
        size: UVec2,
        parts: &[Part],
    ) -> Result<()> {
        let Some(swapchain) = &self.swapchain else { return Ok(()) };
        let fits = self.picture.as_ref().map(Image::size) == Some((size.x, size.y));
        if !fits && !parts.is_empty() {
            self.picture = Some(picture(&self.device, size, swapchain.encodes_srgb())?);
        }
        if let Some(picture) = &self.picture {
            if !parts.is_empty() {
                record_parts(&self.device, cmd, picture, size, parts);
            }
            record_blit(&self.device, cmd, picture, swapchain, image.index);
        }
        if let Some(gui) = &mut self.gui {
            gui.record(cmd, slot, image.index)?;
        }
        Ok(())
    }

    /// Shows the image.
    pub fn present(&mut self, image: &Acquired) -> Result<()> {
        if let Some(swapchain) = &self.swapchain {
            self.stale |= !swapchain.present(image)?;
        }
        Ok(())
    }

    /// Everything of the picture's size has to be made anew; nothing may be in flight.
    pub fn forget_picture(&mut self) {
        self.picture = None;
    }
}

fn picture(device: &Device, size: UVec2, srgb: bool) -> Result<Image> {
    let usage =
        vk::ImageUsageFlags::TRANSFER_SRC | vk::ImageUsageFlags::TRANSFER_DST | vk::ImageUsageFlags::SAMPLED;
    // The values are encoded: they are copied to an encoding image as they are.
    let format = if srgb { vk::Format::R8G8B8A8_SRGB } else { vk::Format::R8G8B8A8_UNORM };
    let desc = ImageDesc { name: "picture", width: size.x, height: size.y, format, usage, mips: false };
    Image::new(device, &desc)
}

const COLOR: vk::ImageSubresourceLayers = vk::ImageSubresourceLayers {
    aspect_mask: vk::ImageAspectFlags::COLOR,
    mip_level: 0,
    base_array_layer: 0,
    layer_count: 1,
};

/// Columns of each part, from its first to the next one's, into `picture`.
fn record_parts(device: &Device, cmd: vk::CommandBuffer, picture: &Image, size: UVec2, parts: &[Part]) {
    use vk::ImageLayout as Layout;
    picture.transition(cmd, Layout::UNDEFINED, Layout::TRANSFER_DST_OPTIMAL);
    for (i, part) in parts.iter().enumerate() {
        let end = parts.get(i + 1).map_or(size.x, |next| next.from).min(size.x);
        if part.from >= end {
            continue;
        }
        let region = vk::BufferImageCopy::default()
            .buffer_offset(4 * u64::from(part.from))
            .buffer_row_length(size.x)
            .image_subresource(COLOR)
            .image_offset(vk::Offset3D { x: part.from as i32, y: 0, z: 0 })
            .image_extent(vk::Extent3D { width: end - part.from, height: size.y, depth: 1 });
        // SAFETY: the buffer holds `size` pixels of 4 bytes, and the image has this size and layout.
        unsafe {
            device.cmd_copy_buffer_to_image(
                cmd,
                part.display.handle(),
                picture.handle(),
                Layout::TRANSFER_DST_OPTIMAL,
                &[region],
            );
        }
    }
    picture.transition(cmd, Layout::TRANSFER_DST_OPTIMAL, Layout::TRANSFER_SRC_OPTIMAL);
}

/// The whole picture onto the whole image, channels in the image's order; then ready to be drawn over.
fn record_blit(device: &Device, cmd: vk::CommandBuffer, picture: &Image, swapchain: &Swapchain, index: u32) {
    use vk::{AccessFlags as Access, ImageLayout as Layout, PipelineStageFlags as Stage};
    let target = swapchain.image(index);
    let corner = |(x, y): (u32, u32)| vk::Offset3D { x: x as i32, y: y as i32, z: 1 };
    let extent = swapchain.extent();
    let blit = vk::ImageBlit::default()
        .src_subresource(COLOR)
        .src_offsets([vk::Offset3D::default(), corner(picture.size())])
        .dst_subresource(COLOR)
        .dst_offsets([vk::Offset3D::default(), corner((extent.width, extent.height))]);
    let barrier = |old, new, before, after, (from, to)| {
        let range = vk::ImageSubresourceRange::default()
            .aspect_mask(vk::ImageAspectFlags::COLOR)
            .level_count(1)
            .layer_count(1);
        let barrier = vk::ImageMemoryBarrier::default()
            .image(target)
            .old_layout(old)
            .new_layout(new)
            .src_access_mask(from)
            .dst_access_mask(to)
            .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .subresource_range(range);
        let flags = vk::DependencyFlags::empty();
        // SAFETY: `cmd` is recording, and the image is ours until it is presented.
        unsafe { device.cmd_pipeline_barrier(cmd, before, after, flags, &[], &[], &[barrier]) };
    };
    // The image is waited for at the transfer stage; its old content does not matter.
    let write = Access::TRANSFER_WRITE;
    let none = Access::empty();
    barrier(Layout::UNDEFINED, Layout::TRANSFER_DST_OPTIMAL, Stage::TRANSFER, Stage::TRANSFER, (none, write));
    let (source, destination) = (Layout::TRANSFER_SRC_OPTIMAL, Layout::TRANSFER_DST_OPTIMAL);
    // SAFETY: both images have these sizes and layouts.
    unsafe {
        device.cmd_blit_image(
            cmd,
            picture.handle(),
            source,
            target,
            destination,
            &[blit],
            vk::Filter::NEAREST,
        );
    }
    let draw = Access::COLOR_ATTACHMENT_READ | Access::COLOR_ATTACHMENT_WRITE;
    let attachment = Layout::COLOR_ATTACHMENT_OPTIMAL;
    barrier(destination, attachment, Stage::TRANSFER, Stage::COLOR_ATTACHMENT_OUTPUT, (write, draw));
}
