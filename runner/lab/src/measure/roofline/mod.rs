//! The least that a frame's rays and bytes can take on a device: the very rays of its passes, traced by a kernel that does
//! nothing else, and the G-buffer copied.

mod capture;

pub use capture::Captured;

use crate::measure::statistics::Times;
use crate::measure::sweep::steady::{SteadyPlan, Watch};
use crate::measure::times::PassTimes;
use candela::error::Result;
use candela::frame::renderer::{FrameOptions, MAX_TIMESTAMPS, Renderer};
use candela::frame::schedule::{Primary, Work};
use candela::scene::lights::LightTable;
use candela::vulkan::Timestamps;
use serde::Serialize;
use shared::camera::Camera;
use shared::frame::Settings;
use shared::interface::PassConstants;
use shared::passes::Pass;
use shared::resources::Resource;
use shared::stored_ray::StoredRay;
use shared::surface::GBufferTexel;
use std::time::Instant;

/// Rays of a pass, traced alone.
#[derive(Clone, Debug, Serialize)]
pub struct RayTimes {
    /// Its stem; a pass may trace one ray after another, and come more than once.
    pub pass: &'static str,
    pub rays: usize,
    pub hits: usize,
    pub ms: Times,
    /// Millions a second.
    pub rate: f64,
}

#[derive(Clone, Debug, Serialize)]
pub struct Roofline {
    /// Times stood still before they were taken; false: the longest wait was over.
    pub steady: bool,
    pub rays: Vec<RayTimes>,
    /// Bytes that the copy read and wrote.
    pub copied: u64,
    pub copy_ms: Times,
    /// 10⁹ bytes a second.
    pub bandwidth: f64,
    /// Medians of the frame that the rays are of: (pass, ms), and the whole.
    pub passes: Vec<(String, f64)>,
    pub frame_ms: f64,
}

/// The frame whose roofline is asked for.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    pub camera: Camera,
    /// With one reservoir a pixel.
    pub settings: Settings,
    pub primary: Primary,
}

/// Frames that give the captured one its history.
pub const HISTORY: u32 = 16;

impl Roofline {
    /// ms that the rays of the frame take alone.
    pub fn ray_ms(&self) -> f64 {
        self.rays.iter().map(|r| r.ms.median).sum()
    }
}

/// The rays of the frame after [`HISTORY`] others, in its order.
pub fn capture(renderer: &mut Renderer, lights: &LightTable, frame: Frame) -> Result<Vec<Captured>> {
    renderer.restart();
    for _ in 0..HISTORY {
        renderer.render(frame.camera, &frame.options())?;
    }
    capture::rays(renderer, lights, frame, |renderer, rays| hits(renderer, Pass::roofline_shadow, rays))
}

impl Captured {
    /// The kernel that traces such rays.
    fn kernel(&self) -> Pass {
        if self.pass == Pass::gbuffer.stem() { Pass::roofline_primary } else { Pass::roofline_shadow }
    }

    /// Of each ray, traced now, 1 if it met anything.
    pub fn hits(&self, renderer: &mut Renderer) -> Result<Vec<u32>> {
        hits(renderer, self.kernel(), &self.rays)
    }
}

/// Measures with `frames` timed launches of each kind, and as many of the whole `frame`.
pub fn measure(renderer: &mut Renderer, lights: &LightTable, frame: Frame, frames: u32) -> Result<Roofline> {
    let captured = capture(renderer, lights, frame)?;
    let mut bench = Bench { renderer, frames, steady: true };
    let rays = captured.iter().map(|captured| bench.rays(captured)).collect::<Result<_>>()?;
    let copied = 2 * u64::from(bench.renderer.size().element_product()) * size_of::<GBufferTexel>() as u64;
    let copy_ms = bench.time_pass(Pass::roofline_copy)?;
    let mut times = PassTimes::default();
    // The copy has overwritten the past.
    bench.renderer.restart();
    bench.settle(|renderer| frame.render(renderer, None))?;
    for _ in 0..frames {
        frame.render(bench.renderer, Some(&mut times))?;
    }
    let passes = times.medians().into_iter().map(|(stem, ms)| (stem.to_owned(), ms)).collect();
    let bandwidth = copied as f64 * 1e-6 / copy_ms.median;
    let steady = bench.steady;
    Ok(Roofline { steady, rays, copied, copy_ms, bandwidth, passes, frame_ms: times.frame_median() })
}

