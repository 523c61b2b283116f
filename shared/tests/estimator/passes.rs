//! Frames on the CPU: the bodies of the GPU's passes in their order; and errors ([`Plant`]) in what they ask, in what they tell, and in
//! what one leaves to the next.

use crate::knowledge::Knowledge;
use crate::plant::Plant;
use crate::world::{SKY, View, World};

use shared::bsdf;
use shared::environment::EnvironmentTexel;
use shared::frame::{FrameConstants, Settings, features, mode};
use shared::geometry::InstanceGeometry;
use shared::glam::{Affine3A, UVec2, Vec3};
use shared::interface::{HitPayload, PassConstants};
use shared::light::tile::{TILE_SIZE, TILES, TileEntry, tile_of};
use shared::light::{LightTable, build_alias_table, kind};
use shared::motion::NO_LIGHT;
use shared::passes::pair_targets::PairTargets;
use shared::passes::{self, Assumed, At, Question, Technique, Visibility, Witness, variant};
use shared::pdf::SourcePdf;
use shared::points::Aim;
use shared::reflected::Reflected;
use shared::resampling::CrossProposal;
use shared::resampling::initial::Candidate;
use shared::reservoir::StoredReservoir;
use shared::resources::{Buffers, Extent};
use shared::shading::Contribution;
use shared::shadow::ShadowRay;
use shared::surface::Surface;
use std::collections::BTreeSet;
use std::f32::consts::PI;

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
    knowledge: Option<Knowledge>,
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
        let knowledge = (settings.cells != 0).then(|| Knowledge::new(world.size));
        Sequence { world, views, lights, settings, seed, plant, index: 0, history, knowledge }
    }

    /// From now on the scene's lights are those of `world`.
    pub fn set_lights(&mut self, world: &World) {
        self.lights = world.clone();
    }

    pub fn reservoirs(&self) -> &[StoredReservoir] {
        &self.history
    }

    /// Runs one frame and gives the radiance of its pixels.
    pub fn next_frame(&mut self) -> Vec<Vec3> {
        let [view, before] = [self.index & 1, (self.index + 1) & 1].map(|i| &self.views[i as usize]);
        let World { lights, alias, tree, size, .. } = &self.lights;
        let sky = lights.iter().position(|light| light.kind == kind::ENVIRONMENT);
        let frame = FrameConstants {
            camera: view.camera,
            previous_camera: before.camera,
            size: *size,
            index: self.index,
            seed: self.seed,
            settings: self.settings,
            exposure: 1.0,
            background: Vec3::ZERO,
            environment_size: if sky.is_some() { SKY } else { UVec2::ZERO },
            first_environment_light: sky.unwrap_or(0) as u32,
            tree_lights: tree.lights.len() as u32,
            place: 0,
        };
        let known = features::TRACEABLE | features::LIGHT_KINDS;
        // What has lights by its triangles' numbers, and what has none: see `World::nearest`.
        let instances = [0, NO_LIGHT].map(|first_light| InstanceGeometry {
            first_light,
            ..InstanceGeometry::new(Affine3A::IDENTITY, 0, 0, 0)
        });
        let texel = |light| EnvironmentTexel { radiance: Vec3::ZERO, light };
        let environment: Vec<_> = (0..SKY.x * SKY.y).map(texel).collect();
        let buffers = Buffers {
            lights,
            alias,
            tree_nodes: &tree.nodes,
            tree_lights: &tree.lights,
            tree_leaves: &tree.leaves,
            instances: &instances,
            environment: &environment,
            gbuffer: &view.gbuffer,
            previous_gbuffer: &before.gbuffer,
            history: &self.history,
            aims: &view.aims,
            ..Buffers::default()
        };
        let frame = Frame {
            world: self.world,
            plant: self.plant,
            constants: &frame,
            features: if sky.is_some() { known | features::ENVIRONMENT } else { known },
            buffers,
        };
        let mut reservoirs = if let Some(knowledge) = &mut self.knowledge {
            knowledge.ready(&frame);
            let buffers = knowledge.buffers(frame.buffers);
            let reservoirs = Frame { buffers, ..frame }.initial();
            knowledge.observe(&frame, &reservoirs);
            reservoirs
        } else {
            frame.initial()
        };
        if self.settings.temporal != 0 {
            // No ray where nothing has moved.
            reservoirs = if view.camera == before.camera {
                frame.temporal(Assumed, &reservoirs)
            } else {
                let planted =
                    [(Plant::HistoryRay, Question::History), (Plant::SurvivorRay, Question::Survivor)];
                frame.temporal(frame.rays(planted), &reservoirs)
            };
        }
        for iteration in 0..self.settings.spatial_iterations * self.settings.spatial {
            let merge = if self.settings.in_pairs() { Frame::spatial_in_pairs } else { Frame::spatial };
            reservoirs = merge(&frame, &reservoirs, iteration);
        }
        let radiance = if self.settings.shading_needs_rays(frame.features) {
            frame.shade(frame.rays([(Plant::ShadowRay, Question::Shade)]), &reservoirs)
        } else {
            frame.shade(Assumed, &reservoirs)
        };
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
pub struct Frame<'a> {
    world: &'a World,
    plant: Option<Plant>,
    pub constants: &'a FrameConstants,
    features: u32,
    pub buffers: Buffers<'a>,
}

