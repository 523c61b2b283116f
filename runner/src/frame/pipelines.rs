//! One pipeline a pass, specialised for a scene's features.

use crate::error::{Error, Result};
use crate::gpu_scene::draws::{self, DrawKind, Draws};
use crate::gpu_scene::past;
use crate::vulkan::{
    Binding, Buffer, ComputePipeline, Device, DrawPipeline, DrawPipelineDesc, DrawTarget, HitGroup,
    Interface, Pipeline, RayPipeline, RayPipelineDesc, SetLayout, Shader, memory_barrier,
};
use crate::{parallel, startup};
use ash::vk;
use glam::UVec2;
use shared::frame::{Settings, features};
use shared::interface::{PassConstants, WORKGROUP, spec_constant};
use shared::passes::{Pass, Rays, Stage, threads};
use shared::resources::{Extent, set};
use std::collections::HashMap;
use std::ffi::CString;

/// Stages that read and write buffers.
pub const SHADERS: vk::PipelineStageFlags = vk::PipelineStageFlags::from_raw(
    vk::PipelineStageFlags::COMPUTE_SHADER.as_raw() | vk::PipelineStageFlags::RAY_TRACING_SHADER_KHR.as_raw(),
);

/// The pipelines of the passes that some frame asked for.
pub struct Pipelines {
    device: Device,
    scene_layout: SetLayout,
    features: u32,
    made: HashMap<(Pass, u32), PassPipeline>,
}

/// A pass, ready to be recorded.
pub enum PassPipeline {
    Compute(ComputePipeline),
    Rays(Box<RayPipeline>),
    /// One for each of the scene's [`draws::kinds`], in their order; what is bound for one is bound for all.
    Raster(Vec<DrawPipeline>),
}

/// A shader's words and entry point, owned.
struct Code {
    spirv: Vec<u32>,
    entry: CString,
}

impl Pipelines {
    /// For scenes whose set 0 has `scene_layout` and which have `features`; nothing is compiled yet.
    pub fn new(device: &Device, scene_layout: &SetLayout, features: u32) -> Result<Self> {
        Ok(Pipelines {
            device: device.clone(),
            scene_layout: scene_layout.clone(),
            features,
            made: HashMap::new(),
        })
    }

    /// Compiles the pipelines of passes and their variants that have not been compiled yet, on all processors.
    pub fn prepare(&mut self, passes: impl Iterator<Item = (Pass, u32)>) -> Result<()> {
        let mut new: Vec<(Pass, u32)> = passes.filter(|pass| !self.made.contains_key(pass)).collect();
        new.sort_unstable();
        new.dedup();
        if new.is_empty() {
            return Ok(());
        }
        let compiled = startup::timed("pipelines", || {
            parallel::map(&new, |&(pass, variant)| self.compile(pass, variant))
        });
        for (pass, pipeline) in new.into_iter().zip(compiled) {
            self.made.insert(pass, pipeline?);
        }
        Ok(())
    }

    /// The pipeline of a prepared pass.
    pub fn get(&self, pass: Pass, variant: u32) -> Option<&PassPipeline> {
        self.made.get(&(pass, variant))
    }

    fn compile(&self, pass: Pass, variant: u32) -> Result<PassPipeline> {
        let (frame_layout, past_layout) = (frame_layout(&self.device, pass)?, past::layout(&self.device)?);
        let all = [&self.scene_layout, &frame_layout, &past_layout];
        let set_layouts = if reads_past(pass) { &all[..] } else { &all[..2] };
        let spec_constants = [(spec_constant::FEATURES, self.features), (spec_constant::VARIANT, variant)];
        let interface = Interface {
            set_layouts,
            push_constant_size: size_of::<PassConstants>() as u32,
            spec_constants: &spec_constants,
        };
        match pass.stage() {
            Stage::Compute => {
                let code = Code::load(pass.stem())?;
                let pipeline = ComputePipeline::new(&self.device, pass.stem(), code.shader(), &interface)?;
                Ok(PassPipeline::Compute(pipeline))
            }
            Stage::RayTracing(rays) => self.compile_rays(pass, rays, interface),
            Stage::Raster => self.compile_raster(pass, interface),
        }
    }

    fn compile_rays(&self, pass: Pass, rays: Rays, interface: Interface<'_>) -> Result<PassPipeline> {
        let code = Code::load(pass.stem())?;
        let misses = [Code::load("primary_miss")?, Code::load("shadow_miss")?];
        let codes: Vec<GroupCode> =
            hit_groups(rays, self.features).into_iter().map(GroupCode::load).collect::<Result<_>>()?;
        let groups: Vec<HitGroup> = codes.iter().map(GroupCode::shaders).collect();
        let desc = RayPipelineDesc {
            name: pass.stem(),
            raygen: code.shader(),
            miss: &[misses[0].shader(), misses[1].shader()],
            hit_groups: &groups,
            interface,
        };
        Ok(PassPipeline::Rays(Box::new(RayPipeline::new(&self.device, &desc)?)))
    }

    fn compile_raster(&self, pass: Pass, interface: Interface<'_>) -> Result<PassPipeline> {
        let load = |part: &str| Code::load(&format!("{}{part}", pass.stem()));
        let opaque = [load("_vertex")?, load("")?];
        let alpha = [load("_alpha_vertex")?, load("_alpha")?];
        let pipeline = |kind: DrawKind| {
            let [vertex, fragment] = if kind.transparent { &alpha } else { &opaque };
            let desc = DrawPipelineDesc {
                name: pass.stem(),
                vertex: vertex.shader(),
                fragment: fragment.shader(),
                culls: !kind.double_sided,
                interface,
            };
            DrawPipeline::new(&self.device, &desc)
        };
        Ok(PassPipeline::Raster(draws::kinds(self.features).map(pipeline).collect::<Result<_>>()?))
    }
}

