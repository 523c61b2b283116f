//! Materials, textures and what stands in for missing ones.

use super::*;
use crate::scene::{AlphaMode, Filter, Material, Mips, Workflow, Wrap};
use glam::{Vec2, Vec4};
use shared::material::UvMap;
use std::sync::Arc;

fn loaded(material: Value) -> (Material, Vec<String>) {
    let mut file = File::quad();
    file.material(material);
    let scene = file.load().unwrap();
    (scene.materials[0].clone(), scene.warnings)
}

#[test]
fn factors_follow_the_specification() {
    // No material at all: ours.
    let plain = File::quad().load().unwrap().materials[0].clone();
    assert_eq!((plain.metallic, plain.roughness), (0.0, 1.0));
    // An empty one: glTF's.
    let (empty, warnings) = loaded(json!({}));
    assert_eq!((empty.metallic, empty.roughness, empty.base_color), (1.0, 1.0, Vec4::ONE));
    assert!(warnings.is_empty());
    let (full, _) = loaded(json!({
        "name": "lamp", "doubleSided": true, "emissiveFactor": [1, 0.5, 0],
        "pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.2, 0.3, 1], "metallicFactor": 0.25, "roughnessFactor": 0.5},
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 40}},
    }));
    assert_eq!((full.name.as_str(), full.double_sided), ("lamp", true));
    assert_eq!((full.metallic, full.roughness, full.base_color), (0.25, 0.5, Vec4::new(0.1, 0.2, 0.3, 1.0)));
    assert_eq!(full.emission, Vec3::new(40.0, 20.0, 0.0));
}

#[test]
fn specular_glossiness_is_read() {
    let (m, warnings) = loaded(json!({"name": "s", "extensions": {"KHR_materials_pbrSpecularGlossiness":
        {"diffuseFactor": [0.5, 0.25, 0.5, 0.75], "specularFactor": [0.1, 0.2, 0.3], "glossinessFactor": 0.75}}}));
    assert_eq!((m.workflow, m.roughness), (Workflow::SpecularGlossiness, 0.25));
    assert_eq!((m.base_color, m.specular), (Vec4::new(0.5, 0.25, 0.5, 0.75), Vec3::new(0.1, 0.2, 0.3)));
    assert!(warnings.is_empty(), "{warnings:?}");
}

#[test]
fn alpha_modes_are_read() {
    assert_eq!(loaded(json!({})).0.alpha, AlphaMode::Opaque);
    assert_eq!(loaded(json!({"alphaMode": "MASK"})).0.alpha, AlphaMode::Mask { cutoff: 0.5 });
    let cut = loaded(json!({"alphaMode": "MASK", "alphaCutoff": 0.25}));
    assert_eq!((cut.0.alpha, cut.1.len()), (AlphaMode::Mask { cutoff: 0.25 }, 0));
    assert_eq!(loaded(json!({"alphaMode": "BLEND"})).0.alpha, AlphaMode::Blend);
}

/// An unlit surface shows its base color, and no other texture counts.
#[test]
fn unlit_and_refraction_are_read() {
    let (unlit, warnings) = loaded(json!({"emissiveFactor": [1, 1, 1],
        "extensions": {"KHR_materials_unlit": {}}}));
    assert!(unlit.unlit && unlit.emission == Vec3::ZERO && warnings.is_empty());
    let (glass, _) = loaded(json!({"extensions": {"KHR_materials_ior": {"ior": 2.0}}}));
    assert!((glass.specular - Vec3::splat(1.0 / 9.0)).length() < 1e-6);
    assert_eq!(loaded(json!({})).0.specular, Vec3::splat(0.04));
}

#[test]
fn one_image_serves_color_and_data() {
    let mut file = File::quad();
    let texture = file.texture(&png([1, 2, 3]));
    file.json["samplers"] = json!([{"magFilter": 9728, "wrapS": 33071, "wrapT": 33648}]);
    file.json["textures"][texture]["sampler"] = json!(0);
    let reference = json!({"index": texture});
    file.material(json!({"pbrMetallicRoughness":
        {"baseColorTexture": reference, "metallicRoughnessTexture": reference}}));
    let scene = file.load().unwrap();
    let [color, data] = &scene.textures[..] else { panic!("{} textures", scene.textures.len()) };
    assert_eq!(scene.materials[0].base_color_texture, Some(0));
    assert_eq!(scene.materials[0].reflectance_texture, Some(1));
    assert!(color.srgb && !data.srgb && Arc::ptr_eq(&color.image, &data.image));
    assert_eq!((color.image.width, color.image.height, &color.image.texels[..]), (1, 1, &[1, 2, 3, 255][..]));
    assert_eq!(color.wrap, [Wrap::ClampToEdge, Wrap::MirroredRepeat]);
    // What the file leaves open is linear.
    assert_eq!(color.filter, Filter { magnify_linear: false, ..Filter::LINEAR });
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
}

