//! Materials and textures of a file -> those of the scene.

use super::dielectric;
use super::geometry::Wear;
use super::images::{self, Fault, Images};
use super::warnings::Warnings;
use super::{Reason, label};
use crate::scene::{AlphaMode, Filter, Image, Material, Mips, Texture, Workflow, Wrap};
use glam::{Vec2, Vec3, Vec4};
use gltf::texture::{MagFilter, MinFilter, WrappingMode};
use shared::material::{DIELECTRIC_F0, UvMap, f0_of_ior, slot};
use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;

/// uv sets that a primitive keeps.
const KEPT_UV_SETS: usize = 2;

/// What a texture is read for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Role {
    /// sRGB
    Color,
    /// Linear
    Data,
    Normal,
}

/// Where a texture takes its coordinates from (KHR_texture_transform).
#[derive(Clone, Copy, Debug, PartialEq)]
struct UvMapping {
    /// n of TEXCOORD_n
    set: u32,
    offset: Vec2,
    /// Radians, counter-clockwise as seen (v grows downwards).
    rotation: f32,
    scale: Vec2,
}

impl Default for UvMapping {
    fn default() -> Self {
        UvMapping { set: 0, offset: Vec2::ZERO, rotation: 0.0, scale: Vec2::ONE }
    }
}

impl UvMapping {
    /// Scale, then rotation, then offset; `set` is the place of TEXCOORD_n in what the primitive keeps.
    fn map(&self, set: u32) -> UvMap {
        let (sin, cos) = self.rotation.sin_cos();
        let scale = self.scale;
        UvMap {
            u: Vec3::new(cos * scale.x, sin * scale.y, self.offset.x),
            v: Vec3::new(-sin * scale.x, cos * scale.y, self.offset.y),
            set,
        }
    }
}

/// A texture as a material names it.
struct Reference<'a> {
    texture: gltf::Texture<'a>,
    role: Role,
    uv: UvMapping,
}

/// The references of a material, one a slot.
#[derive(Default)]
struct References<'a> {
    base_color: Option<Reference<'a>>,
    reflectance: Option<Reference<'a>>,
    normal: Option<Reference<'a>>,
    emissive: Option<Reference<'a>>,
}

impl<'a> References<'a> {
    fn of(material: &gltf::Material<'a>) -> Self {
        let info = |info: gltf::texture::Info<'a>, role| Reference {
            uv: mapping(&info),
            texture: info.texture(),
            role,
        };
        let mut references = References::default();
        if let Some(specular) = material.pbr_specular_glossiness() {
            references.base_color = specular.diffuse_texture().map(|t| info(t, Role::Color));
            // Its alpha, the glossiness, is linear all the same.
            references.reflectance = specular.specular_glossiness_texture().map(|t| info(t, Role::Color));
        } else {
            let pbr = material.pbr_metallic_roughness();
            references.base_color = pbr.base_color_texture().map(|t| info(t, Role::Color));
            references.reflectance = pbr.metallic_roughness_texture().map(|t| info(t, Role::Data));
        }
        if material.unlit() {
            references.reflectance = None;
            return references;
        }
        references.normal = material.normal_texture().map(|normal| Reference {
            uv: normal_mapping(&normal),
            texture: normal.texture(),
            role: Role::Normal,
        });
        // Black times a texture is black.
        if material.emissive_factor() != [0.0; 3] {
            references.emissive = material.emissive_texture().map(|t| info(t, Role::Color));
        }
        references
    }

    /// By [`shared::material::slot`].
    fn slots(&self) -> [&Option<Reference<'a>>; slot::COUNT] {
        [&self.base_color, &self.reflectance, &self.normal, &self.emissive]
    }

    /// Those that there are.
    fn iter(&self) -> impl Iterator<Item = &Reference<'a>> {
        self.slots().into_iter().flatten()
    }

    /// The n of TEXCOORD_n that are read, in the order of the slots: a primitive keeps the first two.
    fn uv_sets(&self) -> Vec<u32> {
        let mut sets: Vec<u32> = Vec::new();
        for reference in self.iter() {
            if !sets.contains(&reference.uv.set) {
                sets.push(reference.uv.set);
            }
        }
        sets
    }

    /// Maps from the sets that a primitive keeps; one of a third set reads the first.
    fn uv_maps(&self, sets: &[u32]) -> [UvMap; slot::COUNT] {
        let kept = &sets[..sets.len().min(KEPT_UV_SETS)];
        self.slots().map(|slot| {
            slot.as_ref().map_or(UvMap::default(), |reference| {
                let place = kept.iter().position(|&set| set == reference.uv.set).unwrap_or_default();
                reference.uv.map(place as u32)
            })
        })
    }
}

fn mapping(info: &gltf::texture::Info) -> UvMapping {
    let set = info.tex_coord();
    info.texture_transform().map_or(UvMapping { set, ..UvMapping::default() }, |transform| UvMapping {
        set: transform.tex_coord().unwrap_or(set),
        offset: transform.offset().into(),
        rotation: transform.rotation(),
        scale: transform.scale().into(),
    })
}

