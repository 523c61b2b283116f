//! Pictures of what a frame is made of, for eyes: the viewer's views, and the running mean of its frames.

use crate::frame::FrameConstants;
use crate::material::{Material, NO_TEXTURE, flag, slot};
use crate::math::{luminance, safe_ratio};
use crate::reservoir::StoredReservoir;
use crate::surface::GBufferTexel;
use crate::tonemap;
use glam::Vec3;
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float;

/// What a view shows.
pub mod kind {
    /// Radiance, tone mapped.
    pub const RADIANCE: u32 = 0;
    /// The running mean, tone mapped.
    pub const MEAN: u32 = 1;
    /// Distance to the camera, in shades of the scale.
    pub const DISTANCE: u32 = 2;
    /// Shading normals.
    pub const NORMAL: u32 = 3;
    /// Normals of triangles.
    pub const GEOMETRIC_NORMAL: u32 = 4;
    /// Albedo of the diffuse lobe.
    pub const DIFFUSE: u32 = 5;
    /// Reflectance at normal incidence.
    pub const F0: u32 = 6;
    /// Roughness.
    pub const ROUGHNESS: u32 = 7;
    /// A color for each instance.
    pub const INSTANCE: u32 = 8;
    /// A color for each light that a reservoir holds.
    pub const LIGHT: u32 = 9;
    /// W of the first reservoir.
    pub const CONTRIBUTION_WEIGHT: u32 = 10;
    /// M of the first reservoir.
    pub const CONFIDENCE: u32 = 11;
    /// Does the survivor's light arrive?
    pub const VISIBILITY: u32 = 12;
    /// Features of the material.
    pub const FEATURES: u32 = 13;
    /// Difference from the reference.
    pub const DIFFERENCE: u32 = 14;
    /// The light cell that the pixel asked in this frame.
    pub const CELL: u32 = 15;
    /// How much of the light of the pixel's sample that cell believes to arrive.
    pub const BELIEVED: u32 = 16;
}

/// Colors of [`kind::VISIBILITY`]: the pixel's light reaches it, is hidden, or there is none.
pub const VISIBLE: Vec3 = Vec3::new(0.95, 0.9, 0.7);
/// The light is hidden.
pub const HIDDEN: Vec3 = Vec3::new(0.75, 0.1, 0.1);
/// There is no light.
pub const NO_SAMPLE: Vec3 = Vec3::new(0.1, 0.1, 0.2);

/// Powers of two that the heat of W and of M covers.
pub const WEIGHT_RANGE: [f32; 2] = [-20.0, 20.0];
/// Of M.
pub const CONFIDENCE_RANGE: [f32; 2] = [0.0, 16.0];
/// The relative difference that has the full color.
pub const LARGEST_DIFFERENCE: f32 = 0.5;

/// What is known of a pixel.
#[derive(Clone, Copy)]
pub struct Pixel {
    /// What it sees.
    pub texel: GBufferTexel,
    /// The first of its reservoirs.
    pub reservoir: StoredReservoir,
    /// What the survivor would contribute unhidden, nit.
    pub unshadowed: Vec3,
    /// The place of its light cell; and the fraction of its light that this believes to arrive. 0 without cells.
    pub cell: u32,
    /// That fraction.
    pub believed: f32,
    /// Of the frame, nit; the mean over frames; and of the reference.
    pub radiance: Vec3,
    /// Over frames, nit.
    pub mean: Vec3,
    /// nit
    pub reference: Vec3,
}

impl Pixel {
    /// A pixel of which no more is known.
    pub fn new(texel: GBufferTexel, radiance: Vec3) -> Self {
        Pixel {
            texel,
            reservoir: StoredReservoir::default(),
            unshadowed: Vec3::ZERO,
            cell: 0,
            believed: 0.0,
            radiance,
            mean: radiance,
            reference: Vec3::ZERO,
        }
    }
}

/// (n - 1)/n of the mean of n - 1 frames and 1/n of the n-th. In f32 its rounding error grows like sqrt(n) ulp: far below
/// the noise that is left after n frames.
pub fn running_mean(mean: Vec3, radiance: Vec3, count: u32) -> Vec3 {
    if count <= 1 { radiance } else { mean + (radiance - mean) / count as f32 }
}

/// Display value (encoded, 0..=1) of `view`, one of [`kind`], with `scale` its measure (m, for the distance).
pub fn color(view: u32, scale: f32, frame: &FrameConstants, pixel: &Pixel) -> Vec3 {
    let texel = &pixel.texel;
    let reservoir = &pixel.reservoir;
    let has_light = reservoir.contribution_weight > 0.0;
    match view {
        kind::RADIANCE => tonemap::display(pixel.radiance, frame.exposure),
        kind::MEAN => tonemap::display(pixel.mean, frame.exposure),
        kind::DIFFERENCE => difference_color(pixel.mean, pixel.reference, frame.exposure),
        _ if texel.is_empty() => Vec3::ZERO,
        kind::DISTANCE => Vec3::splat(safe_ratio(scale, scale + texel.distance())),
        kind::NORMAL => texel.normal() * 0.5 + 0.5,
        kind::GEOMETRIC_NORMAL => texel.geometric_normal() * 0.5 + 0.5,
        kind::DIFFUSE => tonemap::encode(texel.diffuse()),
        kind::F0 => tonemap::encode(texel.f0()),
        kind::ROUGHNESS => Vec3::splat(texel.roughness()),
        kind::INSTANCE => id_color(texel.instance()),
        kind::CONFIDENCE => heat(place((1.0 + reservoir.confidence).log2(), CONFIDENCE_RANGE)),
        kind::VISIBILITY => visibility_color(has_light, pixel),
        kind::CELL if frame.settings.cells == 0 => Vec3::ZERO,
        kind::CELL => id_color(pixel.cell),
        kind::BELIEVED => heat(pixel.believed),
        _ if !has_light => Vec3::ZERO,
        kind::LIGHT => id_color(reservoir.sample.light),
        _ => heat(place(reservoir.contribution_weight.log2(), WEIGHT_RANGE)),
    }
}