impl Frame<'_> {
    pub fn pixels(&self) -> impl Iterator<Item = UVec2> + use<> {
        self.world.pixels()
    }

    pub fn is(&self, plant: Plant) -> bool {
        self.plant == Some(plant)
    }

    pub fn at(&self, pixel: UVec2, lane: u32, iteration: u32) -> At<'_> {
        let Settings { mode, tiles, cells, .. } = self.constants.settings;
        let unbiased = if mode == mode::UNBIASED { variant::UNBIASED } else { 0 };
        At {
            frame: self.constants,
            constants: PassConstants { iteration, ..PassConstants::default() },
            features: self.features,
            variant: unbiased
                | if tiles != 0 { variant::TILED } else { 0 }
                | if cells != 0 { variant::CELLS } else { 0 }
                | if self.buffers.aims.is_empty() { 0 } else { variant::LASTING },
            pixel,
            lane,
        }
    }

    /// One result for every reservoir of every pixel, in the order of a reservoir buffer.
    fn each<T>(&self, iteration: u32, of: impl Fn(At<'_>, Falsifier<'_>, usize) -> T) -> Vec<T> {
        let lanes = 0..self.constants.settings.reservoirs;
        let all = lanes.flat_map(|lane| self.world.pixels().map(move |pixel| (pixel, lane)));
        all.map(|(pixel, lane)| self.at(pixel, lane, iteration))
            .map(|at| of(at, Falsifier { frame: self, at }, at.index(Extent::Reservoirs)))
            .collect()
    }

    /// The exact answers, but to the questions whose error is planted: those are answered with yes.
    fn rays<const N: usize>(&self, assumed: [(Plant, Question); N]) -> Rays<'_> {
        let planted = assumed.into_iter().find(|&(plant, _)| self.is(plant));
        Rays { frame: self, assumed: planted.map(|(_, question)| question) }
    }

    fn initial(&self) -> Vec<StoredReservoir> {
        let b = self.buffers;
        let (entries, points) =
            if self.constants.settings.tiles != 0 { self.tiles() } else { (vec![], vec![]) };
        let rays = self.rays([(Plant::VisibilityReuse, Question::Survivor)]);
        self.each(0, |at, note, _| {
            let mut fresh = passes::initial(
                at,
                rays,
                note,
                b.lights,
                b.alias,
                b.tree_nodes,
                b.tree_lights,
                b.tree_leaves,
                b.instances,
                b.environment,
                b.gbuffer,
                &entries,
                &points,
                b.cells,
                b.lists,
                b.beliefs,
                b.pool_entries,
                b.pool_points,
            );
            if self.is(Plant::FreshNormalization) {
                fresh.contribution_weight *= fresh.confidence;
            }
            if self.is(Plant::EmptyForgotten) && fresh.contribution_weight == 0.0 {
                fresh.confidence = 0.0;
            }
            fresh
        })
    }

    /// The tiles that this frame's pixels read.
    fn tiles(&self) -> (Vec<TileEntry>, Vec<u32>) {
        let count = (TILES * TILE_SIZE) as usize;
        let (mut entries, mut points) = (vec![TileEntry::default(); count], vec![0; count]);
        let used: BTreeSet<_> =
            self.each(0, |at, _, _| tile_of(at.frame, at.pixel, at.lane)).into_iter().collect();
        for place in used.iter().flat_map(|tile| (0..TILE_SIZE).map(move |entry| UVec2::new(entry, *tile))) {
            let at = self.at(place, 0, 0);
            let (mut entry, point) = passes::presample(at, self.buffers.lights, self.buffers.alias);
            if self.is(Plant::TilePmf) {
                // Word 6 of an entry is its density.
                let words: &mut [f32; 8] = bytemuck::cast_mut(&mut entry);
                words[6] = 1.0 / self.buffers.lights.len() as f32;
            }
            (entries[at.index(Extent::Tiles)], points[at.index(Extent::Tiles)]) = (entry, point);
        }
        (entries, points)
    }

    fn temporal(&self, rays: impl Visibility + Copy, fresh: &[StoredReservoir]) -> Vec<StoredReservoir> {
        let b = self.buffers;
        let settings = &self.constants.settings;
        let mut history = b.history.to_vec();
        if self.is(Plant::CapAfterWeight) {
            let cap = settings.confidence_cap * settings.candidates as f32;
            history.iter_mut().for_each(|h| h.contribution_weight *= (h.confidence / cap).max(1.0));
        }
        let mut aims = b.aims.to_vec();
        if self.is(Plant::OtherPoint) {
            let count = aims.len() as u32;
            aims.iter_mut().for_each(|aim| {
                *aim = aim.source().map_or(*aim, |i| Aim::at_point(aim.place, (i + 1) % count));
            });
        }
        self.each(0, |at, note, i| {
            self.unnormalized(passes::temporal(
                at,
                rays,
                note,
                b.lights,
                b.alias,
                b.gbuffer,
                b.previous_gbuffer,
                &history,
                &aims,
                b.previous_lights,
                b.motions,
                b.previous_to_current,
                b.current_to_previous,
                fresh[i],
            ))
        })
    }

    fn unnormalized(&self, merged: StoredReservoir) -> StoredReservoir {
        let planted = self.is(Plant::MergedNormalization);
        let factor =
            if planted { merged.confidence / self.constants.settings.candidates as f32 } else { 1.0 };
        StoredReservoir { contribution_weight: merged.contribution_weight * factor, ..merged }
    }

    fn spatial(&self, reservoirs: &[StoredReservoir], iteration: u32) -> Vec<StoredReservoir> {
        let b = self.buffers;
        let rays =
            self.rays([(Plant::PendingRay, Question::Neighbor), (Plant::SurvivorRay, Question::Survivor)]);
        self.each(iteration, |at, note, _| {
            self.unnormalized(passes::spatial(at, rays, note, b.lights, b.alias, b.gbuffer, reservoirs))
        })
    }

    fn spatial_in_pairs(&self, reservoirs: &[StoredReservoir], iteration: u32) -> Vec<StoredReservoir> {
        let b = self.buffers;
        let all = |ray: Plant| -> Vec<PairTargets> {
            let rays = self.rays([(ray, Question::Partner)]);
            self.each(iteration, |at, note, _| {
                passes::pair_targets(at, rays, note, b.lights, b.alias, b.gbuffer, reservoirs)
            })
        };
        let (here, there) = (all(Plant::RayToPartner), all(Plant::RayFromPartner));
        self.each(iteration, |at, note, i| {
            let mut targets = there.clone();
            targets[i] = here[i];
            let partner = here[i].index as usize;
            if self.is(Plant::PartnerTarget) && partner != i {
                targets[partner].partner = here[i].own;
            }
            passes::pair_merge(at, Assumed, note, reservoirs, &targets)
        })
    }

    fn shade(&self, rays: impl Visibility + Copy, reservoirs: &[StoredReservoir]) -> Vec<Vec3> {
        let b = self.buffers;
        let count = if self.is(Plant::Average) { self.constants.settings.reservoirs as f32 } else { 1.0 };
        let shaded = |pixel: UVec2| {
            let at = self.at(pixel, 0, 0);
            let note = Falsifier { frame: self, at };
            passes::shade(at, rays, note, b.lights, b.alias, b.gbuffer, reservoirs, Vec3::ZERO) * count
        };
        self.world.pixels().map(shaded).collect()
    }
}

