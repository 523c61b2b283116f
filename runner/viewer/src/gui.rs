//! egui on the window's images: one render pass over the picture, on the same device and queue.

use crate::swapchain::Swapchain;
use ash::vk;
use candela::error::{Error, Result};
use candela::vulkan::{Check, CommandRing, Device};
use egui_ash_renderer::allocator::GpuAllocator;
use egui_ash_renderer::{Options, RenderMode, Renderer};
use winit::window::Window;

pub struct Gui {
    device: Device,
    pub context: egui::Context,
    pub window_state: egui_winit::State,
    /// `None` only while it is being dropped.
    renderer: Option<Renderer<GpuAllocator>>,
    target: Target,
    pool: vk::CommandPool,
    /// Textures to free once the frame in a slot is done.
    garbage: Vec<Vec<egui::TextureId>>,
    painted: Painted,
}

/// The render pass and a framebuffer for each of the window's images.
struct Target {
    device: Device,
    format: vk::Format,
    extent: vk::Extent2D,
    pass: vk::RenderPass,
    framebuffers: Vec<vk::Framebuffer>,
}

/// What the last run of the interface wants to see on screen.
#[derive(Default)]
struct Painted {
    primitives: Vec<egui::ClippedPrimitive>,
    textures: egui::TexturesDelta,
    pixels_per_point: f32,
}

impl Gui {
    pub fn new(device: &Device, window: &Window, swapchain: &Swapchain, frames: usize) -> Result<Gui> {
        let context = egui::Context::default();
        context.set_theme(egui::Theme::Dark);
        let side = device.limits().max_image_side as usize;
        let window_state = egui_winit::State::new(
            context.clone(),
            egui::ViewportId::ROOT,
            window,
            Some(window.scale_factor() as f32),
            None,
            Some(side),
        );
        let target = Target::new(device, swapchain)?;
        let allocator = device.allocator();
        let options = Options {
            in_flight_frames: frames,
            srgb_framebuffer: swapchain.encodes_srgb(),
            ..Options::default()
        };
        let mode = RenderMode::RenderPass(target.pass);
        let renderer = Renderer::with_gpu_allocator(allocator.clone(), (**device).clone(), mode, options)
            .map_err(gui_error)?;
        let info = vk::CommandPoolCreateInfo::default().queue_family_index(device.queue_family());
        // SAFETY: a valid create info; `drop` destroys the pool.
        let pool = unsafe { device.create_command_pool(&info, None) }.check("create command pool")?;
        Ok(Gui {
            device: device.clone(),
            context,
            window_state,
            renderer: Some(renderer),
            target,
            pool,
            garbage: vec![Vec::new(); frames],
            painted: Painted::default(),
        })
    }

    /// For a swapchain that has taken the place of the last one; nothing may be in flight.
    pub fn retarget(&mut self, swapchain: &Swapchain) -> Result<()> {
        let new_format = swapchain.format() != self.target.format;
        self.target = Target::new(&self.device, swapchain)?;
        if new_format && let Some(renderer) = &mut self.renderer {
            renderer.set_render_mode(RenderMode::RenderPass(self.target.pass)).map_err(gui_error)?;
        }
        Ok(())
    }

    /// Lays the interface out. `ui` may run more than once.
    pub fn run(&mut self, window: &Window, ui: impl FnMut(&mut egui::Ui)) {
        let input = self.window_state.take_egui_input(window);
        let output = self.context.run_ui(input, ui);
        self.window_state.handle_platform_output(window, output.platform_output);
        // Textures that no frame has taken yet, because the window had no image, stay due.
        self.painted.textures.append(output.textures_delta);
        self.painted.pixels_per_point = output.pixels_per_point;
        self.painted.primitives = self.context.tessellate(output.shapes, output.pixels_per_point);
    }

    /// Brings changed textures to the device. Waits for the frames in flight where something changed: glyphs that
    /// were not seen before, so hardly ever.
    pub fn upload(&mut self, ring: &mut CommandRing) -> Result<()> {
        let Some(renderer) = &mut self.renderer else { return Ok(()) };
        if self.painted.textures.set.is_empty() {
            return Ok(());
        }
        ring.wait()?;
        let queue = self.device.queue();
        for (id, deltas) in self.painted.textures.set.drain() {
            for delta in deltas {
                renderer.set_texture(*queue, self.pool, id, &delta).map_err(gui_error)?;
            }
        }
        Ok(())
    }

