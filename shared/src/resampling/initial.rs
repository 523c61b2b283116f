//! Fills a pixel's reservoir with fresh light candidates: streaming RIS (Bitterli et al. 2020, Alg. 3) over two techniques.
//!
//! M candidates come from the light table, M_b from rays that the surface's reflectance aims (BSDF candidates). All are
//! weighed alike, w = p̂ / (M p + M_b p_b): the balance heuristic of Veach & Guibas 1995, whichever technique drew them. p_b is
//! the density of a direction times the solid angle of a unit of the light.

use super::Survivor;
use crate::bsdf;
use crate::frame::Settings;
use crate::light::tile::{TILE_SIZE, TileEntry, Tiles};
use crate::light::{Incident, LightSample, LightTable};
use crate::math::safe_ratio;
use crate::pdf::SourcePdf;
use crate::reservoir::Reservoir;
use crate::rng::{Rng, unit_f32};
use crate::surface::Surface;
use crate::target::target_function;
use glam::{UVec4, Vec2, Vec3};

/// How many candidates each technique gives a reservoir.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Techniques {
    /// M: from the light table.
    pub lights: u32,
    /// M_b: along the reflectance.
    pub bsdf: u32,
}

impl Techniques {
    /// In a scene with `features`.
    pub fn new(settings: &Settings, features: u32) -> Self {
        Techniques { lights: settings.light_candidates(), bsdf: settings.bsdf_candidates(features) }
    }

    /// p + p_b M_b / M of a sample that the light table draws with density p = `source_pdf`: times M, what all candidates
    /// together draw it with.
    ///
    /// Equation (7): Bitterli (4); thesis (4.9), thesis (4.10), thesis (4.11), thesis (4.12), thesis (4.13).
    /// Equation (8): Bitterli section 2.
    /// Equation (15).
    /// Equation (16).
    pub fn density(self, surface: &Surface, incident: &Incident, source_pdf: SourcePdf) -> SourcePdf {
        if self.bsdf == 0 || incident.solid_angle <= 0.0 {
            return source_pdf;
        }
        let direction = bsdf::pdf(&surface.reflectance, surface.normal, surface.wo, incident.direction);
        let share = self.bsdf as f32 / self.lights as f32;
        SourcePdf(source_pdf.0 + share * direction.0 * incident.solid_angle)
    }
}

/// A light sample that competes for a reservoir.
#[derive(Clone, Copy, Debug)]
pub struct Candidate {
    /// From a tile, `uv` is the place of its entry in all tiles: the point is looked up for the survivor only.
    pub sample: LightSample,
    /// Of [`Techniques::density`].
    pub source_pdf: SourcePdf,
    /// p̂ as far as it decides over survival.
    pub target: f32,
    /// Decides over its survival, in [0, 1).
    pub u: f32,
}

impl Candidate {
    /// w = p̂/p; 1/M follows at the end.
    ///
    /// Equation (9): Bitterli (5), Bitterli Alg. 1; thesis (4.16), thesis (4.17).
    pub fn weight(&self) -> f32 {
        safe_ratio(self.target, self.source_pdf.0)
    }
}

/// A reservoir that candidates compete for.
#[derive(Clone, Copy, Debug, Default)]
pub struct Fresh {
    /// Its confidence counts the candidates from the light table.
    pub reservoir: Reservoir,
    /// The survivor was found by a ray.
    pub seen: bool,
}

impl Fresh {
    /// A candidate from the light table. Does it stay, for now?
    pub fn add(&mut self, candidate: Candidate) -> bool {
        let Candidate { sample, target, u, .. } = candidate;
        let stays = self.reservoir.add(sample, target, candidate.weight(), 1.0, u);
        self.seen &= !stays;
        stays
    }

    /// A candidate that a ray found. Does it stay, for now?
    pub fn add_found(&mut self, candidate: Candidate) -> bool {
        let Candidate { sample, target, u, .. } = candidate;
        let stays = self.reservoir.add(sample, target, candidate.weight(), 0.0, u);
        self.seen |= stays;
        stays
    }

    /// The ray of visibility reuse follows.
    pub fn finish(self, surface: &Surface, lights: LightTable<'_>) -> Survivor {
        let finished = lights.canonical(self.reservoir.finish(self.reservoir.confidence));
        Survivor { seen: self.seen, ..Survivor::new(surface, lights, finished) }
    }
}

/// The next candidate from the light table.
pub fn candidate(
    surface: &Surface,
    lights: LightTable<'_>,
    techniques: Techniques,
    rng: &mut Rng,
) -> Candidate {
    let random = rng.next_u32x4();
    let (sample, source_pdf) = lights.sample([random.x, random.y, random.z]);
    weighed(surface, techniques, sample, &lights.incident(sample, surface.position), source_pdf, random.w)
}

