//! `candela info`: what a scene contains.

use super::args::InfoArgs;
use super::view;
use crate::error::Result;
use crate::gpu_scene::arrays::SceneArrays;
use crate::scene::SceneDescription;
use crate::scene::lights::LightTable;
use shared::frame::features;
use shared::light::kind;

pub fn run(args: &InfoArgs) -> Result<()> {
    let scene = view::load_scene(&args.scene)?;
    let lights = LightTable::new(&scene);
    let arrays = SceneArrays::new(&scene, &lights)?;
    print_geometry(&scene);
    print_lights(&lights);
    print_memory(&scene, &lights, &arrays);
    Ok(())
}

fn print_geometry(scene: &SceneDescription) {
    let bounds = scene.bounds();
    let e = bounds.extent();
    println!("{}", scene.name);
    println!(
        "  triangles   {} in {} instances of {} meshes",
        scene.triangle_count(),
        scene.instances.len(),
        scene.meshes.len()
    );
    println!("  bounds      {:.3} x {:.3} x {:.3} m around {:.3}", e.x, e.y, e.z, bounds.center());
    println!("  materials   {}, textures {}", scene.materials.len(), scene.textures.len());
    let names: Vec<_> = scene.cameras.iter().map(|camera| camera.name.as_str()).collect();
    println!(
        "  cameras     {}",
        if names.is_empty() { "none (one is fitted)".into() } else { names.join(", ") }
    );
}

fn print_lights(lights: &LightTable) {
    let of_kind = |k| lights.lights.iter().filter(|light| light.kind == k).count();
    let flux: f64 = lights.lights.iter().map(|light| f64::from(light.power)).sum();
    println!(
        "  lights      {} points, {} spots, {} directional, {} triangles, {} of an environment, {flux:.1} lm",
        of_kind(kind::POINT),
        of_kind(kind::SPOT),
        of_kind(kind::DIRECTIONAL),
        of_kind(kind::TRIANGLE),
        of_kind(kind::ENVIRONMENT)
    );
}

fn print_memory(scene: &SceneDescription, lights: &LightTable, arrays: &SceneArrays) {
    let mib = |bytes: usize| bytes as f64 / (1 << 20) as f64;
    let vertices = size_of_val(&arrays.positions[..]) + size_of_val(&arrays.attributes[..]);
    println!(
        "  memory      vertices {:.1} MiB, indices {:.1} MiB",
        mib(vertices),
        mib(size_of_val(&arrays.indices[..]))
    );
    let table = size_of_val(&lights.lights[..]) + size_of_val(&lights.alias[..]);
    let mut images: Vec<_> = scene.textures.iter().map(|t| std::sync::Arc::as_ptr(&t.image)).collect();
    images.sort_unstable();
    images.dedup();
    println!("              lights and alias table {:.1} MiB, {} images", mib(table), images.len());
    let on = |bit| if arrays.features & bit != 0 { "yes" } else { "no" };
    println!(
        "  features    textures: {}, normal maps: {}",
        on(features::TEXTURES),
        on(features::NORMAL_MAPS)
    );
}
