//! The frame as the shaders run it: pure functions around rays; and the errors that can be planted between them.

use crate::world::{View, World};

use shared::bsdf;
use shared::frame::{FrameConstants, Settings, features, mode};
use shared::glam::{UVec2, Vec3};
use shared::light::tile::{TILE_SIZE, TILES, TileEntry, Tiles, presample, tile_of};
use shared::light::{LightTable, build_alias_table, kind};
use shared::pdf::SourcePdf;
use shared::resampling::initial::{Candidate, Glance, Techniques};
use shared::resampling::pairs::{self, PairTargets};
use shared::resampling::{Pixels, initial, reservoir_index, spatial, temporal};
use shared::reservoir::{Reservoir, StoredReservoir};
use shared::rng::{Rng, Stream};
use shared::shading;
use shared::surface::Surface;
use shared::target::target_function;
use std::f32::consts::PI;

/// One step done wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plant {
    /// The table believes that it draws every light equally often.
    SourcePmf,
    /// Points on area lights, directions in texels: their density is taken for 1.
    OnLightPdf,
    /// Tile entries forget which light they drew.
    TilePmf,
    /// 1/M of fresh candidates.
    FreshNormalization,
    /// 1/M of merged reservoirs.
    MergedNormalization,
    /// A history's weight is that of its full confidence, its count the capped one.
    CapAfterWeight,
    /// Merged with a MIS weight of 1 each.
    MisWeight,
    /// The MIS weight takes the canonical pixel's target function for the history's own.
    ForeignTarget,
    /// A reservoir found empty counts for nothing: a decision from the sample's content.
    EmptyForgotten,
    /// The cosine at the receiver, at the light, and 1/d².
    Cosine,
    EmitterCosine,
    Distance,
    /// The final shadow ray.
    ShadowRay,
    /// Visibility reuse left out where later passes count on it.
    VisibilityReuse,
    /// The ray from the history's pixel, from the doubted neighbor, and to the survivor.
    HistoryRay,
    DoubtRay,
    SurvivorRay,
    /// Neighbors that see the sample are taken for blind, and the other way round.
    DoubtInverted,
    /// The ray to the partner's sample, where that is merged, and where the partner weighs its own by the answer.
    RayToPartner,
    RayFromPartner,
    /// The partner's view of this pixel's sample is taken to be this pixel's own.
    PartnerTarget,
    /// Reservoirs are summed, not averaged.
    Average,
    /// Light and BSDF candidates are weighed by their own densities alone: what both find counts twice.
    Balance,
    /// The solid angle of a unit of the light, in the density of a BSDF candidate.
    FoundSolidAngle,
    /// The lobes' mixture in that density: the one has the other's probability.
    FoundMixture,
    /// BSDF rays that go through everything.
    FoundRay,
}

/// A run of frames with what it carries from one to the next.
pub struct Sequence<'a> {
    world: &'a World,
    views: &'a [View; 2],
    lights: World,
    settings: Settings,
    seed: u32,
    plant: Option<Plant>,
    index: u32,
    history: Vec<StoredReservoir>,
}

impl<'a> Sequence<'a> {
    pub fn new(
        world: &'a World,
        views: &'a [View; 2],
        settings: Settings,
        seed: u32,
        plant: Option<Plant>,
    ) -> Self {
        let lights = planted_lights(world, plant);
        let count = world.size.x * world.size.y * settings.reservoirs;
        let history = vec![StoredReservoir::default(); count as usize];
        Sequence { world, views, lights, settings, seed, plant, index: 0, history }
    }

    /// From now on the scene's lights are those of `world`.
    pub fn set_lights(&mut self, world: &World) {
        self.lights = world.clone();
    }

    pub fn reservoirs(&self) -> &[StoredReservoir] {
        &self.history
    }

    fn is(&self, plant: Plant) -> bool {
        self.plant == Some(plant)
    }

