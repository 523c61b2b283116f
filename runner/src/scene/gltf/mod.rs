//! glTF 2.0 files (.gltf, .glb) -> `SceneDescription`.
//!
//! A file is not trusted: whatever its bytes are, loading ends with a scene or one line that says what is wrong.

mod accessors;
mod animations;
mod compressed;
mod container;
mod dielectric;
mod draco;
mod extensions;
mod file;
mod geometry;
mod images;
mod instancing;
mod ktx2;
mod materials;
mod meshopt;
mod nodes;
mod origin;
mod schema;
mod shape;
mod skins;
mod tangents;
#[cfg(test)]
mod tests;
mod uri;
mod warnings;

use super::animation::{Local, Node, Thing};
use super::deform::Bends;
use super::lights::{self, MAX_LIGHTS};
use super::{Bounds, Instance, Mesh, PlacedLight, Primitive, SceneDescription};
use crate::error::{Error, Result};
use crate::{files, parallel, startup};
use glam::{DAffine3, DVec3, Vec3};
use materials::Materials;
use nodes::Placed;
use std::collections::{HashMap, HashSet};
use std::path::Path;
use warnings::Warnings;

/// m; squares of distances and areas are far from the end of f32.
const MAX_COORDINATE: f32 = 1e15;

/// Most vertices of meshes that bend, each of which is kept twice for every node that shows it.
const MAX_BENT: usize = 1 << 24;

/// A result inside the loader: its error is the reason alone, [`load`] adds the file.
type Reason<T> = std::result::Result<T, String>;

/// Loads the default scene of a .gltf or .glb file. What it has and can't be drawn yet is in the warnings.
/// Errors, one line each: [`Error::Read`] if `path` can't be read, [`Error::Input`] for everything that is wrong in it.
pub fn load(path: &Path) -> Result<SceneDescription> {
    let bytes = files::read(path)?;
    let base = path.parent().unwrap_or(Path::new(""));
    let mut scene = scene_of(&bytes, base).map_err(|reason| Error::input(path)(one_line(&reason)))?;
    scene.name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Ok(scene)
}

fn scene_of(bytes: &[u8], base: &Path) -> Reason<SceneDescription> {
    let mut warnings = Warnings::default();
    let file::Parsed { document, buffers, broken_nodes, quantized } =
        startup::timed("parse", || file::parse(bytes, base, &mut warnings))?;
    let mut nodes = nodes::place(&document, &broken_nodes)?;
    for placed in nodes.iter_mut().filter(|placed| placed.mesh().is_some()) {
        placed.copies = instancing::copies(&document, &placed.node, &buffers)?;
    }
    let worn = nodes.iter().filter_map(Placed::mesh).flat_map(|mesh| mesh.primitives());
    let images = materials::images_of(worn.map(|primitive| primitive.material()));
    let images = startup::timed("images", || images::load(&document, &images, base, &buffers))?;
    let mut loader = Loader {
        source: geometry::Source { document: &document, buffers: &buffers, quantized },
        materials: Materials::new(&document, images),
        read_meshes: HashMap::new(),
        known_meshes: HashMap::new(),
        users: HashMap::new(),
        bent: 0,
        joints: HashMap::new(),
        scene: SceneDescription::default(),
        warnings,
    };
    startup::timed("meshes", || loader.read_meshes(&nodes));
    // The meshes tell where the scene is.
    loader.scene.origin = loader.recenter(&mut nodes)?;
    let origin = loader.scene.origin;
    let motion = animations::read(&document, &nodes, origin, &buffers, &mut loader.warnings);
    loader.scene.animation = motion.animation;
    loader.joints = skins::joints(&nodes, &motion.of_placed);
    for mesh in nodes.iter().filter_map(Placed::mesh) {
        *loader.users.entry(mesh.index()).or_default() += 1;
    }
    for (i, (placed, &moving)) in nodes.iter().zip(&motion.of_placed).enumerate() {
        loader.add(placed, moving, motion.morphs.get(&i).copied())?;
    }
    loader.finish()
}

/// A primitive, none if it has nothing to draw, and what is to be said of it.
type ReadPrimitive = (Reason<Option<Primitive>>, Warnings);

/// A scene that grows node by node.
struct Loader<'b> {
    source: geometry::Source<'b>,
    materials: Materials,
    /// By their index in the document, until they are used.
    read_meshes: HashMap<usize, Vec<ReadPrimitive>>,
    /// Index in the document -> in the scene, for shared meshes, and the point that their positions are relative to in
    /// object space; `None` for those without triangles.
    known_meshes: HashMap<usize, Option<(usize, DVec3)>>,
    /// How many nodes show a mesh of the document.
    users: HashMap<usize, usize>,
    joints: skins::Joints,
    /// Vertices of meshes that bend, so far.
    bent: usize,
    scene: SceneDescription,
    warnings: Warnings,
}

