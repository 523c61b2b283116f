//! Memory of a device: the allocator of buffers and images, and its use.

use super::device::Device;
use super::physical;
use crate::error::{Error, Left, Result};
use ash::vk;
use gpu_allocator::vulkan::{
    Allocation, AllocationCreateDesc, AllocationScheme, Allocator, AllocatorCreateDesc,
};
use gpu_allocator::{AllocationError, MemoryLocation};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The device's allocator, its own or an application's; it goes before the device.
pub(super) struct DeviceMemory {
    pub allocator: Arc<Mutex<Allocator>>,
    used: AtomicU64,
    has_budget: bool,
}

/// Buffers and images from this size on are worth asking the driver for its budget, bytes.
const LARGE: u64 = 16 << 20;

impl DeviceMemory {
    /// With an allocator of its own where `lent` is none.
    pub fn new(
        instance: &ash::Instance,
        device: &ash::Device,
        physical: vk::PhysicalDevice,
        name: &str,
        lent: Option<Arc<Mutex<Allocator>>>,
    ) -> Result<DeviceMemory> {
        let make = || Self::allocator(instance, device, physical, name);
        Ok(DeviceMemory {
            allocator: lent.map_or_else(make, Ok)?,
            used: AtomicU64::new(0),
            has_budget: physical::has_memory_budget(instance, physical)?,
        })
    }

    fn allocator(
        instance: &ash::Instance,
        device: &ash::Device,
        physical: vk::PhysicalDevice,
        name: &str,
    ) -> Result<Arc<Mutex<Allocator>>> {
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
        Ok(Arc::new(Mutex::new(allocator)))
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
        if requirements.size >= LARGE {
            self.check_room(name, requirements.size)?;
        }
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

    /// Fails where there are no `bytes` more for `what`. A processor's driver promises memory that the machine has not, and the
    /// system then ends the program that uses it.
    pub fn check_room(&self, what: &str, bytes: u64) -> Result<()> {
        let left = self.room();
        if bytes <= left {
            return Ok(());
        }
        let device = if self.info().is_processor() { "this machine" } else { "the GPU" };
        Err(Error::OutOfMemory { what: what.into(), bytes, device, left: Left::Bytes(left) })
    }

    /// Bytes: what the system has left for a processor, and what the largest heap of any other device has beside what is in use.
    fn room(&self) -> u64 {
        let memory = self.memory();
        let mut budget = vk::PhysicalDeviceMemoryBudgetPropertiesEXT::default();
        let mut properties = vk::PhysicalDeviceMemoryProperties2::default();
        if memory.has_budget {
            properties = properties.push_next(&mut budget);
        }
        // SAFETY: the device is of this instance, and has the extension whose structure is asked for.
        unsafe {
            self.instance().get_physical_device_memory_properties2(self.physical_device(), &mut properties)
        };
        let heaps = properties.memory_properties;
        let largest = heaps.memory_heaps_as_slice().iter().map(|heap| heap.size).max().unwrap_or(0);
        if memory.has_budget && self.info().is_processor() {
            return budget.heap_budget[0].saturating_sub(budget.heap_usage[0]);
        }
        largest.saturating_sub(memory.used())
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
    Error::OutOfMemory { what: what.into(), bytes, device, left: Left::Less }
}

#[cfg(test)]
mod tests {
    use super::super::testing::with_device;

    #[test]
    fn memory_that_is_not_there_is_refused() {
        with_device(|device| {
            assert!(device.check_room("a picture", 1 << 20).is_ok());
            let error = device.check_room("a picture", 1 << 60).unwrap_err();
            let text = "a picture needs 1152921504606846976 bytes";
            assert!(error.to_string().contains(text) && error.to_string().contains(" left)"), "{error}");
        });
    }

    /// Against the system's own word, which other programs change meanwhile.
    #[test]
    #[cfg(target_os = "linux")]
    fn a_processor_has_what_the_system_has_left() {
        with_device(|device| {
            let text = std::fs::read_to_string("/proc/meminfo").unwrap();
            let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:")).unwrap();
            let available = line.trim().trim_end_matches(" kB").parse::<u64>().unwrap() * 1024;
            let room = device.room();
            let near = (available / 2..=available * 2).contains(&room);
            assert!(near || !device.info().is_processor(), "{room} of {available}");
        });
    }
}
