//! Descriptor sets: a static one for the scene, pushed ones for each pass.

use super::Check;
use super::acceleration::Tlas;
use super::buffer::Buffer;
use super::device::Device;
use crate::error::{Error, Result};
use ash::vk;
use std::sync::Arc;

/// One binding of a set.
#[derive(Clone, Copy, Debug)]
pub struct Binding {
    pub binding: u32,
    pub kind: vk::DescriptorType,
    /// Descriptors; of an array, the most it can have.
    pub count: u32,
    pub stages: vk::ShaderStageFlags,
    /// Its length is chosen when a set is made, and elements that shaders don't reach may be absent.
    pub array: bool,
}

impl Binding {
    pub const fn one(binding: u32, kind: vk::DescriptorType, stages: vk::ShaderStageFlags) -> Binding {
        Binding { binding, kind, count: 1, stages, array: false }
    }

    /// The storage buffers that the table of resources has in `set`.
    pub fn buffers(set: u32, stages: vk::ShaderStageFlags) -> impl Iterator<Item = Binding> {
        let places = shared::resources::Binding::ALL.iter().filter(move |binding| binding.set() == set);
        places.map(move |&place| Binding::buffer(place, stages))
    }

    /// One of them.
    pub fn buffer(place: shared::resources::Binding, stages: vk::ShaderStageFlags) -> Binding {
        Binding::one(place.number(), vk::DescriptorType::STORAGE_BUFFER, stages)
    }

    /// Sampled images of up to `count` textures; only the last binding of a set can be one.
    pub const fn textures(binding: u32, count: u32, stages: vk::ShaderStageFlags) -> Binding {
        let count = if count == 0 { 1 } else { count };
        Binding { binding, kind: vk::DescriptorType::COMBINED_IMAGE_SAMPLER, count, stages, array: true }
    }
}

/// The layout of a set; clones share it.
#[derive(Clone)]
pub struct SetLayout(Arc<Layout>);

struct Layout {
    device: Device,
    handle: vk::DescriptorSetLayout,
    bindings: Vec<Binding>,
}

impl SetLayout {
    /// Of sets that are made once, with [`DescriptorSet::new`].
    pub fn new(device: &Device, name: &str, bindings: &[Binding]) -> Result<SetLayout> {
        SetLayout::create(device, name, bindings, vk::DescriptorSetLayoutCreateFlags::empty())
    }

    /// Of sets that are pushed, with [`PushSet`].
    pub fn for_push(device: &Device, name: &str, bindings: &[Binding]) -> Result<SetLayout> {
        SetLayout::create(device, name, bindings, vk::DescriptorSetLayoutCreateFlags::PUSH_DESCRIPTOR_KHR)
    }

    fn create(
        device: &Device,
        name: &str,
        bindings: &[Binding],
        flags: vk::DescriptorSetLayoutCreateFlags,
    ) -> Result<SetLayout> {
        let limit = device.limits().max_textures;
        if let Some(array) = bindings.iter().find(|b| b.array && b.count > limit) {
            let (device, count) = (&device.info().name, array.count);
            return Err(Error::Unsupported(format!(
                "the scene has {count} textures, but {device} can bind only {limit}"
            )));
        }
        let infos: Vec<_> = bindings
            .iter()
            .map(|b| {
                vk::DescriptorSetLayoutBinding::default()
                    .binding(b.binding)
                    .descriptor_type(b.kind)
                    .descriptor_count(b.count)
                    .stage_flags(b.stages)
            })
            .collect();
        let array = vk::DescriptorBindingFlags::PARTIALLY_BOUND
            | vk::DescriptorBindingFlags::VARIABLE_DESCRIPTOR_COUNT;
        let binding_flags: Vec<_> =
            bindings.iter().map(|b| if b.array { array } else { Default::default() }).collect();
        let mut extra =
            vk::DescriptorSetLayoutBindingFlagsCreateInfo::default().binding_flags(&binding_flags);
        let mut info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&infos).flags(flags);
        if bindings.iter().any(|b| b.array) {
            info = info.push_next(&mut extra);
        }
        // SAFETY: a valid create info; `drop` destroys the layout.
        let handle = unsafe { device.create_descriptor_set_layout(&info, None) }
            .check(format_args!("create descriptor set layout '{name}'"))?;
        device.set_name(handle, name);
        Ok(SetLayout(Arc::new(Layout { device: device.clone(), handle, bindings: bindings.to_vec() })))
    }

    pub fn handle(&self) -> vk::DescriptorSetLayout {
        self.0.handle
    }
}

impl Drop for Layout {
    fn drop(&mut self) {
        // SAFETY: sets and pipelines that use it hold it.
        unsafe { self.device.destroy_descriptor_set_layout(self.handle, None) };
    }
}

/// A set with its own pool, written before its first use. What is bound must live as long as it.
pub struct DescriptorSet {
    device: Device,
    pool: vk::DescriptorPool,
    handle: vk::DescriptorSet,
    layout: SetLayout,
}

