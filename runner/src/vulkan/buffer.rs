//! Buffers: on the device, or mapped by the host for upload or readback.

use super::device::Device;
use super::memory::creation_error;
use super::upload::Uploader;
use super::{Check, memory_barrier};
use crate::error::{Error, Result};
use ash::vk;
use bytemuck::Pod;
use gpu_allocator::MemoryLocation;
use gpu_allocator::vulkan::Allocation;

/// The smallest buffer: what an empty slice gets, so that it can be bound.
const MIN_SIZE: u64 = 16;

/// Where a buffer lives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Memory {
    /// On the device.
    Device,
    /// Written by the host, read by the device.
    Upload,
    /// Written by the device, read by the host.
    Readback,
}

impl Memory {
    fn location(self) -> MemoryLocation {
        match self {
            Memory::Device => MemoryLocation::GpuOnly,
            Memory::Upload => MemoryLocation::CpuToGpu,
            Memory::Readback => MemoryLocation::GpuToCpu,
        }
    }
}

/// A buffer with its memory; freed when it drops, so not before the device is done with it.
pub struct Buffer {
    device: Device,
    name: String,
    handle: vk::Buffer,
    allocation: Option<Allocation>,
    address: vk::DeviceAddress,
    size: u64,
}

impl Buffer {
    /// `size` bytes with undefined content. Copies to and from it and its device address are always allowed.
    pub fn new(
        device: &Device,
        name: &str,
        size: u64,
        usage: vk::BufferUsageFlags,
        memory: Memory,
    ) -> Result<Buffer> {
        let limit = device.limits().max_storage_buffer;
        if usage.contains(vk::BufferUsageFlags::STORAGE_BUFFER) && size > limit {
            let device = &device.info().name;
            return Err(Error::Unsupported(format!(
                "buffer '{name}' needs {size} bytes, but {device} can bind only {limit}; use a smaller --size or scene"
            )));
        }
        Buffer::unbounded(device, name, size, usage, memory)
    }

    /// As `new`, for a buffer that no descriptor shows to shaders: it may be larger than a binding.
    pub(super) fn unbounded(
        device: &Device,
        name: &str,
        size: u64,
        usage: vk::BufferUsageFlags,
        memory: Memory,
    ) -> Result<Buffer> {
        let usage = usage
            | vk::BufferUsageFlags::TRANSFER_SRC
            | vk::BufferUsageFlags::TRANSFER_DST
            | vk::BufferUsageFlags::SHADER_DEVICE_ADDRESS;
        let info = vk::BufferCreateInfo::default().size(size.max(MIN_SIZE)).usage(usage);
        // SAFETY: a valid create info; the handle is destroyed by `drop`.
        let handle = unsafe { device.create_buffer(&info, None) }
            .map_err(|e| creation_error(e, &format!("buffer '{name}'"), size, memory.location()))?;
        let mut buffer =
            Buffer { device: device.clone(), name: name.into(), handle, allocation: None, address: 0, size };
        buffer.bind_memory(memory)?;
        device.set_name(handle, name);
        Ok(buffer)
    }

    fn bind_memory(&mut self, memory: Memory) -> Result<()> {
        let device = &self.device;
        // SAFETY: the buffer is alive.
        let requirements = unsafe { device.get_buffer_memory_requirements(self.handle) };
        let allocation = device.allocate(&self.name, requirements, memory.location(), true)?;
        // SAFETY: a fresh allocation for this buffer's requirements, in memory made for device addresses.
        unsafe {
            device
                .bind_buffer_memory(self.handle, allocation.memory(), allocation.offset())
                .check(format_args!("bind memory to buffer '{}'", self.name))?;
            let info = vk::BufferDeviceAddressInfo::default().buffer(self.handle);
            self.address = device.get_buffer_device_address(&info);
        }
        self.allocation = Some(allocation);
        Ok(())
    }