#[test]
fn filters_are_read() {
    for (code, minify_linear, mips) in [
        (9728, false, Mips::None),
        (9729, true, Mips::None),
        (9984, false, Mips::Nearest),
        (9985, true, Mips::Nearest),
        (9986, false, Mips::Linear),
        (9987, true, Mips::Linear),
    ] {
        let mut file = File::quad();
        let texture = file.texture(&png([1, 2, 3]));
        file.json["samplers"] = json!([{"magFilter": 9729, "minFilter": code}]);
        file.json["textures"][texture]["sampler"] = json!(0);
        file.material(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": texture}}}));
        let filter = file.load().unwrap().textures[0].filter;
        assert_eq!(filter, Filter { magnify_linear: true, minify_linear, mips }, "{code}");
    }
}

#[test]
fn textures_are_shared_by_materials() {
    let mut file = File::quad();
    let texture = file.texture(&png([1, 2, 3]));
    let mut second = file.primitive().clone();
    for primitive in 0..2 {
        file.material(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": texture}}}));
        if primitive == 0 {
            second["material"] = file.primitive()["material"].clone();
        }
    }
    push(&mut file.json["meshes"][0]["primitives"], second);
    let scene = file.load().unwrap();
    assert_eq!((scene.materials.len(), scene.textures.len()), (2, 1));
}

/// The extension's image counts; one that nobody can read falls back on core glTF's, and one without any on white.
#[test]
fn extensions_name_other_images() {
    let mut file = File::quad();
    let plain = file.texture(&png([1, 2, 3]));
    let mut webp = std::io::Cursor::new(Vec::new());
    image::RgbImage::from_pixel(1, 1, image::Rgb([4, 5, 6]))
        .write_to(&mut webp, image::ImageFormat::WebP)
        .unwrap();
    let sources = [file.texture(webp.get_ref()), file.texture(include_bytes!("ktx2/uastc.ktx2"))];
    for (texture, (name, source)) in
        ["EXT_texture_webp", "KHR_texture_basisu"].iter().zip(sources).enumerate()
    {
        file.json["textures"][texture] = json!({"source": plain, "extensions": {*name: {"source": source}}});
    }
    file.json["textures"][2] = json!({"extensions": {"EXT_texture_avif": {"source": 0}}});
    file.json["extensionsRequired"] = json!(["EXT_texture_webp", "KHR_texture_basisu"]);
    file.material(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0},
        "metallicRoughnessTexture": {"index": 1}}, "emissiveTexture": {"index": 2}, "emissiveFactor": [1, 1, 1]}));
    let scene = file.load().unwrap();
    let images: Vec<_> = scene.textures.iter().map(|texture| &texture.image).collect();
    assert_eq!(images[0].texels, [4, 5, 6, 255]);
    assert_eq!((images[1].width, images[1].height), (18, 10));
    assert_eq!(images[2].texels, [255; 4]);
    assert!(scene.warnings.iter().any(|w| w.contains("texture 2 (has no image")), "{:?}", scene.warnings);
}

/// Two images of one view are one image, so on the device too.
#[test]
fn images_that_name_the_same_bytes_are_one() {
    let mut file = File::quad();
    let first = file.texture(&png([1, 2, 3]));
    let again = file.json["images"][0].clone();
    let second = push(&mut file.json["images"], again);
    let other = push(&mut file.json["textures"], json!({"source": second}));
    file.material(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": first},
        "metallicRoughnessTexture": {"index": other}}}));
    let scene = file.load().unwrap();
    assert_eq!(scene.textures.len(), 2);
    assert!(std::sync::Arc::ptr_eq(&scene.textures[0].image, &scene.textures[1].image));
}

