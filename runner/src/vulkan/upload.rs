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
    pub fn with_capacity(device: &Device, bytes: u64) -> Uploader {
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
            return Err(Error::Internal(format!(
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
        let staging = self.staging.as_mut().ok_or_else(|| Error::Internal("no staging buffer".into()))?;
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

#[cfg(test)]
mod tests {
    use super::super::testing::with_device;
    use super::*;

    /// Texels of a mip level.
    fn read_level(device: &Device, image: &Image, level: u32) -> Vec<u8> {
        use vk::ImageLayout as Layout;
        let (width, height) = ((image.size().0 >> level).max(1), (image.size().1 >> level).max(1));
        let bytes = u64::from(width * height * 4);
        let usage = vk::BufferUsageFlags::empty();
        let target = Buffer::new(device, "level", bytes, usage, Memory::Readback).unwrap();
        let subresource = vk::ImageSubresourceLayers::default()
            .aspect_mask(vk::ImageAspectFlags::COLOR)
            .mip_level(level)
            .layer_count(1);
        let region = vk::BufferImageCopy::default()
            .image_subresource(subresource)
            .image_extent(vk::Extent3D { width, height, depth: 1 });
        let (sampled, source) = (Layout::SHADER_READ_ONLY_OPTIMAL, Layout::TRANSFER_SRC_OPTIMAL);
        let copied = device.submit_once("read level", |cmd| {
            image.transition(cmd, sampled, source);
            // SAFETY: the level and the buffer have this size, and the image this layout.
            unsafe {
                device.cmd_copy_image_to_buffer(cmd, image.handle(), source, target.handle(), &[region])
            };
            image.transition(cmd, source, sampled);
            Ok(())
        });
        copied.unwrap();
        target.read_vec().unwrap()
    }

    /// Pieces larger and smaller than the staging memory, in one uploader.
    #[test]
    fn pieces_of_any_size_arrive() {
        with_device(|device| {
            let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
            let long: Vec<u16> = (0..1001).collect();
            let texels: Vec<u8> = (0..40 * 6 * 4).map(|i| (i % 251) as u8).collect();
            let mut uploader = Uploader::with_capacity(device, 64);
            let short = uploader.buffer("short", &[1u8, 2, 3], usage).unwrap();
            let long_buffer = uploader.buffer("long", &long, usage).unwrap();
            let image = uploader.texture("wide", 40, 6, false, &texels).unwrap();
            uploader.write(&long_buffer, 4, &[9u16]).unwrap();
            uploader.finish().unwrap();
            assert_eq!(short.read_vec::<u8>().unwrap(), [1, 2, 3]);
            let back = long_buffer.read_vec::<u16>().unwrap();
            assert_eq!((&back[..2], back[2], &back[3..]), (&long[..2], 9, &long[3..]));
            assert_eq!((read_level(device, &image, 0), image.levels()), (texels, 6));
        });
    }

    /// A checkerboard's mean is grey, in the space in which light adds: 188 in sRGB, 128 in linear texels.
    #[test]
    fn mips_average_light() {
        with_device(|device| {
            let checker =
                |i: usize| if (i % 8 + i / 8).is_multiple_of(2) { [255; 4] } else { [0, 0, 0, 255] };
            let texels: Vec<u8> = (0..64).flat_map(checker).collect();
            for (srgb, grey) in [(true, 188), (false, 128)] {
                let mut uploader = Uploader::new(device);
                let image = uploader.texture("checker", 8, 8, srgb, &texels).unwrap();
                uploader.finish().unwrap();
                for level in 1..4 {
                    for texel in read_level(device, &image, level).chunks(4) {
                        assert!(texel[0].abs_diff(grey) <= 2 && texel[3] == 255, "level {level}: {texel:?}");
                    }
                }
            }
        });
    }

    #[test]
    fn a_texture_of_the_wrong_size_is_refused() {
        with_device(|device| {
            let Err(error) = Uploader::new(device).texture("bricks", 2, 2, true, &[0; 15]) else {
                panic!("15 bytes are no 2 x 2 RGBA8");
            };
            assert!(error.to_string().contains("bricks"), "{error}");
        });
    }

    #[test]
    fn an_unfinished_upload_is_forgotten() {
        with_device(|device| {
            let mut uploader = Uploader::new(device);
            let buffer = uploader.buffer("lost", &[1u32; 4], vk::BufferUsageFlags::STORAGE_BUFFER).unwrap();
            drop(uploader);
            drop(buffer);
        });
    }
}
