//! The frame as functions over a list of steps, and the copy of each buffer at a binding.

use super::pass::Step;
use super::targets::Target;
use crate::vulkan::Device;
use serde::{Deserialize, Serialize};
use shared::denoise;
use shared::frame::{Settings, features, indirect, mode};
use shared::interface::PassConstants;
use shared::passes::indirect::LEVELS;
use shared::passes::{Pass, variant};
use shared::resources::{Binding, Resource};
use std::ops::Range;

/// Lights that one dispatch of the reference adds: short enough that no driver's watchdog bites.
const REFERENCE_LIGHTS: u32 = 64;

/// Which of the double- and triple-buffered targets hold what; moves on with each frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rotation {
    /// G-buffer of the current frame, 0 or 1; the other is the previous frame's.
    gbuffer: usize,
    /// Reservoirs that the previous frame ended with, 0..3.
    history: usize,
}

/// How a frame finds the surface of each pixel. Both give the same surfaces, but where a pixel's center lies on an edge.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Primary {
    /// The faster one, as measured: `raster` on processors, `rays` on other devices.
    #[default]
    Auto,
    /// The graphics pipeline draws the scene.
    Raster,
    /// A ray a pixel.
    Rays,
}

impl Primary {
    /// Is the scene drawn on `device`?
    pub fn draws(self, device: &Device) -> bool {
        match self {
            Primary::Auto => device.info().is_processor(),
            Primary::Raster => true,
            Primary::Rays => false,
        }
    }
}

/// Which points of the scene pixels shade, see [`shared::points`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Points {
    /// Those behind their centers.
    #[default]
    Centers,
    /// Those of the frame before that fall into them now, by rays.
    Lasting,
    /// The same where nothing has changed: they return to the centers.
    Returning,
    /// Points that last, before a camera at rest: one after the other takes another place in its pixel.
    Wandering,
}

/// What the passes of a frame depend on beside its work.
#[derive(Clone, Copy, Debug, Default)]
pub struct Conditions {
    /// What pixels' centers see is drawn, not found by rays.
    pub draws: bool,
    /// Which points pixels shade.
    pub points: Points,
    /// [`shared::frame::features`] of the scene.
    pub features: u32,
    /// The scene is not where it was in the frame before.
    pub moved: bool,
    /// Every pixel sees the very point that it saw in the frame before.
    pub still: bool,
    /// Light is kept in parts until it is resolved.
    pub parts: bool,
    /// What is shown is denoised, which takes light in parts.
    pub denoise: bool,
    /// The frame before was denoised.
    pub denoised: bool,
    /// What is shown is antialiased, which is denoised.
    pub antialias: bool,
    /// The frame before was antialiased.
    pub antialiased: bool,
    /// The frame before left paths like those that this one draws.
    pub has_paths: bool,
}

/// What a frame computes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "the variants name their fields")]
pub enum Work {
    /// ReSTIR DI.
    Restir(Settings),
    /// The sum over this many lights.
    Reference { lights: u32 },
    /// A part of that sum: `count` lights from `first` on, added to the frame before unless `first` is 0.
    ReferenceSlice { first: u32, count: u32 },
    /// The sum over this many lights at the very surfaces that the frame before shaded. The frame after it follows that one.
    Truth { lights: u32 },
    /// Light that bounced to those surfaces, as of [`Work::Paths`].
    TruthPaths { bounces: u32, paths: u32 },
    /// Light that was reflected on its way to what a pixel sees, up to `bounces` times ([`shared::interface::UNBOUNDED`] for no
    /// end), the mean of `paths` of each pixel. It alone stands in radiance, or in its parts.
    Paths { bounces: u32, paths: u32 },
}

