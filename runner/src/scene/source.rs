//! Scenes by file name or built-in name, with lights.

use super::lights::is_lit;
use super::procedural::{atrium, knot, scatter::scatter, town};
use super::{SceneDescription, SceneSource, environment, gltf};
use crate::error::Result;
use crate::startup;
use std::path::{Path, PathBuf};

/// Seed of scattered lights: the same file and count give the same lights everywhere.
const SCATTER_SEED: u64 = 1;

/// An environment map, as the command line names it.
#[derive(Clone, Debug, PartialEq)]
pub struct EnvironmentSource {
    /// An .hdr or .exr file, or `studio`.
    pub path: PathBuf,
    /// Factor from the file's values to nit.
    pub scale: f32,
    /// Degrees about +Y.
    pub rotation: f32,
}

impl EnvironmentSource {
    /// As the file has it.
    pub fn new(path: PathBuf) -> Self {
        EnvironmentSource { path, scale: 1.0, rotation: 0.0 }
    }
}

/// What lights a scene apart from the lights that it brings, how strong its emission is, and where light arrives.
#[derive(Clone, Debug, PartialEq)]
pub struct Illumination {
    /// Lights of the atrium or the town, or of a file that brings no light and has no environment around it.
    pub lights: usize,
    /// The sky around the scene, in place of what the file brings.
    pub environment: Option<EnvironmentSource>,
    /// Factor on what materials emit.
    pub emissive_scale: f32,
    /// Of points and spots that bring none, m.
    pub light_radius: f32,
    /// See [`SceneDescription::hard_terminator`].
    pub hard_terminator: bool,
}

impl Illumination {
    /// So many point lights, and nothing else.
    pub fn points(lights: usize) -> Self {
        Illumination {
            lights,
            environment: None,
            emissive_scale: 1.0,
            light_radius: 0.0,
            hard_terminator: false,
        }
    }
}

impl SceneSource {
    /// A built-in scene by its name, else a file.
    pub fn named(name: &Path) -> Self {
        match name.to_str() {
            Some("atrium") => SceneSource::Atrium,
            Some("knot") => SceneSource::Knot,
            Some("town") => SceneSource::Town,
            _ => SceneSource::File(name.into()),
        }
    }

    /// Lights where the user does not say how many.
    pub fn usual_lights(&self) -> usize {
        match self {
            SceneSource::Town => town::DEFAULT_LIGHT_COUNT,
            SceneSource::Atrium | SceneSource::Knot | SceneSource::File(_) => atrium::DEFAULT_LIGHT_COUNT,
        }
    }
}

/// Loads or generates a scene, and lights it.
///
/// ```
/// use candela::error::Kind;
/// use candela::scene::{Illumination, SceneSource, load};
/// use std::path::Path;
///
/// // "model.glb" would be a file; `knot` is built in, and has no lights of its own.
/// let scene = load(&SceneSource::named(Path::new("knot")), &Illumination::points(30))?;
/// assert_eq!(scene.lights.len(), 30);
///
/// let missing = load(&SceneSource::named(Path::new("no-such-file.glb")), &Illumination::points(30));
/// assert_eq!(missing.unwrap_err().kind(), Kind::Input);
/// # Ok::<(), candela::error::Error>(())
/// ```
pub fn load(source: &SceneSource, illumination: &Illumination) -> Result<SceneDescription> {
    let &Illumination { lights, ref environment, emissive_scale, light_radius, hard_terminator } =
        illumination;
    let mut scene = startup::timed("scene", || match source {
        SceneSource::Atrium => Ok(atrium::atrium(lights)),
        SceneSource::Knot => Ok(knot::knot()),
        SceneSource::Town => Ok(town::town(lights)),
        SceneSource::File(path) => gltf::load(path),
    })?;
    scene.materials.iter_mut().for_each(|material| material.emission *= emissive_scale);
    if let Some(source) = environment {
        let (map, warnings) = environment::load(source)?;
        scene.environment = Some(map);
        scene.warnings.extend(warnings);
    } else if !is_lit(&scene) {
        scatter(&mut scene, lights, SCATTER_SEED);
    }
    scene.lights.iter_mut().for_each(|light| light.soften(light_radius));
    scene.hard_terminator = hard_terminator;
    Ok(scene)
}
