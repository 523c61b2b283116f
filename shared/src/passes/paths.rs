//! The truth of light that bounces: a path tracer with a loop of its own. Nothing of resampling is in it, so that it can't share
//! its faults.
//!
//! Light that reaches what a pixel sees straight from a light is [`super::reference`]'s. A path starts along the reflectance
//! there, and what lights it at each further point is estimated twice: by a light that the alias table draws, and by the ray that
//! goes on; the balance heuristic weighs both. Emission that the first ray meets is light from a light, and is left out.

use super::{At, Question, Technique, Visibility, Witness};
use crate::alias_table::AliasEntry;
use crate::alpha;
use crate::bsdf;
use crate::environment::EnvironmentTexel;
use crate::geometry::{InstanceGeometry, VertexAttributes};
use crate::light::found::Emitters;
use crate::light::{DOUBLE_SIDED, Light, LightTable};
use crate::material::Material;
use crate::math::safe_ratio;
use crate::motion::NO_LIGHT;
use crate::pdf::PdfArea;
use crate::points::ScenePoint;
use crate::reflected::{Parts, Reflected};
use crate::rng::{Rng, Stream, unit_f32};
use crate::scene::{Met, Scene};
use crate::shadow::ShadowRay;
use crate::surface::{GBufferTexel, Surface};
use crate::target::unshadowed;
use crate::textures::Texels;
use glam::{Vec2, Vec3};

/// Reflections after which Russian roulette begins.
const SURE_BOUNCES: u32 = 3;
/// A path goes on with at most this probability then, also where nothing absorbs.
const MOST_SURVIVAL: f32 = 0.95;
/// No path has more: 0.95^1000 of them would.
pub const LONGEST: u32 = 1000;

/// Light that reached what the pixel sees after 1 to `bounces` reflections, nit: the mean of as many paths as the
/// constants ask for.
#[allow(clippy::too_many_arguments)]
pub fn paths(
    at: At<'_>,
    rays: impl Visibility,
    note: impl Witness,
    lights: &[Light],
    alias: &[AliasEntry],
    instances: &[InstanceGeometry],
    positions: &[Vec3],
    attributes: &[VertexAttributes],
    indices: &[u32],
    materials: &[Material],
    second_uvs: &[Vec2],
    environment: &[EnvironmentTexel],
    textures: impl Texels,
    gbuffer: &[GBufferTexel],
) -> Vec3 {
    let features = at.features;
    let scene =
        Scene { features, instances, positions, attributes, indices, materials, second_uvs, environment };
    indirect::<Vec3>(at, rays, note, at.light_table(lights, alias), scene, textures, gbuffer)
}

/// The same light in [`Parts`]: diffuse, specular, nit.
#[allow(clippy::too_many_arguments)]
pub fn paths_parts(
    at: At<'_>,
    rays: impl Visibility,
    note: impl Witness,
    lights: &[Light],
    alias: &[AliasEntry],
    instances: &[InstanceGeometry],
    positions: &[Vec3],
    attributes: &[VertexAttributes],
    indices: &[u32],
    materials: &[Material],
    second_uvs: &[Vec2],
    environment: &[EnvironmentTexel],
    textures: impl Texels,
    gbuffer: &[GBufferTexel],
) -> (Vec3, Vec3) {
    let features = at.features;
    let scene =
        Scene { features, instances, positions, attributes, indices, materials, second_uvs, environment };
    indirect::<Parts>(at, rays, note, at.light_table(lights, alias), scene, textures, gbuffer).apart()
}

/// Where a path goes on.
#[derive(Clone, Copy, Debug)]
pub struct Bounce {
    /// Unit.
    pub direction: Vec3,
    /// Its density, 1/sr; 0 where nothing is reflected that way.
    pub density: f32,
    /// Cosine between it and the shading normal.
    pub cos: f32,
}

/// Light at a point of a path, before it is weighed.
#[derive(Clone, Copy, Debug, Default)]
pub struct Arrival {
    /// f Le G, nit per measure of the densities.
    pub light: Vec3,
    /// With which the light table draws it.
    pub drawn: f32,
    /// With which the ray that goes on finds it.
    pub found: f32,
}

impl Bounce {
    /// From `surface`, drawn along its reflectance.
    fn new(surface: &Surface, random: [u32; 3]) -> Self {
        let Surface { reflectance, normal, wo, .. } = surface;
        let square = Vec2::new(unit_f32(random[1]), unit_f32(random[2]));
        let direction = bsdf::sample(reflectance, *normal, *wo, unit_f32(random[0]), square);
        let cos = normal.dot(direction);
        // Below the real or the shaded surface nothing is reflected.
        let above = (surface.geometric_normal.dot(direction) > 0.0) & (cos > 0.0);
        let density = if above { bsdf::pdf(reflectance, *normal, *wo, direction).0 } else { 0.0 };
        Bounce { direction, density, cos }
    }

    /// f cosθ.
    fn reflected<L: Reflected>(&self, surface: &Surface) -> L {
        bsdf::eval::<L>(&surface.reflectance, surface.normal, surface.wo, self.direction) * self.cos
    }

    /// f cosθ / p: what light from there is multiplied by.
    fn weight<L: Reflected>(&self, surface: &Surface) -> L {
        self.reflected::<L>(surface) * safe_ratio(1.0, self.density)
    }
}

impl Arrival {
    /// f Le G / (p + p_b): the balance heuristic, whichever of the two drew it.
    ///
    /// Equation (34).
    fn weighed(&self) -> Vec3 {
        self.light * safe_ratio(1.0, self.drawn + self.found)
    }
}

