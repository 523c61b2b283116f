//! An à-trous filter between pixels that see one surface.

use crate::camera::Camera;
use crate::denoise::{Filtered, Guide, Smoothed, colored};
use crate::math::luminance;
use crate::passes::At;
use crate::resources::Extent;
use crate::surface::GBufferTexel;
use glam::{IVec2, Vec3};
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float;

/// Frames after which the noise of a mean is below its deviation from pixel to pixel, which has shadows and highlights in it too.
const YOUNG: f32 = 16.0;

/// Binomial weights of a pixel, of its neighbors along an axis and along a diagonal.
const KERNEL: [f32; 3] = [0.25, 0.125, 0.0625];
/// Least variance, nit^2: nothing is divided by 0.
const LEAST_VARIANCE: f32 = 1e-30;

/// A pixel and what it sees, among its neighbors.
struct Center<'a> {
    at: At<'a>,
    filtering: &'a [Filtered],
    guide: Guide,
    /// Of a pixel at a distance of 1.
    width: f32,
}

/// A pixel as its neighbor sees it.
struct Neighbor {
    filtered: Filtered,
    /// How much of one surface both see.
    similarity: f32,
}

impl<'a> Center<'a> {
    fn new(at: At<'a>, filtering: &'a [Filtered], own: &Filtered) -> Self {
        let Camera { up, .. } = at.frame.camera;
        let guide = Guide::new(own.guide(), &at.frame.camera, at.pixel, at.frame.size);
        Center { at, filtering, guide, width: 2.0 * up.length() / at.frame.size.y as f32 }
    }

    /// The pixel `offset` away.
    fn neighbor(&self, offset: IVec2) -> Neighbor {
        let frame = self.at.frame;
        let pixel = self.at.pixel.as_ivec2() + offset;
        if pixel.cmpge(IVec2::ZERO).all() && pixel.cmplt(frame.size.as_ivec2()).all() {
            let pixel = pixel.as_uvec2();
            let filtered = self.filtering[frame.pixel_index(pixel) as usize];
            if !filtered.is_empty() {
                let guide = Guide::new(filtered.guide(), &frame.camera, pixel, frame.size);
                let apart = offset.abs().max_element() as f32;
                let similarity = not_negligible(self.guide.similarity(&guide, self.width, apart));
                return Neighbor { filtered, similarity };
            }
        }
        Neighbor { filtered: Filtered::default(), similarity: 0.0 }
    }
}

/// How far the luminance of a pixel's mean may be from the truth: its standard deviation among pixels around that see the same
/// surface, more the younger the mean is.
pub fn denoise_variance(at: At<'_>, smoothed: &[Smoothed], filtering: &[Filtered]) -> Filtered {
    let own = filtering[at.index(Extent::Pixels)];
    if own.is_empty() {
        return own;
    }
    let center = Center::new(at, filtering, &own);
    let (mut sum, mut weights, mut squares) = (0.0, 1.0, 0.0);
    let mut i = 0;
    while i < 9 {
        if i != 4 {
            let Neighbor { filtered, similarity } = center.neighbor(2 * IVec2::new(i % 3 - 1, i / 3 - 1));
            // Relative to this pixel's: sums of squares of large numbers would cancel.
            let more = filtered.luminance() - own.luminance();
            sum += similarity * more;
            squares += similarity * more * more;
            weights += similarity;
        }
        i += 1;
    }
    let mean = sum / weights;
    let variance = (squares / weights - mean * mean).max(0.0);
    let frames = smoothed[at.index(Extent::Pixels)].diffuse_frames;
    own.with_deviation((variance * (YOUNG / frames)).sqrt())
}

/// 3 x 3 pixels, 2^iteration apart. Luminance is exchanged between pixels, as much as one gets the other loses: the sum of light stays.
/// Colors are means.
pub fn denoise_spatial(at: At<'_>, filtering: &[Filtered]) -> Filtered {
    let own = filtering[at.index(Extent::Pixels)];
    if own.is_empty() {
        return own;
    }
    let center = Center::new(at, filtering, &own);
    let step = 1 << at.constants.iteration;
    let variance = own.deviation() * own.deviation();
    let (mut change, mut given, mut variances) = (0.0, 0.0, 0.0);
    let mut weights = KERNEL[0];
    let (mut diffuse, mut specular) = (KERNEL[0] * own.diffuse(), KERNEL[0] * own.specular());
    let mut i = 0;
    while i < 9 {
        if i != 4 {
            let offset = IVec2::new(i % 3 - 1, i / 3 - 1);
            let Neighbor { filtered, similarity } = center.neighbor(offset * step);
            let weight = similarity * if offset.x * offset.y == 0 { KERNEL[1] } else { KERNEL[2] };
            weights += weight;
            diffuse += weight * filtered.diffuse();
            specular += weight * filtered.specular();
            let (more, other) =
                (filtered.luminance() - own.luminance(), filtered.deviation() * filtered.deviation());
            let explained = (0.5 * (variance + other)).max(LEAST_VARIANCE).sqrt();
            let weight = not_negligible(weight * (-more.abs() / explained).exp());
            change += weight * more;
            given += weight;
            variances += weight * weight * other;
        }
        i += 1;
    }
    let kept = 1.0 - given;
    Filtered::new(own.guide(), own.luminance() + change, diffuse / weights, specular / weights)
        .with_deviation((kept * kept * variance + variances).sqrt())
}

/// A weight, unless it is next to nothing: what is black stays black.
fn not_negligible(weight: f32) -> f32 {
    if weight < 1e-4 { 0.0 } else { weight }
}

/// Radiance, nit: emission + albedo x diffuse + specular.
pub fn resolve_denoised(
    at: At<'_>,
    gbuffer: &[GBufferTexel],
    emission: &[Vec3],
    smoothed: &[Smoothed],
    filtering: &[Filtered],
) -> Vec3 {
    let i = at.index(Extent::Pixels);
    let (mean, filtered) = (smoothed[i], filtering[i]);
    let diffuse = colored(filtered.luminance(), filtered.diffuse(), mean.diffuse);
    let specular = colored(luminance(mean.specular), filtered.specular(), mean.specular);
    emission[i] + (gbuffer[i].diffuse() * diffuse + specular)
}
