//! Scenes for other programs: a folder with `scene.json` and a PLY file for each shape, as `tools/mitsuba/README.md` lists it.
//!
//! What is written is a [`SceneDescription`], after loading: geometry and lights in world space, metres and photometric
//! units, so that a stranger's renderer starts from what Candela's own passes start from. Alpha is not written;
//! [`left_out`] says so.

use super::export::png;
use super::{
    AlphaMode, Environment, Image, Instance, Material, PanelShape, PlacedLight, Primitive, SceneCamera,
    SceneDescription, Workflow, Wrap,
};
use crate::error::Result;
use crate::image_io;
use glam::Mat3;
use serde_json::{Value, json};
use shared::material::{UvMap, slot};
use std::path::Path;
use std::sync::Arc;

/// Changes when a reader of the old files would misread the new ones.
const VERSION: u32 = 3;

/// Writes `scene` as seen by `camera` into `directory`, which is made if it is not there. `scene.json` is written last, as
/// a whole: a folder with one is complete.
pub fn write(scene: &SceneDescription, camera: &SceneCamera, directory: &Path) -> Result<()> {
    image_io::create_folder(directory)?;
    let mut shapes = Vec::new();
    for instance in &scene.instances {
        for primitive in &scene.meshes[instance.mesh].primitives {
            let file = format!("{:05}.ply", shapes.len());
            image_io::replace(&directory.join(&file), &ply(instance, primitive))?;
            shapes.push(json!({ "name": instance.name, "file": file, "material": primitive.material }));
        }
    }
    let environment = scene.environment.as_ref().map(|map| write_environment(map, directory)).transpose()?;
    let mut root = document(scene, camera);
    root["textures"] = write_textures(scene, directory)?.into();
    root["shapes"] = shapes.into();
    root["environment"] = environment.into();
    image_io::replace(&directory.join("scene.json"), format!("{root:#}\n").as_bytes())
}

/// One line for each kind of thing that the scene has and the files will not.
pub fn left_out(scene: &SceneDescription) -> Vec<String> {
    let count = |has: &dyn Fn(&Material) -> bool| scene.materials.iter().filter(|m| has(m)).count();
    let textured =
        |m: &Material| m.textures().iter().zip(&m.uv_maps).any(|(t, map)| t.is_some() && map.set != 0);
    let second = count(&textured);
    let transparent = count(&|m| m.alpha != AlphaMode::Opaque);
    let unlit = count(&|m| m.unlit);
    let soft = |light: &&PlacedLight| matches!(light, PlacedLight::Spot(spot) if spot.radius > 0.0);
    let soft = scene.lights.iter().filter(soft).count();
    let soft = (soft > 0).then(|| format!("not exported: the radius of {soft} spots"));
    [(second, "a second set of texture coordinates"), (transparent, "transparency"), (unlit, "unlit color")]
        .into_iter()
        .filter(|(materials, _)| *materials > 0)
        .map(|(materials, what)| {
            format!("not exported: {what}, of {materials} of {} materials", scene.materials.len())
        })
        .chain(soft)
        .collect()
}

/// All but the shapes and the environment, which have files of their own.
fn document(scene: &SceneDescription, camera: &SceneCamera) -> Value {
    let [mut points, mut spots, mut directionals, mut panels] = [const { Vec::new() }; 4];
    for light in &scene.lights {
        match light {
            PlacedLight::Point(l) => {
                points.push(json!({
                    "position": l.position.to_array(),
                    "intensity": l.intensity.to_array(),
                    "radius": l.radius,
                }));
            }
            PlacedLight::Spot(l) => spots.push(json!({
                "position": l.position.to_array(),
                "axis": l.axis.to_array(),
                "intensity": l.intensity.to_array(),
                "inner_angle": l.inner_angle,
                "outer_angle": l.outer_angle,
            })),
            PlacedLight::Panel(l) => panels.push(json!({
                "shape": match l.shape {
                    PanelShape::Rectangle => "rectangle",
                    PanelShape::Disk => "disk",
                },
                "position": l.position.to_array(),
                "axis": l.axis.to_array(),
                "up": l.up.to_array(),
                "size": l.size.to_array(),
                "radiance": l.radiance.to_array(),
            })),
            PlacedLight::Directional(l) => directionals.push(
                json!({ "direction": l.direction.to_array(), "illuminance": l.illuminance.to_array() }),
            ),
        }
    }
    json!({
        "format": "candela-scene",
        "version": VERSION,
        "name": scene.name,
        // Where the zero of what follows lies in the world of the scene's file, m.
        "origin": scene.origin.to_array(),
        "camera": {
            "position": camera.position.to_array(),
            "forward": camera.forward.to_array(),
            "up": camera.up.to_array(),
            "fov_y": camera.fov_y,
        },
        "materials": scene.materials.iter().map(material).collect::<Vec<_>>(),
        "point_lights": points,
        "spot_lights": spots,
        "directional_lights": directionals,
        "panel_lights": panels,
    })
}