impl Loader<'_> {
    /// Reads the meshes of `nodes`, moves all nodes to the scene's origin, and gives that point in the file's world.
    fn recenter(&mut self, nodes: &mut [Placed]) -> Reason<DVec3> {
        let mut worn = Vec::new();
        for placed in nodes.iter() {
            if let Some(mesh) = placed.mesh().map(|mesh| self.mesh(&mesh)).transpose()?.flatten() {
                worn.extend(placed.copies.iter().map(|&copy| (mesh, placed.mesh_world * copy)));
            }
        }
        let boxes: Vec<Bounds> = self.scene.meshes.iter().map(Mesh::bounds).collect();
        let mut extent = origin::Extent::default();
        for ((mesh, offset), world) in worn {
            boxes[mesh].corners().into_iter().for_each(|p| extent.add(world.transform_point3(offset + p)));
        }
        let origin = extent.origin();
        for placed in nodes.iter_mut() {
            placed.world.translation -= origin;
            placed.mesh_world.translation -= origin;
        }
        Ok(origin)
    }

    /// `moving`: the node of the scene's animation that this one is; `morph`: which of its morphs bends the mesh.
    fn add(&mut self, placed: &Placed, moving: Option<usize>, morph: Option<usize>) -> Reason<()> {
        if let Some(camera) = placed.camera(self.scene.cameras.len(), &mut self.warnings) {
            self.attach(moving, Thing::Camera(self.scene.cameras.len()));
            self.scene.cameras.push(camera);
        }
        if let Some(light) = placed.add_light(&mut self.scene, &mut self.warnings) {
            self.attach(moving, light);
        }
        let panels = self.source.document.extension_value("EXT_lights_area");
        if let Some(light) = placed.add_panel(panels, &mut self.scene, &mut self.warnings) {
            self.attach(moving, light);
        }
        let Some(source) = placed.mesh() else { return Ok(()) };
        let Some((mesh, offset)) = self.mesh(&source)? else { return Ok(()) };
        let mesh = self.bend(placed, &source, mesh, offset, morph)?;
        // A skin's joints move its mesh, wherever its node is (glTF 2.0, 3.7.3.3).
        let moving = moving.filter(|_| placed.node.skin().is_none());
        // What moves may grow later.
        if !placed.has_area() && moving.is_none() {
            self.warnings.add("left out: its scale is 0", &placed.label);
            return Ok(());
        }
        for &copy in &placed.copies {
            let offset = copy * DAffine3::from_translation(offset);
            let transform = (placed.mesh_world * offset).as_affine3a();
            let moving = moving.map(|node| self.child(node, offset));
            let name = placed.node.name().unwrap_or_default().to_owned();
            self.attach(moving, Thing::Instance(self.scene.instances.len()));
            self.scene.instances.push(Instance { name, mesh, transform });
        }
        Ok(())
    }

    /// Notes what bends `mesh` of the scene for the node, and gives the mesh that shows it: itself, or a copy if others show it too.
    /// Error: too many vertices bend.
    fn bend(
        &mut self,
        placed: &Placed,
        source: &gltf::Mesh,
        mesh: usize,
        offset: DVec3,
        morph: Option<usize>,
    ) -> Reason<usize> {
        let copied = self.users.get(&source.index()).is_some_and(|&users| users > 1);
        let place = if copied { self.scene.meshes.len() } else { mesh };
        let rest = &self.scene.meshes[mesh].primitives;
        Ok(match skins::deformed(placed, place, rest, offset, morph, &self.joints, self.source.buffers) {
            Ok(None) if placed.node.skin().is_none() => mesh,
            Ok(None) => {
                self.warnings.add("a skin without joints and weights stays as modelled", &placed.label);
                mesh
            }
            Err(reason) => {
                let label = format!("{}: {reason}", placed.label);
                self.warnings.add("a skin that is broken stays as modelled", &label);
                mesh
            }
            Ok(Some(deformed)) => {
                self.bent += deformed.rest.iter().map(|primitive| primitive.positions.len()).sum::<usize>();
                if self.bent > MAX_BENT {
                    return Err(format!(
                        "its skinned and morphing meshes have more than {MAX_BENT} vertices"
                    ));
                }
                if copied {
                    let copy = self.scene.meshes[mesh].clone();
                    self.scene.meshes.push(copy);
                }
                self.scene.deformed.push(deformed);
                place
            }
        })
    }

    /// Reads the primitives of all meshes of `nodes`, on all processors; what they lack is said when they are used.
    fn read_meshes(&mut self, nodes: &[Placed]) {
        let mut tasks = Vec::new();
        let mut seen = HashSet::new();
        for mesh in nodes.iter().filter_map(Placed::mesh).filter(|m| seen.insert(m.index())) {
            let mesh_label = label("mesh", mesh.index(), mesh.name());
            for primitive in mesh.primitives() {
                let label = format!("{mesh_label}, primitive {}", primitive.index());
                let mut warnings = Warnings::default();
                // Materials get their numbers in this order.
                let wear = self.materials.wear(&primitive.material(), &mut warnings);
                tasks.push((mesh.index(), primitive, label, wear, warnings));
            }
        }
        let source = self.source;
        let read = parallel::map(&tasks, |(_, primitive, label, wear, _)| {
            let mut warnings = Warnings::default();
            let wear = wear.as_ref().map_err(Clone::clone);
            let read = wear.and_then(|wear| {
                geometry::read(primitive, label, wear, source, &mut warnings)
                    .map_err(|reason| format!("{label}: {reason}"))
            });
            (read, warnings)
        });
        for ((mesh, .., mut warnings), (primitive, more)) in tasks.into_iter().zip(read) {
            warnings.append(more);
            self.read_meshes.entry(mesh).or_default().push((primitive, warnings));
        }
    }

    /// The node of the scene's animation that stands at `offset` from `parent`.
    fn child(&mut self, parent: usize, offset: DAffine3) -> usize {
        if offset == DAffine3::IDENTITY {
            return parent;
        }
        let rest = Local::Matrix(offset);
        self.scene.animation.nodes.push(Node { parent: Some(parent), base: DAffine3::IDENTITY, rest });
        self.scene.animation.nodes.len() - 1
    }

    fn attach(&mut self, moving: Option<usize>, thing: Thing) {
        self.scene.animation.attached.extend(moving.map(|node| (thing, node)));
    }

    /// See [`Self::known_meshes`].
    fn mesh(&mut self, source: &gltf::Mesh) -> Reason<Option<(usize, DVec3)>> {
        if let Some(&known) = self.known_meshes.get(&source.index()) {
            return Ok(known);
        }
        let mut primitives = Vec::new();
        for (primitive, warnings) in self.read_meshes.remove(&source.index()).into_iter().flatten() {
            self.warnings.append(warnings);
            primitives.extend(primitive?);
        }
        let mut known = None;
        if !primitives.is_empty() {
            known = Some((self.scene.meshes.len(), origin::recenter(&mut primitives)));
            let name = source.name().unwrap_or_default().to_owned();
            self.scene.meshes.push(Mesh { name, primitives });
        }
        self.known_meshes.insert(source.index(), known);
        Ok(known)
    }

    fn finish(mut self) -> Reason<SceneDescription> {
        if self.scene.instances.is_empty() {
            let hint = self
                .warnings
                .into_lines()
                .into_iter()
                .next()
                .map(|line| format!(" ({line})"))
                .unwrap_or_default();
            return Err(format!("no triangles in its scene{hint}"));
        }
        self.scene.materials = self.materials.materials;
        let primitives = self.scene.meshes.iter_mut().flat_map(|mesh| &mut mesh.primitives);
        primitives.for_each(|primitive| primitive.bends = Bends::default());
        self.scene.bend(None, |_| true);
        let lights = lights::most(&self.scene);
        if lights > MAX_LIGHTS as u64 {
            return Err(format!(
                "{lights} lights (each emissive triangle is one, in each instance); {MAX_LIGHTS} is the most"
            ));
        }
        if !in_range(&self.scene) {
            return Err(format!("its scene reaches beyond {MAX_COORDINATE:e} m; scale it down"));
        }
        self.scene.textures = self.materials.textures;
        self.scene.warnings = self.warnings.into_lines();
        Ok(self.scene)
    }
}

/// All triangles and lights are nearer than [`MAX_COORDINATE`]; false for NaN too, which large transforms can make.
fn in_range(scene: &SceneDescription) -> bool {
    let near = |p: Vec3| p.abs().cmple(Vec3::splat(MAX_COORDINATE)).all();
    let instance_is_near = |instance: &Instance| {
        let mut positions = scene.meshes[instance.mesh].primitives.iter().flat_map(|p| &p.positions);
        positions.all(|&p| near(instance.transform.transform_point3(p)))
    };
    let swept = scene.animation.swept(scene);
    let sweeps_near =
        scene.instances.is_empty() || swept.min.x > swept.max.x || near(swept.min) && near(swept.max);
    sweeps_near
        && scene.instances.iter().all(instance_is_near)
        && scene.lights.iter().filter_map(PlacedLight::position).all(near)
}

/// `node 3 'Lamp'`
fn label(kind: &str, index: usize, name: Option<&str>) -> String {
    match name {
        Some(name) if !name.is_empty() => format!("{kind} {index} '{name}'"),
        _ => format!("{kind} {index}"),
    }
}

/// Text from a file must not break a message's one line.
fn one_line(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}
