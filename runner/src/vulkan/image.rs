//! 2D images with their view and mip chains.

use super::Check;
use super::buffer::Buffer;
use super::commands::Scope;
use super::device::Device;
use super::memory::creation_error;
use crate::error::{Error, Result};
use ash::vk;
use gpu_allocator::MemoryLocation;
use gpu_allocator::vulkan::Allocation;

/// How to make an image.
#[derive(Clone, Copy, Debug)]
pub struct ImageDesc<'a> {
    /// For debuggers and messages.
    pub name: &'a str,
    /// Texels.
    pub width: u32,
    /// Texels.
    pub height: u32,
    /// Of its texels.
    pub format: vk::Format,
    /// What it is for.
    pub usage: vk::ImageUsageFlags,
    /// With all mip levels down to 1 x 1, or just one.
    pub mips: bool,
}

impl<'a> ImageDesc<'a> {
    /// RGBA8, sampled, with mips.
    pub fn texture(name: &'a str, width: u32, height: u32, srgb: bool) -> Self {
        let format = if srgb { vk::Format::R8G8B8A8_SRGB } else { vk::Format::R8G8B8A8_UNORM };
        let copies = vk::ImageUsageFlags::TRANSFER_SRC | vk::ImageUsageFlags::TRANSFER_DST;
        ImageDesc { name, width, height, format, usage: vk::ImageUsageFlags::SAMPLED | copies, mips: true }
    }

    fn levels(&self) -> u32 {
        if self.mips { self.width.max(self.height).max(1).ilog2() + 1 } else { 1 }
    }
}

/// An image of colors or of depths, with memory and view; freed when it drops, so not before the device is done with it.
pub struct Image {
    device: Device,
    handle: vk::Image,
    view: vk::ImageView,
    allocation: Option<Allocation>,
    aspect: vk::ImageAspectFlags,
    width: u32,
    height: u32,
    levels: u32,
}

impl Image {
    /// Content and layout undefined.
    pub fn new(device: &Device, desc: &ImageDesc) -> Result<Image> {
        let &ImageDesc { name, width, height, format, usage, .. } = desc;
        let limit = device.limits().max_image_side;
        if width == 0 || height == 0 || width > limit || height > limit {
            let device = &device.info().name;
            return Err(Error::Unsupported(format!(
                "image '{name}' is {width} x {height}, but {device} takes 1 to {limit} a side"
            )));
        }
        let levels = desc.levels();
        let info = vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .format(format)
            .extent(vk::Extent3D { width, height, depth: 1 })
            .mip_levels(levels)
            .array_layers(1)
            .samples(vk::SampleCountFlags::TYPE_1)
            .usage(usage);
        let bytes = u64::from(width) * u64::from(height) * 4;
        // SAFETY: a valid create info; the handle is destroyed by `drop`.
        let handle = unsafe { device.create_image(&info, None) }
            .map_err(|e| creation_error(e, &format!("image '{name}'"), bytes, MemoryLocation::GpuOnly))?;
        let aspect = match format {
            vk::Format::D32_SFLOAT => vk::ImageAspectFlags::DEPTH,
            _ => vk::ImageAspectFlags::COLOR,
        };
        let view = vk::ImageView::null();
        let mut image =
            Image { device: device.clone(), handle, view, allocation: None, aspect, width, height, levels };
        image.bind(desc)?;
        device.set_name(handle, name);
        device.set_name(image.view, name);
        Ok(image)
    }

