//! The sample models of the Khronos Group that a folder `../shared/gltf` beside the checkout may hold: what is in them
//! must arrive. Elsewhere these tests say that they are skipped.

use super::*;
use crate::gpu_scene::arrays::SceneArrays;
use crate::scene::lights::{LightTable, is_lit};
use crate::scene::{AlphaMode, Workflow};
use shared::frame::features::{ALPHA, LIGHT_KINDS, NORMAL_MAPS, SMOOTH, TEXTURES, TRACEABLE, UV_MAPS};

/// The .gltf of a model; none where there is no such folder.
fn model(name: &str) -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/gltf");
    let path = folder.join(name).join("glTF").join(format!("{name}.gltf"));
    if !path.exists() {
        println!("skipped: no {}", path.display());
        return None;
    }
    Some(path)
}

struct Expected {
    name: &'static str,
    triangles: usize,
    instances: usize,
    meshes: usize,
    materials: usize,
    textures: usize,
    points: usize,
    features: u32,
    /// Parts of the warnings, in their order.
    warnings: &'static [&'static str],
}

const OCCLUSION: &str = "occlusion textures are not read";

#[rustfmt::skip]
const MODELS: [Expected; 11] = [
    Expected { name: "AlphaBlendModeTest", triangles: 61, instances: 9, meshes: 9, materials: 6, textures: 4, points: 0,
        features: TEXTURES | NORMAL_MAPS | ALPHA, warnings: &[OCCLUSION] },
    Expected { name: "EmissiveStrengthTest", triangles: 90, instances: 6, meshes: 6, materials: 6, textures: 1, points: 0,
        features: TEXTURES | TRACEABLE, warnings: &[] },
    Expected { name: "LightsPunctualLamp", triangles: 6000, instances: 3, meshes: 3, materials: 3, textures: 6, points: 5,
        features: TEXTURES | NORMAL_MAPS | ALPHA, warnings: &["the picture lacks transmission that varies"] },
    Expected { name: "NegativeScaleTest", triangles: 7724, instances: 11, meshes: 8, materials: 6, textures: 2, points: 0,
        features: TEXTURES, warnings: &[] },
    Expected { name: "NormalTangentTest", triangles: 7774, instances: 1, meshes: 1, materials: 1, textures: 3, points: 0,
        features: TEXTURES | NORMAL_MAPS, warnings: &[OCCLUSION] },
    Expected { name: "OrientationTest", triangles: 524, instances: 13, meshes: 13, materials: 7, textures: 0, points: 0,
        features: 0, warnings: &[] },
    Expected { name: "SpecGlossVsMetalRough", triangles: 9028, instances: 4, meshes: 4, materials: 4, textures: 7, points: 0,
        features: TEXTURES | NORMAL_MAPS, warnings: &[OCCLUSION] },
    Expected { name: "TextureTransformTest", triangles: 24, instances: 12, meshes: 9, materials: 9, textures: 5, points: 0,
        features: TEXTURES | UV_MAPS, warnings: &[] },
    Expected { name: "VertexColorTest", triangles: 36, instances: 2, meshes: 2, materials: 2, textures: 2, points: 0,
        features: TEXTURES, warnings: &[] },
    Expected { name: "MetalRoughSpheresNoTextures", triangles: 1_040_213, instances: 102, meshes: 102, materials: 99,
        textures: 0, points: 0, features: 0, warnings: &["196 triangles without an area are left out: mesh 0 'Sphere'"] },
    Expected { name: "SciFiHelmet", triangles: 23358, instances: 1, meshes: 1, materials: 1, textures: 3, points: 0,
        features: TEXTURES | NORMAL_MAPS,
        warnings: &[OCCLUSION, "_BaseColor.png", "_MetallicRoughness.png", "_Normal.png"] },
];

#[test]
fn every_model_arrives_whole() {
    for expected in MODELS {
        let Some(path) = model(expected.name) else { continue };
        let scene = load(&path).unwrap();
        let counts =
            (scene.triangle_count(), scene.instances.len(), scene.meshes.len(), scene.materials.len());
        let Expected { name, triangles, instances, meshes, materials, .. } = expected;
        assert_eq!(counts, (triangles, instances, meshes, materials), "{name}");
        assert_eq!(
            (scene.textures.len(), scene.lights.len()),
            (expected.textures, expected.points),
            "{name}"
        );
        assert_eq!(
            SceneArrays::new(&scene, &LightTable::new(&scene)).unwrap().features & !(LIGHT_KINDS | SMOOTH),
            expected.features,
            "{name}"
        );
        assert_eq!(scene.warnings.len(), expected.warnings.len(), "{name}: {:#?}", scene.warnings);
        for (warning, part) in scene.warnings.iter().zip(expected.warnings) {
            assert!(warning.contains(part), "{name}: '{part}' is missing in: {warning}");
        }
    }
}

/// Strengths 1, 2, 4, 8, 16 of five cubes; their flux must be in the same ratios.
#[test]
fn emissive_strengths_are_flux() {
    let Some(path) = model("EmissiveStrengthTest") else { return };
    let lights = LightTable::new(&load(&path).unwrap()).lights;
    let mut cubes: Vec<f64> =
        lights.chunks(12).map(|cube| cube.iter().map(|light| f64::from(light.power)).sum()).collect();
    cubes.sort_by(f64::total_cmp);
    let ratios: Vec<f64> = cubes.windows(2).map(|pair| pair[1] / pair[0]).collect();
    assert!(ratios.len() == 4 && ratios.iter().all(|r| (r - 2.0).abs() < 1e-3), "{ratios:?}");
}

/// The bottles glow where their emissive texture is not black: few triangles, none of them dark.
#[test]
fn the_bottles_glow_in_parts() {
    let Some(path) = model("SpecGlossVsMetalRough") else { return };
    let scene = load(&path).unwrap();
    let workflows: Vec<_> = scene.materials.iter().map(|material| material.workflow).collect();
    assert!(
        workflows.contains(&Workflow::SpecularGlossiness) && workflows.contains(&Workflow::MetallicRoughness)
    );
    let table = LightTable::new(&scene);
    assert!(is_lit(&scene) && table.lights.iter().all(|light| light.power > 0.0));
    assert!(table.textured == table.lights.len() && table.lights.len() > 100, "{}", table.lights.len());
}

#[test]
fn alpha_modes_are_all_there() {
    let Some(path) = model("AlphaBlendModeTest") else { return };
    let modes: Vec<AlphaMode> =
        load(&path).unwrap().materials.iter().map(|material| material.alpha).collect();
    for mode in [
        AlphaMode::Opaque,
        AlphaMode::Blend,
        AlphaMode::Mask { cutoff: 0.25 },
        AlphaMode::Mask { cutoff: 0.75 },
    ] {
        assert!(modes.contains(&mode), "{mode:?} is missing in {modes:?}");
    }
}