/// The occluders of the world, exactly; or what a planted error makes of them.
#[derive(Clone, Copy)]
struct Rays<'a> {
    frame: &'a Frame<'a>,
    /// Answered with yes.
    assumed: Option<Question>,
}

impl Visibility for Rays<'_> {
    const TRACES: bool = true;

    fn sees(&mut self, question: Question, ray: ShadowRay, _: u32) -> bool {
        let inverted = question == Question::Neighbor && self.frame.is(Plant::PendingInverted);
        self.assumed == Some(question) || self.frame.world.trace(ray) != inverted
    }

    fn nearest(&mut self, origin: Vec3, direction: Vec3, _: u32) -> HitPayload {
        self.frame.world.nearest(origin, direction, self.frame.is(Plant::FoundRay))
    }
}

/// Plants errors in the steps of a body.
#[derive(Clone, Copy)]
struct Falsifier<'a> {
    frame: &'a Frame<'a>,
    at: At<'a>,
}

impl Falsifier<'_> {
    fn surface(&self) -> Surface {
        self.at.surface(&self.at.texel(self.frame.buffers.gbuffer))
    }

    fn lights(&self) -> LightTable<'_> {
        let Buffers { lights, alias, .. } = self.frame.buffers;
        self.at.light_table(lights, alias)
    }

    /// What the density of a BSDF candidate is wrong by.
    fn found_factor(&self, candidate: &Candidate) -> f32 {
        let Surface { reflectance, normal, wo, position, .. } = self.surface();
        let incident = self.lights().incident(candidate.sample, position);
        if self.frame.is(Plant::FoundSolidAngle) {
            return 1.0 / incident.solid_angle.max(1e-6);
        }
        let probability = bsdf::specular_probability(&reflectance, normal.dot(wo));
        let diffuse = normal.dot(incident.direction) / PI;
        let density = bsdf::pdf(&reflectance, normal, wo, incident.direction).0;
        let specular = (density - (1.0 - probability) * diffuse) / probability;
        ((1.0 - probability) * specular + probability * diffuse) / density
    }
}

