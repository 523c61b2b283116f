//! The mean of each surface point over frames.

use crate::denoise::{Filtered, PackedGuide, Smoothed, clamped};
use crate::frame::FrameConstants;
use crate::math::luminance;
use crate::motion::InstanceMotion;
use crate::passes::temporal::{History, history_of};
use crate::passes::{At, Silent, variant};
use crate::points::Aim;
use crate::reflected::Parts;
use crate::resampling::reprojection::Before;
use crate::resources::Extent;
use crate::surface::GBufferTexel;
use glam::{IVec2, UVec2, Vec3};
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float;

/// Of the light around a pixel: a mean that differs by more standard deviations is one of light that is gone.
const DEVIATIONS: f32 = 2.0;

/// Light of this frame (nit, diffuse light under an albedo of 1) goes into its points' means.
#[allow(clippy::too_many_arguments)]
pub fn denoise_temporal(
    at: At<'_>,
    gbuffer: &[GBufferTexel],
    previous_gbuffer: &[GBufferTexel],
    aims: &[Aim],
    motions: &[InstanceMotion],
    direct_diffuse: &[Vec3],
    direct_specular: &[Vec3],
    indirect_diffuse: &[Vec3],
    indirect_specular: &[Vec3],
    previous_smoothed: &[Smoothed],
) -> (Smoothed, Filtered) {
    let (frame, own) = (at.frame, at.index(Extent::Pixels));
    let texel = gbuffer[own];
    if texel.is_empty() {
        return (Smoothed::default(), Filtered::default());
    }
    let mut fresh = Parts { diffuse: direct_diffuse[own], specular: direct_specular[own] };
    if at.is(variant::BOUNCED) {
        fresh += Parts { diffuse: indirect_diffuse[own], specular: indirect_specular[own] };
    }
    let surface = at.surface(&texel);
    let mut mean = Smoothed::default();
    if at.is(variant::DENOISED) {
        let changed = at.is(variant::MOVING);
        let mut then = Before::still(frame, &surface);
        if changed {
            then = then.moved(&surface, &motions[texel.instance() as usize]);
        }
        if let Some(History { pixel, lasts }) =
            history_of(at, &mut Silent, &surface, then, previous_gbuffer, aims)
        {
            let index = frame.pixel_index(pixel) as usize;
            let there =
                previous_gbuffer[index].unpack(at.features, &frame.previous_camera, pixel, frame.size);
            let same_point = lasts != 0 || there.is_same_point(&surface);
            mean = previous_smoothed[index].lasting(frame, same_point, changed, texel.roughness());
            if changed {
                mean.diffuse = near(frame, at.pixel, direct_diffuse, mean.diffuse);
                mean.specular = near(frame, at.pixel, direct_specular, mean.specular);
            }
        }
    }
    let smoothed = mean.with(fresh);
    let filtered = Filtered::new(
        PackedGuide::new(&texel, &surface, frame.camera.forward),
        luminance(smoothed.diffuse),
        smoothed.diffuse,
        smoothed.specular,
    );
    (smoothed, filtered)
}

/// `mean`, as far as the 5 x 5 pixels of `light` around `pixel` bear it out.
fn near(frame: &FrameConstants, pixel: UVec2, light: &[Vec3], mean: Vec3) -> Vec3 {
    let (mut sum, mut squares, mut count) = (0.0, 0.0, 0.0);
    let mut i = 0;
    while i < 25 {
        let at = pixel.as_ivec2() + IVec2::new(i % 5 - 2, i / 5 - 2);
        if at.cmpge(IVec2::ZERO).all() && at.cmplt(frame.size.as_ivec2()).all() {
            let here = luminance(light[frame.pixel_index(at.as_uvec2()) as usize]);
            sum += here;
            squares += here * here;
            count += 1.0;
        }
        i += 1;
    }
    let middle = sum / count;
    let spread = DEVIATIONS * (squares / count - middle * middle).max(0.0).sqrt();
    clamped(mean, middle - spread, middle + spread)
}
