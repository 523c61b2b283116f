//! The device: a cheap shared handle to instance, queue, allocator and extension functions.

use super::c_string;
use super::handles::Handles;
use super::instance::{Instance, MessageLog};
use super::limits::Limits;
use super::memory::DeviceMemory;
use super::physical::{self, DeviceInfo, PhysicalDevice};
use super::pipeline_cache::PipelineCache;
use super::queue::Queue;
use super::samplers::Samplers;
use crate::error::Result;
use crate::startup;
use ash::{ext, khr, vk};
use gpu_allocator::vulkan::Allocator;
use std::ffi::CStr;
use std::mem::ManuallyDrop;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// Which device, and what it should be able to do.
///
/// ```
/// use candela::vulkan::{Device, DeviceOptions};
///
/// let device = Device::new(&DeviceOptions { validate: false, device: None, ..DeviceOptions::default() })?;
/// println!("{}, {} bytes in use", device.info().name, device.memory_used());
/// # Ok::<(), candela::error::Error>(())
/// ```
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

/// Vulkan handles of an application, and what it has enabled: see [`Device::from_raw`].
pub struct RawDevice {
    /// Vulkan's loader.
    pub entry: ash::Entry,
    /// Of the device.
    pub instance: ash::Instance,
    /// That the device is of.
    pub physical_device: vk::PhysicalDevice,
    /// The logical device.
    pub device: ash::Device,
    /// With graphics and compute.
    pub queue: vk::Queue,
    /// Of the queue.
    pub queue_family: u32,
    /// `samplerAnisotropy` is enabled.
    pub has_anisotropy: bool,
    /// VK_EXT_debug_utils is enabled in the instance.
    pub has_debug_utils: bool,
    /// Where buffers and images take their memory, made with `buffer_device_address`; none: an allocator of Candela's own.
    pub allocator: Option<Arc<Mutex<Allocator>>>,
}

/// A logical device with one queue. Clones share it; whatever is made from it holds a clone, so it goes last.
#[derive(Clone)]
pub struct Device(Arc<Inner>);

struct Inner {
    handles: Handles,
    pipelines: PipelineCache,
    physical: PhysicalDevice,
    limits: Limits,
    queue: Queue,
    /// Dropped by hand: before the device.
    memory: ManuallyDrop<DeviceMemory>,
    samplers: Samplers,
    instance: Instance,
}

impl std::ops::Deref for Device {
    type Target = ash::Device;
    fn deref(&self) -> &ash::Device {
        &self.0.handles.device
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
        if options.pipeline_statistics && physical::has_executables(&instance.handle, physical.handle)? {
            extensions.push(khr::pipeline_executable_properties::NAME);
        }
        let (handles, anisotropy) =
            Handles::new(&instance.handle, instance.has_debug_utils, &physical, &extensions)?;
        let queue = Queue::new(&handles.device, physical.queue_family);
        let cache = options.pipeline_cache.as_deref();
        Device::assemble(instance, physical, handles, queue, anisotropy, cache, None)
    }

    /// Instance, device and queue of an application, which it goes on using, and perhaps its allocator. Candela destroys none of
    /// them.
    ///
    /// # Errors
    /// The device lacks an extension or feature, or memory.
    ///
    /// # Safety
    /// The handles belong together and are alive until the last clone of the device, and all that was made from it, is
    /// dropped. The instance and the device have Vulkan 1.2 or later; [`EXTENSIONS`] and [`Features`] were enabled. The
    /// application takes [`Device::queue`] for its own submissions, and does not wait for the whole device while another
    /// thread uses Candela.
    ///
    /// [`EXTENSIONS`]: super::EXTENSIONS
    /// [`Features`]: super::Features
    pub unsafe fn from_raw(raw: RawDevice, pipeline_cache: Option<&Path>) -> Result<Device> {
        let mut physical =
            physical::inspect(&raw.instance, raw.physical_device, &physical::EXTENSIONS)?.complete()?;
        physical.queue_family = raw.queue_family;
        let handles = Handles::borrowed(&raw.instance, raw.has_debug_utils, raw.device);
        let instance = Instance::borrowed(raw.entry, raw.instance, raw.has_debug_utils);
        let queue = Queue::borrowed(raw.queue, raw.queue_family);
        let (anisotropy, allocator) = (raw.has_anisotropy, raw.allocator);
        Device::assemble(instance, physical, handles, queue, anisotropy, pipeline_cache, allocator)
    }

