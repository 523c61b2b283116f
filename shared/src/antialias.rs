//! Antialiasing of a picture over time, for display: never in what is measured.
//!
//! A frame sees each pixel through one place in it. At rest that place wanders ([`crate::passes::points::place_at_rest`]), and the mean
//! over frames is the picture behind a filter a little wider than a pixel ([`filter`]). Means that are measured draw places like a filter
//! (`PixelFilter`), and all their frames weigh the same. What moves takes its mean along, as far as the pixels around bear it out ([`Bounds`]; Karis 2014, "High Quality Temporal Supersampling"; Salvi 2016, "An Excursion in Temporal
//! Supersampling").

#[cfg(not(target_arch = "spirv"))]
use crate::math::pack_place;
use crate::rng::unit_f32;
use glam::{IVec2, UVec2, Vec2, Vec3, Vec4};
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float;

/// Of the filter, pixels.
const DEVIATION: f32 = 0.45;
/// It ends so far from the center along each axis, pixels.
const RADIUS: f32 = 1.0;
/// Of the sum of weights of a pixel and its neighbors over all places: the filter's integral.
pub const MEAN_WEIGHT: f32 = 1.2064;
/// Of the light around a pixel: from where on a mean is one of what is gone.
const DEVIATIONS: f32 = 1.25;

/// Weight of light at `offset` (pixels) from a pixel's center: a Gaussian.
pub fn filter(offset: Vec2) -> f32 {
    if offset.abs().max_element() > RADIUS {
        return 0.0;
    }
    (-offset.length_squared() / (2.0 * DEVIATION * DEVIATION)).exp()
}

/// What a mean over frames weighs light with, by how far from a pixel's center it is seen. Separable; none reaches farther than a pixel
/// along an axis.
#[cfg(not(target_arch = "spirv"))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PixelFilter {
    /// The pixel, evenly.
    Box,
    /// [`filter`].
    Gaussian,
    /// Four terms of cosines over 1.5 pixels (Harris 1978).
    BlackmanHarris,
}

#[cfg(not(target_arch = "spirv"))]
impl PixelFilter {
    /// The place in its pixel through which each looks in frame number `frame` of a mean, packed: drawn like the filter (filter
    /// importance sampling: the mean over frames is the filtered picture, and all frames weigh the same), evenly (the sequence R2).
    pub fn place(self, frame: u32) -> u32 {
        pack_place(0.5 + quasirandom(frame).map(|u| self.offset(u)))
    }

    /// Along an axis, `x` pixels from the center; not normalized.
    fn weight(self, x: f32) -> f32 {
        use std::f32::consts::TAU;
        match self {
            PixelFilter::Box => f32::from(x.abs() <= 0.5),
            PixelFilter::Gaussian => filter(Vec2::new(x, 0.0)),
            PixelFilter::BlackmanHarris if x.abs() > 0.75 => 0.0,
            PixelFilter::BlackmanHarris => {
                let term = |k: f32, factor: f32| factor * (k * TAU * (x / 1.5)).cos();
                0.35875 + term(1.0, 0.48829) + term(2.0, 0.14128) + term(3.0, 0.01168)
            }
        }
    }

    /// Where the share `u` of the filter lies on one side along an axis, pixels from the center.
    fn offset(self, u: f32) -> f32 {
        // As fine as places are packed.
        const STEPS: i32 = 2048;
        let at = |step: i32| (step as f32 + 0.5) / STEPS as f32 * RADIUS;
        let weight = |step: i32| f64::from(self.weight(at(step)));
        let mut left = f64::from(u) * (-STEPS..STEPS).map(weight).sum::<f64>();
        let passes = |step: &i32| {
            left -= weight(*step);
            left < 0.0
        };
        at((-STEPS..STEPS).find(passes).unwrap_or(STEPS - 1))
    }
}

/// Point number `i` of the sequence R2 in the unit square (Roberts 2018, "The Unreasonable Effectiveness of Quasirandom Sequences").
pub fn quasirandom(i: u32) -> Vec2 {
    // 1/g and 1/g^2, g^3 = g + 1, in steps of 2^-32: whole numbers wrap around.
    let along = |step: u32| unit_f32(i.wrapping_mul(step).wrapping_add(1 << 31));
    Vec2::new(along(0xc13f_a9a9), along(0x91e1_0da6))
}

/// How light lies around a pixel.
#[derive(Clone, Copy, Debug, Default)]
pub struct Bounds {
    sum: Vec3,
    squares: Vec3,
    count: f32,
}

impl Bounds {
    /// One pixel more.
    pub fn add(&mut self, light: Vec3) {
        self.sum += light;
        self.squares += light * light;
        self.count += 1.0;
    }

    /// `light`, brought into the box that holds most of what was added: toward its middle, so that colors stay between those seen.
    pub fn hold(&self, light: Vec3) -> Vec3 {
        let middle = self.sum / self.count;
        let variance = (self.squares / self.count - middle * middle).max(Vec3::ZERO);
        let half = DEVIATIONS * Vec3::new(variance.x.sqrt(), variance.y.sqrt(), variance.z.sqrt());
        let off = light - middle;
        let outside = (off.abs() / half.max(Vec3::splat(1e-30))).max_element();
        if outside > 1.0 { middle + off / outside } else { light }
    }
}

/// `picture` of `size` at `place` (pixels, within it) by the cubic of Catmull and Rom, which keeps what a mean over many frames would
/// blur away; the number in w from the nearest pixel.
pub fn sample(picture: &[Vec4], size: UVec2, place: Vec2) -> Vec4 {
    let corner = (place - 0.5).floor();
    let t = place - 0.5 - corner;
    let (x, y) = (cubic(t.x), cubic(t.y));
    let last = size.as_ivec2() - 1;
    let mut light = Vec3::ZERO;
    let mut i = 0;
    while i < 16 {
        let pixel = (corner.as_ivec2() + IVec2::new(i % 4 - 1, i / 4 - 1)).clamp(IVec2::ZERO, last);
        let weight = pick(x, i % 4) * pick(y, i / 4);
        light += weight * picture[(pixel.y * size.x as i32 + pixel.x) as usize].truncate();
        i += 1;
    }
    let nearest = place.as_ivec2().clamp(IVec2::ZERO, last);
    light.max(Vec3::ZERO).extend(picture[(nearest.y * size.x as i32 + nearest.x) as usize].w)
}

/// Weights of four points in a row at `t` between the second and the third.
fn cubic(t: f32) -> Vec4 {
    let (t2, t3) = (t * t, t * t * t);
    Vec4::new(
        -0.5 * t + t2 - 0.5 * t3,
        1.0 - 2.5 * t2 + 1.5 * t3,
        0.5 * t + 2.0 * t2 - 1.5 * t3,
        0.5 * t3 - 0.5 * t2,
    )
}

/// Number `i`; shaders can't index a vector.
fn pick(v: Vec4, i: i32) -> f32 {
    match i {
        0 => v.x,
        1 => v.y,
        2 => v.z,
        _ => v.w,
    }
}

#[cfg(test)]
mod tests;
