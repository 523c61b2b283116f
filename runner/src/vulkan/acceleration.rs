//! Acceleration structures: bottom level, built in batches and compacted, and top level.

use super::buffer::{Buffer, Memory};
use super::compaction::CompactedSizes;
use super::device::Device;
use super::{Check, align_up, memory_barrier};
use crate::error::{Error, Result};
use ash::vk;
use bytemuck::{Pod, Zeroable};

/// Bytes of scratch, and of structures before compaction, that a batch of builds may use (one build may exceed it).
const BATCH: u64 = 128 << 20;
/// Vulkan's alignment of a structure within its buffer.
const STRUCTURE_ALIGNMENT: u64 = 256;

/// Triangles of one material, in buffers on the device made with [`BUILD_INPUT`].
#[derive(Clone, Copy, Debug)]
pub struct BlasGeometry {
    /// Address of the first vertex: `Vec3` (12 bytes).
    pub vertices: vk::DeviceAddress,
    pub vertex_count: u32,
    /// Address of the first index: `u32`, three a triangle, relative to the first vertex.
    pub indices: vk::DeviceAddress,
    pub triangle_count: u32,
    /// No any-hit shader runs.
    pub opaque: bool,
}

/// Usage of buffers that builds read.
pub const BUILD_INPUT: vk::BufferUsageFlags =
    vk::BufferUsageFlags::ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_KHR;

/// One structure; the buffer it lies in is its owner's.
pub(super) struct Structure {
    device: Device,
    pub(super) handle: vk::AccelerationStructureKHR,
}

impl Structure {
    fn new(
        device: &Device,
        name: &str,
        kind: vk::AccelerationStructureTypeKHR,
        buffer: &Buffer,
        offset: u64,
        size: u64,
    ) -> Result<Structure> {
        let info = vk::AccelerationStructureCreateInfoKHR::default()
            .buffer(buffer.handle())
            .offset(offset)
            .size(size)
            .ty(kind);
        // SAFETY: the buffer has this range and the storage usage; `drop` destroys the structure.
        let handle = unsafe { device.acceleration().create_acceleration_structure(&info, None) }
            .check(format_args!("create acceleration structure '{name}'"))?;
        device.set_name(handle, name);
        Ok(Structure { device: device.clone(), handle })
    }

    pub(super) fn address(&self) -> vk::DeviceAddress {
        let info =
            vk::AccelerationStructureDeviceAddressInfoKHR::default().acceleration_structure(self.handle);
        // SAFETY: the structure is alive.
        unsafe { self.device.acceleration().get_acceleration_structure_device_address(&info) }
    }
}

impl Drop for Structure {
    fn drop(&mut self) {
        // SAFETY: the owner keeps it until the device is done with it.
        unsafe { self.device.acceleration().destroy_acceleration_structure(self.handle, None) };
    }
}

fn storage(device: &Device, name: &str, size: u64) -> Result<Buffer> {
    Buffer::new(device, name, size, vk::BufferUsageFlags::ACCELERATION_STRUCTURE_STORAGE_KHR, Memory::Device)
}

/// Scratch memory for builds, and its address aligned as builds need it.
pub(super) fn scratch(device: &Device, size: u64) -> Result<(Buffer, vk::DeviceAddress)> {
    let alignment = u64::from(device.limits().scratch_alignment).max(1);
    let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
    let buffer = Buffer::unbounded(device, "build scratch", size + alignment, usage, Memory::Device)?;
    let address = align_up(buffer.address(), alignment);
    Ok((buffer, address))
}

/// What a build needs of memory, and the geometry that it reads.
pub(super) struct Build {
    geometries: Vec<vk::AccelerationStructureGeometryKHR<'static>>,
    ranges: Vec<vk::AccelerationStructureBuildRangeInfoKHR>,
    kind: vk::AccelerationStructureTypeKHR,
    /// Bytes of the structure and of scratch, each aligned.
    pub(super) size: u64,
    pub(super) scratch: u64,
}