    fn assemble(
        instance: Instance,
        physical: PhysicalDevice,
        handles: Handles,
        queue: Queue,
        anisotropy: bool,
        cache: Option<&Path>,
        allocator: Option<Arc<Mutex<Allocator>>>,
    ) -> Result<Device> {
        let limits = Limits::of(&instance.handle, &physical, anisotropy);
        // SAFETY: a device of this instance.
        let properties = unsafe { instance.handle.get_physical_device_properties(physical.handle) };
        let pipelines = PipelineCache::new(&handles.device, cache, &properties);
        // SAFETY: nothing has been made from the device yet.
        let pipelines = pipelines.inspect_err(|_| unsafe { handles.destroy() })?;
        let name = &physical.info.name;
        let memory = DeviceMemory::new(&instance.handle, &handles.device, physical.handle, name, allocator);
        // SAFETY: nothing else has been made from the device yet.
        let memory = memory.inspect_err(|_| unsafe {
            handles.device.destroy_pipeline_cache(pipelines.handle, None);
            handles.destroy();
        })?;
        Ok(Device(Arc::new(Inner {
            limits,
            queue,
            memory: ManuallyDrop::new(memory),
            samplers: Samplers::default(),
            handles,
            pipelines,
            physical,
            instance,
        })))
    }

    /// What the device is.
    pub fn info(&self) -> &DeviceInfo {
        &self.0.physical.info
    }

    /// What it can do.
    pub fn limits(&self) -> &Limits {
        &self.0.limits
    }

    /// Vulkan's loader.
    pub fn entry(&self) -> &ash::Entry {
        &self.0.instance.entry
    }

    /// Its instance.
    pub fn instance(&self) -> &ash::Instance {
        &self.0.instance.handle
    }

    /// What it is made from.
    pub fn physical_device(&self) -> vk::PhysicalDevice {
        self.0.physical.handle
    }

    /// For all pipelines; several threads may use it.
    pub fn pipeline_cache(&self) -> vk::PipelineCache {
        self.0.pipelines.handle
    }

    /// Functions of VK_KHR_acceleration_structure.
    pub fn acceleration(&self) -> &khr::acceleration_structure::Device {
        &self.0.handles.acceleration
    }

    /// Functions of VK_KHR_ray_tracing_pipeline.
    pub fn ray_tracing(&self) -> &khr::ray_tracing_pipeline::Device {
        &self.0.handles.ray_tracing
    }

    /// Functions of VK_KHR_push_descriptor.
    pub fn push_descriptor(&self) -> &khr::push_descriptor::Device {
        &self.0.handles.push_descriptor
    }

    /// Functions of VK_EXT_debug_utils, where it is enabled.
    pub fn debug_utils(&self) -> Option<&ext::debug_utils::Device> {
        self.0.handles.debug_utils.as_ref()
    }

    /// If pipelines are made to tell about themselves.
    pub(super) fn executables(&self) -> Option<&khr::pipeline_executable_properties::Device> {
        self.0.handles.executables.as_ref()
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
    pub fn allocator(&self) -> &Arc<Mutex<Allocator>> {
        &self.memory().allocator
    }

    /// Bytes that buffers and images occupy now.
    pub fn memory_used(&self) -> u64 {
        self.memory().used()
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

    pub(super) fn submission(&self) -> &Queue {
        &self.0.queue
    }

    pub(super) fn memory(&self) -> &DeviceMemory {
        &self.0.memory
    }

    pub(super) fn samplers(&self) -> &Samplers {
        &self.0.samplers
    }
}

impl Drop for Inner {
    fn drop(&mut self) {
        let device = &self.handles.device;
        self.pipelines.save(device);
        let queue = self.queue.lock();
        // SAFETY: all that was made from the device held a clone of it, so it is gone; memory goes before the device, and
        // nothing reads it afterwards.
        unsafe {
            let _ = device.queue_wait_idle(*queue);
            for sampler in self.samplers.take() {
                device.destroy_sampler(sampler, None);
            }
            ManuallyDrop::drop(&mut self.memory);
            device.destroy_pipeline_cache(self.pipelines.handle, None);
            self.handles.destroy();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing;
    use super::*;
    use crate::error::Error;
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
