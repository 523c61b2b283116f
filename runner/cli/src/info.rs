//! `candela info`: what a scene contains, what each of its features costs, and what is left out.

use super::args::{DeviceArgs, SceneArgs};
use super::pipelines;
use super::view;
use candela::error::Result;
use candela::gpu_scene::GpuScene;
use candela::gpu_scene::arrays::SceneArrays;
use candela::gpu_scene::memory::{self, Cost};
use candela::knobs::Knobs;
use candela::scene::lights::LightTable;
use candela::scene::{AlphaMode, Material, Primitive, SceneDescription, Workflow, emission};
use candela::vulkan::executables::Executable;
use candela::vulkan::{Device, DeviceOptions};
use clap::Args;
use glam::{DVec3, Vec3};
use serde::Serialize;
use shared::frame::features;
use shared::light::count::LightCount;

/// Everything that is said of a scene.
#[derive(Debug, Serialize)]
struct Info {
    name: String,
    triangles: usize,
    meshes: usize,
    instances: usize,
    /// In the file's world, m
    bounds_min: [f64; 3],
    bounds_max: [f64; 3],
    /// The point of it that positions are kept relative to on the device, m
    origin: [f64; 3],
    cameras: Vec<String>,
    lights: usize,
    /// lm
    flux: f64,
    features: Vec<String>,
    memory: Vec<Cost>,
    /// Bytes, on the device that a picture would be rendered on; none without one.
    acceleration_structures: Option<u64>,
    /// Passes and what they were compiled to; none if that was not asked for, or without a device that tells.
    #[serde(skip_serializing_if = "Option::is_none")]
    pipelines: Option<Vec<(&'static str, Vec<Executable>)>>,
    /// What the file has and a picture does not show, with the reasons.
    left_out: Vec<String>,
}

#[derive(Args, Clone, Debug)]
pub struct InfoArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Add the driver's statistics of each pass for this scene: registers, spills, instructions.
    #[arg(long)]
    pub pipelines: bool,
    #[command(flatten)]
    pub device: DeviceArgs,
    /// Print one JSON object.
    #[arg(long)]
    pub json: bool,
}

pub fn run(args: &InfoArgs) -> Result<()> {
    let scene = view::load(&args.scene)?;
    let lights = LightTable::new(&scene);
    let arrays = SceneArrays::new(&scene, &lights)?;
    let bounds = scene.bounds();
    let in_file = |p: Vec3| (scene.origin + p.as_dvec3()).to_array();
    let mut memory = memory::costs(&scene, &lights, &arrays);
    let light_count = LightCount::of(&lights.lights);
    if Knobs::default().settings(light_count).cells != 0 {
        memory.push(memory::light_tree(light_count));
    }
    let on_device = on_device(args, &scene)?;
    let info = Info {
        name: scene.name.clone(),
        triangles: scene.triangle_count(),
        meshes: scene.meshes.len(),
        instances: scene.instances.len(),
        bounds_min: in_file(bounds.min),
        bounds_max: in_file(bounds.max),
        origin: scene.origin.to_array(),
        cameras: scene.cameras.iter().map(|camera| camera.name.clone()).collect(),
        lights: lights.lights.len(),
        flux: lights.lights.iter().map(|light| f64::from(light.power)).sum(),
        features: features(&scene, &arrays),
        memory,
        acceleration_structures: on_device.acceleration,
        pipelines: on_device.pipelines,
        left_out: scene.warnings.clone(),
    };
    if args.json {
        // A tree of numbers and strings: it has a JSON form.
        println!("{:#}", serde_json::to_value(&info).unwrap_or_default());
    } else {
        print(&info);
        info.pipelines.iter().flatten().for_each(|(pass, executables)| pipelines::print(pass, executables));
        if let Some(reason) = on_device.silent {
            println!("  pipelines: {reason}");
        }
    }
    Ok(())
}

