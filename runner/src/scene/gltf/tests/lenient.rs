//! What is not drawn may be broken, and what is drawn may be odd: a warning, not a refusal.

use super::*;
use crate::scene::{PlacedLight, SpotLight};
use glam::Vec4;

/// `change` makes a file odd; it must draw the quad all the same. Gives the scene.
fn drawn(change: impl FnOnce(&mut File)) -> SceneDescription {
    let mut file = File::quad();
    let expected = corners(&file.primitive_loaded());
    change(&mut file);
    let scene = file.load().unwrap();
    assert_eq!(corners(&scene.meshes[0].primitives[0]), expected);
    assert_eq!(scene.instances.len(), 1);
    scene
}

/// As `drawn`; the one warning must contain each of `parts`.
fn warned(change: impl FnOnce(&mut File), parts: &[&str]) {
    let scene = drawn(change);
    let [line] = &scene.warnings[..] else { panic!("{parts:?}: {:?}", scene.warnings) };
    for part in parts {
        assert!(line.contains(part), "'{part}' is missing in: {line}");
    }
}

fn silent(change: impl FnOnce(&mut File)) {
    let scene = drawn(change);
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
}

#[test]
fn things_that_nobody_draws() {
    silent(|f| _ = push(&mut f.json["meshes"], json!({"primitives": [{"attributes": {"POSITION": 99}}]})));
    silent(|f| _ = push(&mut f.json["nodes"], json!({"mesh": 7, "matrix": [1]})));
    silent(|f| _ = push(&mut f.json["scenes"], json!({"nodes": [9]})));
    silent(|f| _ = push(&mut f.json["accessors"], json!({"componentType": 1, "count": 1, "type": "VEC9"})));
    silent(|f| {
        _ = push(&mut f.json["bufferViews"], json!({"buffer": 0, "byteOffset": 1u64 << 60, "byteLength": 8}))
    });
    silent(|f| _ = push(&mut f.json["buffers"], json!({"byteLength": 8})));
    silent(|f| _ = push(&mut f.json["buffers"], json!({"byteLength": 8, "uri": "nowhere.bin"})));
    silent(|f| f.json["skins"] = json!([{}, 7]));
    silent(|f| f.json["cameras"] = json!([{"type": "fisheye"}]));
    silent(|f| f.json["images"] = json!([{"mimeType": "image/png"}]));
    silent(|f| f.json["extensions"] = json!({"VENDOR_any": [1], "KHR_lights_punctual": {}}));
    silent(|f| f.json["asset"]["generator"] = json!(7));
    silent(|f| f.primitive()["attributes"]["COLOR"] = json!(0));
    silent(|f| f.primitive()["attributes"]["_ID"] = json!(99));
    silent(|f| f.json["accessors"][POSITIONS]["min"] = json!("low"));
    silent(|f| f.json["accessors"][POSITIONS]["max"] = Value::Null);
    // A hidden node (KHR_node_visibility), whatever it holds.
    silent(|f| {
        f.json["scenes"][0]["nodes"] = json!([0, 1]);
        let hidden = json!({"KHR_node_visibility": {"visible": false}});
        push(&mut f.json["meshes"], json!({"primitives": [{"attributes": {"POSITION": 2}}]}));
        push(&mut f.json["nodes"], json!({"children": [2], "extensions": hidden}));
        push(&mut f.json["nodes"], json!({"mesh": 1}));
    });
    let named = |f: &mut File| f.json["nodes"][0]["name"] = json!(7);
    warned(named, &["ignored as unreadable: node 0: name: 7 is not a text"]);
    let dangling = |f: &mut File| f.json["nodes"][0]["camera"] = json!(0);
    warned(dangling, &["node 0 'quad': camera: camera 0 of 0 does not exist"]);
    warned(|f| f.json["animations"] = json!({}), &["animations: it is not a list"]);
}

#[test]
fn whole_numbers_may_be_written_as_floats() {
    silent(|f| {
        f.json["accessors"][POSITIONS]["count"] = json!(4.0);
        f.json["nodes"][0]["mesh"] = json!(0.0);
    });
}

#[test]
fn files_without_a_scene_are_drawn_whole() {
    let change = |f: &mut File| {
        f.json["scenes"] = Value::Null;
        f.json["scene"] = Value::Null;
        f.json["nodes"] = json!([{"mesh": 0}, {"children": [0]}]);
    };
    warned(change, &["the file has no scene: all of its nodes are drawn: 2 nodes"]);
    let empty = |f: &mut File| {
        f.json["scene"] = json!(1);
        f.json["scenes"] = json!([{}, {"nodes": [0]}]);
    };
    silent(empty);
}

