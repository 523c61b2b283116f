//! The previous state of a scene that changes, on the device. Made at the first change: a scene that stands still has
//! none of it.

use super::arrays::{environment_texels, vertices};
use super::{GpuScene, STORAGE, environment_size, geometries as geometries_of, tlas_instances};
use crate::error::{Error, Result};
use crate::scene::SceneDescription;
use crate::scene::animation::Pose;
use crate::scene::lights::{LightEdits, LightTable, inverse_map, light_maps};
use crate::vulkan::{
    Binding, BlasUpdate, Buffer, DescriptorSet, Device, Memory, SetLayout, TlasUpdate, Uploader, full_barrier,
};
use ash::vk;
use bytemuck::{Pod, Zeroable, cast_slice};
use glam::{Affine3A, Vec3};
use shared::frame::features;
use shared::geometry::{InstanceGeometry, VertexAttributes};
use shared::light::Light;
use shared::light::count::LightCount;
use shared::motion::{InstanceMotion, NO_LIGHT};
use shared::resources::{Binding as Place, Resource, set};
use std::collections::{BTreeMap, BTreeSet};

/// Indices that stay what they are. An empty buffer can't be bound, so the map says it of the first ones.
const SAME: [u32; 4] = [0, 1, 2, 3];

/// The past of a scene on the device (descriptor set 2), and the changes that the next frame will record.
pub struct Past {
    set: DescriptorSet,
    tlas: TlasUpdate,
    /// Of meshes that bend.
    blas: Option<BlasUpdate>,
    /// As in the previous frame.
    lights: Buffer,
    motions: Buffer,
    maps: [Buffer; 2],
    staging: [Option<Buffer>; 2],
    /// The scene's lights as of now.
    table: LightTable,
    /// Object to world of each of the scene's instances, as last drawn.
    drawn: Vec<Affine3A>,
    /// What changed since the last frame.
    now: Changes,
    /// What changed before it: `motions` and `lights` still hold that.
    before: Changes,
    /// How many times changes were recorded.
    version: u64,
}

#[derive(Default)]
struct Changes {
    any: bool,
    instances: BTreeSet<usize>,
    /// Of meshes that have another shape, by their first vertex.
    vertices: BTreeMap<usize, Vertices>,
    /// Indices of their [`super::arrays::Part`]s.
    parts: BTreeSet<usize>,
    /// Ranges that don't overlap: first -> end.
    lights: BTreeMap<usize, usize>,
    alias: bool,
    /// The light buffers were exchanged: previous and current lights have different indices.
    lights_replaced: bool,
}

/// Of a primitive.
struct Vertices {
    positions: Vec<Vec3>,
    attributes: Vec<VertexAttributes>,
}

/// The layout of set 2.
pub fn layout(device: &Device) -> Result<SetLayout> {
    use vk::{DescriptorType as Type, ShaderStageFlags as Stage};
    let stages = Stage::RAYGEN_KHR | Stage::COMPUTE;
    let structure = Type::ACCELERATION_STRUCTURE_KHR;
    let mut bindings = vec![Binding::one(set::STRUCTURE, structure, Stage::RAYGEN_KHR)];
    bindings.extend(Binding::buffers(set::PAST, stages));
    SetLayout::new(device, "past", &bindings)
}

impl GpuScene {
    /// The next frame shows what `pose` moved and bent where `scene`, to which it was applied, has it now. Instances, lights and
    /// materials must be those that the scene was made with, but for [`GpuScene::replace_lights`].
    pub fn update(&mut self, device: &Device, scene: &SceneDescription, pose: &Pose) -> Result<()> {
        self.settle(device, scene)?;
        let Some(past) = &mut self.past else { return Ok(()) };
        for (i, _) in pose.instances() {
            past.now.instances.insert(i);
            self.arrays.place(i, scene.instances[i].transform);
        }
        for (mesh, part) in self.arrays.bent_parts(scene, pose) {
            past.now.parts.insert(part);
            for range in &self.arrays.parts[part].ranges {
                let (positions, attributes) = vertices(&scene.meshes[mesh].primitives[range.primitive]);
                let bent = Vertices { positions: positions.to_vec(), attributes };
                past.now.vertices.insert(range.first_vertex as usize, bent);
            }
        }
        let columns = past.table.alias.len();
        let (ranges, alias) = past.table.follow(scene, pose);
        past.now.lights.extend(ranges.into_iter().map(|range| (range.start, range.end)));
        past.now.alias |= alias;
        past.now.any = true;
        // A table that came or went: bindings have fixed sizes.
        if past.table.alias.len() != columns {
            return self.replace_lights(device, scene, &LightEdits::default());
        }
        Ok(())
    }

