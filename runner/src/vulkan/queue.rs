//! The queue that everything is submitted to.

use super::Check;
use super::device::Device;
use crate::error::Result;
use ash::vk;
use std::sync::{Mutex, MutexGuard, PoisonError};

pub(super) struct Queue {
    handle: Mutex<vk::Queue>,
    family: u32,
}

impl Queue {
    /// A queue of an application.
    pub fn borrowed(handle: vk::Queue, family: u32) -> Queue {
        Queue { handle: Mutex::new(handle), family }
    }

    pub fn lock(&self) -> MutexGuard<'_, vk::Queue> {
        self.handle.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The one queue that `device` was made with, of this family.
    pub fn new(device: &ash::Device, family: u32) -> Queue {
        // SAFETY: the device was created with one queue of this family.
        let handle = unsafe { device.get_device_queue(family, 0) };
        Queue { handle: Mutex::new(handle), family }
    }
}

impl Device {
    /// Index of the queue's family.
    pub fn queue_family(&self) -> u32 {
        self.submission().family
    }

    /// The queue, locked: Vulkan allows one thread at a time on it.
    pub fn queue(&self) -> MutexGuard<'_, vk::Queue> {
        self.submission().lock()
    }

    /// Waits for all that was submitted to the queue.
    pub fn wait_idle(&self) -> Result<()> {
        let queue = self.queue();
        // SAFETY: the queue is locked.
        unsafe { self.queue_wait_idle(*queue) }.check("wait for the device")
    }
}
