//! The logical device and the functions of its extensions.

use super::Check;
use super::features::Features;
use super::physical::PhysicalDevice;
use crate::error::Result;
use ash::{ext, khr, vk};
use std::ffi::CStr;

/// A logical device with the functions that are called.
pub(super) struct Handles {
    pub device: ash::Device,
    pub acceleration: khr::acceleration_structure::Device,
    pub ray_tracing: khr::ray_tracing_pipeline::Device,
    pub push_descriptor: khr::push_descriptor::Device,
    pub debug_utils: Option<ext::debug_utils::Device>,
    pub executables: Option<khr::pipeline_executable_properties::Device>,
    /// Destroyed by [`Handles::destroy`]; else the application does it.
    owned: bool,
}

impl Handles {
    /// A device with one queue and these extensions, which `physical` has; and whether it filters anisotropically.
    pub fn new(
        instance: &ash::Instance,
        has_debug_utils: bool,
        physical: &PhysicalDevice,
        extensions: &[&CStr],
    ) -> Result<(Handles, bool)> {
        let mut features = Features::new(instance, physical.handle);
        let device = create(instance, physical, extensions, &mut features)?;
        let has_executables = extensions.contains(&khr::pipeline_executable_properties::NAME);
        let executables =
            has_executables.then(|| khr::pipeline_executable_properties::Device::new(instance, &device));
        let handles =
            Handles { executables, owned: true, ..Handles::borrowed(instance, has_debug_utils, device) };
        Ok((handles, features.core.sampler_anisotropy == vk::TRUE))
    }

    /// The device of an application.
    pub fn borrowed(instance: &ash::Instance, has_debug_utils: bool, device: ash::Device) -> Handles {
        Handles {
            acceleration: khr::acceleration_structure::Device::new(instance, &device),
            ray_tracing: khr::ray_tracing_pipeline::Device::new(instance, &device),
            push_descriptor: khr::push_descriptor::Device::new(instance, &device),
            debug_utils: has_debug_utils.then(|| ext::debug_utils::Device::new(instance, &device)),
            executables: None,
            owned: false,
            device,
        }
    }

    /// # Safety
    /// Nothing that was made from the device is left.
    pub unsafe fn destroy(&self) {
        if self.owned {
            // SAFETY: the caller promises it.
            unsafe { self.device.destroy_device(None) };
        }
    }
}

fn create(
    instance: &ash::Instance,
    physical: &PhysicalDevice,
    extensions: &[&CStr],
    features: &mut Features,
) -> Result<ash::Device> {
    let queues = [vk::DeviceQueueCreateInfo::default()
        .queue_family_index(physical.queue_family)
        .queue_priorities(&[1.0])];
    let names: Vec<_> = extensions.iter().map(|name| name.as_ptr()).collect();
    let mut executables =
        vk::PhysicalDevicePipelineExecutablePropertiesFeaturesKHR::default().pipeline_executable_info(true);
    let info = vk::DeviceCreateInfo::default().queue_create_infos(&queues).enabled_extension_names(&names);
    let mut info = features.enable(info);
    if extensions.contains(&khr::pipeline_executable_properties::NAME) {
        info = info.push_next(&mut executables);
    }
    // SAFETY: `choose` has seen that the device has these extensions and features.
    unsafe { instance.create_device(physical.handle, &info, None) }
        .check(format_args!("create device '{}'", physical.info.name))
}
