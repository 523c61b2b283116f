//! `candela export`: a scene for other programs.

use super::args::SceneArgs;
use super::view;
use candela::error::Result;
use candela::scene::interchange;
use clap::Args;
use std::path::PathBuf;

#[derive(Args, Clone, Debug)]
pub struct ExportArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Folder to write to; it is created if it does not exist.
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// As for `render`.
    #[arg(long)]
    pub camera: Option<String>,
}

pub fn run(args: &ExportArgs) -> Result<()> {
    let scene = view::load_scene(&args.scene)?;
    let camera = scene.camera(args.camera.as_deref())?;
    for line in interchange::left_out(&scene) {
        eprintln!("warning: {}: {line}", scene.name);
    }
    interchange::write(&scene, &camera, &args.output)?;
    println!("wrote {}", args.output.join("scene.json").display());
    Ok(())
}
