//! Physical devices: their features, what they lack, and the choice among them.

use super::Check;
use crate::error::{Error, Result};
use ash::{ext, khr, vk};
use serde::Serialize;
use std::ffi::CStr;

/// A device, in words.
#[derive(Clone, Debug, Serialize)]
pub struct DeviceInfo {
    /// As the driver calls it.
    pub name: String,
    /// "discrete", "integrated", "virtual", "cpu" or "other".
    pub kind: &'static str,
    /// The driver's name and version.
    pub driver: String,
    /// Vulkan version that the device offers.
    pub api_version: String,
}

impl DeviceInfo {
    /// Does a processor play the device?
    pub fn is_processor(&self) -> bool {
        self.kind == "cpu"
    }
}

pub(super) struct PhysicalDevice {
    pub handle: vk::PhysicalDevice,
    pub info: DeviceInfo,
    /// Queue family with graphics and compute.
    pub queue_family: u32,
    /// Required extensions, features and the like that it has not.
    missing: Vec<String>,
}

/// Device extensions that Candela needs.
pub const EXTENSIONS: [&CStr; 4] = [
    khr::acceleration_structure::NAME,
    khr::ray_tracing_pipeline::NAME,
    khr::deferred_host_operations::NAME,
    khr::push_descriptor::NAME,
];

/// The best device, or the one that `wanted` names: an index, or a part of the name.
pub(super) fn choose(
    instance: &ash::Instance,
    wanted: Option<&str>,
    extensions: &[&CStr],
) -> Result<PhysicalDevice> {
    // SAFETY: the instance is alive.
    let handles = match unsafe { instance.enumerate_physical_devices() } {
        // The loader's word for: no installed driver found hardware.
        Err(vk::Result::ERROR_INITIALIZATION_FAILED) => Vec::new(),
        handles => handles.check("list devices")?,
    };
    let mut devices = Vec::new();
    for handle in handles {
        devices.push(inspect(instance, handle, extensions)?);
    }
    if let Some(wanted) = wanted {
        devices = matching(devices, wanted)?;
    }
    let seen: Vec<String> = devices.iter().map(PhysicalDevice::describe).collect();
    let usable = devices.into_iter().filter(|d| d.missing.is_empty());
    // The first of the best kind.
    usable.min_by_key(|d| kind_rank(d.info.kind)).ok_or(Error::NoDevice { seen })
}

fn matching(devices: Vec<PhysicalDevice>, wanted: &str) -> Result<Vec<PhysicalDevice>> {
    let names: Vec<_> = devices.iter().enumerate().map(|(i, d)| format!("{i}: {}", d.info.name)).collect();
    let index = wanted.parse::<usize>().ok().filter(|&i| i < devices.len());
    let part = wanted.to_lowercase();
    let matches = |i: usize, d: &PhysicalDevice| match index {
        Some(index) => i == index,
        None => d.info.name.to_lowercase().contains(&part),
    };
    let found: Vec<_> =
        devices.into_iter().enumerate().filter(|(i, d)| matches(*i, d)).map(|(_, d)| d).collect();
    if found.is_empty() {
        return Err(Error::Usage(format!(
            "--device: no device matches '{wanted}'; there are {}",
            names.join(", ")
        )));
    }
    Ok(found)
}

impl PhysicalDevice {
    /// Itself, if it lacks nothing.
    pub fn complete(self) -> Result<PhysicalDevice> {
        if self.missing.is_empty() { Ok(self) } else { Err(Error::NoDevice { seen: vec![self.describe()] }) }
    }

    fn describe(&self) -> String {
        match &self.missing[..] {
            [] => self.info.name.clone(),
            missing => format!("{} lacks {}", self.info.name, missing.join(", ")),
        }
    }
}

fn kind_rank(kind: &str) -> usize {
    ["discrete", "integrated", "virtual", "cpu"].iter().position(|k| *k == kind).unwrap_or(4)
}

/// The device `handle` with the names of what it lacks.
pub(super) fn inspect(
    instance: &ash::Instance,
    handle: vk::PhysicalDevice,
    wanted: &[&CStr],
) -> Result<PhysicalDevice> {
    // SAFETY: `handle` is of this instance.
    let properties = unsafe { instance.get_physical_device_properties(handle) };
    let mut missing = Vec::new();
    let mut driver = String::new();
    if properties.api_version < vk::API_VERSION_1_2 {
        missing.push("Vulkan 1.2".to_string());
    } else {
        driver = driver_name(instance, handle);
        missing.extend(missing_extensions(instance, handle, wanted)?);
        missing.extend(missing_features(instance, handle).into_iter().map(String::from));
    }
    let queue_family = queue_family(instance, handle);
    if queue_family.is_none() {
        missing.push("a queue with graphics and compute".to_string());
    }
    let info = DeviceInfo {
        name: properties.device_name_as_c_str().unwrap_or_default().to_string_lossy().into_owned(),
        kind: match properties.device_type {
            vk::PhysicalDeviceType::DISCRETE_GPU => "discrete",
            vk::PhysicalDeviceType::INTEGRATED_GPU => "integrated",
            vk::PhysicalDeviceType::VIRTUAL_GPU => "virtual",
            vk::PhysicalDeviceType::CPU => "cpu",
            _ => "other",
        },
        driver,
        api_version: version(properties.api_version),
    };
    Ok(PhysicalDevice { handle, info, queue_family: queue_family.unwrap_or(0), missing })
}

