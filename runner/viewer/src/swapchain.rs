//! The window's images: taken, drawn on and shown in turn.

use crate::surface::Surface;
use ash::{khr, vk};
use candela::error::{Error, Result};
use candela::vulkan::{Check, Device};

/// Nanoseconds to wait for an image. A window that nobody sees may never get one; the frame is left out then.
const PATIENCE: u64 = 1_000_000_000;

/// The images of a window at one size. The surface must outlive it.
pub struct Swapchain {
    device: Device,
    loader: khr::swapchain::Device,
    handle: vk::SwapchainKHR,
    images: Vec<vk::Image>,
    views: Vec<vk::ImageView>,
    format: vk::Format,
    extent: vk::Extent2D,
    mode: vk::PresentModeKHR,
    /// One for each frame in flight.
    acquired: Vec<vk::Semaphore>,
    /// One for each image.
    rendered: Vec<vk::Semaphore>,
}

/// An image to draw on.
#[derive(Clone, Copy, Debug)]
pub struct Acquired {
    pub index: u32,
    /// Signalled once the image may be drawn on.
    pub ready: vk::Semaphore,
    /// To be signalled once it has been.
    pub rendered: vk::Semaphore,
}

impl Swapchain {
    /// For a window of `size` pixels, with `frames` in flight. `mode` if the surface has it, else FIFO, which all have.
    /// `old`: the one that this one replaces; nothing may be in flight. None while the window has no area (minimised).
    pub fn new(
        device: &Device,
        surface: &Surface,
        size: [u32; 2],
        mode: vk::PresentModeKHR,
        frames: usize,
        old: Option<Swapchain>,
    ) -> Result<Option<Swapchain>> {
        let capabilities = surface.capabilities()?;
        let extent = extent(&capabilities, size);
        if extent.width == 0 || extent.height == 0 {
            return Ok(None);
        }
        let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::TRANSFER_DST;
        if !capabilities.supported_usage_flags.contains(usage) {
            return Err(Error::Unsupported(
                "the window's images can't be copied to; render without one".into(),
            ));
        }
        let format = choose_format(&surface.formats()?);
        let modes = surface.present_modes()?;
        let mode = if modes.contains(&mode) { mode } else { vk::PresentModeKHR::FIFO };
        let opaque = vk::CompositeAlphaFlagsKHR::OPAQUE;
        let alphas = capabilities.supported_composite_alpha;
        let alpha = if alphas.contains(opaque) { opaque } else { vk::CompositeAlphaFlagsKHR::INHERIT };
        let info = vk::SwapchainCreateInfoKHR::default()
            .surface(surface.handle())
            .min_image_count(image_count(&capabilities))
            .image_format(format.format)
            .image_color_space(format.color_space)
            .image_extent(extent)
            .image_array_layers(1)
            .image_usage(usage)
            .image_sharing_mode(vk::SharingMode::EXCLUSIVE)
            .pre_transform(capabilities.current_transform)
            .composite_alpha(alpha)
            .present_mode(mode)
            .clipped(true)
            .old_swapchain(old.as_ref().map_or(vk::SwapchainKHR::null(), |old| old.handle));
        let loader = khr::swapchain::Device::new(device.instance(), device);
        // SAFETY: a create info within what the surface has said.
        let handle = unsafe { loader.create_swapchain(&info, None) }.check("create swapchain")?;
        drop(old);
        let mut swapchain = Swapchain {
            device: device.clone(),
            loader,
            handle,
            images: Vec::new(),
            views: Vec::new(),
            format: format.format,
            extent,
            mode,
            acquired: Vec::new(),
            rendered: Vec::new(),
        };
        swapchain.fill(frames)?;
        Ok(Some(swapchain))
    }

    fn fill(&mut self, frames: usize) -> Result<()> {
        // SAFETY: the swapchain is alive.
        self.images =
            unsafe { self.loader.get_swapchain_images(self.handle) }.check("get swapchain images")?;
        for &image in &self.images {
            let range = vk::ImageSubresourceRange::default()
                .aspect_mask(vk::ImageAspectFlags::COLOR)
                .level_count(1)
                .layer_count(1);
            let info = vk::ImageViewCreateInfo::default()
                .image(image)
                .view_type(vk::ImageViewType::TYPE_2D)
                .format(self.format)
                .subresource_range(range);
            // SAFETY: an image of this format; `drop` destroys the view.
            let view =
                unsafe { self.device.create_image_view(&info, None) }.check("create swapchain view")?;
            self.views.push(view);
        }
        for _ in 0..self.images.len() {
            self.rendered.push(semaphore(&self.device)?);
        }
        for _ in 0..frames {
            self.acquired.push(semaphore(&self.device)?);
        }
        Ok(())
    }

    pub fn format(&self) -> vk::Format {
        self.format
    }

    /// Values written to the images are encoded as sRGB by the device.
    pub fn encodes_srgb(&self) -> bool {
        is_srgb(self.format)
    }

    pub fn extent(&self) -> vk::Extent2D {
        self.extent
    }

    pub fn mode(&self) -> vk::PresentModeKHR {
        self.mode
    }

    pub fn image(&self, index: u32) -> vk::Image {
        self.images[index as usize]
    }

    pub fn views(&self) -> &[vk::ImageView] {
        &self.views
    }

