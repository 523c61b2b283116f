//! `candela render`: frames of ReSTIR, the last one or their mean as a picture.

use super::accumulation::{Accumulation, Content};
use super::args::values::positive;
use super::args::{DeviceArgs, KnobArgs, PictureArgs, SceneArgs, choice};
use super::progress::Steps;
use super::{output, sequence, truth, view};
use candela::error::Result;
use candela::frame::renderer::{FrameOptions, Renderer};
use candela::frame::schedule::{Primary, Work};
use candela::gpu_scene::GpuScene;
use candela::image_io::PictureFormat;
use candela::knobs::Knobs;
use candela::startup;
use candela::vulkan::Device;
use candela_lab::measure::times::PassTimes;
use clap::Args;
use shared::antialias::PixelFilter;
use shared::frame::Settings;
use shared::math::CENTER;
use shared::resources::Resource;
use std::ops::Range;
use std::path::PathBuf;

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
    /// Frames rendered before the first picture of a sequence, for its history.
    #[arg(long, value_name = "N", default_value_t = 16)]
    pub warm_up: u32,
    /// Render pictures of a sequence again that exist already.
    #[arg(long)]
    pub overwrite: bool,
    /// Write the mean of all frames instead of the last one. On processors, whose rays cost most of a frame, the mean gets
    /// better sooner with --no-temporal --no-spatial.
    #[arg(long)]
    pub accumulate: bool,
    /// Antialias the mean of `--accumulate`: each frame looks through another place in each pixel, drawn like a filter.
    #[arg(long, value_name = "FILTER", requires = "accumulate", num_args = 0..=1, require_equals = true, default_missing_value = "gaussian", value_parser = choice::<PixelFilter>())]
    pub antialias: Option<PixelFilter>,
    /// Denoise and antialias the picture, for the eye: means over frames along surface points, an edge-stopping filter, and a mean
    /// over places in each pixel (not with --pixel-centers). Its histories are those of frames whose mean is taken.
    #[arg(long, conflicts_with_all = ["accumulate", "layers"])]
    pub denoise: bool,
    /// Write the truth beside the picture, an .exr: the sum over all lights at the very points that its pixels shaded; of a sequence
    /// one a picture, with #### or {frame} in its name.
    #[arg(long, value_name = "FILE")]
    pub truth: Option<PathBuf>,
    /// Points drawn on each light with an extent, of `--truth`.
    #[arg(long, default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..))]
    pub truth_samples: u32,
}

/// What `--frames` asks for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Frames {
    /// So many of a still, for one picture.
    Still(u32),
    /// A picture each.
    Sequence(Range<u32>),
}

pub fn run(args: &RenderArgs) -> Result<()> {
    match &args.frames {
        Frames::Still(frames) => still(args, *frames),
        Frames::Sequence(range) => sequence::run(args, range.clone()),
    }
}

fn still(args: &RenderArgs, frames: u32) -> Result<()> {
    let format = output::check(&args.picture.output, &args.picture)?;
    truth::check(args, args.truth.as_deref())?;
    let knobs = args.knobs.knobs()?;
    let mut scene = view::load_scene(&args.scene)?;
    view::pose(&mut scene, args.picture.time);
    let camera = view::camera(&scene, &args.picture)?;
    let device = Device::new(&args.device.options())?;
    let gpu_scene = GpuScene::new(&device, &scene)?;
    let settings = args.settings(&knobs, &gpu_scene);
    let size = args.picture.size;
    let mut renderer = Renderer::new(&device, gpu_scene, size, settings.reservoirs)?;
    if args.accumulate && device.info().is_processor() && (settings.temporal | settings.spatial) != 0 {
        eprintln!("note: on a processor the mean of frames converges faster with --no-temporal --no-spatial");
    }
    let mut options = args.options(settings, knobs.primary);

    // Radiance is radiance: only what is made for a display looks at one.
    let metered = match format {
        PictureFormat::Png => renderer.meter(camera, &options)?,
        PictureFormat::Exr => None,
    };
    let mut progress = Steps::new(frames.into(), "rendering");
    let mut times = PassTimes::default();
    let mut layers = (args.accumulate && options.parts).then(|| Accumulation::new(size, true));
    for frame in 1..=frames {
        options.place = args.antialias.map_or(CENTER, |filter| filter.place(frame - 1));
        times.add(match layers {
            None if args.accumulate => renderer.render_into_mean(camera, &options, frame)?,
            _ => renderer.render(camera, &options)?,
        });
        if frame == 1 {
            startup::reached("first frame, from start");
        }
        if let Some(layers) = &mut layers {
            layers.add(&renderer)?;
        }
        progress.step();
    }
    progress.end();

    let content = match layers {
        Some(layers) => layers.content(&renderer, camera, None)?,
        None if args.accumulate => Content::new(size, renderer.read(Resource::mean)?),
        None => Content::of_frame(&renderer, camera, None, options.parts)?,
    };
    output::write(content, format, &args.picture, metered)?;
    if let Some(path) = &args.truth {
        truth::write(path, args.truth_samples, &mut renderer, camera, &options)?;
        println!("wrote {}", path.display());
    }
    let lights = renderer.scene().light_count();
    println!("{}: {lights} lights, {}x{}, {} frames", device.info().name, size.x, size.y, frames);
    println!("{}", times.summary());
    let rays = renderer.parts().0.most_rays(&settings, knobs.primary);
    let pixels = u64::from(size.x) * u64::from(size.y);
    println!("rays a frame: at most {} ({rays} a pixel)", rays * pixels);
    output::check_validation(&device)
}

impl RenderArgs {
    /// Of its frames, for the scene on the device.
    pub fn settings(&self, knobs: &Knobs, scene: &GpuScene) -> Settings {
        let settings = knobs.settings(scene.lights());
        if self.accumulate || self.denoise { settings.for_a_mean() } else { settings }
    }

    pub fn options(&self, settings: Settings, primary: Primary) -> FrameOptions {
        let options = self.picture.options(Work::Restir(settings), primary);
        if self.denoise { options.finished() } else { options }
    }
}

/// Most pictures of one sequence.
const MAX_PICTURES: usize = 1_000_000;

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
        Frames::Sequence(range) if range.len() > MAX_PICTURES => {
            Err(format!("a sequence has at most {MAX_PICTURES} pictures; render it in parts"))
        }
        _ => Ok(frames),
    }
}
