//! Ray tracing pipelines with their shader tables.

use super::Check;
use super::device::Device;
use super::pipeline::{Interface, Modules, Pipeline, Shader, Specialization};
use super::shader_table::ShaderTable;
use crate::error::{Error, Result};
use ash::vk;

/// Shaders of triangles that are hit; either may be absent.
#[derive(Clone, Copy, Debug, Default)]
pub struct HitGroup<'a> {
    pub closest_hit: Option<Shader<'a>>,
    pub any_hit: Option<Shader<'a>>,
}

#[derive(Clone, Copy)]
pub struct RayPipelineDesc<'a> {
    pub name: &'a str,
    pub raygen: Shader<'a>,
    /// In the order of the miss index.
    pub miss: &'a [Shader<'a>],
    /// In the order of the shader table's hit records.
    pub hit_groups: &'a [HitGroup<'a>],
    pub interface: Interface<'a>,
}

/// A ray pass's pipeline; rays start in the ray generation shader only (recursion depth 1).
pub struct RayPipeline {
    pipeline: Pipeline,
    table: ShaderTable,
}

impl RayPipeline {
    pub fn new(device: &Device, desc: &RayPipelineDesc) -> Result<RayPipeline> {
        use vk::ShaderStageFlags as Stage;
        let any_hit = desc.hit_groups.iter().any(|group| group.any_hit.is_some());
        let mut stages = Stage::RAYGEN_KHR | Stage::MISS_KHR | Stage::CLOSEST_HIT_KHR;
        if any_hit {
            stages |= Stage::ANY_HIT_KHR;
        }
        let point = vk::PipelineBindPoint::RAY_TRACING_KHR;
        let mut pipeline = Pipeline::without_handle(device, desc.name, point, stages, &desc.interface)?;
        pipeline.handle = create(device, desc, pipeline.layout())?;
        device.set_name(pipeline.handle, desc.name);
        let groups = 1 + desc.miss.len() + desc.hit_groups.len();
        let bytes = groups * device.limits().handle_size as usize;
        let loader = device.ray_tracing();
        // SAFETY: the pipeline has this many groups, and `bytes` is the size of all their handles.
        let handles =
            unsafe { loader.get_ray_tracing_shader_group_handles(pipeline.handle, 0, groups as u32, bytes) };
        let handles = handles.check(format_args!("get shader handles of '{}'", desc.name))?;
        let table = ShaderTable::new(device, desc.name, &handles, desc.miss.len())?;
        Ok(RayPipeline { pipeline, table })
    }

    /// Runs the bound pipeline: one ray generation invocation for each point of a grid.
    pub fn trace(&self, cmd: vk::CommandBuffer, [width, height, depth]: [u32; 3]) -> Result<()> {
        let (device, table) = (self.pipeline.device(), &self.table);
        let limit = device.limits().max_ray_dispatch;
        if u64::from(width) * u64::from(height) * u64::from(depth) > u64::from(limit) {
            let device = &device.info().name;
            return Err(Error::Unsupported(format!(
                "{width} x {height} x {depth} rays: {device} launches {limit} at once; use a smaller --size"
            )));
        }
        // SAFETY: `cmd` is recording with this pipeline and its sets bound; the table is this pipeline's.
        unsafe {
            device.ray_tracing().cmd_trace_rays(
                cmd,
                &table.raygen,
                &table.miss,
                &table.hit,
                &table.callable,
                width,
                height,
                depth,
            );
        }
        Ok(())
    }
}

impl std::ops::Deref for RayPipeline {
    type Target = Pipeline;
    fn deref(&self) -> &Pipeline {
        &self.pipeline
    }
}

/// Stages of a pipeline under construction; groups refer to them by index.
struct Stages<'a> {
    modules: Modules<'a>,
    constants: &'a vk::SpecializationInfo<'a>,
    stages: Vec<vk::PipelineShaderStageCreateInfo<'a>>,
}

impl<'a> Stages<'a> {
    fn add(&mut self, shader: Shader<'a>, stage: vk::ShaderStageFlags) -> Result<u32> {
        let info = vk::PipelineShaderStageCreateInfo::default()
            .stage(stage)
            .module(self.modules.get(&shader)?)
            .name(shader.entry)
            .specialization_info(self.constants);
        self.stages.push(info);
        Ok(self.stages.len() as u32 - 1)
    }

    fn add_optional(&mut self, shader: Option<Shader<'a>>, stage: vk::ShaderStageFlags) -> Result<u32> {
        shader.map_or(Ok(vk::SHADER_UNUSED_KHR), |shader| self.add(shader, stage))
    }
}

fn create(device: &Device, desc: &RayPipelineDesc, layout: vk::PipelineLayout) -> Result<vk::Pipeline> {
    use vk::ShaderStageFlags as Stage;
    let specialization = Specialization::new(desc.interface.spec_constants);
    let constants = specialization.info();
    let mut stages = Stages { modules: Modules::new(device), constants: &constants, stages: Vec::new() };
    let mut groups = vec![general(stages.add(desc.raygen, Stage::RAYGEN_KHR)?)];
    for shader in desc.miss {
        groups.push(general(stages.add(*shader, Stage::MISS_KHR)?));
    }
    for group in desc.hit_groups {
        let closest_hit = stages.add_optional(group.closest_hit, Stage::CLOSEST_HIT_KHR)?;
        let any_hit = stages.add_optional(group.any_hit, Stage::ANY_HIT_KHR)?;
        groups.push(
            unused(vk::RayTracingShaderGroupTypeKHR::TRIANGLES_HIT_GROUP)
                .closest_hit_shader(closest_hit)
                .any_hit_shader(any_hit),
        );
    }
    let info = vk::RayTracingPipelineCreateInfoKHR::default()
        .flags(device.pipeline_flags())
        .stages(&stages.stages)
        .groups(&groups)
        .max_pipeline_ray_recursion_depth(1)
        .layout(layout);
    let (deferred, cache) = (vk::DeferredOperationKHR::null(), device.pipeline_cache());
    // SAFETY: modules and layout are alive; the shaders' interface is the layout's.
    let made = unsafe { device.ray_tracing().create_ray_tracing_pipelines(deferred, cache, &[info], None) };
    let made = made.map_err(|(_, result)| result).check(format_args!("create pipeline '{}'", desc.name))?;
    Ok(made.first().copied().unwrap_or_default())
}

fn general(shader: u32) -> vk::RayTracingShaderGroupCreateInfoKHR<'static> {
    unused(vk::RayTracingShaderGroupTypeKHR::GENERAL).general_shader(shader)
}

fn unused(kind: vk::RayTracingShaderGroupTypeKHR) -> vk::RayTracingShaderGroupCreateInfoKHR<'static> {
    vk::RayTracingShaderGroupCreateInfoKHR::default()
        .ty(kind)
        .general_shader(vk::SHADER_UNUSED_KHR)
        .closest_hit_shader(vk::SHADER_UNUSED_KHR)
        .any_hit_shader(vk::SHADER_UNUSED_KHR)
        .intersection_shader(vk::SHADER_UNUSED_KHR)
}
