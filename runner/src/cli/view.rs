//! Which scene and which camera a command is about.

use super::args::values::parse_view;
use super::args::{PictureArgs, SceneArgs};
use crate::error::{Error, Result};
use crate::scene::animation::Thing;
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

/// Poses `scene` at the time that the command line asks for, if it does.
pub fn pose(scene: &mut SceneDescription, time: Option<f64>) {
    if let Some(time) = time {
        let pose = scene.pose(time);
        scene.apply(&pose);
    }
}

/// The camera that the command line asks for, where `scene` has it now: of the scene, given in numbers, or fitted around
/// the scene.
pub fn camera(scene: &SceneDescription, args: &PictureArgs) -> Result<Camera> {
    let view = match &args.camera_path {
        Some(text) => animated_camera(scene, text)?,
        None => scene_camera(scene, args.camera.as_deref())?,
    };
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
        let fov_y = fov.unwrap_or(50.0).clamp(1.0, 170.0).to_radians() as f32;
        let forward = (target - position).normalize().as_vec3();
        let position = (position - scene.origin).as_vec3();
        return Ok(SceneCamera { name: text.into(), position, forward, up: Vec3::Y, fov_y });
    }
    Ok(scene.cameras[camera_index(scene, text)?].clone())
}

fn animated_camera(scene: &SceneDescription, text: &str) -> Result<SceneCamera> {
    let index = camera_index(scene, text)?;
    let moves = |i: &usize| scene.animation.moves(Thing::Camera(*i));
    if moves(&index) {
        return Ok(scene.cameras[index].clone());
    }
    let moving: Vec<_> =
        (0..scene.cameras.len()).filter(moves).map(|i| scene.cameras[i].name.as_str()).collect();
    let known =
        if moving.is_empty() { "no camera moves".into() } else { format!("{} do", moving.join(", ")) };
    Err(Error::Usage(format!("--camera-path {text}: {}: this camera does not move ({known})", scene.name)))
}

fn camera_index(scene: &SceneDescription, text: &str) -> Result<usize> {
    let by_name = scene.cameras.iter().position(|camera| camera.name == text);
    let by_index = text.parse().ok().filter(|&i: &usize| i < scene.cameras.len());
    by_name.or(by_index).ok_or_else(|| {
        let names: Vec<_> = scene.cameras.iter().map(|camera| camera.name.as_str()).collect();
        let known = if names.is_empty() { "none".into() } else { names.join(", ") };
        Error::Usage(format!("{}: no camera '{text}' (it has {known})", scene.name))
    })
}
