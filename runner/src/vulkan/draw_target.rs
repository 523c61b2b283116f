//! The target of the graphics pipeline: two integers a pixel, with reversed depth (0 is infinitely far).

use super::Check;
use super::buffer::Buffer;
use super::device::Device;
use super::image::{Image, ImageDesc};
use crate::error::{Error, Result};
use ash::vk;
use glam::UVec2;

const COLOR: vk::Format = vk::Format::R32G32_UINT;
const DEPTH: vk::Format = vk::Format::D32_SFLOAT;

/// Clears both, draws, and leaves the integers to be copied. All render passes of this kind are compatible.
pub(super) struct RenderPass {
    device: Device,
    pub handle: vk::RenderPass,
}

impl RenderPass {
    pub fn new(device: &Device) -> Result<RenderPass> {
        use vk::ImageLayout as Layout;
        let store = [vk::AttachmentStoreOp::STORE, vk::AttachmentStoreOp::DONT_CARE];
        let end = [Layout::TRANSFER_SRC_OPTIMAL, Layout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL];
        let attachments = std::array::from_fn::<_, 2, _>(|i| {
            vk::AttachmentDescription::default()
                .format([COLOR, DEPTH][i])
                .samples(vk::SampleCountFlags::TYPE_1)
                .load_op(vk::AttachmentLoadOp::CLEAR)
                .store_op(store[i])
                .stencil_load_op(vk::AttachmentLoadOp::DONT_CARE)
                .stencil_store_op(vk::AttachmentStoreOp::DONT_CARE)
                .initial_layout(Layout::UNDEFINED)
                .final_layout(end[i])
        });
        let colors = [vk::AttachmentReference::default().layout(Layout::COLOR_ATTACHMENT_OPTIMAL)];
        let depth =
            vk::AttachmentReference::default().attachment(1).layout(Layout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL);
        let subpasses = [vk::SubpassDescription::default()
            .pipeline_bind_point(vk::PipelineBindPoint::GRAPHICS)
            .color_attachments(&colors)
            .depth_stencil_attachment(&depth)];
        let dependencies = dependencies();
        let info = vk::RenderPassCreateInfo::default()
            .attachments(&attachments)
            .subpasses(&subpasses)
            .dependencies(&dependencies);
        // SAFETY: a valid create info; `drop` destroys the pass.
        let handle = unsafe { device.create_render_pass(&info, None) }.check("create render pass")?;
        Ok(RenderPass { device: device.clone(), handle })
    }
}

/// Drawing waits for the last drawing and its copy; the copy waits for drawing.
fn dependencies() -> [vk::SubpassDependency; 2] {
    use vk::{AccessFlags as Access, PipelineStageFlags as Stage};
    let tests = Stage::EARLY_FRAGMENT_TESTS | Stage::LATE_FRAGMENT_TESTS;
    let draws = tests | Stage::COLOR_ATTACHMENT_OUTPUT;
    let writes = Access::COLOR_ATTACHMENT_WRITE | Access::DEPTH_STENCIL_ATTACHMENT_WRITE;
    let begin = vk::SubpassDependency::default()
        .src_subpass(vk::SUBPASS_EXTERNAL)
        .src_stage_mask(draws | Stage::TRANSFER)
        .src_access_mask(writes)
        .dst_stage_mask(draws)
        .dst_access_mask(writes | Access::DEPTH_STENCIL_ATTACHMENT_READ);
    let end = vk::SubpassDependency::default()
        .dst_subpass(vk::SUBPASS_EXTERNAL)
        .src_stage_mask(Stage::COLOR_ATTACHMENT_OUTPUT)
        .src_access_mask(Access::COLOR_ATTACHMENT_WRITE)
        .dst_stage_mask(Stage::TRANSFER)
        .dst_access_mask(Access::TRANSFER_READ);
    [begin, end]
}

impl Drop for RenderPass {
    fn drop(&mut self) {
        // SAFETY: whoever draws with it keeps it until the device is done.
        unsafe { self.device.destroy_render_pass(self.handle, None) };
    }
}

