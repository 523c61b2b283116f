//! Limits of a device.

use super::physical::PhysicalDevice;
use ash::vk;

/// Limits that the renderer meets.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Shader group handles, bytes.
    pub handle_size: u32,
    /// Of shader group handles, bytes.
    pub handle_alignment: u32,
    /// Of shader binding tables, bytes.
    pub table_alignment: u32,
    /// Rays of one launch.
    pub max_ray_dispatch: u32,
    /// Draws of one indirect command.
    pub max_draws: u32,
    /// Of scratch memory of builds, bytes.
    pub scratch_alignment: u32,
    /// Of a bottom-level structure.
    pub max_geometries: u64,
    /// Of one structure.
    pub max_triangles: u64,
    /// Of a top-level structure.
    pub max_instances: u64,
    /// Nanoseconds a timestamp tick.
    pub timestamp_period: f32,
    /// 0: the queue has no timestamps.
    pub timestamp_bits: u32,
    /// Bytes of one storage buffer binding.
    pub max_storage_buffer: u64,
    /// Of uniform buffers, bytes.
    pub uniform_alignment: u64,
    /// Bytes.
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

impl Limits {
    /// `anisotropy`: the filter is enabled.
    pub(super) fn of(instance: &ash::Instance, physical: &PhysicalDevice, anisotropy: bool) -> Limits {
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
}