/// Black, red, yellow, white for 0 to 1.
pub fn heat(t: f32) -> Vec3 {
    let t = 3.0 * t.clamp(0.0, 1.0);
    Vec3::new(t.min(1.0), (t - 1.0).clamp(0.0, 1.0), (t - 2.0).clamp(0.0, 1.0))
}

/// Blue, black, red for -1 to 1.
pub fn diverging(t: f32) -> Vec3 {
    let t = t.clamp(-1.0, 1.0);
    let (dark, bright) = ((-t).max(0.0), t.max(0.0));
    Vec3::new(bright, 0.55 * (dark + bright) * (dark + bright), dark)
}

/// Too dark is blue, too bright is red; what would be shown black on both sides is no difference.
pub fn difference_color(radiance: Vec3, reference: Vec3, exposure: f32) -> Vec3 {
    let (x, truth) = (luminance(radiance), luminance(reference));
    // One percent of white.
    let floor = safe_ratio(0.01, exposure);
    diverging(safe_ratio(x - truth, truth + floor) / LARGEST_DIFFERENCE)
}

fn visibility_color(has_light: bool, pixel: &Pixel) -> Vec3 {
    let unshadowed = luminance(pixel.unshadowed);
    // Visibility reuse and shading leave nothing of a hidden sample. A surface that shines by itself looks lit.
    let lit = luminance(pixel.radiance) >= 0.5 * unshadowed;
    if !has_light {
        // A hidden survivor keeps its confidence.
        return if pixel.reservoir.confidence > 0.0 { HIDDEN } else { NO_SAMPLE };
    }
    if unshadowed > 0.0 && !lit { HIDDEN } else { VISIBLE }
}

/// Which features of the scene a material uses: textures red, normal map green, alpha blue, emission white on top.
pub fn features_color(material: &Material) -> Vec3 {
    let textured = material.textures[slot::BASE_COLOR] != NO_TEXTURE
        || material.textures[slot::REFLECTANCE] != NO_TEXTURE
        || material.textures[slot::EMISSIVE] != NO_TEXTURE;
    let mapped = material.textures[slot::NORMAL] != NO_TEXTURE;
    let alpha = material.has(flag::MASK) || material.has(flag::BLEND);
    let on = |yes: bool| if yes { 0.8 } else { 0.15 };
    let base = Vec3::new(on(textured), on(mapped), on(alpha));
    if material.emission != Vec3::ZERO { 0.5 * (base + 1.0) } else { base }
}

/// A color that neighbors in number do not share.
pub fn id_color(id: u32) -> Vec3 {
    let hash = id.wrapping_add(1).wrapping_mul(0x9e37_79b9);
    let hash = (hash ^ (hash >> 15)).wrapping_mul(0x85eb_ca6b);
    let hash = hash ^ (hash >> 13);
    let byte = |shift: u32| ((hash >> shift) & 0xff) as f32 / 255.0;
    Vec3::new(byte(0), byte(8), byte(16)) * 0.8 + 0.2
}

fn place(x: f32, range: [f32; 2]) -> f32 {
    safe_ratio(x - range[0], range[1] - range[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_running_mean_is_the_mean() {
        let values = [1.0f32, 5.0, 2.0, 8.0, 4.0];
        let mut mean = Vec3::splat(1e9);
        for (i, &x) in values.iter().enumerate() {
            mean = running_mean(mean, Vec3::new(x, 2.0 * x, 0.0), i as u32 + 1);
        }
        assert!((mean - Vec3::new(4.0, 8.0, 0.0)).abs().max_element() < 1e-5);
    }

    /// The error of a long mean stays near the f32 that holds it.
    #[test]
    fn long_means_do_not_drift() {
        let mut mean = Vec3::ZERO;
        let mut sum = 0.0f64;
        for i in 0..100_000u32 {
            let x = (i.wrapping_mul(2_654_435_761) >> 8) as f32 / (1 << 24) as f32;
            sum += f64::from(x);
            mean = running_mean(mean, Vec3::splat(x), i + 1);
        }
        assert!((f64::from(mean.x) - sum / 100_000.0).abs() < 1e-5);
    }

    #[test]
    fn heat_rises_and_differences_have_a_sign() {
        assert_eq!((heat(-1.0), heat(2.0)), (Vec3::ZERO, Vec3::ONE));
        assert!(
            (1..=100).all(|i| luminance(heat(i as f32 / 100.0)) > luminance(heat((i - 1) as f32 / 100.0)))
        );
        let (dark, equal, bright) = (
            difference_color(Vec3::ONE, Vec3::splat(2.0), 1.0),
            difference_color(Vec3::ONE, Vec3::ONE, 1.0),
            difference_color(Vec3::splat(2.0), Vec3::ONE, 1.0),
        );
        assert!(dark.z > dark.x && bright.x > bright.z && equal == Vec3::ZERO);
        // A pixel that is black on screen either way.
        assert!(difference_color(Vec3::splat(1e-6), Vec3::ZERO, 1.0).max_element() < 0.01);
    }

    #[test]
    fn ids_have_colors_of_their_own() {
        let colors: Vec<Vec3> = (0..1000).map(id_color).collect();
        assert!(colors.windows(2).all(|w| (w[0] - w[1]).length() > 0.02));
    }
}
