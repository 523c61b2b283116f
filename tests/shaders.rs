//! The committed shaders are fresh, and agree with `shared` and the host on everything that no compiler checks.

use rspirv::spirv::{ExecutionModel, StorageClass};
use shader_builder::manifest::{Manifest, Toolchain};
use shared::interface::{HitPayload, PassConstants, ShadowPayload, WORKGROUP};
use shared::passes::{Pass, Rays, Stage};
use shared::resources::{Binding, set};
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
    let library: Vec<_> = candela_assets::MODULES.iter().map(|(stem, _)| *stem).collect();
    assert_eq!(library.len(), manifest.modules.len());
    for &(stem, code) in candela_assets::MODULES {
        assert!(manifest.modules.contains_key(stem), "{stem} is in the library and not in the manifest");
        let expected = match Pass::ALL.iter().find(|pass| pass.stem() == stem).map(|pass| pass.stage()) {
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
    for pass in Pass::ALL {
        assert!(library.contains(&pass.stem()), "pass {} has no shader", pass.stem());
    }
}

/// What elements of buffers are made of. One letter a scalar, in memory order.
fn scalars(element: &str) -> &'static str {
    match element {
        "u32" => "u",
        "UVec2" => "uu",
        "Vec2" => "ff",
        "Vec3" => "fff",
        "Vec4" => "ffff",
        "Aim" => "uu",
        "AliasEntry" => "uuff",
        "Cell" => "fffffffff",
        "Filtered" => "uuuuuuuu",
        "Smoothed" => "ffffffff",
        "ListEntry" => "uf",
        "TreeNode" => "fffffffu",
        "BlockSums" => "fff",
        "EnvironmentTexel" => "fffu",
        "GBufferTexel" => "uuuuuuuu",
        "InstanceGeometry" => "fffufffufffufffffffffffffu",
        "InstanceMotion" => "fffffffffffffffu",
        "Light" => "fffufffuffffffff",
        "Material" => "ffffffffffffffuuuuuffffffuffffffuffffffuffffffu",
        "PairTargets" => "ffu",
        "ScenePoint" => "uuff",
        "StoredRay" => "fffufffu",
        "StoredPath" => "uuuuuuff",
        "StoredReservoir" => "uuff",
        "TileEntry" => "fffuuufu",
        "VertexAttributes" => "uuffu",
        _ => panic!("what is {element} made of?"),
    }
}

fn bound_at(place: (u32, u32)) -> Option<Binding> {
    Binding::ALL.iter().copied().find(|binding| (binding.set(), binding.number()) == place)
}

#[test]
fn buffers_have_the_layout_of_their_structs() {
    for &(stem, code) in candela_assets::MODULES {
        for (place, layout) in Spirv::parse(code).bindings() {
            let Some(binding) = bound_at(place) else { continue };
            let (scalars, size) = (scalars(binding.resource().element()), binding.resource().stride());
            let layout = layout.unwrap_or_else(|| panic!("{stem}: {binding:?} is no buffer"));
            let expected = Layout { scalars: scalars.into(), dense: true, stride: Some(size as u32) };
            assert_eq!(layout, expected, "{stem}: {binding:?}");
            assert_eq!(scalars.len() * 4, size, "the expectation itself");
        }
    }
}

#[test]
fn frame_constants_have_one_layout() {
    let size = size_of::<shared::frame::FrameConstants>();
    for &(stem, code) in candela_assets::MODULES {
        if let Some(Some(layout)) = Spirv::parse(code).bindings().remove(&(set::FRAME, set::CONSTANTS)) {
            assert!(
                layout.dense && layout.scalars.len() * 4 == size,
                "{stem}: {layout:?} is not {size} bytes"
            );
        }
    }
}

/// A shader binds nothing that its pass does not declare, and writes all that it declares to be written.
#[test]
fn passes_declare_what_their_shaders_use() {
    for pass in Pass::ALL {
        let drawn = pass.stage() == Stage::Raster;
        let parts = if drawn { &["_vertex", "", "_alpha_vertex", "_alpha"][..] } else { &[""] };
        let of_part =
            |part| Spirv::parse(candela_assets::spirv(&format!("{}{part}", pass.stem())).unwrap()).bindings();
        let used: BTreeSet<(u32, u32)> = parts.iter().flat_map(of_part).map(|(place, _)| place).collect();
        let declared =
            |place| bound_at(place).is_some_and(|binding| pass.uses().iter().any(|u| u.0 == binding));
        for &(set, number) in &used {
            let scene = set == set::SCENE && (drawn || number == set::STRUCTURE || number == set::TEXTURES);
            let past = (set, number) == (set::PAST, set::STRUCTURE);
            let constants = (set, number) == (set::FRAME, set::CONSTANTS);
            assert!(
                scene || past || constants || declared((set, number)),
                "{pass:?} binds {number} of set {set} without a word"
            );
        }
        for (binding, access) in pass.uses() {
            // What is drawn is copied to the buffer.
            let found = used.contains(&(binding.set(), binding.number()));
            assert!(found || drawn || !access.writes(), "{pass:?} does not write {binding:?}");
        }
    }
}

#[test]
fn payloads_and_push_constants_have_one_layout() {
    let hit = Layout { scalars: "uuuffu".into(), dense: true, stride: None };
    let shadow = Layout { scalars: "uu".into(), dense: true, stride: None };
    assert_eq!((size_of::<HitPayload>(), size_of::<ShadowPayload>()), (24, 8));
    let incoming = |stem| {
        Spirv::parse(candela_assets::spirv(stem).unwrap()).layouts_of(StorageClass::IncomingRayPayloadNV)
    };
    assert_eq!(incoming("closest_hit"), [hit]);
    assert_eq!(incoming("shadow_miss"), [shadow]);
    assert_eq!(incoming("primary_any_hit"), incoming("closest_hit"));
    assert_eq!(incoming("shadow_any_hit"), incoming("shadow_miss"));
    for pass in Pass::ALL {
        let module = Spirv::parse(candela_assets::spirv(pass.stem()).unwrap());
        let expected = match pass.stage() {
            Stage::RayTracing(Rays::Primary) => incoming("closest_hit"),
            Stage::RayTracing(Rays::Shadow) => incoming("shadow_miss"),
            Stage::RayTracing(Rays::Both | Rays::Bounces) => {
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
        assert_eq!(sorted(payloads), sorted(expected), "{}", pass.stem());
        for constants in module.layouts_of(StorageClass::PushConstant) {
            assert!(
                constants.dense && constants.scalars.len() * 4 == size_of::<PassConstants>(),
                "{}",
                pass.stem()
            );
        }
        if pass.stage() == Stage::Compute {
            assert_eq!(module.workgroup(), Some([WORKGROUP[0], WORKGROUP[1], 1]), "{}", pass.stem());
        }
    }
}
