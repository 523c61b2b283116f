//! A scene on the device: buffers, textures, acceleration structures, and descriptor set 0 that shows them to shaders.

#[doc(hidden)]
pub mod arrays;
#[doc(hidden)]
pub mod draws;
mod light_tree;
pub mod memory;
#[doc(hidden)]
pub mod past;

use crate::error::Result;
use crate::scene::lights::LightTable;
use crate::scene::{Image as SceneImage, SceneDescription};
use crate::startup;
use crate::vulkan::acceleration::BUILD_INPUT;
use crate::vulkan::{
    Binding, BlasGeometry, BlasSet, Buffer, DescriptorSet, Device, Image, SetLayout, Tlas, TlasInstance,
    Uploader,
};
use arrays::{SceneArrays, environment_texels};
use ash::vk;
use draws::Draws;
use glam::{Affine3A, UVec2, Vec3, Vec3A};
use past::Past;
use shared::frame::features;
use shared::light::count::LightCount;
use shared::light::tree::Tree;
use shared::material::{Material, UNLIT_WHITE};
use shared::motion::InstanceMotion;
use shared::resources::{Binding as Place, Resource, set};
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;
use std::time::Instant;

const STORAGE: vk::BufferUsageFlags = vk::BufferUsageFlags::STORAGE_BUFFER;

/// The device's copy of a scene. Its handles stay valid as long as it lives.
///
/// ```
/// use candela::gpu_scene::GpuScene;
/// use candela::scene::{Illumination, SceneSource, load};
/// use candela::vulkan::{Device, DeviceOptions};
///
/// let device = Device::new(&DeviceOptions::default())?;
/// let scene = GpuScene::new(&device, &load(&SceneSource::Knot, &Illumination::points(100))?)?;
/// assert_eq!(scene.lights().number, 100);
/// # Ok::<(), candela::error::Error>(())
/// ```
pub struct GpuScene {
    set: DescriptorSet,
    lights: LightCount,
    tree_is_made: bool,
    environment_size: UVec2,
    first_environment_light: u32,
    features: u32,
    /// Without the geometry.
    arrays: SceneArrays,
    buffers: BTreeMap<Resource, Buffer>,
    draws: Draws,
    blas: BlasSet,
    tlas: Tlas,
    /// Set 2 while nothing has moved: passes that may read it are bound to the present.
    present: DescriptorSet,
    past: Option<Past>,
    /// Materials that are unlit, with their base colors.
    unlit: Vec<(usize, Vec3)>,
    // Kept for the descriptors above.
    textures: Vec<Image>,
}

/// Texels of the environment map; 0 without one.
fn environment_size(scene: &SceneDescription) -> UVec2 {
    scene.environment.as_ref().map_or(UVec2::ZERO, |map| map.size)
}

impl GpuScene {
    /// Uploads `scene` and builds its acceleration structures.
    pub fn new(device: &Device, scene: &SceneDescription) -> Result<Self> {
        Self::staged(device, scene, &mut |_| Ok(()))
    }