/// As `mapping`; the gltf crate leaves the extension of normal textures as JSON.
fn normal_mapping(normal: &gltf::material::NormalTexture) -> UvMapping {
    let mut uv = UvMapping { set: normal.tex_coord(), ..UvMapping::default() };
    if let Some(transform) = normal.extension_value("KHR_texture_transform") {
        let number = |value: &serde_json::Value| value.as_f64().map(|x| x as f32);
        let pair = |name: &str| {
            Some(Vec2::new(number(transform.get(name)?.get(0)?)?, number(transform.get(name)?.get(1)?)?))
        };
        uv.offset = pair("offset").unwrap_or(uv.offset);
        uv.scale = pair("scale").unwrap_or(uv.scale);
        uv.rotation = transform.get("rotation").and_then(number).unwrap_or(uv.rotation);
        let set = transform.get("texCoord").and_then(serde_json::Value::as_u64);
        uv.set = set.and_then(|set| u32::try_from(set).ok()).unwrap_or(uv.set);
    }
    uv
}

/// Materials and textures as they are needed, by their place in the document (`None`: no material at all).
pub struct Materials {
    images: Images,
    /// For messages, by their index in the document.
    image_names: Vec<String>,
    wears: HashMap<Option<usize>, Wear>,
    known_textures: HashMap<(usize, Role), usize>,
    pub materials: Vec<Material>,
    pub textures: Vec<Texture>,
}

/// The images that `materials` read, by index.
pub fn images_of<'a>(materials: impl Iterator<Item = gltf::Material<'a>>) -> BTreeSet<usize> {
    materials
        .flat_map(|material| {
            References::of(&material).iter().filter_map(|r| images::of(&r.texture)).collect::<Vec<_>>()
        })
        .collect()
}

impl Materials {
    pub fn new(document: &gltf::Document, images: Images) -> Self {
        Materials {
            images,
            image_names: document.images().map(|i| label("image", i.index(), i.name())).collect(),
            wears: HashMap::new(),
            known_textures: HashMap::new(),
            materials: Vec::new(),
            textures: Vec::new(),
        }
    }

    /// How to dress a primitive in `source`. Errors: an image too large to draw, a factor that is no number.
    pub fn wear(&mut self, source: &gltf::Material, warnings: &mut Warnings) -> Reason<Wear> {
        if let Some(wear) = self.wears.get(&source.index()) {
            return Ok(wear.clone());
        }
        let index = self.materials.len();
        let wear = match source.index() {
            None => {
                self.materials.push(Material::default());
                Wear { material: index, uv_sets: vec![], has_textures: false, normal_map: None }
            }
            Some(i) => {
                let label = label("material", i, source.name());
                let references = References::of(source);
                let material = self
                    .convert(source, &references, &label, warnings)
                    .map_err(|r| format!("{label}: {r}"))?;
                let mut uv_sets = references.uv_sets();
                if uv_sets.len() > KEPT_UV_SETS {
                    warnings.add(
                        "textures with more than two sets of coordinates: the rest read the first",
                        &label,
                    );
                    uv_sets.truncate(KEPT_UV_SETS);
                }
                let has_textures = references.iter().next().is_some();
                let normal_map = material.normal_texture.map(|_| material.uv_maps[slot::NORMAL]);
                self.materials.push(material);
                Wear { material: index, uv_sets, has_textures, normal_map }
            }
        };
        self.wears.insert(source.index(), wear.clone());
        Ok(wear)
    }

    fn convert(
        &mut self,
        source: &gltf::Material,
        references: &References,
        label: &str,
        warnings: &mut Warnings,
    ) -> Reason<Material> {
        if source.occlusion_texture().is_some() {
            let text = "occlusion textures are not read: they approximate the darkening of indirect light";
            warnings.add(text, label);
        }
        let mut texture = |reference: &Option<Reference>| match reference {
            Some(reference) => self.texture(reference, label, warnings).map(Some),
            None => Ok(None),
        };
        let mut material = Material {
            name: source.name().unwrap_or_default().to_owned(),
            base_color_texture: texture(&references.base_color)?,
            reflectance_texture: texture(&references.reflectance)?,
            normal_texture: texture(&references.normal)?,
            emissive_texture: texture(&references.emissive)?,
            uv_maps: references.uv_maps(&references.uv_sets()),
            double_sided: source.double_sided(),
            unlit: source.unlit(),
            alpha: match source.alpha_mode() {
                gltf::material::AlphaMode::Opaque => AlphaMode::Opaque,
                gltf::material::AlphaMode::Mask => {
                    AlphaMode::Mask { cutoff: source.alpha_cutoff().unwrap_or(0.5) }
                }
                gltf::material::AlphaMode::Blend => AlphaMode::Blend,
            },
            ..Material::default()
        };
        if let Some(specular) = source.pbr_specular_glossiness() {
            material.workflow = Workflow::SpecularGlossiness;
            material.base_color = specular.diffuse_factor().into();
            material.specular = specular.specular_factor().into();
            material.roughness = 1.0 - specular.glossiness_factor();
        } else {
            let pbr = source.pbr_metallic_roughness();
            material.base_color = pbr.base_color_factor().into();
            material.metallic = pbr.metallic_factor();
            material.roughness = pbr.roughness_factor();
            let f0 = source.ior().map_or(DIELECTRIC_F0, f0_of_ior);
            material.specular = dielectric::specular(source, f0, label, warnings);
            dielectric::transmit(source, &mut material, label, warnings);
        }
        material.normal_scale = source.normal_texture().map_or(1.0, |normal| normal.scale());
        if !material.unlit {
            material.emission =
                Vec3::from(source.emissive_factor()) * source.emissive_strength().unwrap_or(1.0);
        }
        if material.emission != Vec3::ZERO && material.alpha != AlphaMode::Opaque {
            warnings.add("emissive and not opaque: its light comes from transparent parts too", label);
        }
        restrict(material)
    }

