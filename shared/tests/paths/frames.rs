//! Frames of resampled paths on the CPU, the bodies of the GPU's passes in their order; and errors ([`Plant`]) in what they tell and
//! in what one leaves to the next.

use crate::world::{Grid, Rays, World};
use bytemuck::Zeroable;
use shared::bounced::{Bounced, PathSample};
use shared::camera::Camera;
use shared::frame::{FrameConstants, Settings, indirect};
use shared::glam::{DVec3, UVec2, UVec3, Vec3};
use shared::interface::{HitPayload, PassConstants};
use shared::light::{LightTable, Lights};
use shared::math::luminance;
use shared::passes::indirect::LEVELS;
use shared::passes::pair_targets::PairTargets;
use shared::passes::{self, Assumed, At, Question, Technique, Visibility, Witness};
use shared::pdf::SourcePdf;
use shared::reflected::Reflected;
use shared::resampling::CrossProposal;
use shared::resampling::initial::Candidate;
use shared::reservoir::StoredPath;
use shared::shading::Contribution;
use shared::shadow::ShadowRay;
use shared::surface::{GBufferTexel, Surface};
use std::cell::RefCell;
use std::collections::HashMap;

/// One step done wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plant {
    /// The geometry term between the pixel's surface and the point that reflects.
    Geometry,
    /// The reflectance at that point is that toward the pixel where the path was found.
    Reflectance,
    /// Lights that a ray from there finds weigh as if the table never drew them.
    Balance,
    /// A path that found nothing counts for nothing.
    EmptyForgotten,
    /// The history's paths are merged although the scene has changed.
    Stale,
    /// The MIS weight takes the canonical pixel's target for the other's own.
    ForeignTarget,
    /// The rays that ask whether the history's pixel, or this one, or a partner, sees a path.
    HistoryRay,
    SurvivorRay,
    PartnerRay,
    /// The probability of going on.
    Survival,
    /// A path that goes on answers for one pixel alone.
    Alone,
}

/// What two cameras see, which take turns: the odd one from a few pixels beside.
pub struct Views {
    pub size: UVec2,
    cameras: [Camera; 2],
    gbuffers: [Vec<GBufferTexel>; 2],
}

impl Views {
    pub fn new(world: &World, size: UVec2, eyes: [Vec3; 2], forward: Vec3) -> Self {
        Views::turned(world, size, eyes, [forward; 2])
    }

    pub fn turned(world: &World, size: UVec2, eyes: [Vec3; 2], forward: [Vec3; 2]) -> Self {
        let cameras = [0, 1].map(|i| Camera::new(eyes[i], forward[i], Vec3::Y, 0.35, size));
        let gbuffer = |camera| pixels(size).map(|pixel| world.texel(camera, pixel, size)).collect();
        Views { size, gbuffers: [gbuffer(&cameras[0]), gbuffer(&cameras[1])], cameras }
    }

    /// What frame `index` sees.
    pub fn surfaces(&self, index: u32) -> Vec<Surface> {
        let (camera, texels) = (&self.cameras[index as usize & 1], &self.gbuffers[index as usize & 1]);
        pixels(self.size)
            .zip(texels)
            .map(|(pixel, texel)| texel.unpack(u32::MAX, camera, pixel, self.size))
            .collect()
    }
}

fn pixels(size: UVec2) -> impl Iterator<Item = UVec2> {
    (0..size.x * size.y).map(move |i| UVec2::new(i % size.x, i / size.x))
}

/// Unlimited bounces, by `FULL`; both kinds of reuse.
pub fn settings(indirect: u32) -> Settings {
    Settings { indirect, radius: 4.0, depth_threshold: 0.5, ..Settings::default() }
}

pub fn one() -> Settings {
    settings(indirect::ONE)
}

/// A run of frames with what it carries from one to the next.
pub struct Sequence<'a> {
    pub world: &'a World,
    views: &'a Views,
    settings: Settings,
    seed: u32,
    plant: Option<Plant>,
    pub index: u32,
    history: Vec<StoredPath>,
    /// From where paths were found.
    found_from: RefCell<HashMap<[u32; 6], Vec3>>,
    /// The scene has changed since the frame before.
    changed: bool,
}

impl<'a> Sequence<'a> {
    pub fn new(
        world: &'a World,
        views: &'a Views,
        settings: Settings,
        seed: u32,
        plant: Option<Plant>,
    ) -> Self {
        let (history, found_from) = (Vec::new(), RefCell::default());
        Sequence { world, views, settings, seed, plant, index: 0, history, found_from, changed: false }
    }

    /// From now on the scene is `world`.
    pub fn change(&mut self, world: &'a World) {
        (self.world, self.changed) = (world, true);
    }