    /// A device buffer with a copy of `data`; waits for the upload. (`Uploader` does many at once.)
    /// An empty slice gives 16 zero bytes.
    pub fn from_slice<T: Pod>(
        device: &Device,
        name: &str,
        data: &[T],
        usage: vk::BufferUsageFlags,
    ) -> Result<Buffer> {
        let mut uploader = Uploader::with_capacity(device, size_of_val(data) as u64);
        let buffer = uploader.buffer(name, data, usage)?;
        uploader.finish()?;
        Ok(buffer)
    }

    /// To record with.
    pub fn handle(&self) -> vk::Buffer {
        self.handle
    }

    /// As debuggers show it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Bytes asked for.
    pub fn size(&self) -> u64 {
        self.size
    }

    /// For acceleration structures and binding tables.
    pub fn address(&self) -> vk::DeviceAddress {
        self.address
    }

    /// All of the buffer, for a descriptor.
    pub fn descriptor(&self) -> vk::DescriptorBufferInfo {
        vk::DescriptorBufferInfo::default().buffer(self.handle).range(vk::WHOLE_SIZE)
    }

    /// Writes into an `Upload` buffer, `offset` bytes from its start. The device must not be reading there.
    pub fn write<T: Pod>(&mut self, offset: u64, data: &[T]) -> Result<()> {
        let (bytes, start) = (bytemuck::cast_slice::<T, u8>(data), offset as usize);
        let mapped = self.allocation.as_mut().and_then(Allocation::mapped_slice_mut);
        let target = mapped.and_then(|m| m.get_mut(start..start + bytes.len()));
        match target {
            Some(target) => target.copy_from_slice(bytes),
            None => return Err(self.out_of_range("write", offset, bytes.len())),
        }
        Ok(())
    }

    /// The whole content, as far as it makes whole `T`s. Waits: not for use within a frame.
    pub fn read_vec<T: Pod>(&self) -> Result<Vec<T>> {
        let count = self.size as usize / size_of::<T>().max(1);
        if count == 0 {
            return Ok(Vec::new());
        }
        if self.mapped().is_none() {
            let name = format!("readback of {}", self.name);
            let usage = vk::BufferUsageFlags::empty();
            let staging = Buffer::new(&self.device, &name, self.size, usage, Memory::Readback)?;
            self.device.submit_once(&name, |cmd| {
                self.record_copy(cmd, &staging);
                Ok(())
            })?;
            return staging.read_vec();
        }
        let bytes = count * size_of::<T>();
        let mapped = self.mapped().and_then(|m| m.get(..bytes));
        let mapped = mapped.ok_or_else(|| self.out_of_range("read", 0, bytes))?;
        Ok(bytemuck::pod_collect_to_vec(mapped))
    }

    /// Records a copy of all of it to the start of `target`, after what earlier commands wrote; the host or later
    /// commands may read `target` then.
    pub fn record_copy(&self, cmd: vk::CommandBuffer, target: &Buffer) {
        let size = self.size.min(target.size);
        if size == 0 {
            return;
        }
        use vk::{AccessFlags as Access, PipelineStageFlags as Stage};
        let before = (Stage::ALL_COMMANDS, Access::MEMORY_WRITE);
        memory_barrier(
            &self.device,
            cmd,
            before,
            (Stage::TRANSFER, Access::TRANSFER_READ | Access::TRANSFER_WRITE),
        );
        let region = vk::BufferCopy::default().size(size);
        // SAFETY: `cmd` is recording; both buffers hold `size` bytes and allow copies.
        unsafe { self.device.cmd_copy_buffer(cmd, self.handle, target.handle, &[region]) };
        let after = (
            Stage::ALL_COMMANDS | Stage::HOST,
            Access::MEMORY_READ | Access::MEMORY_WRITE | Access::HOST_READ,
        );
        memory_barrier(&self.device, cmd, (Stage::TRANSFER, Access::TRANSFER_WRITE), after);
    }

