//! A scene as plain CPU data: no Vulkan type, no file handle. Loaders and generators make it, `gpu_scene` uploads it.

pub mod animation;
pub mod camera;
pub mod deform;
pub mod emission;
pub mod environment;
pub mod export;
#[doc(hidden)]
pub mod fixtures;
pub mod gltf;
#[doc(hidden)]
pub mod interchange;
pub mod lights;
#[doc(hidden)]
pub mod procedural;
mod source;
pub mod viewpoint;

pub use environment::Environment;
pub use lights::placed::{DirectionalLight, PanelLight, PanelShape, PlacedLight, PointLight, SpotLight};
pub use source::{EnvironmentSource, Illumination, load};

use glam::{Affine3A, DVec3, Vec2, Vec3, Vec4};
use shared::material::{DIELECTRIC_F0, UvMap, slot};
use std::path::PathBuf;
use std::sync::Arc;

/// Everything that is drawn, in metres and photometric units.
///
/// A program fills in what it needs:
///
/// ```
/// use candela::scene::{Instance, Material, Mesh, PointLight, Primitive, SceneDescription};
/// use candela::shared::glam::{Affine3A, Vec3};
///
/// let triangle = Primitive {
///     positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
///     normals: vec![Vec3::Z; 3],
///     indices: vec![0, 1, 2],
///     ..Primitive::default()
/// };
/// let two_metres_away = Affine3A::from_translation(Vec3::new(0.0, 0.0, -2.0));
/// let scene = SceneDescription {
///     meshes: vec![Mesh { name: "triangle".into(), primitives: vec![triangle] }],
///     instances: vec![Instance { name: "here".into(), mesh: 0, transform: two_metres_away }],
///     materials: vec![Material { metallic: 1.0, roughness: 0.3, ..Material::default() }],
///     lights: vec![PointLight { position: Vec3::Z, intensity: Vec3::splat(50.0), radius: 0.0 }.into()],
///     ..SceneDescription::default()
/// };
/// assert_eq!(scene.triangle_count(), 1);
/// assert_eq!(scene.bounds().max, Vec3::new(1.0, 1.0, -2.0));
/// ```
#[derive(Clone, Debug, Default)]
pub struct SceneDescription {
    /// For messages and file names.
    pub name: String,
    /// Where the zero of all positions below lies in the file's world, m: not at its zero in files far from that, as f32
    /// would have no digits left for detail.
    pub origin: DVec3,
    /// Geometry; [`Instance::mesh`] is an index into it.
    pub meshes: Vec<Mesh>,
    /// What stands in the world.
    pub instances: Vec<Instance>,
    /// [`Primitive::material`] is an index into it.
    pub materials: Vec<Material>,
    /// Materials have indices into it.
    pub textures: Vec<Texture>,
    /// But for emissive meshes and the environment.
    pub lights: Vec<PlacedLight>,
    /// The sky.
    pub environment: Option<Environment>,
    /// [`SceneDescription::camera`] takes them by name or number.
    pub cameras: Vec<SceneCamera>,
    /// What moves; the fields above hold it at rest, or where [`SceneDescription::apply`] put it.
    pub animation: animation::Animation,
    /// What bends; its meshes hold the shape at rest, or what [`SceneDescription::bend`] made of it.
    pub deformed: Vec<deform::Deformed>,
    /// Light arrives at triangles as they are, not at the curved surfaces that they stand for
    /// ([`shared::geometry::InstanceGeometry::bulge`]).
    pub hard_terminator: bool,
    /// One line each: what the file has and the picture will not show, and why.
    pub warnings: Vec<String>,
}

/// Geometry that is shared by instances; each primitive has one material.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// For messages.
    pub name: String,
    /// One for each of its materials.
    pub primitives: Vec<Primitive>,
}

/// An indexed triangle list. All attribute vectors have one entry a vertex, or are empty where the file has none
/// (normals are never empty: loaders compute flat ones).
#[derive(Clone, Debug, Default)]
pub struct Primitive {
    /// Index into [`SceneDescription::materials`].
    pub material: usize,
    /// Object space, m; finite.
    pub positions: Vec<Vec3>,
    /// Unit, object space.
    pub normals: Vec<Vec3>,
    /// Unit tangent and handedness (w = ±1), object space.
    pub tangents: Vec<Vec4>,
    /// Set 0; empty where no texture is read.
    pub uvs: Vec<Vec2>,
    /// What texture maps call set 1.
    pub second_uvs: Vec<Vec2>,
    /// Linear RGBA, 0..=1.
    pub colors: Vec<Vec4>,
    /// Three a triangle, counter-clockwise as seen from its front; each below the number of positions. Cameras don't see the backs
    /// of materials that are not [`Material::double_sided`].
    pub indices: Vec<u32>,
    /// What bends it, where it is kept as modelled.
    pub bends: deform::Bends,
}