    /// Runs one frame and gives the light that bounced to its pixels.
    pub fn next_frame(&mut self) -> Vec<Vec3> {
        let [now, before] = [self.index as usize & 1, (self.index as usize + 1) & 1];
        let constants = FrameConstants {
            camera: self.views.cameras[now],
            previous_camera: self.views.cameras[before],
            size: self.views.size,
            index: self.index,
            seed: self.seed,
            settings: self.settings,
            environment_size: self.world.sky_size,
            first_environment_light: self.world.first_sky_light,
            ..FrameConstants::zeroed()
        };
        let frame = Frame { sequence: self, constants: &constants, gbuffer: &self.views.gbuffers[now] };
        let mut paths = frame.initial();
        if self.settings.indirect == indirect::FULL {
            (0..LEVELS.len()).for_each(|level| frame.further(&mut paths, level));
        }
        let keeps = !self.changed || frame.is(Plant::Stale);
        if self.settings.temporal != 0 && self.index > 0 && keeps {
            paths = frame.temporal(&self.views.gbuffers[before], &paths);
        }
        for iteration in 0..self.settings.spatial * self.settings.spatial_iterations {
            paths = frame.pairs(&paths, iteration);
        }
        let light = frame.shade(&paths);
        (self.history, self.changed) = (paths, false);
        self.index += 1;
        light
    }
}

struct Frame<'a> {
    sequence: &'a Sequence<'a>,
    constants: &'a FrameConstants,
    gbuffer: &'a [GBufferTexel],
}

/// Calls a body with the buffers of the lights and of the scene, and those that follow.
macro_rules! pass {
    ($body:ident($frame:ident, $at:expr, $rays:expr, $note:expr; $($last:expr),*)) => {{
        let world = $frame.sequence.world;
        let scene = world.scene();
        passes::$body(
            $at, $rays, $note, &world.lights, &world.alias, scene.instances, scene.positions, scene.attributes, scene.indices,
            scene.materials, scene.second_uvs, scene.environment, Grid, $frame.gbuffer, $($last),*
        )
    }};
}

impl Frame<'_> {
    fn is(&self, plant: Plant) -> bool {
        self.sequence.plant == Some(plant)
    }

    fn at(&self, pixel: UVec2, iteration: u32) -> At<'_> {
        let constants = PassConstants { iteration, ..PassConstants::default() };
        let UVec2 { x, y } = pixel;
        At::new(self.constants, constants, self.sequence.world.features, 0, UVec3::new(x, y, 0))
    }

    fn each<T>(&self, iteration: u32, of: impl Fn(At<'_>, Falsifier<'_>, usize) -> T) -> Vec<T> {
        let one = |(i, pixel)| {
            let at = self.at(pixel, iteration);
            of(at, Falsifier { frame: self, at }, i)
        };
        pixels(self.constants.size).enumerate().map(one).collect()
    }

    fn rays(&self) -> Asking<'_> {
        Asking { frame: self }
    }

    fn initial(&self) -> Vec<StoredPath> {
        self.each(0, |at, note, _| {
            let mut path = pass!(indirect_initial(self, at, self.rays(), note; &[]));
            assert_eq!(path.confidence, 1.0);
            let from = at.surface(&at.texel(self.gbuffer)).position;
            self.sequence.found_from.borrow_mut().insert(key(path.sample), from);
            if self.is(Plant::EmptyForgotten) && path.contribution_weight == 0.0 {
                path.confidence = 0.0;
            }
            path
        })
    }

    fn further(&self, paths: &mut [StoredPath], level: usize) {
        let World { features, .. } = self.sequence.world;
        let constants =
            PassConstants { iteration: level as u32, level: LEVELS[level], ..PassConstants::default() };
        let size = self.constants.size;
        for UVec2 { x, y } in pixels(size) {
            let at = At::picked(self.constants, constants, *features, 0, UVec3::new(x, y, 0));
            if at.pixel.cmplt(size).all() {
                let (note, i) =
                    (Falsifier { frame: self, at }, self.constants.pixel_index(at.pixel) as usize);
                paths[i] = pass!(indirect_further(self, at, self.rays(), note; paths[i]));
            }
        }
    }

    fn temporal(&self, before: &[GBufferTexel], fresh: &[StoredPath]) -> Vec<StoredPath> {
        let history = &self.sequence.history;
        self.each(
            0,
            |at, note, i| pass!(indirect_temporal(self, at, self.rays(), note; before, history, &[], fresh[i])),
        )
    }

    fn pairs(&self, paths: &[StoredPath], iteration: u32) -> Vec<StoredPath> {
        let targets: Vec<PairTargets> = self
            .each(iteration, |at, note, _| pass!(indirect_pair_targets(self, at, self.rays(), note; paths)));
        self.each(iteration, |at, note, _| passes::indirect_pair_merge(at, Assumed, note, paths, &targets))
    }

    fn shade(&self, paths: &[StoredPath]) -> Vec<Vec3> {
        self.each(0, |at, note, _| pass!(indirect_shade(self, at, Assumed, note; paths, Vec3::ZERO)))
    }

    fn table(&self) -> LightTable<'_> {
        let World { lights, alias, features, .. } = self.sequence.world;
        LightTable { lights: Lights { lights, features: *features }, alias }
    }

    fn bounced(&self) -> Bounced<'_, Grid> {
        Bounced { table: self.table(), scene: self.sequence.world.scene(), textures: Grid }
    }
}

