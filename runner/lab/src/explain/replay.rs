//! The bodies of passes, run again for one pixel: rays are answered by every triangle in f64, and what a body does is written down.

use super::World;
use super::compare::{Difference, ROUNDING_ULPS, ulps};
use super::heard::Heard;
use super::record::{PassReport, Shading};
use candela::frame::follow::Ran;
use glam::{UVec2, Vec3};
use shared::cells::cell_of;
use shared::cells::pool::Sources;
use shared::interface::HitPayload;
use shared::passes::pair_targets::PairTargets;
use shared::passes::{
    Assumed, At, Body, Output, Question, Silent, Stage, Technique, Visibility, Witness, run, variant,
};
use shared::pdf::SourcePdf;
use shared::reflected::Reflected;
use shared::resampling::initial::{BsdfRay, Candidate, Fresh};
use shared::resampling::pairwise::Weighed;
use shared::resampling::{CrossProposal, reservoir_index};
use shared::reservoir::StoredReservoir;
use shared::resources::{Binding, Buffers, Extent};
use shared::shading::Contribution;
use shared::shadow::ShadowRay;
use std::cell::RefCell;

/// The pixel to replay, and the scene around it.
pub struct Replay<'a> {
    pub world: &'a World<'a>,
    pub buffers: Buffers<'a>,
    pub ran: &'a Ran,
    pub pixel: UVec2,
}

impl Replay<'_> {
    /// The pass over reservoir `lane`. `pairs`: of a pass that merges pairs, the one before it, which told them of each other.
    pub fn reservoir(&self, lane: u32, pairs: Option<&Replay<'_>>) -> PassReport {
        let at = self.at(lane);
        let gpu: StoredReservoir = self.ran.left(Binding::merged)[at.index(Extent::Reservoirs)];
        let attempt = |flips| {
            let heard = Listener::new(Heard::new(self, lane, gpu, flips));
            let targets = pairs.map(|pairs| pairs.targets(lane, self.buffers.pair_targets, &heard));
            let pair_targets = targets.as_deref().unwrap_or_default();
            let result = self.run(lane, &Buffers { pair_targets, ..self.buffers }, &heard);
            let Some(Output::Reservoir(cpu)) = result else { return (StoredReservoir::default(), heard) };
            (cpu, heard)
        };
        let agrees = |cpu: &StoredReservoir| Difference::new(*cpu, gpu).is_rounding();
        let (cpu, heard) = first_agreeing(attempt, agrees);
        let heard = heard.0.into_inner();
        PassReport {
            pass: self.ran.pass.stem(),
            iteration: self.ran.iteration(),
            reservoir: lane,
            cpu: self.world.survivor(cpu),
            gpu: self.world.survivor(gpu),
            difference: Difference::new(cpu, gpu),
            ..heard.report(cpu)
        }
    }

    /// The pass that shades.
    pub fn shading(&self) -> Shading {
        let index = self.at(0).index(Extent::Pixels);
        let gpu: Vec3 = self.ran.left(Binding::radiance)[index];
        let difference = |cpu: Vec3| [0, 1, 2].map(|i| ulps(cpu[i], gpu[i]));
        let attempt = |flips| {
            let heard = Listener::new(Heard::new(self, 0, StoredReservoir::default(), flips));
            let result = self.run(0, &self.buffers, &heard);
            let Some(Output::Radiance(cpu)) = result else { return (Vec3::NAN, heard) };
            (cpu, heard)
        };
        let agrees = |cpu: &Vec3| difference(*cpu).iter().all(|&u| u <= ROUNDING_ULPS);
        let (cpu, heard) = first_agreeing(attempt, agrees);
        let Heard { contributions, rays, .. } = heard.0.into_inner();
        Shading { contributions, rays, cpu: cpu.to_array(), ulps: difference(cpu) }
    }

    pub fn at(&self, lane: u32) -> At<'_> {
        self.ran.at(self.world.features(), self.pixel, lane)
    }

    /// The density with which the pass draws candidates on `light`, but for BSDF rays.
    pub fn source_pdf(&self, lane: u32, light: u32) -> SourcePdf {
        let (at, b) = (self.at(lane), &self.buffers);
        if at.is(variant::CELLS) {
            self.sources(lane).pdf(light)
        } else {
            at.light_table(b.lights, b.alias).pdf(light)
        }
    }

    /// What entry `entry` of the pool of the pixel's cell is drawn from.
    pub fn source(&self, lane: u32, entry: u32) -> &'static str {
        self.sources(lane).name(entry)
    }

    /// Of the pixel's cell.
    fn sources(&self, lane: u32) -> Sources<'_> {
        let (at, b) = (self.at(lane), &self.buffers);
        let table = at.light_table(b.lights, b.alias);
        let tree = at.light_tree(b.tree_nodes, b.tree_lights, b.tree_leaves);
        let place = cell_of(at.frame, &at.surface(&at.texel(b.gbuffer)), at.pixel);
        at.sources(table, tree, b.cells, b.lists, b.beliefs, place)
    }

    fn run(&self, lane: u32, buffers: &Buffers<'_>, heard: &Listener<'_>) -> Option<Output> {
        let (body, at) = (self.ran.pass.body(), self.at(lane));
        match self.ran.pass.stage() {
            Stage::RayTracing(_) => run(body, at, heard, heard, buffers),
            Stage::Compute | Stage::Raster => run(body, at, Assumed, heard, buffers),
        }
    }

    /// `gpu`, what `pair_targets` left, with what the CPU makes of both halves of the pixel's pair.
    fn targets(&self, lane: u32, gpu: &[PairTargets], heard: &Listener<'_>) -> Vec<PairTargets> {
        let mut targets = gpu.to_vec();
        let half = |pixel: UVec2, purpose, targets: &mut [PairTargets]| {
            heard.0.borrow_mut().purpose = purpose;
            let at = self.ran.at(self.world.features(), pixel, lane);
            if let Some(Output::Targets(found)) = run(Body::pair_targets, at, heard, Silent, &self.buffers) {
                targets[at.index(Extent::Reservoirs)] = found;
            }
        };
        half(self.pixel, "from this pixel to its partner's sample", &mut targets);
        let partner = self.partner(lane, targets[self.at(lane).index(Extent::Reservoirs)]);
        if let Some(partner) = partner {
            half(partner, "from the partner to this pixel's sample", &mut targets);
        }
        heard.0.borrow_mut().partner(partner);
        targets
    }

    /// The pixel whose reservoir `targets` names.
    fn partner(&self, lane: u32, targets: PairTargets) -> Option<UVec2> {
        let frame = &self.ran.frame;
        let place = targets.index - reservoir_index(frame, UVec2::ZERO, lane);
        let pixel = UVec2::new(place % frame.size.x, place / frame.size.x);
        (pixel != self.pixel).then_some(pixel)
    }
}

