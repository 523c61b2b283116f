//! Compute pipelines, and the parts that all pipelines share (layout, constants, binding).

use super::Check;
use super::descriptors::{DescriptorSet, PushSet, SetLayout};
use super::device::Device;
use crate::error::{Error, Result};
use ash::vk;
use bytemuck::Pod;
use std::ffi::CStr;

/// An entry point of a SPIR-V module.
#[derive(Clone, Copy, Debug)]
pub struct Shader<'a> {
    pub spirv: &'a [u32],
    pub entry: &'a CStr,
}

/// What a pipeline's shaders take from outside.
#[derive(Clone, Copy, Default)]
pub struct Interface<'a> {
    /// Set 0, 1, ..
    pub set_layouts: &'a [&'a SetLayout],
    /// Bytes, a multiple of 4; 0 for none.
    pub push_constant_size: u32,
    /// Id and value of specialisation constants; those that a shader hasn't are ignored.
    pub spec_constants: &'a [(u32, u32)],
}

/// A pipeline with its layout.
pub struct Pipeline {
    device: Device,
    pub(super) handle: vk::Pipeline,
    layout: vk::PipelineLayout,
    bind_point: vk::PipelineBindPoint,
    /// Stages that see the push constants.
    stages: vk::ShaderStageFlags,
    _set_layouts: Vec<SetLayout>,
}

impl Pipeline {
    /// The layout alone; the caller sets `handle`.
    pub(super) fn without_handle(
        device: &Device,
        name: &str,
        bind_point: vk::PipelineBindPoint,
        stages: vk::ShaderStageFlags,
        interface: &Interface,
    ) -> Result<Pipeline> {
        let (size, limit) = (interface.push_constant_size, device.limits().max_push_constants);
        if size > limit {
            let device = &device.info().name;
            return Err(Error::Unsupported(format!(
                "pass '{name}': {size} bytes of push constants; {device} has {limit}"
            )));
        }
        let sets: Vec<_> = interface.set_layouts.iter().map(|layout| layout.handle()).collect();
        let ranges = [vk::PushConstantRange { stage_flags: stages, offset: 0, size }];
        let ranges = if size > 0 { &ranges[..] } else { &[] };
        let info = vk::PipelineLayoutCreateInfo::default().set_layouts(&sets).push_constant_ranges(ranges);
        // SAFETY: the set layouts are alive; `drop` destroys the layout.
        let layout = unsafe { device.create_pipeline_layout(&info, None) }
            .check(format_args!("create pipeline layout of '{name}'"))?;
        let _set_layouts = interface.set_layouts.iter().map(|&layout| layout.clone()).collect();
        let handle = vk::Pipeline::null();
        Ok(Pipeline { device: device.clone(), handle, layout, bind_point, stages, _set_layouts })
    }

    pub(super) fn device(&self) -> &Device {
        &self.device
    }

    pub fn layout(&self) -> vk::PipelineLayout {
        self.layout
    }

    pub fn bind_point(&self) -> vk::PipelineBindPoint {
        self.bind_point
    }

    pub fn bind(&self, cmd: vk::CommandBuffer) {
        // SAFETY: `cmd` is recording.
        unsafe { self.device.cmd_bind_pipeline(cmd, self.bind_point, self.handle) };
    }

    /// Binds `set` as set `index`.
    pub fn bind_set(&self, cmd: vk::CommandBuffer, index: u32, set: &DescriptorSet) {
        let sets = [set.handle()];
        // SAFETY: `cmd` is recording, and the set was made from the layout's set layout `index`.
        unsafe { self.device.cmd_bind_descriptor_sets(cmd, self.bind_point, self.layout, index, &sets, &[]) };
    }

    /// Pushes `resources` as set `index`, whose layout is a push layout.
    pub fn push_set(&self, cmd: vk::CommandBuffer, index: u32, resources: &PushSet) {
        resources.push(&self.device, cmd, self.bind_point, self.layout, index);
    }

    /// Sets the push constants: a `T` of the declared size.
    pub fn push_constants<T: Pod>(&self, cmd: vk::CommandBuffer, constants: &T) {
        let bytes = bytemuck::bytes_of(constants);
        // SAFETY: `cmd` is recording; the layout has a range of these stages from 0.
        unsafe { self.device.cmd_push_constants(cmd, self.layout, self.stages, 0, bytes) };
    }
}

