//! The scene and the camera of a command.

use super::args::{PictureArgs, SceneArgs};
use candela::error::Result;
use candela::scene::{self, SceneDescription};
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
    scene::load(&args.source(), &args.illumination())
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
        Some(text) => scene.animated_camera(text)?,
        None => scene.camera(args.camera.as_deref())?,
    };
    Ok(view.seen_in(args.size))
}
