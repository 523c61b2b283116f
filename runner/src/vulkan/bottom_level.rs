//! Bottom-level structures whose triangles change from frame to frame.
//!
//! They are built anew, not refitted: a refitted structure gets worse with each change of shape, and a build of what bends, a few
//! ten thousand triangles, is a small part of a frame. Each has two copies, so that the past keeps the one that it was traced in.

use super::acceleration::{
    BlasGeometry, BlasSet, Build, Structure, blas_build, place, record_builds, scratch,
};
use super::buffer::Buffer;
use super::device::Device;
use crate::error::Result;
use ash::vk;
use std::collections::{BTreeMap, BTreeSet};

/// What rebuilding some structures of a [`BlasSet`] takes.
pub struct BlasUpdate {
    changing: BTreeMap<usize, Changing>,
    storage: Buffer,
    scratch_buffer: Buffer,
    scratch: vk::DeviceAddress,
}

struct Changing {
    build: Build,
    copies: [Structure; 2],
    /// The one that is built next.
    next: usize,
}

impl BlasUpdate {
    /// For the structures of these indices, whose geometries stay where they are.
    pub fn new(device: &Device, meshes: &BTreeMap<usize, Vec<BlasGeometry>>) -> Result<BlasUpdate> {
        let builds =
            meshes.iter().map(|(&i, mesh)| blas_build(device, i, mesh)).collect::<Result<Vec<_>>>()?;
        let sizes: Vec<u64> = builds.iter().flat_map(|build| [build.size; 2]).collect();
        let (structures, storage) = place(device, "BLAS that changes", 0, &sizes)?;
        let (scratch_buffer, scratch) = scratch(device, builds.iter().map(|build| build.scratch).sum())?;
        let mut structures = structures.into_iter();
        let mut changing = BTreeMap::new();
        for (&index, build) in meshes.keys().zip(builds) {
            if let (Some(first), Some(second)) = (structures.next(), structures.next()) {
                changing.insert(index, Changing { build, copies: [first, second], next: 0 });
            }
        }
        Ok(BlasUpdate { changing, storage, scratch_buffer, scratch })
    }

    /// Device memory, bytes.
    pub fn bytes(&self) -> u64 {
        self.storage.size() + self.scratch_buffer.size()
    }

    /// Records: those of `indices` are built from what their geometries are now, and `set` refers to them. What it referred to before
    /// stays until their next build. All earlier work must be behind a barrier; builds of top-level structures and traces may follow.
    pub fn record(
        &mut self,
        device: &Device,
        cmd: vk::CommandBuffer,
        set: &mut BlasSet,
        indices: &BTreeSet<usize>,
    ) {
        let (mut builds, mut targets) = (Vec::new(), Vec::new());
        for (&index, Changing { build, copies, next }) in
            self.changing.iter_mut().filter(|(index, _)| indices.contains(index))
        {
            let target = &copies[*next];
            *next = 1 - *next;
            set.addresses[index] = target.address();
            builds.push(&*build);
            targets.push(target);
        }
        if !builds.is_empty() {
            record_builds(device, cmd, &builds, &targets, self.scratch);
        }
    }
}
