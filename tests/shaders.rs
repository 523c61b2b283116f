//! The committed shaders are fresh, and agree with `shared` and the host on everything that no compiler checks.

use candela::frame::pass::{Rays, Stage};
use candela::frame::passes;
use candela::shader_library;
use rspirv::spirv::{ExecutionModel, StorageClass};
use shader_builder::manifest::{Manifest, Toolchain};
use shared::interface::{
    HitPayload, PassConstants, ShadowPayload, WORKGROUP, frame_binding as frame, past_binding as past,
    scene_binding as scene,
};
use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;
use tests::spirv::{Layout, Spirv};

fn workspace() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new("."))
}

#[test]
fn committed_shaders_are_made_from_these_sources() {
    let manifest = Manifest::read(workspace()).unwrap();
    let stale = manifest.stale(workspace()).unwrap();
    assert!(stale.is_empty(), "run `cargo xtask shaders`:\n{}", stale.join("\n"));
}

/// Negative control: a changed byte in any input or output is seen.
#[test]
fn a_stale_manifest_is_noticed() {
    let fresh = Manifest::read(workspace()).unwrap();
    let tampers: [fn(&mut Manifest); 5] = [
        |m| drop(m.sources.insert("shared/src/light.rs".into(), "0".into())),
        |m| drop(m.sources.insert("shared/src/gone.rs".into(), "0".into())),
        |m| drop(m.dependencies.insert("glam".into(), "0.1".into())),
        |m| drop(m.modules.remove("shade")),
        |m| m.options.push('x'),
    ];
    for tamper in tampers {
        let mut manifest = fresh.clone();
        tamper(&mut manifest);
        assert_eq!(manifest.stale(workspace()).unwrap().len(), 1);
    }
}

/// Where the compiler that made the shaders is at hand, it makes the same bytes again.
#[test]
fn the_same_compiler_gives_the_same_bytes() {
    let Ok(toolchain) = Toolchain::from_environment() else {
        eprintln!("no shader compiler in the environment: nothing to compare");
        return;
    };
    if !Manifest::read(workspace()).unwrap().is_made_by(&toolchain).unwrap() {
        eprintln!("another shader compiler than the manifest's: nothing to compare");
        return;
    }
    let status = Command::new(env!("CARGO"))
        .args(["run", "--quiet", "--package", "shader-builder", "--", "--check"])
        .current_dir(workspace())
        .status()
        .unwrap();
    assert!(status.success(), "assets/shaders is not what the sources compile to");
}

#[test]
fn every_module_has_its_entry_point() {
    let manifest = Manifest::read(workspace()).unwrap();
    let library: Vec<_> = shader_library::MODULES.iter().map(|(stem, _)| *stem).collect();
    assert_eq!(library.len(), manifest.modules.len());
    for &(stem, code) in shader_library::MODULES {
        assert!(manifest.modules.contains_key(stem), "{stem} is in the library and not in the manifest");
        let expected = match passes::ALL.iter().find(|pass| pass.stem == stem).map(|pass| pass.stage) {
            Some(Stage::Compute) => ExecutionModel::GLCompute,
            Some(Stage::Raster) => ExecutionModel::Fragment,
            Some(Stage::RayTracing(_)) => ExecutionModel::RayGenerationNV,
            None if stem.ends_with("_vertex") => ExecutionModel::Vertex,
            None if stem.ends_with("_alpha") => ExecutionModel::Fragment,
            None if stem.ends_with("_miss") => ExecutionModel::MissNV,
            None if stem.ends_with("_any_hit") => ExecutionModel::AnyHitNV,
            None => ExecutionModel::ClosestHitNV,
        };
        assert_eq!(Spirv::parse(code).entry_points(), [(expected, stem.to_string())]);
    }
    for pass in passes::ALL {
        assert!(library.contains(&pass.stem), "pass {} has no shader", pass.stem);
    }
}

