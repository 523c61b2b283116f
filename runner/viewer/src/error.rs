//! The error of the picture on screen, read back with the frames.

use ash::vk;
use candela::error::Result;
use candela::frame::history::History;
use candela::vulkan::{Buffer, Device, Memory, memory_barrier};
use shared::resources::Resource;
use shared::statistics::BlockSums;

/// Sums in flight.
#[derive(Default)]
pub struct ErrorSlot {
    buffer: Option<Buffer>,
    /// Frames in the mean that was compared; 0: a single frame.
    taken: Option<u32>,
}

/// A frame's error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Frames in the mean; 0: a single frame.
    pub count: u32,
    /// Root mean square difference of the luminances over the reference's mean luminance.
    pub error: f64,
}

impl ErrorSlot {
    /// Copies the sums that were recorded just before, of a mean of so many frames, if there are any.
    pub fn record(
        &mut self,
        device: &Device,
        cmd: vk::CommandBuffer,
        history: &History,
        compared: Option<u32>,
    ) -> Result<()> {
        self.taken = compared;
        if compared.is_none() {
            self.buffer = None;
            return Ok(());
        }
        let sums = history.target(Resource::statistics);
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

    /// What came of it, once the frame is done.
    pub fn read(&self) -> Result<Option<Measured>> {
        let (Some(buffer), Some(count)) = (&self.buffer, self.taken) else { return Ok(None) };
        Ok(relative_rmse(&buffer.read_vec()?).map(|error| Measured { count, error }))
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

    /// The window's number is what `candela compare` says of the same two pictures: its RMSE over the reference's mean. Sums
    /// are in f32, a block at a time, so to 1e-5; a reference that is off by 1 % is seen.
    #[test]
    fn it_is_what_compare_says() {
        use candela_lab::measure::metrics::metrics;
        use glam::{UVec2, Vec3};
        use shared::math::luminance;
        use shared::rng::{Rng, Stream};
        use shared::statistics::BLOCK;
        const SIDE: u32 = 100;
        let pixels = |stream| -> Vec<Vec3> {
            let pixel = |i| {
                let bits = Rng::new(UVec2::new(i % SIDE, i / SIDE), 3, 7, stream, 0).next_u32x4();
                Vec3::new(bits.x as f32, bits.y as f32, bits.z as f32) / u32::MAX as f32
            };
            (0..SIDE * SIDE).map(pixel).collect()
        };
        let reference = pixels(Stream::Initial);
        let noise = pixels(Stream::Spatial);
        let picture: Vec<Vec3> = reference.iter().zip(&noise).map(|(a, b)| 40.0 * (a + 0.2 * b)).collect();
        let reference: Vec<Vec3> = reference.iter().map(|c| 40.0 * c).collect();
        let blocks = SIDE.div_ceil(BLOCK);
        let mut sums = vec![BlockSums::default(); (blocks * blocks) as usize];
        for i in 0..SIDE * SIDE {
            let block = (i / SIDE / BLOCK) * blocks + i % SIDE / BLOCK;
            sums[block as usize].add(picture[i as usize], reference[i as usize]);
        }
        let mean = |picture: &[Vec3]| {
            picture.iter().map(|c| f64::from(luminance(*c))).sum::<f64>() / picture.len() as f64
        };
        let said = |reference: &[Vec3]| metrics(&picture, reference).rmse / mean(reference);
        let error = relative_rmse(&sums).unwrap();
        assert!((error / said(&reference) - 1.0).abs() < 1e-5 && error > 0.05, "{error}");
        let off: Vec<Vec3> = reference.iter().map(|c| 1.01 * c).collect();
        assert!((error / said(&off) - 1.0).abs() > 1e-3);
    }
}
