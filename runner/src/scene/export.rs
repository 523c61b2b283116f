//! Scenes as glTF 2.0: geometry, metallic-roughness materials with their textures, lights, cameras, and what
//! moves (a root of the animation without a place of its own). What other
//! workflows, alpha modes and texture transforms say is not written.

use super::animation::{Curve, Interpolation, Local, Thing};
use super::{
    Image, Instance, Material, Mesh, Mips, PanelLight, PanelShape, PlacedLight, PointLight, Primitive,
    SceneCamera, SceneDescription, SpotLight, Texture, Wrap,
};
use crate::error::{Error, Result};
use glam::{DMat3, DMat4, DQuat, DVec3, Mat4, Vec3};
use image::ImageEncoder;
use serde_json::{Map, Value, json};
use std::collections::HashSet;
use std::sync::Arc;

// Numbers of the glTF specification.
const FLOAT: u32 = 5126;
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
/// Near plane of exported cameras, m: glTF asks for one, Candela has none.
const NEAR: f32 = 0.01;

/// One file: a .glb with everything in it. The same scene gives the same bytes. Fails where a texture's texels do not
/// fit its size.
pub fn to_glb(scene: &SceneDescription) -> Result<Vec<u8>> {
    let (mut root, bin) = document(scene)?;
    if !bin.is_empty() {
        root.insert("buffers".into(), json!([{ "byteLength": bin.len() }]));
    }
    // The writer counts the length.
    let header = gltf::binary::Header { magic: *b"glTF", version: 2, length: 0 };
    let json = Value::Object(root).to_string().into_bytes().into();
    let bin = (!bin.is_empty()).then(|| bin.into());
    let glb = gltf::Glb { header, json, bin };
    glb.to_vec().map_err(|error| Error::Internal(format!("the file can't be written: {error}")))
}

/// Two files: the text of a .gltf and the bytes of the buffer that it refers to as `buffer_uri`.
pub fn to_gltf(scene: &SceneDescription, buffer_uri: &str) -> Result<(String, Vec<u8>)> {
    let (mut root, bin) = document(scene)?;
    if !bin.is_empty() {
        root.insert("buffers".into(), json!([{ "byteLength": bin.len(), "uri": buffer_uri }]));
    }
    Ok((format!("{:#}\n", Value::Object(root)), bin))
}

/// The buffer under construction.
#[derive(Default)]
struct Binary {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Binary {
    fn view(&mut self, bytes: &[u8], target: Option<u32>) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let mut view = json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() });
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        self.bytes.extend(bytes);
        self.views.push(view);
        self.views.len() - 1
    }

    fn accessor(&mut self, view: usize, component: u32, kind: &str, count: usize) -> usize {
        let accessor =
            json!({ "bufferView": view, "componentType": component, "type": kind, "count": count });
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// A vertex attribute of N floats.
    fn attribute<T: bytemuck::NoUninit>(&mut self, kind: &str, values: &[T]) -> usize {
        let view = self.view(bytemuck::cast_slice(values), Some(ARRAY_BUFFER));
        self.accessor(view, FLOAT, kind, values.len())
    }

    fn indices(&mut self, indices: &[u32], vertices: usize) -> usize {
        // 65535 is the restart index: not a vertex.
        if vertices <= usize::from(u16::MAX) {
            let short: Vec<u16> = indices.iter().map(|&i| i as u16).collect();
            let view = self.view(bytemuck::cast_slice(&short), Some(ELEMENT_ARRAY_BUFFER));
            self.accessor(view, UNSIGNED_SHORT, "SCALAR", indices.len())
        } else {
            let view = self.view(bytemuck::cast_slice(indices), Some(ELEMENT_ARRAY_BUFFER));
            self.accessor(view, UNSIGNED_INT, "SCALAR", indices.len())
        }
    }
}

