//! What can be said on the command line, with units, ranges and defaults.

use crate::error::{Error, Result};
use crate::scene::{EnvironmentSource, SceneSource};
use crate::vulkan::DeviceOptions;
use clap::{Args, Parser, Subcommand, ValueEnum};
use glam::UVec2;
use shared::frame::{Settings, mode};
use std::path::PathBuf;

/// Direct lighting from thousands to millions of lights: ReSTIR DI on Vulkan ray tracing, every shader in Rust.
#[derive(Debug, Parser)]
#[command(version)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Render a picture with ReSTIR.
    Render(RenderArgs),
    /// Render the truth: every light of every pixel, without resampling.
    Reference(ReferenceArgs),
    /// Say what a scene contains.
    Info(InfoArgs),
    /// Write the project's own test scenes.
    #[command(hide = true)]
    Fixtures { directory: PathBuf },
}

/// Which scene, lit by what.
#[derive(Args, Clone, Debug)]
pub struct SceneArgs {
    /// A .gltf or .glb file, or `atrium`, the built-in hall.
    #[arg(default_value = "atrium")]
    pub scene: PathBuf,
    /// Number of point lights: of the atrium, or scattered in a file that has no light [default: 500].
    pub n_lights: Option<usize>,
    /// The same as N_LIGHTS.
    #[arg(long, value_name = "N", conflicts_with = "n_lights")]
    pub lights: Option<usize>,
    /// Environment map around the scene: equirectangular .hdr or .exr, +Y up, its middle is +X.
    #[arg(long, value_name = "FILE")]
    pub environment: Option<PathBuf>,
    /// Factor from the environment map's values to nit.
    #[arg(long, value_name = "S", default_value_t = 1.0, value_parser = positive, requires = "environment")]
    pub environment_scale: f32,
}

#[derive(Args, Clone, Debug)]
pub struct DeviceArgs {
    /// Use the device whose name contains this, or the one with this number.
    #[arg(long)]
    pub device: Option<String>,
    /// Switch the Vulkan validation layer on; any message is an error.
    #[arg(long)]
    pub validate: bool,
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
    #[arg(long, default_value_t = 0.0, allow_hyphen_values = true)]
    pub exposure: f32,
}

#[derive(Args, Clone, Debug)]
pub struct RenderArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    #[command(flatten)]
    pub picture: PictureArgs,
    #[command(flatten)]
    pub device: DeviceArgs,
    #[command(flatten)]
    pub knobs: KnobArgs,
    /// Frames to render; the last one is written.
    #[arg(long, default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..))]
    pub frames: u32,
    /// Write the mean of all frames instead of the last one.
    #[arg(long)]
    pub accumulate: bool,
}

#[derive(Args, Clone, Debug)]
pub struct ReferenceArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    #[command(flatten)]
    pub picture: PictureArgs,
    #[command(flatten)]
    pub device: DeviceArgs,
    /// Points drawn on each emissive triangle; point lights are exact with one.
    #[arg(long, default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..))]
    pub samples: u32,
}

#[derive(Args, Clone, Debug)]
pub struct InfoArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Mode {
    /// 1/M weights (Bitterli et al. 2020, Alg. 4): fast, darkens where neighbors disagree.
    Biased,
    /// Pairwise MIS with the neighbors' visibility: the right mean, more rays.
    Unbiased,
}

