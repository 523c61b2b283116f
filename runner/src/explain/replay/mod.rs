//! The passes of one pixel on the CPU, each from the GPU's own input, by the steps of the functions that the shaders run.

mod initial;
mod pairs;

use super::World;
use super::compare::{Difference, ROUNDING_ULPS, ulps};
use super::record::{Glance, Merged, Neighbor, PassReport, Ray, Shading, Survivor};
use glam::{Affine3A, UVec2, Vec3};
use shared::alpha::{self, SURE_HITS_ONLY};
use shared::frame::{FrameConstants, mode};
use shared::light::LightTable;
use shared::math::safe_ratio;
use shared::resampling::initial::{Proposal, accept};
use shared::resampling::pairwise::{Pairwise, Weighed};
use shared::resampling::{
    CrossProposal, Pixels, is_similar_distance, is_similar_normal, reservoir_index, spatial, target_of,
};
use shared::reservoir::{Reservoir, StoredReservoir};
use shared::rng::{Rng, Stream};
use shared::shading;
use shared::shadow::ShadowRay;
use shared::surface::{GBufferTexel, Surface};

/// The pixel to replay, and what all of its passes share.
pub struct Replay<'a> {
    pub world: &'a World<'a>,
    pub frame: FrameConstants,
    pub pixel: UVec2,
    pub surface: Surface,
    /// Of the whole frame.
    pub gbuffer: &'a [GBufferTexel],
}

/// A pass as the estimator's own function has it, and what the lines of the report come to.
pub(super) struct Replayed {
    report: PassReport,
    result: StoredReservoir,
    lines: StoredReservoir,
}

impl Replayed {
    /// `lines` before the survivor's ray said whether it is `visible`.
    pub(super) fn new(
        report: PassReport,
        result: StoredReservoir,
        lines: StoredReservoir,
        visible: bool,
    ) -> Self {
        Replayed { report, result, lines: if visible { lines } else { lines.occluded() } }
    }

    /// A merge by 1/M.
    pub(super) fn uniform(mut report: PassReport, result: StoredReservoir, merged: Reservoir) -> Self {
        let others = report.others.iter_mut().filter_map(|other| other.merged.as_mut());
        for one in report.canonical.iter_mut().chain(others) {
            one.mis_weight = safe_ratio(one.reservoir.confidence, merged.confidence);
        }
        Replayed { report, result, lines: merged.finish(merged.confidence) }
    }
}

/// Answers the rays of a pass, on the CPU; `flips` turns the answers of those whose bit is set.
pub(super) struct Rays<'a> {
    world: &'a World<'a>,
    flips: u32,
    /// Rays so far, of both kinds.
    count: usize,
    asked: Vec<Ray>,
    glances: Vec<Glance>,
}

impl Rays<'_> {
    /// Is the answer of the next ray turned?
    fn next_flips(&mut self) -> bool {
        self.count += 1;
        self.flips >> (self.count - 1) & 1 != 0
    }

    pub(super) fn ask(&mut self, purpose: &'static str, ray: ShadowRay, key: u32) -> bool {
        self.ask_among(&self.world.occluders.arrays.transforms, purpose, ray, key)
    }

    /// Where `places` has the scene's instances.
    pub(super) fn ask_among(
        &mut self,
        places: &[Affine3A],
        purpose: &'static str,
        ray: ShadowRay,
        key: u32,
    ) -> bool {
        let blocker = self.world.occluders.blocker(places, ray, key);
        let flip = self.next_flips();
        let visible = blocker.is_none();
        self.asked.push(Ray {
            purpose,
            origin: ray.origin.to_array(),
            direction: ray.direction.to_array(),
            visible,
            blocker,
            gpu_disagrees: flip,
        });
        visible != flip
    }
}