    /// As `new`; `stage` hears what is being done, and may end it by an error.
    pub fn staged(
        device: &Device,
        scene: &SceneDescription,
        stage: &mut dyn FnMut(&'static str) -> Result<()>,
    ) -> Result<Self> {
        stage("buffers and textures")?;
        let lights = startup::timed("lights", || LightTable::new(scene));
        let arrays = startup::timed("geometry", || SceneArrays::new(scene, &lights))?;
        let start = Instant::now();
        let mut upload = Uploader::new(device);
        let positions = upload.buffer("positions", &arrays.positions, STORAGE | BUILD_INPUT)?;
        let indices = upload.buffer("indices", &arrays.indices, STORAGE | BUILD_INPUT)?;
        let environment = upload.buffer("environment map", &environment_texels(scene), STORAGE)?;
        let mut buffers = BTreeMap::from([
            (Resource::instances, upload.buffer("instances", &arrays.instances, STORAGE)?),
            (Resource::positions, positions),
            (Resource::attributes, upload.buffer("vertex attributes", &arrays.attributes, STORAGE)?),
            (Resource::indices, indices),
            (Resource::materials, upload.buffer("materials", &arrays.materials, STORAGE)?),
            (Resource::lights, upload.buffer("lights", &lights.lights, STORAGE)?),
            (Resource::alias, upload.buffer("alias table", &lights.alias, STORAGE)?),
            (Resource::second_uvs, upload.buffer("second uvs", &arrays.second_uvs, STORAGE)?),
            (Resource::environment, environment),
        ]);
        buffers.extend(light_tree::buffers(&mut upload, &Tree::default())?);
        let draws = Draws::new(&mut upload, &arrays)?;
        let (textures, views) = upload_textures(device, &mut upload, scene)?;
        upload.finish()?;
        startup::done("upload", start);

        stage("acceleration structures")?;
        let (positions, indices) = (&buffers[&Resource::positions], &buffers[&Resource::indices]);
        let geometries = geometries(&arrays, positions, indices);
        let blas = startup::timed("BLAS", || BlasSet::build(device, &geometries))?;
        let tlas = startup::timed("TLAS", || Tlas::build(device, &blas, &tlas_instances(&arrays)))?;
        let set = DescriptorSet::new(
            device,
            "scene",
            &set_layout(device, views.len() as u32, arrays.features)?,
            views.len() as u32,
        )?;
        set.bind_tlas(set::STRUCTURE, &tlas);
        for place in places(set::SCENE) {
            set.bind_storage_buffer(place.number(), &buffers[&place.resource()]);
        }
        set.bind_textures(set::TEXTURES, &views);
        let present = DescriptorSet::new(device, "present", &past::layout(device)?, 0)?;
        present.bind_tlas(set::STRUCTURE, &tlas);
        for place in places(set::PAST) {
            present.bind_storage_buffer(place.number(), &buffers[&Resource::instances]);
        }
        let unlit = scene.materials.iter().enumerate().filter(|(_, material)| material.unlit);
        Ok(GpuScene {
            present,
            unlit: unlit.map(|(i, material)| (i, material.base_color.truncate())).collect(),
            set,
            lights: LightCount::of(&lights.lights),
            tree_is_made: false,
            environment_size: environment_size(scene),
            first_environment_light: lights.first_environment as u32,
            features: arrays.features,
            arrays: arrays.without_geometry(),
            buffers,
            draws,
            blas,
            tlas,
            past: None,
            textures,
        })
    }

    /// Descriptors of set 0.
    pub fn set(&self) -> &DescriptorSet {
        &self.set
    }

    /// Has a material that shows its base color?
    pub fn has_unlit(&self) -> bool {
        !self.unlit.is_empty()
    }

    /// Shows white unlit surfaces with `white` nit from the next frame on ([`UNLIT_WHITE`] before the first call). Nothing may
    /// be in flight.
    pub fn set_unlit_white(&self, device: &Device, white: f32) -> Result<()> {
        let stride = size_of::<Material>();
        let mut upload = Uploader::with_capacity(device, (self.unlit.len() * stride) as u64);
        for &(i, color) in &self.unlit {
            let offset = i * stride + std::mem::offset_of!(Material, base_color);
            let shown = color * (white / UNLIT_WHITE);
            upload.write(&self.buffers[&Resource::materials], offset as u64, &[shown])?;
        }
        upload.finish()
    }

    /// The triangles, for the graphics pipeline.
    pub fn draws(&self) -> &Draws {
        &self.draws
    }

    /// All lights: placed, emissive triangles, texels of the sky.
    pub fn light_count(&self) -> u32 {
        self.lights.number
    }

    /// How many there are, and how dense: what [`crate::knobs::Knobs::settings`] asks for.
    pub fn lights(&self) -> LightCount {
        self.lights
    }

    /// The way back of each [`shared::geometry::InstanceGeometry`], from the last frame in which anything moved ([`GpuScene::version`])
    /// to the one before it; nothing where nothing ever moved.
    pub fn motions(&self) -> Result<Vec<InstanceMotion>> {
        self.past.as_ref().map_or(Ok(Vec::new()), Past::motions)
    }

    /// Lights of the light tree; 0 before it is made.
    pub fn tree_lights(&self) -> u32 {
        if self.tree_is_made { self.lights.placed } else { 0 }
    }

    /// Texels of the environment map; 0 without one.
    pub fn environment_size(&self) -> UVec2 {
        self.environment_size
    }

    /// Index of the light of the map's first lit texel.
    pub fn first_environment_light(&self) -> u32 {
        self.first_environment_light
    }

    /// [`shared::frame::features`] of the scene.
    pub fn features(&self) -> u32 {
        self.features
    }

    /// Device memory of all buffers, bytes; see [`memory`] for what they hold.
    pub fn bytes(&self) -> u64 {
        self.buffers.values().map(Buffer::size).sum::<u64>() + self.draws.bytes() + self.past_bytes()
    }

    /// Device memory of the acceleration structures, bytes.
    pub fn acceleration_bytes(&self) -> u64 {
        self.blas.bytes() + self.tlas.bytes()
    }

    /// Images on the device, mip levels included.
    pub fn image_count(&self) -> usize {
        self.textures.len()
    }
}

/// The buffers of `set`.
fn places(set: u32) -> impl Iterator<Item = Place> {
    Place::ALL.iter().copied().filter(move |place| place.set() == set)
}

/// The layout of set 0 for a scene with so many textures and these features.
fn set_layout(device: &Device, textures: u32, features: u32) -> Result<SetLayout> {
    use vk::ShaderStageFlags as Stage;
    let alpha = match features & features::ALPHA != 0 {
        true => Stage::ANY_HIT_KHR | Stage::FRAGMENT,
        false => Stage::empty(),
    };
    let stages = Stage::RAYGEN_KHR | Stage::COMPUTE | Stage::VERTEX | alpha;
    let structure = vk::DescriptorType::ACCELERATION_STRUCTURE_KHR;
    let mut bindings = vec![Binding::one(set::STRUCTURE, structure, Stage::RAYGEN_KHR)];
    bindings.extend(Binding::buffers(set::SCENE, stages));
    let stages = Stage::RAYGEN_KHR | Stage::COMPUTE | alpha;
    bindings.push(Binding::textures(set::TEXTURES, textures, stages));
    SetLayout::new(device, "scene", &bindings)
}

/// One BLAS a part, one geometry a primitive.
fn geometries(arrays: &SceneArrays, positions: &Buffer, indices: &Buffer) -> Vec<Vec<BlasGeometry>> {
    let geometry = |range: &arrays::PrimitiveRange| BlasGeometry {
        vertices: positions.address() + 12 * u64::from(range.first_vertex),
        vertex_count: range.vertex_count,
        indices: indices.address() + 4 * u64::from(range.first_index),
        triangle_count: range.triangle_count,
        opaque: range.opaque,
    };
    arrays.parts.iter().map(|part| part.ranges.iter().map(geometry).collect()).collect()
}

/// Vulkan takes the facing in object space, so a transform that mirrors changes nothing: its front, where corners run
/// clockwise in left-handed coordinates, is glTF's, where they run counter-clockwise in right-handed ones. Only rays that
/// cull look at it; double-sided parts are never culled.
///
/// What is scaled to nothing can't be hit, and Vulkan wants a transform that has an inverse.
fn tlas_instances(arrays: &SceneArrays) -> Vec<TlasInstance> {
    use vk::GeometryInstanceFlagsKHR as Flags;
    let place = |placement: &arrays::Placement| {
        let transform = arrays.transforms[placement.instance];
        let shown = has_area(&transform);
        TlasInstance {
            transform: rows(if shown { &transform } else { &Affine3A::IDENTITY }),
            custom_index: placement.custom_index,
            mask: if shown { 0xff } else { 0 },
            blas: placement.part,
            flags: match arrays.parts[placement.part].double_sided {
                true => Flags::TRIANGLE_FACING_CULL_DISABLE,
                false => Flags::empty(),
            },
        }
    };
    arrays.placements.iter().map(place).collect()
}

fn has_area(transform: &Affine3A) -> bool {
    let [x, y, z] = [transform.x_axis, transform.y_axis, transform.z_axis];
    [x.cross(y), y.cross(z), z.cross(x)].iter().any(|&area| area != Vec3A::ZERO)
}

/// The first three rows of a transform's matrix.
fn rows(transform: &Affine3A) -> [f32; 12] {
    let m = glam::Mat4::from(*transform).transpose().to_cols_array();
    std::array::from_fn(|i| m[i])
}

type View = (vk::ImageView, vk::Sampler);

/// One device image for each way an image is read (sRGB or linear), one view and sampler a texture.
fn upload_textures(
    device: &Device,
    upload: &mut Uploader,
    scene: &SceneDescription,
) -> Result<(Vec<Image>, Vec<View>)> {
    let mut images = Vec::new();
    let mut known: HashMap<(*const SceneImage, bool), usize> = HashMap::new();
    let mut views = Vec::with_capacity(scene.textures.len());
    for texture in &scene.textures {
        let key = (Arc::as_ptr(&texture.image), texture.srgb);
        let index = match known.get(&key) {
            Some(&index) => index,
            None => {
                let image = &texture.image;
                images.push(upload.texture(
                    &image.name,
                    image.width,
                    image.height,
                    texture.srgb,
                    &image.texels,
                )?);
                known.insert(key, images.len() - 1);
                images.len() - 1
            }
        };
        views.push((images[index].view(), device.sampler(texture.wrap, texture.filter)?));
    }
    Ok((images, views))
}
