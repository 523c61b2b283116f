//! Tests of the loader as a whole, on a small file that each of them changes a little.

mod animations;
mod bends;
mod draco;
mod errors;
mod far;
mod features;
mod hostile;
mod khronos;
mod lenient;
mod materials;

use super::*;
use crate::scene::Primitive;
use glam::Mat4;
use serde_json::{Value, json};
use std::path::PathBuf;

/// A file that holds one quad (0..1 in x and y, facing +z) of two triangles: 4 vertices with normals and uvs.
struct File {
    json: Value,
    bin: Vec<u8>,
}

/// Accessors of [`File::quad`].
const POSITIONS: usize = 0;
const INDICES: usize = 3;

impl File {
    fn quad() -> Self {
        let mut file = File {
            json: json!({
                "asset": {"version": "2.0"},
                "scene": 0,
                "scenes": [{"nodes": [0]}],
                "nodes": [{"mesh": 0, "name": "quad"}],
                "meshes": [{"primitives": [{"attributes": {}}]}],
                "buffers": [{}], "bufferViews": [], "accessors": [],
            }),
            bin: Vec::new(),
        };
        file.attribute("POSITION", &floats(&[0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0.]), 5126, "VEC3");
        file.attribute("NORMAL", &floats(&[0., 0., 1., 0., 0., 1., 0., 0., 1., 0., 0., 1.]), 5126, "VEC3");
        file.attribute("TEXCOORD_0", &floats(&[0., 1., 1., 1., 1., 0., 0., 0.]), 5126, "VEC2");
        file.indices(&[0, 1, 2, 0, 2, 3]);
        let bounds = json!({"min": [0, 0, 0], "max": [1, 1, 0]});
        file.json["accessors"][POSITIONS]["min"] = bounds["min"].clone();
        file.json["accessors"][POSITIONS]["max"] = bounds["max"].clone();
        file
    }

    /// Appends bytes, and a view of them; gives its index.
    fn view(&mut self, bytes: &[u8]) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let view = json!({"buffer": 0, "byteOffset": self.bin.len(), "byteLength": bytes.len()});
        self.bin.extend(bytes);
        push(&mut self.json["bufferViews"], view)
    }

    /// Appends an accessor of `kind` ("VEC3") with components of glTF's code `component`; gives its index.
    fn accessor(&mut self, bytes: &[u8], component: u32, kind: &str) -> usize {
        let size = match component {
            5121 => 1,
            5123 => 2,
            _ => 4,
        };
        let components = match kind {
            "SCALAR" => 1,
            "MAT4" => 16,
            _ => kind[3..].parse::<usize>().unwrap(),
        };
        let view = self.view(bytes);
        let count = bytes.len() / (size * components);
        push(
            &mut self.json["accessors"],
            json!({"bufferView": view, "componentType": component, "count": count, "type": kind}),
        )
    }

    /// Adds an attribute to the quad's primitive.
    fn attribute(&mut self, name: &str, bytes: &[u8], component: u32, kind: &str) {
        let accessor = self.accessor(bytes, component, kind);
        self.primitive()["attributes"][name] = json!(accessor);
    }

    /// Gives the quad's primitive these indices (16 bits).
    fn indices(&mut self, indices: &[u16]) {
        let bytes: Vec<u8> = indices.iter().flat_map(|i| i.to_le_bytes()).collect();
        let accessor = self.accessor(&bytes, 5123, "SCALAR");
        self.primitive()["indices"] = json!(accessor);
    }

    fn primitive(&mut self) -> &mut Value {
        &mut self.json["meshes"][0]["primitives"][0]
    }

    /// Adds a texture that reads an image held in the file; gives its index.
    fn texture(&mut self, image: &[u8]) -> usize {
        let view = self.view(image);
        let source = push(&mut self.json["images"], json!({"bufferView": view, "mimeType": "image/png"}));
        push(&mut self.json["textures"], json!({"source": source}))
    }

    /// Adds a material and gives it to the quad.
    fn material(&mut self, material: Value) {
        let index = push(&mut self.json["materials"], material);
        self.primitive()["material"] = json!(index);
    }

    /// As binary glTF.
    fn bytes(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        if json["buffers"][0]["byteLength"].is_null() {
            json["buffers"][0]["byteLength"] = json!(self.bin.len());
        }
        let json = json.to_string().into_bytes();
        let glb = gltf::Glb {
            header: gltf::binary::Header { magic: *b"glTF", version: 2, length: 0 },
            json: json.into(),
            bin: Some((&self.bin).into()),
        };
        glb.to_vec().unwrap()
    }

    fn load(&self) -> Reason<SceneDescription> {
        scene_of(&self.bytes(), Path::new(""))
    }

    /// The quad's primitive as loaded.
    fn primitive_loaded(&self) -> Primitive {
        self.load().unwrap().meshes[0].primitives[0].clone()
    }

    /// The reason why the file can't be loaded; must be one line.
    fn reason(&self) -> String {
        one_line_reason(self.load())
    }
}

fn one_line_reason(loaded: Reason<SceneDescription>) -> String {
    let reason = one_line(&loaded.expect_err("the file should not load"));
    assert!(!reason.is_empty() && !reason.contains('\n'));
    reason
}

/// Appends to a JSON array, which is made if there is none; gives the element's index.
fn push(array: &mut Value, element: Value) -> usize {
    if array.is_null() {
        *array = json!([]);
    }
    let array = array.as_array_mut().unwrap();
    array.push(element);
    array.len() - 1
}

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|x| x.to_le_bytes()).collect()
}

/// A PNG of one RGB texel.
fn png(texel: [u8; 3]) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let (color, format) = (image::ColorType::Rgb8, image::ImageFormat::Png);
    image::write_buffer_with_format(&mut bytes, &texel, 1, 1, color, format).unwrap();
    bytes.into_inner()
}

/// Corners of each triangle, in order.
fn corners(p: &Primitive) -> Vec<[Vec3; 3]> {
    p.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]].map(|i| p.positions[i as usize])).collect()
}

/// A folder for one test's files, removed afterwards.
struct Folder(PathBuf);

impl Folder {
    fn new(test: &str) -> Self {
        let path = std::env::temp_dir().join(format!("candela-{test}-{}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Folder(path)
    }

    fn write(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.0.join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