/// The first replay whose result is the GPU's but for rounding, trying the CPU's answers to its rays before others.
fn explain<T>(
    world: &World<'_>,
    replay: impl Fn(&mut Rays<'_>) -> T,
    agrees: impl Fn(&T) -> bool,
) -> (T, Vec<Ray>) {
    let attempt = |flips| {
        let mut rays = Rays { world, flips, count: 0, asked: Vec::new(), glances: Vec::new() };
        (replay(&mut rays), rays.asked, rays.count)
    };
    let (first, rays, count) = attempt(0);
    if agrees(&first) {
        return (first, rays);
    }
    // A flip may add a ray: one bit more than were asked.
    let agreeing = (1..2u32 << count).map(attempt).find(|(report, ..)| agrees(report));
    agreeing.map_or((first, rays), |(report, rays, _)| (report, rays))
}

impl Replay<'_> {
    pub(super) fn lights(&self) -> LightTable<'_> {
        self.world.light_table()
    }

    pub(super) fn rng(&self, stream: Stream, lane: u32) -> Rng {
        Rng::new(self.pixel, self.frame.index, self.frame.seed, stream, lane)
    }

    pub(super) fn at(&self, reservoirs: &[StoredReservoir], lane: u32) -> StoredReservoir {
        reservoirs[reservoir_index(&self.frame, self.pixel, lane) as usize]
    }

    fn survivor(&self, reservoir: StoredReservoir) -> Survivor {
        let light = (reservoir.contribution_weight > 0.0).then_some(reservoir.sample.light);
        Survivor {
            light,
            kind: light.map_or("", |light| self.world.kind(light)),
            uv: reservoir.sample.uv,
            contribution_weight: reservoir.contribution_weight,
            confidence: reservoir.confidence,
        }
    }

    /// Completes the report of a pass.
    pub(super) fn report(
        &self,
        gpu: StoredReservoir,
        replay: impl Fn(&mut Rays<'_>) -> Replayed,
    ) -> PassReport {
        let agrees = |replayed: &Replayed| Difference::new(replayed.result, gpu).is_rounding();
        let (replayed, rays) = explain(self.world, replay, agrees);
        PassReport {
            rays,
            cpu: self.survivor(replayed.result),
            gpu: self.survivor(gpu),
            difference: Difference::new(replayed.result, gpu),
            consistent: replayed.result == replayed.lines,
            ..replayed.report
        }
    }

    /// Does the ray of visibility reuse reach the finished survivor? True where the pass does not ask.
    pub(super) fn is_seen(&self, proposal: &Proposal, asks: bool, rays: &mut Rays<'_>) -> bool {
        !asks
            || proposal.is_certain()
            || rays.ask("from this pixel to the survivor", proposal.ray, SURE_HITS_ONLY)
    }

    /// Why `texel` does not hold a surface like the pixel's own, at `distance` from its camera and with `normal`.
    pub(super) fn unlike(&self, distance: f32, normal: Vec3, texel: &GBufferTexel) -> Option<&'static str> {
        if texel.is_empty() {
            Some("it sees no surface")
        } else if !is_similar_distance(&self.frame.settings, distance, texel) {
            Some("its distance differs too much")
        } else if !is_similar_normal(&self.frame.settings, normal, texel) {
            Some("its normal differs too much")
        } else {
            None
        }
    }

    /// `pixels`: the reservoirs before the pass.
    pub fn spatial(
        &self,
        pass: &'static str,
        iteration: u32,
        lane: u32,
        reservoirs: &[StoredReservoir],
        gpu: &[StoredReservoir],
    ) -> PassReport {
        let pixels = Pixels { gbuffer: self.gbuffer, reservoirs };
        self.report(self.at(gpu, lane), |rays| {
            let report = PassReport { pass, iteration, reservoir: lane, ..Default::default() };
            match self.frame.settings.mode {
                mode::BIASED => self.spatial_biased(report, pixels),
                _ => self.spatial_unbiased(report, pixels, rays),
            }
        })
    }

    fn spatial_rng(&self, report: &PassReport) -> Rng {
        self.rng(Stream::Spatial, report.reservoir + self.frame.settings.reservoirs * report.iteration)
    }

    /// The next neighbor, whether it is merged, and its two numbers.
    fn next_neighbor(&self, rng: &mut Rng) -> (Neighbor, Option<UVec2>, [f32; 2]) {
        let (place, numbers) = spatial::draw_neighbor(&self.frame, self.pixel, rng);
        let Some(place) = place else {
            let rejected = Some("outside the picture, or the pixel itself");
            return (Neighbor { rejected, ..Default::default() }, None, numbers);
        };
        let texel = self.gbuffer[self.frame.pixel_index(place) as usize];
        let rejected = self.unlike(self.surface.distance, self.surface.normal, &texel);
        let neighbor = Neighbor { pixel: Some(place.to_array()), rejected, ..Default::default() };
        (neighbor, rejected.is_none().then_some(place), numbers)
    }

    fn spatial_biased(&self, mut report: PassReport, pixels: Pixels<'_>) -> Replayed {
        let (lane, mut rng) = (report.reservoir, self.spatial_rng(&report));
        let (frame, lights, surface) = (&self.frame, self.lights(), &self.surface);
        let result = spatial::biased(frame, lights, surface, pixels, self.pixel, lane, &mut rng.clone());
        let mut merged = Reservoir::default();
        let canonical = self.at(pixels.reservoirs, lane);
        report.canonical = Some(self.merge(&mut merged, canonical, rng.next_f32()));
        for _ in 0..frame.settings.neighbors {
            let (mut neighbor, place, [u, _]) = self.next_neighbor(&mut rng);
            neighbor.merged = place.map(|place| {
                let reservoir = pixels.reservoirs[reservoir_index(frame, place, lane) as usize];
                self.merge(&mut merged, reservoir, u)
            });
            report.others.push(neighbor);
        }
        Replayed::uniform(report, result, merged)
    }

    fn spatial_unbiased(&self, mut report: PassReport, pixels: Pixels<'_>, rays: &mut Rays<'_>) -> Replayed {
        let (lane, mut rng) = (report.reservoir, self.spatial_rng(&report));
        let (frame, lights, surface) = (&self.frame, self.lights(), &self.surface);
        let asks = frame.settings.visibility_is_known();
        let mut whole = rng;
        let proposal = spatial::propose(frame, lights, surface, pixels, self.pixel, lane, &mut whole);
        let seen = !asks
            || proposal.is_certain()
            || rays.ask("from the drawn neighbor to this pixel's sample", proposal.ray, SURE_HITS_ONLY);
        let finished = spatial::accept(surface, lights, proposal, seen, &mut whole);
        let visible = self.is_seen(&finished, asks, rays);

        let canonical = self.at(pixels.reservoirs, lane);
        let others = spatial::confidence_of_neighbors(frame, surface, pixels, self.pixel, lane, rng);
        let mut lines = spatial::Proposal::new(&frame.settings, surface, lights, canonical, others);
        for _ in 0..frame.settings.neighbors {
            let (mut neighbor, place, [u, lot]) = self.next_neighbor(&mut rng);
            if let Some(place) = place {
                let cross = spatial::cross(frame, lights, surface, canonical, pixels, place, lane);
                let added = lines.add(cross, u, lot);
                self.cross(&mut neighbor, &cross, added.weighed);
                (neighbor.doubt, neighbor.asked) = (Some(added.doubt), added.asked);
            }
            report.others.push(neighbor);
        }
        let lines =
            self.end_with_canonical(&mut report, &mut lines.resolved(seen), canonical, rng.next_f32());
        Replayed::new(report, accept(finished, visible), lines, visible)
    }

    /// A reservoir that is merged with nothing.
    pub(super) fn alone(&self, reservoir: StoredReservoir) -> Merged {
        let target = target_of(&self.surface, self.lights(), reservoir);
        let weight = target * reservoir.contribution_weight;
        Merged { reservoir: self.survivor(reservoir), target, mis_weight: 1.0, weight, chosen: true }
    }

    /// Merges by 1/M; the MIS weight is known at the end.
    pub(super) fn merge(&self, merged: &mut Reservoir, reservoir: StoredReservoir, u: f32) -> Merged {
        let target = target_of(&self.surface, self.lights(), reservoir);
        Merged {
            reservoir: self.survivor(reservoir),
            target,
            mis_weight: 0.0,
            weight: reservoir.merged_weight(target),
            chosen: merged.merge(reservoir, target, u),
        }
    }

    pub(super) fn cross(&self, neighbor: &mut Neighbor, cross: &CrossProposal, weighed: Weighed) {
        neighbor.target_there = Some(cross.targets.neighbor_at_neighbor);
        neighbor.canonical_there = Some(cross.targets.canonical_at_neighbor);
        let target = cross.targets.neighbor_at_canonical;
        neighbor.merged = Some(self.weighed(cross.neighbor, target, weighed));
    }

    fn weighed(&self, reservoir: StoredReservoir, target: f32, weighed: Weighed) -> Merged {
        let Weighed { mis_weight, weight, survives } = weighed;
        Merged { reservoir: self.survivor(reservoir), target, mis_weight, weight, chosen: survives }
    }

    pub(super) fn end_with_canonical(
        &self,
        report: &mut PassReport,
        merge: &mut Pairwise,
        canonical: StoredReservoir,
        u: f32,
    ) -> StoredReservoir {
        let weighed = merge.add_canonical(u);
        let target = target_of(&self.surface, self.lights(), canonical);
        report.canonical = Some(self.weighed(canonical, target, weighed));
        merge.merged().finish(1.0)
    }

    /// `emission`: radiance before the pass. `gpu`: after it.
    pub fn shade(&self, reservoirs: &[StoredReservoir], emission: Vec3, gpu: Vec3) -> Shading {
        let difference = |cpu: Vec3| [0, 1, 2].map(|i| ulps(cpu[i], gpu[i]));
        let replay = |rays: &mut Rays<'_>| self.average(reservoirs, rays);
        let agrees =
            |(_, lit): &(Vec<Vec3>, Vec3)| difference(emission + *lit).iter().all(|&u| u <= ROUNDING_ULPS);
        let ((contributions, lit), rays) = explain(self.world, replay, agrees);
        let cpu = emission + lit;
        Shading {
            contributions: contributions.iter().map(Vec3::to_array).collect(),
            rays,
            cpu: cpu.to_array(),
            ulps: difference(cpu),
        }
    }

    /// What each reservoir contributes, and their mean.
    fn average(&self, reservoirs: &[StoredReservoir], rays: &mut Rays<'_>) -> (Vec<Vec3>, Vec3) {
        let known = !self.frame.settings.shading_needs_rays(self.world.features());
        let mut rng = self.rng(Stream::Shade, 0);
        let (mut average, mut contributions) = (shading::Average::default(), Vec::new());
        for lane in 0..self.frame.settings.reservoirs {
            let proposal = shading::propose(&self.surface, self.lights(), self.at(reservoirs, lane));
            let key = alpha::key(rng.next_u32x4().x);
            let visible = !proposal.is_dark()
                && (known || rays.ask("from this pixel to the survivor", proposal.ray, key));
            average.add(proposal, visible);
            contributions.push(if visible { proposal.radiance } else { Vec3::ZERO });
        }
        (contributions, average.radiance())
    }
}