#[test]
fn text_may_be_padded_with_zeros() {
    let mut json = File::quad();
    let data: Vec<u8> = std::mem::take(&mut json.bin);
    use base64::Engine;
    let uri = base64::engine::general_purpose::STANDARD.encode(&data);
    let uri = format!("data:application/octet-stream;base64,{uri}");
    json.json["buffers"] = json!([{"byteLength": data.len(), "uri": uri}]);
    let mut text = json.json.to_string().into_bytes();
    text.extend([0; 3]);
    assert_eq!(scene_of(&text, Path::new("")).unwrap().triangle_count(), 2);
    // Names in an encoding of their own: here Latin-1.
    let at = text.windows(4).position(|w| w == b"quad").unwrap();
    text[at] = 0xe9;
    assert_eq!(scene_of(&text, Path::new("")).unwrap().triangle_count(), 2);
}

#[test]
fn chunks_that_nobody_knows_are_skipped() {
    let mut bytes = File::quad().bytes();
    bytes.extend([4, 0, 0, 0]);
    bytes.extend(b"ODDLabcd");
    assert!(scene_of(&bytes, Path::new("")).is_ok());
}

#[test]
fn attributes_that_a_quad_can_be_drawn_without() {
    let broken = "is broken and not used: mesh 0, primitive 0";
    warned(|f| f.json["accessors"][1]["count"] = json!(3), &["NORMAL", broken, "3 elements for 4 vertices"]);
    warned(
        |f| f.json["accessors"][2]["count"] = json!(5),
        &["TEXCOORD_0", broken, "reach past buffer view 2"],
    );
    warned(
        |f| f.json["accessors"][1]["type"] = json!("VEC2"),
        &["NORMAL", broken, "Vec2 of F32 is not allowed"],
    );
    warned(|f| f.primitive()["attributes"]["COLOR_0"] = json!(99), &["COLOR_0: accessor 99 of 4"]);
}

#[test]
fn directions_that_are_none_are_mended() {
    let nan = |at: usize| move |f: &mut File| f.bin[at..at + 4].copy_from_slice(&f32::NAN.to_le_bytes());
    let scene = drawn(nan(48));
    assert_eq!(scene.meshes[0].primitives[0].normals, [Vec3::Z; 4]);
    let scene = drawn(|f| {
        f.attribute("TANGENT", &floats(&[1.0, 0.0, 0.0, 1.0].repeat(4)), 5126, "VEC4");
        let at = f.bin.len() - 4;
        nan(at - 12)(f);
    });
    assert!(
        scene.meshes[0].primitives[0].tangents.iter().all(|t| t.is_finite() && t.truncate().is_normalized())
    );
}

#[test]
fn broken_vertices_take_only_their_triangles() {
    // Vertex 3 belongs to the second triangle alone.
    let nan = |at: usize| {
        let mut file = File::quad();
        file.attribute("COLOR_0", &floats(&[0.5; 16]), 5126, "VEC4");
        file.bin[at..at + 4].copy_from_slice(&f32::NAN.to_le_bytes());
        let scene = file.load().unwrap();
        assert_eq!(scene.triangle_count(), 1);
        assert_eq!(
            scene.warnings,
            ["1 triangles with a vertex that is not finite are left out: mesh 0, primitive 0"]
        );
        let p = &scene.meshes[0].primitives[0];
        assert_eq!(p.positions.len(), 3);
        assert!(p.positions.iter().all(|v| v.is_finite()) && p.uvs.iter().all(|v| v.is_finite()));
        assert!(p.colors.iter().all(|v| v.is_finite()));
    };
    let colors = File::quad().bin.len();
    [12 * 3, 96 + 8 * 3, colors + 16 * 3].into_iter().for_each(nan);
    // One that no triangle uses takes none.
    let mut file = File::quad();
    file.indices(&[0, 1, 2]);
    file.bin[36..40].copy_from_slice(&f32::INFINITY.to_le_bytes());
    let scene = file.load().unwrap();
    assert!(scene.warnings.is_empty() && scene.meshes[0].primitives[0].positions.len() == 3);
}

#[test]
fn accessors_without_bytes_are_zero() {
    let scene = drawn(|f| {
        f.json["accessors"][2]["bufferView"] = Value::Null;
        let zero = push(
            &mut f.json["accessors"],
            json!({"componentType": 5121, "count": 4, "type": "VEC4", "normalized": true}),
        );
        f.primitive()["attributes"]["COLOR_0"] = json!(zero);
    });
    let p = &scene.meshes[0].primitives[0];
    assert_eq!((&p.uvs[..], &p.colors[..]), (&[glam::Vec2::ZERO; 4][..], &[Vec4::ZERO; 4][..]));
}