/// Nine images of 1 GiB by 104 bytes each: nothing of them is decoded.
#[test]
fn more_texels_than_memory_are_refused() {
    let file = |count: u8| {
        let mut file = File::quad();
        let plain = file.primitive().clone();
        for _ in 0..count {
            let mut header = vec![0; 104];
            header[..12].copy_from_slice(b"\xabKTX 20\xbb\r\n\x1a\n");
            header[20..28].copy_from_slice(&[0, 64, 0, 0, 0, 64, 0, 0]);
            let texture = file.texture(&header);
            file.material(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": texture}}}));
            let worn = std::mem::replace(file.primitive(), plain.clone());
            push(&mut file.json["meshes"][0]["primitives"], worn);
        }
        file
    };
    assert!(file(9).reason().contains("2415919104 texels; 2147483648 (8 GiB) is the most"));
    let broken = file(8).load().unwrap().warnings;
    assert!(broken.iter().any(|w| w.contains("can't decode it")), "{broken:?}");
}

#[test]
fn missing_and_broken_images_have_stand_ins() {
    let mut file = File::quad();
    file.json["images"] = json!([{"uri": "nowhere.png"}]);
    file.json["textures"] = json!([{"source": 0}]);
    let broken = file.texture(b"no image");
    file.material(json!({"name": "m", "normalTexture": {"index": 0, "scale": 0.5},
        "pbrMetallicRoughness": {"baseColorTexture": {"index": broken}}}));
    let scene = file.load().unwrap();
    let texels = |texture: Option<usize>| scene.textures[texture.unwrap()].image.texels.clone();
    assert_eq!(texels(scene.materials[0].base_color_texture), [255; 4]);
    assert_eq!(texels(scene.materials[0].normal_texture), [128, 128, 255, 255]);
    assert_eq!(scene.materials[0].normal_scale, 0.5);
    let warned =
        |part: &str| scene.warnings.iter().any(|w| w.contains(part) && w.ends_with("material 0 'm'"));
    assert!(warned("nowhere.png") && warned("can't decode it"), "{:?}", scene.warnings);
    // A normal map needs tangents.
    assert_eq!(scene.meshes[0].primitives[0].tangents, [Vec4::new(1.0, 0.0, 0.0, 1.0); 4]);
}

#[test]
fn images_beside_the_file_are_found() {
    let folder = Folder::new("images");
    folder.write("a b.png", &png([9, 8, 7]));
    let mut file = File::quad();
    file.json["images"] = json!([{"uri": "a%20b.png"}]);
    file.json["textures"] = json!([{"source": 0}]);
    file.material(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}));
    let scene = load(&folder.write("quad.glb", &file.bytes())).unwrap();
    assert_eq!(scene.textures[0].image.texels, [9, 8, 7, 255]);
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
}

#[test]
fn images_too_large_are_an_error() {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let (color, format) = (image::ColorType::L8, image::ImageFormat::Png);
    image::write_buffer_with_format(&mut bytes, &[0; 20_000], 20_000, 1, color, format).unwrap();
    let mut file = File::quad();
    let texture = file.texture(&bytes.into_inner());
    file.material(json!({"name": "m", "emissiveFactor": [1, 1, 1], "emissiveTexture": {"index": texture}}));
    assert!(file.reason().contains("material 0 'm': image 0: 20000 x 1 px"), "{}", file.reason());
}

