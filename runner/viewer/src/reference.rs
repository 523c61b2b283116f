//! The truth beside the frames: a slice of the lights with each frame, and the mean over whole sums.

use ash::vk;
use candela::error::Result;
use candela::frame::history::History;
use candela::frame::recorder::{FrameOptions, Recorder};
use candela::frame::schedule::Work;
use candela::vulkan::{Device, Timestamps};
use glam::UVec2;
use shared::camera::Camera;
use shared::interface::PassConstants;
use shared::passes::Pass;
use shared::view::kind;

/// Another seed than the frames': the same random numbers on both sides would hide an error.
const SEED: u32 = 0x5eed;

pub struct Reference {
    pub history: History,
    /// Lights that the sum has so far.
    lights: u32,
    /// Whole sums in the mean.
    pub count: u32,
}

impl Reference {
    pub fn new(device: &Device, size: UVec2) -> Result<Reference> {
        let mut history = History::new(device, size, 0)?;
        history.make_mean(device)?;
        Ok(Reference { history, lights: 0, count: 0 })
    }

    /// The picture has changed.
    pub fn restart(&mut self) {
        self.history.restart();
        (self.lights, self.count) = (0, 0);
    }

    /// Records the next slice, with what else a frame is made `like`; the display shows the mean, or the growing sum until there is one.
    pub fn record(
        &mut self,
        cmd: vk::CommandBuffer,
        recorder: &mut Recorder,
        camera: Camera,
        like: &FrameOptions,
        budget: u64,
        timestamps: &mut Timestamps,
    ) -> Result<()> {
        let total = recorder.scene().light_count();
        let first = self.lights;
        let count = slice(total - first, self.history.size(), budget);
        let work = Work::ReferenceSlice { first, count };
        let options = FrameOptions { work, seed: SEED, ..*like };
        recorder.record(cmd, &mut self.history, camera, &options, timestamps)?;
        self.lights = first + count;
        let mut looks = Vec::new();
        if self.lights == total {
            (self.lights, self.count) = (0, self.count + 1);
            looks.push((Pass::accumulate, self.constants()));
        }
        let view = if self.count > 0 { kind::MEAN } else { kind::RADIANCE };
        looks.push((Pass::view, PassConstants { view, ..self.constants() }));
        recorder.record_looks(cmd, &self.history, None, &looks, timestamps)
    }

    fn constants(&self) -> PassConstants {
        PassConstants { count: self.count, ..PassConstants::default() }
    }
}

/// Lights of the next slice, of `left` that are left: about `budget` rays, at least one light.
fn slice(left: u32, size: UVec2, budget: u64) -> u32 {
    let pixels = u64::from(size.x) * u64::from(size.y);
    let affordable = (budget / pixels.max(1)).max(1);
    u32::try_from(affordable).unwrap_or(u32::MAX).min(left)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slices_keep_to_their_budget() {
        let size = UVec2::new(1000, 100);
        assert_eq!(slice(500, size, 1_000_000), 10);
        assert_eq!(slice(7, size, 1_000_000), 7);
        assert_eq!(slice(500, size, 5), 1);
        assert_eq!(slice(0, size, 1_000_000), 0);
    }
}