    /// Index of the texture that `reference` reads; an image used as color and as data makes two, and is shared.
    fn texture(&mut self, reference: &Reference, label: &str, warnings: &mut Warnings) -> Reason<usize> {
        let key = (reference.texture.index(), reference.role);
        if let Some(&index) = self.known_textures.get(&key) {
            return Ok(index);
        }
        let image = self.image(&reference.texture, reference.role, label, warnings)?;
        let sampler = reference.texture.sampler();
        self.textures.push(Texture {
            image,
            srgb: reference.role == Role::Color,
            wrap: [wrap(sampler.wrap_s()), wrap(sampler.wrap_t())],
            filter: filter(sampler.mag_filter(), sampler.min_filter()),
        });
        self.known_textures.insert(key, self.textures.len() - 1);
        Ok(self.textures.len() - 1)
    }

    /// The image, or one texel in its place: white, or a normal that changes nothing.
    fn image(
        &self,
        texture: &gltf::Texture,
        role: Role,
        material: &str,
        warnings: &mut Warnings,
    ) -> Reason<Arc<Image>> {
        let (name, reason) = match images::of(texture) {
            None => (label("texture", texture.index(), texture.name()), "has no image that can be read"),
            Some(index) => {
                let name =
                    self.image_names.get(index).cloned().unwrap_or_else(|| label("image", index, None));
                match self.images.get(&index) {
                    Some(Ok(image)) => return Ok(image.clone()),
                    Some(Err(Fault::TooLarge(reason))) => return Err(format!("{name}: {reason}")),
                    Some(Err(Fault::Missing(reason))) => (name, reason.as_str()),
                    None => (name, "does not exist"),
                }
            }
        };
        let (texel, stands_in) = match role {
            Role::Normal => ([128, 128, 255, 255], "a flat normal"),
            Role::Color | Role::Data => ([255; 4], "white"),
        };
        warnings.add(&format!("{name} ({reason}) is replaced by {stands_in}"), material);
        Ok(images::stand_in(&name, texel))
    }
}

/// What a file leaves open is linear.
fn filter(magnify: Option<MagFilter>, minify: Option<MinFilter>) -> Filter {
    let (minify_linear, mips) = match minify.unwrap_or(MinFilter::LinearMipmapLinear) {
        MinFilter::Nearest => (false, Mips::None),
        MinFilter::Linear => (true, Mips::None),
        MinFilter::NearestMipmapNearest => (false, Mips::Nearest),
        MinFilter::LinearMipmapNearest => (true, Mips::Nearest),
        MinFilter::NearestMipmapLinear => (false, Mips::Linear),
        MinFilter::LinearMipmapLinear => (true, Mips::Linear),
    };
    Filter { magnify_linear: magnify != Some(MagFilter::Nearest), minify_linear, mips }
}

fn wrap(mode: WrappingMode) -> Wrap {
    match mode {
        WrappingMode::Repeat => Wrap::Repeat,
        WrappingMode::MirroredRepeat => Wrap::MirroredRepeat,
        WrappingMode::ClampToEdge => Wrap::ClampToEdge,
    }
}

/// The material with its factors in their ranges. Errors: factors that are infinite or make no sense.
fn restrict(mut material: Material) -> Reason<Material> {
    let emission = material.emission;
    if !(emission.is_finite() && emission.min_element() >= 0.0) {
        return Err(format!("emission {emission} is negative or infinite"));
    }
    if !material.normal_scale.is_finite() {
        return Err("the scale of its normal map is infinite".into());
    }
    let rows = material.uv_maps.iter().flat_map(|map| [map.u, map.v]);
    if !rows.into_iter().all(Vec3::is_finite) {
        return Err("the transform of a texture is infinite".into());
    }
    if !material.specular.is_finite() {
        return Err("its index of refraction is invalid".into());
    }
    material.specular = material.specular.clamp(Vec3::ZERO, Vec3::ONE);
    material.base_color = material.base_color.clamp(Vec4::ZERO, Vec4::ONE);
    material.metallic = material.metallic.clamp(0.0, 1.0);
    material.roughness = material.roughness.clamp(0.0, 1.0);
    Ok(material)
}