fn key(sample: PathSample) -> [u32; 6] {
    bytemuck::cast(sample)
}

/// The rays of the world; or what a planted error makes of them: yes.
#[derive(Clone, Copy)]
struct Asking<'a> {
    frame: &'a Frame<'a>,
}

impl Visibility for Asking<'_> {
    const TRACES: bool = true;

    fn sees(&mut self, question: Question, ray: ShadowRay, key: u32) -> bool {
        let assumed = match question {
            Question::History => Plant::HistoryRay,
            Question::Survivor => Plant::SurvivorRay,
            Question::Partner => Plant::PartnerRay,
            _ => return Rays(self.frame.sequence.world).sees(question, ray, key),
        };
        self.frame.is(assumed) || Rays(self.frame.sequence.world).sees(question, ray, key)
    }

    fn nearest(&mut self, origin: Vec3, direction: Vec3, key: u32) -> HitPayload {
        Rays(self.frame.sequence.world).nearest(origin, direction, key)
    }
}

/// Plants errors in the steps of a body.
#[derive(Clone, Copy)]
struct Falsifier<'a> {
    frame: &'a Frame<'a>,
    at: At<'a>,
}

impl Witness for Falsifier<'_> {
    fn draws(&mut self, technique: Technique, candidate: &mut Candidate) {
        if self.frame.is(Plant::Balance) && technique == Technique::Bsdf {
            let SourcePdf(drawn) = self.frame.table().pdf(candidate.sample.light);
            candidate.source_pdf.0 -= drawn;
        }
    }

    fn crosses(&mut self, cross: &mut CrossProposal<PathSample>) {
        if self.frame.is(Plant::ForeignTarget) {
            cross.targets.neighbor_at_neighbor = cross.targets.neighbor_at_canonical;
        }
    }

    fn answers(&mut self, pixels: &mut f32) {
        if self.frame.is(Plant::Alone) {
            *pixels = 1.0;
        }
    }

    fn survives(&mut self, survival: &mut f32) {
        if self.frame.is(Plant::Survival) {
            *survival = 1.0;
        }
    }

    fn brings<L: Reflected>(&mut self, path: StoredPath, shaded: &mut Contribution<L>) {
        if path.contribution_weight == 0.0 {
            return;
        }
        let bounced = self.frame.bounced();
        let to = self.at.surface(&self.at.texel(self.frame.gbuffer)).position;
        let here = bounced.reflector(path.sample.point(), to);
        if self.frame.is(Plant::Geometry) {
            shaded.radiance = shaded.radiance * (1.0 / here.solid_angle);
        }
        if self.frame.is(Plant::Reflectance) {
            let from = self.frame.sequence.found_from.borrow()[&key(path.sample)];
            let there = bounced.reflector(path.sample.point(), from);
            let [stale, anew] = [there, here].map(|r| luminance(r.radiance(bounced.table, path.sample)));
            shaded.radiance = shaded.radiance * (stale / anew);
        }
    }
}

/// Independent runs of frames, each with a seed of its own: mean luminance of the last one in four parts of the picture.
pub fn runs(
    world: &World,
    views: &Views,
    settings: Settings,
    frames: u32,
    plant: Option<Plant>,
    count: u32,
) -> Vec<[f64; 4]> {
    let run = |seed| {
        let mut sequence = Sequence::new(world, views, settings, seed, plant);
        let last = (0..frames).map(|_| sequence.next_frame()).last().expect("a frame");
        assert!(last.iter().all(|light| light.is_finite() && light.min_element() >= 0.0));
        quarters(views.size, last.iter().map(|&light| f64::from(luminance(light))))
    };
    (1..=count).map(run).collect()
}

/// Means of the quarters of a picture.
pub fn quarters(size: UVec2, values: impl Iterator<Item = f64>) -> [f64; 4] {
    let mut sums = [0.0; 4];
    for (pixel, value) in pixels(size).zip(values) {
        sums[(pixel.x * 2 / size.x + pixel.y * 2 / size.y * 2) as usize] += value;
    }
    sums.map(|sum| sum / f64::from(size.x * size.y / 4))
}

/// Student's t of the quarter that is farthest off; `tolerance`: of the truth itself, relative.
pub fn largest_t(runs: &[[f64; 4]], truth: [f64; 4], tolerance: f64) -> f64 {
    let n = runs.len() as f64;
    let t = |quarter: usize| {
        let mean = runs.iter().map(|run| run[quarter]).sum::<f64>() / n;
        let variance = runs.iter().map(|run| (run[quarter] - mean).powi(2)).sum::<f64>() / (n - 1.0);
        let error = (variance / n + (tolerance * truth[quarter]).powi(2)).sqrt();
        (mean - truth[quarter]).abs() / error.max(f64::MIN_POSITIVE)
    };
    (0..4).map(t).fold(0.0, f64::max)
}

/// The eye's side of a world, as [`DVec3`] for quadratures.
pub fn luminances(light: impl Iterator<Item = DVec3>) -> impl Iterator<Item = f64> {
    light.map(|light| f64::from(luminance(light.as_vec3())))
}
