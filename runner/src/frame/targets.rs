//! Buffers of the size of the picture: double-buffered G-buffer, triple-buffered reservoirs, radiance, display.

use super::pass::BufferId;
use crate::error::Result;
use crate::vulkan::{Buffer, Device, DrawTarget, Memory, Uploader};
use ash::vk;
use glam::{UVec2, Vec3};
use shared::light::tile::{TILE_SIZE, TILES, TileEntry};
use shared::reservoir::StoredReservoir;
use shared::statistics::{BLOCK, BlockSums};
use shared::stored_ray::StoredRay;
use shared::surface::GBufferTexel;

/// The targets of one picture size and reservoir count.
pub struct Targets {
    gbuffer: [Buffer; 2],
    reservoirs: [Buffer; 3],
    radiance: Buffer,
    display: Buffer,
    /// Entries and points of the light tiles.
    tiles: [Buffer; 2],
    /// Of the viewer; tiny until they are asked for.
    mean: Buffer,
    statistics: Buffer,
    /// Of the floors, and whether each hit; tiny until they are asked for.
    rays: Buffer,
    hits: Buffer,
    /// Of frames that are rasterized; absent until there is one.
    visibility: Buffer,
    drawn: Option<DrawTarget>,
    size: UVec2,
}

impl Targets {
    /// Undefined content. `reservoirs`: N a pixel; 0 where nothing is resampled.
    pub fn new(device: &Device, size: UVec2, reservoirs: u32) -> Result<Self> {
        let pixels = u64::from(size.x) * u64::from(size.y);
        let make = |name: &str, bytes: usize, per_pixel: u64| {
            storage(device, name, pixels * per_pixel * bytes as u64)
        };
        let gbuffer = |name| make(name, size_of::<GBufferTexel>(), 1);
        let reservoir = |name| make(name, size_of::<StoredReservoir>(), reservoirs.into());
        let tile =
            |name: &str, bytes: usize| storage(device, name, u64::from(TILES * TILE_SIZE) * bytes as u64);
        Ok(Targets {
            mean: storage(device, "mean", 0)?,
            statistics: storage(device, "statistics", 0)?,
            rays: storage(device, "rays", 0)?,
            hits: storage(device, "hits", 0)?,
            gbuffer: [gbuffer("G-buffer 0")?, gbuffer("G-buffer 1")?],
            reservoirs: [reservoir("reservoirs 0")?, reservoir("reservoirs 1")?, reservoir("reservoirs 2")?],
            radiance: make("radiance", size_of::<Vec3>(), 1)?,
            display: make("display", 4, 1)?,
            tiles: [tile("tile entries", size_of::<TileEntry>())?, tile("tile points", 4)?],
            visibility: storage(device, "visibility", 0)?,
            drawn: None,
            size,
        })
    }

    /// Makes room for what the graphics pipeline draws, unless it is there.
    pub fn make_visibility(&mut self, device: &Device) -> Result<()> {
        if self.drawn.is_none() {
            self.visibility = storage(device, "visibility", self.pixels() * size_of::<UVec2>() as u64)?;
            self.drawn = Some(DrawTarget::new(device, self.size)?);
        }
        Ok(())
    }

    /// What the graphics pipeline draws into, once there is room for it.
    pub fn drawn(&self) -> Option<&DrawTarget> {
        self.drawn.as_ref()
    }

    fn pixels(&self) -> u64 {
        u64::from(self.size.x) * u64::from(self.size.y)
    }

    /// Makes room for a mean over frames and for sums over blocks.
    pub fn make_mean(&mut self, device: &Device) -> Result<()> {
        let (size, pixels) = (self.size, self.pixels());
        let blocks = u64::from(size.x.div_ceil(BLOCK)) * u64::from(size.y.div_ceil(BLOCK));
        self.mean = storage(device, "mean", pixels * size_of::<Vec3>() as u64)?;
        self.statistics = storage(device, "statistics", blocks * size_of::<BlockSums>() as u64)?;
        Ok(())
    }

    /// Puts `rays`, one a pixel, where the passes of the floors find them.
    pub fn set_rays(&mut self, device: &Device, rays: &[StoredRay]) -> Result<()> {
        self.hits = storage(device, "hits", 4 * rays.len() as u64)?;
        let mut upload = Uploader::new(device);
        self.rays = upload.buffer("rays", rays, vk::BufferUsageFlags::STORAGE_BUFFER)?;
        upload.finish()
    }

    pub fn has_mean(&self) -> bool {
        self.mean.size() > 0
    }

    pub fn get(&self, id: BufferId) -> &Buffer {
        match id {
            BufferId::GBuffer(i) => &self.gbuffer[i],
            BufferId::Reservoirs(i) => &self.reservoirs[i],
            BufferId::Radiance => &self.radiance,
            BufferId::Display => &self.display,
            BufferId::TileEntries => &self.tiles[0],
            BufferId::TilePoints => &self.tiles[1],
            // Another history's mean stands in for the reference where there is one.
            BufferId::Mean | BufferId::Reference => &self.mean,
            BufferId::Statistics => &self.statistics,
            BufferId::Rays => &self.rays,
            BufferId::Hits => &self.hits,
            BufferId::Visibility => &self.visibility,
        }
    }

    /// Device memory, bytes.
    pub fn bytes(&self) -> u64 {
        let all = self
            .gbuffer
            .iter()
            .chain(&self.reservoirs)
            .chain([&self.radiance, &self.display])
            .chain(&self.tiles)
            .chain([&self.mean, &self.statistics, &self.rays, &self.hits, &self.visibility]);
        let images = self.drawn.as_ref().map_or(0, |_| self.pixels() * DrawTarget::BYTES);
        all.map(Buffer::size).sum::<u64>() + images
    }
}

fn storage(device: &Device, name: &str, bytes: u64) -> Result<Buffer> {
    Buffer::new(device, name, bytes, vk::BufferUsageFlags::STORAGE_BUFFER, Memory::Device)
}
