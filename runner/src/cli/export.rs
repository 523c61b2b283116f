//! `candela export`: a scene for other programs.

use super::args::ExportArgs;
use super::view;
use crate::error::Result;
use crate::scene::interchange;

pub fn run(args: &ExportArgs) -> Result<()> {
    let scene = view::load_scene(&args.scene)?;
    let camera = view::scene_camera(&scene, args.camera.as_deref())?;
    for line in interchange::left_out(&scene) {
        eprintln!("warning: {}: {line}", scene.name);
    }
    interchange::write(&scene, &camera, &args.output)?;
    println!("wrote {}", args.output.join("scene.json").display());
    Ok(())
}