impl DescriptorSet {
    /// `array_count`: length of the array binding, if the layout has one (0 gives room for one, unbound).
    pub fn new(device: &Device, name: &str, layout: &SetLayout, array_count: u32) -> Result<DescriptorSet> {
        let array_count = array_count.max(1);
        let bindings = &layout.0.bindings;
        let sizes: Vec<_> = bindings
            .iter()
            .map(|b| {
                let count = if b.array { array_count } else { b.count };
                vk::DescriptorPoolSize::default().ty(b.kind).descriptor_count(count)
            })
            .collect();
        let info = vk::DescriptorPoolCreateInfo::default().max_sets(1).pool_sizes(&sizes);
        // SAFETY: a valid create info; `drop` destroys the pool.
        let pool = unsafe { device.create_descriptor_pool(&info, None) }
            .check(format_args!("create descriptor pool '{name}'"))?;
        let handle = vk::DescriptorSet::null();
        let mut set = DescriptorSet { device: device.clone(), pool, handle, layout: layout.clone() };
        let (layouts, counts) = ([layout.handle()], [array_count]);
        let mut variable =
            vk::DescriptorSetVariableDescriptorCountAllocateInfo::default().descriptor_counts(&counts);
        let mut info = vk::DescriptorSetAllocateInfo::default().descriptor_pool(pool).set_layouts(&layouts);
        if bindings.iter().any(|b| b.array) {
            info = info.push_next(&mut variable);
        }
        // SAFETY: the pool has room for this one set.
        let sets = unsafe { device.allocate_descriptor_sets(&info) }
            .check(format_args!("allocate descriptor set '{name}'"))?;
        set.handle = sets.first().copied().unwrap_or_default();
        device.set_name(set.handle, name);
        Ok(set)
    }

    pub fn handle(&self) -> vk::DescriptorSet {
        self.handle
    }

    pub fn layout(&self) -> &SetLayout {
        &self.layout
    }

    pub fn bind_tlas(&self, binding: u32, tlas: &Tlas) {
        let handles = [tlas.handle()];
        let mut structures =
            vk::WriteDescriptorSetAccelerationStructureKHR::default().acceleration_structures(&handles);
        let write = self.write(binding, vk::DescriptorType::ACCELERATION_STRUCTURE_KHR);
        self.update(write.descriptor_count(1).push_next(&mut structures));
    }

    pub fn bind_storage_buffer(&self, binding: u32, buffer: &Buffer) {
        let buffers = [buffer.descriptor()];
        self.update(self.write(binding, vk::DescriptorType::STORAGE_BUFFER).buffer_info(&buffers));
    }

    /// Binds textures from index 0 on: views, in the layout for sampling, with their samplers.
    pub fn bind_textures(&self, binding: u32, textures: &[(vk::ImageView, vk::Sampler)]) {
        if textures.is_empty() {
            return;
        }
        let images: Vec<_> = textures
            .iter()
            .map(|&(view, sampler)| {
                vk::DescriptorImageInfo::default()
                    .image_view(view)
                    .sampler(sampler)
                    .image_layout(vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL)
            })
            .collect();
        self.update(self.write(binding, vk::DescriptorType::COMBINED_IMAGE_SAMPLER).image_info(&images));
    }

    fn write(&self, binding: u32, kind: vk::DescriptorType) -> vk::WriteDescriptorSet<'static> {
        vk::WriteDescriptorSet::default().dst_set(self.handle).dst_binding(binding).descriptor_type(kind)
    }

    fn update(&self, write: vk::WriteDescriptorSet) {
        // SAFETY: the set isn't in use yet; the write's resources are alive and of the binding's type.
        unsafe { self.device.update_descriptor_sets(&[write], &[]) };
    }
}

impl Drop for DescriptorSet {
    fn drop(&mut self) {
        // SAFETY: the owner keeps it until the device is done with it; the set goes with its pool.
        unsafe { self.device.destroy_descriptor_pool(self.pool, None) };
    }
}

/// Buffers of a set that is pushed into a command buffer, not kept.
#[derive(Default)]
pub struct PushSet(Vec<(u32, vk::DescriptorType, vk::DescriptorBufferInfo)>);

impl PushSet {
    pub fn new() -> PushSet {
        PushSet::default()
    }

    pub fn storage_buffer(mut self, binding: u32, buffer: &Buffer) -> PushSet {
        self.0.push((binding, vk::DescriptorType::STORAGE_BUFFER, buffer.descriptor()));
        self
    }

    pub fn uniform_buffer(mut self, binding: u32, buffer: &Buffer) -> PushSet {
        self.0.push((binding, vk::DescriptorType::UNIFORM_BUFFER, buffer.descriptor()));
        self
    }

    pub fn push(
        &self,
        device: &Device,
        cmd: vk::CommandBuffer,
        bind_point: vk::PipelineBindPoint,
        layout: vk::PipelineLayout,
        set: u32,
    ) {
        let writes = self.0.iter().map(|(binding, kind, info)| {
            let write = vk::WriteDescriptorSet::default().dst_binding(*binding).descriptor_type(*kind);
            write.buffer_info(std::slice::from_ref(info))
        });
        let writes: Vec<_> = writes.collect();
        // SAFETY: `cmd` is recording, set `set` of the layout is a push layout with these bindings.
        unsafe { device.push_descriptor().cmd_push_descriptor_set(cmd, bind_point, layout, set, &writes) };
    }
}
