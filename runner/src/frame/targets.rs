//! Buffers of a frame, allocated when the first pass needs them: copies, lengths and strides are those of the table of
//! resources.

use crate::error::Result;
use crate::vulkan::{Buffer, Device, DrawTarget, Memory, Uploader};
use ash::vk;
use glam::UVec2;
use shared::passes::threads;
use shared::resources::{Extent, Resource};
use shared::stored_ray::StoredRay;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

/// One copy of a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Target {
    pub resource: Resource,
    pub copy: usize,
}

impl From<Resource> for Target {
    /// Of a buffer that is there once.
    fn from(resource: Resource) -> Self {
        Target { resource, copy: 0 }
    }
}

/// The targets of one picture size and reservoir count.
pub struct Targets {
    buffers: BTreeMap<Target, Buffer>,
    /// Stands where a buffer is bound that nobody has asked for: a variant of the pass that does not read it.
    nothing: Buffer,
    drawn: Option<DrawTarget>,
    size: UVec2,
    /// N a pixel.
    reservoirs: u32,
}

impl Targets {
    /// What every frame has, of undefined content. `reservoirs`: N a pixel; 0 where nothing is resampled.
    pub fn new(device: &Device, size: UVec2, reservoirs: u32) -> Result<Self> {
        let nothing = storage(device, "nothing", 0)?;
        let mut targets = Targets { buffers: BTreeMap::new(), nothing, drawn: None, size, reservoirs };
        let always = [Resource::gbuffer, Resource::reservoirs, Resource::radiance, Resource::display];
        let bytes = always.map(|resource| resource.copies() as u64 * targets.bytes_of(resource));
        device.check_room(&format!("a picture of {}x{} pixels", size.x, size.y), bytes.iter().sum())?;
        for resource in always {
            targets.make(device, resource)?;
        }
        Ok(targets)
    }

    /// Makes room for all copies of `resource`, unless it is there. Frames in flight don't notice.
    pub fn make(&mut self, device: &Device, resource: Resource) -> Result<()> {
        let bytes = self.bytes_of(resource);
        for copy in 0..resource.copies() {
            let target = Target { resource, copy };
            if let Entry::Vacant(place) = self.buffers.entry(target) {
                let buffer = storage(device, &format!("{} {copy}", resource.name()), bytes)?;
                if counts(resource) {
                    clear(device, &buffer)?;
                }
                place.insert(buffer);
            }
        }
        if resource == Resource::visibility && self.drawn.is_none() {
            self.drawn = Some(DrawTarget::new(device, self.size)?);
        }
        Ok(())
    }

    /// Of each copy.
    fn bytes_of(&self, resource: Resource) -> u64 {
        self.elements(resource.extent()) * resource.stride() as u64
    }

    fn elements(&self, extent: Extent) -> u64 {
        let threads = threads(extent, self.size);
        let all = u64::from(threads.x) * u64::from(threads.y);
        match extent {
            Extent::Reservoirs => all * u64::from(self.reservoirs),
            Extent::List => 1 + all,
            _ => all,
        }
    }

    /// What the graphics pipeline draws into, once there is room for it.
    pub fn drawn(&self) -> Option<&DrawTarget> {
        self.drawn.as_ref()
    }

    /// Puts `rays`, one a pixel, where the passes of the roofline find them.
    pub fn set_rays(&mut self, device: &Device, rays: &[StoredRay]) -> Result<()> {
        self.make(device, Resource::hits)?;
        let mut upload = Uploader::new(device);
        let rays = upload.buffer("rays", rays, vk::BufferUsageFlags::STORAGE_BUFFER)?;
        self.buffers.insert(Resource::rays.into(), rays);
        upload.finish()
    }

    pub fn has(&self, resource: Resource) -> bool {
        self.buffers.contains_key(&resource.into())
    }

    pub fn get(&self, target: Target) -> &Buffer {
        self.buffers.get(&target).unwrap_or(&self.nothing)
    }

    /// Device memory, bytes.
    pub fn bytes(&self) -> u64 {
        let pixels = u64::from(self.size.x) * u64::from(self.size.y);
        let images = self.drawn.as_ref().map_or(0, |_| pixels * DrawTarget::BYTES);
        self.buffers.values().map(Buffer::size).sum::<u64>() + images
    }
}

/// Do passes count in it from frame to frame?
fn counts(resource: Resource) -> bool {
    resource == Resource::caught
        || matches!(resource.extent(), Extent::Cells | Extent::Lists | Extent::Beliefs)
}

/// Fills `buffer` with zeros, and waits for it.
fn clear(device: &Device, buffer: &Buffer) -> Result<()> {
    device.submit_once("clear", |cmd| {
        // SAFETY: `cmd` is recording, and the buffer is alive until it has run.
        unsafe { device.cmd_fill_buffer(cmd, buffer.handle(), 0, vk::WHOLE_SIZE, 0) };
        Ok(())
    })
}

fn storage(device: &Device, name: &str, bytes: u64) -> Result<Buffer> {
    Buffer::new(device, name, bytes, vk::BufferUsageFlags::STORAGE_BUFFER, Memory::Device)
}
