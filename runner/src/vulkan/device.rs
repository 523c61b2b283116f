//! The device: a cheap shared handle to instance, queue, allocator and extension functions.

use super::image::SamplerKey;
use super::instance::{Instance, MessageLog};
use super::physical::{self, DeviceInfo, PhysicalDevice};
use super::pipeline_cache::PipelineCache;
use super::{Check, c_string};
use crate::error::{Error, Result};
use crate::startup;
use ash::{ext, khr, vk};
use gpu_allocator::vulkan::{
    Allocation, AllocationCreateDesc, AllocationScheme, Allocator, AllocatorCreateDesc,
};
use gpu_allocator::{AllocationError, MemoryLocation};
use std::collections::HashMap;
use std::ffi::CStr;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

#[derive(Clone, Debug, Default)]
pub struct DeviceOptions {
    /// Runs under the Khronos validation layer and collects what it says.
    pub validate: bool,
    /// Index, or part of the name, of the device to use; else the fastest kind is chosen.
    pub device: Option<String>,
    /// What a window's surface needs of the instance; if any, the device gets VK_KHR_swapchain.
    pub window_extensions: Vec<&'static CStr>,
    /// Folder where compiled pipelines outlive the program; none: they don't.
    pub pipeline_cache: Option<PathBuf>,
    /// Pipelines can tell what the driver's compiler made of them, where it offers that.
    pub pipeline_statistics: bool,
}

/// Limits that the renderer meets.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Shader group handles, bytes.
    pub handle_size: u32,
    pub handle_alignment: u32,
    pub table_alignment: u32,
    pub max_ray_dispatch: u32,
    /// Draws of one indirect command.
    pub max_draws: u32,
    pub scratch_alignment: u32,
    /// Of a bottom-level structure.
    pub max_geometries: u64,
    pub max_triangles: u64,
    /// Of a top-level structure.
    pub max_instances: u64,
    /// Nanoseconds a timestamp tick.
    pub timestamp_period: f32,
    /// 0: the queue has no timestamps.
    pub timestamp_bits: u32,
    /// Bytes of one storage buffer binding.
    pub max_storage_buffer: u64,
    pub uniform_alignment: u64,
    pub max_push_constants: u32,
    /// Sampled images that one stage can reach.
    pub max_textures: u32,
    /// Side of a 2D image, texels.
    pub max_image_side: u32,
    /// Width or height of a picture that the graphics pipeline draws.
    pub max_drawn_side: u32,
    /// 1 where the device has no anisotropic filter.
    pub max_anisotropy: f32,
}

/// A logical device with one queue. Clones share it; whatever is made from it holds a clone, so it goes last.
#[derive(Clone)]
pub struct Device(Arc<Inner>);

struct Inner {
    device: ash::Device,
    pipelines: PipelineCache,
    physical: PhysicalDevice,
    limits: Limits,
    queue: Mutex<vk::Queue>,
    acceleration: khr::acceleration_structure::Device,
    ray_tracing: khr::ray_tracing_pipeline::Device,
    push_descriptor: khr::push_descriptor::Device,
    debug_utils: Option<ext::debug_utils::Device>,
    executables: Option<khr::pipeline_executable_properties::Device>,
    /// `None` only while the device is being dropped.
    allocator: Option<Arc<Mutex<Allocator>>>,
    memory_used: AtomicU64,
    samplers: Mutex<HashMap<SamplerKey, vk::Sampler>>,
    instance: Instance,
}

impl std::ops::Deref for Device {
    type Target = ash::Device;
    fn deref(&self) -> &ash::Device {
        &self.0.device
    }
}

impl Device {
    /// Errors: no loader, no device with ray tracing (with what each lacks), no such device, no validation layer.
    pub fn new(options: &DeviceOptions) -> Result<Device> {
        startup::timed("device", || Device::create(options))
    }

