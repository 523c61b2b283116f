//! Memory of a device: what buffers and images are put in, and how much of it is used.

use super::device::Device;
use crate::error::{Error, Result};
use ash::vk;
use gpu_allocator::vulkan::{
    Allocation, AllocationCreateDesc, AllocationScheme, Allocator, AllocatorCreateDesc,
};
use gpu_allocator::{AllocationError, MemoryLocation};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The device's allocator; it goes before the device.
pub(super) struct DeviceMemory {
    pub allocator: Arc<Mutex<Allocator>>,
    used: AtomicU64,
}

impl DeviceMemory {
    pub fn new(
        instance: &ash::Instance,
        device: &ash::Device,
        physical: vk::PhysicalDevice,
        name: &str,
    ) -> Result<DeviceMemory> {
        let allocator = Allocator::new(&AllocatorCreateDesc {
            instance: instance.clone(),
            device: device.clone(),
            physical_device: physical,
            debug_settings: Default::default(),
            buffer_device_address: true,
            allocation_sizes: Default::default(),
        });
        let allocator =
            allocator.map_err(|e| Error::Platform(format!("{name}: can't manage its memory: {e}")))?;
        Ok(DeviceMemory { allocator: Arc::new(Mutex::new(allocator)), used: AtomicU64::new(0) })
    }

    pub fn used(&self) -> u64 {
        self.used.load(Ordering::Relaxed)
    }

    fn lock(&self) -> MutexGuard<'_, Allocator> {
        self.allocator.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Device {
    /// Memory for the resource `name`, of whatever size `requirements` ask for.
    pub(super) fn allocate(
        &self,
        name: &str,
        requirements: vk::MemoryRequirements,
        location: MemoryLocation,
        linear: bool,
    ) -> Result<Allocation> {
        let memory = self.memory();
        let scheme = AllocationScheme::GpuAllocatorManaged;
        let desc = AllocationCreateDesc { name, requirements, location, linear, allocation_scheme: scheme };
        let allocation = memory.lock().allocate(&desc).map_err(|error| match error {
            AllocationError::OutOfMemory => out_of_memory(name, requirements.size, location),
            other => Error::Platform(format!("{name}: can't allocate {} bytes: {other}", requirements.size)),
        })?;
        memory.used.fetch_add(allocation.size(), Ordering::Relaxed);
        Ok(allocation)
    }

    pub(super) fn free(&self, allocation: Allocation) {
        let memory = self.memory();
        memory.used.fetch_sub(allocation.size(), Ordering::Relaxed);
        if let Err(error) = memory.lock().free(allocation) {
            tracing::error!("can't free memory: {error}");
        }
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