    fn bind(&mut self, desc: &ImageDesc) -> Result<()> {
        let (device, name) = (&self.device, desc.name);
        // SAFETY: the image is alive.
        let requirements = unsafe { device.get_image_memory_requirements(self.handle) };
        let allocation = device.allocate(name, requirements, MemoryLocation::GpuOnly, false)?;
        // SAFETY: a fresh allocation for this image's requirements.
        let bound =
            unsafe { device.bind_image_memory(self.handle, allocation.memory(), allocation.offset()) };
        self.allocation = Some(allocation);
        bound.check(format_args!("bind memory to image '{name}'"))?;
        let info = vk::ImageViewCreateInfo::default()
            .image(self.handle)
            .view_type(vk::ImageViewType::TYPE_2D)
            .format(desc.format)
            .subresource_range(self.range(0, self.levels));
        // SAFETY: the image is bound, and the view has its format and levels.
        self.view = unsafe { self.device.create_image_view(&info, None) }
            .check(format_args!("create view of image '{name}'"))?;
        Ok(())
    }

    /// To record with.
    pub fn handle(&self) -> vk::Image {
        self.handle
    }

    /// Of all levels.
    pub fn view(&self) -> vk::ImageView {
        self.view
    }

    /// Width and height, texels.
    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// Mip levels.
    pub fn levels(&self) -> u32 {
        self.levels
    }

    fn range(&self, first: u32, count: u32) -> vk::ImageSubresourceRange {
        vk::ImageSubresourceRange::default()
            .aspect_mask(self.aspect)
            .base_mip_level(first)
            .level_count(count)
            .layer_count(1)
    }

    /// Moves all levels from layout `old` to `new`, after all earlier commands and before all later ones.
    pub fn transition(&self, cmd: vk::CommandBuffer, old: vk::ImageLayout, new: vk::ImageLayout) {
        self.barrier(cmd, 0..self.levels, (old, new), ALL, ALL);
    }

    fn barrier(
        &self,
        cmd: vk::CommandBuffer,
        levels: std::ops::Range<u32>,
        (old, new): (vk::ImageLayout, vk::ImageLayout),
        before: Scope,
        after: Scope,
    ) {
        let barrier = vk::ImageMemoryBarrier::default()
            .image(self.handle)
            .subresource_range(self.range(levels.start, levels.len() as u32))
            .old_layout(old)
            .new_layout(new)
            .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .src_access_mask(before.1)
            .dst_access_mask(after.1);
        let flags = vk::DependencyFlags::empty();
        // SAFETY: `cmd` is recording, and the image has these levels.
        unsafe { self.device.cmd_pipeline_barrier(cmd, before.0, after.0, flags, &[], &[], &[barrier]) };
    }

    /// Copies the tightly packed texels of `buffer`, which transfers see, to level 0 and leaves the image ready to be sampled. Comes
    /// after all earlier commands.
    pub fn record_fill(&self, cmd: vk::CommandBuffer, buffer: &Buffer) {
        use vk::ImageLayout as Layout;
        self.transition(cmd, Layout::UNDEFINED, Layout::TRANSFER_DST_OPTIMAL);
        self.record_upload_rows(cmd, buffer.handle(), 0, 0, self.height);
        self.transition(cmd, Layout::TRANSFER_DST_OPTIMAL, Layout::SHADER_READ_ONLY_OPTIMAL);
    }

    pub(super) fn record_upload_begin(&self, cmd: vk::CommandBuffer) {
        let layouts = (vk::ImageLayout::UNDEFINED, vk::ImageLayout::TRANSFER_DST_OPTIMAL);
        self.barrier(cmd, 0..self.levels, layouts, NOTHING, TRANSFER_WRITE);
    }

    /// Copies `rows` of level 0 from tightly packed texels, after `record_upload_begin`.
    pub(super) fn record_upload_rows(
        &self,
        cmd: vk::CommandBuffer,
        source: vk::Buffer,
        offset: u64,
        y: u32,
        rows: u32,
    ) {
        let copy = vk::BufferImageCopy::default()
            .buffer_offset(offset)
            .image_subresource(layers(0))
            .image_offset(vk::Offset3D { x: 0, y: y as i32, z: 0 })
            .image_extent(vk::Extent3D { width: self.width, height: rows, depth: 1 });
        let layout = vk::ImageLayout::TRANSFER_DST_OPTIMAL;
        // SAFETY: `cmd` is recording, the rows exist on both sides, and the level is in this layout.
        unsafe { self.device.cmd_copy_buffer_to_image(cmd, source, self.handle, layout, &[copy]) };
    }