    /// Runs one frame and gives the radiance of its pixels.
    pub fn next_frame(&mut self) -> Vec<Vec3> {
        let [view, before] = [self.index & 1, (self.index + 1) & 1].map(|i| &self.views[i as usize]);
        let size = self.world.size;
        let frame = FrameConstants {
            camera: view.camera,
            previous_camera: before.camera,
            size,
            index: self.index,
            seed: self.seed,
            settings: self.settings,
            exposure: 1.0,
            background: Vec3::ZERO,
            environment_size: UVec2::ZERO,
            first_environment_light: 0,
        };
        let lights = self.lights.table();
        let pass = Pass { sequence: self, frame: &frame, lights, view, before };
        let mut reservoirs = pass.initial();
        if self.settings.temporal != 0 {
            reservoirs = pass.temporal(reservoirs);
        }
        for iteration in 0..self.settings.spatial_iterations * self.settings.spatial {
            let merge = if self.settings.in_pairs() { Pass::spatial_in_pairs } else { Pass::spatial };
            reservoirs = merge(&pass, reservoirs, iteration);
        }
        let radiance = pass.shade(&reservoirs);
        self.history = reservoirs;
        self.index += 1;
        radiance
    }
}

fn planted_lights(world: &World, plant: Option<Plant>) -> World {
    let mut planted = world.clone();
    match plant {
        Some(Plant::SourcePmf) => {
            let uniform = 1.0 / world.lights.len() as f32;
            for entry in &mut planted.alias {
                entry.alias_pmf = uniform;
                entry.pmf = if entry.pmf > 0.0 { uniform } else { 0.0 };
            }
        }
        Some(Plant::OnLightPdf) => planted.lights.iter_mut().for_each(|light| light.area = 1.0),
        _ => assert_eq!(planted.alias, build_alias_table(&planted.lights)),
    }
    planted
}

/// What all passes of a frame read.
#[derive(Clone, Copy)]
struct Pass<'a> {
    sequence: &'a Sequence<'a>,
    frame: &'a FrameConstants,
    lights: LightTable<'a>,
    view: &'a View,
    before: &'a View,
}

