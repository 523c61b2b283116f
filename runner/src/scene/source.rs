//! From what the command line names to a scene with lights.

use super::lights::{LightTable, scatter};
use super::{SceneDescription, SceneSource, atrium, gltf};
use crate::error::Result;

/// Seed of scattered lights: the same file and count give the same lights everywhere.
const SCATTER_SEED: u64 = 1;

/// Loads or generates a scene. `light_count` point lights light the atrium, or a file that brings no light of its own.
pub fn load(source: &SceneSource, light_count: usize) -> Result<SceneDescription> {
    match source {
        SceneSource::Atrium => Ok(atrium::atrium(light_count)),
        SceneSource::File(path) => {
            let mut scene = gltf::load(path)?;
            if LightTable::new(&scene).alias.is_empty() {
                scatter(&mut scene, light_count, SCATTER_SEED);
            }
            Ok(scene)
        }
    }
}
