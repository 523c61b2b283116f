//! Geometry and hierarchy that must arrive as the file means it.

use super::*;
use glam::{Vec2, Vec4};

/// Object-space (1, 1, 0) of the quad, where instance `i` puts it.
fn far_corner(scene: &SceneDescription, i: usize) -> Vec3 {
    scene.instances[i].transform.transform_point3(Vec3::new(1.0, 1.0, 0.0))
}

#[test]
fn a_quad_is_loaded_whole() {
    let scene = File::quad().load().unwrap();
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    assert_eq!((scene.meshes.len(), scene.instances.len(), scene.triangle_count()), (1, 1, 2));
    assert_eq!(scene.instances[0].name, "quad");
    let p = &scene.meshes[0].primitives[0];
    let [a, b, c, d] = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y];
    assert_eq!(corners(p), [[a, b, c], [a, c, d]]);
    assert_eq!((&p.normals, &p.uvs), (&vec![Vec3::Z; 4], &vec![Vec2::Y, Vec2::ONE, Vec2::X, Vec2::ZERO]));
    assert!(p.tangents.is_empty() && p.colors.is_empty());
}

#[test]
fn transforms_compose_from_the_root() {
    let mut file = File::quad();
    let half = std::f32::consts::FRAC_1_SQRT_2;
    file.json["scenes"][0]["nodes"] = json!([1]);
    file.json["nodes"] = json!([
        {"mesh": 0, "scale": [2, 3, 1]},
        // A quarter turn about z; the quaternion's length must not matter.
        {"children": [0, 2], "rotation": [0, 0, 2.0 * half, 2.0 * half], "translation": [10, 0, 0]},
        {"mesh": 0, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,5,1]},
        // Not in the scene.
        {"mesh": 0},
    ]);
    let scene = file.load().unwrap();
    assert_eq!((scene.meshes.len(), scene.instances.len()), (1, 2), "the mesh is shared");
    assert!((far_corner(&scene, 0) - Vec3::new(7.0, 2.0, 0.0)).length() < 1e-5);
    assert!((far_corner(&scene, 1) - Vec3::new(9.0, 1.0, 5.0)).length() < 1e-5);
    assert_eq!(scene.triangle_count(), 4);
}

#[test]
fn negative_scales_mirror() {
    let mut file = File::quad();
    file.json["nodes"][0]["scale"] = json!([-1, 1, 1]);
    let scene = file.load().unwrap();
    assert_eq!(far_corner(&scene, 0), Vec3::new(-1.0, 1.0, 0.0));
    assert!(scene.instances[0].transform.matrix3.determinant() < 0.0);
}

#[test]
fn nodes_scaled_to_nothing_are_left_out() {
    let mut file = File::quad();
    file.json["scenes"][0]["nodes"] = json!([0, 1]);
    push(&mut file.json["nodes"], json!({"mesh": 0, "scale": [0, 0, 1], "name": "hidden"}));
    let scene = file.load().unwrap();
    assert_eq!(scene.instances.len(), 1);
    assert_eq!(scene.warnings, ["left out: its scale is 0: node 1 'hidden'"]);
}

#[test]
fn deep_hierarchies_neither_overflow_nor_drift() {
    let mut file = File::quad();
    let deep = 100_000;
    let step = |i: usize| json!({"children": [i + 1], "translation": [0.1, 0, 0]});
    let mut nodes: Vec<Value> = (0..deep).map(step).collect();
    nodes.push(json!({"mesh": 0}));
    file.json["nodes"] = json!(nodes);
    let scene = file.load().unwrap();
    let x = scene.origin.x + f64::from(far_corner(&scene, 0).x);
    // Summed in f32, 10 000 m would be off by metres.
    assert!((x - 10_001.0).abs() < 0.01, "{x}");
}