fn weighed(
    surface: &Surface,
    techniques: Techniques,
    sample: LightSample,
    incident: &Incident,
    source_pdf: SourcePdf,
    random: u32,
) -> Candidate {
    let target = target_function(surface, incident);
    Candidate {
        sample,
        source_pdf: techniques.density(surface, incident, source_pdf),
        target,
        u: unit_f32(random),
    }
}

/// Random numbers of candidate `i` of a tile in x and y; `last` are those of the candidate before. Four serve two.
pub fn numbers_from_tile(i: u32, last: UVec4, rng: &mut Rng) -> UVec4 {
    if i & 1 == 0 { rng.next_u32x4() } else { UVec4::new(last.z, last.w, 0, 0) }
}

/// Place of the entry of tile `tile` that `random` draws.
pub fn place_in_tile(tile: u32, random: u32) -> u32 {
    tile * TILE_SIZE + (random & (TILE_SIZE - 1))
}

/// Place of the entry for candidate `i` from the pool, of `pool` samples, of cell `cell`: each has a part of the pool, in which `random` draws.
pub fn place_in_pool(cell: u32, pool: u32, i: u32, techniques: Techniques, random: u32) -> u32 {
    let within = (i * pool + (random & (pool - 1))) / techniques.lights;
    cell * pool + (within & (pool - 1))
}

/// The candidate at `place` of all tiles or pools; its target is what is believed to arrive. `random` decides over its survival.
pub fn candidate_at_place(
    surface: &Surface,
    lights: LightTable<'_>,
    techniques: Techniques,
    tiles: Tiles<'_>,
    place: u32,
    random: u32,
) -> Candidate {
    let entry: TileEntry = tiles.entries[place as usize];
    let sample = LightSample { light: entry.light(), uv: place };
    let incident = entry.incident(lights, surface.position);
    let candidate = weighed(surface, techniques, sample, &incident, entry.source_pdf(), random);
    Candidate { target: candidate.target * entry.visibility(), ..candidate }
}

impl Fresh {
    /// With the point of a survivor from a tile.
    pub fn looked_up(mut self, tiles: Tiles<'_>) -> Self {
        if self.reservoir.weight_sum > 0.0 {
            self.reservoir.sample.uv = tiles.points[self.reservoir.sample.uv as usize];
        }
        self
    }
}

/// A ray that looks for light where the surface reflects.
#[derive(Clone, Copy, Debug)]
pub struct BsdfRay {
    /// World space, m.
    pub origin: Vec3,
    /// Unit.
    pub direction: Vec3,
    /// Decides over the survival of what it finds, in [0, 1).
    pub u: f32,
}

impl BsdfRay {
    /// The next BSDF candidate's.
    pub fn new(surface: &Surface, rng: &mut Rng) -> Self {
        let random = rng.next_u32x4();
        let square = Vec2::new(unit_f32(random.y), unit_f32(random.z));
        let Surface { reflectance, normal, wo, .. } = surface;
        BsdfRay {
            origin: surface.ray_origin(f32::MAX),
            direction: bsdf::sample(reflectance, *normal, *wo, unit_f32(random.x), square),
            u: unit_f32(random.w),
        }
    }

    /// Below the real or the shaded surface there is nothing to find.
    pub fn is_worth_tracing(&self, surface: &Surface) -> bool {
        surface.geometric_normal.dot(self.direction) > 0.0 && surface.normal.dot(self.direction) > 0.0
    }

    /// The candidate where the ray ended on `light`, which other techniques draw with a density of `source_pdf`; one that weighs
    /// nothing for no light.
    pub fn candidate(
        &self,
        surface: &Surface,
        lights: LightTable<'_>,
        techniques: Techniques,
        light: u32,
        source_pdf: SourcePdf,
    ) -> Candidate {
        let sample = lights.lights.sample_along(light, self.direction, surface.position);
        self.candidate_at(surface, lights, techniques, sample, source_pdf)
    }

    /// The same, where the point on the light is known.
    pub fn candidate_at(
        &self,
        surface: &Surface,
        lights: LightTable<'_>,
        techniques: Techniques,
        sample: LightSample,
        source_pdf: SourcePdf,
    ) -> Candidate {
        let incident = lights.incident(sample, surface.position);
        Candidate {
            sample,
            source_pdf: techniques.density(surface, &incident, source_pdf),
            target: target_function(surface, &incident),
            u: self.u,
        }
    }
}
