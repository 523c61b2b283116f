//! The light table: what a reservoir's sample means, and how one is drawn.

use super::{Incident, Light};
use crate::motion::NO_LIGHT;
use crate::pdf::{Pmf, SourcePdf};
use crate::reservoir::StoredReservoir;
use crate::{alias_table, alias_table::AliasEntry};
use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3};

/// A point on a light: what a reservoir keeps. The light and where on it, both as drawn, so that every pass that
/// reads it evaluates the very same point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct LightSample {
    /// Index into the light table.
    pub light: u32,
    /// Where on the light: two 16-bit coordinates in the unit square, see [`LightSample::square`].
    pub uv: u32,
}

impl LightSample {
    /// The sample of `light` at a point of the unit square, moved to the grid.
    pub fn at(light: u32, square: Vec2) -> Self {
        let place = (square * 65536.0).clamp(Vec2::ZERO, Vec2::splat(65535.0));
        LightSample { light, uv: place.x as u32 | (place.y as u32) << 16 }
    }

    /// The point of the unit square: centers of a 65536 x 65536 grid, so never on its edge.
    pub fn square(self) -> Vec2 {
        Vec2::new((self.uv & 0xffff) as f32 + 0.5, (self.uv >> 16) as f32 + 0.5) * (1.0 / 65536.0)
    }
}

/// The lights of a scene.
#[derive(Clone, Copy)]
pub struct Lights<'a> {
    /// By index.
    pub lights: &'a [Light],
    /// [`crate::frame::features`]: kinds of light that it does not name are not there, and cost nothing.
    pub features: u32,
}

/// The lights and the table that draws them in proportion to their power.
///
/// ```
/// use candela_shared::glam::Vec3;
/// use candela_shared::light::{Light, LightTable, Lights, build_alias_table};
///
/// let lights = [1.0, 3.0].map(|cd| Light::point(Vec3::Y, Vec3::splat(cd)));
/// let alias = build_alias_table(&lights);
/// let table = LightTable { lights: Lights::untextured(&lights), alias: &alias };
/// assert!((table.pmf(1).0 - 0.75).abs() < 1e-6);
/// ```
#[derive(Clone, Copy)]
pub struct LightTable<'a> {
    /// The lights.
    pub lights: Lights<'a>,
    /// One column a light.
    pub alias: &'a [AliasEntry],
}

impl<'a> Lights<'a> {
    /// How many there are.
    pub fn count(self) -> u32 {
        self.lights.len() as u32
    }

    /// `sample` as seen from `receiver`; dark for a sample of no light.
    pub fn incident(self, sample: LightSample, receiver: Vec3) -> Incident {
        if sample.light >= self.count() {
            return Incident::default();
        }
        self.lights[sample.light as usize].sample_li_among(self.features, sample.square(), receiver)
    }

    /// The point of `light` in `direction` (unit) from `receiver`; of no light, a sample of none.
    pub fn sample_along(self, light: u32, direction: Vec3, receiver: Vec3) -> LightSample {
        if light >= self.count() {
            return LightSample { light: NO_LIGHT, uv: 0 };
        }
        LightSample::at(light, self.lights[light as usize].invert_li(direction, receiver))
    }

    /// Has `light` more than one point to sample?
    fn has_extent(self, light: u32) -> bool {
        light < self.count() && self.lights[light as usize].has_extent()
    }

    /// Density of a sample on `light` in the light's own measure; 0 for no light.
    pub fn pdf_li(self, light: u32) -> SourcePdf {
        if light < self.count() {
            self.lights[light as usize].pdf_li_among(self.features)
        } else {
            SourcePdf(0.0)
        }
    }
}

impl<'a> LightTable<'a> {
    /// Draws a light by its power, and a point on it. `random`: alias column, alias ticket, point.
    ///
    /// Equation (5): Bitterli section 5; thesis section 5.1.
    pub fn sample(self, random: [u32; 3]) -> (LightSample, SourcePdf) {
        let (light, pmf) = alias_table::sample(self.alias, [random[0], random[1]]);
        let sample = LightSample { light, uv: random[2] };
        (sample, pmf.and_on_light(self.lights.pdf_li(light)))
    }

    /// The density with which [`LightTable::sample`] draws points of `light`, in the light's own measure; 0 for no light.
    pub fn pdf(self, light: u32) -> SourcePdf {
        if light >= self.lights.count() || self.alias.is_empty() {
            return SourcePdf(0.0);
        }
        self.pmf(light).and_on_light(self.lights.pdf_li(light))
    }

    /// The probability with which [`LightTable::sample`] draws `light`, which there must be.
    pub fn pmf(self, light: u32) -> Pmf {
        Pmf(self.alias[light as usize].pmf)
    }

    /// The same reservoir; samples of a light without extent become one and the same, so that who reuses them can tell.
    pub fn canonical(self, reservoir: StoredReservoir) -> StoredReservoir {
        let LightSample { light, uv } = reservoir.sample;
        let uv = if self.lights.has_extent(light) { uv } else { 0 };
        StoredReservoir { sample: LightSample { light, uv }, ..reservoir }
    }

    /// `sample` as seen from `receiver`; dark for a sample of no light.
    pub fn incident(self, sample: LightSample, receiver: Vec3) -> Incident {
        self.lights.incident(sample, receiver)
    }
}

#[cfg(not(target_arch = "spirv"))]
impl<'a> Lights<'a> {
    /// Lights without emissive textures.
    pub fn untextured(lights: &'a [Light]) -> Self {
        Lights { lights, features: u32::MAX }
    }
}

/// The alias table over the power of `lights`.
#[cfg(not(target_arch = "spirv"))]
pub fn build_alias_table(lights: &[Light]) -> Vec<AliasEntry> {
    let weights: Vec<f64> = lights.iter().map(|light| f64::from(light.power)).collect();
    alias_table::build(&weights)
}
