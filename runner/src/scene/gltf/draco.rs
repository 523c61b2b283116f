//! Compressed primitives (KHR_draco_mesh_compression).

use super::{Reason, accessors};
use draco_core::{DecodeLimits, DecoderBuffer, Mesh, MeshDecoder};
use gltf::accessor::DataType;
use gltf::mesh::Semantic;
use gltf::{Document, Primitive};
use serde_json::Value;

/// Bytes of vertices that one primitive may decode to: a stream of some kB can ask for any number.
const MAX_DECODED: u64 = 1 << 31;

/// A decoded primitive.
pub struct Decoded {
    mesh: Mesh,
    /// Attributes by their names in glTF, and their places in the mesh.
    attributes: Value,
}

/// Decodes `primitive`; none if it is not compressed. Errors: a broken stream, or one without a bound that is kept.
pub fn decode(document: &Document, primitive: &Primitive, buffers: &[Vec<u8>]) -> Reason<Option<Decoded>> {
    let Some(extension) = primitive.extension_value("KHR_draco_mesh_compression") else { return Ok(None) };
    let view =
        extension.get("bufferView").and_then(Value::as_u64).and_then(|view| usize::try_from(view).ok());
    let view = view.and_then(|view| document.views().nth(view)).ok_or("Draco: it has no buffer view")?;
    let limits = DecodeLimits::default().with_max_decoded_bytes(MAX_DECODED);
    let mut stream = DecoderBuffer::new(accessors::bytes_of(&view, buffers)?).with_limits(limits);
    let mut mesh = Mesh::new();
    MeshDecoder::new().decode(&mut stream, &mut mesh).map_err(|error| format!("Draco: {error}"))?;
    let attributes = extension.get("attributes").cloned().unwrap_or_default();
    Ok(Some(Decoded { mesh, attributes }))
}

impl Decoded {
    /// Corners of the triangles.
    pub fn indices(&self) -> Vec<u32> {
        self.mesh.faces().iter().flatten().map(|point| point.0).collect()
    }

    /// An attribute as [`accessors::floats`] gives it; none if it is not among those that are compressed. `accessor` says
    /// what its integers stand for.
    pub fn floats<const N: usize>(
        &self,
        semantic: &Semantic,
        accessor: &gltf::Accessor,
        normalized: bool,
    ) -> Option<Reason<Vec<[f32; N]>>> {
        let id = self.attributes.get(semantic.to_string())?.as_u64()?;
        let attribute = u32::try_from(id).ok().and_then(|id| self.mesh.attribute_by_unique_id(id));
        let Some(attribute) = attribute else {
            return Some(Err(format!("Draco: attribute {id} does not exist")));
        };
        let components = usize::from(attribute.num_components()).min(N);
        if components == 0 {
            return Some(Err(format!("Draco: attribute {id} is empty")));
        }
        let most = match accessor.data_type() {
            DataType::I8 => 127.0,
            DataType::U8 => 255.0,
            DataType::I16 => 32767.0,
            DataType::U16 => 65535.0,
            _ => 1.0,
        };
        let scale = if normalized { 1.0 / most } else { 1.0 };
        let values = attribute.read_f32s(self.mesh.num_points(), components);
        let element = |values: &[f32]| {
            let mut element = [1.0; N];
            element.iter_mut().zip(values).for_each(|(x, value)| *x = value * scale);
            element
        };
        Some(Ok(values.chunks_exact(components).map(element).collect()))
    }
}
