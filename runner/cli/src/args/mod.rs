//! Options that commands share, with units, ranges and defaults. Each command has its own beside them.

mod knobs;
pub mod values;

pub use knobs::{KnobArgs, choice};

use super::compare::CompareArgs;
use super::denoise::DenoiseArgs;
use super::explain::ExplainArgs;
use super::export::ExportArgs;
use super::info::InfoArgs;
use super::reference::ReferenceArgs;
use super::render::RenderArgs;
use super::report::ReportArgs;
use super::roofline::RooflineArgs;
use super::sweep::SweepArgs;
use super::window::ViewArgs;
use candela::error::Kind;
use candela::frame::renderer::FrameOptions;
use candela::frame::schedule::{Primary, Work};
use candela::scene::{EnvironmentSource, Illumination, SceneSource};
use candela::vulkan::{DeviceOptions, pipeline_cache};
use clap::{Args, Parser, Subcommand};
use glam::UVec2;
use std::path::PathBuf;
use values::{degrees, lights, parse_size, positive, stops, time};

/// Direct lighting from thousands to millions of lights: ReSTIR DI on Vulkan ray tracing, every shader in Rust.
#[derive(Debug, Parser)]
#[command(version, args_conflicts_with_subcommands = true, args_override_self = true, after_help = exit_codes())]
pub struct Cli {
    #[command(subcommand)]
    pub command: Option<Command>,
    /// Without a command: the viewer.
    #[command(flatten)]
    pub view: ViewArgs,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Show a scene in a window (the default command).
    View(ViewArgs),
    /// Render a picture with ReSTIR.
    Render(RenderArgs),
    /// Render the truth: every light of every pixel, without resampling.
    Reference(ReferenceArgs),
    /// Print what a scene contains, and what is left out.
    Info(InfoArgs),
    /// Compare a picture with the truth: error measures and heat maps.
    Compare(CompareArgs),
    /// Denoise a still picture with Intel Open Image Denoise.
    Denoise(DenoiseArgs),
    /// Measure times and errors over scenes, lights and settings, and write a report.
    Sweep(SweepArgs),
    /// Measure the least time that a frame's rays and bytes take on this device.
    #[command(alias = "floors")]
    Roofline(RooflineArgs),
    /// Write the report of a sweep again, or fill the tables of a page.
    Report(ReportArgs),
    /// Write a scene for other programs: scene.json and PLY files (tools/mitsuba renders them with Mitsuba).
    Export(ExportArgs),
    /// Replay one pixel of one frame on the CPU: each candidate, ray and weight, and whether the GPU agrees.
    Explain(ExplainArgs),
    /// Fill the tables of docs/command-line.md.
    #[command(hide = true)]
    Page { page: PathBuf },
    /// Write the project's own test scenes.
    #[command(hide = true)]
    Fixtures { directory: PathBuf },
}

/// Which scene, lit by what.
#[derive(Args, Clone, Debug)]
pub struct SceneArgs {
    /// A .gltf or .glb file, or a built-in scene: `atrium`, a hall; `knot`, one object; `town`, a town at night.
    #[arg(default_value = "atrium")]
    pub scene: PathBuf,
    /// Number of lights: point lights of the atrium, lights of all kinds in the town, point lights scattered in a file that has no
    /// light [default: 500; of the town 20000].
    #[arg(value_parser = lights)]
    pub n_lights: Option<usize>,
    /// The same as N_LIGHTS.
    #[arg(long, value_name = "N", conflicts_with = "n_lights", value_parser = lights)]
    pub lights: Option<usize>,
    /// Environment map around the scene: equirectangular .hdr or .exr (or, less bright, .png, .jpg, .webp), +Y up, its middle
    /// is +X; or `studio`, a built-in one for looking at models.
    #[arg(long, value_name = "FILE")]
    pub environment: Option<PathBuf>,
    /// Factor from the environment map's values to nit.
    #[arg(long, value_name = "S", default_value_t = 1.0, value_parser = positive, requires = "environment")]
    pub environment_scale: f32,
    /// Turn the environment map about +Y, from +Z to +X.
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0, allow_hyphen_values = true, value_parser = degrees, requires = "environment")]
    pub environment_rotation: f32,
    /// Factor on the emission of materials: 1 in a file is 1 nit, though many files mean the white of a screen.
    #[arg(long, value_name = "S", default_value_t = 1.0, value_parser = positive)]
    pub emissive_scale: f32,
    /// Radius of points and spots that have none, for soft shadows: points become spheres, spots disks, with the same flux.
    #[arg(long, value_name = "METRES", value_parser = positive)]
    pub light_radius: Option<f32>,
    /// Let light arrive at triangles as they are, not at the curved surfaces that their normals tell of: it is cut off along edges of
    /// low-poly meshes.
    #[arg(long)]
    pub hard_terminator: bool,
}