/// Every knob of the estimator; see `shared::frame::Settings`.
#[derive(Args, Clone, Debug)]
pub struct KnobArgs {
    /// Light candidates a reservoir: more is less noise and more time.
    #[arg(long, default_value_t = Settings::default().candidates, value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub candidates: u32,
    /// Neighbors of each spatial pass.
    #[arg(long, default_value_t = Settings::default().neighbors, value_parser = clap::value_parser!(u32).range(1..=32))]
    pub neighbors: u32,
    /// Spatial passes.
    #[arg(long, default_value_t = Settings::default().spatial_iterations, value_parser = clap::value_parser!(u32).range(1..=8))]
    pub iterations: u32,
    /// Radius of the neighborhood, pixels.
    #[arg(long, default_value_t = Settings::default().radius, value_parser = positive)]
    pub radius: f32,
    /// Reservoirs a pixel.
    #[arg(long, default_value_t = Settings::default().reservoirs, value_parser = clap::value_parser!(u32).range(1..=4))]
    pub reservoirs: u32,
    /// A history weighs at most this many times the new candidates.
    #[arg(long, default_value_t = Settings::default().confidence_cap, value_parser = positive)]
    pub confidence_cap: f32,
    /// Reuse the previous frame (on by default).
    #[arg(long, overrides_with = "no_temporal")]
    pub temporal: bool,
    #[arg(long, overrides_with = "temporal")]
    pub no_temporal: bool,
    /// Reuse neighboring pixels (on by default).
    #[arg(long, overrides_with = "no_spatial")]
    pub spatial: bool,
    #[arg(long, overrides_with = "spatial")]
    pub no_spatial: bool,
    /// Test the survivor's visibility before it is reused (on by default).
    #[arg(long, overrides_with = "no_visibility")]
    pub visibility: bool,
    #[arg(long, overrides_with = "visibility")]
    pub no_visibility: bool,
    /// Largest difference in distance between neighbors, as a fraction.
    #[arg(long, default_value_t = Settings::default().depth_threshold, value_parser = positive)]
    pub depth_threshold: f32,
    /// Largest angle between normals of neighbors, degrees.
    #[arg(long, default_value_t = 25.0, value_parser = positive)]
    pub normal_threshold: f32,
    /// Draw candidates from presampled light tiles (by default from 4,096 lights on).
    #[arg(long, overrides_with = "no_tiles")]
    pub tiles: bool,
    #[arg(long, overrides_with = "tiles")]
    pub no_tiles: bool,
    /// How reused reservoirs are weighted.
    #[arg(long, value_enum, default_value_t = Mode::Biased)]
    pub mode: Mode,
}

/// Measured on an H100 (docs/performance.md): equal at 500 lights, faster from some thousands on.
const TILES_FROM: u32 = 4096;

/// Point lights where neither the scene nor the user says how many.
const DEFAULT_LIGHTS: usize = 500;

impl SceneArgs {
    pub fn source(&self) -> SceneSource {
        if self.scene.as_os_str() == "atrium" {
            SceneSource::Atrium
        } else {
            SceneSource::File(self.scene.clone())
        }
    }

    pub fn environment_source(&self) -> Option<EnvironmentSource> {
        let path = self.environment.clone()?;
        Some(EnvironmentSource { path, scale: self.environment_scale })
    }

    pub fn light_count(&self) -> usize {
        self.n_lights.or(self.lights).unwrap_or(DEFAULT_LIGHTS)
    }
}

impl DeviceArgs {
    pub fn options(&self) -> DeviceOptions {
        DeviceOptions { validate: self.validate, device: self.device.clone(), ..DeviceOptions::default() }
    }
}

impl KnobArgs {
    pub fn settings(&self) -> Settings {
        Settings {
            candidates: self.candidates,
            visibility_reuse: (!self.no_visibility).into(),
            temporal: (!self.no_temporal).into(),
            spatial: (!self.no_spatial).into(),
            spatial_iterations: self.iterations,
            neighbors: self.neighbors,
            radius: self.radius,
            depth_threshold: self.depth_threshold,
            normal_threshold: self.normal_threshold.to_radians().cos(),
            confidence_cap: self.confidence_cap,
            reservoirs: self.reservoirs,
            mode: match self.mode {
                Mode::Biased => mode::BIASED,
                Mode::Unbiased => mode::UNBIASED,
            },
            tiles: self.tiles.into(),
        }
    }

    /// The same for a scene of so many lights: tiles pay where the light table outgrows the caches.
    pub fn settings_for(&self, lights: u32) -> Settings {
        let many = lights >= TILES_FROM && !self.no_tiles;
        Settings { tiles: (self.tiles || many).into(), ..self.settings() }
    }
}

