//! The container: the bytes of a .gltf or .glb file -> a validated document and its buffers.

use super::{Reason, label, uri};
use gltf::mesh::Semantic;
use gltf::{Document, Gltf};
use std::path::Path;

/// Extensions that are drawn, at least approximately: a file may require them.
pub const SUPPORTED_EXTENSIONS: &[&str] = &[
    "EXT_texture_webp",
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_unlit",
    "KHR_texture_basisu",
    "KHR_texture_transform",
];

/// Parses `bytes` and reads all buffers; external ones are relative to `base`. Each index of the document is in
/// range afterwards, but not yet the bytes that its accessors stand for.
pub fn parse(bytes: &[u8], base: &Path) -> Reason<(Document, Vec<Vec<u8>>)> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    check_container(bytes)?;
    let Gltf { document, blob } = Gltf::from_slice_without_validation(bytes).map_err(describe)?;
    let root = document.into_json();
    check_version(&root.asset)?;
    check_extensions(&root)?;
    check_position_accessors(&root)?;
    check_nodes(&root)?;
    check_animations(&root)?;
    let document = Document::from_json(root).map_err(describe)?;
    let buffers = read_buffers(&document, base, blob)?;
    Ok((document, buffers))
}

/// Tells what is no glTF at all, and catches what the parser takes for granted.
fn check_container(bytes: &[u8]) -> Reason<()> {
    if let Some(header) = bytes.strip_prefix(b"glTF") {
        let length = header.get(4..8).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
        return match length {
            Some(length) if length >= 12 => Ok(()),
            _ => Err("binary glTF with a broken header".into()),
        };
    }
    match bytes.iter().find(|byte| !byte.is_ascii_whitespace()) {
        Some(b'{') => Ok(()),
        _ => Err("no glTF: neither JSON nor binary glTF (wrong magic)".into()),
    }
}

fn check_version(asset: &gltf::json::Asset) -> Reason<()> {
    let version = asset.min_version.as_ref().unwrap_or(&asset.version);
    let known = if asset.min_version.is_some() { version == "2.0" } else { version.starts_with("2.") };
    if known { Ok(()) } else { Err(format!("glTF version {version}; only 2.0 can be read")) }
}

fn check_extensions(root: &gltf::json::Root) -> Reason<()> {
    let unknown: Vec<&str> = root
        .extensions_required
        .iter()
        .map(String::as_str)
        .filter(|name| !SUPPORTED_EXTENSIONS.contains(name))
        .collect();
    if unknown.is_empty() {
        return Ok(());
    }
    Err(format!("requires {}, which is not supported; export the scene without", unknown.join(", ")))
}

/// The validation of the gltf crate looks at the bounds of each POSITION accessor before it has checked its index.
fn check_position_accessors(root: &gltf::json::Root) -> Reason<()> {
    let positions = gltf::json::validation::Checked::Valid(Semantic::Positions);
    for (m, mesh) in root.meshes.iter().enumerate() {
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            if let Some(index) = primitive.attributes.get(&positions)
                && index.value() >= root.accessors.len()
            {
                let (index, count) = (index.value(), root.accessors.len());
                return Err(format!(
                    "meshes[{m}].primitives[{p}]: accessor {index} of {count} does not exist"
                ));
            }
        }
    }
    Ok(())
}

fn exists(what: &str, index: usize, count: usize) -> Reason<()> {
    match index < count {
        true => Ok(()),
        false => Err(format!("{what} {index} of {count} does not exist")),
    }
}

/// The validation of the gltf crate would not say which node it is by name, nor how many there are of what it asks for.
fn check_nodes(root: &gltf::json::Root) -> Reason<()> {
    for (n, node) in root.nodes.iter().enumerate() {
        let mesh = node.mesh.map_or(Ok(()), |mesh| exists("mesh", mesh.value(), root.meshes.len()));
        let camera =
            node.camera.map_or(Ok(()), |camera| exists("camera", camera.value(), root.cameras.len()));
        let mut children = node.children.iter().flatten();
        mesh.and(camera)
            .and_then(|()| {
                children.try_for_each(|child| exists("child node", child.value(), root.nodes.len()))
            })
            .map_err(|reason| format!("{}: {reason}", label("node", n, node.name.as_deref())))?;
    }
    Ok(())
}

/// The validation of the gltf crate does not look at all indices of animations.
fn check_animations(root: &gltf::json::Root) -> Reason<()> {
    for (a, animation) in root.animations.iter().enumerate() {
        for (c, channel) in animation.channels.iter().enumerate() {
            exists("node", channel.target.node.value(), root.nodes.len())
                .and_then(|()| exists("sampler", channel.sampler.value(), animation.samplers.len()))
                .map_err(|reason| format!("animations[{a}].channels[{c}]: {reason}"))?;
        }
        for (s, sampler) in animation.samplers.iter().enumerate() {
            exists("accessor", sampler.input.value(), root.accessors.len())
                .and_then(|()| exists("accessor", sampler.output.value(), root.accessors.len()))
                .map_err(|reason| format!("animations[{a}].samplers[{s}]: {reason}"))?;
        }
    }
    Ok(())
}

fn describe(error: gltf::Error) -> String {
    match error {
        gltf::Error::Deserialize(error) => format!("broken JSON: {error}"),
        gltf::Error::Binary(error) => format!("broken binary glTF: {error}"),
        gltf::Error::Validation(errors) => match errors.as_slice() {
            [] => "invalid glTF".into(),
            [(path, error)] => format!("{path}: {error}"),
            [(path, error), rest @ ..] => format!("{path}: {error} (and {} more faults)", rest.len()),
        },
        other => other.to_string(),
    }
}

fn read_buffers(document: &Document, base: &Path, mut blob: Option<Vec<u8>>) -> Reason<Vec<Vec<u8>>> {
    let mut buffers = Vec::new();
    for buffer in document.buffers() {
        let (data, source) = match buffer.source() {
            gltf::buffer::Source::Bin => {
                (blob.take().ok_or("no uri, and no binary chunk left".to_owned()), String::new())
            }
            gltf::buffer::Source::Uri(uri) => (uri::read(uri, base), format!(" ('{}')", uri::label(uri))),
        };
        let index = buffer.index();
        let mut data = data.map_err(|reason| format!("buffer {index}: {reason}"))?;
        if data.len() < buffer.length() {
            let (has, needs) = (data.len(), buffer.length());
            return Err(format!("buffer {index}{source} is too short: {has} bytes instead of {needs}"));
        }
        // What is behind the declared length (padding) must not be reachable.
        data.truncate(buffer.length());
        buffers.push(data);
    }
    Ok(buffers)
}
