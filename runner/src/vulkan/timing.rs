//! GPU time of passes, from timestamps between them.

use super::Check;
use super::device::Device;
use crate::error::Result;
use ash::vk;

/// Timestamps of one frame in flight. On a queue that has none, all calls do nothing and `read` gives `None`.
pub struct Timestamps {
    device: Device,
    pool: Option<vk::QueryPool>,
    /// Queries: the frame's start and one a label.
    capacity: u32,
    labels: Vec<&'static str>,
}

impl Timestamps {
    /// For at most `max` labels a frame; more are not measured.
    pub fn new(device: &Device, max: u32) -> Result<Timestamps> {
        let capacity = max + 1;
        let mut pool = None;
        if device.limits().timestamp_bits > 0 {
            let info =
                vk::QueryPoolCreateInfo::default().query_type(vk::QueryType::TIMESTAMP).query_count(capacity);
            // SAFETY: a valid create info; `drop` destroys the pool.
            pool = Some(unsafe { device.create_query_pool(&info, None) }.check("create timestamp queries")?);
        }
        Ok(Timestamps { device: device.clone(), pool, capacity, labels: Vec::new() })
    }

    /// Starts a frame's measurements. The frame that used them before must be done.
    pub fn begin(&mut self, cmd: vk::CommandBuffer) {
        self.labels.clear();
        if let Some(pool) = self.pool {
            // SAFETY: `cmd` is recording outside a render pass, and the queries are not in use.
            unsafe { self.device.cmd_reset_query_pool(cmd, pool, 0, self.capacity) };
            self.stamp(cmd, pool, 0);
        }
    }

    /// All commands since the last stamp are the pass `label`.
    pub fn write(&mut self, cmd: vk::CommandBuffer, label: &'static str) {
        let query = self.labels.len() as u32 + 1;
        if let Some(pool) = self.pool
            && query < self.capacity
        {
            self.stamp(cmd, pool, query);
            self.labels.push(label);
        }
    }

    /// The first label that the device has not got past, without waiting: where it is, or where it was lost.
    pub fn unfinished(&self) -> Option<&'static str> {
        let pool = self.pool?;
        // A value and whether it is there.
        let mut stamps = vec![[0u64; 2]; self.labels.len() + 1];
        let flags = vk::QueryResultFlags::TYPE_64 | vk::QueryResultFlags::WITH_AVAILABILITY;
        // SAFETY: the frame has reset these queries. A lost device may refuse, and then has told nothing.
        let _ = unsafe { self.device.get_query_pool_results(pool, 0, &mut stamps, flags) };
        self.labels.iter().zip(&stamps[1..]).find(|(_, stamp)| stamp[1] == 0).map(|(label, _)| *label)
    }

    fn stamp(&self, cmd: vk::CommandBuffer, pool: vk::QueryPool, query: u32) {
        let stage = vk::PipelineStageFlags::BOTTOM_OF_PIPE;
        // SAFETY: `cmd` is recording, the query exists and was reset.
        unsafe { self.device.cmd_write_timestamp(cmd, stage, pool, query) };
    }

    /// Milliseconds of each label, in order, once the frame is done.
    pub fn read(&self) -> Result<Option<Vec<(&'static str, f64)>>> {
        let Some(pool) = self.pool else { return Ok(None) };
        if self.labels.is_empty() {
            return Ok(Some(Vec::new()));
        }
        let mut ticks = vec![0u64; self.labels.len() + 1];
        let flags = vk::QueryResultFlags::TYPE_64 | vk::QueryResultFlags::WAIT;
        // SAFETY: the frame has written these queries.
        unsafe { self.device.get_query_pool_results(pool, 0, &mut ticks, flags) }.check("read timestamps")?;
        let limits = self.device.limits();
        let milliseconds = |pair: &[u64]| {
            elapsed(pair[0], pair[1], limits.timestamp_bits) * f64::from(limits.timestamp_period) * 1e-6
        };
        Ok(Some(self.labels.iter().copied().zip(ticks.windows(2).map(milliseconds)).collect()))
    }
}

/// Ticks from `start` to `end` of a counter with `bits` valid bits, which may have wrapped once.
fn elapsed(start: u64, end: u64, bits: u32) -> f64 {
    let mask = u64::MAX >> (64 - bits.clamp(1, 64));
    (end.wrapping_sub(start) & mask) as f64
}

impl Drop for Timestamps {
    fn drop(&mut self) {
        if let Some(pool) = self.pool {
            // SAFETY: the owner keeps it until the frame is done.
            unsafe { self.device.destroy_query_pool(pool, None) };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{CommandRing, testing::with_device};
    use super::*;

    #[test]
    fn a_counter_may_wrap() {
        assert_eq!(elapsed(10, 25, 64), 15.0);
        assert_eq!(elapsed(u64::MAX - 4, 5, 64), 10.0);
        // Bits above the valid ones are undefined.
        assert_eq!(elapsed(0xffff_fff0, 0xabc_0000_0010, 32), 32.0);
    }

    /// A frame that stopped after its first pass, as a lost device's does, names the second.
    #[test]
    fn the_pass_that_was_not_finished_is_named() {
        with_device(|device| {
            let mut times = Timestamps::new(device, 2).unwrap();
            device
                .submit_once("half a frame", |cmd| {
                    times.begin(cmd);
                    times.write(cmd, "first");
                    Ok(())
                })
                .unwrap();
            times.labels.push("second");
            assert_eq!(times.unfinished(), times.pool.map(|_| "second"));
        });
    }

    /// Frames in flight, each with its own timestamps.
    #[test]
    fn frames_are_timed() {
        with_device(|device| {
            let mut ring = CommandRing::new(device, 2).unwrap();
            let mut times: Vec<_> = (0..2).map(|_| Timestamps::new(device, 2).unwrap()).collect();
            for _ in 0..5 {
                let frame = ring.begin().unwrap();
                let times = &mut times[frame.slot()];
                times.begin(frame.cmd());
                for label in ["first", "second", "one too many"] {
                    times.write(frame.cmd(), label);
                }
                frame.submit(&[], &[]).unwrap();
            }
            // One that is begun and given up.
            ring.begin().unwrap();
            ring.wait().unwrap();
            for times in &times {
                let Some(read) = times.read().unwrap() else { return };
                assert_eq!(read.iter().map(|(label, _)| *label).collect::<Vec<_>>(), ["first", "second"]);
                assert!(read.iter().all(|(_, ms)| (0.0..60_000.0).contains(ms)), "{read:?}");
                assert_eq!(times.unfinished(), None);
            }
        });
    }
}