impl Build {
    fn new(
        device: &Device,
        kind: vk::AccelerationStructureTypeKHR,
        geometries: Vec<vk::AccelerationStructureGeometryKHR<'static>>,
        counts: &[u32],
    ) -> Build {
        let ranges = counts
            .iter()
            .map(|&n| vk::AccelerationStructureBuildRangeInfoKHR::default().primitive_count(n))
            .collect();
        let mut build = Build { geometries, ranges, kind, size: 0, scratch: 0 };
        let mut sizes = vk::AccelerationStructureBuildSizesInfoKHR::default();
        // SAFETY: one count a geometry; addresses aren't read here.
        unsafe {
            device.acceleration().get_acceleration_structure_build_sizes(
                vk::AccelerationStructureBuildTypeKHR::DEVICE,
                &build.info(),
                counts,
                &mut sizes,
            );
        }
        build.size = align_up(sizes.acceleration_structure_size, STRUCTURE_ALIGNMENT);
        build.scratch =
            align_up(sizes.build_scratch_size, u64::from(device.limits().scratch_alignment).max(1));
        build
    }

    /// A top-level structure over `count` records at this address.
    pub(super) fn of_instances(device: &Device, records: vk::DeviceAddress, count: u32) -> Build {
        let data = vk::AccelerationStructureGeometryInstancesDataKHR::default()
            .data(vk::DeviceOrHostAddressConstKHR { device_address: records });
        let geometry = vk::AccelerationStructureGeometryKHR::default()
            .geometry_type(vk::GeometryTypeKHR::INSTANCES)
            .geometry(vk::AccelerationStructureGeometryDataKHR { instances: data });
        Build::new(device, vk::AccelerationStructureTypeKHR::TOP_LEVEL, vec![geometry], &[count])
    }

    fn info(&self) -> vk::AccelerationStructureBuildGeometryInfoKHR<'_> {
        use vk::BuildAccelerationStructureFlagsKHR as Flags;
        let compact = match self.kind {
            vk::AccelerationStructureTypeKHR::BOTTOM_LEVEL => Flags::ALLOW_COMPACTION,
            _ => Flags::empty(),
        };
        vk::AccelerationStructureBuildGeometryInfoKHR::default()
            .ty(self.kind)
            .flags(Flags::PREFER_FAST_TRACE | compact)
            .mode(vk::BuildAccelerationStructureModeKHR::BUILD)
            .geometries(&self.geometries)
    }
}

/// Records the builds, side by side; `scratch` holds the sum of what they need. Traces and copies may follow.
pub(super) fn record_builds(
    device: &Device,
    cmd: vk::CommandBuffer,
    builds: &[&Build],
    targets: &[&Structure],
    scratch: vk::DeviceAddress,
) {
    let mut address = scratch;
    let mut infos = Vec::with_capacity(builds.len());
    for (build, target) in builds.iter().zip(targets) {
        let scratch = vk::DeviceOrHostAddressKHR { device_address: address };
        infos.push(build.info().dst_acceleration_structure(target.handle).scratch_data(scratch));
        address += build.scratch;
    }
    let ranges: Vec<_> = builds.iter().map(|build| &build.ranges[..]).collect();
    // SAFETY: `cmd` is recording; targets have the size that was asked for, and scratch regions don't overlap.
    unsafe { device.acceleration().cmd_build_acceleration_structures(cmd, &infos, &ranges) };
    use vk::{AccessFlags as Access, PipelineStageFlags as Stage};
    let build = Stage::ACCELERATION_STRUCTURE_BUILD_KHR;
    let read = Access::ACCELERATION_STRUCTURE_READ_KHR;
    let after = (build | Stage::RAY_TRACING_SHADER_KHR, read);
    memory_barrier(device, cmd, (build, Access::ACCELERATION_STRUCTURE_WRITE_KHR), after);
}

fn refs<T>(list: &[T]) -> Vec<&T> {
    list.iter().collect()
}

/// Compacted bottom-level structures, by index.
pub struct BlasSet {
    structures: Vec<Structure>,
    /// Of those that instances refer to: what changes has others than these ([`super::bottom_level`]).
    pub(super) addresses: Vec<vk::DeviceAddress>,
    storage: Vec<Buffer>,
}

