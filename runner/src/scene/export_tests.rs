//! The oracle is the `gltf` crate: its validation and its reading of the bytes.

use super::*;
use crate::scene::Filter;
use crate::scene::PointLight;
use crate::scene::procedural::atrium::atrium;
use glam::{Affine3A, Quat, Vec2, Vec4};

/// One of everything that a scene can have.
fn small_scene() -> SceneDescription {
    let texels = vec![9, 8, 7, 255, 1, 2, 3, 4];
    let image = Arc::new(Image { name: "two texels".into(), width: 2, height: 1, texels });
    let texture = |srgb, wrap| Texture {
        image: image.clone(),
        srgb,
        wrap,
        filter: if srgb { Filter::LINEAR } else { Filter::NEAREST },
    };
    let primitive = Primitive {
        material: 0,
        positions: vec![Vec3::new(0.1, 0.2, 0.3), Vec3::new(1.5, 0.0, -2.0), Vec3::Y],
        normals: vec![Vec3::Z; 3],
        tangents: vec![Vec4::new(1.0, 0.0, 0.0, -1.0); 3],
        uvs: vec![Vec2::ZERO, Vec2::new(3.0, -0.25), Vec2::Y],
        colors: vec![Vec4::new(0.1, 0.2, 0.3, 1.0); 3],
        indices: vec![2, 0, 1],
        ..Primitive::default()
    };
    let mirror = Affine3A::from_scale_rotation_translation(
        Vec3::new(-1.0, 2.0, 0.5),
        Quat::from_rotation_x(0.3),
        Vec3::new(4.0, 5.0, 6.0),
    );
    SceneDescription {
        name: "small".into(),
        meshes: vec![Mesh { name: "triangle".into(), primitives: vec![primitive] }],
        instances: vec![Instance { name: "mirrored".into(), mesh: 0, transform: mirror }],
        materials: vec![Material {
            name: "all".into(),
            base_color: Vec4::new(0.25, 0.5, 0.75, 1.0),
            base_color_texture: Some(0),
            reflectance_texture: Some(1),
            normal_texture: Some(1),
            normal_scale: 0.5,
            emission: Vec3::new(100.0, 50.0, 0.0),
            emissive_texture: Some(0),
            metallic: 0.125,
            roughness: 0.375,
            double_sided: true,
            ..Material::default()
        }],
        textures: vec![
            texture(true, [Wrap::Repeat, Wrap::MirroredRepeat]),
            texture(false, [Wrap::ClampToEdge; 2]),
        ],
        lights: vec![
            PointLight {
                position: Vec3::new(1.0, 2.0, 3.0),
                intensity: Vec3::new(8.0, 2.0, 4.0),
                radius: 0.0,
            }
            .into(),
        ],
        cameras: vec![SceneCamera {
            name: "eye".into(),
            position: Vec3::new(0.0, 1.0, 5.0),
            forward: Vec3::new(0.6, 0.0, -0.8),
            up: Vec3::Y,
            fov_y: 0.75,
        }],
        warnings: Vec::new(),
        ..SceneDescription::default()
    }
}

fn world(node: &gltf::Node) -> Mat4 {
    Mat4::from_cols_array_2d(&node.transform().matrix())
}