#[test]
fn topologies_give_the_same_triangles() {
    let expected = corners(&File::quad().primitive_loaded());
    let mut fan = File::quad();
    fan.indices(&[0, 1, 2, 3]);
    fan.primitive()["mode"] = json!(6);
    // A fan ends its triangles with the hub; turned by one they are the same.
    let turned: Vec<_> = corners(&fan.primitive_loaded()).iter().map(|&[a, b, c]| [c, a, b]).collect();
    assert_eq!(turned, expected);
    let mut strip = File::quad();
    strip.indices(&[1, 2, 0, 3]);
    strip.primitive()["mode"] = json!(5);
    let normals =
        corners(&strip.primitive_loaded()).iter().map(|[a, b, c]| (b - a).cross(c - a)).collect::<Vec<_>>();
    assert_eq!(normals, [Vec3::Z; 2]);
    let mut unindexed = File::quad();
    unindexed.primitive()["indices"] = Value::Null;
    unindexed.primitive()["mode"] = json!(6);
    let turned: Vec<_> = corners(&unindexed.primitive_loaded()).iter().map(|&[a, b, c]| [c, a, b]).collect();
    assert_eq!(turned, expected);
}

#[test]
fn points_and_degenerate_triangles_are_left_out() {
    let mut file = File::quad();
    file.indices(&[0, 1, 2, 3, 3, 1, 2, 2, 2]);
    let mut points = file.primitive().clone();
    points["mode"] = json!(0);
    push(&mut file.json["meshes"][0]["primitives"], points);
    let scene = file.load().unwrap();
    assert_eq!((scene.triangle_count(), scene.meshes[0].primitives.len()), (1, 1));
    assert_eq!(
        scene.warnings,
        [
            "2 triangles without an area are left out: mesh 0, primitive 0",
            "points and lines are left out: mesh 0, primitive 1"
        ]
    );
}

#[test]
fn missing_normals_are_flat_and_void_the_tangents() {
    let mut file = File::quad();
    file.attribute("TANGENT", &floats(&[1.0, 0.0, 0.0, -1.0].repeat(4)), 5126, "VEC4");
    assert_eq!(file.primitive_loaded().tangents, [Vec4::new(1.0, 0.0, 0.0, -1.0); 4]);
    file.primitive()["attributes"].as_object_mut().unwrap().remove("NORMAL");
    let p = file.primitive_loaded();
    assert_eq!((p.positions.len(), p.uvs.len(), p.normals), (6, 6, vec![Vec3::Z; 6]));
    assert!(p.tangents.is_empty());
}

#[test]
fn colors_and_coordinates_come_in_any_format() {
    let expected = Vec4::new(1.0, 0.0, 0.2, 1.0);
    let words: Vec<u8> = [65535u16, 0, 13107, 65535].repeat(4).iter().flat_map(|x| x.to_le_bytes()).collect();
    for (bytes, component, kind) in [
        ([255, 0, 51, 255].repeat(4), 5121, "VEC4"),
        ([255, 0, 51].repeat(4), 5121, "VEC3"),
        (words, 5123, "VEC4"),
        (floats(&[1.0, 0.0, 0.2].repeat(4)), 5126, "VEC3"),
        // Out of range: clamped.
        (floats(&[7.0, -1.0, 0.2, 1.0].repeat(4)), 5126, "VEC4"),
    ] {
        let mut file = File::quad();
        file.attribute("COLOR_0", &bytes, component, kind);
        let colors = file.primitive_loaded().colors;
        assert!(
            colors.len() == 4 && colors.iter().all(|c| (*c - expected).abs().max_element() < 1e-6),
            "{kind} {component}"
        );
    }
    let mut file = File::quad();
    file.attribute("TEXCOORD_0", &[0, 255, 255, 255, 255, 0, 0, 0], 5121, "VEC2");
    assert_eq!(file.primitive_loaded().uvs, [Vec2::Y, Vec2::ONE, Vec2::X, Vec2::ZERO]);
}

#[test]
fn strides_and_sparse_values_are_followed() {
    let mut file = File::quad();
    // Positions, each followed by one float of something else.
    let interleaved: Vec<f32> = [[0., 0., 0.], [2., 0., 0.], [2., 2., 0.], [0., 2., 0.]]
        .iter()
        .flat_map(|p| [p[0], p[1], p[2], 9.0])
        .collect();
    let view = file.view(&floats(&interleaved));
    file.json["bufferViews"][view]["byteStride"] = json!(16);
    file.json["accessors"][POSITIONS]["bufferView"] = json!(view);
    assert_eq!(file.primitive_loaded().positions[2], Vec3::new(2.0, 2.0, 0.0));
    let (indices, values) = (file.view(&[1, 3]), file.view(&floats(&[5., 0., 0., 0., 5., 0.])));
    file.json["accessors"][POSITIONS]["sparse"] = json!({"count": 2, "indices": {"bufferView": indices, "componentType": 5121}, "values": {"bufferView": values}});
    let expected = [Vec3::ZERO, Vec3::X * 5.0, Vec3::new(2.0, 2.0, 0.0), Vec3::Y * 5.0];
    assert_eq!(file.primitive_loaded().positions, expected);
}