#[derive(Args, Clone, Debug)]
pub struct DeviceArgs {
    /// Vulkan device, by number or by a part of its name.
    #[arg(long)]
    pub device: Option<String>,
    /// Enable the Vulkan validation layer; any message is an error.
    #[arg(long)]
    pub validate: bool,
    /// Neither read nor write the cache of compiled pipelines (also CANDELA_NO_PIPELINE_CACHE=1).
    #[arg(long)]
    pub no_pipeline_cache: bool,
    /// Print the time of each step from start to first frame, on standard error.
    #[arg(long)]
    pub timings: bool,
}

#[derive(Args, Clone, Debug)]
pub struct PictureArgs {
    /// Picture to write: .png (tone mapped) or .exr (radiance in nit).
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Width x height in pixels.
    #[arg(long, default_value = "1280x720", value_parser = parse_size)]
    pub size: UVec2,
    /// A camera of the scene by name or number, or `x,y,z,tx,ty,tz[,fov]`: position and target in m, vertical field of
    /// view in degrees.
    #[arg(long)]
    pub camera: Option<String>,
    /// Seed of the random numbers: the same seed gives the same picture.
    #[arg(long, default_value_t = 0)]
    pub seed: u32,
    /// Stops brighter (+) or darker (-) than the automatic exposure.
    #[arg(long, default_value_t = 0.0, allow_hyphen_values = true, value_parser = stops)]
    pub exposure: f32,
    /// Add layers to the picture (.exr): diffuse, specular and emitted light, albedo, f0, normal, depth.
    #[arg(long)]
    pub layers: bool,
    /// Time of the scene's animations, in seconds; in a sequence, that of frame 0 [default: at rest; in a sequence 0].
    #[arg(long, value_name = "T", value_parser = time)]
    pub time: Option<f64>,
    /// Animated camera of the scene, by name or number.
    #[arg(long, value_name = "NAME", conflicts_with = "camera")]
    pub camera_path: Option<String>,
}

/// What scripts want to know at the end of `--help`.
fn exit_codes() -> String {
    let line = |kind: Kind| format!("  {}  {}", kind.exit_code(), kind.meaning());
    format!("Exit codes:\n  0  done\n{}", Kind::ALL.map(line).join("\n"))
}

impl Cli {
    /// Are the steps of the start to be reported?
    pub fn timings(&self) -> bool {
        match &self.command {
            None => self.view.device.timings,
            Some(Command::View(args)) => args.device.timings,
            Some(Command::Render(args)) => args.device.timings,
            Some(Command::Reference(args)) => args.device.timings,
            Some(Command::Info(args)) => args.device.timings,
            Some(Command::Sweep(args)) => args.device.timings,
            Some(Command::Roofline(args)) => args.device.timings,
            Some(Command::Explain(args)) => args.device.timings,
            _ => false,
        }
    }
}

impl SceneArgs {
    pub fn source(&self) -> SceneSource {
        SceneSource::named(&self.scene)
    }

    pub fn illumination(&self) -> Illumination {
        let (scale, rotation) = (self.environment_scale, self.environment_rotation);
        let environment = self.environment.clone().map(|path| EnvironmentSource { path, scale, rotation });
        Illumination {
            lights: self.light_count(),
            environment,
            emissive_scale: self.emissive_scale,
            light_radius: self.light_radius.unwrap_or(0.0),
            hard_terminator: self.hard_terminator,
        }
    }

    pub fn light_count(&self) -> usize {
        self.n_lights.or(self.lights).unwrap_or_else(|| self.source().usual_lights())
    }
}

impl PictureArgs {
    /// Of its frames.
    pub fn options(&self, work: Work, primary: Primary) -> FrameOptions {
        FrameOptions { parts: self.layers, ..FrameOptions::new(work, primary, self.seed) }
    }
}

impl DeviceArgs {
    pub fn options(&self) -> DeviceOptions {
        let off = self.no_pipeline_cache
            || std::env::var_os("CANDELA_NO_PIPELINE_CACHE").is_some_and(|value| value == "1");
        DeviceOptions {
            validate: self.validate,
            device: self.device.clone(),
            pipeline_cache: if off { None } else { pipeline_cache::default_directory() },
            ..DeviceOptions::default()
        }
    }
}

#[cfg(test)]
mod tests;