#[test]
fn lights_of_all_kinds_survive() {
    use crate::scene::{DirectionalLight, PanelLight, PanelShape, SpotLight};
    let axis = Vec3::new(0.36, -0.48, 0.8);
    let up = Vec3::Y.reject_from_normalized(axis).normalize();
    let panel = |shape, size| PanelLight {
        position: Vec3::ONE,
        axis,
        up,
        size,
        shape,
        radiance: Vec3::new(9.0, 6.0, 3.0),
    };
    let [position, intensity] = [Vec3::X, Vec3::new(8.0, 4.0, 2.0)];
    let (inner_angle, outer_angle) = (0.25, 0.5);
    let lights: Vec<PlacedLight> = vec![
        PointLight { position, intensity, radius: 0.25 }.into(),
        panel(PanelShape::Rectangle, glam::Vec2::new(1.5, 0.5)).into(),
        SpotLight { position, axis, intensity, inner_angle, outer_angle, radius: 0.125 }.into(),
        panel(PanelShape::Disk, glam::Vec2::splat(0.5)).into(),
        DirectionalLight { direction: -axis, illuminance: intensity }.into(),
        SpotLight { position, axis, intensity, inner_angle, outer_angle, radius: 0.0 }.into(),
    ];
    let scene = SceneDescription { lights: lights.clone(), ..small_scene() };
    let folder = std::env::temp_dir().join(format!("candela-lights-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("lights.glb");
    std::fs::write(&path, to_glb(&scene).unwrap()).unwrap();
    let read = crate::scene::gltf::load(&path).unwrap().lights;
    std::fs::remove_dir_all(&folder).unwrap();
    assert_eq!(read.len(), lights.len());
    for (read, written) in read.iter().zip(&lights) {
        let [read, written] = [read, written].map(|light| light.light(|| 1.0));
        assert_eq!(read.kind, written.kind);
        let near = |a: Vec3, b: Vec3| (a - b).length() < 1e-5 * (1.0 + b.length());
        let pairs = [
            (read.position, written.position),
            (read.emission, written.emission),
            (read.edge1, written.edge1),
            (read.edge2, written.edge2),
        ];
        assert!(pairs.iter().all(|&(a, b)| near(a, b)), "{read:?} instead of {written:?}");
        assert!((read.area - written.area).abs() < 1e-5);
    }
}

#[test]
fn geometry_survives() {
    let scene = small_scene();
    let (document, buffers, _) = gltf::import_slice(to_glb(&scene).unwrap()).unwrap();
    let node = document.nodes().find(|node| node.mesh().is_some()).unwrap();
    assert_eq!(world(&node), Mat4::from(scene.instances[0].transform));
    let read_primitive = node.mesh().unwrap().primitives().next().unwrap();
    let reader = read_primitive.reader(|buffer| Some(&buffers[buffer.index()]));
    let original = &scene.meshes[0].primitives[0];
    let positions: Vec<Vec3> = reader.read_positions().unwrap().map(Vec3::from).collect();
    assert_eq!(positions, original.positions);
    let normals: Vec<Vec3> = reader.read_normals().unwrap().map(Vec3::from).collect();
    assert_eq!(normals, original.normals);
    let tangents: Vec<Vec4> = reader.read_tangents().unwrap().map(Vec4::from).collect();
    assert_eq!(tangents, original.tangents);
    let uvs: Vec<Vec2> = reader.read_tex_coords(0).unwrap().into_f32().map(Vec2::from).collect();
    assert_eq!(uvs, original.uvs);
    let colors: Vec<Vec4> = reader.read_colors(0).unwrap().into_rgba_f32().map(Vec4::from).collect();
    assert_eq!(colors, original.colors);
    assert_eq!(reader.read_indices().unwrap().into_u32().collect::<Vec<_>>(), original.indices);
    let bounds = read_primitive.bounding_box();
    assert_eq!((bounds.min, bounds.max), ([0.0, 0.0, -2.0], [1.5, 1.0, 0.3]));
}

#[test]
fn materials_lights_and_cameras_survive() {
    let (document, _, images) = gltf::import_slice(to_glb(&small_scene()).unwrap()).unwrap();
    let material = document.materials().next().unwrap();
    let pbr = material.pbr_metallic_roughness();
    assert_eq!(pbr.base_color_factor(), [0.25, 0.5, 0.75, 1.0]);
    assert_eq!((pbr.metallic_factor(), pbr.roughness_factor()), (0.125, 0.375));
    assert_eq!(pbr.base_color_texture().unwrap().texture().index(), 0);
    assert_eq!(pbr.metallic_roughness_texture().unwrap().texture().index(), 1);
    assert_eq!(material.normal_texture().unwrap().scale(), 0.5);
    assert!(material.double_sided() && material.emissive_texture().is_some());
    let emission = Vec3::from(material.emissive_factor()) * material.emissive_strength().unwrap();
    assert_eq!(emission, Vec3::new(100.0, 50.0, 0.0));

    assert_eq!(images.len(), 1, "shared by both textures");
    assert_eq!(images[0].pixels, [9, 8, 7, 255, 1, 2, 3, 4]);
    let samplers: Vec<_> =
        document.textures().map(|t| (t.sampler().wrap_s(), t.sampler().wrap_t())).collect();
    use gltf::texture::WrappingMode::{ClampToEdge, MirroredRepeat, Repeat};
    assert_eq!(samplers, [(Repeat, MirroredRepeat), (ClampToEdge, ClampToEdge)]);

    let lamp = document.nodes().find(|node| node.light().is_some()).unwrap();
    let light = lamp.light().unwrap();
    assert_eq!(Vec3::from(light.color()) * light.intensity(), Vec3::new(8.0, 2.0, 4.0));
    assert_eq!(world(&lamp).w_axis.truncate(), Vec3::new(1.0, 2.0, 3.0));

    let eye = document.nodes().find(|node| node.camera().is_some()).unwrap();
    assert!(world(&eye).transform_vector3(Vec3::NEG_Z).abs_diff_eq(Vec3::new(0.6, 0.0, -0.8), 1e-6));
    assert!(world(&eye).transform_vector3(Vec3::Y).abs_diff_eq(Vec3::Y, 1e-6));
    let camera = eye.camera().unwrap();
    let gltf::camera::Projection::Perspective(lens) = camera.projection() else { panic!("orthographic") };
    assert_eq!(lens.yfov(), 0.75);
}

#[test]
fn two_files_hold_the_same_as_one() {
    let (text, bin) = to_gltf(&small_scene(), "small.bin").unwrap();
    let parsed = gltf::Gltf::from_slice(text.as_bytes()).unwrap();
    let buffer = parsed.buffers().next().unwrap();
    assert!(matches!(buffer.source(), gltf::buffer::Source::Uri("small.bin")));
    assert_eq!(buffer.length(), bin.len());
    let glb = gltf::Glb::from_slice(&to_glb(&small_scene()).unwrap()).unwrap().bin.unwrap().into_owned();
    assert_eq!(glb[..bin.len()], bin);
}

#[test]
fn the_atrium_can_be_exported() {
    let scene = atrium(20);
    let (document, buffers, images) = gltf::import_slice(to_glb(&scene).unwrap()).unwrap();
    let mut triangles = 0;
    for mesh in document.nodes().filter_map(|node| node.mesh()) {
        for primitive in mesh.primitives() {
            let reader = primitive.reader(|buffer| Some(&buffers[buffer.index()]));
            triangles += reader.read_indices().unwrap().into_u32().count() / 3;
        }
    }
    assert_eq!(triangles, scene.triangle_count());
    assert_eq!(document.lights().unwrap().len(), 20);
    assert_eq!((document.materials().len(), images.len()), (scene.materials.len(), scene.textures.len()));
}

#[test]
fn an_empty_scene_is_a_file_too() {
    let glb = to_glb(&SceneDescription::default()).unwrap();
    assert_eq!(gltf::Gltf::from_slice(&glb).unwrap().nodes().len(), 0);
}

#[test]
fn a_texture_of_the_wrong_size_is_an_error() {
    let mut scene = small_scene();
    let short = Image { name: "short".into(), width: 2, height: 2, texels: vec![0; 12] };
    scene.textures[1].image = Arc::new(short);
    assert!(to_glb(&scene).unwrap_err().to_string().contains("'short'"));
}
