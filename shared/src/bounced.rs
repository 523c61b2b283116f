//! Light that bounces, as a pixel sees it: points of surfaces are its lights. A sample is a path beyond what the pixel sees, the
//! same path for every pixel, in the measures of its own surfaces; so reuse is the identity, and its Jacobian 1.
//!
//! x1 is what the pixel sees, x2 the point that reflects light to it, y a point of a light. Numbers: docs/algorithm.md, section 19.

use crate::alpha;
use crate::bsdf;
use crate::geometry::SurfacePoint;
use crate::light::{Incident, LightSample, LightTable};
use crate::math::{inverse_sqrt, pack_direction, unpack_direction};
use crate::points::ScenePoint;
use crate::resampling::Source;
use crate::scene::Scene;
use crate::surface::Surface;
use crate::target::{target_function, unshadowed};
use crate::textures::Texels;
use bytemuck::{Pod, Zeroable};
use glam::{UVec2, Vec2, Vec3};

/// Steps of a barycentric coordinate: 0.05 mm in a triangle of 100 m.
const STEPS: u32 = 1 << 21;
/// Bits of a key.
const KEY: u32 = 21;
/// In the second word of a place: light arrives from a direction, not from a point of a light.
const REFLECTED: u32 = 1 << 31;

/// A point of a triangle that a ray met, with the key of the path. 16 bytes. All zero: none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct PathPoint {
    /// 1 + index of its [`crate::geometry::InstanceGeometry`].
    instance: u32,
    /// Triangle within that geometry.
    primitive: u32,
    /// Barycentric coordinates in the lower 21 bits, the key's 11 lower bits above the one, 10 above the other.
    place: UVec2,
}

/// A path from x2 on. 24 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct PathSample {
    /// x2
    point: PathPoint,
    /// A [`LightSample`]; or the direction that light arrives from, packed, and its color, 10 bits a channel.
    arrival: UVec2,
}

/// What decides over blended surfaces along a path: a part of it, so that every ray that asks for it gets the same answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PathKey(u32);

impl PathKey {
    /// Of 32 random bits.
    pub fn new(random: u32) -> Self {
        PathKey(random >> (32 - KEY))
    }

    /// Of rays between x1 and x2, for [`crate::alpha`].
    pub fn to_surface(self) -> u32 {
        alpha::key(self.0 << 2)
    }

    /// Of rays from x2 on.
    pub fn to_light(self) -> u32 {
        alpha::key(self.0 << 2 | 2)
    }
}

impl PathPoint {
    /// What the first ray of a path met, if anything; moved to the nearest place that can be stored, where all is evaluated.
    pub fn new(hit: ScenePoint, key: PathKey) -> Self {
        if hit.is_none() {
            return PathPoint::default();
        }
        let step = |x: f32| ((x * STEPS as f32).max(0.0) as u32).min(STEPS - 1);
        let PathKey(key) = key;
        let place =
            UVec2::new(step(hit.barycentrics.x) | key << KEY, step(hit.barycentrics.y) | (key >> 11) << KEY);
        PathPoint { instance: hit.instance() + 1, primitive: hit.primitive, place }
    }

    /// Did the path meet nothing?
    pub fn is_none(&self) -> bool {
        self.instance == 0
    }

    fn point(&self) -> ScenePoint {
        let weight = |word: u32| ((word & (STEPS - 1)) as f32 + 0.5) / STEPS as f32;
        let barycentrics = Vec2::new(weight(self.place.x), weight(self.place.y));
        ScenePoint::new(self.instance - 1, self.primitive, barycentrics)
    }

    /// What its rays ask blended surfaces with.
    pub fn key(&self) -> PathKey {
        let UVec2 { x: low, y: high } = self.place;
        PathKey(low >> KEY | ((high & !REFLECTED) >> KEY) << 11)
    }

