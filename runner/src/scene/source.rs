//! From what the command line names to a scene with lights.

use super::lights::is_lit;
use super::procedural::{atrium, knot, scatter::scatter};
use super::{SceneDescription, SceneSource, environment, gltf};
use crate::error::Result;
use crate::startup;
use std::path::{Path, PathBuf};

/// Seed of scattered lights: the same file and count give the same lights everywhere.
const SCATTER_SEED: u64 = 1;

/// An environment map, as the command line names it.
#[derive(Clone, Debug, PartialEq)]
pub struct EnvironmentSource {
    pub path: PathBuf,
    /// Factor from the file's values to nit.
    pub scale: f32,
}

impl SceneSource {
    /// A built-in scene by its name, else a file.
    pub fn named(name: &Path) -> Self {
        match name.to_str() {
            Some("atrium") => SceneSource::Atrium,
            Some("knot") => SceneSource::Knot,
            _ => SceneSource::File(name.into()),
        }
    }
}

/// Loads or generates a scene. `light_count` point lights light the atrium, or a file that brings no light of its own
/// and has no environment around it.
pub fn load(
    source: &SceneSource,
    light_count: usize,
    environment: Option<&EnvironmentSource>,
) -> Result<SceneDescription> {
    let mut scene = startup::timed("scene", || match source {
        SceneSource::Atrium => Ok(atrium::atrium(light_count)),
        SceneSource::Knot => Ok(knot::knot()),
        SceneSource::File(path) => gltf::load(path),
    })?;
    if let Some(source) = environment {
        let (map, warning) = environment::load(&source.path, source.scale)?;
        scene.environment = Some(map);
        scene.warnings.extend(warning);
    } else if !is_lit(&scene) {
        scatter(&mut scene, light_count, SCATTER_SEED);
    }
    Ok(scene)
}
