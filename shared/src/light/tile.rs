//! Presampled light tiles (Wyman & Panteleev 2021, "Rearchitecting Spatiotemporal Resampling for Production", section 4):
//! each frame draws a few thousand light samples once; the pixels of a block take their candidates from one small tile of
//! them, which caches hold, instead of from all lights.
//!
//! An entry is drawn as any candidate is, so a uniform pick from a tile has the source density of the entry itself, and
//! resampling stays unbiased. Packing touches only the target that candidates compete with, never the light they bring:
//! later passes and the contribution weight's integrand read the light itself.

use super::arrival::{Connection, from_point, traceable};
use super::kinds::{attenuates, is_shape};
use super::{DOUBLE_SIDED, Incident, LightSample, LightTable, Shape};
use crate::frame::FrameConstants;
use crate::math::{pack_direction, safe_ratio, unpack_direction};
use crate::pdf::SourcePdf;
use crate::rng::{Rng, Stream, hash};
use bytemuck::{Pod, Zeroable};
use glam::{UVec2, UVec4, Vec3};
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float;

/// Tiles drawn a frame.
pub const TILES: u32 = 128;
/// Entries of a tile, a power of two.
pub const TILE_SIZE: u32 = 1024;
/// Pixels of this many columns and rows share a tile.
const BLOCK: u32 = 8;

/// More than packing can take from a cosine: what the light lights, its entry lights too.
const COSINE_SLACK: f32 = 1e-4;
/// Steps of the emission's code in an octave, and its least exponent: 2^-32 to 2^32, within 0.04 %.
const STEPS: f32 = 1024.0;
const LEAST_EXPONENT: f32 = -32.0;

/// A drawn light sample, ready to be weighed. 32 bytes: one memory sector.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct TileEntry {
    /// The point on the light, world space, m; for light from infinity the unit direction to it; of [`Shape::Seen`] the point of
    /// the square.
    position: Vec3,
    /// Surface: its normal, see [`pack_direction`].
    normal: u32,
    /// Emission, logarithmic: red in the low half, green in the high one.
    red_green: u32,
    /// Blue in the low half; kind in bits 16 to 19, flags in 20 to 23, and the believed visibility x 256 - 1 above.
    blue_kind: u32,
    /// Density of this sample in the light's own measure.
    source_pdf: f32,
    /// Index of the light.
    light: u32,
}

/// All tiles of a frame, one after another.
#[derive(Clone, Copy)]
pub struct Tiles<'a> {
    /// What is drawn from.
    pub entries: &'a [TileEntry],
    /// `LightSample::uv` of each entry: read for the survivor only.
    pub points: &'a [u32],
}

/// The tile that reservoir `lane` of `pixel` draws from.
pub fn tile_of(frame: &FrameConstants, pixel: UVec2, lane: u32) -> u32 {
    let block = pixel / BLOCK;
    let stream = (Stream::Tiles as u32) << 16 | lane;
    hash(UVec4::new(block.x | block.y << 16, frame.index, frame.seed, stream)).x % TILES
}

/// Draws entry `entry` of tile `tile`, and its point.
pub fn presample(lights: LightTable<'_>, tile: u32, entry: u32, frame: &FrameConstants) -> (TileEntry, u32) {
    let mut rng = Rng::new(UVec2::new(entry, tile), frame.index, frame.seed, Stream::Tiles, 0);
    let random = rng.next_u32x4();
    let (sample, source_pdf) = lights.sample([random.x, random.y, random.z]);
    (TileEntry::new(lights, sample, source_pdf), sample.uv)
}

impl TileEntry {
    pub(crate) fn new(lights: LightTable<'_>, sample: LightSample, source_pdf: SourcePdf) -> Self {
        if sample.light >= lights.lights.count() {
            return TileEntry::default();
        }
        let light = lights.lights.lights[sample.light as usize];
        let place = light.place(sample.square(), lights.lights.features);
        let e = light.emission;
        TileEntry {
            position: place.position,
            normal: pack_direction(place.normal),
            red_green: encode(e.x) | encode(e.y) << 16,
            blue_kind: encode(e.z) | (light.kind | light.flags << 4 | 0xff << 8) << 16,
            source_pdf: source_pdf.0,
            light: sample.light,
        }
    }

    /// The same, believed to arrive with a probability of `visibility` in (0, 1], rounded.
    pub(crate) fn believed(self, visibility: f32) -> Self {
        let code = (visibility * 256.0).clamp(1.0, 256.0) as u32 - 1;
        TileEntry { blue_kind: self.blue_kind & 0x00ff_ffff | code << 24, ..self }
    }