#[test]
fn bad_emission_is_an_error() {
    let mut file = File::quad();
    file.material(json!({"emissiveFactor": [1, 1, 1],
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": -1}}}));
    assert!(file.reason().contains("material 0: emission"), "{}", file.reason());
}

/// KHR_texture_transform: scale, then a turn that is counter-clockwise as seen (v down), then offset.
#[test]
fn coordinates_are_transformed() {
    let mut file = File::quad();
    let texture = file.texture(&png([1, 2, 3]));
    let quarter = std::f32::consts::FRAC_PI_2;
    let transform = json!({"offset": [0.5, 0], "scale": [2, 1], "rotation": quarter});
    let moved = json!({"index": texture, "extensions": {"KHR_texture_transform": transform}});
    file.material(json!({"normalTexture": moved,
        "pbrMetallicRoughness": {"baseColorTexture": moved, "metallicRoughnessTexture": {"index": texture}}}));
    let scene = file.load().unwrap();
    let [base_color, reflectance, normal, _] = scene.materials[0].uv_maps;
    let uvs = &scene.meshes[0].primitives[0].uvs;
    assert_eq!(uvs[..], [Vec2::Y, Vec2::ONE, Vec2::X, Vec2::ZERO]);
    // (u, v) -> (2u, v) -> (v, -2u) -> + (0.5, 0)
    let expected = [Vec2::new(1.5, 0.0), Vec2::new(1.5, -2.0), Vec2::new(0.5, -2.0), Vec2::new(0.5, 0.0)];
    for map in [base_color, normal] {
        assert!(uvs.iter().zip(expected).all(|(uv, e)| (map.apply(*uv) - e).length() < 1e-6), "{map:?}");
    }
    assert_eq!(reflectance, UvMap::default());
    // The normal map's own axes: its u grows along v, downwards here.
    let tangent = scene.meshes[0].primitives[0].tangents[0];
    assert!((tangent.truncate() + Vec3::Y).length() < 1e-5, "{tangent}");
}

#[test]
fn two_sets_of_coordinates_are_kept() {
    let mut file = File::quad();
    file.attribute("TEXCOORD_1", &floats(&[0.25; 8]), 5126, "VEC2");
    file.attribute("TEXCOORD_2", &floats(&[0.5; 8]), 5126, "VEC2");
    let texture = file.texture(&png([1, 2, 3]));
    let reads = |set: u32| json!({"index": texture, "texCoord": set});
    file.material(json!({"pbrMetallicRoughness":
        {"baseColorTexture": reads(2), "metallicRoughnessTexture": reads(1)}, "normalTexture": reads(2)}));
    let scene = file.load().unwrap();
    let primitive = &scene.meshes[0].primitives[0];
    assert!(primitive.uvs.iter().all(|&uv| uv == Vec2::splat(0.5)));
    assert!(
        primitive.second_uvs.iter().all(|&uv| uv == Vec2::splat(0.25)) && primitive.second_uvs.len() == 4
    );
    assert_eq!(scene.materials[0].uv_maps.map(|map| map.set), [0, 1, 0, 0]);
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    // A third one is told.
    file.material(json!({"pbrMetallicRoughness":
        {"baseColorTexture": reads(2), "metallicRoughnessTexture": reads(1)}, "normalTexture": reads(0)}));
    assert!(file.load().unwrap().warnings[0].starts_with("textures with more than two sets"));
}

/// The closed form of the specification: min(f0 color, 1) factor.
#[test]
fn strength_and_color_of_reflections_are_read() {
    let of = |specular: Value| {
        loaded(json!({"extensions": {"KHR_materials_ior": {"ior": 3.0}, "KHR_materials_specular": specular}}))
    };
    let near = |a: Vec3, b: Vec3| (a - b).length() < 1e-6;
    assert!(near(of(json!({})).0.specular, Vec3::splat(0.25)));
    assert!(near(of(json!({"specularFactor": 0.5})).0.specular, Vec3::splat(0.125)));
    let (colored, warnings) = of(json!({"specularFactor": 0.5, "specularColorFactor": [1, 0.5, 8]}));
    assert!(near(colored.specular, Vec3::new(0.125, 0.0625, 0.5)), "{}", colored.specular);
    assert!(warnings.is_empty(), "{warnings:?}");
    let (_, warnings) = of(json!({"specularTexture": {"index": 0}}));
    assert!(warnings.iter().any(|line| line.contains("specularTexture")), "{warnings:?}");
    // Nonsense is as if it were not there.
    assert!(near(of(json!({"specularFactor": "a", "specularColorFactor": 3})).0.specular, Vec3::splat(0.25)));
}

/// What passes, what is reflected at normal incidence, and what is scattered add up to what the specification says.
#[test]
fn thin_surfaces_pass_light() {
    let of = |t: f32, base: f32, metallic: f32| {
        loaded(json!({
            "pbrMetallicRoughness": {"baseColorFactor": [base, base, base, 1], "metallicFactor": metallic},
            "extensions": {"KHR_materials_transmission": {"transmissionFactor": t}},
        }))
    };
    for (t, base) in [(1.0, 1.0), (1.0, 0.5), (0.5, 0.8), (0.1, 1.0)] {
        let (m, warnings) = of(t, base, 0.0);
        assert_eq!((m.alpha, warnings.len()), (AlphaMode::Blend, 1), "{warnings:?}");
        let alpha = m.base_color.w;
        assert!((1.0 - alpha - t * base * 0.96).abs() < 1e-5, "passes {}", 1.0 - alpha);
        assert!((alpha * m.specular.x - 0.04).abs() < 1e-5, "reflects {}", alpha * m.specular.x);
        assert!((alpha * m.base_color.x - (1.0 - t) * base).abs() < 1e-5, "scatters {}", m.base_color.x);
    }
    for (t, metallic) in [(0.0, 0.0), (1.0, 1.0)] {
        let (m, warnings) = of(t, 1.0, metallic);
        assert!(m.alpha == AlphaMode::Opaque && warnings.is_empty());
    }
    let textured = json!({"pbrMetallicRoughness": {"metallicFactor": 0},
        "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1, "transmissionTexture": {"index": 0}}}});
    let (m, warnings) = loaded(textured);
    assert!(m.alpha == AlphaMode::Opaque && warnings.len() == 1, "{warnings:?}");
}