    fn create(options: &DeviceOptions) -> Result<Device> {
        let instance = Instance::new(options.validate, &options.window_extensions)?;
        let mut extensions = physical::EXTENSIONS.to_vec();
        if !options.window_extensions.is_empty() {
            extensions.push(khr::swapchain::NAME);
        }
        let physical = physical::choose(&instance.handle, options.device.as_deref(), &extensions)?;
        let wants_statistics = options.pipeline_statistics;
        let has_statistics =
            wants_statistics && physical::has_executables(&instance.handle, physical.handle)?;
        if has_statistics {
            extensions.push(khr::pipeline_executable_properties::NAME);
        }
        let (device, anisotropy) = create(&instance.handle, &physical, &extensions)?;
        let limits = limits(&instance.handle, &physical, anisotropy);
        // SAFETY: a device of this instance.
        let properties = unsafe { instance.handle.get_physical_device_properties(physical.handle) };
        let pipelines = PipelineCache::new(&device, options.pipeline_cache.as_deref(), &properties);
        // SAFETY: nothing has been made from the device yet.
        let pipelines = pipelines.inspect_err(|_| unsafe { device.destroy_device(None) })?;
        let allocator = Allocator::new(&AllocatorCreateDesc {
            instance: instance.handle.clone(),
            device: device.clone(),
            physical_device: physical.handle,
            debug_settings: Default::default(),
            buffer_device_address: true,
            allocation_sizes: Default::default(),
        });
        let allocator = allocator.map_err(|e| {
            // SAFETY: nothing else has been made from the device yet.
            unsafe {
                device.destroy_pipeline_cache(pipelines.handle, None);
                device.destroy_device(None);
            }
            Error::Platform(format!("{}: can't manage its memory: {e}", physical.info.name))
        })?;
        // SAFETY: the device was created with one queue of this family.
        let queue = unsafe { device.get_device_queue(physical.queue_family, 0) };
        Ok(Device(Arc::new(Inner {
            limits,
            queue: Mutex::new(queue),
            acceleration: khr::acceleration_structure::Device::new(&instance.handle, &device),
            ray_tracing: khr::ray_tracing_pipeline::Device::new(&instance.handle, &device),
            push_descriptor: khr::push_descriptor::Device::new(&instance.handle, &device),
            executables: has_statistics
                .then(|| khr::pipeline_executable_properties::Device::new(&instance.handle, &device)),
            debug_utils: instance
                .has_debug_utils
                .then(|| ext::debug_utils::Device::new(&instance.handle, &device)),
            allocator: Some(Arc::new(Mutex::new(allocator))),
            memory_used: AtomicU64::new(0),
            samplers: Mutex::default(),
            device,
            pipelines,
            physical,
            instance,
        })))
    }

    pub fn info(&self) -> &DeviceInfo {
        &self.0.physical.info
    }

    pub fn limits(&self) -> &Limits {
        &self.0.limits
    }

    pub fn entry(&self) -> &ash::Entry {
        &self.0.instance.entry
    }

    pub fn instance(&self) -> &ash::Instance {
        &self.0.instance.handle
    }

    pub fn physical_device(&self) -> vk::PhysicalDevice {
        self.0.physical.handle
    }

    pub fn queue_family(&self) -> u32 {
        self.0.physical.queue_family
    }

    /// The queue, locked: Vulkan wants one thread at a time on it.
    pub fn queue(&self) -> MutexGuard<'_, vk::Queue> {
        self.0.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// For all pipelines; several threads may use it.
    pub fn pipeline_cache(&self) -> vk::PipelineCache {
        self.0.pipelines.handle
    }

    pub fn acceleration(&self) -> &khr::acceleration_structure::Device {
        &self.0.acceleration
    }

    pub fn ray_tracing(&self) -> &khr::ray_tracing_pipeline::Device {
        &self.0.ray_tracing
    }

    pub fn push_descriptor(&self) -> &khr::push_descriptor::Device {
        &self.0.push_descriptor
    }

    pub fn debug_utils(&self) -> Option<&ext::debug_utils::Device> {
        self.0.debug_utils.as_ref()
    }