fn version(v: u32) -> String {
    format!("{}.{}.{}", vk::api_version_major(v), vk::api_version_minor(v), vk::api_version_patch(v))
}

fn driver_name(instance: &ash::Instance, handle: vk::PhysicalDevice) -> String {
    let mut driver = vk::PhysicalDeviceDriverProperties::default();
    let mut properties = vk::PhysicalDeviceProperties2::default().push_next(&mut driver);
    // SAFETY: a device of this instance, Vulkan 1.2.
    unsafe { instance.get_physical_device_properties2(handle, &mut properties) };
    let text = |s: std::result::Result<&CStr, _>| s.unwrap_or_default().to_string_lossy().into_owned();
    format!("{} {}", text(driver.driver_name_as_c_str()), text(driver.driver_info_as_c_str()))
        .trim()
        .to_string()
}

fn queue_family(instance: &ash::Instance, handle: vk::PhysicalDevice) -> Option<u32> {
    // SAFETY: a device of this instance.
    let families = unsafe { instance.get_physical_device_queue_family_properties(handle) };
    let both = vk::QueueFlags::GRAPHICS | vk::QueueFlags::COMPUTE;
    families.iter().position(|f| f.queue_flags.contains(both)).map(|i| i as u32)
}

fn missing_extensions(
    instance: &ash::Instance,
    handle: vk::PhysicalDevice,
    wanted: &[&CStr],
) -> Result<Vec<String>> {
    // SAFETY: a device of this instance.
    let present =
        unsafe { instance.enumerate_device_extension_properties(handle) }.check("list device extensions")?;
    let has = |name: &CStr| present.iter().any(|e| e.extension_name_as_c_str() == Ok(name));
    Ok(wanted.iter().filter(|name| !has(name)).map(|name| name.to_string_lossy().into_owned()).collect())
}

/// Can its pipelines tell what they were compiled to?
pub(super) fn has_executables(instance: &ash::Instance, handle: vk::PhysicalDevice) -> Result<bool> {
    let extension = [khr::pipeline_executable_properties::NAME];
    let mut executables = vk::PhysicalDevicePipelineExecutablePropertiesFeaturesKHR::default();
    let mut features = vk::PhysicalDeviceFeatures2::default().push_next(&mut executables);
    // SAFETY: a device of this instance, Vulkan 1.2; the structure of an absent extension is left as it is.
    unsafe { instance.get_physical_device_features2(handle, &mut features) };
    let feature = executables.pipeline_executable_info == vk::TRUE;
    Ok(feature && missing_extensions(instance, handle, &extension)?.is_empty())
}

/// Can it be asked what its heaps have left?
pub(super) fn has_memory_budget(instance: &ash::Instance, handle: vk::PhysicalDevice) -> Result<bool> {
    Ok(missing_extensions(instance, handle, &[ext::memory_budget::NAME])?.is_empty())
}

fn missing_features(instance: &ash::Instance, handle: vk::PhysicalDevice) -> Vec<&'static str> {
    let mut acceleration = vk::PhysicalDeviceAccelerationStructureFeaturesKHR::default();
    let mut ray_tracing = vk::PhysicalDeviceRayTracingPipelineFeaturesKHR::default();
    let mut v12 = vk::PhysicalDeviceVulkan12Features::default();
    let mut features = vk::PhysicalDeviceFeatures2::default()
        .push_next(&mut v12)
        .push_next(&mut acceleration)
        .push_next(&mut ray_tracing);
    // SAFETY: a device of this instance, Vulkan 1.2; structures of absent extensions are left as they are.
    unsafe { instance.get_physical_device_features2(handle, &mut features) };
    let v10 = features.features;
    let all = [
        (v10.multi_draw_indirect, "multiDrawIndirect"),
        (v10.draw_indirect_first_instance, "drawIndirectFirstInstance"),
        (v12.scalar_block_layout, "scalarBlockLayout"),
        (v12.vulkan_memory_model, "vulkanMemoryModel"),
        (v12.vulkan_memory_model_device_scope, "vulkanMemoryModelDeviceScope"),
        (v12.buffer_device_address, "bufferDeviceAddress"),
        (v12.runtime_descriptor_array, "runtimeDescriptorArray"),
        (v12.shader_sampled_image_array_non_uniform_indexing, "shaderSampledImageArrayNonUniformIndexing"),
        (v12.descriptor_binding_partially_bound, "descriptorBindingPartiallyBound"),
        (v12.descriptor_binding_variable_descriptor_count, "descriptorBindingVariableDescriptorCount"),
        (v12.host_query_reset, "hostQueryReset"),
        (v12.timeline_semaphore, "timelineSemaphore"),
        (acceleration.acceleration_structure, "accelerationStructure"),
        (ray_tracing.ray_tracing_pipeline, "rayTracingPipeline"),
    ];
    all.into_iter().filter(|(has, _)| *has == vk::FALSE).map(|(_, name)| name).collect()
}
