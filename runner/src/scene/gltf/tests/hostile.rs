//! Broken on purpose: no bytes may make the loader panic, hang or ask for absurd memory.

use super::*;
use glam::UVec2;
use shared::rng::{Rng, Stream};

/// A file that uses all that the loader reads.
fn rich() -> Vec<u8> {
    let mut file = File::quad();
    let texture = file.texture(&png([1, 2, 3]));
    let reference =
        json!({"index": texture, "extensions": {"KHR_texture_transform": {"offset": [0, 1], "rotation": 1}}});
    file.json["samplers"] = json!([{"magFilter": 9728, "wrapS": 33071}]);
    file.json["textures"][texture]["sampler"] = json!(0);
    file.material(json!({"name": "m", "normalTexture": reference, "emissiveTexture": reference,
        "emissiveFactor": [1, 1, 1], "pbrMetallicRoughness": {"baseColorTexture": reference},
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 5}}}));
    file.attribute("COLOR_0", &[255, 0, 51, 255].repeat(4), 5121, "VEC4");
    let (indices, values) = (file.view(&[1, 3]), file.view(&floats(&[5., 0., 0., 0., 5., 0.])));
    file.json["accessors"][POSITIONS]["sparse"] = json!({"count": 2, "indices": {"bufferView": indices, "componentType": 5121}, "values": {"bufferView": values}});
    file.json["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1}}]);
    file.json["extensions"] =
        json!({"KHR_lights_punctual": {"lights": [{"type": "point"}, {"type": "spot", "spot": {}}]}});
    let light = json!({"KHR_lights_punctual": {"light": 0}});
    file.json["nodes"][0]["children"] = json!([1]);
    push(&mut file.json["nodes"], json!({"camera": 0, "rotation": [0, 0, 0, 1], "extensions": light}));
    file.bytes()
}

/// Loads and drops the result: only a panic fails. Also asks what the rest of the program asks of every scene.
fn survives(bytes: &[u8]) -> bool {
    match scene_of(bytes, Path::new("/nowhere")) {
        Err(reason) => {
            assert!(!reason.is_empty());
            false
        }
        Ok(scene) => {
            assert!(scene.bounds().extent().is_finite() && scene.triangle_count() > 0);
            for p in scene.meshes.iter().flat_map(|mesh| &mesh.primitives) {
                assert!(p.indices.iter().all(|&i| (i as usize) < p.positions.len()));
                assert!(p.normals.len() == p.positions.len() && p.normals.iter().all(|n| n.is_normalized()));
                assert!(p.material < scene.materials.len());
            }
            crate::scene::lights::LightTable::new(&scene);
            true
        }
    }
}

#[test]
fn truncated_files() {
    let bytes = rich();
    assert!(survives(&bytes));
    for length in (0..bytes.len()).step_by(7) {
        assert!(!survives(&bytes[..length]), "{length} of {} bytes", bytes.len());
    }
}

#[test]
fn flipped_bits() {
    let bytes = rich();
    let mut rng = Rng::new(UVec2::new(7, 7), 0, 0, Stream::Initial, 0);
    let mut loaded = 0;
    for _ in 0..1500 {
        let mut broken = bytes.clone();
        let random = rng.next_u32x4();
        for word in random.to_array().into_iter().take(1 + random.w as usize % 3) {
            let place = word as usize >> 3;
            let i = place % broken.len();
            broken[i] ^= 1 << (word & 7);
        }
        loaded += usize::from(survives(&broken));
    }
    // Else the bits missed the content, or hit the container alone.
    assert!((100..1400).contains(&loaded), "{loaded} of 1500 loaded");
}

/// Each number of the JSON in turn becomes one that no one expects.
#[test]
fn absurd_numbers() {
    let bytes = rich();
    let text_end = 20 + u32::from_le_bytes([bytes[12], bytes[13], bytes[14], bytes[15]]) as usize;
    let json: Value = serde_json::from_slice(&bytes[20..text_end]).unwrap();
    let file = File { json, bin: bytes[text_end + 8..].to_vec() };
    let mut places = Vec::new();
    numbers(&file.json, String::new(), &mut places);
    assert!(places.len() > 80, "{}", places.len());
    for place in &places {
        for absurd in [
            json!(0),
            json!(-1),
            json!(3),
            json!(255),
            json!(u32::MAX),
            json!(u64::MAX),
            json!(1e300),
            json!(0.5),
            Value::Null,
        ] {
            let mut broken = File { json: file.json.clone(), bin: file.bin.clone() };
            *broken.json.pointer_mut(place).unwrap() = absurd;
            survives(&broken.bytes());
        }
    }
}

/// JSON pointers of all numbers below `value`.
fn numbers(value: &Value, place: String, places: &mut Vec<String>) {
    match value {
        Value::Number(_) => places.push(place),
        Value::Array(values) => {
            values.iter().enumerate().for_each(|(i, value)| numbers(value, format!("{place}/{i}"), places));
        }
        Value::Object(values) => {
            values.iter().for_each(|(key, value)| numbers(value, format!("{place}/{key}"), places));
        }
        _ => {}
    }
}