    /// The next frame has the lights that `scene` has now: some added, removed, or changed in strength. `edits` says which
    /// of the former lights is which.
    pub fn replace_lights(
        &mut self,
        device: &Device,
        scene: &SceneDescription,
        edits: &LightEdits,
    ) -> Result<()> {
        self.settle(device, scene)?;
        let Some(past) = &mut self.past else { return Ok(()) };
        // Buffers go, and descriptors change.
        device.wait_idle()?;
        let table = LightTable::new(scene);
        if table.lights.iter().any(|light| self.features & features::light_kind(light.kind) == 0) {
            let reason = "lights of a new kind: create the scene again with them";
            return Err(Error::Internal(reason.into()));
        }
        let [mut to_current, _] = light_maps(&past.table, &table, edits);
        if past.now.lights_replaced {
            // The second time within a frame: the previous frame's lights stay where they are.
            let first: Vec<u32> = past.maps[0].read_vec()?;
            let then = |&light: &u32| to_current.get(light as usize).copied().unwrap_or(NO_LIGHT);
            to_current = first.iter().map(then).collect();
        }
        self.arrays.set_lights(&table);
        let to_previous = inverse_map(&to_current, table.lights.len());
        let mut upload = Uploader::new(device);
        let maps = [&to_current, &to_previous].map(|map| upload.buffer("light map", map, STORAGE));
        let lights = upload.buffer("lights", &table.lights, STORAGE)?;
        let alias = upload.buffer("alias table", &table.alias, STORAGE)?;
        let instances = upload.buffer("instances", &self.arrays.instances, STORAGE)?;
        // Texels know their lights.
        let environment = upload.buffer("environment map", &environment_texels(scene), STORAGE)?;
        upload.finish()?;
        let [first, second] = maps;
        past.maps = [first?, second?];
        past.table = table;
        let former = self.buffers.insert(Resource::lights, lights);
        if let (false, Some(former)) = (past.now.lights_replaced, former) {
            past.lights = former;
        }
        self.buffers.insert(Resource::alias, alias);
        self.buffers.insert(Resource::instances, instances);
        self.buffers.insert(Resource::environment, environment);
        self.lights = LightCount::of(&past.table.lights);
        self.environment_size = environment_size(scene);
        self.first_environment_light = past.table.first_environment as u32;
        past.now = Changes {
            any: true,
            instances: std::mem::take(&mut past.now.instances),
            vertices: std::mem::take(&mut past.now.vertices),
            parts: std::mem::take(&mut past.now.parts),
            lights_replaced: true,
            ..Changes::default()
        };
        for place in [Place::lights, Place::alias, Place::instances, Place::environment] {
            self.set.bind_storage_buffer(place.number(), &self.buffers[&place.resource()]);
        }
        past.bind_lights();
        self.drop_light_tree(device)
    }

    /// Number of the changes that frames have seen, or the next one will. A frame of one number and the frame of the next are
    /// the present and the past.
    pub fn version(&self) -> u64 {
        self.past.as_ref().map_or(0, |past| past.version + u64::from(past.now.any))
    }

    /// Has anything changed since the last recorded frame?
    pub fn has_changed(&self) -> bool {
        self.past.as_ref().is_some_and(|past| past.now.any)
    }

    /// Set 2: the previous frame's scene; the present one until something changes.
    pub fn past_set(&self) -> &DescriptorSet {
        self.past.as_ref().map_or(&self.present, |past| &past.set)
    }

    /// Device memory that is there for the past alone, bytes; 0 for a scene that never changed.
    pub fn past_bytes(&self) -> u64 {
        self.past.as_ref().map_or(0, Past::bytes)
    }

