//! The logical device and the functions of its extensions.

use super::Check;
use super::instance::Instance;
use super::physical::{self, PhysicalDevice};
use crate::error::Result;
use ash::{ext, khr, vk};
use std::ffi::CStr;

/// What is called. Destroyed by its owner, after all that was made with it.
pub(super) struct Handles {
    pub device: ash::Device,
    pub acceleration: khr::acceleration_structure::Device,
    pub ray_tracing: khr::ray_tracing_pipeline::Device,
    pub push_descriptor: khr::push_descriptor::Device,
    pub debug_utils: Option<ext::debug_utils::Device>,
    pub executables: Option<khr::pipeline_executable_properties::Device>,
}

impl Handles {
    /// With one queue and these extensions, which `physical` has; and whether it filters anisotropically.
    pub fn new(
        instance: &Instance,
        physical: &PhysicalDevice,
        extensions: &[&CStr],
    ) -> Result<(Handles, bool)> {
        let (device, anisotropy) = create(&instance.handle, physical, extensions)?;
        let has_executables = extensions.contains(&khr::pipeline_executable_properties::NAME);
        let handle = &instance.handle;
        let handles = Handles {
            acceleration: khr::acceleration_structure::Device::new(handle, &device),
            ray_tracing: khr::ray_tracing_pipeline::Device::new(handle, &device),
            push_descriptor: khr::push_descriptor::Device::new(handle, &device),
            debug_utils: instance.has_debug_utils.then(|| ext::debug_utils::Device::new(handle, &device)),
            executables: has_executables
                .then(|| khr::pipeline_executable_properties::Device::new(handle, &device)),
            device,
        };
        Ok((handles, anisotropy))
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
