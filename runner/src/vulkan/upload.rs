//! Many copies to the device in few submissions, through one bounded staging buffer.

use super::align_up;
use super::buffer::{Buffer, Memory};
use super::commands::{Commands, full_barrier};
use super::device::Device;
use super::image::{Image, ImageDesc};
use crate::error::{Error, Result};
use ash::vk;
use bytemuck::Pod;

/// Bytes of staging memory.
const CHUNK: u64 = 64 << 20;
/// Staged pieces start at multiples of this: a texel's size and more.
const ALIGNMENT: u64 = 16;

/// Collects copies; `finish` runs those that have not run yet. Dropped unfinished, it forgets them. Targets must live
/// until `finish` returns.
pub struct Uploader {
    device: Device,
    capacity: u64,
    staging: Option<Buffer>,
    used: u64,
    commands: Option<Commands>,
}

impl Uploader {
    pub fn new(device: &Device) -> Uploader {
        Uploader::with_capacity(device, CHUNK)
    }

    /// For uploads known to be small: staging memory of at most `bytes`.
    pub(super) fn with_capacity(device: &Device, bytes: u64) -> Uploader {
        let capacity = align_up(bytes.clamp(ALIGNMENT, CHUNK), ALIGNMENT);
        Uploader { device: device.clone(), capacity, staging: None, used: 0, commands: None }
    }

    /// A device buffer that will hold `data`; an empty slice gives 16 zero bytes.
    pub fn buffer<T: Pod>(&mut self, name: &str, data: &[T], usage: vk::BufferUsageFlags) -> Result<Buffer> {
        let buffer = Buffer::new(&self.device, name, size_of_val(data) as u64, usage, Memory::Device)?;
        if data.is_empty() {
            self.write(&buffer, 0, &[0u32; 4])?;
        } else {
            self.write(&buffer, 0, data)?;
        }
        Ok(buffer)
    }

    /// Copies `data` to `offset` bytes from the start of `target`, which must have room.
    pub fn write<T: Pod>(&mut self, target: &Buffer, offset: u64, data: &[T]) -> Result<()> {
        let mut rest: &[u8] = bytemuck::cast_slice(data);
        let mut offset = offset;
        while !rest.is_empty() {
            let (bytes, tail) = rest.split_at(rest.len().min(self.room(1)? as usize));
            let (cmd, staging, start) = self.stage(bytes)?;
            let region =
                vk::BufferCopy::default().src_offset(start).dst_offset(offset).size(bytes.len() as u64);
            // SAFETY: `cmd` is recording; the staged bytes and the target's range exist.
            unsafe { self.device.cmd_copy_buffer(cmd, staging, target.handle(), &[region]) };
            offset += bytes.len() as u64;
            rest = tail;
        }
        Ok(())
    }

    /// A sampled image with its full mip chain. `rgba`: 8 bits a channel, rows from the top, `srgb` if so encoded.
    pub fn texture(&mut self, name: &str, width: u32, height: u32, srgb: bool, rgba: &[u8]) -> Result<Image> {
        let row = u64::from(width) * 4;
        if rgba.len() as u64 != row * u64::from(height) || rgba.is_empty() {
            let bytes = rgba.len();
            return Err(Error::Usage(format!(
                "texture '{name}': {bytes} bytes are not {width} x {height} RGBA8"
            )));
        }
        let image = Image::new(&self.device, &ImageDesc::texture(name, width, height, srgb))?;
        let cmd = self.recording()?;
        image.record_upload_begin(cmd);
        let mut y = 0;
        while y < height {
            let rows = (self.room(row)? / row).min(u64::from(height - y));
            let start = u64::from(y) * row;
            let bytes = &rgba[start as usize..(start + rows * row) as usize];
            let (cmd, staging, offset) = self.stage(bytes)?;
            image.record_upload_rows(cmd, staging, offset, y, rows as u32);
            y += rows as u32;
        }
        let cmd = self.recording()?;
        image.record_mips(cmd);
        Ok(image)
    }

    /// Runs what is left and waits for it; everything later sees the uploads.
    pub fn finish(mut self) -> Result<()> {
        self.flush()
    }

    /// Staging bytes that are free, at least `needed` (else it runs what has been staged).
    fn room(&mut self, needed: u64) -> Result<u64> {
        if needed > self.capacity {
            // One row of texels is wider than a small staging buffer.
            self.flush()?;
            (self.capacity, self.staging) = (align_up(needed, ALIGNMENT), None);
        }
        if self.capacity - self.used < needed {
            self.flush()?;
        }
        Ok(self.capacity - self.used)
    }

    /// Copies `bytes`, which fit, to the staging buffer: (commands, staging buffer, offset).
    fn stage(&mut self, bytes: &[u8]) -> Result<(vk::CommandBuffer, vk::Buffer, u64)> {
        let cmd = self.recording()?;
        if self.staging.is_none() {
            let usage = vk::BufferUsageFlags::empty();
            self.staging = Some(Buffer::new(&self.device, "staging", self.capacity, usage, Memory::Upload)?);
        }
        let staging = self.staging.as_mut().ok_or_else(|| Error::Usage("no staging buffer".into()))?;
        let offset = self.used;
        staging.write(offset, bytes)?;
        self.used = align_up(offset + bytes.len() as u64, ALIGNMENT);
        Ok((cmd, staging.handle(), offset))
    }

    fn recording(&mut self) -> Result<vk::CommandBuffer> {
        if let Some(commands) = &self.commands {
            return Ok(commands.cmd);
        }
        let mut commands = Commands::new(&self.device)?;
        commands.begin("upload")?;
        Ok(self.commands.insert(commands).cmd)
    }

    fn flush(&mut self) -> Result<()> {
        self.used = 0;
        let Some(mut commands) = self.commands.take() else { return Ok(()) };
        full_barrier(&self.device, commands.cmd);
        commands.submit("upload", &[], &[])?;
        commands.wait("upload")
    }
}
