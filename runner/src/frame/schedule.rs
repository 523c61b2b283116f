//! The frame as a readable list of passes, and which buffer each of them finds behind its roles.

use super::pass::{BufferId, Pass, Role, Step};
use super::passes::{
    gbuffer, gbuffer_raster, initial, initial_tiled, pair_merge, pair_targets, presample, reference, shade,
    shade_known, spatial, spatial_unbiased, temporal, temporal_known, temporal_moving, temporal_unbiased,
    temporal_unbiased_moving, tonemap, visibility,
};
use crate::vulkan::Device;
use serde::{Deserialize, Serialize};
use shared::frame::{Settings, mode};
use shared::interface::PassConstants;
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

/// How a frame finds what its pixels see. Both give the same surfaces, but where a pixel's center lies on an edge.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Primary {
    /// What was measured to be faster: `raster` on processors, `rays` on other devices.
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

/// What the passes of a frame depend on beside its work.
#[derive(Clone, Copy, Debug, Default)]
pub struct Conditions {
    /// Surfaces are drawn, not found by rays.
    pub draws: bool,
    /// [`shared::frame::features`] of the scene.
    pub features: u32,
    /// The scene is not where it was in the frame before.
    pub moved: bool,
    /// Every pixel sees the very point that it saw in the frame before.
    pub still: bool,
}

/// What a frame computes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Work {
    /// ReSTIR DI.
    Restir(Settings),
    /// The sum over this many lights.
    Reference { lights: u32 },
    /// A part of that sum: `count` lights from `first` on, added to the frame before unless `first` is 0.
    ReferenceSlice { first: u32, count: u32 },
}

/// The passes of one frame and the rotation that the next frame starts from.
pub fn schedule(work: &Work, conditions: Conditions, rotation: Rotation) -> (Vec<Step>, Rotation) {
    let (input, output) = (rotation.history, rotation.other(0));
    let mut frame = Frame { conditions, rotation, input, output, steps: Vec::new() };
    if let Work::ReferenceSlice { first, count } = *work {
        if first == 0 {
            frame.surfaces();
        }
        frame.reference(first..first + count);
        // The next slice adds to the same surfaces.
        return (frame.steps, rotation);
    }
    frame.surfaces();
    match *work {
        Work::Restir(ref settings) => frame.restir(settings),
        Work::Reference { lights } => frame.reference(0..lights),
        Work::ReferenceSlice { .. } => {}
    }
    frame.push(&tonemap::PASS, PassConstants::default());
    (frame.steps, Rotation { gbuffer: 1 - rotation.gbuffer, history: frame.output })
}

