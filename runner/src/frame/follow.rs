//! Inputs and outputs of each pass of a frame, read back step by step, to run its body again on the CPU.

use super::history::History;
use super::pass::Step;
use super::targets::Target;
use crate::error::Result;
use bytemuck::Pod;
use glam::UVec2;
use shared::frame::FrameConstants;
use shared::passes::{Access, At, Pass};
use shared::resources::{Binding, Buffers, set};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Words of a buffer; steps that find the same content share it.
type Content = Arc<Vec<u32>>;

/// Follows a frame; see [`super::recorder::Recorder::render_stepwise`].
#[derive(Default)]
pub struct Follower {
    contents: BTreeMap<Target, Content>,
}

/// A pass that has run, with what it read and what it wrote.
pub struct Ran {
    pub pass: Pass,
    pub frame: FrameConstants,
    variant: u32,
    constants: shared::interface::PassConstants,
    found: Vec<(Binding, Content)>,
    left: Vec<(Binding, Content)>,
}

impl Follower {
    /// After `step` has run.
    pub fn see(&mut self, history: &History, frame: &FrameConstants, step: &Step) -> Result<Ran> {
        let (mut found, mut left) = (Vec::new(), Vec::new());
        for &(binding, access, target) in &step.targets {
            if access != Access::Write {
                let content = match self.contents.get(&target) {
                    Some(content) => content.clone(),
                    None => Arc::new(history.read(target)?),
                };
                self.contents.insert(target, content.clone());
                found.push((binding, content));
            }
        }
        for &(binding, access, target) in &step.targets {
            if access.writes() {
                let content = Content::new(history.read(target)?);
                self.contents.insert(target, content.clone());
                left.push((binding, content));
            }
        }
        let (variant, constants) = (step.variant, step.constants);
        Ok(Ran { pass: step.pass, frame: *frame, variant, constants, found, left })
    }
}

impl Ran {
    /// One of its threads, in a scene with `features`.
    pub fn at(&self, features: u32, pixel: UVec2, lane: u32) -> At<'_> {
        At::new(&self.frame, self.constants, features, self.variant, pixel.extend(lane))
    }

    pub fn iteration(&self) -> u32 {
        self.constants.iteration
    }

    /// What it read, in a scene that has `scene` in sets 0 and 2.
    pub fn buffers<'a>(&'a self, scene: &Buffers<'a>) -> Buffers<'a> {
        let mut buffers = *scene;
        for (binding, content) in &self.found {
            debug_assert_eq!(binding.set(), set::FRAME);
            buffers.set(*binding, bytemuck::cast_slice(content));
        }
        buffers
    }

    /// What it left behind `binding`; nothing if it does not write it.
    pub fn left<T: Pod>(&self, binding: Binding) -> &[T] {
        let content = self.left.iter().find(|(name, _)| *name == binding);
        content.map_or(&[], |(_, content)| bytemuck::cast_slice(content))
    }
}
