//! Copies of a node's mesh (EXT_mesh_gpu_instancing).

use super::accessors::{self, Integers};
use super::{Reason, label};
use glam::{DAffine3, DQuat, DVec3};
use gltf::accessor::Dimensions;
use gltf::{Document, Node};
use serde_json::Value;

/// Where the copies of the mesh of `node` stand relative to it: one, at its place, without the extension. Errors: an
/// attribute that is broken, or of another length than the others.
pub fn copies(document: &Document, node: &Node, buffers: &[Vec<u8>]) -> Reason<Vec<DAffine3>> {
    let Some(extension) = node.extension_value("EXT_mesh_gpu_instancing") else {
        return Ok(vec![DAffine3::IDENTITY]);
    };
    let named = |error: String| {
        format!("{}: EXT_mesh_gpu_instancing: {error}", label("node", node.index(), node.name()))
    };
    let accessor = |name: &str| {
        let index = extension.get("attributes")?.get(name).and_then(Value::as_u64)?;
        document.accessors().nth(usize::try_from(index).ok()?)
    };
    let vectors = |name: &str| {
        let read =
            |accessor| accessors::floats::<3>(&accessor, &[Dimensions::Vec3], Integers::AsDeclared, buffers);
        accessor(name).map(read).transpose().map_err(|reason| named(format!("{name}: {reason}")))
    };
    let (translations, scales) = (vectors("TRANSLATION")?, vectors("SCALE")?);
    let read =
        |accessor| accessors::floats::<4>(&accessor, &[Dimensions::Vec4], Integers::Normalized, buffers);
    let rotations =
        accessor("ROTATION").map(read).transpose().map_err(|reason| named(format!("ROTATION: {reason}")))?;
    let lengths = [
        translations.as_ref().map(Vec::len),
        scales.as_ref().map(Vec::len),
        rotations.as_ref().map(Vec::len),
    ];
    let mut lengths = lengths.into_iter().flatten();
    let Some(count) = lengths.next() else { return Ok(vec![DAffine3::IDENTITY]) };
    if lengths.any(|length| length != count) {
        return Err(named("its attributes have different numbers of elements".into()));
    }
    let vector = |list: &Option<Vec<[f32; 3]>>, i: usize| {
        list.as_ref().map(|list| DVec3::from(list[i].map(f64::from)))
    };
    let copy = |i: usize| {
        let rotation = rotations.as_ref().map(|list| DQuat::from_array(list[i].map(f64::from)));
        // Without a length it has no direction: not turned.
        let rotation = rotation.map_or(DQuat::IDENTITY, |q| {
            if q.length_squared() > 0.0 { q.normalize() } else { DQuat::IDENTITY }
        });
        let scale = vector(&scales, i).unwrap_or(DVec3::ONE);
        DAffine3::from_scale_rotation_translation(
            scale,
            rotation,
            vector(&translations, i).unwrap_or_default(),
        )
    };
    let copies: Vec<DAffine3> = (0..count).map(copy).collect();
    match copies.iter().position(|copy| !copy.is_finite()) {
        Some(i) => Err(named(format!("copy {i} has no finite transform"))),
        None => Ok(copies),
    }
}