    /// Copies level 0 to `buffer`, tightly packed; the level must be in the layout for it.
    pub fn record_copy(&self, cmd: vk::CommandBuffer, buffer: &Buffer) {
        let copy = vk::BufferImageCopy::default().image_subresource(layers(0)).image_extent(vk::Extent3D {
            width: self.width,
            height: self.height,
            depth: 1,
        });
        let layout = vk::ImageLayout::TRANSFER_SRC_OPTIMAL;
        // SAFETY: `cmd` is recording, and the owner made the buffer for these texels.
        unsafe { self.device.cmd_copy_image_to_buffer(cmd, self.handle, layout, buffer.handle(), &[copy]) };
    }

    /// Fills levels 1.. from level 0, each from the one before, and leaves all ready to be sampled.
    pub(super) fn record_mips(&self, cmd: vk::CommandBuffer) {
        use vk::ImageLayout as Layout;
        let (source, target) = (Layout::TRANSFER_SRC_OPTIMAL, Layout::TRANSFER_DST_OPTIMAL);
        for level in 1..self.levels {
            self.barrier(cmd, level - 1..level, (target, source), TRANSFER_WRITE, TRANSFER_READ);
            let blit = vk::ImageBlit::default()
                .src_subresource(layers(level - 1))
                .src_offsets([vk::Offset3D::default(), self.corner(level - 1)])
                .dst_subresource(layers(level))
                .dst_offsets([vk::Offset3D::default(), self.corner(level)]);
            let filter = vk::Filter::LINEAR;
            // SAFETY: `cmd` is recording, and each level is in the layout that is given.
            unsafe {
                self.device.cmd_blit_image(cmd, self.handle, source, self.handle, target, &[blit], filter)
            };
        }
        let last = self.levels - 1;
        let sampled = Layout::SHADER_READ_ONLY_OPTIMAL;
        if last > 0 {
            self.barrier(cmd, 0..last, (source, sampled), TRANSFER_READ, ALL);
        }
        self.barrier(cmd, last..self.levels, (target, sampled), TRANSFER_WRITE, ALL);
    }

    /// The far corner of a level.
    fn corner(&self, level: u32) -> vk::Offset3D {
        let side = |texels: u32| (texels >> level).max(1) as i32;
        vk::Offset3D { x: side(self.width), y: side(self.height), z: 1 }
    }
}

const NOTHING: Scope = (vk::PipelineStageFlags::TOP_OF_PIPE, vk::AccessFlags::empty());
const TRANSFER_READ: Scope = (vk::PipelineStageFlags::TRANSFER, vk::AccessFlags::TRANSFER_READ);
const TRANSFER_WRITE: Scope = (vk::PipelineStageFlags::TRANSFER, vk::AccessFlags::TRANSFER_WRITE);
const ALL: Scope = (
    vk::PipelineStageFlags::ALL_COMMANDS,
    vk::AccessFlags::from_raw(vk::AccessFlags::MEMORY_READ.as_raw() | vk::AccessFlags::MEMORY_WRITE.as_raw()),
);

fn layers(level: u32) -> vk::ImageSubresourceLayers {
    vk::ImageSubresourceLayers::default()
        .aspect_mask(vk::ImageAspectFlags::COLOR)
        .mip_level(level)
        .layer_count(1)
}

impl Drop for Image {
    fn drop(&mut self) {
        // SAFETY: the owner keeps an image until the device is done with it.
        unsafe {
            self.device.destroy_image_view(self.view, None);
            self.device.destroy_image(self.handle, None);
        }
        if let Some(allocation) = self.allocation.take() {
            self.device.free(allocation);
        }
    }
}
