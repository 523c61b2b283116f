//! Graphics pipelines that draw into a [`super::DrawTarget`] from storage buffers alone.

use super::Check;
use super::buffer::Buffer;
use super::device::Device;
use super::draw_target::RenderPass;
use super::pipeline::{Interface, Modules, Pipeline, Shader, Specialization};
use crate::error::Result;
use ash::vk;
use std::ops::Range;

#[derive(Clone, Copy)]
pub struct DrawPipelineDesc<'a> {
    pub name: &'a str,
    pub vertex: Shader<'a>,
    pub fragment: Shader<'a>,
    /// Backs (clockwise on the picture) are not drawn.
    pub culls: bool,
    pub interface: Interface<'a>,
}

/// A pipeline for one kind of triangles; what is nearer (greater depth) is kept.
pub struct DrawPipeline(Pipeline);

impl DrawPipeline {
    pub fn new(device: &Device, desc: &DrawPipelineDesc) -> Result<DrawPipeline> {
        let stages = vk::ShaderStageFlags::VERTEX | vk::ShaderStageFlags::FRAGMENT;
        let point = vk::PipelineBindPoint::GRAPHICS;
        let mut pipeline = Pipeline::without_handle(device, desc.name, point, stages, &desc.interface)?;
        pipeline.handle = create(device, desc, pipeline.layout())?;
        device.set_name(pipeline.handle, desc.name);
        Ok(DrawPipeline(pipeline))
    }

    /// Draws `draws` (numbers of [`vk::DrawIndirectCommand`]s in `commands`) with the bound pipeline.
    pub fn draw(&self, cmd: vk::CommandBuffer, commands: &Buffer, draws: Range<u32>) {
        let device = self.0.device();
        let stride = size_of::<vk::DrawIndirectCommand>() as u32;
        let most = device.limits().max_draws;
        for first in draws.clone().step_by(most as usize) {
            let (offset, count) = (u64::from(first) * u64::from(stride), most.min(draws.end - first));
            // SAFETY: `cmd` is recording inside a render pass with this pipeline and its sets bound; the commands exist.
            unsafe { device.cmd_draw_indirect(cmd, commands.handle(), offset, count, stride) };
        }
    }
}

impl std::ops::Deref for DrawPipeline {
    type Target = Pipeline;
    fn deref(&self) -> &Pipeline {
        &self.0
    }
}

fn create(device: &Device, desc: &DrawPipelineDesc, layout: vk::PipelineLayout) -> Result<vk::Pipeline> {
    let mut modules = Modules::new(device);
    let specialization = Specialization::new(desc.interface.spec_constants);
    let constants = specialization.info();
    let mut stages = Vec::new();
    for (stage, shader) in
        [(vk::ShaderStageFlags::VERTEX, desc.vertex), (vk::ShaderStageFlags::FRAGMENT, desc.fragment)]
    {
        let info = vk::PipelineShaderStageCreateInfo::default()
            .stage(stage)
            .module(modules.get(&shader)?)
            .name(shader.entry)
            .specialization_info(&constants);
        stages.push(info);
    }
    let input = vk::PipelineVertexInputStateCreateInfo::default();
    let assembly =
        vk::PipelineInputAssemblyStateCreateInfo::default().topology(vk::PrimitiveTopology::TRIANGLE_LIST);
    let viewport = vk::PipelineViewportStateCreateInfo::default().viewport_count(1).scissor_count(1);
    let rasterization = vk::PipelineRasterizationStateCreateInfo::default()
        .cull_mode(if desc.culls { vk::CullModeFlags::BACK } else { vk::CullModeFlags::NONE })
        .front_face(vk::FrontFace::COUNTER_CLOCKWISE)
        .line_width(1.0);
    let samples =
        vk::PipelineMultisampleStateCreateInfo::default().rasterization_samples(vk::SampleCountFlags::TYPE_1);
    let depth = vk::PipelineDepthStencilStateCreateInfo::default()
        .depth_test_enable(true)
        .depth_write_enable(true)
        .depth_compare_op(vk::CompareOp::GREATER);
    let colors = [vk::PipelineColorBlendAttachmentState::default()
        .color_write_mask(vk::ColorComponentFlags::R | vk::ColorComponentFlags::G)];
    let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(&colors);
    let dynamic = vk::PipelineDynamicStateCreateInfo::default()
        .dynamic_states(&[vk::DynamicState::VIEWPORT, vk::DynamicState::SCISSOR]);
    let pass = RenderPass::new(device)?;
    let info = vk::GraphicsPipelineCreateInfo::default()
        .flags(device.pipeline_flags())
        .stages(&stages)
        .vertex_input_state(&input)
        .input_assembly_state(&assembly)
        .viewport_state(&viewport)
        .rasterization_state(&rasterization)
        .multisample_state(&samples)
        .depth_stencil_state(&depth)
        .color_blend_state(&blend)
        .dynamic_state(&dynamic)
        .layout(layout)
        .render_pass(pass.handle);
    // SAFETY: modules, layout and pass are alive; the shaders' interface is the layout's.
    let made = unsafe { device.create_graphics_pipelines(device.pipeline_cache(), &[info], None) };
    let made = made.map_err(|(_, result)| result).check(format_args!("create pipeline '{}'", desc.name))?;
    Ok(made.first().copied().unwrap_or_default())
}