    /// Draws over the image, which has the layout of a color attachment and is left ready to be shown. The frame that
    /// used `slot` before is done.
    pub fn record(&mut self, cmd: vk::CommandBuffer, slot: usize, image: u32) -> Result<()> {
        let Some(renderer) = &mut self.renderer else { return Ok(()) };
        for id in self.garbage[slot].drain(..) {
            renderer.free_texture(id).map_err(gui_error)?;
        }
        self.garbage[slot].extend(self.painted.textures.free.drain());
        let extent = self.target.extent;
        let begin = vk::RenderPassBeginInfo::default()
            .render_pass(self.target.pass)
            .framebuffer(self.target.framebuffers[image as usize])
            .render_area(vk::Rect2D { offset: vk::Offset2D::default(), extent });
        // SAFETY: `cmd` is recording; pass and framebuffer belong together.
        unsafe { self.device.cmd_begin_render_pass(cmd, &begin, vk::SubpassContents::INLINE) };
        let drawn = renderer.cmd_draw(cmd, extent, self.painted.pixels_per_point, &self.painted.primitives);
        // SAFETY: ends the pass that was begun above.
        unsafe { self.device.cmd_end_render_pass(cmd) };
        drawn.map_err(gui_error)
    }
}

impl Drop for Gui {
    fn drop(&mut self) {
        let _ = self.device.wait_idle();
        self.renderer = None;
        // SAFETY: nothing is in flight.
        unsafe { self.device.destroy_command_pool(self.pool, None) };
    }
}

impl Target {
    fn new(device: &Device, swapchain: &Swapchain) -> Result<Target> {
        let mut target = Target {
            device: device.clone(),
            format: swapchain.format(),
            extent: swapchain.extent(),
            pass: render_pass(device, swapchain.format())?,
            framebuffers: Vec::new(),
        };
        for &view in swapchain.views() {
            let views = [view];
            let info = vk::FramebufferCreateInfo::default()
                .render_pass(target.pass)
                .attachments(&views)
                .width(target.extent.width)
                .height(target.extent.height)
                .layers(1);
            // SAFETY: a view of the pass's format and this size.
            let framebuffer =
                unsafe { device.create_framebuffer(&info, None) }.check("create framebuffer")?;
            target.framebuffers.push(framebuffer);
        }
        Ok(target)
    }
}

impl Drop for Target {
    fn drop(&mut self) {
        // SAFETY: the owner has waited for the frames that use it.
        unsafe {
            for &framebuffer in &self.framebuffers {
                self.device.destroy_framebuffer(framebuffer, None);
            }
            self.device.destroy_render_pass(self.pass, None);
        }
    }
}

/// Draws over what is there and leaves the image ready to be shown.
fn render_pass(device: &Device, format: vk::Format) -> Result<vk::RenderPass> {
    let attachments = [vk::AttachmentDescription::default()
        .format(format)
        .samples(vk::SampleCountFlags::TYPE_1)
        .load_op(vk::AttachmentLoadOp::LOAD)
        .store_op(vk::AttachmentStoreOp::STORE)
        .stencil_load_op(vk::AttachmentLoadOp::DONT_CARE)
        .stencil_store_op(vk::AttachmentStoreOp::DONT_CARE)
        .initial_layout(vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL)
        .final_layout(vk::ImageLayout::PRESENT_SRC_KHR)];
    let colors = [vk::AttachmentReference::default().layout(vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL)];
    let subpasses = [vk::SubpassDescription::default()
        .pipeline_bind_point(vk::PipelineBindPoint::GRAPHICS)
        .color_attachments(&colors)];
    let info = vk::RenderPassCreateInfo::default().attachments(&attachments).subpasses(&subpasses);
    // SAFETY: a valid create info; the target destroys the pass.
    unsafe { device.create_render_pass(&info, None) }.check("create render pass")
}

fn gui_error(error: egui_ash_renderer::RendererError) -> Error {
    match error {
        egui_ash_renderer::RendererError::Vulkan(vk::Result::ERROR_DEVICE_LOST) => {
            Error::DeviceLost("user interface".into())
        }
        other => Error::Platform(format!("user interface: {other}")),
    }
}
