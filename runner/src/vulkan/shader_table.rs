//! The shader binding table: where a trace finds its shaders.

use super::align_up;
use super::buffer::{Buffer, Memory};
use super::device::Device;
use super::upload::Uploader;
use crate::error::Result;
use ash::vk;

/// Sizes of a device's shader group handles, bytes; alignments are powers of two.
#[derive(Clone, Copy, Debug)]
pub struct HandleSizes {
    pub size: u64,
    pub alignment: u64,
    /// Of each region's start.
    pub base_alignment: u64,
}

/// Records of one kind: `count` of them, `stride` bytes apart, from byte `offset` of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    pub offset: u64,
    pub stride: u64,
    pub count: u64,
}

impl Region {
    pub fn size(self) -> u64 {
        self.stride * self.count
    }

    /// As a trace takes it; an empty region has no address.
    fn at(self, table: vk::DeviceAddress) -> vk::StridedDeviceAddressRegionKHR {
        if self.count == 0 {
            return vk::StridedDeviceAddressRegionKHR::default();
        }
        vk::StridedDeviceAddressRegionKHR::default()
            .device_address(table + self.offset)
            .stride(self.stride)
            .size(self.size())
    }
}

/// Regions for one ray generation shader, `miss` miss shaders and `hit` hit groups; and the table's size in bytes.
/// The table itself must start at a multiple of the base alignment.
pub fn regions(handles: HandleSizes, miss: u64, hit: u64) -> ([Region; 3], u64) {
    let stride = align_up(handles.size, handles.alignment);
    let mut end = 0;
    let regions = [1, miss, hit].map(|count| {
        let region = Region { offset: align_up(end, handles.base_alignment), stride, count };
        end = region.offset + region.size();
        region
    });
    (regions, end)
}

/// The table of one pipeline, on the device.
pub struct ShaderTable {
    _buffer: Buffer,
    pub raygen: vk::StridedDeviceAddressRegionKHR,
    pub miss: vk::StridedDeviceAddressRegionKHR,
    pub hit: vk::StridedDeviceAddressRegionKHR,
    /// Empty: no shader calls others.
    pub callable: vk::StridedDeviceAddressRegionKHR,
}

impl ShaderTable {
    /// `handles`: the pipeline's group handles (ray generation, misses, hit groups), tightly packed.
    pub fn new(device: &Device, name: &str, handles: &[u8], miss: usize) -> Result<ShaderTable> {
        let limits = device.limits();
        let sizes = HandleSizes {
            size: limits.handle_size.into(),
            alignment: limits.handle_alignment.into(),
            base_alignment: limits.table_alignment.into(),
        };
        let groups = handles.len() / sizes.size as usize;
        let ([raygen, misses, hits], bytes) =
            regions(sizes, miss as u64, groups.saturating_sub(1 + miss) as u64);
        let mut table = vec![0u8; bytes as usize];
        let mut handles = handles.chunks_exact(sizes.size as usize);
        for region in [raygen, misses, hits] {
            for (record, handle) in (0..region.count).zip(&mut handles) {
                let start = (region.offset + record * region.stride) as usize;
                table[start..start + handle.len()].copy_from_slice(handle);
            }
        }
        let usage = vk::BufferUsageFlags::SHADER_BINDING_TABLE_KHR;
        let size = bytes + sizes.base_alignment;
        let buffer = Buffer::new(device, &format!("shader table of {name}"), size, usage, Memory::Device)?;
        let start = align_up(buffer.address(), sizes.base_alignment);
        let mut uploader = Uploader::with_capacity(device, bytes);
        uploader.write(&buffer, start - buffer.address(), &table)?;
        uploader.finish()?;
        let callable = Default::default();
        let [raygen, miss, hit] = [raygen, misses, hits].map(|region| region.at(start));
        Ok(ShaderTable { _buffer: buffer, raygen, miss, hit, callable })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(handles: HandleSizes, miss: u64, hit: u64) -> ([Region; 3], u64) {
        let (regions, size) = regions(handles, miss, hit);
        let mut end = 0;
        for (region, count) in regions.iter().zip([1, miss, hit]) {
            assert_eq!(region.count, count);
            assert!(region.offset >= end, "regions overlap: {regions:?}");
            assert_eq!(region.offset % handles.base_alignment, 0);
            assert_eq!(region.stride % handles.alignment, 0);
            assert!(region.stride >= handles.size && region.stride < handles.size + handles.alignment);
            end = region.offset + region.size();
        }
        assert_eq!(size, end);
        (regions, size)
    }

    /// Sizes of real drivers and odd ones, against the rules of VkStridedDeviceAddressRegionKHR.
    #[test]
    fn regions_keep_vulkans_rules() {
        for (size, alignment, base_alignment) in [
            (32, 32, 64),
            (32, 16, 32),
            (32, 64, 64),
            (32, 32, 32),
            (16, 16, 16),
            (40, 32, 64),
            (64, 64, 128),
        ] {
            let handles = HandleSizes { size, alignment, base_alignment };
            for miss in 0..5 {
                for hit in 0..5 {
                    check(handles, miss, hit);
                }
            }
        }
    }

    #[test]
    fn regions_of_two_known_devices() {
        let nvidia = HandleSizes { size: 32, alignment: 32, base_alignment: 64 };
        let (r, size) = check(nvidia, 2, 3);
        assert_eq!((r[0].offset, r[1].offset, r[2].offset, size), (0, 64, 128, 224));
        let odd = HandleSizes { size: 40, alignment: 32, base_alignment: 64 };
        let (r, size) = check(odd, 1, 1);
        assert_eq!((r[0].stride, r[1].offset, r[2].offset, size), (64, 64, 128, 192));
    }

    #[test]
    fn an_empty_region_has_no_address() {
        let ([_, miss, _], _) = regions(HandleSizes { size: 32, alignment: 32, base_alignment: 64 }, 0, 1);
        let region = miss.at(4096);
        assert_eq!((region.device_address, region.size), (0, 0));
    }
}
