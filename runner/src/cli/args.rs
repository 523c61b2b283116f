//! What can be said on the command line, with units, ranges and defaults.

use crate::error::{Error, Result};
use crate::scene::{EnvironmentSource, SceneSource};
use crate::settings_file::{CANDIDATES, ITERATIONS, Mode, NEIGHBORS, RESERVOIRS, SettingsFile, Tiles};
use crate::vulkan::{DeviceOptions, pipeline_cache};
use clap::{Args, Parser, Subcommand};
use glam::UVec2;
use std::ops::Range;
use std::ops::RangeInclusive;
use std::path::PathBuf;

/// Direct lighting from thousands to millions of lights: ReSTIR DI on Vulkan ray tracing, every shader in Rust.
#[derive(Debug, Parser)]
#[command(version, args_conflicts_with_subcommands = true)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Option<Command>,
    /// Without a command: the viewer.
    #[command(flatten)]
    pub view: ViewArgs,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Open a window on a scene (what happens without a command).
    View(ViewArgs),
    /// Render a picture with ReSTIR.
    Render(RenderArgs),
    /// Render the truth: every light of every pixel, without resampling.
    Reference(ReferenceArgs),
    /// Say what a scene contains.
    Info(InfoArgs),
    /// Say how far a picture is from the truth.
    Compare(CompareArgs),
    /// Measure times and errors over scenes, lights and settings, and write a report.
    Sweep(SweepArgs),
    /// Measure the least that a frame's rays and bytes take on this device.
    Floors(FloorsArgs),
    /// Write the report of a sweep again, or the tables of a page.
    Report(ReportArgs),
    /// Write a scene for other programs: scene.json and PLY files (tools/mitsuba renders them with Mitsuba).
    Export(ExportArgs),
    /// Replay one pixel of one frame on the CPU: each candidate, ray and weight, and whether the GPU agrees.
    Explain(ExplainArgs),
    /// Write the project's own test scenes.
    #[command(hide = true)]
    Fixtures { directory: PathBuf },
}

/// Which scene, lit by what.
#[derive(Args, Clone, Debug)]
pub struct SceneArgs {
    /// A .gltf or .glb file, or a built-in scene: `atrium`, a hall, or `knot`, one object.
    #[arg(default_value = "atrium")]
    pub scene: PathBuf,
    /// Number of point lights: of the atrium, or scattered in a file that has no light [default: 500].
    pub n_lights: Option<usize>,
    /// The same as N_LIGHTS.
    #[arg(long, value_name = "N", conflicts_with = "n_lights")]
    pub lights: Option<usize>,
    /// Environment map around the scene: equirectangular .hdr or .exr, +Y up, its middle is +X; or `studio`, a built-in
    /// one for looking at models.
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
    /// Compile all pipelines anew, and keep none for the next start (also CANDELA_NO_PIPELINE_CACHE=1).
    #[arg(long)]
    pub no_pipeline_cache: bool,
    /// Say on standard error how long each step from start to first frame takes.
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
    #[arg(long, default_value_t = 0.0, allow_hyphen_values = true)]
    pub exposure: f32,
    /// Pose the scene's animations at T seconds; of a sequence, the time of frame 0 [default: at rest; of a sequence 0].
    #[arg(long, value_name = "T", value_parser = time)]
    pub time: Option<f64>,
    /// Look through this animated camera of the scene, by name or number.
    #[arg(long, value_name = "NAME", conflicts_with = "camera")]
    pub camera_path: Option<String>,
}

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
    #[arg(long, default_value_t = 0.0, allow_hyphen_values = true)]
    pub exposure: f32,
    /// Commands that the viewer plays by itself, for tests.
    #[arg(long, value_name = "FILE", hide = true)]
    pub script: Option<PathBuf>,
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
    /// N: frames to render, the last one is written. A..B: a sequence, pictures A to B - 1; `-o` must have #### or {frame} for
    /// their number.
    #[arg(long, value_name = "N|A..B", default_value = "16", value_parser = parse_frames)]
    pub frames: Frames,
    /// Pictures a second of a sequence.
    #[arg(long, default_value_t = 24.0, value_parser = positive)]
    pub fps: f32,
    /// Frames before the first picture of a sequence, which give it a history.
    #[arg(long, value_name = "N", default_value_t = 16)]
    pub warm_up: u32,
    /// Render the pictures of a sequence anew that exist.
    #[arg(long)]
    pub overwrite: bool,
    /// Write the mean of all frames instead of the last one.
    #[arg(long)]
    pub accumulate: bool,
}

