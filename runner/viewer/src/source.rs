//! The source of a scene: a file or a built-in name, with its options.

use candela::error::{Error, Result};
use candela::scene::{self, EnvironmentSource, Illumination, SceneDescription, SceneSource};
use std::path::Path;

/// Where a scene and its light come from.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    pub scene: SceneSource,
    pub illumination: Illumination,
}

impl Source {
    pub fn load(&self) -> Result<SceneDescription> {
        scene::load(&self.scene, &self.illumination)
    }

    /// What this becomes when `path` is dropped on it: another scene, or another sky over the same one.
    pub fn with_file(&self, path: &Path) -> Result<Source> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        let under = |environment| Illumination { environment, ..self.illumination.clone() };
        match extension.as_str() {
            "glb" | "gltf" => Ok(Source { scene: SceneSource::File(path.into()), illumination: under(None) }),
            "hdr" | "exr" | "png" | "jpg" | "jpeg" | "webp" => {
                let environment = EnvironmentSource::new(path.into());
                Ok(Source { scene: self.scene.clone(), illumination: under(Some(environment)) })
            }
            _ => Err(Error::Usage(format!(
                "{}: not a scene (.glb, .gltf) and not a sky (.hdr, .exr, .png, .jpg, .webp)",
                path.display()
            ))),
        }
    }

    /// As messages name it: the sky if there is one, else the scene.
    pub fn name(&self) -> String {
        match (&self.illumination.environment, &self.scene) {
            (Some(environment), _) => environment.path.display().to_string(),
            (None, SceneSource::File(path)) => path.display().to_string(),
            (None, _) => self.arguments(),
        }
    }

    /// As the command line says it.
    pub fn arguments(&self) -> String {
        let scene = match &self.scene {
            SceneSource::Atrium => "atrium".to_string(),
            SceneSource::Knot => "knot".to_string(),
            SceneSource::Town => "town".to_string(),
            SceneSource::File(path) => quoted(path),
        };
        let Illumination { lights, environment, emissive_scale, light_radius, hard_terminator } =
            &self.illumination;
        let sky = environment.as_ref().map_or(String::new(), |environment| {
            let EnvironmentSource { path, scale, rotation } = environment;
            let option = |name: &str, value: f32, usual: f32| match value == usual {
                true => String::new(),
                false => format!(" --environment-{name} {value}"),
            };
            let changes = option("scale", *scale, 1.0) + &option("rotation", *rotation, 0.0);
            format!(" --environment {}{changes}", quoted(path))
        });
        let emission = match *emissive_scale {
            1.0 => String::new(),
            scale => format!(" --emissive-scale {scale}"),
        };
        let radius = match *light_radius {
            0.0 => String::new(),
            radius => format!(" --light-radius {radius}"),
        };
        let terminator = if *hard_terminator { " --hard-terminator" } else { "" };
        format!("{scene} {lights}{sky}{emission}{radius}{terminator}")
    }
}

/// For a shell.
fn quoted(path: &Path) -> String {
    let text = path.display().to_string();
    let plain = |c: char| c.is_ascii_alphanumeric() || "/._-+:,@%".contains(c);
    if !text.is_empty() && text.chars().all(plain) {
        text
    } else {
        format!("'{}'", text.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn atrium() -> Source {
        Source { scene: SceneSource::Atrium, illumination: Illumination::points(7) }
    }

    #[test]
    fn files_become_scenes_or_skies() {
        let scene = atrium().with_file(Path::new("/a b/c.GLB")).unwrap();
        assert_eq!(scene.arguments(), "'/a b/c.GLB' 7");
        let sky = scene.with_file(Path::new("sky.hdr")).unwrap();
        assert_eq!(sky.arguments(), "'/a b/c.GLB' 7 --environment sky.hdr");
        assert_eq!(sky.with_file(Path::new("d.gltf")).unwrap().arguments(), "d.gltf 7");
        let error = atrium().with_file(Path::new("notes.txt")).unwrap_err().to_string();
        assert!(error.contains("notes.txt") && error.contains(".glb"), "{error}");
    }
}