impl Frame {
    fn options(self) -> FrameOptions {
        FrameOptions::new(Work::Restir(self.settings), self.primary, 0)
    }

    /// Renders the whole of it; gives its ms.
    fn render(self, renderer: &mut Renderer, times: Option<&mut PassTimes>) -> Result<f64> {
        let start = Instant::now();
        let steps = renderer.render(self.camera, &self.options())?;
        let steps = steps.unwrap_or_else(|| vec![("frame", start.elapsed().as_secs_f64() * 1e3)]);
        let ms = steps.iter().map(|(_, ms)| ms).sum();
        if let Some(times) = times {
            times.add(Some(steps));
        }
        Ok(ms)
    }
}

/// `pass` alone; gives its ms.
fn launch(renderer: &mut Renderer, pass: Pass, timestamps: &mut Timestamps) -> Result<f64> {
    let (recorder, history) = renderer.parts();
    let (device, start) = (recorder.device().clone(), Instant::now());
    device.submit_once(pass.stem(), |cmd| {
        timestamps.begin(cmd);
        let passes = [(pass, PassConstants::default())];
        recorder.record_looks(cmd, history, None, &passes, timestamps)
    })?;
    let ms = timestamps.read()?.map(|steps| steps.iter().map(|(_, ms)| ms).sum());
    Ok(ms.unwrap_or_else(|| start.elapsed().as_secs_f64() * 1e3))
}

/// Of each ray, 1 if it met anything; the rays stay on the device.
fn hits(renderer: &mut Renderer, pass: Pass, rays: &[StoredRay]) -> Result<Vec<u32>> {
    let (recorder, history) = renderer.parts();
    history.set_rays(recorder.device(), rays)?;
    let mut timestamps = Timestamps::new(recorder.device(), MAX_TIMESTAMPS)?;
    launch(renderer, pass, &mut timestamps)?;
    renderer.read(Resource::hits)
}

struct Bench<'a> {
    renderer: &'a mut Renderer,
    frames: u32,
    steady: bool,
}

impl Bench<'_> {
    fn rays(&mut self, captured: &Captured) -> Result<RayTimes> {
        let hits = captured.hits(self.renderer)?.iter().sum::<u32>() as usize;
        let ms = self.time_pass(captured.kernel())?;
        let rays = captured.rays.iter().filter(|ray| ray.traced != 0).count();
        Ok(RayTimes { pass: captured.pass, rays, hits, ms, rate: rays as f64 * 1e-3 / ms.median })
    }

    /// ms of `pass` alone, warm.
    fn time_pass(&mut self, pass: Pass) -> Result<Times> {
        let (recorder, _) = self.renderer.parts();
        let mut timestamps = Timestamps::new(recorder.device(), MAX_TIMESTAMPS)?;
        self.settle(|renderer| launch(renderer, pass, &mut timestamps))?;
        let ms = (0..self.frames).map(|_| launch(self.renderer, pass, &mut timestamps));
        Ok(Times::of(&ms.collect::<Result<Vec<f64>>>()?))
    }

    /// Works until the time of a launch stands still.
    fn settle(&mut self, mut work: impl FnMut(&mut Renderer) -> Result<f64>) -> Result<()> {
        let (start, mut watch) = (Instant::now(), Watch::new(SteadyPlan::default()));
        loop {
            let ms = work(self.renderer)?;
            if let Some(settled) = watch.add(ms, start.elapsed().as_secs_f64() * 1e3) {
                self.steady &= settled.steady;
                return Ok(());
            }
        }
    }
}
