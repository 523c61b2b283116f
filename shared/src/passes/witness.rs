//! Who hears what a pass does.

use super::paths::{Arrival, Bounce};
use crate::bounced::PathSample;
use crate::interface::HitPayload;
use crate::reflected::Reflected;
use crate::resampling::CrossProposal;
use crate::resampling::initial::{BsdfRay, Candidate, Fresh};
use crate::resampling::pairwise::Weighed;
use crate::reservoir::{StoredPath, StoredReservoir};
use crate::shading::Contribution;
use glam::UVec2;

/// How a candidate was drawn.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Technique {
    /// From the alias table over all lights.
    Table,
    /// From a light tile.
    Tile,
    /// From the pool of a cell.
    Pool,
    /// By a BSDF ray.
    Bsdf,
}

/// Hears the steps of a body, in their order. What comes as `&mut` a test may falsify, to see that the error is noticed.
/// All methods do nothing unless they are written: on the GPU nothing is left of them.
pub trait Witness {
    /// Before a candidate competes.
    fn draws(&mut self, _technique: Technique, _candidate: &mut Candidate) {}
    /// After it has; `fresh` is the reservoir with it.
    fn candidate(&mut self, _technique: Technique, _candidate: &Candidate, _fresh: &Fresh, _stays: bool) {}
    /// The tile, or the cell, that candidates come from.
    fn tile(&mut self, _tile: u32) {}
    /// A BSDF ray, what it met, and the light there.
    fn bsdf_ray(&mut self, _ray: &BsdfRay, _hit: HitPayload, _light: u32) {}
    /// The pixel whose reservoir is about to be merged, none outside the image; and whether its surface is similar.
    fn place(&mut self, _place: Option<UVec2>, _similar: bool) {}
    /// Before the targets of a merge are used.
    fn cross(&mut self, _cross: &mut CrossProposal) {}
    /// A reservoir has been merged, the other pixel's.
    fn merged(&mut self, _reservoir: StoredReservoir, _target: f32, _weighed: Weighed) {}
    /// The same of the pixel's own.
    fn merged_canonical(&mut self, _reservoir: StoredReservoir, _target: f32, _weighed: Weighed) {}
    /// What the canonical MIS weight gains if the last neighbor does not see the canonical sample, and whether it answers for all.
    fn pending(&mut self, _pending: f32, _asked: bool) {}
    /// What a reservoir contributes if its sample is visible.
    fn shaded<L: Reflected>(&mut self, _reservoir: StoredReservoir, _shaded: &mut Contribution<L>) {}
    /// Whether it was.
    fn lit<L: Reflected>(&mut self, _shaded: &Contribution<L>, _visible: bool) {}
    /// Where a path goes on, before it does.
    fn bounces(&mut self, _bounce: &mut Bounce) {}
    /// Light at a point of a path, before it is weighed.
    fn arrives(&mut self, _technique: Technique, _arrival: &mut Arrival) {}
    /// Before the targets of a merge of paths are used.
    fn crosses(&mut self, _cross: &mut CrossProposal<PathSample>) {}
    /// What a path brings to its pixel.
    fn brings<L: Reflected>(&mut self, _path: StoredPath, _shaded: &mut Contribution<L>) {}
    /// For how many pixels the one that goes on answers.
    fn answers(&mut self, _pixels: &mut f32) {}
    /// The probability with which a path went on, before it is divided by it.
    fn survives(&mut self, _survival: &mut f32) {}
}

/// Hears nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Witness for Silent {}