/// The JSON but for its buffer, and the buffer.
fn document(scene: &SceneDescription) -> Result<(Map<String, Value>, Vec<u8>)> {
    let mut bin = Binary::default();
    let meshes: Vec<Value> = scene.meshes.iter().map(|mesh| mesh_json(mesh, &mut bin)).collect();
    let (images, textures, samplers) = textures_json(&scene.textures, &mut bin)?;
    let materials: Vec<Value> = scene.materials.iter().map(material_json).collect();
    let (nodes, roots) = nodes_json(scene);
    let animations = animations_json(scene, nodes.len() - scene.animation.nodes.len(), &mut bin);
    let (panels, lights): (Vec<&PlacedLight>, Vec<&PlacedLight>) =
        scene.lights.iter().partition(|light| is_panel(light));
    let mut root = Map::new();
    root.insert("asset".into(), json!({ "version": "2.0", "generator": "Candela" }));
    if !nodes.is_empty() {
        root.insert("scene".into(), json!(0));
        root.insert("scenes".into(), json!([{ "name": scene.name, "nodes": roots }]));
    }
    let mut used = Vec::new();
    let mut extensions = Map::new();
    for (extension, lights) in [(AREA, panels), (PUNCTUAL, lights)] {
        if !lights.is_empty() {
            used.push(extension);
            let lights: Vec<Value> = lights.into_iter().map(light_json).collect();
            extensions.insert(extension.into(), json!({ "lights": lights }));
        }
    }
    if !extensions.is_empty() {
        root.insert("extensions".into(), extensions.into());
    }
    if scene.materials.iter().any(|material| material.emission.max_element() > 1.0) {
        used.push("KHR_materials_emissive_strength");
    }
    let cameras = scene.cameras.iter().map(camera_json).collect();
    let used = used.into_iter().map(Value::from).collect();
    let lists: [(&str, Vec<Value>); 11] = [
        ("accessors", bin.accessors),
        ("animations", animations),
        ("bufferViews", bin.views),
        ("cameras", cameras),
        ("extensionsUsed", used),
        ("images", images),
        ("materials", materials),
        ("meshes", meshes),
        ("nodes", nodes),
        ("samplers", samplers),
        ("textures", textures),
    ];
    // glTF has no empty arrays.
    root.extend(
        lists.into_iter().filter(|(_, list)| !list.is_empty()).map(|(key, list)| (key.into(), list.into())),
    );
    Ok((root, bin.bytes))
}

fn mesh_json(mesh: &Mesh, bin: &mut Binary) -> Value {
    let primitives: Vec<Value> = mesh.primitives.iter().map(|p| primitive_json(p, bin)).collect();
    json!({ "name": mesh.name, "primitives": primitives })
}

fn primitive_json(primitive: &Primitive, bin: &mut Binary) -> Value {
    let mut attributes = Map::new();
    let mut add = |name: &str, accessor: usize| attributes.insert(name.into(), accessor.into());
    let position = bin.attribute("VEC3", &primitive.positions);
    let (min, max) = primitive
        .positions
        .iter()
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(min, max), &p| (min.min(p), max.max(p)));
    bin.accessors[position]["min"] = json!(min.to_array());
    bin.accessors[position]["max"] = json!(max.to_array());
    add("POSITION", position);
    add("NORMAL", bin.attribute("VEC3", &primitive.normals));
    if !primitive.tangents.is_empty() {
        add("TANGENT", bin.attribute("VEC4", &primitive.tangents));
    }
    if !primitive.uvs.is_empty() {
        add("TEXCOORD_0", bin.attribute("VEC2", &primitive.uvs));
    }
    if !primitive.colors.is_empty() {
        add("COLOR_0", bin.attribute("VEC4", &primitive.colors));
    }
    let indices = bin.indices(&primitive.indices, primitive.positions.len());
    json!({ "attributes": attributes, "indices": indices, "material": primitive.material })
}

