//! Compacted sizes of acceleration structures, queried.

use super::Check;
use super::device::Device;
use crate::error::Result;
use ash::vk;

/// Queries of compacted sizes.
pub(super) struct CompactedSizes {
    device: Device,
    pool: vk::QueryPool,
    count: u32,
}

impl CompactedSizes {
    const KIND: vk::QueryType = vk::QueryType::ACCELERATION_STRUCTURE_COMPACTED_SIZE_KHR;

    pub fn new(device: &Device, count: u32) -> Result<Self> {
        let info = vk::QueryPoolCreateInfo::default().query_type(Self::KIND).query_count(count);
        // SAFETY: a valid create info; `drop` destroys the pool.
        let pool = unsafe { device.create_query_pool(&info, None) }.check("create query pool")?;
        Ok(CompactedSizes { device: device.clone(), pool, count })
    }

    pub fn record(&self, cmd: vk::CommandBuffer, structures: &[vk::AccelerationStructureKHR]) {
        // SAFETY: `cmd` is recording; one query a structure; the builds are ordered before.
        unsafe {
            self.device.cmd_reset_query_pool(cmd, self.pool, 0, self.count);
            let acceleration = self.device.acceleration();
            acceleration.cmd_write_acceleration_structures_properties(
                cmd,
                structures,
                Self::KIND,
                self.pool,
                0,
            );
        }
    }

    pub fn read(&self) -> Result<Vec<u64>> {
        let mut sizes = vec![0u64; self.count as usize];
        let flags = vk::QueryResultFlags::TYPE_64 | vk::QueryResultFlags::WAIT;
        // SAFETY: the queries were written by a submission that is done.
        unsafe { self.device.get_query_pool_results(self.pool, 0, &mut sizes, flags) }
            .check("read compacted sizes")?;
        Ok(sizes)
    }
}

impl Drop for CompactedSizes {
    fn drop(&mut self) {
        // SAFETY: the submission that wrote it is done.
        unsafe { self.device.destroy_query_pool(self.pool, None) };
    }
}