impl Witness for Falsifier<'_> {
    fn draws(&mut self, technique: Technique, candidate: &mut Candidate) {
        if self.frame.is(Plant::BeliefInTargetAlone) && technique == Technique::Pool {
            // As if every second light were believed to be half as visible.
            candidate.target *= if candidate.sample.light & 1 == 0 { 0.5 } else { 1.0 };
            candidate.source_pdf.0 *= if candidate.sample.light & 1 == 0 { 0.5 } else { 1.0 };
        }
        let table = self.lights().pdf(candidate.sample.light).0;
        let found = candidate.source_pdf.0 - table;
        let density = match (self.frame.plant, technique) {
            (Some(Plant::Balance), Technique::Bsdf) => found,
            (Some(Plant::Balance), _) => table,
            (Some(Plant::FoundSolidAngle | Plant::FoundMixture), Technique::Bsdf) => {
                table + found * self.found_factor(candidate)
            }
            _ => return,
        };
        candidate.source_pdf = SourcePdf(density);
    }

    fn cross(&mut self, cross: &mut CrossProposal) {
        let (targets, history) = (&mut cross.targets, &mut cross.neighbor);
        match self.frame.plant {
            Some(Plant::ForeignTarget) => targets.neighbor_at_neighbor = targets.neighbor_at_canonical,
            Some(Plant::MisWeight) => {
                // The canonical sample weighs all where the history could not have found it; the history's own weight ends at its
                // share of the confidence, which is taken out.
                targets.canonical_at_neighbor = 0.0;
                targets.neighbor_at_neighbor = 1e30;
                let fresh = self.frame.constants.settings.candidates as f32;
                history.contribution_weight *= (fresh + history.confidence) / history.confidence;
            }
            _ => {}
        }
    }

    /// Takes a term back out of the integrand.
    fn shaded<L: Reflected>(&mut self, stored: StoredReservoir, shaded: &mut Contribution<L>) {
        if stored.contribution_weight == 0.0 || self.frame.plant.is_none() {
            return;
        }
        let surface = self.surface();
        let incident = self.lights().incident(stored.sample, surface.position);
        let light = &self.frame.buffers.lights[stored.sample.light as usize];
        let finite = light.kind == kind::POINT || light.kind == kind::TRIANGLE;
        let factor = match self.frame.plant {
            Some(Plant::Cosine) => 1.0 / surface.normal.dot(incident.direction).max(1e-3),
            Some(Plant::EmitterCosine) if light.kind == kind::TRIANGLE => {
                1.0 / -incident.normal.dot(incident.direction).min(-1e-3)
            }
            Some(Plant::Distance) if finite => incident.distance * incident.distance,
            _ => 1.0,
        };
        shaded.radiance = shaded.radiance * factor;
    }
}