impl Pass<'_> {
    fn is(&self, plant: Plant) -> bool {
        self.sequence.is(plant)
    }

    fn surface(&self, pixel: UVec2) -> &Surface {
        &self.view.surfaces[self.frame.pixel_index(pixel) as usize]
    }

    /// One result for every reservoir of every pixel, in the order of a reservoir buffer.
    fn each(&self, of: impl Fn(UVec2, u32, usize) -> StoredReservoir) -> Vec<StoredReservoir> {
        let lanes = 0..self.frame.settings.reservoirs;
        let places = lanes.flat_map(|lane| self.sequence.world.pixels().map(move |pixel| (pixel, lane)));
        places
            .map(|(pixel, lane)| of(pixel, lane, reservoir_index(self.frame, pixel, lane) as usize))
            .collect()
    }

    fn rng(&self, pixel: UVec2, stream: Stream, lane: u32) -> Rng {
        Rng::new(pixel, self.frame.index, self.frame.seed, stream, lane)
    }

    /// The reservoir, or an empty one where a ray finds its sample hidden.
    fn seen(&self, proposal: initial::Proposal, ray_left_out: bool) -> StoredReservoir {
        let known = ray_left_out || proposal.is_certain();
        initial::accept(proposal, known || self.sequence.world.trace(proposal.ray))
    }

    fn initial(&self) -> Vec<StoredReservoir> {
        let settings = self.frame.settings;
        let tiles = (settings.tiles != 0).then(|| self.tiles());
        self.each(|pixel, lane, _| {
            let (surface, lights) = (self.surface(pixel), self.lights);
            let mut rng = self.rng(pixel, Stream::Initial, lane);
            let techniques = Techniques::new(&settings, features::TRACEABLE);
            let weighed = if self.is(Plant::Balance) { 0 } else { techniques.bsdf };
            let weighed = Techniques { bsdf: weighed, ..techniques };
            let mut fresh = match &tiles {
                Some((entries, points)) => {
                    let (tiles, tile) = (Tiles { entries, points }, tile_of(self.frame, pixel, lane));
                    initial::from_tile(surface, lights, weighed, tiles, tile, &mut rng)
                }
                None => initial::from_table(surface, lights, weighed, &mut rng),
            };
            for _ in 0..techniques.bsdf {
                let glance = Glance::new(surface, &mut rng);
                if glance.is_worth_tracing(surface) {
                    fresh.add_found(self.found(surface, techniques, glance));
                }
            }
            let mut proposal = fresh.finish(surface, lights);
            if self.is(Plant::FreshNormalization) {
                proposal.reservoir.contribution_weight *= proposal.reservoir.confidence;
            }
            let blind = settings.visibility_reuse == 0 || self.is(Plant::VisibilityReuse);
            let mut fresh = self.seen(proposal, blind);
            if self.is(Plant::EmptyForgotten) && fresh.contribution_weight == 0.0 {
                fresh.confidence = 0.0;
            }
            fresh
        })
    }

    fn found(&self, surface: &Surface, techniques: Techniques, glance: Glance) -> Candidate {
        let through = self.is(Plant::FoundRay);
        let light = self.sequence.world.find(glance.origin, glance.direction, through);
        let right = glance.candidate(surface, self.lights, techniques, light);
        let incident = self.lights.incident(right.sample, surface.position);
        let table = self.lights.pdf(light).0;
        let found = right.source_pdf.0 - table;
        let probability = bsdf::specular_probability(&surface.reflectance, surface.normal.dot(surface.wo));
        let diffuse = surface.normal.dot(incident.direction) / PI;
        let density = bsdf::pdf(&surface.reflectance, surface.normal, surface.wo, incident.direction).0;
        let specular = (density - (1.0 - probability) * diffuse) / probability;
        let source_pdf = match self.sequence.plant {
            Some(Plant::Balance) => found,
            Some(Plant::FoundSolidAngle) => table + found / incident.solid_angle.max(1e-6),
            Some(Plant::FoundMixture) => {
                let exchanged = (1.0 - probability) * specular + probability * diffuse;
                table + found * exchanged / density
            }
            _ => return right,
        };
        Candidate { source_pdf: SourcePdf(source_pdf), ..right }
    }

    /// The tiles that this frame's pixels read.
    fn tiles(&self) -> (Vec<TileEntry>, Vec<u32>) {
        let count = (TILES * TILE_SIZE) as usize;
        let mut entries: Vec<TileEntry> = vec![Default::default(); count];
        let mut points: Vec<u32> = vec![Default::default(); count];
        let lanes = 0..self.frame.settings.reservoirs;
        let used = lanes
            .flat_map(|lane| self.sequence.world.pixels().map(move |pixel| tile_of(self.frame, pixel, lane)));
        for tile in used.collect::<std::collections::BTreeSet<_>>() {
            for entry in 0..TILE_SIZE {
                let place = (tile * TILE_SIZE + entry) as usize;
                (entries[place], points[place]) = presample(self.lights, tile, entry, self.frame);
                if self.is(Plant::TilePmf) {
                    // The sixth word of an entry is its density.
                    let words: &mut [f32; 8] = bytemuck::cast_mut(&mut entries[place]);
                    words[6] = 1.0 / self.lights.lights.count() as f32;
                }
            }
        }
        (entries, points)
    }

    fn temporal(&self, fresh: Vec<StoredReservoir>) -> Vec<StoredReservoir> {
        let previous = Pixels { gbuffer: &self.before.gbuffer, reservoirs: &self.sequence.history };
        self.each(|pixel, lane, i| {
            if self.frame.settings.mode == mode::BIASED {
                self.reuse_history_biased(pixel, lane, fresh[i], previous)
            } else {
                self.reuse_history(pixel, lane, fresh[i], previous)
            }
        })
    }

    fn reuse_history_biased(
        &self,
        pixel: UVec2,
        lane: u32,
        fresh: StoredReservoir,
        previous: Pixels<'_>,
    ) -> StoredReservoir {
        let (frame, lights, surface) = (self.frame, self.lights, self.surface(pixel));
        let mut rng = self.rng(pixel, Stream::Temporal, lane);
        if self.is(Plant::CapAfterWeight)
            && let Some(place) = temporal::reproject(frame, surface, previous)
        {
            let history = previous.reservoirs[reservoir_index(frame, place, lane) as usize];
            let capped = history.capped(frame.settings.confidence_cap * fresh.confidence);
            let mut merged = Reservoir::default();
            merged.merge(fresh, self.target(surface, fresh), rng.next_f32());
            merged.merge(history, self.target(surface, history), rng.next_f32());
            return merged.finish(fresh.confidence + capped.confidence);
        }
        let merged = temporal::biased(frame, lights, surface, fresh, previous, lane, &mut rng);
        self.unnormalized(merged)
    }

    fn reuse_history(
        &self,
        pixel: UVec2,
        lane: u32,
        fresh: StoredReservoir,
        previous: Pixels<'_>,
    ) -> StoredReservoir {
        let (frame, lights, surface) = (self.frame, self.lights, self.surface(pixel));
        let mut rng = self.rng(pixel, Stream::Temporal, lane);
        let Some(mut proposal) = temporal::propose(frame, lights, surface, fresh, previous, lane) else {
            return fresh;
        };
        let blind = !frame.settings.visibility_is_known();
        if self.is(Plant::MisWeight) {
            let mut merged = Reservoir::default();
            for other in [fresh, proposal.neighbor] {
                let target = self.target(surface, other);
                let weight = target * other.contribution_weight;
                merged.add(other.sample, target, weight, other.confidence, rng.next_f32());
            }
            let merged = initial::Proposal::new(surface, lights, merged.finish(1.0));
            return self.seen(merged, blind);
        }
        if self.is(Plant::ForeignTarget) {
            proposal.targets.neighbor_at_neighbor = proposal.targets.neighbor_at_canonical;
        }
        let visible = blind
            || proposal.is_certain()
            || self.is(Plant::HistoryRay)
            || self.sequence.world.trace(proposal.ray);
        let merged = temporal::accept(lights, surface, fresh, proposal, visible, &mut rng);
        self.seen(merged, blind || self.is(Plant::SurvivorRay))
    }

    fn target(&self, surface: &Surface, reservoir: StoredReservoir) -> f32 {
        target_function(surface, &self.lights.incident(reservoir.sample, surface.position))
    }

    fn unnormalized(&self, merged: StoredReservoir) -> StoredReservoir {
        let planted = self.is(Plant::MergedNormalization);
        let factor = if planted { merged.confidence / self.frame.settings.candidates as f32 } else { 1.0 };
        StoredReservoir { contribution_weight: merged.contribution_weight * factor, ..merged }
    }

    fn spatial(&self, input: Vec<StoredReservoir>, iteration: u32) -> Vec<StoredReservoir> {
        let (frame, lights) = (self.frame, self.lights);
        let pixels = Pixels { gbuffer: &self.view.gbuffer, reservoirs: &input };
        self.each(|pixel, lane, _| {
            let surface = self.surface(pixel);
            let mut rng = self.rng(pixel, Stream::Spatial, lane + frame.settings.reservoirs * iteration);
            if frame.settings.mode == mode::BIASED {
                let merged = spatial::biased(frame, lights, surface, pixels, pixel, lane, &mut rng);
                return self.unnormalized(merged);
            }
            let blind = !frame.settings.visibility_is_known();
            let proposal = spatial::propose(frame, lights, surface, pixels, pixel, lane, &mut rng);
            let answer = blind
                || proposal.is_certain()
                || self.is(Plant::DoubtRay)
                || self.sequence.world.trace(proposal.ray);
            let visible = answer != self.is(Plant::DoubtInverted);
            let merged = spatial::accept(surface, lights, proposal, visible, &mut rng);
            self.seen(merged, blind || self.is(Plant::SurvivorRay))
        })
    }

    fn spatial_in_pairs(&self, input: Vec<StoredReservoir>, iteration: u32) -> Vec<StoredReservoir> {
        let settings = &self.frame.settings;
        let pixels = Pixels { gbuffer: &self.view.gbuffer, reservoirs: &input };
        let places = || {
            let lanes = 0..settings.reservoirs;
            lanes.flat_map(|lane| self.sequence.world.pixels().map(move |pixel| (pixel, lane)))
        };
        let all = |blind| -> Vec<PairTargets> {
            let of = |(pixel, lane)| {
                self.pair_targets(pixels, pixel, lane, lane + settings.reservoirs * iteration, blind)
            };
            places().map(of).collect()
        };
        let blind = !settings.visibility_is_known();
        let here = all(blind || self.is(Plant::RayToPartner));
        let there = all(blind || self.is(Plant::RayFromPartner));
        self.each(|pixel, lane, i| {
            let mut rng = self.rng(pixel, Stream::Spatial, lane + settings.reservoirs * iteration);
            let partner = here[i].index as usize;
            if partner == i {
                return input[i];
            }
            let (here, mut there) = (here[i], there[partner]);
            if self.is(Plant::PartnerTarget) {
                there.partner = here.own;
            }
            pairs::merge(settings, [input[i], input[partner]], [here, there], &mut rng)
        })
    }

    fn pair_targets(
        &self,
        pixels: Pixels<'_>,
        pixel: UVec2,
        lane: u32,
        repetition: u32,
        blind: bool,
    ) -> PairTargets {
        let (frame, surface) = (self.frame, self.surface(pixel));
        let proposal = pairs::propose(frame, self.lights, surface, pixels, pixel, lane, repetition);
        let visible = blind || proposal.is_certain() || self.sequence.world.trace(proposal.ray);
        pairs::accept(proposal, visible)
    }

    fn shade(&self, reservoirs: &[StoredReservoir]) -> Vec<Vec3> {
        let known = self.frame.settings.visibility_is_known();
        let world = self.sequence.world;
        let shaded = |pixel: UVec2| {
            let surface = self.surface(pixel);
            let mut average = shading::Average::default();
            for lane in 0..self.frame.settings.reservoirs {
                let stored = reservoirs[reservoir_index(self.frame, pixel, lane) as usize];
                let mut proposal = shading::propose(surface, self.lights, stored);
                proposal.radiance *= self.planted_factor(surface, stored);
                let visible = known || self.is(Plant::ShadowRay) || world.trace(proposal.ray);
                average.add(proposal, visible);
            }
            let count = if self.is(Plant::Average) { self.frame.settings.reservoirs as f32 } else { 1.0 };
            average.radiance() * count
        };
        world.pixels().map(shaded).collect()
    }

    /// Takes a term back out of the integrand.
    fn planted_factor(&self, surface: &Surface, stored: StoredReservoir) -> f32 {
        if stored.contribution_weight == 0.0 {
            return 1.0;
        }
        let incident = self.lights.incident(stored.sample, surface.position);
        let light = &self.lights.lights.lights[stored.sample.light as usize];
        let finite = light.kind == kind::POINT || light.kind == kind::TRIANGLE;
        match self.sequence.plant {
            Some(Plant::Cosine) => 1.0 / surface.normal.dot(incident.direction).max(1e-3),
            Some(Plant::EmitterCosine) if light.kind == kind::TRIANGLE => {
                1.0 / -incident.normal.dot(incident.direction).min(-1e-3)
            }
            Some(Plant::Distance) if finite => incident.distance * incident.distance,
            _ => 1.0,
        }
    }
}