/// What `--frames` asks for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Frames {
    /// So many of a still, for one picture.
    Still(u32),
    /// A picture each.
    Sequence(Range<u32>),
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
    /// Also what the driver's compiler made of each pass for this scene: registers, spills, instructions, as far as it tells.
    #[arg(long)]
    pub pipelines: bool,
    #[command(flatten)]
    pub device: DeviceArgs,
    /// As one JSON object.
    #[arg(long)]
    pub json: bool,
}

#[derive(Args, Clone, Debug)]
pub struct CompareArgs {
    /// The picture to judge: .exr, linear radiance.
    pub picture: PathBuf,
    /// The truth: .exr of the same size.
    pub reference: PathBuf,
    /// Print the numbers as JSON.
    #[arg(long)]
    pub json: bool,
    /// Write heat maps of the error to this folder: flip.png and signed.png.
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
}

#[derive(Args, Clone, Debug)]
pub struct SweepArgs {
    /// A .toml file, or a built-in plan: thesis, lights, modes, bench (times alone), smoke.
    pub plan: PathBuf,
    /// Folder of the results: points.json, points.csv, report.html.
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Folder of what is kept between runs: finished points and references [default: DIR/cache].
    #[arg(long, value_name = "DIR")]
    pub cache: Option<PathBuf>,
    /// Measure only the points whose name contains this; may be said several times.
    #[arg(long, value_name = "TEXT")]
    pub only: Vec<String>,
    /// Width x height in pixels, in place of the plan's.
    #[arg(long, value_parser = parse_size)]
    pub size: Option<UVec2>,
    /// Frames before the timed ones, in place of the plan's.
    #[arg(long, value_name = "FRAMES")]
    pub warm_up: Option<u32>,
    /// Timed frames, in place of the plan's.
    #[arg(long, value_parser = clap::value_parser!(u32).range(2..))]
    pub frames: Option<u32>,
    /// Independent runs, in place of the plan's.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    pub replicas: Option<u32>,
    /// Milliseconds of accumulation, in place of the plan's.
    #[arg(long, value_name = "MS", value_parser = positive)]
    pub accumulate: Option<f32>,
    /// Print the points of the plan and measure nothing.
    #[arg(long)]
    pub list: bool,
    #[command(flatten)]
    pub device: DeviceArgs,
}

#[derive(Args, Clone, Debug)]
pub struct FloorsArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Width x height in pixels.
    #[arg(long, default_value = "1920x1080", value_parser = parse_size)]
    pub size: UVec2,
    /// As for `render`.
    #[arg(long)]
    pub camera: Option<String>,
    /// The frame whose rays are traced.
    #[arg(long, value_enum, default_value_t = Mode::Biased)]
    pub mode: Mode,
    /// Timed launches of each kind of ray, and timed frames.
    #[arg(long, default_value_t = 32, value_parser = clap::value_parser!(u32).range(2..))]
    pub frames: u32,
    #[command(flatten)]
    pub device: DeviceArgs,
    /// As one JSON object.
    #[arg(long)]
    pub json: bool,
}

#[derive(Args, Clone, Debug)]
pub struct ReportArgs {
    /// Folder of a sweep's results, or of committed ones.
    pub directory: PathBuf,
    /// Fill the tables of this page from the folder's .json files.
    #[arg(long, value_name = "FILE")]
    pub markdown: Option<PathBuf>,
}

#[derive(Args, Clone, Debug)]
pub struct ExportArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Folder to write to; it is made if it is not there.
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// As for `render`.
    #[arg(long)]
    pub camera: Option<String>,
}

#[derive(Args, Clone, Debug)]
pub struct ExplainArgs {
    /// Column of the pixel, from the left, from 0.
    pub x: u32,
    /// Row of the pixel, from the top, from 0.
    pub y: u32,
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Width x height in pixels.
    #[arg(long, default_value = "1280x720", value_parser = parse_size)]
    pub size: UVec2,
    /// As for `render`.
    #[arg(long)]
    pub camera: Option<String>,
    /// As for `render`.
    #[arg(long, default_value_t = 0)]
    pub seed: u32,
    /// Frames, as `render` counts them; the last one is explained.
    #[arg(long, default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..))]
    pub frames: u32,
    /// Explain this frame instead, counted from 0.
    #[arg(long, value_name = "F", conflicts_with = "frames")]
    pub frame: Option<u32>,
    #[command(flatten)]
    pub device: DeviceArgs,
    #[command(flatten)]
    pub knobs: KnobArgs,
    /// Print JSON, for scripts.
    #[arg(long)]
    pub json: bool,
}

