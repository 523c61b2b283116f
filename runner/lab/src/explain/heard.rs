//! The steps of a body, recorded for a report.

use super::rays::Hit;
use super::record::{
    BsdfRay as BsdfRayReport, Candidate as CandidateReport, Merged, Neighbor, PassReport, Ray, Tile,
};
use super::replay::Replay;
use glam::{UVec2, Vec3};
use shared::alpha::SURE_HITS_ONLY;
use shared::cells;
use shared::interface::HitPayload;
use shared::light::LightSample;
use shared::light::tile::{TILE_SIZE, presample};
use shared::math::safe_ratio;
use shared::motion::NO_LIGHT;
use shared::passes::{Body, Question, Technique, variant};
use shared::reflected::Reflected;
use shared::resampling::initial::{BsdfRay, Candidate, Fresh, Techniques};
use shared::resampling::pairwise::Weighed;
use shared::resampling::reprojection::{Before, is_similar_albedo};
use shared::resampling::{
    CrossProposal, confidence, is_similar_distance, is_similar_normal, pairs, reservoir_index, target_of,
};
use shared::reservoir::StoredReservoir;
use shared::shading::Contribution;
use shared::shadow::ShadowRay;
use shared::surface::{GBufferTexel, Surface};

/// Steps of a light's grid that rounding may be off by: lavapipe's sine and cosine differ in the last bits, H100's by 1e-4.
const NEAR: f32 = 16.0;

/// Are both on one light, at most [`NEAR`] steps of its grid apart?
fn are_near(a: LightSample, b: LightSample) -> bool {
    let [a_square, b_square] = [a, b].map(LightSample::square);
    a.light == b.light && (a_square - b_square).abs().max_element() * 65536.0 <= NEAR
}

/// Answers the rays of a body, and hears it.
pub struct Heard<'a> {
    replay: &'a Replay<'a>,
    lane: u32,
    /// What the GPU ended with.
    gpu: StoredReservoir,
    /// The answers of rays whose bit is set are turned.
    flips: u32,
    /// Rays so far, of both kinds.
    pub count: usize,
    /// Of the next ray, where its question does not tell.
    pub purpose: &'static str,
    pub rays: Vec<Ray>,
    pub contributions: Vec<[f32; 3]>,
    report: PassReport,
    /// The BSDF ray before its candidate competes, whether its answer is turned, and what it met.
    met: Option<Hit>,
    turned: Option<BsdfRay>,
}

impl<'a> Heard<'a> {
    pub fn new(replay: &'a Replay<'a>, lane: u32, gpu: StoredReservoir, flips: u32) -> Self {
        Heard {
            replay,
            lane,
            gpu,
            flips,
            count: 0,
            purpose: "",
            rays: Vec::new(),
            contributions: Vec::new(),
            report: PassReport::default(),
            met: None,
            turned: None,
        }
    }

    /// Is the answer of the next ray turned?
    fn next_flips(&mut self) -> bool {
        self.count += 1;
        self.count <= 32 && self.flips >> (self.count - 1) & 1 != 0
    }

    pub fn ask(&mut self, question: Question, ray: ShadowRay, key: u32, before: bool) -> bool {
        let world = self.replay.world;
        let blocker = world.blocker(ray, key, before);
        let flip = self.next_flips();
        let visible = blocker.is_none();
        let purpose = match question {
            Question::Survivor | Question::Shade | Question::Light => "from this pixel to the survivor",
            Question::History => "from the history's pixel to the current sample",
            Question::Neighbor => "from the drawn neighbor to this pixel's sample",
            Question::Partner => self.purpose,
        };
        self.rays.push(Ray {
            purpose,
            origin: ray.origin.to_array(),
            direction: ray.direction.to_array(),
            visible,
            blocker,
            gpu_disagrees: flip,
        });
        visible != flip
    }

    pub fn meet(&mut self, origin: Vec3, direction: Vec3) -> HitPayload {
        self.met = self.replay.world.surely_met(origin, direction);
        match &self.met {
            Some(hit) => {
                HitPayload { hit: 1, instance: hit.geometry, primitive: hit.triangle, ..Default::default() }
            }
            None => HitPayload { key: SURE_HITS_ONLY, ..Default::default() },
        }
    }

    pub fn tile(&mut self, tile: u32) {
        if self.replay.at(self.lane).is(variant::CELLS) {
            self.report.cell = Some(tile);
        } else {
            self.report.tile = Some(Tile { tile, equal_entries: 0 });
        }
    }

