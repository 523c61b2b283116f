//! Features of a device that Candela enables.

use ash::vk;

/// Features as structures for `vk::DeviceCreateInfo`: the required ones (see `physical`), and the optional ones that a device
/// has. An application with features of its own in the same structures merges them by hand.
pub struct Features {
    /// Of Vulkan 1.0.
    pub core: vk::PhysicalDeviceFeatures,
    /// Of Vulkan 1.2.
    pub v12: vk::PhysicalDeviceVulkan12Features<'static>,
    /// Of its extension.
    pub acceleration_structure: vk::PhysicalDeviceAccelerationStructureFeaturesKHR<'static>,
    /// Of its extension.
    pub ray_tracing_pipeline: vk::PhysicalDeviceRayTracingPipelineFeaturesKHR<'static>,
}

impl Features {
    /// For `physical`, a device of `instance`.
    pub fn new(instance: &ash::Instance, physical: vk::PhysicalDevice) -> Features {
        // SAFETY: a device of this instance.
        let present = unsafe { instance.get_physical_device_features(physical) };
        let formats = present.shader_storage_image_extended_formats == vk::TRUE;
        Features {
            core: vk::PhysicalDeviceFeatures::default()
                .multi_draw_indirect(true)
                .draw_indirect_first_instance(true)
                .sampler_anisotropy(present.sampler_anisotropy == vk::TRUE)
                .shader_storage_image_extended_formats(formats),
            v12: vk::PhysicalDeviceVulkan12Features::default()
                .scalar_block_layout(true)
                .vulkan_memory_model(true)
                .vulkan_memory_model_device_scope(true)
                .buffer_device_address(true)
                .runtime_descriptor_array(true)
                .shader_sampled_image_array_non_uniform_indexing(true)
                .descriptor_binding_partially_bound(true)
                .descriptor_binding_variable_descriptor_count(true)
                .host_query_reset(true)
                .timeline_semaphore(true),
            acceleration_structure: vk::PhysicalDeviceAccelerationStructureFeaturesKHR::default()
                .acceleration_structure(true),
            ray_tracing_pipeline: vk::PhysicalDeviceRayTracingPipelineFeaturesKHR::default()
                .ray_tracing_pipeline(true),
        }
    }

    /// Adds them to `info`.
    pub fn enable<'a>(&'a mut self, info: vk::DeviceCreateInfo<'a>) -> vk::DeviceCreateInfo<'a> {
        info.enabled_features(&self.core)
            .push_next(&mut self.v12)
            .push_next(&mut self.acceleration_structure)
            .push_next(&mut self.ray_tracing_pipeline)
    }
}
