//! Command buffers: one that runs at once, a ring of frames in flight, and barriers.

use super::Check;
use super::device::Device;
use crate::error::Result;
use ash::vk;

/// What a barrier orders: stages and the accesses in them.
pub type Scope = (vk::PipelineStageFlags, vk::AccessFlags);

/// Later commands in `after` see what earlier ones in `before` wrote, in any buffer or image.
pub fn memory_barrier(device: &Device, cmd: vk::CommandBuffer, before: Scope, after: Scope) {
    let barrier = vk::MemoryBarrier::default().src_access_mask(before.1).dst_access_mask(after.1);
    let flags = vk::DependencyFlags::empty();
    // SAFETY: `cmd` is recording.
    unsafe { device.cmd_pipeline_barrier(cmd, before.0, after.0, flags, &[barrier], &[], &[]) };
}

/// All that follows, on the device or the host, sees all that came before.
pub fn full_barrier(device: &Device, cmd: vk::CommandBuffer) {
    use vk::{AccessFlags as Access, PipelineStageFlags as Stage};
    let (read, write) = (Access::MEMORY_READ, Access::MEMORY_WRITE);
    let after = (Stage::ALL_COMMANDS | Stage::HOST, read | write | Access::HOST_READ);
    memory_barrier(device, cmd, (Stage::ALL_COMMANDS, write), after);
}

impl Device {
    /// Records, submits and waits; everything later sees the results. `what` names it in errors ("build BLAS").
    pub fn submit_once<R>(
        &self,
        what: &str,
        record: impl FnOnce(vk::CommandBuffer) -> Result<R>,
    ) -> Result<R> {
        let mut commands = Commands::new(self)?;
        commands.begin(what)?;
        let result = record(commands.cmd)?;
        full_barrier(self, commands.cmd);
        commands.submit(what, &[], &[])?;
        commands.wait(what)?;
        Ok(result)
    }
}

/// One command buffer with its pool and fence.
pub(super) struct Commands {
    device: Device,
    pool: vk::CommandPool,
    pub cmd: vk::CommandBuffer,
    fence: vk::Fence,
    /// Submitted and not yet waited for.
    pending: bool,
}

impl Commands {
    pub fn new(device: &Device) -> Result<Commands> {
        let (pool, cmd, fence) = Default::default();
        let mut commands = Commands { device: device.clone(), pool, cmd, fence, pending: false };
        let info = vk::CommandPoolCreateInfo::default()
            .queue_family_index(device.queue_family())
            .flags(vk::CommandPoolCreateFlags::TRANSIENT);
        // SAFETY: valid create infos; `drop` destroys what has been made.
        unsafe {
            commands.pool = device.create_command_pool(&info, None).check("create command pool")?;
            let info = vk::CommandBufferAllocateInfo::default()
                .command_pool(commands.pool)
                .level(vk::CommandBufferLevel::PRIMARY)
                .command_buffer_count(1);
            let buffers = device.allocate_command_buffers(&info).check("allocate command buffer")?;
            commands.cmd = buffers.first().copied().unwrap_or_default();
            commands.fence =
                device.create_fence(&vk::FenceCreateInfo::default(), None).check("create fence")?;
        }
        Ok(commands)
    }

    /// Waits for the last submission, then starts to record anew.
    pub fn begin(&mut self, what: &str) -> Result<()> {
        self.wait(what)?;
        let info = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: nothing of this pool is pending after the wait.
        unsafe {
            self.device
                .reset_command_pool(self.pool, vk::CommandPoolResetFlags::empty())
                .check("reset command pool")?;
            self.device.begin_command_buffer(self.cmd, &info).check("begin command buffer")
        }
    }

    pub fn submit(
        &mut self,
        what: &str,
        wait: &[(vk::Semaphore, vk::PipelineStageFlags)],
        signal: &[vk::Semaphore],
    ) -> Result<()> {
        let (semaphores, stages): (Vec<_>, Vec<_>) = wait.iter().copied().unzip();
        let buffers = [self.cmd];
        let info = vk::SubmitInfo::default()
            .command_buffers(&buffers)
            .wait_semaphores(&semaphores)
            .wait_dst_stage_mask(&stages)
            .signal_semaphores(signal);
        // SAFETY: the buffer is recording, the fence unsignalled, the queue locked.
        unsafe {
            self.device.end_command_buffer(self.cmd).check(format_args!("record {what}"))?;
            let queue = self.device.queue();
            self.device.queue_submit(*queue, &[info], self.fence).check(what)?;
        }
        self.pending = true;
        Ok(())
    }

    /// Waits for the last submission, if any.
    pub fn wait(&mut self, what: &str) -> Result<()> {
        if self.pending {
            // SAFETY: the fence was given to a submission, and is reset only once it is signalled.
            unsafe {
                self.device.wait_for_fences(&[self.fence], true, u64::MAX).check(what)?;
                self.device.reset_fences(&[self.fence]).check("reset fence")?;
            }
            self.pending = false;
        }
        Ok(())
    }
}

impl Drop for Commands {
    fn drop(&mut self) {
        // A device that is lost has nothing pending, so the objects can go.
        let _ = self.wait("last commands");
        // SAFETY: nothing is pending; null handles are allowed.
        unsafe {
            self.device.destroy_fence(self.fence, None);
            self.device.destroy_command_pool(self.pool, None);
        }
    }
}

/// Command buffers for frames in flight: slot `i` of `frames`, again and again.
pub struct CommandRing {
    slots: Vec<Commands>,
    next: usize,
}

impl CommandRing {
    /// `frames` in flight, at least 1.
    pub fn new(device: &Device, frames: usize) -> Result<CommandRing> {
        let slots = (0..frames.max(1)).map(|_| Commands::new(device)).collect::<Result<_>>()?;
        Ok(CommandRing { slots, next: 0 })
    }

    /// How many frames may be in flight.
    pub fn len(&self) -> usize {
        self.slots.len()
    }

    /// Is there room for none?
    pub fn is_empty(&self) -> bool {
        self.slots.is_empty()
    }

    /// Starts the next frame; waits until the frame that used its slot before is done.
    pub fn begin(&mut self) -> Result<FrameCommands<'_>> {
        let slot = self.next;
        self.next = (slot + 1) % self.slots.len();
        let commands = &mut self.slots[slot];
        commands.begin("frame")?;
        Ok(FrameCommands { slot, commands })
    }

    /// Waits for all frames; errors name the frame as the place.
    pub fn wait(&mut self) -> Result<()> {
        self.slots.iter_mut().try_for_each(|commands| commands.wait("frame"))
    }
}

/// A frame that is being recorded; dropped without `submit`, it is as if it had not begun.
pub struct FrameCommands<'a> {
    slot: usize,
    commands: &'a mut Commands,
}

impl FrameCommands<'_> {
    /// Recording.
    pub fn cmd(&self) -> vk::CommandBuffer {
        self.commands.cmd
    }

    /// Which of the ring's slots: what the host writes for a frame (constants, timestamps) exists once a slot.
    pub fn slot(&self) -> usize {
        self.slot
    }

    /// Submits; `wait` and `signal` are a swapchain's semaphores, or empty.
    pub fn submit(
        self,
        wait: &[(vk::Semaphore, vk::PipelineStageFlags)],
        signal: &[vk::Semaphore],
    ) -> Result<()> {
        self.commands.submit("frame", wait, signal)
    }
}
