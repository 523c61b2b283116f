//! `candela render --frames A..B`: pictures of a sequence, one a frame. Those that exist are skipped, so that jobs can share a
//! sequence and resume it.

use super::accumulation::{Before, Content};
use super::progress::Steps;
use super::render::RenderArgs;
use super::writer::Writer;
use super::{output, truth, view};
use candela::error::{Error, Result};
use candela::exposure;
use candela::frame::renderer::{FrameOptions, Renderer};
use candela::gpu_scene::GpuScene;
use candela::image_io::PictureFormat;
use candela::scene::SceneDescription;
use candela::vulkan::Device;
use candela_lab::measure::times::PassTimes;
use shared::camera::Camera;
use std::ops::Range;
use std::path::{Path, PathBuf};

pub fn run(args: &RenderArgs, frames: Range<u32>) -> Result<()> {
    if args.accumulate {
        return Err(Error::Usage(
            "--accumulate writes one picture, a range of --frames one for each frame: use one of them".into(),
        ));
    }
    let wanted: Vec<(u32, PathBuf)> = frames
        .map(|frame| Ok((frame, numbered(&args.picture.output, frame)?)))
        .collect::<Result<Vec<_>>>()?;
    let format = output::check(&wanted[0].1, &args.picture)?;
    let truths = args.truth.as_ref();
    truth::check(args, truths.map(|path| numbered(path, wanted[0].0)).transpose()?.as_deref())?;
    let all = wanted.len();
    let missing: Vec<_> = wanted.into_iter().filter(|(_, path)| args.overwrite || !path.exists()).collect();
    if missing.len() < all {
        println!(
            "{} of {all} pictures exist and are skipped (--overwrite renders them again)",
            all - missing.len()
        );
    }
    if missing.is_empty() {
        return Ok(());
    }
    let knobs = args.knobs.knobs()?;
    let scene = view::load_scene(&args.scene)?;
    view::camera(&scene, &args.picture)?;
    let device = Device::new(&args.device.options())?;
    let gpu_scene = GpuScene::new(&device, &scene)?;
    let settings = args.settings(&knobs, &gpu_scene);
    let renderer = Renderer::new(&device, gpu_scene, args.picture.size, settings.reservoirs)?;
    let options = args.options(settings, knobs.primary);
    let mut film = Film {
        args,
        scene,
        renderer,
        options,
        next: None,
        now: None,
        before: None,
        times: PassTimes::default(),
    };
    let mut progress = Steps::new(missing.len() as u64, "sequence");
    // The same for all pictures, and for all jobs that share the sequence.
    let exposure = match format {
        PictureFormat::Exr => 1.0,
        PictureFormat::Png => film.exposure()?,
    };
    let mut writer = Writer::new();
    for (frame, path) in &missing {
        let camera = film.picture(*frame)?;
        let content = Content::of_frame(&film.renderer, camera, film.before.as_ref(), options.parts)?;
        writer.push(path.clone(), move || content.encode(format, exposure))?;
        if let Some(path) = truths {
            let path = numbered(path, *frame)?;
            truth::write(&path, args.truth_samples, &mut film.renderer, camera, &options)?;
        }
        progress.step();
    }
    writer.finish()?;
    progress.end();
    let (first, last) = (&missing[0].1, &missing[missing.len() - 1].1);
    println!("wrote {} pictures, {} to {}", missing.len(), first.display(), last.display());
    println!("{}: {} lights", device.info().name, film.renderer.scene().light_count());
    println!(
        "{}; a GPU lowers its clock while pictures are read back, so measure times with `sweep`",
        film.times.summary()
    );
    output::check_validation(&device)
}

/// A scene that runs through its frames.
struct Film<'a> {
    args: &'a RenderArgs,
    scene: SceneDescription,
    renderer: Renderer,
    options: FrameOptions,
    /// The frame that continues the history.
    next: Option<u32>,
    /// The camera of the last frame of this history.
    now: Option<Camera>,
    /// The frame before that, where layers ask for it.
    before: Option<Before>,
    times: PassTimes,
}

impl Film<'_> {
    /// Renders `frame` and gives its camera, with the history of the frame before: rendered just now, or anew from `--warm-up` frames before.
    fn picture(&mut self, frame: u32) -> Result<Camera> {
        if self.next != Some(frame) {
            self.renderer.restart();
            self.now = None;
            for before in (1..=self.args.warm_up).rev() {
                // Before the beginning everything stands where it begins.
                self.render(frame.saturating_sub(before))?;
            }
        }
        self.next = Some(frame + 1);
        self.render(frame)
    }

    /// By the first picture.
    fn exposure(&mut self) -> Result<f32> {
        let stops = self.args.picture.exposure;
        let camera = self.set(0)?;
        match self.renderer.meter(camera, &self.options)? {
            Some(exposure) => Ok(exposure * stops.exp2()),
            None => {
                self.picture(0)?;
                Ok(exposure::automatic(&self.renderer.radiance()?, stops))
            }
        }
    }

    fn render(&mut self, frame: u32) -> Result<Camera> {
        let version = self.renderer.scene().version();
        let camera = self.set(frame)?;
        self.times.add(self.renderer.render(camera, &self.options)?);
        let scene = self.renderer.scene();
        self.before = match self.now.replace(camera) {
            Some(camera) if self.options.parts => {
                let motions = if scene.version() != version { scene.motions()? } else { Vec::new() };
                Some(Before { camera, motions })
            }
            _ => None,
        };
        Ok(camera)
    }

    /// The scene as `frame` shows it, and its camera.
    fn set(&mut self, frame: u32) -> Result<Camera> {
        let time = self.args.picture.time.unwrap_or(0.0) + f64::from(frame) / f64::from(self.args.fps);
        let pose = self.scene.pose(time);
        self.scene.apply(&pose);
        if self.scene.changes() {
            self.renderer.update_scene(&self.scene, &pose)?;
        }
        view::camera(&self.scene, &self.args.picture)
    }
}

/// `path` with the number of `frame` in place of the last run of # (padded with zeros to its length) or of `{frame}`, in its
/// file name.
fn numbered(path: &Path, frame: u32) -> Result<PathBuf> {
    let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    let name = if let Some(end) = name.rfind('#') {
        let start = name[..end]
            .rfind(|c| c != '#')
            .map_or(0, |i| i + name[i..].chars().next().map_or(1, char::len_utf8));
        let width = end + 1 - start;
        format!("{}{frame:0width$}{}", &name[..start], &name[end + 1..])
    } else if name.contains("{frame}") {
        name.replace("{frame}", &frame.to_string())
    } else {
        let path = path.display();
        return Err(Error::Usage(format!("-o {path}: a sequence needs #### or {{frame}} in its file name")));
    };
    Ok(path.with_file_name(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_take_the_number() {
        let name =
            |text: &str, frame| numbered(Path::new(text), frame).map(|path| path.display().to_string());
        assert_eq!(name("out/a-####.png", 7).unwrap(), "out/a-0007.png");
        assert_eq!(name("####.exr", 12345).unwrap(), "12345.exr");
        assert_eq!(name("#take-##é###.png", 8).unwrap(), "#take-##é008.png");
        assert_eq!(name("é##.png", 8).unwrap(), "é08.png");
        assert_eq!(name("a.{frame}.png", 8).unwrap(), "a.8.png");
        for text in ["a.png", "out-##/a.png", ".."] {
            assert!(name(text, 1).unwrap_err().to_string().contains("####"), "{text}");
        }
    }
}