    pub fn bsdf_ray(&mut self, ray: &BsdfRay, _: HitPayload, _: u32) {
        self.turned = (self.next_flips() && self.gpu.contribution_weight > 0.0).then_some(*ray);
        self.report.bsdf_rays.push(BsdfRayReport {
            origin: ray.origin.to_array(),
            direction: ray.direction.to_array(),
            hit: self.met.take(),
            light: None,
            uv: 0,
            gpu_disagrees: false,
        });
    }

    /// A turned BSDF ray takes the GPU's sample for what was found, as directions are rounded otherwise there.
    pub fn draws(&mut self, technique: Technique, candidate: &mut Candidate) {
        if technique == Technique::Tile {
            self.compare_entry(candidate.sample);
        }
        let Some(report) = self.report.bsdf_rays.last_mut() else { return };
        if technique != Technique::Bsdf {
            return;
        }
        let found = candidate.sample;
        (report.light, report.uv) = ((found.light != NO_LIGHT).then_some(found.light), found.uv);
        if let Some(ray) = self.turned.take() {
            report.gpu_disagrees = !are_near(found, self.gpu.sample);
            let (at, surface) = (self.replay.at(self.lane), self.surface());
            let lights = at.light_table(self.replay.buffers.lights, self.replay.buffers.alias);
            let techniques = Techniques::new(&at.frame.settings, at.features);
            let source_pdf = self.replay.source_pdf(self.lane, self.gpu.sample.light);
            *candidate = ray.candidate_at(&surface, lights, techniques, self.gpu.sample, source_pdf);
        }
    }

    /// Does the CPU draw the same entry?
    fn compare_entry(&mut self, sample: LightSample) {
        let at = self.replay.at(self.lane);
        let lights = at.light_table(self.replay.buffers.lights, self.replay.buffers.alias);
        let Some(tile) = &mut self.report.tile else { return };
        let (entry, point) = presample(lights, tile.tile, sample.uv % TILE_SIZE, at.frame);
        let same =
            entry.light() == sample.light && point == self.replay.buffers.tile_points[sample.uv as usize];
        tile.equal_entries += u32::from(same);
    }

    pub fn candidate(&mut self, technique: Technique, candidate: &Candidate, fresh: &Fresh, stays: bool) {
        let light = candidate.sample.light;
        let place = candidate.sample.uv;
        let pool = technique == Technique::Pool;
        self.report.candidates.push(CandidateReport {
            by: match technique {
                Technique::Table => "table",
                Technique::Tile => "tile",
                Technique::Pool => {
                    let pool = cells::pool(self.replay.at(self.lane).frame);
                    self.replay.source(self.lane, place % pool)
                }
                Technique::Bsdf => "bsdf",
            },
            light,
            kind: self.replay.world.kind(light),
            source_pdf: candidate.source_pdf.0,
            believed: if pool { self.replay.buffers.pool_entries[place as usize].visibility() } else { 1.0 },
            target: candidate.target,
            weight: candidate.weight(),
            weight_sum: fresh.reservoir.weight_sum,
            chosen: stays,
        });
    }

    pub fn place(&mut self, place: Option<UVec2>, similar: bool) {
        let rejected = match place {
            _ if similar => None,
            None if self.is_temporal() => Some("outside the previous picture, or the first frame"),
            None => Some("outside the picture, or the pixel itself"),
            Some(place) => Some(self.unlike(place)),
        };
        let pixel = place.map(|place| place.to_array());
        self.report.others.push(Neighbor { pixel, rejected, ..Default::default() });
    }

    /// The pixel's partner; none: it is merged with nothing.
    pub fn partner(&mut self, partner: Option<UVec2>) {
        let at = self.replay.at(self.lane);
        match (partner, pairs::partner_of(at.frame, at.pixel, at.repetition())) {
            (Some(_), _) | (None, None) => self.place(partner, partner.is_some()),
            (None, Some(unlike)) => self.place(Some(unlike), false),
        }
    }

