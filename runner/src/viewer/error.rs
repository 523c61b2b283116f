//! The error of what is on screen, read back with the frames.

use crate::error::Result;
use crate::frame::history::History;
use crate::frame::pass::BufferId;
use crate::vulkan::{Buffer, Device, Memory, memory_barrier};
use ash::vk;
use shared::statistics::BlockSums;

/// Sums in flight.
#[derive(Default)]
pub struct ErrorSlot {
    buffer: Option<Buffer>,
    taken: bool,
}

impl ErrorSlot {
    /// Copies the sums that were recorded just before, if there are any.
    pub fn record(
        &mut self,
        device: &Device,
        cmd: vk::CommandBuffer,
        history: &History,
        there: bool,
    ) -> Result<()> {
        self.taken = there;
        if !there {
            self.buffer = None;
            return Ok(());
        }
        let sums = history.target(BufferId::Statistics);
        let bytes = sums.size();
        let target = match self.buffer.take().filter(|buffer| buffer.size() == bytes) {
            Some(buffer) => buffer,
            None => Buffer::new(device, "error", bytes, vk::BufferUsageFlags::empty(), Memory::Readback)?,
        };
        sums.record_copy_range(cmd, 0, &target, 0, bytes)?;
        self.buffer = Some(target);
        use vk::{AccessFlags as Access, PipelineStageFlags as Stage};
        let host = (Stage::HOST, Access::HOST_READ);
        memory_barrier(device, cmd, (Stage::TRANSFER, Access::TRANSFER_WRITE), host);
        Ok(())
    }

    /// Root mean square difference of the luminances over the reference's mean luminance, once the frame is done.
    pub fn read(&self) -> Result<Option<f64>> {
        let Some(buffer) = self.buffer.as_ref().filter(|_| self.taken) else { return Ok(None) };
        Ok(relative_rmse(&buffer.read_vec()?))
    }
}

fn relative_rmse(blocks: &[BlockSums]) -> Option<f64> {
    let sum = |part: fn(&BlockSums) -> f32| blocks.iter().map(|b| f64::from(part(b))).sum::<f64>();
    let (pixels, mean) = (sum(|b| b.pixels), sum(|b| b.reference));
    let rmse = (sum(|b| b.squared_difference) / pixels).sqrt();
    let relative = rmse / (mean / pixels);
    relative.is_finite().then_some(relative)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_is_relative_to_the_mean_reference() {
        let block =
            |pixels, squared_difference, reference| BlockSums { pixels, squared_difference, reference };
        // Four pixels off by 1 where the truth is 2 on average.
        let error = relative_rmse(&[block(3.0, 3.0, 7.0), block(1.0, 1.0, 1.0)]);
        assert_eq!(error, Some(0.5));
        assert_eq!(relative_rmse(&[block(4.0, 0.0, 0.0)]), None);
        assert_eq!(relative_rmse(&[]), None);
    }
}
