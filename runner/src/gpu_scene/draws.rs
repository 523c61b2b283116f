//! A scene as the graphics pipeline draws it: a draw for each instance geometry, sorted by what its triangles need.

use super::arrays::SceneArrays;
use crate::error::Result;
use crate::vulkan::{Buffer, Uploader};
use ash::vk;
use shared::frame::features;
use std::ops::Range;

/// Bytes of a draw.
pub const DRAW_BYTES: usize = size_of::<vk::DrawIndirectCommand>();

/// What triangles need of their pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DrawKind {
    /// A shader decides over each pixel.
    pub transparent: bool,
    /// Both sides are seen.
    pub double_sided: bool,
}

/// Those that scenes with these features may have; what hides the most comes first.
pub fn kinds(features: u32) -> impl Iterator<Item = DrawKind> {
    let transparent = if features & features::ALPHA != 0 { &[false, true][..] } else { &[false] };
    let both = |&transparent: &bool| [false, true].map(|double_sided| DrawKind { transparent, double_sided });
    transparent.iter().flat_map(both)
}

/// Indirect draws on the device. They know no place: what moves is drawn where its instance is.
pub struct Draws {
    buffer: Buffer,
    /// Draws of each of the kinds, in order.
    ranges: Vec<Range<u32>>,
}

impl Draws {
    pub(super) fn new(upload: &mut Uploader, arrays: &SceneArrays) -> Result<Draws> {
        let (mut draws, mut ranges) = (Vec::new(), Vec::new());
        for kind in kinds(arrays.features) {
            let first = draws.len() as u32;
            draws.extend(of_kind(arrays, kind));
            ranges.push(first..draws.len() as u32);
        }
        let buffer = upload.buffer("draws", &draws, vk::BufferUsageFlags::INDIRECT_BUFFER)?;
        Ok(Draws { buffer, ranges })
    }

    pub fn buffer(&self) -> &Buffer {
        &self.buffer
    }

    /// Which draws are of each of the scene's [`kinds`], in order.
    pub fn ranges(&self) -> &[Range<u32>] {
        &self.ranges
    }

    pub(super) fn bytes(&self) -> u64 {
        self.buffer.size()
    }
}

/// `vk::DrawIndirectCommand`s: vertex count, instance count, first vertex, first instance. The instance is the geometry.
fn of_kind(arrays: &SceneArrays, kind: DrawKind) -> Vec<[u32; 4]> {
    let mut draws = Vec::new();
    for placement in &arrays.placements {
        let part = &arrays.parts[placement.part];
        for (geometry, range) in (placement.custom_index..).zip(&part.ranges) {
            if part.double_sided == kind.double_sided && range.opaque != kind.transparent {
                draws.push([3 * range.triangle_count, 1, 0, geometry]);
            }
        }
    }
    draws
}
