//! The bytes of a .gltf or .glb file -> a valid document, and its buffers.

use super::shape::{Kind, Mender, Shape};
use super::warnings::Warnings;
use super::{Reason, compressed, container, extensions, schema, uri};
use gltf::Document;
use serde_json::{Map, Value, json};
use std::collections::{HashMap, HashSet};
use std::path::Path;

/// What a file holds.
pub struct Parsed {
    /// Each index is in range, each code is known; what its accessors ask of the bytes is not checked.
    pub document: Document,
    pub buffers: Vec<Vec<u8>>,
    /// Nodes that can't be drawn, by index, each with a reason.
    pub broken_nodes: HashMap<usize, String>,
    /// Integers may stand for coordinates (KHR_mesh_quantization).
    pub quantized: bool,
}

/// Parses `bytes` and reads the buffers that are used; external ones are relative to `base`.
pub fn parse(bytes: &[u8], base: &Path, warnings: &mut Warnings) -> Reason<Parsed> {
    let (mut json, chunk) = container::open(bytes)?;
    let [used, required] = ["extensionsUsed", "extensionsRequired"].map(|name| names(&json[name]));
    extensions::check(&used, &required, warnings)?;
    let mut mender = Mender::new(warnings);
    let mut root = Map::new();
    root.insert("asset".into(), json!({"version": "2.0"}));
    for (kind, name, _) in TABLES {
        mender.count(kind, table(&mut json, name).and_then(|list| list.as_array()).map_or(0, Vec::len));
    }
    let (mut buffers, mut broken_views) = (Vec::new(), HashMap::new());
    for (kind, name, shape) in TABLES {
        let Some(mut list) = table(&mut json, name).map(Value::take).filter(|list| !list.is_null()) else {
            continue;
        };
        if let Err(reason) = mender.mend(&mut list, &Shape::Table(kind, shape), name) {
            mender.ignore(&format!("{name}: {reason}"));
            continue;
        }
        match kind {
            Kind::Buffer => {
                buffers = read_buffers(&list, &json["bufferViews"], base, chunk, &mut mender);
                broken_views =
                    compressed::decode(&mut json["bufferViews"], &mut list, &mut buffers, &mut mender);
                mender.recount(Kind::Buffer, buffers.len());
            }
            Kind::View => {
                check_views(root.get("buffers"), &list, &buffers, &mut mender);
                broken_views.drain().for_each(|(i, reason)| mender.mark(Kind::View, i, reason));
            }
            Kind::Scene => root.extend(scene(&json, &list, &mut mender)?),
            _ => {}
        }
        match kind {
            Kind::Light | Kind::Panel => {
                let extension = if kind == Kind::Light { PUNCTUAL } else { AREA };
                let extensions = root.entry("extensions").or_insert_with(|| json!({}));
                extensions[extension] = json!({"lights": list});
            }
            _ => _ = root.insert(name.into(), list),
        }
    }
    let broken_nodes = mender.broken(Kind::Node);
    add_scene(&mut root, warnings);
    let root =
        serde_json::from_value(Value::Object(root)).map_err(|error| format!("broken JSON: {error}"))?;
    let document = Document::from_json_without_validation(root);
    let quantized = used.iter().chain(&required).any(|name| name == "KHR_mesh_quantization");
    Ok(Parsed { document, buffers, broken_nodes, quantized })
}

/// The extensions that list lights.
const PUNCTUAL: &str = "KHR_lights_punctual";
const AREA: &str = "EXT_lights_area";

/// The lists of things; each kind comes after those that it names.
const TABLES: [(Kind, &str, &Shape); 15] = [
    (Kind::Buffer, "buffers", &schema::BUFFER),
    (Kind::View, "bufferViews", &schema::VIEW),
    (Kind::Accessor, "accessors", &schema::ACCESSOR),
    (Kind::Image, "images", &schema::IMAGE),
    (Kind::Sampler, "samplers", &schema::SAMPLER),
    (Kind::Texture, "textures", &schema::TEXTURE),
    (Kind::Material, "materials", &schema::MATERIAL),
    (Kind::Camera, "cameras", &schema::CAMERA),
    (Kind::Light, "lights", &schema::LIGHT),
    (Kind::Panel, "area lights", &schema::PANEL),
    (Kind::Mesh, "meshes", &schema::MESH),
    (Kind::Skin, "skins", &schema::SKIN),
    (Kind::Node, "nodes", &schema::NODE),
    (Kind::Scene, "scenes", &schema::SCENE),
    (Kind::Animation, "animations", &schema::ANIMATION),
];