/// The passes of one frame and the rotation that the next frame starts from.
pub fn schedule(work: &Work, conditions: Conditions, rotation: Rotation) -> (Vec<Step>, Rotation) {
    let mut frame = Frame::new(conditions, rotation);
    match *work {
        Work::Restir(ref settings) => {
            surfaces(&mut frame);
            restir_di(&mut frame, settings);
            restir_gi(&mut frame, settings);
            if frame.conditions.denoise {
                denoise(&mut frame, settings);
                antialias(&mut frame);
            } else {
                resolve(&mut frame);
                if frame.conditions.parts && settings.indirect != indirect::OFF {
                    frame.run(Pass::resolve_indirect);
                }
            }
        }
        Work::Reference { lights } => {
            surfaces(&mut frame);
            reference(&mut frame, 0..lights);
            resolve(&mut frame);
        }
        Work::Paths { bounces, paths: count } => {
            surfaces(&mut frame);
            paths(&mut frame, bounces, count);
            let next = Rotation { gbuffer: 1 - rotation.gbuffer, history: frame.output };
            return (frame.steps, next);
        }
        Work::ReferenceSlice { first, count } => {
            if first == 0 {
                surfaces(&mut frame);
            }
            reference(&mut frame, first..first + count);
            resolve(&mut frame);
            // The next slice adds to the same surfaces.
            return (frame.steps, rotation);
        }
        Work::TruthPaths { bounces, paths: count } => {
            frame.run(Pass::gbuffer_kept);
            paths(&mut frame, bounces, count);
            return (frame.steps, rotation);
        }
        Work::Truth { lights } => {
            frame.run(Pass::gbuffer_kept);
            reference(&mut frame, 0..lights);
            resolve(&mut frame);
            return (frame.steps, rotation);
        }
    }
    frame.run(Pass::tonemap);
    (frame.steps, Rotation { gbuffer: 1 - rotation.gbuffer, history: frame.output })
}

/// What each pixel sees.
fn surfaces(frame: &mut Frame) {
    let rests = match (frame.conditions.points, frame.conditions.draws) {
        (Points::Centers, true) => {
            frame.run(Pass::visibility);
            return frame.run(Pass::gbuffer_raster);
        }
        (Points::Centers, false) => return frame.run(Pass::gbuffer),
        (Points::Lasting, _) => 0,
        (Points::Returning, _) => variant::RESTS,
        (Points::Wandering, _) => variant::WANDERS,
    };
    frame.run(Pass::scatter);
    frame.run(Pass::land);
    frame.run_variant(Pass::aim, rests);
    frame.run(Pass::gbuffer_aimed);
}

/// ReSTIR DI: candidates, reuse in time and in space, shading.
fn restir_di(frame: &mut Frame, settings: &Settings) {
    let Conditions { moved, still, features, parts, .. } = frame.conditions;
    let unbiased = settings.mode == mode::UNBIASED;
    let weights = if unbiased { variant::UNBIASED } else { 0 };
    if settings.cells != 0 {
        candidates_of_cells(frame, settings);
    } else if settings.tiles != 0 {
        frame.run(Pass::presample);
        frame.run_variant(frame.initial(settings), variant::TILED);
    } else {
        frame.run(frame.initial(settings));
    }
    if settings.temporal != 0 {
        // At rest all visibility is known; nobody asks where it is left to shading.
        let known = !moved && (still || !settings.visibility_is_known());
        let lasting = lasting(frame.conditions);
        let bits = weights | lasting | if moved { variant::MOVING } else { 0 };
        match (unbiased && !known, lasting != 0 && !moved) {
            (false, _) => frame.run_variant(Pass::temporal, bits),
            (true, false) => frame.run_variant(Pass::temporal_traced, bits),
            // Few pixels ask, here and there: threads that trace rays stand side by side.
            (true, true) => {
                frame.run_variant(Pass::temporal, bits);
                frame.run_variant(Pass::temporal_hops, bits);
            }
        }
    }
    for iteration in 0..settings.spatial * settings.spatial_iterations {
        frame.exchange(iteration);
        let constants = PassConstants { iteration, ..Default::default() };
        if settings.in_pairs() {
            frame.run_with(Pass::pair_targets, constants);
            frame.run_with(Pass::pair_merge, constants);
        } else {
            let pass = if unbiased { Pass::spatial_traced } else { Pass::spatial };
            frame.steps.push(frame.step(pass, weights, constants));
        }
    }
    frame.input = frame.output;
    frame.run(match (parts, settings.shading_needs_rays(features)) {
        (false, false) => Pass::shade,
        (false, true) => Pass::shade_traced,
        (true, false) => Pass::shade_parts,
        (true, true) => Pass::shade_parts_traced,
    });
}

/// The variant of passes that look for a point in the frame before.
fn lasting(conditions: Conditions) -> u32 {
    match conditions.points {
        Points::Centers => 0,
        Points::Lasting | Points::Returning | Points::Wandering => variant::LASTING,
    }
}