    /// The next image, for the frame in flight `slot`, which must have been waited for. None: the window has changed and
    /// needs a new swapchain, or has no image to give now.
    pub fn acquire(&self, slot: usize) -> Result<Option<Acquired>> {
        let ready = self.acquired[slot];
        // SAFETY: the semaphore was waited for by the frame that had the slot before.
        let next = unsafe { self.loader.acquire_next_image(self.handle, PATIENCE, ready, vk::Fence::null()) };
        match next {
            // A suboptimal image has to be shown all the same; `present` says so again.
            Ok((index, _)) => Ok(Some(Acquired { index, ready, rendered: self.rendered[index as usize] })),
            Err(vk::Result::ERROR_OUT_OF_DATE_KHR | vk::Result::TIMEOUT | vk::Result::NOT_READY) => Ok(None),
            Err(error) => Err(error).check("get an image of the window"),
        }
    }

    /// Shows the image once it has been drawn. False: the window has changed and needs a new swapchain.
    pub fn present(&self, image: &Acquired) -> Result<bool> {
        let (swapchains, indices, wait) = ([self.handle], [image.index], [image.rendered]);
        let info = vk::PresentInfoKHR::default()
            .swapchains(&swapchains)
            .image_indices(&indices)
            .wait_semaphores(&wait);
        let queue = self.device.queue();
        // SAFETY: the image was acquired and its semaphore will be signalled; the queue is locked.
        match unsafe { self.loader.queue_present(*queue, &info) } {
            Ok(suboptimal) => Ok(!suboptimal),
            Err(vk::Result::ERROR_OUT_OF_DATE_KHR) => Ok(false),
            Err(error) => Err(error).check("show a frame"),
        }
    }
}

impl Drop for Swapchain {
    fn drop(&mut self) {
        // The last frames may still be on their way to the screen. A lost device has none.
        let _ = self.device.wait_idle();
        // SAFETY: nothing is in flight.
        unsafe {
            for &semaphore in self.acquired.iter().chain(&self.rendered) {
                self.device.destroy_semaphore(semaphore, None);
            }
            for &view in &self.views {
                self.device.destroy_image_view(view, None);
            }
            self.loader.destroy_swapchain(self.handle, None);
        }
    }
}

fn semaphore(device: &Device) -> Result<vk::Semaphore> {
    // SAFETY: a valid create info; the swapchain destroys it.
    unsafe { device.create_semaphore(&vk::SemaphoreCreateInfo::default(), None) }.check("create semaphore")
}

pub(crate) fn is_srgb(format: vk::Format) -> bool {
    matches!(format, vk::Format::B8G8R8A8_SRGB | vk::Format::R8G8B8A8_SRGB | vk::Format::A8B8G8R8_SRGB_PACK32)
}

/// The display values are encoded already, so a format that stores bytes as they are comes first.
fn choose_format(formats: &[vk::SurfaceFormatKHR]) -> vk::SurfaceFormatKHR {
    use vk::Format as F;
    let wanted = [F::B8G8R8A8_UNORM, F::R8G8B8A8_UNORM, F::A8B8G8R8_UNORM_PACK32];
    let srgb = |f: &&vk::SurfaceFormatKHR| f.color_space == vk::ColorSpaceKHR::SRGB_NONLINEAR;
    let plain = formats.iter().filter(srgb).find(|f| wanted.contains(&f.format));
    let encoding = formats.iter().filter(srgb).find(|f| is_srgb(f.format));
    plain.or(encoding).or(formats.first()).copied().unwrap_or_default()
}

/// The surface's own size where it has one.
fn extent(capabilities: &vk::SurfaceCapabilitiesKHR, size: [u32; 2]) -> vk::Extent2D {
    if capabilities.current_extent.width != u32::MAX {
        return capabilities.current_extent;
    }
    let (min, max) = (capabilities.min_image_extent, capabilities.max_image_extent);
    vk::Extent2D { width: size[0].clamp(min.width, max.width), height: size[1].clamp(min.height, max.height) }
}

/// One more than the least: no wait for the image on the screen.
fn image_count(capabilities: &vk::SurfaceCapabilitiesKHR) -> u32 {
    let most = if capabilities.max_image_count == 0 { u32::MAX } else { capabilities.max_image_count };
    (capabilities.min_image_count + 1).min(most)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn format(format: vk::Format) -> vk::SurfaceFormatKHR {
        vk::SurfaceFormatKHR { format, color_space: vk::ColorSpaceKHR::SRGB_NONLINEAR }
    }

    #[test]
    fn formats_that_keep_bytes_come_first() {
        use vk::Format as F;
        let hdr = vk::SurfaceFormatKHR {
            format: F::R8G8B8A8_UNORM,
            color_space: vk::ColorSpaceKHR::HDR10_ST2084_EXT,
        };
        let chosen = |formats: &[vk::SurfaceFormatKHR]| choose_format(formats).format;
        assert_eq!(chosen(&[hdr, format(F::B8G8R8A8_SRGB), format(F::B8G8R8A8_UNORM)]), F::B8G8R8A8_UNORM);
        assert_eq!(chosen(&[hdr, format(F::B8G8R8A8_SRGB)]), F::B8G8R8A8_SRGB);
        assert_eq!(chosen(&[format(F::R5G6B5_UNORM_PACK16)]), F::R5G6B5_UNORM_PACK16);
    }

    #[test]
    fn sizes_and_counts_follow_the_surface() {
        let mut c = vk::SurfaceCapabilitiesKHR {
            current_extent: vk::Extent2D { width: u32::MAX, height: u32::MAX },
            min_image_extent: vk::Extent2D { width: 1, height: 1 },
            max_image_extent: vk::Extent2D { width: 100, height: 100 },
            min_image_count: 2,
            ..Default::default()
        };
        assert_eq!(extent(&c, [500, 50]), vk::Extent2D { width: 100, height: 50 });
        assert_eq!(image_count(&c), 3);
        c.max_image_count = 2;
        c.current_extent = vk::Extent2D { width: 0, height: 0 };
        assert_eq!((extent(&c, [5, 5]).width, image_count(&c)), (0, 2));
    }
}