/// (images, textures, samplers): an image that several textures share is written once.
fn textures_json(textures: &[Texture], bin: &mut Binary) -> Result<(Vec<Value>, Vec<Value>, Vec<Value>)> {
    let mut images: Vec<(&Arc<Image>, Value)> = Vec::new();
    let (mut texture_list, mut samplers) = (Vec::new(), Vec::new());
    for texture in textures {
        let known = images.iter().position(|(image, _)| Arc::ptr_eq(image, &texture.image));
        let source = match known {
            Some(source) => source,
            None => {
                let view = bin.view(&png(&texture.image)?, None);
                let image =
                    json!({ "name": texture.image.name, "bufferView": view, "mimeType": "image/png" });
                images.push((&texture.image, image));
                images.len() - 1
            }
        };
        let mag = if texture.filter.magnify_linear { 9729 } else { 9728 };
        let min = match (texture.filter.minify_linear, texture.filter.mips) {
            (false, Mips::None) => 9728,
            (true, Mips::None) => 9729,
            (false, Mips::Nearest) => 9984,
            (true, Mips::Nearest) => 9985,
            (false, Mips::Linear) => 9986,
            (true, Mips::Linear) => 9987,
        };
        let [s, t] = texture.wrap.map(wrap_code);
        let sampler = json!({ "magFilter": mag, "minFilter": min, "wrapS": s, "wrapT": t });
        let at = samplers.iter().position(|known| *known == sampler).unwrap_or_else(|| {
            samplers.push(sampler);
            samplers.len() - 1
        });
        texture_list.push(json!({ "source": source, "sampler": at }));
    }
    Ok((images.into_iter().map(|(_, json)| json).collect(), texture_list, samplers))
}

fn wrap_code(wrap: Wrap) -> u32 {
    match wrap {
        Wrap::Repeat => 10497,
        Wrap::MirroredRepeat => 33648,
        Wrap::ClampToEdge => 33071,
    }
}

pub(super) fn png(image: &Image) -> Result<Vec<u8>> {
    let Image { name, width, height, texels } = image;
    if texels.len() as u64 != u64::from(*width) * u64::from(*height) * 4 || texels.is_empty() {
        let bytes = texels.len();
        return Err(Error::Internal(format!(
            "texture '{name}': {bytes} bytes are not {width} x {height} RGBA texels"
        )));
    }
    let mut png = Vec::new();
    image::codecs::png::PngEncoder::new(&mut png)
        .write_image(texels, *width, *height, image::ExtendedColorType::Rgba8)
        .map_err(|error| Error::Internal(format!("texture '{name}': can't be written as PNG: {error}")))?;
    Ok(png)
}

fn material_json(material: &Material) -> Value {
    let mut pbr = json!({
        "baseColorFactor": material.base_color.to_array(),
        "metallicFactor": material.metallic,
        "roughnessFactor": material.roughness,
    });
    if let Some(index) = material.base_color_texture {
        pbr["baseColorTexture"] = json!({ "index": index });
    }
    if let Some(index) = material.reflectance_texture {
        pbr["metallicRoughnessTexture"] = json!({ "index": index });
    }
    let mut json =
        json!({ "name": material.name, "pbrMetallicRoughness": pbr, "doubleSided": material.double_sided });
    if let Some(index) = material.normal_texture {
        json["normalTexture"] = json!({ "index": index, "scale": material.normal_scale });
    }
    if let Some(index) = material.emissive_texture {
        json["emissiveTexture"] = json!({ "index": index });
    }
    // The factor is limited to 1: the rest is the extension's strength.
    let strength = material.emission.max_element();
    if strength > 1.0 {
        json["extensions"] = json!({ "KHR_materials_emissive_strength": { "emissiveStrength": strength } });
    }
    if strength > 0.0 {
        json["emissiveFactor"] = json!((material.emission / strength.max(1.0)).to_array());
    }
    json
}

/// The extensions that list lights.
const PUNCTUAL: &str = "KHR_lights_punctual";
const AREA: &str = "EXT_lights_area";

fn is_panel(light: &PlacedLight) -> bool {
    matches!(light, PlacedLight::Panel(_))
}

