//! Files that are wrong in one place: the error must name it.

use super::*;

/// `change` makes a file wrong; the reason must contain each of `parts`.
fn rejected(change: impl FnOnce(&mut File), parts: &[&str]) {
    let mut file = File::quad();
    assert!(file.load().is_ok());
    change(&mut file);
    let reason = file.reason();
    for part in parts {
        assert!(reason.contains(part), "'{part}' is missing in: {reason}");
    }
}

#[test]
fn no_gltf_at_all() {
    let reason = |bytes: &[u8]| one_line_reason(scene_of(bytes, Path::new("")));
    for bytes in [&b""[..], b"   ", b"PK\x03\x04", b"[1]", b"glTX\x02\0\0\0"] {
        assert!(reason(bytes).contains("neither JSON nor binary glTF"), "{bytes:?}");
    }
    assert!(reason(b"glTF\x02\0\0\0\x05\0\0\0").contains("broken header"));
    assert!(reason(b"glTF\x01\0\0\0\x0c\0\0\0").contains("version"));
    assert!(reason(b"{\"asset\": ").contains("broken JSON"));
    for old in [
        &br#"{"asset": {"version": "1.0"}}"#[..],
        br#"{"asset": {"version": 1.0}}"#,
        br#"{"asset": {}, "meshes": {"quad": {}}, "accessors": {}}"#,
        br#"{"asset": {"version": "2.1", "minVersion": "2.1"}}"#,
    ] {
        assert!(reason(old).contains("only 2.0 can be read"), "{}", reason(old));
    }
    assert!(reason(b"{\"meshes\": []}").contains("JSON without the version"));
    assert!(reason(b"{\"asset\": {\"version\": \"2.0\"}}").contains("no scene"));
}

#[test]
fn missing_files_are_named() {
    let path = Path::new("/nowhere/at-all.gltf");
    let error = load(path).unwrap_err();
    assert!(matches!(&error, Error::Read { path: named, .. } if named == path), "{error}");
    assert!(matches!(load(&std::env::temp_dir()), Err(Error::Read { .. })), "a folder is no file");
}

#[test]
fn external_buffers() {
    let folder = Folder::new("buffers");
    let file = File::quad();
    let mut json = file.json.clone();
    json["buffers"] = json!([{"uri": "quad.bin", "byteLength": file.bin.len()}]);
    let path = folder.write("quad.gltf", json.to_string().as_bytes());
    let error = load(&path).unwrap_err().to_string();
    assert!(error.starts_with(path.to_str().unwrap()), "{error}");
    assert!(
        error.contains("buffer 0") && error.contains("quad.bin") && error.contains("can't read"),
        "{error}"
    );
    folder.write("quad.bin", &file.bin[1..]);
    let error = load(&path).unwrap_err().to_string();
    let sizes = format!("which is too short: {} bytes instead of {}", file.bin.len() - 1, file.bin.len());
    assert!(error.contains("('quad.bin')") && error.contains(&sizes), "{error}");
    folder.write("quad.bin", &file.bin);
    assert!(load(&path).is_ok());
}

#[test]
fn extensions_that_are_required() {
    let require = |names: Value| move |file: &mut File| file.json["extensionsRequired"] = names;
    rejected(
        require(json!(["VENDOR_mesh_fractal", "KHR_texture_transform"])),
        &["requires VENDOR_mesh_fractal, which is not supported"],
    );
    let mut file = File::quad();
    file.json["extensionsRequired"] =
        json!(["KHR_texture_transform", "KHR_materials_sheen", "KHR_materials_clearcoat", "KHR_xmp_json_ld"]);
    file.json["extensionsUsed"] = json!(["KHR_texture_transform", "KHR_materials_sheen", "KHR_unknown"]);
    assert_eq!(
        file.load().unwrap().warnings,
        [
            "the picture lacks: sheen (KHR_materials_sheen), clear coats (KHR_materials_clearcoat)",
            "extensions without an effect here: KHR_unknown, KHR_xmp_json_ld"
        ]
    );
}

