//! A top-level structure that changes from frame to frame, and a second one with its previous state.
//!
//! It is rebuilt, not refitted: a build over instances takes little more time and traces as fast as the first one.

use super::acceleration::{BlasSet, Build, Tlas, TlasInstance, record_builds, scratch};
use super::buffer::{Buffer, Memory};
use super::device::Device;
use crate::error::Result;
use crate::vulkan::acceleration::BUILD_INPUT;
use ash::vk;

/// What rebuilding a [`Tlas`] takes. Two frames may be in flight: each has its own copy of the records.
pub struct TlasUpdate {
    past: Tlas,
    records: [Buffer; 2],
    next: usize,
    count: u32,
    _scratch: Buffer,
    scratch: vk::DeviceAddress,
}

impl TlasUpdate {
    /// For a structure over `count` instances.
    pub fn new(device: &Device, count: usize) -> Result<TlasUpdate> {
        let bytes = 64 * count as u64;
        let records = |name| Buffer::new(device, name, bytes, BUILD_INPUT, Memory::Upload);
        let records = [records("instances of the TLAS, 0")?, records("instances of the TLAS, 1")?];
        let build = Build::of_instances(device, records[0].address(), count as u32);
        let past = Tlas::empty(device, "TLAS of the past", &build)?;
        let (buffer, address) = scratch(device, build.scratch)?;
        Ok(TlasUpdate { past, records, next: 0, count: count as u32, _scratch: buffer, scratch: address })
    }

    /// How the structure was before the last recorded update.
    pub fn past(&self) -> &Tlas {
        &self.past
    }

    /// Device memory, bytes.
    pub fn bytes(&self) -> u64 {
        self.past.bytes() + self.records.iter().map(Buffer::size).sum::<u64>()
    }

    /// Records: `tlas`, over as many instances as announced, becomes the past, and is built anew over `instances`. All
    /// earlier work must be behind a barrier; traces may follow.
    pub fn record(
        &mut self,
        device: &Device,
        cmd: vk::CommandBuffer,
        tlas: &Tlas,
        set: &BlasSet,
        instances: &[TlasInstance],
    ) -> Result<()> {
        let records = instances.iter().map(|i| i.record(set)).collect::<Result<Vec<_>>>()?;
        let buffer = &mut self.records[self.next];
        self.next = 1 - self.next;
        buffer.write(0, &records)?;
        let copy = vk::CopyAccelerationStructureInfoKHR::default()
            .src(tlas.handle())
            .dst(self.past.handle())
            .mode(vk::CopyAccelerationStructureModeKHR::CLONE);
        // SAFETY: `cmd` is recording; both structures were made for the same count of instances.
        unsafe { device.acceleration().cmd_copy_acceleration_structure(cmd, &copy) };
        super::full_barrier(device, cmd);
        let build = Build::of_instances(device, buffer.address(), self.count);
        record_builds(device, cmd, &[&build], &[&tlas.structure], self.scratch);
        Ok(())
    }
}