    /// Records the changes since the last frame; what was current becomes the past. Later commands see both.
    pub fn record_changes(&mut self, device: &Device, cmd: vk::CommandBuffer) -> Result<()> {
        let Some(past) = &mut self.past else { return Ok(()) };
        if !past.now.any {
            return Ok(());
        }
        full_barrier(device, cmd);
        let lights = &self.buffers[&Resource::lights];
        if !past.now.lights_replaced {
            let mut ranges = past.before.lights.clone();
            ranges.extend(&past.now.lights);
            for (first, end) in ranges {
                record_copy::<Light>(device, cmd, (lights, first), (&past.lights, first), end - first);
            }
        }
        full_barrier(device, cmd);
        let mut staged = Staged::default();
        for &i in past.now.instances.union(&past.before.instances) {
            let transform = self.arrays.transforms[i];
            let motion = InstanceMotion::between(past.drawn[i], transform);
            past.drawn[i] = transform;
            let range = self.arrays.geometries_of(i);
            staged.add(
                Target::Motions,
                range.start * size_of::<InstanceMotion>(),
                &vec![motion; range.len()],
            );
            let geometry: &[InstanceGeometry] = &self.arrays.instances[range.clone()];
            staged.add(Target::Instances, range.start * size_of::<InstanceGeometry>(), geometry);
        }
        for (&first, &end) in &past.now.lights {
            staged.add(Target::Lights, first * size_of::<Light>(), &past.table.lights[first..end]);
        }
        if past.now.alias {
            staged.add(Target::Alias, 0, &past.table.alias);
        }
        for (&first, Vertices { positions, attributes }) in &past.now.vertices {
            staged.add(Target::Positions, first * size_of::<Vec3>(), positions);
            staged.add(Target::Attributes, first * size_of::<VertexAttributes>(), attributes);
        }
        let target = |target| match target {
            Target::Positions => &self.buffers[&Resource::positions],
            Target::Attributes => &self.buffers[&Resource::attributes],
            Target::Motions => &past.motions,
            Target::Instances => &self.buffers[&Resource::instances],
            Target::Lights => lights,
            Target::Alias => &self.buffers[&Resource::alias],
        };
        past.staging.swap(0, 1);
        let staging = staged.write(device, past.staging[0].take())?;
        for &(to, offset, from, size) in &staged.copies {
            record_copy::<u8>(device, cmd, (&staging, from), (target(to), offset), size);
        }
        past.staging[0] = Some(staging);
        full_barrier(device, cmd);
        if let Some(blas) = &mut past.blas {
            blas.record(device, cmd, &mut self.blas, &past.now.parts);
        }
        let instances = tlas_instances(&self.arrays);
        past.tlas.record(device, cmd, &self.tlas, &self.blas, &instances)?;
        full_barrier(device, cmd);
        past.before = std::mem::take(&mut past.now);
        past.version += 1;
        Ok(())
    }

    /// Makes the past, if there is none; ends one whose lights had other indices.
    fn settle(&mut self, device: &Device, scene: &SceneDescription) -> Result<()> {
        let Some(past) = &mut self.past else {
            self.past = Some(Past::new(device, self, scene)?);
            return Ok(());
        };
        if past.before.lights_replaced && !past.now.any {
            device.wait_idle()?;
            let lights = &self.buffers[&Resource::lights];
            past.lights = Buffer::new(device, "lights of the past", lights.size(), STORAGE, Memory::Device)?;
            past.maps = same(device)?;
            device.submit_once("copy lights", |cmd| {
                lights.record_copy(cmd, &past.lights);
                Ok(())
            })?;
            past.before.lights_replaced = false;
            past.bind_lights();
        }
        Ok(())
    }
}