#[test]
fn accessors_out_of_their_bytes() {
    let count = |n: u64| move |f: &mut File| f.json["accessors"][POSITIONS]["count"] = json!(n);
    let where_ = "mesh 0, primitive 0: POSITION: accessor 0";
    rejected(count(5), &[where_, "5 elements reach past buffer view 0 of 48 bytes"]);
    rejected(count(u64::MAX), &[where_, "reach past buffer view 0"]);
    rejected(count(0), &[where_, "no elements"]);
    rejected(
        |f| f.json["accessors"][POSITIONS]["byteOffset"] = json!(4),
        &[where_, "reach past buffer view 0"],
    );
    rejected(|f| f.json["accessors"][POSITIONS]["byteOffset"] = json!(u64::MAX), &[where_, "reach past"]);
    rejected(|f| f.json["bufferViews"][0]["byteStride"] = json!(16), &[where_, "reach past buffer view 0"]);
    rejected(|f| f.json["bufferViews"][0]["byteStride"] = json!(8), &[where_, "stride of 8 bytes"]);
    rejected(
        |f| f.json["bufferViews"][0]["byteLength"] = json!(10_000),
        &["node 0 'quad'", "POSITION: accessor 0: buffer view 0: it reaches past buffer 0"],
    );
    // The bytes are there, but not declared.
    let shorter = |f: &mut File| f.json["buffers"][0]["byteLength"] = json!(f.bin.len() - 4);
    rejected(shorter, &["buffer view 3: it reaches past buffer 0"]);
    rejected(
        |f| f.json["bufferViews"][0]["byteOffset"] = json!(u64::MAX),
        &["node 0 'quad'", "POSITION: accessor 0: buffer view 0: it reaches past buffer 0"],
    );
    rejected(|f| f.json["accessors"][POSITIONS]["componentType"] = json!(5123), &[where_, "not allowed"]);
    rejected(|f| f.json["accessors"][POSITIONS]["type"] = json!("VEC4"), &[where_, "not allowed"]);
    rejected(
        |f| f.json["accessors"][INDICES]["count"] = json!(7),
        &["indices: accessor 3", "reach past buffer view 3"],
    );
}

#[test]
fn sparse_accessors_out_of_their_bytes() {
    let sparse = |indices: &'static [u8], count: u64| {
        move |f: &mut File| {
            let (indices, values) = (f.view(indices), f.view(&floats(&[0.5; 6])));
            f.json["accessors"][POSITIONS]["sparse"] = json!({"count": count,
                "indices": {"bufferView": indices, "componentType": 5121}, "values": {"bufferView": values}});
        }
    };
    rejected(sparse(&[1, 9], 2), &["POSITION: accessor 0", "sparse index 9 for 4 elements"]);
    rejected(sparse(&[0, 1, 2], 3), &["3 elements reach past"]);
    rejected(sparse(&[0, 1], 0), &["0 sparse values for 4 elements"]);
    rejected(sparse(&[0, 1], 5), &["5 sparse values for 4 elements"]);
    rejected(
        |f| {
            sparse(&[0, 1], 2)(f);
            f.json["accessors"][POSITIONS]["bufferView"] = Value::Null;
            f.json["accessors"][POSITIONS]["count"] = json!(1u64 << 40);
        },
        &["without a buffer view are too many"],
    );
}