impl Drop for Pipeline {
    fn drop(&mut self) {
        // SAFETY: the owner keeps it until the device is done with it; null handles are allowed.
        unsafe {
            self.device.destroy_pipeline(self.handle, None);
            self.device.destroy_pipeline_layout(self.layout, None);
        }
    }
}

/// Specialisation constants in Vulkan's form.
pub(super) struct Specialization {
    entries: Vec<vk::SpecializationMapEntry>,
    data: Vec<u8>,
}

impl Specialization {
    pub fn new(constants: &[(u32, u32)]) -> Specialization {
        let entry = |(i, &(id, _)): (usize, &(u32, u32))| {
            vk::SpecializationMapEntry::default().constant_id(id).offset(4 * i as u32).size(4)
        };
        let entries = constants.iter().enumerate().map(entry).collect();
        let data = constants.iter().flat_map(|(_, value)| value.to_ne_bytes()).collect();
        Specialization { entries, data }
    }

    pub fn info(&self) -> vk::SpecializationInfo<'_> {
        vk::SpecializationInfo::default().map_entries(&self.entries).data(&self.data)
    }
}

/// Shader modules while a pipeline is being made, one for each piece of SPIR-V.
pub(super) struct Modules<'a> {
    device: &'a Device,
    modules: Vec<(&'a [u32], vk::ShaderModule)>,
}

impl<'a> Modules<'a> {
    pub fn new(device: &'a Device) -> Modules<'a> {
        Modules { device, modules: Vec::new() }
    }

    pub fn get(&mut self, shader: &Shader<'a>) -> Result<vk::ShaderModule> {
        if let Some((_, module)) = self.modules.iter().find(|(spirv, _)| std::ptr::eq(*spirv, shader.spirv)) {
            return Ok(*module);
        }
        let info = vk::ShaderModuleCreateInfo::default().code(shader.spirv);
        // SAFETY: the SPIR-V is the project's own, checked when it was built; `drop` destroys the module.
        let module = unsafe { self.device.create_shader_module(&info, None) }
            .check(format_args!("load shader '{}'", shader.entry.to_string_lossy()))?;
        self.modules.push((shader.spirv, module));
        Ok(module)
    }
}

impl Drop for Modules<'_> {
    fn drop(&mut self) {
        for (_, module) in &self.modules {
            // SAFETY: pipelines don't need their modules once they are made.
            unsafe { self.device.destroy_shader_module(*module, None) };
        }
    }
}

/// A compute pass's pipeline; what it shares with the others is in [`Pipeline`].
pub struct ComputePipeline(Pipeline);

impl ComputePipeline {
    pub fn new(
        device: &Device,
        name: &str,
        shader: Shader,
        interface: &Interface,
    ) -> Result<ComputePipeline> {
        let stage = vk::ShaderStageFlags::COMPUTE;
        let point = vk::PipelineBindPoint::COMPUTE;
        let mut pipeline = Pipeline::without_handle(device, name, point, stage, interface)?;
        let mut modules = Modules::new(device);
        let specialization = Specialization::new(interface.spec_constants);
        let constants = specialization.info();
        let stage = vk::PipelineShaderStageCreateInfo::default()
            .stage(stage)
            .module(modules.get(&shader)?)
            .name(shader.entry)
            .specialization_info(&constants);
        let info = vk::ComputePipelineCreateInfo::default()
            .flags(device.pipeline_flags())
            .stage(stage)
            .layout(pipeline.layout);
        // SAFETY: module and layout are alive; the shader's interface is the layout's.
        let made = unsafe { device.create_compute_pipelines(device.pipeline_cache(), &[info], None) };
        let made = made.map_err(|(_, result)| result).check(format_args!("create pipeline '{name}'"))?;
        pipeline.handle = made.first().copied().unwrap_or_default();
        device.set_name(pipeline.handle, name);
        Ok(ComputePipeline(pipeline))
    }

    /// Runs the bound pipeline over `groups` workgroups in x, y, z.
    pub fn dispatch(&self, cmd: vk::CommandBuffer, groups: [u32; 3]) {
        // SAFETY: `cmd` is recording with this pipeline and its sets bound.
        unsafe { self.0.device.cmd_dispatch(cmd, groups[0], groups[1], groups[2]) };
    }
}

impl std::ops::Deref for ComputePipeline {
    type Target = Pipeline;
    fn deref(&self) -> &Pipeline {
        &self.0
    }
}