    /// The fraction of its light that is believed to arrive, in (0, 1].
    pub fn visibility(&self) -> f32 {
        ((self.blue_kind >> 24) + 1) as f32 * (1.0 / 256.0)
    }

    /// Its index in the light buffer.
    pub fn light(&self) -> u32 {
        self.light
    }

    /// Density that the sample was drawn with.
    pub fn source_pdf(&self) -> SourcePdf {
        SourcePdf(self.source_pdf)
    }

    /// Direction, irradiance and solid angle at `receiver` of what the entry stands for, its emission within 0.04 % and positive
    /// wherever the light's is, its normal within 1e-4 rad; the other fields are not set. Of lights that shine more in some
    /// directions than in others, and of [`Shape::Seen`], all of it is read from `lights`.
    pub fn incident(&self, lights: LightTable<'_>, receiver: Vec3) -> Incident {
        let (kind, flags) = (self.blue_kind >> 16 & 15, self.blue_kind >> 20 & 15);
        let features = lights.lights.features;
        if is_shape(kind, Shape::Seen, features) {
            let light = lights.lights.lights[self.light as usize];
            return light.seen(self.position.truncate(), receiver, features);
        }
        if attenuates(kind, features) {
            let light = lights.lights.lights[self.light as usize];
            let incident =
                from_point(self.position, &Connection::new(receiver, self.position), light.emission);
            let irradiance = incident.irradiance * light.attenuation(incident.direction, features);
            return Incident { irradiance, ..incident };
        }
        let emission = Vec3::new(
            decode(self.red_green & 0xffff),
            decode(self.red_green >> 16),
            decode(self.blue_kind & 0xffff),
        );
        if is_shape(kind, Shape::Infinity, features) {
            let solid_angle = traceable(flags);
            let direction = self.position;
            return Incident { direction, irradiance: emission, solid_angle, ..Incident::default() };
        }
        let incident = from_point(self.position, &Connection::new(receiver, self.position), emission);
        if is_shape(kind, Shape::Surface, features) {
            let cos = -unpack_direction(self.normal).dot(incident.direction);
            let facing = if flags & DOUBLE_SIDED != 0 { cos.abs() } else { cos };
            let inverse_square = safe_ratio(1.0, incident.distance * incident.distance);
            return Incident {
                irradiance: incident.irradiance * (facing + COSINE_SLACK).max(0.0),
                solid_angle: traceable(flags) * (facing.max(0.0) * inverse_square),
                ..incident
            };
        }
        incident
    }
}

/// Logarithm in 16 bits; 0 stays 0, and nothing positive becomes 0.
fn encode(x: f32) -> u32 {
    if x <= 0.0 {
        return 0;
    }
    (((x.log2() - LEAST_EXPONENT) * STEPS + 0.5).clamp(0.0, 65534.0)) as u32 + 1
}