    /// If pipelines are made to tell about themselves.
    pub(super) fn executables(&self) -> Option<&khr::pipeline_executable_properties::Device> {
        self.0.executables.as_ref()
    }

    /// Can pipelines tell what the driver's compiler made of them?
    pub fn has_pipeline_statistics(&self) -> bool {
        self.executables().is_some()
    }

    /// How all pipelines are made.
    pub(super) fn pipeline_flags(&self) -> vk::PipelineCreateFlags {
        match self.has_pipeline_statistics() {
            true => vk::PipelineCreateFlags::CAPTURE_STATISTICS_KHR,
            false => vk::PipelineCreateFlags::empty(),
        }
    }

    /// For libraries that allocate themselves (the GUI); they must let go of it before the device drops.
    pub fn allocator(&self) -> Option<&Arc<Mutex<Allocator>>> {
        self.0.allocator.as_ref()
    }

    /// Bytes that buffers and images occupy now.
    pub fn memory_used(&self) -> u64 {
        self.0.memory_used.load(Ordering::Relaxed)
    }

    /// Warnings and errors of the validation layer so far; empty without `validate`.
    pub fn validation_messages(&self) -> Vec<String> {
        self.message_log().lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// The log itself, which outlives the device.
    pub(super) fn message_log(&self) -> &MessageLog {
        &self.0.instance.messages
    }

    /// Names an object for debuggers and validation messages.
    pub fn set_name<H: vk::Handle>(&self, handle: H, name: &str) {
        let Some(debug) = self.debug_utils() else { return };
        let name = c_string(name);
        let info = vk::DebugUtilsObjectNameInfoEXT::default().object_handle(handle).object_name(&name);
        // SAFETY: the handle is alive. A name that can't be set is no loss.
        let _ = unsafe { debug.set_debug_utils_object_name(&info) };
    }

    pub fn wait_idle(&self) -> Result<()> {
        let _queue = self.queue();
        // SAFETY: the queue is locked.
        unsafe { self.device_wait_idle() }.check("wait for the device")
    }

    /// Memory for the resource `name`, of whatever size `requirements` ask for.
    pub(super) fn allocate(
        &self,
        name: &str,
        requirements: vk::MemoryRequirements,
        location: MemoryLocation,
        linear: bool,
    ) -> Result<Allocation> {
        let mut allocator = self.lock_allocator()?;
        let scheme = AllocationScheme::GpuAllocatorManaged;
        let desc = AllocationCreateDesc { name, requirements, location, linear, allocation_scheme: scheme };
        let allocation = allocator.allocate(&desc).map_err(|error| match error {
            AllocationError::OutOfMemory => out_of_memory(name, requirements.size, location),
            other => Error::Platform(format!("{name}: can't allocate {} bytes: {other}", requirements.size)),
        })?;
        self.0.memory_used.fetch_add(allocation.size(), Ordering::Relaxed);
        Ok(allocation)
    }

    pub(super) fn free(&self, allocation: Allocation) {
        self.0.memory_used.fetch_sub(allocation.size(), Ordering::Relaxed);
        if let Ok(mut allocator) = self.lock_allocator()
            && let Err(error) = allocator.free(allocation)
        {
            tracing::error!("can't free memory: {error}");
        }
    }

    fn lock_allocator(&self) -> Result<MutexGuard<'_, Allocator>> {
        let allocator = self.allocator().ok_or_else(|| Error::Internal("the device is gone".into()))?;
        Ok(allocator.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// The device's samplers, by key; they live as long as it does.
    pub(super) fn samplers(&self) -> MutexGuard<'_, HashMap<SamplerKey, vk::Sampler>> {
        self.0.samplers.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The error of a failed call that was to make a resource of `bytes`.
pub(super) fn creation_error(result: vk::Result, what: &str, bytes: u64, location: MemoryLocation) -> Error {
    match result {
        vk::Result::ERROR_OUT_OF_DEVICE_MEMORY | vk::Result::ERROR_OUT_OF_HOST_MEMORY => {
            out_of_memory(what, bytes, location)
        }
        _ => Error::Vulkan { what: format!("create {what}"), result },
    }
}

fn out_of_memory(what: &str, bytes: u64, location: MemoryLocation) -> Error {
    let device = if location == MemoryLocation::GpuOnly { "the GPU" } else { "the host" };
    Error::OutOfMemory { what: what.into(), bytes, device }
}

impl Drop for Inner {
    fn drop(&mut self) {
        self.pipelines.save(&self.device);
        // SAFETY: all that was made from the device held a clone of it, so it is gone; memory goes before the device.
        unsafe {
            let _ = self.device.device_wait_idle();
            for (_, sampler) in self.samplers.get_mut().unwrap_or_else(PoisonError::into_inner).drain() {
                self.device.destroy_sampler(sampler, None);
            }
            self.allocator = None;
            self.device.destroy_pipeline_cache(self.pipelines.handle, None);
            self.device.destroy_device(None);
        }
    }
}

/// The logical device, and whether it filters anisotropically.
fn create(
    instance: &ash::Instance,
    physical: &PhysicalDevice,
    extensions: &[&CStr],
) -> Result<(ash::Device, bool)> {
    // SAFETY: a device of this instance.
    let present = unsafe { instance.get_physical_device_features(physical.handle) };
    let enabled = vk::PhysicalDeviceFeatures::default()
        .multi_draw_indirect(true)
        .draw_indirect_first_instance(true)
        .sampler_anisotropy(present.sampler_anisotropy == vk::TRUE)
        .shader_storage_image_extended_formats(present.shader_storage_image_extended_formats == vk::TRUE);
    let mut v12 = physical::vulkan12_features();
    let mut acceleration =
        vk::PhysicalDeviceAccelerationStructureFeaturesKHR::default().acceleration_structure(true);
    let mut ray_tracing =
        vk::PhysicalDeviceRayTracingPipelineFeaturesKHR::default().ray_tracing_pipeline(true);
    let queues = [vk::DeviceQueueCreateInfo::default()
        .queue_family_index(physical.queue_family)
        .queue_priorities(&[1.0])];
    let names: Vec<_> = extensions.iter().map(|name| name.as_ptr()).collect();
    let mut executables =
        vk::PhysicalDevicePipelineExecutablePropertiesFeaturesKHR::default().pipeline_executable_info(true);
    let mut info = vk::DeviceCreateInfo::default()
        .queue_create_infos(&queues)
        .enabled_extension_names(&names)
        .enabled_features(&enabled)
        .push_next(&mut v12)
        .push_next(&mut acceleration)
        .push_next(&mut ray_tracing);
    if extensions.contains(&khr::pipeline_executable_properties::NAME) {
        info = info.push_next(&mut executables);
    }
    // SAFETY: `choose` has seen that the device has these extensions and features.
    let device = unsafe { instance.create_device(physical.handle, &info, None) }
        .check(format_args!("create device '{}'", physical.info.name))?;
    Ok((device, enabled.sampler_anisotropy == vk::TRUE))
}

fn limits(instance: &ash::Instance, physical: &PhysicalDevice, anisotropy: bool) -> Limits {
    let mut acceleration = vk::PhysicalDeviceAccelerationStructurePropertiesKHR::default();
    let mut ray_tracing = vk::PhysicalDeviceRayTracingPipelinePropertiesKHR::default();
    let mut properties =
        vk::PhysicalDeviceProperties2::default().push_next(&mut acceleration).push_next(&mut ray_tracing);
    // SAFETY: a device of this instance that has both extensions.
    unsafe { instance.get_physical_device_properties2(physical.handle, &mut properties) };
    let limits = properties.properties.limits;
    // SAFETY: as above.
    let families = unsafe { instance.get_physical_device_queue_family_properties(physical.handle) };
    let textures = [
        limits.max_per_stage_descriptor_samplers,
        limits.max_per_stage_descriptor_sampled_images,
        limits.max_descriptor_set_samplers,
        limits.max_descriptor_set_sampled_images,
    ];
    let [width, height] = limits.max_viewport_dimensions;
    let drawn = [limits.max_framebuffer_width, limits.max_framebuffer_height, width, height];
    Limits {
        handle_size: ray_tracing.shader_group_handle_size,
        handle_alignment: ray_tracing.shader_group_handle_alignment,
        table_alignment: ray_tracing.shader_group_base_alignment,
        max_ray_dispatch: ray_tracing.max_ray_dispatch_invocation_count,
        max_draws: limits.max_draw_indirect_count,
        scratch_alignment: acceleration.min_acceleration_structure_scratch_offset_alignment,
        max_geometries: acceleration.max_geometry_count,
        max_triangles: acceleration.max_primitive_count,
        max_instances: acceleration.max_instance_count,
        timestamp_period: limits.timestamp_period,
        timestamp_bits: families
            .get(physical.queue_family as usize)
            .map_or(0, |family| family.timestamp_valid_bits),
        max_storage_buffer: limits.max_storage_buffer_range.into(),
        uniform_alignment: limits.min_uniform_buffer_offset_alignment,
        max_push_constants: limits.max_push_constants_size,
        max_textures: textures.into_iter().min().unwrap_or(0),
        max_image_side: limits.max_image_dimension2_d,
        max_drawn_side: drawn.into_iter().fold(limits.max_image_dimension2_d, u32::min),
        max_anisotropy: if anisotropy { limits.max_sampler_anisotropy } else { 1.0 },
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing;
    use super::*;
    use crate::vulkan::{Buffer, Memory};

    #[test]
    fn a_device_comes_and_goes_cleanly() {
        testing::with_device(|device| {
            assert!(!device.info().name.is_empty());
            assert!(device.limits().handle_size >= 16 && device.limits().max_textures >= 16);
        });
    }

    #[test]
    fn an_unknown_device_is_refused_by_name() {
        let Some(device) = testing::device() else { return };
        let wanted = Some("Voodoo 2".to_string());
        let Err(error) = Device::new(&DeviceOptions { device: wanted, ..Default::default() }) else {
            panic!("there is no such device");
        };
        let text = error.to_string();
        assert!(text.contains("Voodoo 2") && text.contains(&device.info().name), "{text}");
    }

    #[test]
    fn what_a_device_lacks_is_said() {
        let Some(device) = testing::device() else { return };
        let chosen = physical::choose(device.instance(), None, &[c"VK_XYZ_wishful_thinking"]);
        let Err(error) = chosen else { panic!("there is no such extension") };
        let text = error.to_string();
        assert!(text.contains("VK_XYZ_wishful_thinking") && text.contains(&device.info().name), "{text}");
    }

    /// Planted error: the layer must be heard.
    #[test]
    fn validation_finds_a_copy_beyond_the_end() {
        let Some(device) = testing::device() else { return };
        let make =
            || Buffer::new(&device, "short", 64, vk::BufferUsageFlags::empty(), Memory::Device).unwrap();
        let (source, target) = (make(), make());
        let recorded: Result<()> = device.submit_once("never", |cmd| {
            let region = vk::BufferCopy::default().size(4096);
            // SAFETY: not safe at all, but never submitted.
            unsafe { device.cmd_copy_buffer(cmd, source.handle(), target.handle(), &[region]) };
            Err(Error::Internal("not submitted".into()))
        });
        assert!(recorded.is_err());
        assert!(device.validation_messages().iter().any(|m| m.contains("vkCmdCopyBuffer")));
    }

    #[test]
    fn out_of_memory_names_the_resource() {
        testing::with_device(|device| {
            let usage = vk::BufferUsageFlags::empty();
            let Err(error) = Buffer::new(device, "everything", 1 << 42, usage, Memory::Device) else {
                panic!("4 TiB fit");
            };
            let text = error.to_string();
            assert!(text.contains("everything") && text.contains("4398046511104"), "{text}");
        });
    }
}