fn table<'j>(json: &'j mut Value, name: &str) -> Option<&'j mut Value> {
    match name {
        "lights" => json.get_mut("extensions")?.get_mut(PUNCTUAL)?.get_mut(name),
        "area lights" => json.get_mut("extensions")?.get_mut(AREA)?.get_mut("lights"),
        _ => json.get_mut(name),
    }
}

fn names(list: &Value) -> Vec<String> {
    list.as_array().into_iter().flatten().filter_map(Value::as_str).map(str::to_owned).collect()
}

/// The property that names the scene that is drawn: by default the first. Error: it is broken.
fn scene(json: &Value, scenes: &Value, mender: &mut Mender) -> Reason<Option<(String, Value)>> {
    if scenes.as_array().is_none_or(Vec::is_empty) {
        return Ok(None);
    }
    let mut index = json.get("scene").cloned().filter(|scene| !scene.is_null()).unwrap_or(json!(0));
    mender.mend(&mut index, &Shape::Index(Kind::Scene), "scene")?;
    Ok(Some(("scene".into(), index)))
}

/// A file without scenes is a library: gives it one of all its nodes that have no parent.
fn add_scene(root: &mut Map<String, Value>, warnings: &mut Warnings) {
    let nodes = root.get("nodes").and_then(Value::as_array);
    let scenes = root.get("scenes").and_then(Value::as_array);
    let (Some(nodes), true) = (nodes, scenes.is_none_or(Vec::is_empty)) else { return };
    let children = nodes.iter().filter_map(|node| node.get("children")?.as_array()).flatten();
    let children: HashSet<u64> = children.filter_map(Value::as_u64).collect();
    let parentless: Vec<u64> = (0..nodes.len() as u64).filter(|node| !children.contains(node)).collect();
    warnings.add("the file has no scene: all of its nodes are drawn", &format!("{} nodes", nodes.len()));
    root.insert("scenes".into(), json!([{"nodes": parentless}]));
}

/// The bytes of those buffers that a view looks at; the others are empty.
fn read_buffers(
    list: &Value,
    views: &Value,
    base: &Path,
    mut chunk: Option<&[u8]>,
    mender: &mut Mender,
) -> Vec<Vec<u8>> {
    // Views are not mended yet: what is no number names no buffer.
    let buffer = |view: &Value| compressed::of(view).unwrap_or(view).get("buffer")?.as_f64();
    let used: HashSet<u64> = elements(views).iter().filter_map(buffer).map(|n| n as u64).collect();
    let mut buffers = Vec::new();
    for (i, buffer) in elements(list).iter().enumerate() {
        let uri = buffer.get("uri").and_then(Value::as_str);
        let data = match uri {
            _ if !used.contains(&(i as u64)) => Ok(Vec::new()),
            Some(uri) => uri::read(uri, base),
            None => chunk.take().map(<[u8]>::to_vec).ok_or("no uri, and no binary chunk left".to_owned()),
        };
        let mut data = data.unwrap_or_else(|reason| {
            mender.mark(Kind::Buffer, i, reason);
            Vec::new()
        });
        // What is behind the declared length (padding) must not be reachable.
        data.truncate(usize::try_from(number(buffer, "byteLength")).unwrap_or(usize::MAX));
        buffers.push(data);
    }
    buffers
}

/// Each view must lie inside of its buffer.
fn check_views(list: Option<&Value>, views: &Value, buffers: &[Vec<u8>], mender: &mut Mender) {
    for (i, view) in elements(views).iter().enumerate() {
        let buffer = number(view, "buffer") as usize;
        let end = number(view, "byteOffset").checked_add(number(view, "byteLength"));
        let has = buffers.get(buffer).map_or(0, Vec::len) as u64;
        if end.is_none_or(|end| end > has) {
            let buffer_json = list.and_then(|list| list.get(buffer)).unwrap_or(&Value::Null);
            let source =
                buffer_json.get("uri").and_then(Value::as_str).map(|uri| format!(" ('{}')", uri::label(uri)));
            let source = source.unwrap_or_default();
            let needs = number(buffer_json, "byteLength");
            let short = if needs > has {
                format!(", which is too short: {has} bytes instead of {needs}")
            } else {
                String::new()
            };
            mender.mark(
                Kind::View,
                i,
                format!("it reaches past buffer {buffer}{source} of {has} bytes{short}"),
            );
        }
    }
}

fn elements(list: &Value) -> &[Value] {
    list.as_array().map_or(&[], Vec::as_slice)
}

/// A whole number, 0 if it is missing.
fn number(object: &Value, name: &str) -> u64 {
    object.get(name).and_then(Value::as_u64).unwrap_or_default()
}