/// ReSTIR for light that bounces: paths, reuse in time and in pairs, shading on top of direct light. Always unbiased.
fn restir_gi(frame: &mut Frame, settings: &Settings) {
    if settings.indirect == indirect::OFF {
        return;
    }
    let Conditions { moved, still, parts, has_paths, .. } = frame.conditions;
    // As many exchanges as of reservoirs: both end in the same place.
    (frame.input, frame.output) = (frame.rotation.history, frame.rotation.other(0));
    frame.run_variant(Pass::indirect_initial, if frame.shares_ray(settings) { variant::MET } else { 0 });
    if settings.indirect == indirect::FULL {
        for (iteration, level) in (0..).zip(LEVELS) {
            let constants = PassConstants { iteration, level, ..Default::default() };
            frame.run_with(Pass::indirect_further, constants);
        }
    }
    // What arrives at the points of paths may have changed where something has moved.
    if settings.temporal != 0 && has_paths && !moved {
        let pass = if still { Pass::indirect_temporal } else { Pass::indirect_temporal_traced };
        frame.run_variant(pass, lasting(frame.conditions));
    }
    for iteration in 0..settings.spatial * settings.spatial_iterations {
        frame.exchange(iteration);
        let constants = PassConstants { iteration, ..Default::default() };
        frame.run_with(Pass::indirect_pair_targets, constants);
        frame.run_with(Pass::indirect_pair_merge, constants);
    }
    frame.input = frame.output;
    frame.run(if parts { Pass::indirect_shade_parts } else { Pass::indirect_shade });
}

/// Fresh candidates from what the cells of the world have learned; and what they learn of it.
fn candidates_of_cells(frame: &mut Frame, settings: &Settings) {
    for pass in [Pass::learn_beliefs, Pass::learn_lists, Pass::mark_cells, Pass::cells, Pass::pools] {
        frame.run(pass);
    }
    frame.run_variant(frame.initial(settings), variant::CELLS);
    if settings.learning != 0 {
        frame.run(Pass::observe);
    }
}

/// The sum over `lights`.
fn reference(frame: &mut Frame, lights: Range<u32>) {
    let pass = if frame.conditions.parts { Pass::reference_parts } else { Pass::reference };
    if frame.conditions.parts && lights.is_empty() {
        // Parts begin at 0, which somebody has to write.
        frame.run(pass);
    }
    for first_light in lights.clone().step_by(REFERENCE_LIGHTS as usize) {
        let light_count = REFERENCE_LIGHTS.min(lights.end - first_light);
        frame.run_with(pass, PassConstants { first_light, light_count, ..Default::default() });
    }
}

/// Light of `paths` of each pixel, in the place of what is seen unlit.
fn paths(frame: &mut Frame, bounces: u32, paths: u32) {
    let pass = if frame.conditions.parts { Pass::paths_parts } else { Pass::paths };
    frame.run_with(pass, PassConstants { bounces, paths, ..Default::default() });
}

/// The parts together are the picture.
fn resolve(frame: &mut Frame) {
    if frame.conditions.parts {
        frame.resolved = true;
        frame.run(Pass::resolve);
    }
}

/// The picture from light in parts without its noise, see [`shared::denoise`].
fn denoise(frame: &mut Frame, settings: &Settings) {
    let Conditions { moved, denoised, .. } = frame.conditions;
    let bit = |is: bool, variant: u32| if is { variant } else { 0 };
    let bounced = settings.indirect != indirect::OFF;
    let bits = bit(bounced, variant::BOUNCED)
        | bit(denoised, lasting(frame.conditions) | variant::DENOISED | bit(moved, variant::MOVING));
    frame.filter(Pass::denoise_temporal, bits, 0);
    frame.filter(Pass::denoise_variance, 0, 0);
    for iteration in 0..denoise::ITERATIONS {
        frame.filter(Pass::denoise_spatial, 0, iteration);
    }
    frame.resolved = true;
    // Light in parts is dead by then.
    frame.aliased = frame.conditions.antialias;
    frame.run(Pass::resolve_denoised);
}

/// The mean of the picture over places in its pixels, see [`shared::antialias`].
fn antialias(frame: &mut Frame) {
    let Conditions { antialias, antialiased, moved, .. } = frame.conditions;
    if antialias {
        frame.aliased = false;
        let bit = |is: bool, variant: u32| if is { variant } else { 0 };
        frame.run_variant(
            Pass::antialias,
            bit(antialiased, variant::ANTIALIASED | bit(moved, variant::MOVING)),
        );
    }
}

/// Steps that look at a frame, of which `after` is the rotation that it left.
pub fn looks(passes: &[(Pass, PassConstants)], after: Rotation) -> Vec<Step> {
    let mut frame = Frame::new(Conditions::default(), Rotation { gbuffer: 1 - after.gbuffer, ..after });
    passes.iter().for_each(|&(pass, constants)| frame.run_with(pass, constants));
    frame.steps
}

impl Rotation {
    /// The two reservoir buffers that do not hold the history.
    fn other(self, which: usize) -> usize {
        (self.history + 1 + which) % 3
    }