#[test]
fn vertices_that_make_no_sense() {
    rejected(|f| f.indices(&[0, 1, 4]), &["primitive 0: accessor 4: index 4 is out of range of 4 vertices"]);
    rejected(|f| f.json["nodes"][0]["scale"] = json!([3e38, 1, 1]), &["reaches beyond"]);
    let nan = |file: &mut File| {
        for vertex in 0..4 {
            file.bin[12 * vertex..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
        }
    };
    rejected(nan, &["no triangles", "2 triangles with a vertex that is not finite"]);
}

#[test]
fn transforms_that_make_no_sense() {
    let matrix = |element: usize, value: f64| {
        move |f: &mut File| {
            let mut m = [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.];
            m[element] = value;
            f.json["nodes"][0]["matrix"] = json!(m);
        }
    };
    rejected(matrix(12, 1e300), &["node 0 'quad'", "not finite"]);
    rejected(matrix(3, 0.5), &["node 0 'quad'", "not affine"]);
    rejected(matrix(15, 2.0), &["node 0 'quad'", "not affine"]);
    rejected(|f| f.json["nodes"][0]["translation"] = json!([0, 1e300, 0]), &["node 0 'quad'", "not finite"]);
    rejected(|f| f.json["nodes"][0]["rotation"] = json!([0, 0, 0, 0]), &["node 0 'quad'", "not a rotation"]);
}

#[test]
fn hierarchies_that_are_no_trees() {
    rejected(|f| f.json["nodes"][0]["children"] = json!([0]), &["node 0 'quad'", "its own ancestor"]);
    let loops = json!([{"children": [1]}, {"children": [2]}, {"children": [0], "mesh": 0}]);
    rejected(|f| f.json["nodes"] = loops, &["node 0", "its own ancestor"]);
    let diamond = json!([{"children": [1, 2]}, {"children": [3]}, {"children": [3]}, {"mesh": 0}]);
    rejected(|f| f.json["nodes"] = diamond, &["node 3 has two parents"]);
}

#[test]
fn indices_of_things_that_are_not_there() {
    let mesh = "node 0 'quad': mesh 0: primitives: 0: ";
    rejected(|f| f.primitive()["material"] = json!(7), &[mesh, "material 7 of 0 does not exist"]);
    rejected(
        |f| f.primitive()["attributes"]["POSITION"] = json!(99),
        &[mesh, "POSITION: accessor 99 of 4 does not exist"],
    );
    rejected(
        |f| {
            f.json["nodes"][0]["mesh"] = json!(1);
            f.json["nodes"][0]["name"] = json!("lamp");
        },
        &["node 0 'lamp': mesh 1 of 1 does not exist"],
    );
    rejected(
        |f| f.json["nodes"][0]["children"] = json!([7]),
        &["node 0 'quad': children: 0: node 7 of 1 does not exist"],
    );
    rejected(|f| f.json["scene"] = json!(4), &["scene 4 of 1 does not exist"]);
    rejected(|f| f.json["scenes"][0]["nodes"] = json!([4]), &["scene 0: nodes: 0: node 4 of 1"]);
}

#[test]
fn nothing_to_draw() {
    rejected(|f| f.indices(&[0, 0, 1]), &["no triangles", "without an area"]);
    rejected(|f| f.primitive()["mode"] = json!(1), &["no triangles", "points and lines are left out"]);
    rejected(|f| f.json["nodes"][0]["mesh"] = Value::Null, &["no triangles"]);
}

#[test]
fn names_can_not_break_the_line() {
    rejected(
        |f| {
            f.json["nodes"][0]["name"] = json!("two\nlines\u{1b}[31m");
            f.json["nodes"][0]["rotation"] = json!([0, 0, 0, 0]);
        },
        &["node 0 'two lines [31m'"],
    );
}

/// 4,100 copies of 4,098 emissive triangles: a scene of some kB would take gigabytes.
#[test]
fn more_lights_than_memory() {
    let glowing = |copies: usize| {
        let mut file = File::quad();
        file.indices(&[0, 1, 2, 0, 2, 3].repeat(2049));
        file.material(json!({"emissiveFactor": [1, 1, 1]}));
        file.json["nodes"] = vec![json!({"mesh": 0}); copies].into();
        file.json["scenes"] = json!([{"nodes": (0..copies).collect::<Vec<_>>()}]);
        file
    };
    let reason = glowing(4100).reason();
    assert!(reason.contains("16801800 lights") && reason.contains("16777216 is the most"), "{reason}");
    assert_eq!(glowing(2).load().unwrap().instances.len(), 2);
}