/// Entry points of a hit group. Shadow rays without any-hit run no shader, but their table still needs a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GroupShaders {
    pub closest_hit: Option<&'static str>,
    pub any_hit: Option<&'static str>,
}

/// The hit groups of rays in scenes with these features, in the order of [`shared::interface::hit_group`].
pub fn hit_groups(rays: Rays, features: u32) -> Vec<GroupShaders> {
    let any_hit = |stem| (features & features::ALPHA != 0).then_some(stem);
    let shadow = GroupShaders { closest_hit: None, any_hit: any_hit("shadow_any_hit") };
    let nearest = GroupShaders { closest_hit: Some("closest_hit"), any_hit: any_hit("primary_any_hit") };
    match rays {
        Rays::Primary => vec![nearest],
        Rays::Bounces => vec![shadow, nearest],
        Rays::Both if features & features::TRACEABLE != 0 => vec![shadow, nearest],
        Rays::Shadow | Rays::Both => vec![shadow],
    }
}

/// The code of a hit group.
struct GroupCode {
    closest_hit: Option<Code>,
    any_hit: Option<Code>,
}

impl GroupCode {
    fn load(GroupShaders { closest_hit, any_hit }: GroupShaders) -> Result<Self> {
        let load = |stem: Option<&str>| stem.map(Code::load).transpose();
        Ok(GroupCode { closest_hit: load(closest_hit)?, any_hit: load(any_hit)? })
    }

    fn shaders(&self) -> HitGroup<'_> {
        HitGroup {
            closest_hit: self.closest_hit.as_ref().map(Code::shader),
            any_hit: self.any_hit.as_ref().map(Code::shader),
        }
    }
}

impl Code {
    fn load(stem: &str) -> Result<Self> {
        let missing = || Error::Internal(format!("no shader '{stem}' in this program"));
        let bytes = candela_assets::spirv(stem).ok_or_else(missing)?;
        let spirv = bytes.chunks_exact(4).map(|w| u32::from_le_bytes([w[0], w[1], w[2], w[3]])).collect();
        Ok(Code { spirv, entry: CString::new(stem).map_err(|_| missing())? })
    }

    fn shader(&self) -> Shader<'_> {
        Shader { spirv: &self.spirv, entry: &self.entry }
    }
}

impl PassPipeline {
    /// What its resources are bound to.
    pub fn pipeline(&self) -> &Pipeline {
        match self {
            PassPipeline::Compute(pipeline) => pipeline,
            PassPipeline::Rays(pipeline) => pipeline.as_ref(),
            PassPipeline::Raster(pipelines) => &pipelines[0],
        }
    }

    /// Launches `pass` over a picture of `size`; one that draws needs more, see [`draw`].
    pub fn launch(&self, cmd: vk::CommandBuffer, pass: Pass, size: UVec2, settings: &Settings) -> Result<()> {
        let extent = pass.extent();
        let size = threads(extent, size);
        let depth = if extent == Extent::Reservoirs { settings.reservoirs } else { 1 };
        match self {
            PassPipeline::Compute(pipeline) => {
                let groups = [size.x.div_ceil(WORKGROUP[0]), size.y.div_ceil(WORKGROUP[1]), depth];
                pipeline.dispatch(cmd, groups);
                Ok(())
            }
            PassPipeline::Rays(pipeline) => pipeline.trace(cmd, [size.x, size.y, depth]),
            PassPipeline::Raster(_) => {
                Err(Error::Internal(format!("pass '{}' has nothing to draw into", pass.stem())))
            }
        }
    }
}

/// Draws all of `scene` into `target`, and copies that to `buffer`. Shaders after it see the copy.
pub fn draw(
    device: &Device,
    cmd: vk::CommandBuffer,
    pipelines: &[DrawPipeline],
    scene: &Draws,
    target: &DrawTarget,
    buffer: &Buffer,
) {
    target.record(cmd, || {
        for (pipeline, draws) in pipelines.iter().zip(scene.ranges()) {
            if !draws.is_empty() {
                pipeline.bind(cmd);
                pipeline.draw(cmd, scene.buffer(), draws.clone());
            }
        }
    });
    let copies = vk::PipelineStageFlags::TRANSFER;
    // Shaders of the frame before may still read the last copy.
    memory_barrier(device, cmd, (SHADERS, vk::AccessFlags::empty()), (copies, vk::AccessFlags::empty()));
    target.record_copy(cmd, buffer);
    let written = (copies, vk::AccessFlags::TRANSFER_WRITE);
    memory_barrier(device, cmd, written, (SHADERS, vk::AccessFlags::SHADER_READ));
}

/// Does any variant of `pass` look at the scene as it was in the previous frame?
pub fn reads_past(pass: Pass) -> bool {
    pass.uses().iter().any(|(binding, _)| binding.set() == set::PAST)
}

/// The layout of set 1 for `pass`: constants, and the buffers that it uses. Devices push 32 descriptors at most, and all passes
/// together have more buffers.
fn frame_layout(device: &Device, pass: Pass) -> Result<SetLayout> {
    use vk::ShaderStageFlags as Shader;
    let stages = Shader::RAYGEN_KHR | Shader::COMPUTE;
    let readers = stages | Shader::VERTEX | Shader::FRAGMENT;
    let mut bindings = vec![Binding::one(set::CONSTANTS, vk::DescriptorType::UNIFORM_BUFFER, readers)];
    let buffers = pass.uses().iter().filter(|(buffer, _)| buffer.set() == set::FRAME);
    bindings.extend(buffers.map(|(buffer, _)| Binding::buffer(*buffer, stages)));
    SetLayout::for_push(device, "frame", &bindings)
}