/// Steps that look at a frame, of which `after` is the rotation that it left.
pub fn looks(passes: &[(&'static Pass, PassConstants)], after: Rotation) -> Vec<Step> {
    let rotation = Rotation { gbuffer: 1 - after.gbuffer, ..after };
    let (input, output) = (after.history, after.other(0));
    let mut frame = Frame { conditions: Conditions::default(), rotation, input, output, steps: Vec::new() };
    for &(pass, constants) in passes {
        frame.push(pass, constants);
    }
    frame.steps
}

impl Rotation {
    /// The two reservoir buffers that do not hold the history.
    fn other(self, which: usize) -> usize {
        (self.history + 1 + which) % 3
    }

    /// The G-buffer of the frame before.
    pub fn last_gbuffer(self) -> BufferId {
        BufferId::GBuffer(1 - self.gbuffer)
    }

    /// The reservoirs that the frame before shaded.
    pub fn last_reservoirs(self) -> BufferId {
        BufferId::Reservoirs(self.history)
    }
}

struct Frame {
    conditions: Conditions,
    rotation: Rotation,
    /// Reservoirs the next pass reads / the next pass writes.
    input: usize,
    output: usize,
    steps: Vec<Step>,
}

impl Frame {
    fn surfaces(&mut self) {
        let passes: &[&'static Pass] = match self.conditions.draws {
            true => &[&visibility::PASS, &gbuffer_raster::PASS],
            false => &[&gbuffer::PASS],
        };
        passes.iter().for_each(|pass| self.push(pass, PassConstants::default()));
    }

    fn restir(&mut self, settings: &Settings) {
        let unbiased = settings.mode == mode::UNBIASED;
        let Conditions { moved, still, .. } = self.conditions;
        let temporal = match (unbiased, moved) {
            (true, true) => &temporal_unbiased_moving::PASS,
            (true, false) if still || !settings.visibility_is_known() => &temporal_known::PASS,
            (true, false) => &temporal_unbiased::PASS,
            (false, true) => &temporal_moving::PASS,
            (false, false) => &temporal::PASS,
        };
        let spatial = if unbiased { &spatial_unbiased::PASS } else { &spatial::PASS };
        if settings.tiles != 0 {
            self.push(&presample::PASS, PassConstants::default());
            self.push(&initial_tiled::PASS, PassConstants::default());
        } else {
            self.push(&initial::PASS, PassConstants::default());
        }
        if settings.temporal != 0 {
            self.push(temporal, PassConstants::default());
        }
        if settings.spatial != 0 {
            for iteration in 0..settings.spatial_iterations {
                self.input = self.output;
                self.output = self.rotation.other(1 - iteration as usize % 2);
                let constants = PassConstants { iteration, ..Default::default() };
                if settings.in_pairs() {
                    self.push(&pair_targets::PASS, constants);
                    self.push(&pair_merge::PASS, constants);
                } else {
                    self.push(spatial, constants);
                }
            }
        }
        self.input = self.output;
        let asks = settings.shading_needs_rays(self.conditions.features);
        self.push(if asks { &shade::PASS } else { &shade_known::PASS }, PassConstants::default());
    }

    fn reference(&mut self, lights: Range<u32>) {
        for first_light in lights.clone().step_by(REFERENCE_LIGHTS as usize) {
            let light_count = REFERENCE_LIGHTS.min(lights.end - first_light);
            self.push(&reference::PASS, PassConstants { first_light, light_count, ..Default::default() });
        }
    }

    fn push(&mut self, pass: &'static Pass, constants: PassConstants) {
        let buffers = pass.uses.iter().map(|&(role, _)| self.buffer(role)).collect();
        self.steps.push(Step { pass, buffers, constants });
    }

    fn buffer(&self, role: Role) -> BufferId {
        match role {
            Role::GBuffer => BufferId::GBuffer(self.rotation.gbuffer),
            Role::PreviousGBuffer => BufferId::GBuffer(1 - self.rotation.gbuffer),
            Role::ReservoirsIn => BufferId::Reservoirs(self.input),
            Role::ReservoirsOut => BufferId::Reservoirs(self.output),
            Role::ReservoirsHistory => BufferId::Reservoirs(self.rotation.history),
            Role::Radiance => BufferId::Radiance,
            Role::Display => BufferId::Display,
            Role::TileEntries => BufferId::TileEntries,
            Role::TilePoints => BufferId::TilePoints,
            Role::Mean => BufferId::Mean,
            Role::Reference => BufferId::Reference,
            Role::Statistics => BufferId::Statistics,
            Role::Rays => BufferId::Rays,
            Role::Hits => BufferId::Hits,
            Role::Visibility => BufferId::Visibility,
            Role::PairTargets => BufferId::Reservoirs(self.rotation.history),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::pass::{Access, barriers};
    use std::collections::HashMap;

    /// Follows the data: every buffer holds what its reader expects, however many iterations and whatever is off.
    #[test]
    fn every_pass_reads_what_the_pass_before_it_wrote() {
        for iterations in 1..=4 {
            for (temporal, spatial, pairs) in
                [(0, 0, 0), (0, 1, 0), (1, 0, 0), (1, 1, 0), (0, 1, 1), (1, 1, 1)]
            {
                let spatial_iterations = iterations;
                let settings =
                    Settings { temporal, spatial, pairs, spatial_iterations, ..Default::default() };
                follow(&Work::Restir(settings), true, "gbuffer_raster");
                follow(&Work::Restir(settings), false, "gbuffer");
            }
        }
    }

    fn follow(work: &Work, draws: bool, surfaces: &str) {
        let mut rotation = Rotation::default();
        let mut content: HashMap<BufferId, (u32, &str)> = HashMap::new();
        for frame in 0..7 {
            let conditions = Conditions { draws, moved: frame % 2 == 1, ..Default::default() };
            let (steps, next) = schedule(work, conditions, rotation);
            let mut last_reservoirs = "";
            for step in &steps {
                for (&(role, access), buffer) in step.pass.uses.iter().zip(&step.buffers) {
                    let found = content.get(buffer).copied();
                    match role {
                        Role::GBuffer if access == Access::Read => {
                            assert_eq!(found, Some((frame, surfaces)))
                        }
                        Role::PreviousGBuffer if frame > 0 => assert_eq!(found, Some((frame - 1, surfaces))),
                        Role::Visibility if access == Access::Read => {
                            assert_eq!(found, Some((frame, "visibility")))
                        }
                        Role::ReservoirsIn => assert_eq!(found, Some((frame, last_reservoirs))),
                        Role::PairTargets if access == Access::Read => {
                            assert_eq!(found, Some((frame, "pair_targets")))
                        }
                        Role::ReservoirsHistory if frame > 0 => {
                            assert_eq!(found.map(|f| f.0), Some(frame - 1), "history is of the frame before");
                        }
                        _ => {}
                    }
                }
                for (&(role, access), buffer) in step.pass.uses.iter().zip(&step.buffers) {
                    if access != Access::Read {
                        content.insert(*buffer, (frame, step.pass.stem));
                        last_reservoirs =
                            if role == Role::ReservoirsOut { step.pass.stem } else { last_reservoirs };
                    }
                }
            }
            let view = looks(&[(&super::super::passes::view::PASS, PassConstants::default())], next);
            assert_eq!(content[&view[0].buffers[0]], (frame, surfaces));
            assert_eq!(content[&view[0].buffers[1]], (frame, last_reservoirs));
            assert_eq!(content[&next.last_reservoirs()], (frame, last_reservoirs));
            assert_eq!(content[&next.last_gbuffer()], (frame, surfaces));
            rotation = next;
        }
    }

    #[test]
    fn the_thesis_frame_reads_like_the_paper() {
        let thesis = Settings { mode: mode::BIASED, spatial_iterations: 2, ..Settings::default() };
        let (steps, _) = schedule(&Work::Restir(thesis), Conditions::default(), Rotation::default());
        let stems: Vec<_> = steps.iter().map(|s| s.pass.stem).collect();
        assert_eq!(stems, ["gbuffer", "initial", "temporal", "spatial", "spatial", "shade", "tonemap"]);
        assert!(barriers(&steps).iter().all(|&wait| wait), "each pass needs the one before it");
    }

    #[test]
    fn the_reference_covers_each_light_once() {
        for lights in [0, 1, 63, 64, 65, 500] {
            let (steps, _) =
                schedule(&Work::Reference { lights }, Conditions::default(), Rotation::default());
            let ranges = steps.iter().filter(|s| s.pass.stem == "reference").map(|s| s.constants);
            let covered: Vec<u32> =
                ranges.flat_map(|c| c.first_light..c.first_light + c.light_count).collect();
            assert_eq!(covered, (0..lights).collect::<Vec<_>>());
        }
    }

    #[test]
    fn slices_of_the_reference_are_the_reference() {
        let mut rotation = Rotation::default();
        let mut covered = Vec::new();
        for (first, count) in [(0, 100), (100, 30), (130, 1)] {
            let work = Work::ReferenceSlice { first, count };
            let (steps, next) = schedule(&work, Conditions::default(), rotation);
            let surfaces = steps.iter().filter(|s| s.pass.stem == "gbuffer").count();
            assert_eq!(surfaces, usize::from(first == 0), "one set of surfaces for all");
            let adds = steps.iter().filter(|s| s.pass.stem == "reference").map(|s| s.constants);
            covered.extend(adds.flat_map(|c| c.first_light..c.first_light + c.light_count));
            rotation = next;
        }
        assert_eq!(covered, (0..131).collect::<Vec<_>>());
    }
}
