//! Streams that Google's encoder wrote (draco3dgltf), and broken ones.

use super::*;
use base64::Engine;
use glam::UVec2;
use shared::rng::{Rng, Stream};

/// 5 x 5 vertices at (x, y, xy/8), with uvs of (x, y)/4 and 32 triangles: what the encoder was given, to 14 and 12 bits.
fn grid(stream: &[u8]) -> File {
    let mut file = File::quad();
    let view = file.view(stream);
    let accessor = |kind: &str| json!({"componentType": 5126, "count": 25, "type": kind});
    let positions = push(&mut file.json["accessors"], accessor("VEC3"));
    let uvs = push(&mut file.json["accessors"], accessor("VEC2"));
    let indices =
        push(&mut file.json["accessors"], json!({"componentType": 5125, "count": 96, "type": "SCALAR"}));
    let draco = json!({"bufferView": view, "attributes": {"POSITION": 0, "TEXCOORD_0": 1}});
    *file.primitive() = json!({"attributes": {"POSITION": positions, "TEXCOORD_0": uvs}, "indices": indices,
        "extensions": {"KHR_draco_mesh_compression": draco}});
    file.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    file
}

fn bytes(base64: &str) -> Vec<u8> {
    base64::engine::general_purpose::STANDARD.decode(base64).unwrap()
}

#[test]
fn a_grid_comes_back() {
    for stream in [SEQUENTIAL, EDGEBREAKER] {
        let scene = grid(&bytes(stream)).load().unwrap();
        assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
        let p = &scene.meshes[0].primitives[0];
        assert_eq!(p.indices.len(), 96);
        for (p, uv) in p.positions.iter().zip(&p.uvs) {
            assert!(
                (p.z - p.x * p.y / 8.0).abs() < 2e-3 && (p.truncate() - 4.0 * *uv).length() < 4e-3,
                "{p} {uv}"
            );
        }
        // Each cell has its two triangles, seen from above.
        let mut cells: Vec<[i32; 2]> = corners(p)
            .iter()
            .map(|t| {
                assert!((t[1] - t[0]).cross(t[2] - t[0]).z > 0.0);
                let middle = (t[0] + t[1] + t[2]) / 3.0;
                [middle.x as i32, middle.y as i32]
            })
            .collect();
        cells.sort();
        let expected: Vec<[i32; 2]> = (0..32).map(|i| [i / 8, i / 2 % 4]).collect();
        assert_eq!(cells, expected);
    }
}

#[test]
fn what_is_broken_is_named() {
    let stream = bytes(EDGEBREAKER);
    let mut file = grid(&stream[..stream.len() / 2]);
    assert!(file.reason().starts_with("mesh 0, primitive 0: Draco: "), "{}", file.reason());
    file = grid(&stream);
    file.primitive()["extensions"]["KHR_draco_mesh_compression"]["bufferView"] = json!(99);
    assert!(file.reason().contains("KHR_draco_mesh_compression: buffer view 99 of"), "{}", file.reason());
    file = grid(&stream);
    file.primitive()["extensions"]["KHR_draco_mesh_compression"]["attributes"]["POSITION"] = json!(7);
    assert!(file.reason().contains("Draco: attribute 7 does not exist"), "{}", file.reason());
}

/// Whatever the bits: no panic.
#[test]
fn changed_streams_do_no_harm() {
    let mut rng = Rng::new(UVec2::new(5, 5), 0, 0, Stream::Initial, 0);
    let mut loaded = 0;
    for stream in [bytes(SEQUENTIAL), bytes(EDGEBREAKER)] {
        for _ in 0..500 {
            let mut broken = stream.clone();
            let random = rng.next_u32x4();
            for word in random.to_array().into_iter().take(1 + random.w as usize % 3) {
                let i = (word >> 8) as usize % broken.len();
                broken[i] = word as u8;
            }
            loaded += usize::from(grid(&broken).load().is_ok());
        }
    }
    assert!((10..990).contains(&loaded), "{loaded} of 1000 loaded");
}

const SEQUENTIAL: &str = "\
    RFJBQ08CAgEAAAAgGQEAAQUFAQYBAgYGAgcCAwcHAwgDBAgIBAkFBgoKBgsGBwsLBwwHCAwMCA0ICQ0NCQ4KCw8PCxALDBAQDBEMDRER\
    DRINDhISDhMPEBQUEBUQERUVERYREhYWEhcSExcXExgBAgAJAwAAAwkCAAECAgABAQAPA5ECK10PFS4GnwAlFYCAAAABAAAAAAQAAAD/\
    DwAAAAAIAAAAAgAACAAAgAAAAAEAAgAAhP8HAAAEAAQAAAgBAAD8fwBAAAAAAQABAADE/wMAAAQAAgAAiADw//8fAAQAABgAEAAAYPw/\
    AABgACAAAMAIAADg/wsAAgAAEAAIAABA/h8AAEAAEAAAgAAAAAAA/z8AAAABAQECgRAlHAMhBf//////////////////////////////\
    ///////////rsQcDDRcN+JEffTsO/kdDkkCTiwAAAAD/DwAAAAAAAAAAAAAAAAAAAACAQA4AAAAAAAAAAAAAgD8M";
const EDGEBREAKER: &str = "\
    RFJBQ08CAgEBAAAAGSABIAMACu/T6lOt6lPVqhr/ARH/AsxCAv8AAAAAAAEACQMAAAIBAwkCAAECAQEBAA8DIQUfRSHtEQMhBZECCJQn\
    EAlm9p+E////DwD9f///PwBA//8fAADwPwAC/A8AAAAQAAD+DwCA/wEI4H8AAACAAAAAAAEA4H8AAMD/AACA/wMA4H8BAPgfAAAAIAAA\
    AEAAAvgfAAAAIAAC/A8AAABQAAD+BwAAAAD/PwAAAAAAAAAAAAAAAAAAAACAQA4BAQEADQMVLj0KHyEFkQIGqKZ06v+h//////c/APoP\
    QgIACQgiAAAAAP8PAAAAAAAAAAAAAAAAgD8M";
