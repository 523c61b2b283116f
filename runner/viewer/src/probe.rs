//! The state of one pixel, read back with the frames: a frame or two late, without a wait.

use ash::vk;
use bytemuck::{Pod, Zeroable};
use candela::error::Result;
use candela::frame::history::History;
use candela::vulkan::{Buffer, Device, Memory, memory_barrier};
use glam::{UVec2, Vec3};
use shared::camera::Camera;
use shared::reservoir::StoredReservoir;
use shared::resources::Resource;
use shared::surface::{GBufferTexel, Surface};

/// Reservoirs a pixel has at most.
const RESERVOIRS: usize = 4;

/// The content of the readback buffer.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Content {
    texel: GBufferTexel,
    reservoirs: [StoredReservoir; RESERVOIRS],
    radiance: Vec3,
}

/// A pixel of a frame.
#[derive(Clone, Debug)]
pub struct Probe {
    pub pixel: UVec2,
    /// Nothing was hit, or nothing that is lit.
    pub surface: Option<Surface>,
    pub instance: u32,
    pub reservoirs: Vec<StoredReservoir>,
    /// Nit.
    pub radiance: Vec3,
}

impl Probe {
    /// World space, m.
    pub fn position(&self) -> Option<Vec3> {
        self.surface.map(|surface| surface.position)
    }
}

/// A probe in flight.
pub struct ProbeSlot {
    buffer: Buffer,
    taken: Option<Taken>,
}

#[derive(Clone, Copy)]
struct Taken {
    pixel: UVec2,
    size: UVec2,
    camera: Camera,
    reservoirs: usize,
}

impl ProbeSlot {
    pub fn new(device: &Device) -> Result<ProbeSlot> {
        let usage = vk::BufferUsageFlags::empty();
        let bytes = size_of::<Content>() as u64;
        Ok(ProbeSlot { buffer: Buffer::new(device, "probe", bytes, usage, Memory::Readback)?, taken: None })
    }

    /// Copies what `history`'s last frame, just recorded, has at `pixel`.
    pub fn record(
        &mut self,
        device: &Device,
        cmd: vk::CommandBuffer,
        history: &History,
        camera: Camera,
        pixel: Option<UVec2>,
    ) -> Result<()> {
        let size = history.size();
        self.taken = None;
        let Some(pixel) = pixel.filter(|pixel| pixel.cmplt(size).all()) else { return Ok(()) };
        let (index, pixels) = (u64::from(pixel.y * size.x + pixel.x), u64::from(size.x * size.y));
        let copy = |source: &Buffer, at: u64, offset: usize, bytes: usize| {
            source.record_copy_range(cmd, at * bytes as u64, &self.buffer, offset as u64, bytes as u64)
        };
        copy(history.gbuffer(), index, std::mem::offset_of!(Content, texel), size_of::<GBufferTexel>())?;
        let radiance = history.target(Resource::radiance);
        copy(radiance, index, std::mem::offset_of!(Content, radiance), size_of::<Vec3>())?;
        let reservoirs = history.reservoirs() as usize;
        for lane in 0..reservoirs.min(RESERVOIRS) {
            let bytes = size_of::<StoredReservoir>();
            let offset = std::mem::offset_of!(Content, reservoirs) + lane * bytes;
            copy(history.shaded_reservoirs(), lane as u64 * pixels + index, offset, bytes)?;
        }
        use vk::{AccessFlags as Access, PipelineStageFlags as Stage};
        let host = (Stage::HOST, Access::HOST_READ);
        memory_barrier(device, cmd, (Stage::TRANSFER, Access::TRANSFER_WRITE), host);
        self.taken = Some(Taken { pixel, size, camera, reservoirs });
        Ok(())
    }

    /// What was there, once the frame is done.
    pub fn read(&self) -> Result<Option<Probe>> {
        let Some(Taken { pixel, size, camera, reservoirs }) = self.taken else { return Ok(None) };
        let Some(content) = self.buffer.read_vec::<Content>()?.first().copied() else { return Ok(None) };
        let texel = content.texel;
        Ok(Some(Probe {
            pixel,
            surface: (!texel.is_empty()).then(|| texel.unpack(u32::MAX, &camera, pixel, size)),
            instance: texel.instance(),
            reservoirs: content.reservoirs[..reservoirs.min(RESERVOIRS)].to_vec(),
            radiance: content.radiance,
        }))
    }
}