/// The images of one picture size.
pub struct DrawTarget {
    pass: RenderPass,
    framebuffer: vk::Framebuffer,
    color: Image,
    _depth: Image,
    size: UVec2,
}

impl DrawTarget {
    /// For pictures of `size` pixels. Errors: a picture that is larger than the device draws.
    pub fn new(device: &Device, size: UVec2) -> Result<DrawTarget> {
        use vk::ImageUsageFlags as Usage;
        let limit = device.limits().max_drawn_side;
        if size.max_element() > limit {
            let device = &device.info().name;
            return Err(Error::Unsupported(format!(
                "a picture of {}x{}: {device} draws at most {limit} a side; use --primary rays or a smaller --size",
                size.x, size.y
            )));
        }
        let image = |name, format, usage| {
            let UVec2 { x: width, y: height } = size;
            Image::new(device, &ImageDesc { name, width, height, format, usage, mips: false })
        };
        let pass = RenderPass::new(device)?;
        let color = image("visibility", COLOR, Usage::COLOR_ATTACHMENT | Usage::TRANSFER_SRC)?;
        let depth = image("depth", DEPTH, Usage::DEPTH_STENCIL_ATTACHMENT)?;
        let views = [color.view(), depth.view()];
        let info = vk::FramebufferCreateInfo::default()
            .render_pass(pass.handle)
            .attachments(&views)
            .width(size.x)
            .height(size.y)
            .layers(1);
        // SAFETY: views of the pass's formats and this size; `drop` destroys the framebuffer.
        let framebuffer = unsafe { device.create_framebuffer(&info, None) }.check("create framebuffer")?;
        Ok(DrawTarget { pass, framebuffer, color, _depth: depth, size })
    }

    /// Bytes a pixel of both images.
    pub const BYTES: u64 = 8 + 4;

    /// Zeroes both images, and draws into them what `draw` records.
    pub fn record(&self, cmd: vk::CommandBuffer, draw: impl FnOnce()) {
        let device = &self.pass.device;
        let (width, height) = (self.size.x, self.size.y);
        let area = vk::Rect2D { extent: vk::Extent2D { width, height }, ..Default::default() };
        let viewport =
            vk::Viewport { width: width as f32, height: height as f32, max_depth: 1.0, ..Default::default() };
        let clear = [vk::ClearValue::default(); 2];
        let begin = vk::RenderPassBeginInfo::default()
            .render_pass(self.pass.handle)
            .framebuffer(self.framebuffer)
            .render_area(area)
            .clear_values(&clear);
        // SAFETY: `cmd` is recording outside a render pass; the framebuffer is the pass's.
        unsafe {
            device.cmd_begin_render_pass(cmd, &begin, vk::SubpassContents::INLINE);
            device.cmd_set_viewport(cmd, 0, &[viewport]);
            device.cmd_set_scissor(cmd, 0, &[area]);
        }
        draw();
        // SAFETY: ends what was begun above.
        unsafe { device.cmd_end_render_pass(cmd) };
    }

    /// Copies the integers of the last drawing to `buffer`, rows from the top, 8 bytes a pixel.
    pub fn record_copy(&self, cmd: vk::CommandBuffer, buffer: &Buffer) {
        self.color.record_copy(cmd, buffer);
    }
}

impl Drop for DrawTarget {
    fn drop(&mut self) {
        // SAFETY: the owner keeps it until the device is done with it.
        unsafe { self.pass.device.destroy_framebuffer(self.framebuffer, None) };
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing;
    use super::*;

    #[test]
    fn pictures_that_are_too_large_are_refused_with_a_way_out() {
        testing::with_device(|device| {
            let Err(error) = DrawTarget::new(device, UVec2::new(1 << 20, 8)) else {
                panic!("no device draws a million pixels a side");
            };
            let text = error.to_string();
            assert!(text.contains("1048576x8") && text.contains("--primary rays"), "{text}");
        });
    }
}