/// A mesh in the world.
#[derive(Clone, Debug)]
pub struct Instance {
    /// For messages.
    pub name: String,
    /// Index into [`SceneDescription::meshes`].
    pub mesh: usize,
    /// Object to world.
    pub transform: Affine3A,
}

/// glTF's material parameters.
///
/// ```
/// use candela::scene::Material;
/// use candela::shared::glam::Vec3;
///
/// let gold = Material { base_color: Vec3::new(1.0, 0.77, 0.34).extend(1.0), metallic: 1.0, roughness: 0.2, ..Material::default() };
/// let lamp = Material { emission: Vec3::splat(2_000.0), ..Material::default() }; // each triangle is a light
/// assert!(gold.emission == Vec3::ZERO && lamp.metallic == 0.0);
/// ```
#[derive(Clone, Debug)]
pub struct Material {
    /// For messages.
    pub name: String,
    /// Linear RGBA; of specular-glossiness the diffuse color.
    pub base_color: Vec4,
    /// sRGB; a factor on the base color.
    pub base_color_texture: Option<usize>,
    /// Which of the fields below count.
    pub workflow: Workflow,
    /// Of metallic-roughness alone.
    pub metallic: f32,
    /// 1 - glossiness
    pub roughness: f32,
    /// Reflectance at normal incidence, linear RGB: of what is no metal, or of specular-glossiness all of it.
    pub specular: Vec3,
    /// Metallic-roughness or specular-glossiness.
    pub reflectance_texture: Option<usize>,
    /// Tangent space.
    pub normal_texture: Option<usize>,
    /// Factor on its x and y.
    pub normal_scale: f32,
    /// Radiance, nit, linear RGB (strength included).
    pub emission: Vec3,
    /// sRGB; a factor on the emission.
    pub emissive_texture: Option<usize>,
    /// Where each texture takes its coordinates from, by [`shared::material::slot`].
    pub uv_maps: [UvMap; slot::COUNT],
    /// Both sides are seen. Shadow rays meet both sides of every material.
    pub double_sided: bool,
    /// Shows its base color ([`shared::material::UNLIT_WHITE`] for white), neither lights nor is lit.
    pub unlit: bool,
    /// What alpha means.
    pub alpha: AlphaMode,
}

/// How a material says what it reflects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Workflow {
    /// glTF's own.
    MetallicRoughness,
    /// KHR_materials_pbrSpecularGlossiness.
    SpecularGlossiness,
}

/// What alpha (factor x texture x vertex color) means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AlphaMode {
    /// Nothing.
    Opaque,
    /// Solid where alpha reaches the cutoff, else not there.
    Mask {
        /// From 0 to 1.
        cutoff: f32,
    },
    /// The part of the light that the surface stops or reflects.
    Blend,
}

/// An image with the way it is read.
#[derive(Clone, Debug)]
pub struct Texture {
    /// Shared by textures that read it in different ways.
    pub image: Arc<Image>,
    /// The texels are sRGB-encoded color (else linear data).
    pub srgb: bool,
    /// Along u and v.
    pub wrap: [Wrap; 2],
    /// Between texels.
    pub filter: Filter,
}

/// How texels and mip levels become a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Filter {
    /// Interpolates between texels that are larger than pixels (else the nearest one counts).
    pub magnify_linear: bool,
    /// The same for smaller ones.
    pub minify_linear: bool,
    /// Of the levels.
    pub mips: Mips,
}

/// Which mip levels are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Mips {
    /// The finest alone.
    None,
    /// The nearest one.
    Nearest,
    /// Between two.
    Linear,
}

impl Filter {
    /// Trilinear.
    pub const LINEAR: Filter = Filter { magnify_linear: true, minify_linear: true, mips: Mips::Linear };
    /// Texels as they are.
    pub const NEAREST: Filter = Filter { magnify_linear: false, minify_linear: false, mips: Mips::Nearest };
}

/// What uvs outside of 0..=1 read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// The texture again.
    Repeat,
    /// The texture, every other time mirrored.
    MirroredRepeat,
    /// The texel at the edge.
    ClampToEdge,
}