    /// The G-buffer of the frame before.
    pub fn last_gbuffer(self) -> Target {
        Target { resource: Resource::gbuffer, copy: 1 - self.gbuffer }
    }

    /// The reservoirs that the frame before shaded.
    pub fn last_reservoirs(self) -> Target {
        Target { resource: Resource::reservoirs, copy: self.history }
    }
}

/// A frame in the making.
struct Frame {
    conditions: Conditions,
    rotation: Rotation,
    /// Reservoirs the next pass reads / the next pass writes.
    input: usize,
    output: usize,
    /// Copy of what is filtered that the next pass of the denoiser reads.
    filtering: usize,
    /// Behind `radiance` stands the picture of this frame alone.
    aliased: bool,
    /// Behind `radiance` stands the picture, not yet its emission alone.
    resolved: bool,
    steps: Vec<Step>,
}

impl Frame {
    fn new(conditions: Conditions, rotation: Rotation) -> Self {
        let (input, output) = (rotation.history, rotation.other(0));
        Frame {
            conditions,
            rotation,
            input,
            output,
            filtering: 0,
            aliased: false,
            resolved: !conditions.parts,
            steps: Vec::new(),
        }
    }

    fn run(&mut self, pass: Pass) {
        self.run_with(pass, PassConstants::default());
    }

    fn run_with(&mut self, pass: Pass, constants: PassConstants) {
        self.steps.push(self.step(pass, 0, constants));
    }

    fn run_variant(&mut self, pass: Pass, variant: u32) {
        self.steps.push(self.step(pass, variant, PassConstants::default()));
    }

    fn step(&self, pass: Pass, variant: u32, constants: PassConstants) -> Step {
        Step::new(pass, variant, constants, |binding| self.target(binding))
    }

    /// Do paths begin along the BSDF rays of direct light? Those go through what is not surely in the way: here all is.
    fn shares_ray(&self, settings: &Settings) -> bool {
        let features = self.conditions.features;
        settings.indirect != indirect::OFF
            && features & features::ALPHA == 0
            && settings.bsdf_candidates(features) > 0
    }

    /// Fresh candidates of direct light.
    fn initial(&self, settings: &Settings) -> Pass {
        if self.shares_ray(settings) { Pass::initial_met } else { Pass::initial }
    }

    /// A pass of the denoiser; the next one reads what it writes.
    fn filter(&mut self, pass: Pass, variant: u32, iteration: u32) {
        let constants = PassConstants { iteration, ..Default::default() };
        self.steps.push(self.step(pass, variant, constants));
        self.filtering = 1 - self.filtering;
    }

    /// What was written is read next, in iteration `iteration` of spatial reuse.
    fn exchange(&mut self, iteration: u32) {
        self.input = self.output;
        self.output = self.rotation.other(1 - iteration as usize % 2);
    }

    fn target(&self, binding: Binding) -> Target {
        let copy = |resource, copy| Target { resource, copy };
        match binding {
            Binding::gbuffer => copy(Resource::gbuffer, self.rotation.gbuffer),
            Binding::previous_gbuffer => self.rotation.last_gbuffer(),
            Binding::points => copy(Resource::points, self.rotation.gbuffer),
            Binding::previous_points => copy(Resource::points, 1 - self.rotation.gbuffer),
            Binding::smoothed => copy(Resource::smoothed, self.rotation.gbuffer),
            Binding::previous_smoothed => copy(Resource::smoothed, 1 - self.rotation.gbuffer),
            Binding::filtering => copy(Resource::filtered, self.filtering),
            Binding::filtered => copy(Resource::filtered, 1 - self.filtering),
            Binding::reservoirs => copy(Resource::reservoirs, self.input),
            Binding::merged => copy(Resource::reservoirs, self.output),
            // The history is dead once it is merged: pairs of pixels tell each other there what they know.
            Binding::history | Binding::pair_targets => self.rotation.last_reservoirs(),
            Binding::paths => copy(Resource::paths, self.input),
            Binding::merged_paths => copy(Resource::paths, self.output),
            Binding::path_history | Binding::path_targets => copy(Resource::paths, self.rotation.history),
            Binding::antialiased => copy(Resource::antialiased, self.rotation.gbuffer),
            Binding::previous_antialiased => copy(Resource::antialiased, 1 - self.rotation.gbuffer),
            Binding::aliased => Resource::direct_diffuse.into(),
            Binding::radiance if self.aliased => Resource::direct_diffuse.into(),
            Binding::radiance if !self.resolved => Resource::emission.into(),
            once => once.resource().into(),
        }
    }
}

#[cfg(test)]
mod tests;