/// The first attempt whose result is the GPU's but for rounding, trying the CPU's answers to its rays before others: bit i of an
/// attempt turns the answer of ray i.
fn first_agreeing<'a, T>(
    attempt: impl Fn(u32) -> (T, Listener<'a>),
    agrees: impl Fn(&T) -> bool,
) -> (T, Listener<'a>) {
    let first = attempt(0);
    if agrees(&first.0) {
        return first;
    }
    // A flip may add a ray: one bit more than were asked. With more than 16 rays the search would not end.
    let count = first.1.0.borrow().count.min(16);
    (1..2u32 << count).map(attempt).find(|(result, _)| agrees(result)).unwrap_or(first)
}

/// One pair of ears for the rays of a body and for what it does.
struct Listener<'a>(RefCell<Heard<'a>>);

impl<'a> Listener<'a> {
    fn new(heard: Heard<'a>) -> Self {
        Listener(RefCell::new(heard))
    }
}

impl Visibility for &Listener<'_> {
    const TRACES: bool = true;

    fn sees(&mut self, question: Question, ray: ShadowRay, key: u32) -> bool {
        self.0.borrow_mut().ask(question, ray, key, false)
    }

    fn saw(&mut self, question: Question, ray: ShadowRay, key: u32) -> bool {
        self.0.borrow_mut().ask(question, ray, key, true)
    }

    fn nearest(&mut self, origin: Vec3, direction: Vec3, _: u32) -> HitPayload {
        self.0.borrow_mut().meet(origin, direction)
    }
}

macro_rules! hears {
    ($($method:ident($($name:ident: $type:ty),*))*) => {
        impl Witness for &Listener<'_> {
            $(fn $method(&mut self, $($name: $type),*) {
                self.0.borrow_mut().$method($($name),*);
            })*

            fn lit<L: Reflected>(&mut self, shaded: &Contribution<L>, visible: bool) {
                self.0.borrow_mut().lit(shaded, visible);
            }
        }
    };
}

hears! {
    draws(technique: Technique, candidate: &mut Candidate)
    candidate(
        technique: Technique,
        candidate: &Candidate,
        fresh: &Fresh,
        stays: bool
    )
    tile(tile: u32)
    bsdf_ray(ray: &BsdfRay, hit: HitPayload, light: u32)
    place(place: Option<UVec2>, similar: bool)
    cross(cross: &mut CrossProposal)
    merged(reservoir: StoredReservoir, target: f32, weighed: Weighed)
    merged_canonical(reservoir: StoredReservoir, target: f32, weighed: Weighed)
    pending(pending: f32, asked: bool)
}