/// What a buffer's elements are made of, by its place. One letter a scalar, in memory order.
fn element(set: u32, binding: u32) -> Option<(&'static str, usize)> {
    use shared::{
        alias_table::AliasEntry, environment::EnvironmentTexel, geometry::*, light::Light,
        light::tile::TileEntry, material::Material, motion::InstanceMotion, resampling::pairs::PairTargets,
        reservoir::StoredReservoir, stored_ray::StoredRay, surface::GBufferTexel,
    };
    Some(match (set, binding) {
        (scene::SET, scene::INSTANCES) => ("fffufffufffufffffffffffffu", size_of::<InstanceGeometry>()),
        (scene::SET, scene::POSITIONS) => ("fff", 12),
        (scene::SET, scene::ATTRIBUTES) => ("uuffu", size_of::<VertexAttributes>()),
        (scene::SET, scene::INDICES) => ("u", 4),
        (scene::SET, scene::MATERIALS) => {
            ("ffffffffffffffuuuuuffffffuffffffuffffffuffffffu", size_of::<Material>())
        }
        (scene::SET, scene::SECOND_UVS) => ("ff", size_of::<glam::Vec2>()),
        (scene::SET, scene::LIGHTS) | (past::SET, past::LIGHTS) => ("fffufffuffffffff", size_of::<Light>()),
        (scene::SET, scene::ENVIRONMENT) => ("fffu", size_of::<EnvironmentTexel>()),
        (scene::SET, scene::ALIAS) => ("uuff", size_of::<AliasEntry>()),
        (frame::SET, frame::GBUFFER | frame::PREVIOUS_GBUFFER) => ("uuuuuuuu", size_of::<GBufferTexel>()),
        (frame::SET, frame::RESERVOIRS_IN | frame::RESERVOIRS_OUT | frame::RESERVOIRS_HISTORY) => {
            ("uuff", size_of::<StoredReservoir>())
        }
        (frame::SET, frame::PAIR_TARGETS) => ("ffu", size_of::<PairTargets>()),
        (frame::SET, frame::RADIANCE | frame::MEAN | frame::REFERENCE) => ("fff", 12),
        (frame::SET, frame::STATISTICS) => ("fff", 12),
        (frame::SET, frame::RAYS) => ("fffufffu", size_of::<StoredRay>()),
        (frame::SET, frame::DISPLAY | frame::HITS) => ("u", 4),
        (frame::SET, frame::TILE_ENTRIES) => ("fffuuufu", size_of::<TileEntry>()),
        (frame::SET, frame::VISIBILITY) => ("uu", size_of::<glam::UVec2>()),
        (frame::SET, frame::TILE_POINTS) => ("u", 4),
        (past::SET, past::MOTIONS) => ("fffffffffffffffu", size_of::<InstanceMotion>()),
        (past::SET, past::PREVIOUS_TO_CURRENT | past::CURRENT_TO_PREVIOUS) => ("u", 4),
        _ => return None,
    })
}

#[test]
fn buffers_have_the_layout_of_their_structs() {
    for &(stem, code) in shader_library::MODULES {
        for ((set, binding), layout) in Spirv::parse(code).bindings() {
            let Some((scalars, size)) = element(set, binding) else { continue };
            let layout =
                layout.unwrap_or_else(|| panic!("{stem}: set {set}, binding {binding} is no buffer"));
            let expected = Layout { scalars: scalars.into(), dense: true, stride: Some(size as u32) };
            assert_eq!(layout, expected, "{stem}: set {set}, binding {binding}");
            assert_eq!(scalars.len() * 4, size, "the expectation itself");
        }
    }
}

#[test]
fn frame_constants_have_one_layout() {
    let size = size_of::<shared::frame::FrameConstants>();
    for &(stem, code) in shader_library::MODULES {
        if let Some(Some(layout)) = Spirv::parse(code).bindings().remove(&(frame::SET, frame::CONSTANTS)) {
            assert!(
                layout.dense && layout.scalars.len() * 4 == size,
                "{stem}: {layout:?} is not {size} bytes"
            );
        }
    }
}