#[test]
fn cameras_and_lights_stand_in_the_world() {
    let mut file = File::quad();
    file.json["cameras"] = json!([
        {"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1}},
        {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "zfar": 9, "znear": 0.1}},
    ]);
    let light = |kind: &str| json!({"type": kind, "color": [1, 0.5, 0], "intensity": 8, "range": 9, "spot": {"innerConeAngle": 0.25}});
    file.json["extensions"] =
        json!({"KHR_lights_punctual": {"lights": [light("point"), light("spot"), light("directional")]}});
    let carries = |light: usize| json!({"KHR_lights_punctual": {"light": light}});
    file.json["scenes"][0]["nodes"] = json!([0, 1, 2, 3]);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    // A quarter turn about y: the camera looks along -x.
    let turned = json!({"camera": 0, "rotation": [0, half, 0, half], "scale": [3, 3, 3], "translation": [1, 2, 3], "extensions": carries(0)});
    let nodes = file.json["nodes"].as_array_mut().unwrap();
    let spot = json!({"camera": 1, "rotation": [0, half, 0, half], "scale": [1, -5, 9], "translation": [4, 0, 0], "extensions": carries(1)});
    // A quarter turn about x: -z becomes +y.
    let sun = json!({"rotation": [half, 0, 0, half], "translation": [9, 9, 9], "extensions": carries(2)});
    nodes.extend([turned, spot, sun]);
    let scene = file.load().unwrap();
    let position = Vec3::new(1.0, 2.0, 3.0);
    use crate::scene::PlacedLight::{Directional, Point, Spot};
    let [Point(point), Spot(spot), Directional(sun)] = &scene.lights[..] else {
        panic!("{:?}", scene.lights)
    };
    assert_eq!((point.position, point.intensity), (position, Vec3::new(8.0, 4.0, 0.0)));
    assert!((spot.axis + Vec3::X).length() < 1e-6, "scale may mirror, but not turn the axis: {}", spot.axis);
    assert_eq!((spot.position, spot.intensity), (Vec3::X * 4.0, Vec3::new(8.0, 4.0, 0.0)));
    assert_eq!((spot.inner_angle, spot.outer_angle), (0.25, std::f32::consts::FRAC_PI_4));
    assert!((sun.direction + Vec3::Y).length() < 1e-6, "it shines up: {}", sun.direction);
    assert_eq!(sun.illuminance, Vec3::new(8.0, 4.0, 0.0));
    let [camera] = &scene.cameras[..] else { panic!("{:?}", scene.cameras) };
    assert_eq!((camera.position, camera.fov_y), (position, 0.5));
    assert!((camera.forward + Vec3::X).length() < 1e-6 && (camera.up - Vec3::Y).length() < 1e-6);
    // Ranges in one line, the orthographic camera in another.
    assert_eq!(scene.warnings.len(), 2, "{:?}", scene.warnings);
}

#[test]
fn lights_may_have_a_radius() {
    let mut file = File::quad();
    let light = |kind: &str, extras| json!({"type": kind, "intensity": 8, "extras": extras});
    file.json["extensions"]["KHR_lights_punctual"]["lights"] = json!([
        light("point", json!({"radius": 0.25, "author": ["somebody"]})),
        light("spot", json!({"radius": 0.5})),
        light("point", json!("nothing of ours")),
        light("point", json!({"radius": -1})),
    ]);
    let node = |light: usize, extras| json!({"scale": [3, 3, 3], "extras": extras, "extensions": {"KHR_lights_punctual": {"light": light}}});
    let nodes = file.json["nodes"].as_array_mut().unwrap();
    // The light's own comes first.
    nodes.extend([
        node(0, json!({"radius": 0.75})),
        node(1, json!(7)),
        node(2, json!({"radius": 0.125})),
        node(2, json!(null)),
        node(3, json!({})),
    ]);
    file.json["scenes"][0]["nodes"] = json!([0, 1, 2, 3, 4, 5]);
    let scene = file.load().unwrap();
    use crate::scene::PlacedLight::{Point, Spot};
    let radius = |light: &PlacedLight| match light {
        Point(light) => light.radius,
        Spot(light) => light.radius,
        _ => panic!("{light:?}"),
    };
    assert_eq!(scene.lights.iter().map(radius).collect::<Vec<_>>(), [0.25, 0.5, 0.125, 0.0, 0.0]);
    let [warning] = &scene.warnings[..] else { panic!("{:?}", scene.warnings) };
    assert!(
        warning.contains("invalid radius") && warning.contains("node 5") && warning.contains("-1"),
        "{warning}"
    );
    let mut soft = scene;
    soft.lights.iter_mut().for_each(|light| light.soften(2.0));
    assert_eq!(soft.lights.iter().map(radius).collect::<Vec<_>>(), [0.25, 0.5, 0.125, 2.0, 2.0]);
}