/// Every knob of the estimator: of `--settings`, changed by what else is said. See [`SettingsFile`].
#[derive(Args, Clone, Debug, Default)]
pub struct KnobArgs {
    /// A JSON document of knobs; the options below change single ones.
    #[arg(long, value_name = "FILE")]
    pub settings: Option<PathBuf>,
    #[arg(long, value_parser = count(&CANDIDATES), help = knob("Light candidates a reservoir: more is less noise and more time", |d| d.candidates))]
    pub candidates: Option<u32>,
    #[arg(long, value_parser = count(&NEIGHBORS), help = knob("Neighbors of each spatial pass", |d| d.neighbors))]
    pub neighbors: Option<u32>,
    #[arg(long, value_parser = count(&ITERATIONS), help = knob("Spatial passes", |d| d.iterations))]
    pub iterations: Option<u32>,
    #[arg(long, value_parser = positive, help = knob("Radius of the neighborhood, pixels", |d| d.radius))]
    pub radius: Option<f32>,
    #[arg(long, value_parser = count(&RESERVOIRS), help = knob("Reservoirs a pixel", |d| d.reservoirs))]
    pub reservoirs: Option<u32>,
    #[arg(long, value_parser = positive, help = knob("A history weighs at most this many times the new candidates", |d| d.confidence_cap))]
    pub confidence_cap: Option<f32>,
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
    #[arg(long, value_parser = positive, help = knob("Largest difference in distance between neighbors, as a fraction", |d| d.depth_threshold))]
    pub depth_threshold: Option<f32>,
    #[arg(long, value_parser = positive, help = knob("Largest angle between normals of neighbors, degrees", |d| d.normal_threshold))]
    pub normal_threshold: Option<f32>,
    /// Draw candidates from presampled light tiles (by default from 4,096 lights on).
    #[arg(long, overrides_with = "no_tiles")]
    pub tiles: bool,
    #[arg(long, overrides_with = "tiles")]
    pub no_tiles: bool,
    /// How reused reservoirs are weighted [default: biased].
    #[arg(long, value_enum)]
    pub mode: Option<Mode>,
}

/// Point lights where neither the scene nor the user says how many.
const DEFAULT_LIGHTS: usize = 500;

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
            Some(Command::Floors(args)) => args.device.timings,
            Some(Command::Explain(args)) => args.device.timings,
            _ => false,
        }
    }
}