    /// Why the surface at `place` is not similar.
    fn unlike(&self, place: UVec2) -> &'static str {
        let (at, buffers) = (self.replay.at(self.lane), &self.replay.buffers);
        let surface = at.surface(&at.texel(buffers.gbuffer));
        let (mut distance, mut normal) = (surface.distance, surface.normal);
        let mut texels = buffers.gbuffer;
        let is_history = self.is_temporal();
        if is_history {
            let mut before = Before::still(at.frame, &surface);
            if at.is(variant::MOVING) {
                let instance = at.texel(buffers.gbuffer).instance() as usize;
                before = before.moved(&surface, &buffers.motions[instance]);
            }
            (distance, normal) = (before.relative.length(), before.normal);
            texels = buffers.previous_gbuffer;
        }
        let texel: GBufferTexel = texels[at.frame.pixel_index(place) as usize];
        let settings = &at.frame.settings;
        if texel.is_empty() {
            "it sees no surface"
        } else if !is_similar_distance(settings, distance, &texel) {
            "its distance differs too much"
        } else if !is_similar_normal(settings, normal, &texel) {
            "its normal differs too much"
        } else if is_history && !is_similar_albedo(&surface, &texel) {
            "its albedo differs too much"
        } else if self.is_pairwise() && self.both_last(place) {
            "both have long histories, and are not merged"
        } else {
            // Of the two distances of a pair the smaller one counts.
            "its distance differs too much"
        }
    }

    fn both_last(&self, place: UVec2) -> bool {
        let (at, reservoirs) = (self.replay.at(self.lane), self.replay.buffers.reservoirs);
        let of = |pixel| reservoirs[reservoir_index(at.frame, pixel, self.lane) as usize];
        confidence::both_last(&at.frame.settings, of(at.pixel), of(place))
    }

    pub fn cross(&mut self, cross: &mut CrossProposal) {
        if let Some(neighbor) = self.report.others.last_mut() {
            neighbor.target_there = Some(cross.targets.neighbor_at_neighbor);
            neighbor.canonical_there = Some(cross.targets.canonical_at_neighbor);
        }
    }

    pub fn merged(&mut self, reservoir: StoredReservoir, target: f32, weighed: Weighed) {
        let merged = self.line(reservoir, target, weighed);
        if let Some(neighbor) = self.report.others.last_mut() {
            neighbor.merged = Some(merged);
        }
    }

    pub fn merged_canonical(&mut self, reservoir: StoredReservoir, target: f32, weighed: Weighed) {
        self.report.canonical = Some(self.line(reservoir, target, weighed));
    }

    fn line(&self, reservoir: StoredReservoir, target: f32, weighed: Weighed) -> Merged {
        let Weighed { mis_weight, weight, survives } = weighed;
        let reservoir = self.replay.world.survivor(reservoir);
        Merged { reservoir, target, mis_weight, weight, chosen: survives }
    }

    pub fn pending(&mut self, pending: f32, asked: bool) {
        if let Some(neighbor) = self.report.others.last_mut() {
            (neighbor.pending, neighbor.asked) = (Some(pending), asked);
        }
    }

    pub fn lit<L: Reflected>(&mut self, shaded: &Contribution<L>, visible: bool) {
        let albedo = self.surface().reflectance.diffuse;
        let radiance = if visible { shaded.radiance.whole(albedo) } else { Vec3::ZERO };
        self.contributions.push(radiance.to_array());
    }

    /// The report of a pass over a reservoir that ended with `cpu`.
    pub fn report(mut self, cpu: StoredReservoir) -> PassReport {
        let is_fresh = matches!(self.replay.ran.pass.body(), Body::initial | Body::initial_met);
        let is_merge = self.report.candidates.is_empty() && !is_fresh;
        if is_merge && self.report.canonical.is_none() {
            // Merged with nothing.
            let at = self.replay.at(self.lane);
            let surface = at.surface(&at.texel(self.replay.buffers.gbuffer));
            let lights = at.light_table(self.replay.buffers.lights, self.replay.buffers.alias);
            let target = target_of(&surface, lights, cpu);
            let weight = target * cpu.contribution_weight;
            let alone = Weighed { mis_weight: 1.0, weight, survives: true };
            self.report.canonical = Some(self.line(cpu, target, alone));
        } else if is_merge && !self.replay.at(self.lane).is(variant::UNBIASED) && !self.is_pairwise() {
            let others = self.report.others.iter_mut().filter_map(|other| other.merged.as_mut());
            for one in self.report.canonical.iter_mut().chain(others) {
                one.mis_weight = safe_ratio(one.reservoir.confidence, cpu.confidence);
            }
        }
        PassReport { rays: self.rays, ..self.report }
    }

    fn surface(&self) -> Surface {
        let at = self.replay.at(self.lane);
        at.surface(&at.texel(self.replay.buffers.gbuffer))
    }

    fn is_pairwise(&self) -> bool {
        self.replay.ran.pass.body() == Body::pair_merge
    }

    fn is_temporal(&self) -> bool {
        matches!(self.replay.ran.pass.body(), Body::temporal | Body::temporal_hops)
    }
}