impl BlasSet {
    /// One structure for each list of geometries. Geometry must have reached the device; waits for the builds.
    pub fn build<G: AsRef<[BlasGeometry]>>(device: &Device, meshes: &[G]) -> Result<BlasSet> {
        let mut set = BlasSet { structures: Vec::new(), addresses: Vec::new(), storage: Vec::new() };
        let mut batch = Vec::new();
        let (mut size, mut scratch) = (0, 0);
        for (index, mesh) in meshes.iter().enumerate() {
            let build = blas_build(device, index, mesh.as_ref())?;
            if !batch.is_empty() && (size + build.size > BATCH || scratch + build.scratch > BATCH) {
                set.build_batch(device, &std::mem::take(&mut batch))?;
                (size, scratch) = (0, 0);
            }
            (size, scratch) = (size + build.size, scratch + build.scratch);
            batch.push(build);
        }
        if !batch.is_empty() {
            set.build_batch(device, &batch)?;
        }
        Ok(set)
    }

    pub fn len(&self) -> usize {
        self.structures.len()
    }

    pub fn is_empty(&self) -> bool {
        self.structures.is_empty()
    }

    /// Memory of all structures, bytes.
    pub fn bytes(&self) -> u64 {
        self.storage.iter().map(Buffer::size).sum()
    }

    fn build_batch(&mut self, device: &Device, builds: &[Build]) -> Result<()> {
        let first = self.structures.len();
        let sizes: Vec<u64> = builds.iter().map(|build| build.size).collect();
        let (loose, _loose_storage) = place(device, "BLAS before compaction", first, &sizes)?;
        let (_scratch, scratch) = scratch(device, builds.iter().map(|build| build.scratch).sum())?;
        let handles: Vec<_> = loose.iter().map(|s| s.handle).collect();
        let queries = CompactedSizes::new(device, handles.len() as u32)?;
        device.submit_once("build bottom-level acceleration structures", |cmd| {
            let (builds, targets) = (refs(builds), refs(&loose));
            record_builds(device, cmd, &builds, &targets, scratch);
            queries.record(cmd, &handles);
            Ok(())
        })?;
        let (compact, storage) = place(device, "BLAS", first, &queries.read()?)?;
        device.submit_once("compact acceleration structures", |cmd| {
            for (source, target) in loose.iter().zip(&compact) {
                let copy = vk::CopyAccelerationStructureInfoKHR::default()
                    .src(source.handle)
                    .dst(target.handle)
                    .mode(vk::CopyAccelerationStructureModeKHR::COMPACT);
                // SAFETY: `cmd` is recording; the target has the compacted size that the query gave.
                unsafe { device.acceleration().cmd_copy_acceleration_structure(cmd, &copy) };
            }
            Ok(())
        })?;
        self.addresses.extend(compact.iter().map(Structure::address));
        self.structures.extend(compact);
        self.storage.push(storage);
        Ok(())
    }
}

/// Bottom-level structures of these sizes in one buffer.
pub(super) fn place(
    device: &Device,
    name: &str,
    first: usize,
    sizes: &[u64],
) -> Result<(Vec<Structure>, Buffer)> {
    let total = sizes.iter().map(|&size| align_up(size, STRUCTURE_ALIGNMENT)).sum();
    let buffer = storage(device, name, total)?;
    let kind = vk::AccelerationStructureTypeKHR::BOTTOM_LEVEL;
    let mut offset = 0;
    let mut structures = Vec::with_capacity(sizes.len());
    for (i, &size) in sizes.iter().enumerate() {
        structures.push(Structure::new(
            device,
            &format!("{name} {}", first + i),
            kind,
            &buffer,
            offset,
            size,
        )?);
        offset += align_up(size, STRUCTURE_ALIGNMENT);
    }
    Ok((structures, buffer))
}

pub(super) fn blas_build(device: &Device, index: usize, mesh: &[BlasGeometry]) -> Result<Build> {
    let limits = device.limits();
    let triangles: u64 = mesh.iter().map(|g| u64::from(g.triangle_count)).sum();
    check_limit(device, &format!("geometries of mesh {index}"), mesh.len() as u64, limits.max_geometries)?;
    check_limit(device, &format!("triangles of mesh {index}"), triangles, limits.max_triangles)?;
    let counts: Vec<u32> = mesh.iter().map(|g| g.triangle_count).collect();
    let geometries = mesh.iter().map(triangle_geometry).collect();
    Ok(Build::new(device, vk::AccelerationStructureTypeKHR::BOTTOM_LEVEL, geometries, &counts))
}

