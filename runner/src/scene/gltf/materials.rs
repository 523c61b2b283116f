//! Materials and textures of a file -> those of the scene.

use super::geometry::Wear;
use super::images::{self, Fault, Images};
use super::warnings::Warnings;
use super::{Reason, label};
use crate::scene::{Image, Material, Texture, Wrap};
use glam::{Vec2, Vec3, Vec4};
use gltf::material::AlphaMode;
use gltf::texture::{MagFilter, WrappingMode};
use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;

/// What a texture is read for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Role {
    /// sRGB
    Color,
    /// Linear
    Data,
    Normal,
}

/// Where a material's textures take their coordinates from (KHR_texture_transform).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UvMapping {
    /// n of TEXCOORD_n
    pub set: u32,
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
    /// Scale, then rotation, then offset.
    pub fn apply(&self, uv: Vec2) -> Vec2 {
        if *self == (UvMapping { set: self.set, ..UvMapping::default() }) {
            return uv;
        }
        let (sin, cos) = self.rotation.sin_cos();
        let p = uv * self.scale;
        self.offset + Vec2::new(cos * p.x + sin * p.y, cos * p.y - sin * p.x)
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
    metallic_roughness: Option<Reference<'a>>,
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
        } else {
            let pbr = material.pbr_metallic_roughness();
            references.base_color = pbr.base_color_texture().map(|t| info(t, Role::Color));
            references.metallic_roughness = pbr.metallic_roughness_texture().map(|t| info(t, Role::Data));
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

    /// Those that there are, the most visible one first.
    fn iter(&self) -> impl Iterator<Item = &Reference<'a>> {
        [&self.base_color, &self.normal, &self.metallic_roughness, &self.emissive].into_iter().flatten()
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
    wears: HashMap<Option<usize>, Wear>,
    known_textures: HashMap<(usize, Role), usize>,
    pub materials: Vec<Material>,
    pub textures: Vec<Texture>,
}

/// The images that `materials` read, by index.
pub fn images_of<'a>(materials: impl Iterator<Item = gltf::Material<'a>>) -> BTreeSet<usize> {
    materials
        .flat_map(|material| {
            References::of(&material).iter().map(|r| r.texture.source().index()).collect::<Vec<_>>()
        })
        .collect()
}

impl Materials {
    pub fn new(images: Images) -> Self {
        Materials {
            images,
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
                Wear { material: index, uv: UvMapping::default(), has_textures: false, has_normal_map: false }
            }
            Some(i) => {
                let label = label("material", i, source.name());
                let references = References::of(source);
                let material = self
                    .convert(source, &references, &label, warnings)
                    .map_err(|r| format!("{label}: {r}"))?;
                let uv = references.iter().next().map(|r| r.uv).unwrap_or_default();
                if references.iter().any(|r| r.uv != uv) {
                    let text = "textures with different coordinates: all use those of the base color";
                    warnings.add(text, &label);
                }
                let has_textures = references.iter().next().is_some();
                let has_normal_map = material.normal_texture.is_some();
                self.materials.push(material);
                Wear { material: index, uv, has_textures, has_normal_map }
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
        warn_of_approximations(source, references, label, warnings);
        let mut texture = |reference: &Option<Reference>| match reference {
            Some(reference) => self.texture(reference, label, warnings).map(Some),
            None => Ok(None),
        };
        let mut material = Material {
            name: source.name().unwrap_or_default().to_owned(),
            base_color_texture: texture(&references.base_color)?,
            metallic_roughness_texture: texture(&references.metallic_roughness)?,
            normal_texture: texture(&references.normal)?,
            emissive_texture: texture(&references.emissive)?,
            double_sided: source.double_sided(),
            ..Material::default()
        };
        if let Some(specular) = source.pbr_specular_glossiness() {
            material.base_color = specular.diffuse_factor().into();
            material.roughness = 1.0 - specular.glossiness_factor();
        } else {
            let pbr = source.pbr_metallic_roughness();
            material.base_color = pbr.base_color_factor().into();
            material.metallic = pbr.metallic_factor();
            material.roughness = pbr.roughness_factor();
        }
        material.normal_scale = source.normal_texture().map_or(1.0, |normal| normal.scale());
        material.emission = Vec3::from(source.emissive_factor()) * source.emissive_strength().unwrap_or(1.0);
        restrict(material)
    }

    /// Index of the texture that `reference` reads; an image used as color and as data makes two, and is shared.
    fn texture(&mut self, reference: &Reference, label: &str, warnings: &mut Warnings) -> Reason<usize> {
        let key = (reference.texture.index(), reference.role);
        if let Some(&index) = self.known_textures.get(&key) {
            return Ok(index);
        }
        let image = self.image(&reference.texture.source(), reference.role, label, warnings)?;
        let sampler = reference.texture.sampler();
        self.textures.push(Texture {
            image,
            srgb: reference.role == Role::Color,
            wrap: [wrap(sampler.wrap_s()), wrap(sampler.wrap_t())],
            linear_filter: sampler.mag_filter() != Some(MagFilter::Nearest),
        });
        self.known_textures.insert(key, self.textures.len() - 1);
        Ok(self.textures.len() - 1)
    }

    /// The image, or one texel in its place: white, or a normal that changes nothing.
    fn image(
        &self,
        source: &gltf::Image,
        role: Role,
        material: &str,
        warnings: &mut Warnings,
    ) -> Reason<Arc<Image>> {
        let name = label("image", source.index(), source.name());
        let reason = match self.images.get(&source.index()) {
            Some(Ok(image)) => return Ok(image.clone()),
            Some(Err(Fault::TooLarge(reason))) => return Err(format!("{name}: {reason}")),
            Some(Err(Fault::Missing(reason))) => reason.as_str(),
            None => "not loaded",
        };
        let (texel, stands_in) = match role {
            Role::Normal => ([128, 128, 255, 255], "a flat normal"),
            Role::Color | Role::Data => ([255; 4], "white"),
        };
        warnings.add(&format!("{name} ({reason}) is replaced by {stands_in}"), material);
        Ok(images::stand_in(&name, texel))
    }
}

fn wrap(mode: WrappingMode) -> Wrap {
    match mode {
        WrappingMode::Repeat => Wrap::Repeat,
        WrappingMode::MirroredRepeat => Wrap::MirroredRepeat,
        WrappingMode::ClampToEdge => Wrap::ClampToEdge,
    }
}

fn warn_of_approximations(
    source: &gltf::Material,
    references: &References,
    label: &str,
    warnings: &mut Warnings,
) {
    if source.alpha_mode() != AlphaMode::Opaque {
        warnings.add("alpha modes MASK and BLEND are drawn opaque", label);
    }
    if source.pbr_specular_glossiness().is_some() {
        warnings.add(
            "specular-glossiness is approximated: diffuse color, no metal, glossiness without its texture",
            label,
        );
    }
    if references.emissive.is_some() {
        warnings.add("an emissive texture: as a light, each triangle emits the texture's average", label);
    }
    if source.unlit() {
        warnings.add("KHR_materials_unlit: drawn lit", label);
    }
    if source.ior().is_some_and(|ior| ior != 1.5) {
        warnings.add("KHR_materials_ior: drawn with an index of refraction of 1.5", label);
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
    material.base_color = material.base_color.clamp(Vec4::ZERO, Vec4::ONE);
    material.metallic = material.metallic.clamp(0.0, 1.0);
    material.roughness = material.roughness.clamp(0.0, 1.0);
    Ok(material)
}