fn decode(code: u32) -> f32 {
    if code == 0 { 0.0 } else { ((code - 1) as f32 * (1.0 / STEPS) + LEAST_EXPONENT).exp2() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::kinds::SAMPLES;
    use crate::light::{Light, Lights, build_alias_table};

    /// Some more triangles, which packing is hardest on.
    fn all_kinds() -> Vec<Light> {
        let [a, b, c] = [Vec3::new(1.0, 2.0, 0.5), Vec3::new(1.7, 2.1, 0.4), Vec3::new(1.1, 2.3, 1.2)];
        let triangles = [
            Light::triangle([a, b, c], Vec3::new(7.0, 3e4, 0.2), false),
            Light::triangle([a, c, b], Vec3::new(1e-4, 2.0, 9.0), true),
        ];
        let dim = |light: Light| Light { emission: light.emission * Vec3::new(100.0, 1e-3, 0.0), ..light };
        let samples = SAMPLES.into_iter().flat_map(|(_, known)| [known(1.0).light, dim(known(2.5).light)]);
        samples.chain(triangles).collect()
    }

    /// Each kind: what an entry says is what its light says, within the packing's error; and wherever the light
    /// lights a receiver, the entry does, also along the light's surface.
    #[test]
    fn entries_say_what_their_lights_say() {
        let lights = all_kinds();
        let alias = build_alias_table(&lights);
        let table = LightTable { lights: Lights::untextured(&lights), alias: &alias };
        let mut rng = Rng::new(UVec2::ZERO, 0, 3, Stream::Initial, 0);
        for light in 0..lights.len() as u32 {
            let mut lit = 0;
            for i in 0..20_000 {
                let r = rng.next_u32x4();
                let sample = LightSample { light, uv: r.x };
                let entry = TileEntry::new(table, sample, SourcePdf(1.0));
                let mut receiver = Vec3::new(r.y as f32, r.z as f32, r.w as f32) / 2f32.powi(32) * 6.0 - 3.0;
                if i % 2 == 0 && is_shape(lights[light as usize].kind, Shape::Surface, u32::MAX) {
                    // In the plane of a flat one, but for rounding.
                    let on = |uv: u32| table.incident(LightSample { light, uv }, Vec3::ZERO).position;
                    receiver = on(r.x) + (on(r.y) - on(r.z)) * 3.0;
                }
                let (exact, packed) = (table.incident(sample, receiver), entry.incident(table, receiver));
                let error = (packed.irradiance - exact.irradiance).abs();
                let grazing = exact.normal != Vec3::ZERO && -exact.normal.dot(exact.direction) < 0.5;
                lit += u32::from(exact.irradiance.max_element() > 0.0);
                for channel in 0..3 {
                    let truth = exact.irradiance[channel];
                    assert!(truth == 0.0 || packed.irradiance[channel] > 0.0, "light {light} went out");
                    if !grazing && truth > 0.0 {
                        assert!(error[channel] <= 1e-3 * truth, "light {light}: {packed:?}, {exact:?}");
                    }
                }
                assert!((packed.direction - exact.direction).length() < 1e-6);
                let slack = 2e-4 * safe_ratio(1.0, exact.distance * exact.distance);
                let solid_angle = if grazing { 0.0 } else { exact.solid_angle };
                assert!((packed.solid_angle - solid_angle).abs() <= slack || grazing, "light {light}");
            }
            assert!(lit > 500, "light {light}: {lit}");
        }
    }

    #[test]
    fn emission_keeps_its_value() {
        for i in 0..10_000 {
            let x = 2f32.powf(i as f32 / 10_000.0 * 63.9 - 31.9);
            let back = decode(encode(x));
            assert!((back - x).abs() <= 4e-4 * x, "{x} became {back}");
        }
        assert_eq!(decode(encode(0.0)), 0.0);
        assert!(decode(encode(1e-38)) > 0.0 && decode(encode(f32::MAX)).is_finite());
    }

    /// A tile's entries follow the light table: chi-square over the lights, 5 degrees of freedom, false alarm 1e-4
    /// (fixed seed).
    #[test]
    fn entries_follow_the_light_table() {
        let lights: Vec<_> =
            (1..=6).map(|i| Light::point(Vec3::X * i as f32, Vec3::splat(i as f32))).collect();
        let alias = build_alias_table(&lights);
        let table = LightTable { lights: Lights::untextured(&lights), alias: &alias };
        let frame = FrameConstants { index: 5, seed: 9, ..Zeroable::zeroed() };
        let mut counts = [0u32; 6];
        for entry in 0..16 * TILE_SIZE {
            let (drawn, _) = presample(table, entry / TILE_SIZE, entry % TILE_SIZE, &frame);
            counts[drawn.light as usize] += 1;
            let pmf = (drawn.light + 1) as f32 / 21.0;
            assert!((drawn.source_pdf - pmf).abs() < 1e-6 * pmf);
        }
        let chi2: f64 = (0..6)
            .map(|i| (f64::from(16 * TILE_SIZE) * f64::from(i as u32 + 1) / 21.0, f64::from(counts[i])))
            .map(|(expected, n)| (n - expected).powi(2) / expected)
            .sum();
        assert!(chi2 < 25.7, "{chi2}: {counts:?}");
    }

    #[test]
    fn blocks_share_tiles_and_frames_change_them() {
        let mut frame = FrameConstants { size: UVec2::splat(64), ..Zeroable::zeroed() };
        let of = |frame: &FrameConstants, x, y| tile_of(frame, UVec2::new(x, y), 0);
        assert_eq!(of(&frame, 8, 16), of(&frame, 15, 23));
        let all: std::collections::HashSet<_> =
            (0..4096).map(|i| of(&frame, i % 64 * 8, i / 64 * 8)).collect();
        assert_eq!(all.len(), TILES as usize, "every tile is used");
        let before = of(&frame, 0, 0);
        frame.index = 1;
        assert_ne!(of(&frame, 0, 0), before, "with this seed");
    }
}