#[test]
fn area_lights_hang_on_nodes() {
    let mut file = File::quad();
    file.json["extensionsRequired"] = json!(["EXT_lights_area"]);
    file.json["extensions"]["EXT_lights_area"]["lights"] = json!([
        {"type": "rect", "color": [1, 0.5, 0.25], "intensity": 8, "size": 0.5, "rect": {"aspect": 3}},
        {"type": "disk"},
        {"type": "tube"},
        {"type": "disk", "size": 0},
    ]);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    // A quarter turn about y: -z becomes -x; the largest scale counts.
    let turn = json!([0, half, 0, half]);
    let node = |light: usize| json!({"rotation": turn, "translation": [1, 2, 3], "scale": [1, -4, 2], "extensions": {"EXT_lights_area": {"light": light}}});
    let nodes = file.json["nodes"].as_array_mut().unwrap();
    nodes.extend((0..4).map(node));
    file.json["scenes"][0]["nodes"] = json!([0, 1, 2, 3, 4]);
    let scene = file.load().unwrap();
    use crate::scene::{PanelShape, PlacedLight::Panel};
    let [Panel(rectangle), Panel(disk)] = &scene.lights[..] else { panic!("{:?}", scene.lights) };
    assert_eq!((rectangle.shape, disk.shape), (PanelShape::Rectangle, PanelShape::Disk));
    for light in [rectangle, disk] {
        assert_eq!(light.position, Vec3::new(1.0, 2.0, 3.0));
        assert!((light.axis + Vec3::X).length() < 1e-6 && (light.up + Vec3::Y).length() < 1e-6, "{light:?}");
    }
    assert!((rectangle.size - glam::Vec2::new(6.0, 2.0)).length() < 1e-5, "{}", rectangle.size);
    assert_eq!((rectangle.radiance, disk.radiance), (Vec3::new(8.0, 4.0, 2.0), Vec3::splat(1000.0)));
    assert!((disk.size - 4.0).length() < 1e-5);
    assert_eq!(scene.warnings.len(), 2, "{:?}", scene.warnings);
}

#[test]
fn files_may_be_text_with_a_buffer_beside_it() {
    let folder = Folder::new("beside");
    let mut file = File::quad();
    file.json["buffers"] = json!([{"uri": "quad%20data.bin", "byteLength": file.bin.len()}]);
    folder.write("quad data.bin", &file.bin);
    let path = folder.write("quad.gltf", file.json.to_string().as_bytes());
    let scene = load(&path).unwrap();
    assert_eq!((scene.name.as_str(), scene.triangle_count()), ("quad", 2));
}