    /// The path on which `sample` lights the point.
    pub fn lit(self, LightSample { light, uv }: LightSample) -> PathSample {
        PathSample { point: self, arrival: UVec2::new(light, uv) }
    }

    /// The path on which light arrives from `direction` (unit), in the ratios of the channels of `radiance`. Its largest channel is
    /// left to the contribution weight.
    pub fn reflected(self, direction: Vec3, radiance: Vec3) -> PathSample {
        let color = (radiance * (1023.0 / radiance.max_element()) + 0.5).as_uvec3();
        let arrival = UVec2::new(pack_direction(direction), color.x | color.y << 10 | color.z << 20);
        PathSample { point: PathPoint { place: self.place | UVec2::new(0, REFLECTED), ..self }, arrival }
    }
}

impl PathSample {
    /// x2.
    pub fn point(&self) -> PathPoint {
        self.point
    }

    /// What its rays ask blended surfaces with.
    pub fn key(&self) -> PathKey {
        self.point.key()
    }

    /// The point of a light that lights x2, if it is lit directly.
    pub fn light(&self) -> Option<LightSample> {
        let UVec2 { x: light, y: uv } = self.arrival;
        if self.point.place.y & REFLECTED == 0 { Some(LightSample { light, uv }) } else { None }
    }

    /// Direction (unit) that light arrives from, and its color, of the others.
    fn arriving(&self) -> (Vec3, Vec3) {
        let UVec2 { x: direction, y: color } = self.arrival;
        let channels = UVec2::new(color & 1023, color >> 10 & 1023).extend(color >> 20 & 1023);
        (unpack_direction(direction), channels.as_vec3() / 1023.0)
    }
}

/// x2 as x1 sees it.
#[derive(Clone, Copy, Debug)]
pub struct Reflector {
    /// It reflects toward x1, along `wo`.
    pub surface: Surface,
    /// Of its triangle, where rays end: world space, m.
    pub position: Vec3,
    /// Of its triangle, unit, toward x1.
    pub normal: Vec3,
    /// From x1 to x2, m.
    pub distance: f32,
    /// cosθ'/d² at x2, sr/m²; 0 where it reflects nothing that way.
    pub solid_angle: f32,
}

impl Reflector {
    /// What x2 sends to x1, for one measure of what arrives along `sample`, unshadowed, nit.
    ///
    /// Equation (35).
    pub fn radiance(&self, table: LightTable<'_>, sample: PathSample) -> Vec3 {
        match sample.light() {
            Some(light) => unshadowed(&self.surface, &table.incident(light, self.surface.position)),
            None => {
                let (direction, color) = sample.arriving();
                reflected(&self.surface, direction) * color
            }
        }
    }

    /// p̂ of `sample`, which begins here, at `first`.
    pub fn target(&self, table: LightTable<'_>, first: &Surface, sample: PathSample) -> f32 {
        target_function(first, &self.incident(self.radiance(table, sample)))
    }

    /// As a light that sends `radiance` (nit, for one measure of what arrives at x2).
    pub fn incident(&self, radiance: Vec3) -> Incident {
        let Surface { distance: magnitude, wo, .. } = self.surface;
        let irradiance = radiance * self.solid_angle;
        Incident {
            position: self.position,
            normal: self.normal,
            magnitude,
            direction: -wo,
            distance: self.distance,
            irradiance: irradiance.min(Vec3::splat(1e30)),
            solid_angle: self.solid_angle,
        }
    }
}

/// Everything that tells what paths bring.
#[derive(Clone, Copy)]
pub struct Bounced<'a, T: Texels> {
    /// Lights at x2 and beyond.
    pub table: LightTable<'a>,
    /// Where x2 lies.
    pub scene: Scene<'a>,
    /// Of its materials.
    pub textures: T,
}

