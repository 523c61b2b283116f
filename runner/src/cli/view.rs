//! Which scene and which camera a command is about.

use super::args::{PictureArgs, SceneArgs, parse_view};
use crate::error::{Error, Result};
use crate::scene::{self, SceneCamera, SceneDescription};
use glam::{UVec2, Vec3};
use shared::camera::Camera;

/// Loads the scene and says on standard error what it leaves out.
pub fn load_scene(args: &SceneArgs) -> Result<SceneDescription> {
    let scene = load(args)?;
    for warning in &scene.warnings {
        eprintln!("warning: {}: {warning}", scene.name);
    }
    Ok(scene)
}

/// As [`load_scene`], in silence.
pub fn load(args: &SceneArgs) -> Result<SceneDescription> {
    scene::load(&args.source(), args.light_count(), args.environment_source().as_ref())
}

/// The camera that the command line asks for: of the scene, given in numbers, or fitted around the scene.
pub fn camera(scene: &SceneDescription, args: &PictureArgs) -> Result<Camera> {
    let view = scene_camera(scene, args.camera.as_deref())?;
    Ok(shared_camera(&view, args.size))
}

/// The camera of that name, number or position; without one, the scene's first, or one fitted around it.
pub fn scene_camera(scene: &SceneDescription, text: Option<&str>) -> Result<SceneCamera> {
    match text {
        Some(text) => named_camera(scene, text),
        None => Ok(scene.cameras.first().cloned().unwrap_or_else(|| scene.camera_fitted())),
    }
}

/// A scene's camera for a picture of `size`.
pub fn shared_camera(view: &SceneCamera, size: UVec2) -> Camera {
    Camera::new(view.position, view.forward, view.up, view.fov_y, size)
}

fn named_camera(scene: &SceneDescription, text: &str) -> Result<SceneCamera> {
    if let Some(numbers) = parse_view(text) {
        let (position, target, fov) = numbers?;
        if position == target {
            return Err(Error::Usage(format!("--camera {text}: position and target are the same point")));
        }
        let fov_y = fov.unwrap_or(50.0).clamp(1.0, 170.0).to_radians();
        let forward = (target - position).normalize();
        return Ok(SceneCamera { name: text.into(), position, forward, up: Vec3::Y, fov_y });
    }
    let by_name = scene.cameras.iter().find(|camera| camera.name == text);
    let by_index = text.parse().ok().and_then(|i: usize| scene.cameras.get(i));
    by_name.or(by_index).cloned().ok_or_else(|| {
        let names: Vec<_> = scene.cameras.iter().map(|camera| camera.name.as_str()).collect();
        let known = if names.is_empty() { "none".into() } else { names.join(", ") };
        Error::Usage(format!("{}: no camera '{text}' (it has {known})", scene.name))
    })
}