/// What only a device can say.
#[derive(Default)]
struct OnDevice {
    acceleration: Option<u64>,
    pipelines: Option<Vec<(&'static str, Vec<Executable>)>>,
    /// Why nothing is said of pipelines that were asked for.
    silent: Option<String>,
}

/// Built to be measured; a machine without a device still tells all the rest.
fn on_device(args: &InfoArgs, scene: &SceneDescription) -> Result<OnDevice> {
    let options = DeviceOptions { pipeline_statistics: args.pipelines, ..args.device.options() };
    let device = match Device::new(&options) {
        Ok(device) => device,
        Err(error) => {
            let silent = args.pipelines.then(|| error.to_string());
            return Ok(OnDevice { silent, ..OnDevice::default() });
        }
    };
    let Ok(scene) = GpuScene::new(&device, scene) else { return Ok(OnDevice::default()) };
    let acceleration = Some(scene.acceleration_bytes());
    if !args.pipelines {
        return Ok(OnDevice { acceleration, ..OnDevice::default() });
    }
    if !device.has_pipeline_statistics() {
        let name = &device.info().name;
        let silent = Some(format!("{name} does not offer VK_KHR_pipeline_executable_properties"));
        return Ok(OnDevice { acceleration, silent, ..OnDevice::default() });
    }
    Ok(OnDevice { acceleration, pipelines: Some(pipelines::executables(&device, &scene)?), silent: None })
}

/// Whether a material has something.
type Has<'a> = &'a dyn Fn(&Material) -> bool;

/// What pipelines are specialised for, and what materials and meshes make use of.
fn features(scene: &SceneDescription, arrays: &SceneArrays) -> Vec<String> {
    let mut found = Vec::new();
    for (bit, name) in [
        (features::TEXTURES, "textures"),
        (features::NORMAL_MAPS, "normal maps"),
        (features::UV_MAPS, "texture transforms or a second uv set"),
        (features::ENVIRONMENT, "an environment map"),
        (features::SMOOTH, "curved surfaces"),
    ] {
        if arrays.features & bit != 0 {
            found.push(name.to_owned());
        }
    }
    let triangles = |has: Has| -> usize {
        let counts = |p: &&Primitive| has(&scene.materials[p.material]);
        let of_mesh = |mesh: usize| -> usize {
            scene.meshes[mesh].primitives.iter().filter(counts).map(|p| p.indices.len() / 3).sum()
        };
        scene.instances.iter().map(|instance| of_mesh(instance.mesh)).sum()
    };
    let materials: [(&str, Has); 7] = [
        ("masked, through any-hit shaders", &|m| matches!(m.alpha, AlphaMode::Mask { .. })),
        ("blended, through any-hit shaders", &|m| m.alpha == AlphaMode::Blend),
        ("double-sided", &|m| m.double_sided),
        ("specular-glossiness", &|m| m.workflow == Workflow::SpecularGlossiness),
        ("unlit", &|m| m.unlit),
        ("emissive", &|m| m.emission != Vec3::ZERO),
        ("of them with an emissive texture", &emission::is_textured),
    ];
    for (name, has) in materials {
        let count = triangles(has);
        if count > 0 {
            found.push(format!("{count} triangles {name}"));
        }
    }
    let colored = |p: &Primitive| !p.colors.is_empty();
    if scene.meshes.iter().any(|mesh| mesh.primitives.iter().any(colored)) {
        found.push("vertex colors".into());
    }
    let mirrored = scene.instances.iter().filter(|i| i.transform.matrix3.determinant() < 0.0).count();
    if mirrored > 0 {
        found.push(format!("{mirrored} mirrored instances"));
    }
    found
}

fn print(info: &Info) {
    let [min, max] = [info.bounds_min, info.bounds_max].map(DVec3::from_array);
    let (e, center) = (max - min, 0.5 * (min + max));
    let cameras =
        if info.cameras.is_empty() { "none (one is fitted)".to_owned() } else { info.cameras.join(", ") };
    let (triangles, instances, meshes) = (info.triangles, info.instances, info.meshes);
    println!("{}", info.name);
    println!("  triangles   {triangles} in {instances} instances of {meshes} meshes");
    println!("  bounds      {:.3} x {:.3} x {:.3} m around {center:.3}", e.x, e.y, e.z);
    if info.origin != [0.0; 3] {
        println!(
            "  origin      {:.3}: positions are stored relative to it, as the scene is far from zero",
            DVec3::from_array(info.origin)
        );
    }
    println!("  cameras     {cameras}");
    println!("  lights      {}, {:.1} lm", info.lights, info.flux);
    list("features", &info.features);
    println!("  device memory");
    for cost in &info.memory {
        println!("    {:<22} {:>10}  {}", cost.feature, bytes(cost.bytes), cost.detail);
    }
    match info.acceleration_structures {
        Some(size) => println!("    {:<22} {:>10}", "acceleration", bytes(size)),
        None => println!("    {:<22} {:>10}  no device here to build them", "acceleration", "?"),
    }
    list("left out", &info.left_out);
}

fn list(name: &str, lines: &[String]) {
    println!("  {name}{}", if lines.is_empty() { ": none" } else { "" });
    for line in lines {
        println!("    {line}");
    }
}

fn bytes(n: u64) -> String {
    match n {
        0..1024 => format!("{n} B"),
        1024..1_048_576 => format!("{:.1} KiB", n as f64 / 1024.0),
        _ => format!("{:.1} MiB", n as f64 / 1_048_576.0),
    }
}