    /// Records a copy of `size` bytes at `from` to `to` in `target`; both ranges must exist. The caller orders it among
    /// other commands.
    pub fn record_copy_range(
        &self,
        cmd: vk::CommandBuffer,
        from: u64,
        target: &Buffer,
        to: u64,
        size: u64,
    ) -> Result<()> {
        if from + size > self.size.max(MIN_SIZE) || to + size > target.size.max(MIN_SIZE) {
            return Err(self.out_of_range("copy", from, size as usize));
        }
        let region = vk::BufferCopy::default().src_offset(from).dst_offset(to).size(size);
        // SAFETY: `cmd` is recording; the ranges lie inside buffers that allow copies.
        unsafe { self.device.cmd_copy_buffer(cmd, self.handle, target.handle, &[region]) };
        Ok(())
    }

    fn mapped(&self) -> Option<&[u8]> {
        self.allocation.as_ref().and_then(Allocation::mapped_slice)
    }

    fn out_of_range(&self, action: &str, offset: u64, bytes: usize) -> Error {
        let Buffer { name, size, .. } = self;
        Error::Internal(format!(
            "can't {action} {bytes} bytes at {offset} of buffer '{name}' ({size} bytes, mapped: {})",
            self.mapped().is_some()
        ))
    }
}

impl Drop for Buffer {
    fn drop(&mut self) {
        // SAFETY: the owner keeps a buffer until the device is done with it.
        unsafe { self.device.destroy_buffer(self.handle, None) };
        if let Some(allocation) = self.allocation.take() {
            self.device.free(allocation);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::with_device;
    use super::*;

    const STORAGE: vk::BufferUsageFlags = vk::BufferUsageFlags::STORAGE_BUFFER;

    #[test]
    fn content_comes_back() {
        with_device(|device| {
            let data: Vec<u32> = (0..100_003).map(|i: u32| i.wrapping_mul(2_654_435_761)).collect();
            let buffer = Buffer::from_slice(device, "numbers", &data, STORAGE).unwrap();
            assert!(buffer.address() != 0 && device.memory_used() >= buffer.size());
            assert_eq!(buffer.read_vec::<u32>().unwrap(), data);
            let bytes: Vec<u8> = vec![7; 13];
            let odd = Buffer::from_slice(device, "odd size", &bytes, STORAGE).unwrap();
            assert_eq!(odd.read_vec::<u8>().unwrap(), bytes);
        });
    }

    #[test]
    fn empty_slices_can_be_bound() {
        with_device(|device| {
            let buffer = Buffer::from_slice::<u32>(device, "empty", &[], STORAGE).unwrap();
            assert_eq!((buffer.size(), buffer.read_vec::<u32>().unwrap()), (0, vec![]));
        });
    }

    #[test]
    fn the_host_writes_only_where_it_may() {
        with_device(|device| {
            let mut buffer = Buffer::new(device, "constants", 64, STORAGE, Memory::Upload).unwrap();
            buffer.write(0, &[1u32; 16]).unwrap();
            buffer.write(8, &[5u32, 6]).unwrap();
            assert_eq!(buffer.read_vec::<u32>().unwrap()[..5], [1, 1, 5, 6, 1]);
            assert!(buffer.write(60, &[0u64]).unwrap_err().to_string().contains("constants"));
            let mut remote = Buffer::new(device, "remote", 64, STORAGE, Memory::Device).unwrap();
            assert_eq!(remote.write(0, &[0u32]).is_err(), remote.mapped().is_none());
        });
    }

    #[test]
    fn a_buffer_too_large_to_bind_is_refused() {
        with_device(|device| {
            let size = device.limits().max_storage_buffer + 1;
            let Err(error) = Buffer::new(device, "reservoirs", size, STORAGE, Memory::Device) else {
                panic!("larger than a binding");
            };
            assert!(error.to_string().contains("reservoirs"), "{error}");
        });
    }
}