fn material(material: &Material) -> Value {
    let [base_color, reflectance, normal, emissive] = material.textures();
    let texture = |texture: Option<usize>, slot: usize| {
        let UvMap { u, v, set } = material.uv_maps[slot];
        texture.map(|t| json!({ "texture": t, "u": u.to_array(), "v": v.to_array(), "set": set }))
    };
    json!({
        "base_color_texture": texture(base_color, slot::BASE_COLOR),
        "reflectance_texture": texture(reflectance, slot::REFLECTANCE),
        "normal_texture": texture(normal, slot::NORMAL),
        "normal_scale": material.normal_scale,
        "emissive_texture": texture(emissive, slot::EMISSIVE),
        "name": material.name,
        "workflow": match material.workflow {
            Workflow::MetallicRoughness => "metallic-roughness",
            Workflow::SpecularGlossiness => "specular-glossiness",
        },
        "base_color": material.base_color.truncate().to_array(),
        "metallic": material.metallic,
        "roughness": material.roughness,
        "specular": material.specular.to_array(),
        "emission": material.emission.to_array(),
        "double_sided": material.double_sided,
    })
}

/// A PNG file each image.
fn write_textures(scene: &SceneDescription, directory: &Path) -> Result<Vec<Value>> {
    let mut images: Vec<&Arc<Image>> = Vec::new();
    let mut json = Vec::new();
    for texture in &scene.textures {
        let known = images.iter().position(|image| Arc::ptr_eq(image, &texture.image));
        let file = format!("texture-{:03}.png", known.unwrap_or(images.len()));
        if known.is_none() {
            image_io::replace(&directory.join(&file), &png(&texture.image)?)?;
            images.push(&texture.image);
        }
        let wrap = texture.wrap.map(|wrap| match wrap {
            Wrap::Repeat => "repeat",
            Wrap::MirroredRepeat => "mirrored-repeat",
            Wrap::ClampToEdge => "clamp-to-edge",
        });
        let linear = texture.filter.magnify_linear;
        json.push(json!({ "file": file, "srgb": texture.srgb, "wrap": wrap, "linear": linear }));
    }
    Ok(json)
}

fn write_environment(map: &Environment, directory: &Path) -> Result<Value> {
    image_io::write_exr(&directory.join("environment.exr"), map.size, &map.radiance)?;
    Ok(json!({ "file": "environment.exr", "size": map.size.to_array() }))
}