impl<T: Texels> Bounced<'_, T> {
    /// x2 as `receiver` (m) sees it.
    pub fn reflector(self, point: PathPoint, receiver: Vec3) -> Reflector {
        let met = self.scene.met(self.textures, point.point());
        let to_receiver = receiver - met.seen.point.position;
        let square = to_receiver.length_squared();
        // Nearer than 1e-15 m there is no direction: d² has to be a normal number.
        let inverse = if square > 1e-30 { inverse_sqrt(square) } else { 0.0 };
        let wo = to_receiver * inverse;
        let surface = met.seen.surface(wo, met.magnitude);
        let SurfacePoint { position, geometric_normal, .. } = met.seen.point;
        let normal = if met.seen.is_front(wo) { geometric_normal } else { -geometric_normal };
        let cos = normal.dot(wo).max(0.0);
        let solid_angle = if met.seen.reflects(wo) { cos * inverse * inverse } else { 0.0 };
        Reflector { surface, position, normal, distance: square * inverse, solid_angle }
    }
}

/// f cosθ of `surface` for light from `direction` (unit); 0 from below it, real or shaded.
pub fn reflected(surface: &Surface, direction: Vec3) -> Vec3 {
    let cos = surface.normal.dot(direction);
    if (surface.geometric_normal.dot(direction) <= 0.0) | (cos <= 0.0) {
        return Vec3::ZERO;
    }
    bsdf::eval::<Vec3>(&surface.reflectance, surface.normal, surface.wo, direction) * cos
}

impl<T: Texels> Source for Bounced<'_, T> {
    type Sample = PathSample;

    fn incident(self, sample: PathSample, receiver: Vec3) -> Incident {
        if sample.point.is_none() {
            return Incident::default();
        }
        let reflector = self.reflector(sample.point, receiver);
        reflector.incident(reflector.radiance(self.table, sample))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A hit, a key and a color come back: places within half a step, keys whole, ratios of channels within half of 1/1023.
    #[test]
    fn paths_survive_packing() {
        for i in 0..1000u32 {
            let t = i as f32 / 1000.0;
            let barycentrics = Vec2::new(t, (1.0 - t) * t);
            let hit = ScenePoint::new(i * 16_777, i << 19, barycentrics);
            let key = PathKey::new(i.wrapping_mul(0x9e37_79b9));
            let point = PathPoint::new(hit, key);
            let direction = Vec3::new(t - 0.5, 0.3, 0.7 - t).normalize();
            let radiance = Vec3::new(1e-6, 3.0, 7.0 * t) * 10f32.powi(i as i32 % 40 - 20);
            let (lit, reflected) =
                (point.lit(LightSample { light: i, uv: u32::MAX - i }), point.reflected(direction, radiance));
            assert_eq!((lit.key(), reflected.key()), (key, key));
            assert_eq!(lit.light(), Some(LightSample { light: i, uv: u32::MAX - i }));
            assert_eq!(reflected.light(), None);
            for sample in [lit, reflected] {
                let back = sample.point.point();
                assert_eq!((back.instance(), back.primitive), (hit.instance(), hit.primitive));
                assert!((back.barycentrics - barycentrics).abs().max_element() <= 0.51 / STEPS as f32);
            }
            let (from, color) = reflected.arriving();
            assert!(from.dot(direction) > 0.999_999);
            let ratios = radiance / radiance.max_element();
            assert!((color - ratios).abs().max_element() <= 0.501 / 1023.0, "{color} {ratios}");
        }
        assert_eq!((size_of::<PathPoint>(), size_of::<PathSample>()), (16, 24));
        assert!(PathSample::default().point().is_none());
    }

    /// No two keys, and neither end of a path, ask blended surfaces with the same numbers; none asks for sure hits only.
    #[test]
    fn keys_differ() {
        let mut all: Vec<u32> = (0..1u32 << 12)
            .map(|i| PathKey::new(i << 20))
            .flat_map(|k| [k.to_surface(), k.to_light()])
            .collect();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), 2 << 12);
        assert!(!all.contains(&alpha::SURE_HITS_ONLY));
    }
}