fn triangle_geometry(g: &BlasGeometry) -> vk::AccelerationStructureGeometryKHR<'static> {
    let triangles = vk::AccelerationStructureGeometryTrianglesDataKHR::default()
        .vertex_format(vk::Format::R32G32B32_SFLOAT)
        .vertex_data(vk::DeviceOrHostAddressConstKHR { device_address: g.vertices })
        .vertex_stride(12)
        .max_vertex(g.vertex_count.saturating_sub(1))
        .index_type(vk::IndexType::UINT32)
        .index_data(vk::DeviceOrHostAddressConstKHR { device_address: g.indices });
    let flags = match g.opaque {
        true => vk::GeometryFlagsKHR::OPAQUE,
        // Alpha tests must not blend twice: a triangle is offered once.
        false => vk::GeometryFlagsKHR::NO_DUPLICATE_ANY_HIT_INVOCATION,
    };
    vk::AccelerationStructureGeometryKHR::default()
        .geometry_type(vk::GeometryTypeKHR::TRIANGLES)
        .geometry(vk::AccelerationStructureGeometryDataKHR { triangles })
        .flags(flags)
}

fn check_limit(device: &Device, what: &str, count: u64, limit: u64) -> Result<()> {
    if count <= limit {
        return Ok(());
    }
    let device = &device.info().name;
    Err(Error::Unsupported(format!(
        "{what}: {count} are more than the {limit} that {device} can trace; split the scene"
    )))
}

/// A mesh in the world.
#[derive(Clone, Copy, Debug)]
pub struct TlasInstance {
    /// Object to world: the first three rows of the matrix, row by row.
    pub transform: [f32; 12],
    /// What shaders read as the instance's custom index; below 2^24.
    pub custom_index: u32,
    pub mask: u8,
    /// Index in the `BlasSet`.
    pub blas: usize,
    pub flags: vk::GeometryInstanceFlagsKHR,
}

/// `VkAccelerationStructureInstanceKHR`: 64 bytes.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct InstanceRecord {
    transform: [f32; 12],
    index_and_mask: u32,
    table_offset_and_flags: u32,
    blas: u64,
}

impl TlasInstance {
    pub(super) fn record(&self, set: &BlasSet) -> Result<InstanceRecord> {
        if self.custom_index >> 24 != 0 {
            let index = self.custom_index;
            return Err(Error::Unsupported(format!(
                "instance index {index} is not below 2^24 (16777216); split the scene"
            )));
        }
        let Some(&blas) = set.addresses.get(self.blas) else {
            return Err(Error::Internal(format!("an instance wants mesh {} of {}", self.blas, set.len())));
        };
        Ok(InstanceRecord {
            transform: self.transform,
            index_and_mask: self.custom_index | u32::from(self.mask) << 24,
            table_offset_and_flags: self.flags.as_raw() << 24,
            blas,
        })
    }
}

/// A top-level structure. It refers to its `BlasSet`, which must live as long.
pub struct Tlas {
    pub(super) structure: Structure,
    storage: Buffer,
}

impl Tlas {
    /// Waits for the build. No instances give a structure that every ray misses.
    pub fn build(device: &Device, set: &BlasSet, instances: &[TlasInstance]) -> Result<Tlas> {
        check_limit(device, "instances", instances.len() as u64, device.limits().max_instances)?;
        let records = instances.iter().map(|i| i.record(set)).collect::<Result<Vec<_>>>()?;
        let records = Buffer::from_slice(device, "instances of the TLAS", &records, BUILD_INPUT)?;
        let build = Build::of_instances(device, records.address(), instances.len() as u32);
        let Tlas { structure, storage } = Tlas::empty(device, "TLAS", &build)?;
        let (_scratch, scratch) = scratch(device, build.scratch)?;
        device.submit_once("build the top-level acceleration structure", |cmd| {
            record_builds(device, cmd, &[&build], &[&structure], scratch);
            Ok(())
        })?;
        Ok(Tlas { structure, storage })
    }

    /// Room for what `build` makes.
    pub(super) fn empty(device: &Device, name: &str, build: &Build) -> Result<Tlas> {
        let storage = storage(device, name, build.size)?;
        let structure = Structure::new(device, name, build.kind, &storage, 0, build.size)?;
        Ok(Tlas { structure, storage })
    }

    pub fn handle(&self) -> vk::AccelerationStructureKHR {
        self.structure.handle
    }

    pub fn bytes(&self) -> u64 {
        self.storage.size()
    }
}

#[cfg(test)]
#[path = "acceleration_tests.rs"]
mod tests;