/// Set 1 of a shader is what its pass declares, no more and no less; set 0 has only what the scene provides.
#[test]
fn passes_declare_what_their_shaders_use() {
    for pass in passes::ALL {
        let drawn = pass.stage == Stage::Raster;
        let parts = if drawn { &["_vertex", "", "_alpha_vertex", "_alpha"][..] } else { &[""] };
        let bindings: BTreeSet<(u32, u32)> = parts
            .iter()
            .flat_map(|part| {
                Spirv::parse(shader_library::spirv(&format!("{}{part}", pass.stem)).unwrap()).bindings()
            })
            .map(|(place, _)| place)
            .collect();
        let used: Vec<u32> = bindings.iter().filter(|k| k.0 == frame::SET).map(|k| k.1).collect();
        let mut declared: Vec<u32> = pass.uses.iter().map(|(role, _)| role.binding()).collect();
        if drawn {
            // Its image is copied to the buffer that it declares.
            assert_eq!(declared, [frame::VISIBILITY]);
            declared.clear();
        }
        declared.push(frame::CONSTANTS);
        declared.sort_unstable();
        assert_eq!(used, declared, "{}", pass.stem);
        let of_the_past: Vec<u32> = bindings.iter().filter(|k| k.0 == past::SET).map(|k| k.1).collect();
        assert_eq!(!of_the_past.is_empty(), pass.past, "{}", pass.stem);
        assert!(of_the_past.iter().all(|&binding| binding <= past::CURRENT_TO_PREVIOUS));
        let known = |set: u32| [frame::SET, past::SET].contains(&set);
        assert!(bindings.iter().all(|k| known(k.0) || k.0 == scene::SET && k.1 <= scene::TEXTURES));
    }
}

#[test]
fn payloads_and_push_constants_have_one_layout() {
    let hit = Layout { scalars: "uuuffu".into(), dense: true, stride: None };
    let shadow = Layout { scalars: "uu".into(), dense: true, stride: None };
    assert_eq!((size_of::<HitPayload>(), size_of::<ShadowPayload>()), (24, 8));
    let incoming = |stem| {
        Spirv::parse(shader_library::spirv(stem).unwrap()).layouts_of(StorageClass::IncomingRayPayloadNV)
    };
    assert_eq!(incoming("closest_hit"), [hit]);
    assert_eq!(incoming("shadow_miss"), [shadow]);
    assert_eq!(incoming("primary_any_hit"), incoming("closest_hit"));
    assert_eq!(incoming("shadow_any_hit"), incoming("shadow_miss"));
    for pass in passes::ALL {
        let module = Spirv::parse(shader_library::spirv(pass.stem).unwrap());
        let expected = match pass.stage {
            Stage::RayTracing(Rays::Primary) => incoming("closest_hit"),
            Stage::RayTracing(Rays::Shadow) => incoming("shadow_miss"),
            Stage::RayTracing(Rays::Both) => {
                incoming("closest_hit").into_iter().chain(incoming("shadow_miss")).collect()
            }
            Stage::Compute | Stage::Raster => vec![],
        };
        // The compiler declares two payloads in any order.
        let sorted = |mut layouts: Vec<Layout>| {
            layouts.sort_by(|a, b| a.scalars.cmp(&b.scalars));
            layouts
        };
        let payloads = module.layouts_of(StorageClass::RayPayloadNV);
        assert_eq!(sorted(payloads), sorted(expected), "{}", pass.stem);
        for constants in module.layouts_of(StorageClass::PushConstant) {
            assert!(
                constants.dense && constants.scalars.len() * 4 == size_of::<PassConstants>(),
                "{}",
                pass.stem
            );
        }
        if pass.stage == Stage::Compute {
            assert_eq!(module.workgroup(), Some([WORKGROUP[0], WORKGROUP[1], 1]), "{}", pass.stem);
        }
    }
}
