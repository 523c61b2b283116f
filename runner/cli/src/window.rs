//! `candela`: the viewer.

use super::args::values::{parse_size, stops, time};
use super::args::{DeviceArgs, KnobArgs, SceneArgs};
#[cfg(feature = "viewer")]
use super::{output, view};
use candela::error::Result;
#[cfg(feature = "viewer")]
use candela_viewer::{Display, Script, Source, Start};
use clap::Args;
use glam::UVec2;
use std::path::PathBuf;

#[derive(Args, Clone, Debug)]
pub struct ViewArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    #[command(flatten)]
    pub device: DeviceArgs,
    #[command(flatten)]
    pub knobs: KnobArgs,
    /// Width x height of the window in pixels.
    #[arg(long, default_value = "1280x720", value_parser = parse_size)]
    pub size: UVec2,
    /// A camera of the scene by name or number, or `x,y,z,tx,ty,tz[,fov]`: position and target in m, vertical field of
    /// view in degrees.
    #[arg(long, allow_hyphen_values = true)]
    pub camera: Option<String>,
    /// Stops brighter (+) or darker (-) than the automatic exposure.
    #[arg(long, default_value_t = 0.0, allow_hyphen_values = true, value_parser = stops)]
    pub exposure: f32,
    /// Time of the scene's animations, in seconds [default: at rest].
    #[arg(long, value_name = "T", value_parser = time)]
    pub time: Option<f64>,
    /// Commands that the viewer plays by itself, for tests.
    #[arg(long, value_name = "FILE", hide = true)]
    pub script: Option<PathBuf>,
}

/// Without the feature `viewer` there is no window to open.
#[cfg(not(feature = "viewer"))]
pub fn run(_: &ViewArgs) -> Result<()> {
    let text = "this build of candela has no viewer (feature `viewer`); `candela render` draws to a file";
    Err(candela::error::Error::Unsupported(text.into()))
}

#[cfg(feature = "viewer")]
pub fn run(args: &ViewArgs) -> Result<()> {
    let settings = args.knobs.knobs()?;
    let script = args.script.as_deref().map(Script::read).transpose()?.unwrap_or_default();
    // Without a display nothing else is worth a wait.
    let display = Display::open(args.device.options())?;
    let mut scene = view::load_scene(&args.scene)?;
    view::pose(&mut scene, args.time);
    let camera = scene.camera(args.camera.as_deref())?;
    let device = display.device.clone();
    let source = Source { scene: args.scene.source(), illumination: args.scene.illumination() };
    display.run(Start {
        device: device.clone(),
        scene,
        source,
        camera,
        settings,
        time: args.time,
        size: args.size,
        stops: args.exposure,
        script,
    })?;
    output::check_validation(&device)
}