/// Decoded RGBA8 texels, rows from the top.
#[derive(Debug)]
pub struct Image {
    /// For messages.
    pub name: String,
    /// Texels.
    pub width: u32,
    /// Texels.
    pub height: u32,
    /// 4 bytes a texel.
    pub texels: Vec<u8>,
}

/// A perspective camera in world space.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneCamera {
    /// What [`SceneDescription::camera`] finds it by.
    pub name: String,
    /// m
    pub position: Vec3,
    /// Unit.
    pub forward: Vec3,
    /// Unit, across `forward`.
    pub up: Vec3,
    /// Vertical field of view, radians.
    pub fov_y: f32,
}

/// Axis-aligned box, m. Empty where `min > max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The least coordinates.
    pub min: Vec3,
    /// The greatest coordinates.
    pub max: Vec3,
}

/// Where a scene comes from, as the command line names it.
#[derive(Clone, Debug, PartialEq)]
pub enum SceneSource {
    /// The procedural hall: nothing to download.
    Atrium,
    /// One object before a backdrop.
    Knot,
    /// The procedural town at night.
    Town,
    /// A .gltf or .glb file.
    File(PathBuf),
}

impl Default for Material {
    /// glTF's default material, but for its metal: a file without materials should look like plaster, not chrome.
    fn default() -> Self {
        Material {
            name: String::new(),
            base_color: Vec4::ONE,
            base_color_texture: None,
            workflow: Workflow::MetallicRoughness,
            metallic: 0.0,
            roughness: 1.0,
            specular: Vec3::splat(DIELECTRIC_F0),
            reflectance_texture: None,
            normal_texture: None,
            normal_scale: 1.0,
            emission: Vec3::ZERO,
            emissive_texture: None,
            uv_maps: Default::default(),
            double_sided: false,
            unlit: false,
            alpha: AlphaMode::Opaque,
        }
    }
}

impl Material {
    /// The textures, by [`shared::material::slot`].
    pub fn textures(&self) -> [Option<usize>; slot::COUNT] {
        [self.base_color_texture, self.reflectance_texture, self.normal_texture, self.emissive_texture]
    }
}

impl Default for Bounds {
    fn default() -> Self {
        Bounds { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY }
    }
}

impl Bounds {
    /// Grows to hold `p`.
    pub fn add(&mut self, p: Vec3) {
        self.min = self.min.min(p);
        self.max = self.max.max(p);
    }

    /// Its middle.
    pub fn center(&self) -> Vec3 {
        0.5 * (self.min + self.max)
    }

    /// All eight.
    pub fn corners(&self) -> [DVec3; 8] {
        let ends = [self.min.as_dvec3(), self.max.as_dvec3()];
        std::array::from_fn(|i| DVec3::new(ends[i & 1].x, ends[i >> 1 & 1].y, ends[i >> 2].z))
    }

    /// Length of the box along each axis.
    pub fn extent(&self) -> Vec3 {
        self.max - self.min
    }

    /// Radius of the sphere around the box, m; 1 for a box without any extent.
    pub fn radius(&self) -> f32 {
        let radius = 0.5 * self.extent().as_dvec3().length() as f32;
        if self.extent().min_element() >= 0.0 && radius > 0.0 { radius } else { 1.0 }
    }
}

impl Mesh {
    /// Object-space box.
    pub fn bounds(&self) -> Bounds {
        let mut bounds = Bounds::default();
        self.primitives.iter().flat_map(|p| &p.positions).for_each(|&p| bounds.add(p));
        bounds
    }
}

impl SceneDescription {
    /// Radius of the sphere around everything, wherever it moves, m.
    pub fn radius(&self) -> f32 {
        let (mut bounds, swept) = (self.bounds(), self.animation.swept(self));
        bounds.min = bounds.min.min(swept.min);
        bounds.max = bounds.max.max(swept.max);
        bounds.radius()
    }

    /// World-space box around all instances.
    pub fn bounds(&self) -> Bounds {
        let mut bounds = Bounds::default();
        for instance in &self.instances {
            for primitive in &self.meshes[instance.mesh].primitives {
                // Of all vertices: a box around a turned box is needlessly large.
                for &p in &primitive.positions {
                    bounds.add(instance.transform.transform_point3(p));
                }
            }
        }
        bounds
    }

    /// Triangles as instanced in the world.
    pub fn triangle_count(&self) -> usize {
        let of_mesh = |mesh: &Mesh| mesh.primitives.iter().map(|p| p.indices.len() / 3).sum::<usize>();
        self.instances.iter().map(|instance| of_mesh(&self.meshes[instance.mesh])).sum()
    }
}