/// A primitive in world space as binary PLY: x y z, nx ny nz, and u v, r g b where it has them (f32); triangles whose
/// counter-clockwise side is the front.
fn ply(instance: &Instance, primitive: &Primitive) -> Vec<u8> {
    let (uvs, colors) = (&primitive.uvs, &primitive.colors);
    let mut properties = vec!["x", "y", "z", "nx", "ny", "nz"];
    properties.extend(if uvs.is_empty() { &[][..] } else { &["u", "v"] });
    properties.extend(if colors.is_empty() { &[][..] } else { &["r", "g", "b"] });
    let properties: String = properties.iter().map(|name| format!("property float {name}\n")).collect();
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\n{properties}element face {}\n\
         property list uchar int vertex_indices\nend_header\n",
        primitive.positions.len(),
        primitive.indices.len() / 3,
    )
    .into_bytes();

    let linear = Mat3::from(instance.transform.matrix3);
    let (of_normals, mirrored) = (linear.inverse().transpose(), linear.determinant() < 0.0);
    let mut put = |values: &[f32]| bytes.extend(values.iter().flat_map(|x| x.to_le_bytes()));
    for (i, (&position, &normal)) in primitive.positions.iter().zip(&primitive.normals).enumerate() {
        put(&instance.transform.transform_point3(position).to_array());
        put(&(of_normals * normal).normalize_or(normal).to_array());
        if let Some(uv) = uvs.get(i) {
            put(&uv.to_array());
        }
        if let Some(color) = colors.get(i) {
            put(&color.truncate().to_array());
        }
    }
    for t in primitive.indices.chunks_exact(3) {
        // A mirror turns the winding, but the outside stays outside.
        let corners = if mirrored { [t[0], t[2], t[1]] } else { [t[0], t[1], t[2]] };
        bytes.push(3);
        bytes.extend(corners.map(u32::to_le_bytes).concat());
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::fixtures;
    use glam::{UVec2, Vec3};
    use std::path::PathBuf;

    fn folder(name: &str) -> PathBuf {
        std::env::temp_dir().join(format!("candela-export-{name}-{}", std::process::id()))
    }

    fn fixture(name: &str) -> SceneDescription {
        fixtures::all().into_iter().find(|(n, _)| *n == name).unwrap().1
    }

    /// The triangles of a file, read by the text of its header.
    fn triangles(bytes: &[u8]) -> Vec<[(Vec3, Vec3); 3]> {
        let end = bytes.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
        let header = std::str::from_utf8(&bytes[..end]).unwrap();
        let count = |element: &str| -> usize {
            let line = header.lines().find_map(|l| l.strip_prefix(&format!("element {element} ")));
            line.unwrap().parse().unwrap()
        };
        let stride = 4 * header.matches("property float").count();
        let float = |at: usize| f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
        let vector = |at: usize| Vec3::new(float(at), float(at + 4), float(at + 8));
        let vertex = |i: usize| (vector(end + i * stride), vector(end + i * stride + 12));
        let faces = end + count("vertex") * stride;
        assert_eq!(bytes.len(), faces + 13 * count("face"));
        let index = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
        (0..count("face")).map(|f| [1, 5, 9].map(|offset| vertex(index(faces + 13 * f + offset)))).collect()
    }

    /// Under rotation, uneven scale and a mirror: world-space corners, unit normals on the front's side.
    #[test]
    fn shapes_are_in_world_space_and_face_outward() {
        let (scene, folder) = (fixture("instances"), folder("shapes"));
        write(&scene, &scene.cameras[0], &folder).unwrap();
        let mut count = 0;
        for (i, instance) in scene.instances.iter().enumerate() {
            let bytes = std::fs::read(folder.join(format!("{i:05}.ply"))).unwrap();
            let primitive = &scene.meshes[instance.mesh].primitives[0];
            for (triangle, t) in triangles(&bytes).iter().zip(primitive.indices.chunks_exact(3)) {
                let [a, b, c] = triangle.map(|(position, _)| position);
                let front = (b - a).cross(c - a).normalize();
                assert_eq!(
                    a,
                    instance.transform.transform_point3(primitive.positions[t[0] as usize]),
                    "{}",
                    instance.name
                );
                for (_, normal) in triangle {
                    assert!(
                        (normal.length() - 1.0).abs() < 1e-5 && front.dot(*normal) > 0.99,
                        "{front} {normal}"
                    );
                }
                count += 1;
            }
        }
        std::fs::remove_dir_all(&folder).unwrap();
        assert_eq!(count, scene.triangle_count());
    }

    #[test]
    fn the_document_names_every_light_and_file() {
        let mut scene = fixture("cornell-box");
        let radiance: Vec<Vec3> = (0..8).map(|i| Vec3::new(i as f32, 0.5, 2e4)).collect();
        let map = Environment { size: UVec2::new(4, 2), radiance };
        scene.environment = Some(map.clone());
        scene.lights = fixture("point-lights").lights;
        let folder = folder("document");
        // Twice: an old export is replaced.
        write(&fixture("instances"), &scene.cameras[0], &folder).unwrap();
        write(&scene, &scene.cameras[0], &folder).unwrap();
        let text = std::fs::read_to_string(folder.join("scene.json")).unwrap();
        let root: Value = serde_json::from_str(&text).unwrap();
        let read = image_io::read_exr(&folder.join(root["environment"]["file"].as_str().unwrap())).unwrap();
        assert_eq!(read, (map.size, map.radiance));
        for shape in root["shapes"].as_array().unwrap() {
            assert!(folder.join(shape["file"].as_str().unwrap()).is_file());
        }
        std::fs::remove_dir_all(&folder).unwrap();
        let vector = |value: &Value| -> Vec<f32> { serde_json::from_value(value.clone()).unwrap() };
        for (written, light) in root["point_lights"].as_array().unwrap().iter().zip(&scene.lights) {
            let PlacedLight::Point(light) = light else { panic!("{light:?}") };
            assert_eq!(vector(&written["position"]), light.position.to_array());
            assert_eq!(vector(&written["intensity"]), light.intensity.to_array());
        }
        assert_eq!(root["point_lights"].as_array().unwrap().len(), 25);
        let lamp = &root["materials"][root["shapes"][5]["material"].as_u64().unwrap() as usize];
        assert_eq!(
            (&lamp["name"], vector(&lamp["emission"])),
            (&json!("lamp"), vec![5000.0, 3600.0, 1900.0])
        );
        assert_eq!(vector(&root["camera"]["forward"]), scene.cameras[0].forward.to_array());
    }

    #[test]
    fn what_is_left_out_is_said() {
        let mut scene = fixture("cornell-box");
        assert!(left_out(&scene).is_empty());
        scene.materials[1].base_color_texture = Some(0);
        assert!(left_out(&scene).is_empty(), "textures are exported");
        scene.materials[1].uv_maps[slot::BASE_COLOR].set = 1;
        scene.materials[2].alpha = AlphaMode::Blend;
        let lines = left_out(&scene);
        assert_eq!(
            lines,
            [
                "not exported: a second set of texture coordinates, of 1 of 8 materials",
                "not exported: transparency, of 1 of 8 materials"
            ]
        );
        // A directory can't be made under a file.
        let below = Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml/below");
        let error = write(&scene, &scene.cameras[0], &below).unwrap_err().to_string();
        assert!(error.contains("below: can't write"), "{error}");
    }
}