/// The mean of a pixel's paths.
fn indirect<L: Reflected>(
    at: At<'_>,
    mut rays: impl Visibility,
    mut note: impl Witness,
    table: LightTable<'_>,
    scene: Scene<'_>,
    textures: impl Texels,
    gbuffer: &[GBufferTexel],
) -> L {
    let texel = at.texel(gbuffer);
    let mut sum = L::default();
    if texel.is_empty() || at.constants.bounces == 0 {
        return sum;
    }
    let surface = at.surface(&texel);
    let mut i = 0;
    // Around a trace, see `Visibility`.
    while i < at.constants.paths {
        let rng = at.lane_rng(Stream::Paths, i);
        sum += path::<L>(at, &mut rays, &mut note, table, scene, textures, surface, rng);
        i += 1;
    }
    sum / (at.constants.paths.max(1)) as f32
}

/// Light after 1 to `bounces` reflections on its way to `surface`: one path's estimate.
///
/// Equation (33).
#[allow(clippy::too_many_arguments)]
fn path<L: Reflected>(
    at: At<'_>,
    rays: &mut impl Visibility,
    note: &mut impl Witness,
    table: LightTable<'_>,
    scene: Scene<'_>,
    textures: impl Texels,
    mut surface: Surface,
    mut rng: Rng,
) -> L {
    let bounces = at.constants.bounces.min(LONGEST);
    let emitters = Emitters::new(at.frame, at.features, scene.instances, scene.environment);
    // What light at the first point, and at those after it, is multiplied by.
    let (mut first, mut weight) = (L::default(), Vec3::ONE);
    let mut sum = Vec3::ZERO;
    let mut reflections = 0;
    // Around a trace, see `Visibility`.
    while reflections <= bounces {
        if reflections > 0 {
            let random = rng.next_u32x4();
            let (ray, mut arrival) = drawn(table, &surface, [random.x, random.y, random.z]);
            note.arrives(Technique::Table, &mut arrival);
            let light = weight * arrival.weighed();
            if light != Vec3::ZERO && rays.sees(Question::Light, ray, alpha::key(random.w)) {
                sum += light;
            }
        }
        let random = rng.next_u32x4();
        let mut bounce = Bounce::new(&surface, [random.x, random.y, random.z]);
        note.bounces(&mut bounce);
        if bounce.density <= 0.0 {
            break;
        }
        let hit = rays.nearest(surface.ray_origin(f32::MAX), bounce.direction, alpha::key(random.w));
        let light = emitters.light_at(hit, bounce.direction);
        if hit.hit == 0 {
            if reflections > 0 {
                let mut arrival = found_sky(table, light, &surface, &bounce);
                note.arrives(Technique::Bsdf, &mut arrival);
                sum += weight * arrival.weighed();
            }
            break;
        }
        let met = scene.met(textures, ScenePoint::from(hit));
        // From the pixel's own surface it is direct light.
        if reflections > 0 {
            let mut arrival = found(table, light, &surface, &bounce, &met);
            note.arrives(Technique::Bsdf, &mut arrival);
            sum += weight * arrival.weighed();
        }
        if reflections == bounces || !met.seen.reflects(-bounce.direction) {
            break;
        }
        if reflections == 0 {
            first = bounce.weight::<L>(&surface);
        } else {
            weight *= bounce.weight::<Vec3>(&surface);
        }
        if reflections >= SURE_BOUNCES {
            let mut survival = weight.max_element().min(MOST_SURVIVAL);
            if rng.next_f32() >= survival {
                break;
            }
            note.survives(&mut survival);
            weight /= survival;
        }
        surface = met.seen.surface(-bounce.direction, met.magnitude);
        reflections += 1;
    }
    first * sum
}

/// A light that the table draws, as it lights `surface`, and the ray that decides over it.
fn drawn(table: LightTable<'_>, surface: &Surface, random: [u32; 3]) -> (ShadowRay, Arrival) {
    let (sample, density) = table.sample(random);
    let incident = table.incident(sample, surface.position);
    let Surface { reflectance, normal, wo, .. } = surface;
    let direction = bsdf::pdf(reflectance, *normal, *wo, incident.direction);
    let arrival = Arrival {
        light: unshadowed::<Vec3>(surface, &incident),
        drawn: density.0,
        found: direction.0 * incident.solid_angle,
    };
    (ShadowRay::new(surface, &incident), arrival)
}

/// What a ray from `surface` found of `light` on the surface that it met; nothing where that is none.
fn found(table: LightTable<'_>, light: u32, surface: &Surface, bounce: &Bounce, met: &Met) -> Arrival {
    if light == NO_LIGHT {
        return Arrival::default();
    }
    let Light { emission, flags, .. } = table.lights.lights[light as usize];
    let shines = met.seen.is_front(-bounce.direction) | (flags & DOUBLE_SIDED != 0);
    let point = &met.seen.point;
    let distance = (point.position - surface.position).length();
    let cos = point.geometric_normal.dot(bounce.direction).abs();
    Arrival {
        light: if shines { bounce.reflected::<Vec3>(surface) * emission } else { Vec3::ZERO },
        drawn: PdfArea(table.pdf(light).0).to_solid_angle(distance, cos).0,
        found: bounce.density,
    }
}

/// The same of the sky.
fn found_sky(table: LightTable<'_>, light: u32, surface: &Surface, bounce: &Bounce) -> Arrival {
    if light == NO_LIGHT {
        return Arrival::default();
    }
    Arrival {
        light: bounce.reflected::<Vec3>(surface) * table.lights.lights[light as usize].emission,
        drawn: table.pdf(light).0,
        found: bounce.density,
    }
}