/// KHR_lights_punctual: cd or lx; EXT_lights_area: nit. The color's largest component is 1.
fn light_json(light: &PlacedLight) -> Value {
    let (kind, emission) = match light {
        PlacedLight::Point(l) => ("point", l.intensity),
        PlacedLight::Spot(l) => ("spot", l.intensity),
        PlacedLight::Directional(l) => ("directional", l.illuminance),
        PlacedLight::Panel(PanelLight { shape: PanelShape::Disk, radiance, .. }) => ("disk", *radiance),
        PlacedLight::Panel(l) => ("rect", l.radiance),
    };
    let intensity = emission.max_element();
    let color = if intensity > 0.0 { emission / intensity } else { Vec3::ONE };
    let mut json = json!({ "type": kind, "color": color.to_array(), "intensity": intensity });
    match light {
        PlacedLight::Spot(l) => {
            json["spot"] = json!({ "innerConeAngle": l.inner_angle, "outerConeAngle": l.outer_angle });
        }
        PlacedLight::Panel(l) => {
            json["size"] = json!(l.size.y);
            if l.shape == PanelShape::Rectangle {
                json["rect"] = json!({ "aspect": l.size.x / l.size.y });
            }
        }
        PlacedLight::Point(_) | PlacedLight::Directional(_) => {}
    }
    if let PlacedLight::Point(PointLight { radius, .. }) | PlacedLight::Spot(SpotLight { radius, .. }) = light
        && *radius > 0.0
    {
        json["extras"] = json!({ "radius": radius });
    }
    json
}

/// The node of a light that stands still. It shines along -z.
fn light_node(light: &PlacedLight) -> Map<String, Value> {
    let mut node = Map::new();
    let along = |axis: Vec3| DQuat::from_rotation_arc(DVec3::NEG_Z, axis.as_dvec3().normalize());
    let turn = match light {
        PlacedLight::Point(_) => None,
        PlacedLight::Spot(l) => Some(along(l.axis)),
        PlacedLight::Directional(l) => Some(along(-l.direction)),
        PlacedLight::Panel(l) => {
            let axes = [l.axis.cross(l.up), l.up, -l.axis].map(Vec3::as_dvec3);
            Some(DQuat::from_mat3(&DMat3::from_cols(axes[0], axes[1], axes[2])).normalize())
        }
    };
    if let Some(position) = light.position() {
        node.insert("translation".into(), json!(position.to_array()));
    }
    if let Some(turn) = turn {
        node.insert("rotation".into(), json!(turn.as_quat().to_array()));
    }
    node
}

fn camera_json(camera: &SceneCamera) -> Value {
    json!({
        "name": camera.name,
        "type": "perspective",
        "perspective": { "yfov": camera.fov_y, "znear": NEAR },
    })
}

