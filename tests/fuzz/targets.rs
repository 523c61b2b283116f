//! What is fed, and with what.

use candela::knobs::Knobs;
use candela::scene::lights::LightTable;
use candela::scene::{EnvironmentSource, SceneDescription, environment, gltf};
use candela_lab::measure::sweep::plan::Plan;
use clap::ValueEnum;
use std::path::{Path, PathBuf};

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Target {
    /// glTF files, and the light table of what they load.
    Gltf,
    /// Environment maps.
    Environment,
    /// Settings documents.
    Settings,
    /// Plans of sweeps.
    Plan,
    /// Planted faults, which must be found.
    #[value(hide = true)]
    Planted,
}

impl Target {
    pub const ALL: [Target; 4] = [Target::Gltf, Target::Environment, Target::Settings, Target::Plan];

    /// Right files: (extension, bytes), in an order that does not depend on the machine.
    pub fn corpus(self) -> std::io::Result<Vec<(String, Vec<u8>)>> {
        let folders: &[&str] = match self {
            Target::Gltf => &["../assets/scenes", "fuzz/corpus/gltf"],
            Target::Environment => &["fuzz/corpus/environment"],
            Target::Settings | Target::Planted => &["fuzz/corpus/settings"],
            Target::Plan => &["../assets/plans", "fuzz/corpus/plan"],
        };
        let mut files: Vec<PathBuf> = Vec::new();
        for folder in folders {
            let entries = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder).read_dir()?;
            let mut paths = entries.map(|e| Ok(e?.path())).collect::<std::io::Result<Vec<_>>>()?;
            paths.sort();
            files.extend(paths);
        }
        let extension = |path: &Path| path.extension().unwrap_or_default().to_string_lossy().into_owned();
        files.iter().map(|path| Ok((extension(path), std::fs::read(path)?))).collect()
    }

    /// Reads the file as the program does. Errors are answers; the number is bytes of what came out of it.
    pub fn read(self, path: &Path) -> usize {
        match self {
            Target::Gltf => gltf::load(path).map_or(0, |scene| {
                let lights = LightTable::new(&scene);
                size_of_scene(&scene) + size_of_val(&lights.lights[..])
            }),
            Target::Environment => {
                let source = EnvironmentSource::new(path.into());
                environment::load(&source).map_or(0, |(map, _)| size_of_val(&map.radiance[..]))
            }
            Target::Settings => Knobs::read(path).map_or(0, |file| file.to_json().len()),
            Target::Plan => {
                Plan::read(path).map_or(0, |(plan, _)| plan.points().map_or(0, |points| points.len() * 1024))
            }
            Target::Planted => planted(&std::fs::read(path).unwrap_or_default()),
        }
    }
}

fn size_of_scene(scene: &SceneDescription) -> usize {
    let primitives = scene.meshes.iter().flat_map(|mesh| &mesh.primitives);
    // Position, normal, tangent, two uvs and a color.
    let geometry: usize = primitives.map(|p| 72 * p.positions.len() + 4 * p.indices.len()).sum();
    let texels: usize = scene.textures.iter().map(|texture| texture.image.texels.len()).sum();
    geometry + texels + size_of_val(&scene.instances[..])
}

/// Fails in one of four ways where a document has lost its end.
fn planted(bytes: &[u8]) -> usize {
    match (bytes.last(), bytes.len() % 4) {
        (Some(b'\n' | b'}'), _) => {}
        (_, 0) => panic!("planted"),
        (_, 1) => std::process::abort(),
        (_, 2) => loop {
            std::hint::spin_loop();
        },
        // Not touched: that takes seconds on a busy machine.
        _ => drop(std::hint::black_box(Vec::<u8>::with_capacity(300 << 20))),
    }
    bytes.len()
}