fn parse_size(text: &str) -> Result<UVec2, String> {
    let (x, y) = text.split_once('x').ok_or("expected WIDTHxHEIGHT, such as 1280x720")?;
    match (x.parse(), y.parse()) {
        (Ok(x), Ok(y)) if (1..=16384).contains(&x) && (1..=16384).contains(&y) => Ok(UVec2::new(x, y)),
        _ => Err("width and height go from 1 to 16384".into()),
    }
}

fn positive(text: &str) -> Result<f32, String> {
    text.parse()
        .ok()
        .filter(|x: &f32| x.is_finite() && *x > 0.0)
        .ok_or_else(|| "expected a number above 0".into())
}

/// `x,y,z,tx,ty,tz[,fov]` as (position, target, fov in degrees), or none if it is no list of numbers.
pub fn parse_view(text: &str) -> Option<Result<(glam::Vec3, glam::Vec3, Option<f32>)>> {
    let numbers: Vec<f32> = text.split(',').map(|n| n.trim().parse().ok()).collect::<Option<_>>()?;
    let finite = numbers.iter().all(|n| n.is_finite());
    match numbers[..] {
        [x, y, z, tx, ty, tz, ref fov @ ..] if finite && fov.len() <= 1 => {
            Some(Ok((glam::Vec3::new(x, y, z), glam::Vec3::new(tx, ty, tz), fov.first().copied())))
        }
        // A single number is a camera's index.
        [_] => None,
        _ => Some(Err(Error::Usage(format!("--camera {text}: expected x,y,z,tx,ty,tz[,fov]")))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn render(line: &str) -> Result<RenderArgs, clap::Error> {
        let cli = Cli::try_parse_from(["candela", "render"].into_iter().chain(line.split(' ')))?;
        match cli.command {
            Command::Render(args) => Ok(args),
            _ => unreachable!(),
        }
    }

    #[test]
    fn defaults_are_the_settings_defaults() {
        let settings = render("-o a.png").unwrap().knobs.settings();
        assert!((settings.normal_threshold - Settings::default().normal_threshold).abs() < 1e-3);
        assert_eq!(
            Settings { normal_threshold: 0.0, ..settings },
            Settings { normal_threshold: 0.0, ..Settings::default() }
        );
    }

    #[test]
    fn knobs_reach_the_settings() {
        let line = "a.glb 7 -o a.png --size 64x48 --candidates 8 --neighbors 3 --iterations 1 --radius 10 --reservoirs 2 \
                    --no-temporal --no-spatial --spatial --no-visibility --depth-threshold 0.2 --normal-threshold 60";
        let args = render(&line.split_whitespace().collect::<Vec<_>>().join(" ")).unwrap();
        let s = args.knobs.settings();
        assert_eq!((s.candidates, s.neighbors, s.spatial_iterations, s.reservoirs), (8, 3, 1, 2));
        assert_eq!((s.temporal, s.spatial, s.visibility_reuse), (0, 1, 0));
        assert_eq!((s.radius, s.depth_threshold), (10.0, 0.2));
        assert!((s.normal_threshold - 0.5).abs() < 1e-6);
        assert_eq!((args.scene.light_count(), args.picture.size), (7, UVec2::new(64, 48)));
    }

    #[test]
    fn nonsense_is_refused() {
        for line in [
            "",
            "-o a.png --size 64",
            "-o a.png --size 0x5",
            "-o a.png --candidates 0",
            "-o a.png --candidates 2000",
            "-o a.png --radius nan",
            "-o a.png --radius -1",
            "-o a.png --mode magic",
            "a.glb 5 --lights 6 -o a.png",
        ] {
            assert!(render(line).is_err(), "{line}");
        }
    }

    #[test]
    fn views_are_six_or_seven_numbers() {
        assert!(parse_view("nave").is_none() && parse_view("2").is_none());
        let (position, target, fov) = parse_view("1,2,3,4,5,6").unwrap().unwrap();
        assert_eq!((position.x, target.z, fov), (1.0, 6.0, None));
        assert_eq!(parse_view("1,2,3,4,5,6,50").unwrap().unwrap().2, Some(50.0));
        assert!(parse_view("1,2,3").unwrap().is_err() && parse_view("1,2,3,4,5,inf").unwrap().is_err());
    }
}