impl SceneArgs {
    pub fn source(&self) -> SceneSource {
        SceneSource::named(&self.scene)
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

impl KnobArgs {
    /// The settings file, or the defaults, with the changes of the command line.
    pub fn document(&self) -> Result<SettingsFile> {
        let file = self.settings.as_deref().map(SettingsFile::read).transpose()?.unwrap_or_default();
        let switch = |on: bool, off: bool, default: bool| (default || on) && !off;
        let document = SettingsFile {
            mode: self.mode.unwrap_or(file.mode),
            candidates: self.candidates.unwrap_or(file.candidates),
            visibility: switch(self.visibility, self.no_visibility, file.visibility),
            temporal: switch(self.temporal, self.no_temporal, file.temporal),
            spatial: switch(self.spatial, self.no_spatial, file.spatial),
            iterations: self.iterations.unwrap_or(file.iterations),
            neighbors: self.neighbors.unwrap_or(file.neighbors),
            radius: self.radius.unwrap_or(file.radius),
            reservoirs: self.reservoirs.unwrap_or(file.reservoirs),
            confidence_cap: self.confidence_cap.unwrap_or(file.confidence_cap),
            depth_threshold: self.depth_threshold.unwrap_or(file.depth_threshold),
            normal_threshold: self.normal_threshold.map_or(file.normal_threshold, f64::from),
            tiles: match (self.tiles, self.no_tiles) {
                (true, _) => Tiles::On,
                (_, true) => Tiles::Off,
                _ => file.tiles,
            },
        };
        document.check().map_err(Error::Usage)?;
        Ok(document)
    }
}

/// Parser of a count in `range`.
fn count(range: &RangeInclusive<u32>) -> clap::builder::RangedI64ValueParser<u32> {
    clap::value_parser!(u32).range(i64::from(*range.start())..=i64::from(*range.end()))
}

/// A knob's help with its default.
fn knob<T: std::fmt::Display>(help: &str, default: impl Fn(&SettingsFile) -> T) -> String {
    format!("{help} [default: {}]", default(&SettingsFile::default()))
}

fn parse_frames(text: &str) -> Result<Frames, String> {
    const EXPECTED: &str = "expected a number of frames above 0, or a range A..B with A < B";
    let number = |text: &str| text.parse::<u32>().map_err(|_| EXPECTED.to_owned());
    let frames = match text.split_once("..") {
        None => Frames::Still(number(text)?),
        Some((first, end)) => Frames::Sequence(number(first)?..number(end)?),
    };
    match &frames {
        Frames::Still(0) => Err(EXPECTED.into()),
        Frames::Sequence(range) if range.is_empty() => Err(EXPECTED.into()),
        _ => Ok(frames),
    }
}

fn time(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|t: &f64| t.is_finite() && *t >= 0.0)
        .ok_or_else(|| "expected seconds, from 0 on".into())
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
            Some(Command::Render(args)) => Ok(args),
            _ => unreachable!(),
        }
    }

    #[test]
    fn defaults_are_the_documents_defaults() {
        let document = render("-o a.png").unwrap().knobs.document().unwrap();
        assert_eq!(document, SettingsFile::default());
    }

    /// Whatever the file says, the command line has the last word; what it does not mention stays.
    #[test]
    fn the_command_line_overrides_the_file() {
        let path = std::env::temp_dir().join(format!("candela-knobs-{}.json", std::process::id()));
        std::fs::write(&path, r#"{"candidates": 5, "temporal": false, "neighbors": 7, "tiles": "on"}"#)
            .unwrap();
        let line = |rest: &str| format!("-o a.png --settings {} {rest}", path.display()).trim().to_owned();
        let document = |rest: &str| render(&line(rest)).unwrap().knobs.document();
        let file = document("").unwrap();
        assert_eq!((file.candidates, file.temporal, file.neighbors, file.tiles), (5, false, 7, Tiles::On));
        let changed = document("--candidates 6 --temporal --no-tiles").unwrap();
        let expected = SettingsFile { candidates: 6, temporal: true, tiles: Tiles::Off, ..file };
        assert_eq!(changed, expected);
        std::fs::write(&path, r#"{"candidates": 5000}"#).unwrap();
        let error = document("").unwrap_err().to_string();
        assert!(error.contains("candela-knobs") && error.contains("1..=1024"), "{error}");
        std::fs::remove_file(&path).unwrap();
    }

    #[test]
    fn knobs_reach_the_settings() {
        let line = "a.glb 7 -o a.png --size 64x48 --candidates 8 --neighbors 3 --iterations 1 --radius 10 --reservoirs 2 \
                    --no-temporal --no-spatial --spatial --no-visibility --depth-threshold 0.2 --normal-threshold 60";
        let args = render(&line.split_whitespace().collect::<Vec<_>>().join(" ")).unwrap();
        let s = args.knobs.document().unwrap().settings(7);
        assert_eq!((s.candidates, s.neighbors, s.spatial_iterations, s.reservoirs), (8, 3, 1, 2));
        assert_eq!((s.temporal, s.spatial, s.visibility_reuse), (0, 1, 0));
        assert_eq!((s.radius, s.depth_threshold), (10.0, 0.2));
        assert!((s.normal_threshold - 0.5).abs() < 1e-6);
        assert_eq!((args.scene.light_count(), args.picture.size), (7, UVec2::new(64, 48)));
    }

    #[test]
    fn the_viewer_needs_no_command() {
        let parse = |line: &str| Cli::try_parse_from(line.split(' ')).unwrap();
        let cli = parse("candela");
        assert!(cli.command.is_none() && cli.view.scene.source() == SceneSource::Atrium);
        let cli = parse("candela a.glb 7 --candidates 8 --camera=-1,2,3,4,5,6");
        assert!(cli.command.is_none() && cli.view.knobs.candidates == Some(8));
        assert_eq!((cli.view.scene.light_count(), cli.view.camera.as_deref()), (7, Some("-1,2,3,4,5,6")));
        let Some(Command::View(args)) = parse("candela view a.glb 7").command else { panic!("no view") };
        assert_eq!(args.scene.scene, PathBuf::from("a.glb"));
        assert!(matches!(parse("candela info a.glb").command, Some(Command::Info(_))));
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
            "-o a.png --frames 0",
            "-o a.png --frames 5..5",
            "-o a.png --frames 5..x",
            "-o a.png --time -1",
            "-o a.png --time nan",
            "-o a.png --camera a --camera-path b",
        ] {
            assert!(render(line).is_err(), "{line}");
        }
    }

    #[test]
    fn frames_are_a_number_or_a_range() {
        assert_eq!(render("-o a.png").unwrap().frames, Frames::Still(16));
        assert_eq!(render("-o a.png --frames 3").unwrap().frames, Frames::Still(3));
        assert_eq!(render("-o a.png --frames 10..20").unwrap().frames, Frames::Sequence(10..20));
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