/// The nodes, those of the animation last, and which of them are roots. What moves hangs on a node of the animation and has
/// no transform of its own.
fn nodes_json(scene: &SceneDescription) -> (Vec<Value>, Vec<usize>) {
    let moves = |thing| scene.animation.moves(thing);
    let instance = |(i, instance): (usize, &Instance)| {
        let mut node = json!({ "name": instance.name, "mesh": instance.mesh });
        let matrix = Mat4::from(instance.transform);
        if matrix != Mat4::IDENTITY && !moves(Thing::Instance(i)) {
            node["matrix"] = json!(matrix.to_cols_array());
        }
        node
    };
    let camera = |(i, camera): (usize, &SceneCamera)| {
        if moves(Thing::Camera(i)) {
            return json!({ "name": camera.name, "camera": i });
        }
        // A glTF camera looks along -z of its node.
        let back = -camera.forward;
        let right = camera.up.cross(back).normalize_or(back.any_orthonormal_vector());
        let axes = [right, back.cross(right), back].map(|axis| axis.extend(0.0));
        let matrix = Mat4::from_cols(axes[0], axes[1], axes[2], camera.position.extend(1.0));
        json!({ "name": camera.name, "camera": i, "matrix": matrix.to_cols_array() })
    };
    let panels: Vec<usize> = (0..scene.lights.len()).filter(|&i| is_panel(&scene.lights[i])).collect();
    let light = |(i, light): (usize, &PlacedLight)| {
        let mut node = if moves(Thing::Light(i)) { Map::new() } else { light_node(light) };
        let (extension, place) = if is_panel(light) {
            (AREA, panels.partition_point(|&panel| panel < i))
        } else {
            (PUNCTUAL, i - panels.partition_point(|&panel| panel < i))
        };
        node.insert("extensions".into(), json!({ extension: { "light": place } }));
        node.into()
    };
    let instances = scene.instances.iter().enumerate().map(instance);
    let cameras = scene.cameras.iter().enumerate().map(camera);
    let lights = scene.lights.iter().enumerate().map(light);
    let mut nodes: Vec<Value> = instances.chain(cameras).chain(lights).collect();
    let first = nodes.len();
    let mut children = vec![Vec::new(); scene.animation.nodes.len()];
    for &(thing, node) in &scene.animation.attached {
        children[node].push(match thing {
            Thing::Instance(i) => i,
            Thing::Camera(i) => scene.instances.len() + i,
            Thing::Light(i) => scene.instances.len() + scene.cameras.len() + i,
        });
    }
    for (i, node) in scene.animation.nodes.iter().enumerate() {
        children.get_mut(node.parent.unwrap_or(usize::MAX)).into_iter().for_each(|list| list.push(first + i));
    }
    let child: HashSet<usize> = children.iter().flatten().copied().collect();
    for (node, children) in scene.animation.nodes.iter().zip(&children) {
        let mut json = match node.rest {
            Local::Matrix(affine) => json!({ "matrix": DMat4::from(affine).as_mat4().to_cols_array() }),
            Local::Trs { translation, rotation, scale } => json!({
                "translation": translation.as_vec3().to_array(),
                "rotation": rotation.as_quat().to_array(),
                "scale": scale.as_vec3().to_array(),
            }),
        };
        if !children.is_empty() {
            json["children"] = json!(children);
        }
        nodes.push(json);
    }
    let roots = (0..nodes.len()).filter(|i| !child.contains(i)).collect();
    (nodes, roots)
}

/// One animation with all channels; `first`: the node that the animation's first one became.
fn animations_json(scene: &SceneDescription, first: usize, bin: &mut Binary) -> Vec<Value> {
    let (mut samplers, mut channels) = (Vec::new(), Vec::new());
    for (i, channel) in scene.animation.channels.iter().enumerate() {
        let three =
            |values: &[DVec3]| values.iter().flat_map(|v| v.as_vec3().to_array()).collect::<Vec<f32>>();
        let (path, times, interpolation, kind, values) = match &channel.curve {
            Curve::Translation(t) => ("translation", &t.times, t.interpolation, "VEC3", three(&t.values)),
            Curve::Scale(t) => ("scale", &t.times, t.interpolation, "VEC3", three(&t.values)),
            Curve::Rotation(t) => {
                let values = t.values.iter().flat_map(|v| v.as_vec4().to_array()).collect();
                ("rotation", &t.times, t.interpolation, "VEC4", values)
            }
        };
        let interpolation = match interpolation {
            Interpolation::Step => "STEP",
            Interpolation::Linear => "LINEAR",
            Interpolation::CubicSpline => "CUBICSPLINE",
        };
        let view = bin.view(bytemuck::cast_slice(times), None);
        let input = bin.accessor(view, FLOAT, "SCALAR", times.len());
        bin.accessors[input]["min"] = json!([times.first()]);
        bin.accessors[input]["max"] = json!([times.last()]);
        let count = values.len() / if kind == "VEC4" { 4 } else { 3 };
        let view = bin.view(bytemuck::cast_slice(&values), None);
        let output = bin.accessor(view, FLOAT, kind, count);
        samplers.push(json!({ "input": input, "output": output, "interpolation": interpolation }));
        let target = json!({ "node": first + channel.node, "path": path });
        channels.push(json!({ "sampler": i, "target": target }));
    }
    if channels.is_empty() { vec![] } else { vec![json!({ "samplers": samplers, "channels": channels })] }
}

#[cfg(test)]
#[path = "export_tests.rs"]
mod tests;
