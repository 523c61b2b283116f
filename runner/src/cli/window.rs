//! `candela`: the viewer.

use super::args::ViewArgs;
use super::{output, view};
use crate::error::Result;
use crate::viewer::{Display, Script, Source, Start};

pub fn run(args: &ViewArgs) -> Result<()> {
    let settings = args.knobs.document()?;
    let script = args.script.as_deref().map(Script::read).transpose()?.unwrap_or_default();
    // Without a display nothing else is worth a wait.
    let display = Display::open(args.device.options())?;
    let mut scene = view::load_scene(&args.scene)?;
    view::pose(&mut scene, args.time);
    let camera = view::scene_camera(&scene, args.camera.as_deref())?;
    let device = display.device.clone();
    let source = Source {
        scene: args.scene.source(),
        lights: args.scene.light_count(),
        environment: args.scene.environment_source(),
    };
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
