//! Scenes are read beside the frames: the old one stays on screen until the new one is whole.

use crate::error::{Error, Result};
use crate::scene::{self, EnvironmentSource, SceneDescription, SceneSource};
use std::path::Path;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::Instant;

/// Where a scene and its light come from.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    pub scene: SceneSource,
    /// Point lights of the atrium, or of a file without light.
    pub lights: usize,
    pub environment: Option<EnvironmentSource>,
}

impl Source {
    pub fn load(&self) -> Result<SceneDescription> {
        scene::load(&self.scene, self.lights, self.environment.as_ref())
    }

    /// What this becomes when `path` is dropped on it: another scene, or another sky over the same one.
    pub fn with_file(&self, path: &Path) -> Result<Source> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        match extension.as_str() {
            "glb" | "gltf" => {
                Ok(Source { scene: SceneSource::File(path.into()), environment: None, ..self.clone() })
            }
            "hdr" | "exr" => {
                let environment = EnvironmentSource { path: path.into(), scale: 1.0 };
                Ok(Source { environment: Some(environment), ..self.clone() })
            }
            _ => Err(Error::Usage(format!(
                "{}: not a scene (.glb, .gltf) and not a sky (.hdr, .exr)",
                path.display()
            ))),
        }
    }

    /// As the command line says it.
    pub fn arguments(&self) -> String {
        let scene = match &self.scene {
            SceneSource::Atrium => "atrium".to_string(),
            SceneSource::Knot => "knot".to_string(),
            SceneSource::File(path) => quoted(path),
        };
        let sky = self.environment.as_ref().map_or(String::new(), |environment| {
            let scale = environment.scale;
            let scale = if scale == 1.0 { String::new() } else { format!(" --environment-scale {scale}") };
            format!(" --environment {}{scale}", quoted(&environment.path))
        });
        format!("{scene} {}{sky}", self.lights)
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

/// At most one scene that is being read.
#[derive(Default)]
pub struct Loader(Option<Job>);

struct Job {
    source: Source,
    result: Receiver<Result<SceneDescription>>,
    since: Instant,
}

impl Loader {
    /// Starts to read `source`; one that is being read already is given up.
    pub fn start(&mut self, source: Source) -> Result<()> {
        let (sender, result) = channel();
        let job = source.clone();
        std::thread::Builder::new()
            .name("scene loader".into())
            // Nobody listens any more when another file was dropped meanwhile.
            .spawn(move || sender.send(job.load()).ok())
            .map_err(|e| Error::Usage(format!("can't start a thread to load the scene: {e}")))?;
        self.0 = Some(Job { source, result, since: Instant::now() });
        Ok(())
    }

    /// The scene that has been read since the last call, or why it could not be.
    pub fn poll(&mut self) -> Option<(Source, Result<SceneDescription>)> {
        let job = self.0.as_ref()?;
        let result = match job.result.try_recv() {
            Ok(result) => result,
            Err(TryRecvError::Empty) => return None,
            Err(TryRecvError::Disconnected) => {
                Err(Error::Usage(format!("{}: loading it failed unexpectedly", job.source.arguments())))
            }
        };
        self.0.take().map(|job| (job.source, result))
    }

    /// What is being read, and for how many seconds.
    pub fn progress(&self) -> Option<(String, f32)> {
        self.0.as_ref().map(|job| (job.source.arguments(), job.since.elapsed().as_secs_f32()))
    }

    pub fn is_busy(&self) -> bool {
        self.0.is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn atrium() -> Source {
        Source { scene: SceneSource::Atrium, lights: 7, environment: None }
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

    #[test]
    fn a_scene_or_an_error_arrives() {
        let mut loader = Loader::default();
        for (path, good) in
            [("../assets/scenes/cornell-box.glb", true), ("../assets/scenes/missing.glb", false)]
        {
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
            loader.start(atrium().with_file(&path).unwrap()).unwrap();
            assert!(loader.is_busy() && loader.progress().is_some());
            let (source, result) = std::iter::repeat_with(|| loader.poll()).find_map(|r| r).unwrap();
            assert_eq!((source.scene, result.is_ok()), (SceneSource::File(path), good));
            assert!(!loader.is_busy());
        }
    }
}