#[test]
fn sparse_values_may_come_in_any_order() {
    let mut file = File::quad();
    let (indices, values) = (file.view(&[3, 1]), file.view(&floats(&[0., 5., 0., 5., 0., 0.])));
    file.json["accessors"][POSITIONS]["sparse"] = json!({"count": 2, "indices": {"bufferView": indices, "componentType": 5121}, "values": {"bufferView": values}});
    let expected = [Vec3::ZERO, Vec3::X * 5.0, Vec3::new(1.0, 1.0, 0.0), Vec3::Y * 5.0];
    assert_eq!(file.primitive_loaded().positions, expected);
}

#[test]
fn coordinates_of_more_components_lose_the_rest() {
    let scene = drawn(|f| f.attribute("TEXCOORD_0", &floats(&[0.25, 0.5, 9.0].repeat(4)), 5126, "VEC3"));
    assert_eq!(scene.meshes[0].primitives[0].uvs, [glam::Vec2::new(0.25, 0.5); 4]);
}

#[test]
fn codes_that_nobody_knows_have_their_defaults() {
    let textured = |f: &mut File| {
        let texture = f.texture(&png([1, 2, 3]));
        f.material(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": texture}}}));
        texture
    };
    // GL_CLAMP, which some exporters take for the one that clamps to the edge.
    let clamp = |f: &mut File| {
        let texture = textured(f);
        f.json["samplers"] = json!([{"wrapS": 10496, "wrapT": 33071}]);
        f.json["textures"][texture]["sampler"] = json!(0);
    };
    warned(clamp, &["sampler 0: wrapS: 10496 is an unknown code"]);
    let dangling = |f: &mut File| {
        let texture = textured(f);
        f.json["textures"][texture]["sampler"] = json!(5);
    };
    warned(dangling, &["texture 0: sampler: sampler 5 of 0"]);
    warned(|f| f.material(json!({"alphaMode": "GLASS"})), &["material 0: alphaMode", "GLASS"]);
    warned(|f| f.material(json!({"emissiveFactor": [1, 1]})), &["material 0: emissiveFactor", "a list of 2"]);
    let missing = json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 3}}});
    warned(|f| f.material(missing), &["baseColorTexture: texture 3 of 0"]);
    warned(
        |f| f.material(json!({"extensions": {"KHR_materials_ior": {"ior": "glass"}}})),
        &["material 0", "ior: \"glass\" is not a number"],
    );
}

fn lit(light: Value) -> impl FnOnce(&mut File) {
    move |file| {
        file.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [light]}});
        file.json["nodes"][0]["extensions"] = json!({"KHR_lights_punctual": {"light": 0}});
    }
}

#[test]
fn lights_that_make_no_sense() {
    let negative = json!({"type": "point", "intensity": -4});
    warned(lit(negative), &["a light of negative or infinite intensity is left out: node 0 'quad'"]);
    let infinite = json!({"type": "directional", "intensity": 1e300});
    warned(lit(infinite), &["a light of negative or infinite intensity is left out"]);
    warned(lit(json!({"type": "area"})), &["node 0 'quad': KHR_lights_punctual", "\"area\" is not one of"]);
    warned(lit(json!({"type": "point", "color": "red"})), &["light 0: color"]);
    let mut file = File::quad();
    lit(json!({"type": "spot"}))(&mut file);
    assert_eq!(spot_of(&file.load().unwrap()).outer_angle, std::f32::consts::FRAC_PI_4);
}

fn spot_of(scene: &SceneDescription) -> SpotLight {
    let [PlacedLight::Spot(light)] = scene.lights[..] else { panic!("{:?}", scene.lights) };
    light
}

#[test]
fn cones_are_cut_to_what_is_possible() {
    let widest = std::f32::consts::FRAC_PI_2;
    for (inner, outer, cut) in
        [(0.5, 0.4, (0.4, 0.4)), (-0.1, 0.4, (0.0, 0.4)), (0.0, 3.0, (0.0, widest)), (2.0, -1.0, (0.0, 0.0))]
    {
        let spot = json!({"type": "spot", "spot": {"innerConeAngle": inner, "outerConeAngle": outer}});
        let scene = drawn(lit(spot));
        let light = spot_of(&scene);
        assert!(
            (light.inner_angle - cut.0).abs() < 1e-3 && (light.outer_angle - cut.1).abs() < 1e-3,
            "{light:?}"
        );
        assert!(scene.warnings[0].starts_with("the cone of a spot is cut"), "{:?}", scene.warnings);
    }
}