#[test]
fn integers_may_stand_for_coordinates() {
    let words = |values: &[i16]| values.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let mut file = File::quad();
    file.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    // Each padded to 8 bytes, as gltfpack writes them.
    let positions = words(&[0, 0, 0, 0, 100, 0, 0, 0, 100, 100, 0, 0, 0, 100, 0, 0]);
    let view = file.view(&positions);
    file.json["bufferViews"][view]["byteStride"] = json!(8);
    file.json["accessors"][POSITIONS]["bufferView"] = json!(view);
    file.json["accessors"][POSITIONS]["componentType"] = json!(5122);
    let normals = file.view(&[0, 0, 127, 0].repeat(4));
    file.json["bufferViews"][normals]["byteStride"] = json!(4);
    file.json["accessors"][1] =
        json!({"bufferView": normals, "componentType": 5120, "normalized": true, "count": 4, "type": "VEC3"});
    file.attribute("TEXCOORD_0", &[0, 0, 3, 0, 3, 3, 0, 3].map(|x: u8| [x, 0]).concat(), 5123, "VEC2");
    let p = file.primitive_loaded();
    assert_eq!(p.positions, [Vec3::ZERO, Vec3::X * 100.0, Vec3::new(100.0, 100.0, 0.0), Vec3::Y * 100.0]);
    assert_eq!(p.normals, [Vec3::Z; 4]);
    assert_eq!(p.uvs[2], Vec2::splat(3.0));
    // Without the extension, integers are not allowed there.
    file.json["extensionsRequired"] = json!([]);
    assert!(file.reason().contains("Vec3 of I16 is not allowed here"));
}

#[test]
fn a_mesh_may_be_copied() {
    let mut file = File::quad();
    let places = file.accessor(&floats(&[0., 0., 0., 0., 0., 3.]), 5126, "VEC3");
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let turns = file.accessor(&floats(&[0., 0., 0., 1., 0., 0., half, half]), 5126, "VEC4");
    let attributes = json!({"TRANSLATION": places, "ROTATION": turns, "_ID": 99});
    file.json["nodes"][0]["extensions"] = json!({"EXT_mesh_gpu_instancing": {"attributes": attributes}});
    file.json["nodes"][0]["translation"] = json!([10, 0, 0]);
    let scene = file.load().unwrap();
    assert_eq!((scene.meshes.len(), scene.instances.len(), scene.triangle_count()), (1, 2, 4));
    let corner = |i: usize| scene.origin.as_vec3() + far_corner(&scene, i);
    assert!((corner(0) - Vec3::new(11.0, 1.0, 0.0)).length() < 1e-5);
    assert!((corner(1) - Vec3::new(9.0, 1.0, 3.0)).length() < 1e-5);
    file.json["accessors"][turns]["count"] = json!(1);
    assert!(file.reason().contains("node 0 'quad': EXT_mesh_gpu_instancing: its attributes have different"));
}

#[test]
fn what_hidden_nodes_hold_is_not_there_but_for_cameras() {
    let mut file = File::quad();
    file.json["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1}}]);
    file.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [{"type": "point"}]}});
    file.json["scenes"][0]["nodes"] = json!([0, 1]);
    let nodes = file.json["nodes"].as_array_mut().unwrap();
    nodes.push(json!({"children": [2], "extensions": {"KHR_node_visibility": {"visible": false}}}));
    let light = json!({"KHR_lights_punctual": {"light": 0}, "KHR_node_visibility": {"visible": true}});
    nodes.push(json!({"mesh": 0, "camera": 0, "extensions": light}));
    let scene = file.load().unwrap();
    assert_eq!((scene.instances.len(), scene.lights.len(), scene.cameras.len()), (1, 0, 1));
    assert_eq!(scene.cameras[0].name, "0");
    file.json["nodes"][1]["extensions"]["KHR_node_visibility"]["visible"] = json!(true);
    let scene = file.load().unwrap();
    assert_eq!((scene.instances.len(), scene.lights.len()), (2, 1));
}

#[test]
fn the_node_of_a_skin_does_not_move_it() {
    let mut file = File::quad();
    file.json["skins"] = json!([{"joints": [0]}]);
    file.json["nodes"][0]["skin"] = json!(0);
    file.json["nodes"][0]["translation"] = json!([5, 0, 0]);
    let scene = file.load().unwrap();
    assert_eq!(far_corner(&scene, 0), Vec3::new(1.0, 1.0, 0.0));
    assert_eq!(scene.warnings, ["a skin without joints and weights stays as modelled: node 0 'quad'"]);
}

#[test]
fn paths_may_have_backslashes_and_another_case() {
    let folder = Folder::new("case");
    let mut file = File::quad();
    std::fs::create_dir_all(folder.0.join("Data")).unwrap();
    file.json["buffers"] = json!([{"uri": "data\\QUAD.bin", "byteLength": file.bin.len()}]);
    folder.write("Data/quad.BIN", &file.bin);
    let path = folder.write("quad.gltf", file.json.to_string().as_bytes());
    assert_eq!(load(&path).unwrap().triangle_count(), 2);
}