impl Past {
    fn new(device: &Device, scene: &GpuScene, description: &SceneDescription) -> Result<Past> {
        let geometries = scene.arrays.instances.len();
        let tlas = TlasUpdate::new(device, scene.arrays.placements.len())?;
        let lights = &scene.buffers[&Resource::lights];
        let past_lights = Buffer::new(device, "lights of the past", lights.size(), STORAGE, Memory::Device)?;
        device.submit_once("copy lights", |cmd| {
            lights.record_copy(cmd, &past_lights);
            Ok(())
        })?;
        let still = vec![InstanceMotion::zeroed(); geometries];
        let bent = scene.arrays.bent_parts(description, &Pose { bent: Some(0.0), ..Pose::default() });
        let mut changing = BTreeMap::new();
        if !bent.is_empty() {
            let buffers = [Resource::positions, Resource::indices].map(|name| &scene.buffers[&name]);
            let all = geometries_of(&scene.arrays, buffers[0], buffers[1]);
            changing.extend(bent.iter().map(|&(_, part)| (part, all[part].clone())));
        }
        let blas = match changing.is_empty() {
            true => None,
            false => Some(BlasUpdate::new(device, &changing)?),
        };
        let set = DescriptorSet::new(device, "past", &layout(device)?, 0)?;
        let past = Past {
            set,
            lights: past_lights,
            motions: Buffer::from_slice(device, "motions", &still, STORAGE)?,
            maps: same(device)?,
            staging: [None, None],
            table: LightTable::new(description),
            drawn: scene.arrays.transforms.clone(),
            tlas,
            blas,
            now: Changes::default(),
            before: Changes::default(),
            version: 0,
        };
        past.set.bind_tlas(set::STRUCTURE, past.tlas.past());
        past.set.bind_storage_buffer(Place::motions.number(), &past.motions);
        past.bind_lights();
        Ok(past)
    }

    fn bind_lights(&self) {
        self.set.bind_storage_buffer(Place::previous_lights.number(), &self.lights);
        self.set.bind_storage_buffer(Place::previous_to_current.number(), &self.maps[0]);
        self.set.bind_storage_buffer(Place::current_to_previous.number(), &self.maps[1]);
    }

    /// Of each geometry, as the last frame with changes left them.
    pub(super) fn motions(&self) -> Result<Vec<InstanceMotion>> {
        self.motions.read_vec()
    }

    fn bytes(&self) -> u64 {
        let staging = self.staging.iter().flatten().map(Buffer::size).sum::<u64>();
        let blas = self.blas.as_ref().map_or(0, BlasUpdate::bytes);
        self.tlas.bytes() + blas + self.lights.size() + self.motions.size() + staging
    }
}

fn same(device: &Device) -> Result<[Buffer; 2]> {
    let map = || Buffer::from_slice(device, "light map", &SAME, STORAGE);
    Ok([map()?, map()?])
}

#[derive(Clone, Copy)]
enum Target {
    Positions,
    Attributes,
    Motions,
    Instances,
    Lights,
    Alias,
}

/// Small pieces for many places, through one buffer.
#[derive(Default)]
struct Staged {
    bytes: Vec<u8>,
    /// (target, offset there, offset in `bytes`, bytes)
    copies: Vec<(Target, usize, usize, usize)>,
}

impl Staged {
    fn add<T: Pod>(&mut self, target: Target, offset: usize, data: &[T]) {
        let data: &[u8] = cast_slice(data);
        if !data.is_empty() {
            self.copies.push((target, offset, self.bytes.len(), data.len()));
            self.bytes.extend(data);
        }
    }

    /// The bytes in `buffer`, or in a larger one.
    fn write(&self, device: &Device, buffer: Option<Buffer>) -> Result<Buffer> {
        let size = self.bytes.len() as u64;
        let mut buffer = match buffer.filter(|buffer| buffer.size() >= size) {
            Some(buffer) => buffer,
            None => {
                let usage = vk::BufferUsageFlags::empty();
                Buffer::new(device, "staging of changes", size.max(16), usage, Memory::Upload)?
            }
        };
        buffer.write(0, &self.bytes)?;
        Ok(buffer)
    }
}

/// Copies `count` elements from a place to another (in elements).
fn record_copy<T>(
    device: &Device,
    cmd: vk::CommandBuffer,
    from: (&Buffer, usize),
    to: (&Buffer, usize),
    count: usize,
) {
    let bytes = |n: usize| (n * size_of::<T>()) as u64;
    let region =
        vk::BufferCopy::default().src_offset(bytes(from.1)).dst_offset(bytes(to.1)).size(bytes(count));
    if count > 0 {
        // SAFETY: `cmd` is recording; both ranges exist, as their owner made the buffers for these elements.
        unsafe { device.cmd_copy_buffer(cmd, from.0.handle(), to.0.handle(), &[region]) };
    }
}
