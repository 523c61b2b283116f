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
use glam::{IVec2, UVec2, Vec2, Vec3};
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
    let bounced = at.is(variant::BOUNCED);
    let light =
        Light { frame, bounced, direct_diffuse, direct_specular, indirect_diffuse, indirect_specular };
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
                light.hold(at.pixel, &mut mean);
            }
        }
    }
    let smoothed = mean.with(light.at(own));
    let filtered = Filtered::new(
        PackedGuide::new(&texel, &surface, frame.camera.forward),
        luminance(smoothed.diffuse),
        smoothed.diffuse,
        smoothed.specular,
    );
    (smoothed, filtered)
}

/// Light of this frame that reaches the eye over what it sees, once or more often reflected.
#[derive(Clone, Copy)]
struct Light<'a> {
    frame: &'a FrameConstants,
    bounced: bool,
    direct_diffuse: &'a [Vec3],
    direct_specular: &'a [Vec3],
    indirect_diffuse: &'a [Vec3],
    indirect_specular: &'a [Vec3],
}

impl Light<'_> {
    /// Of pixel number `i`.
    fn at(self, i: usize) -> Parts {
        let mut parts = Parts { diffuse: self.direct_diffuse[i], specular: self.direct_specular[i] };
        if self.bounced {
            parts += Parts { diffuse: self.indirect_diffuse[i], specular: self.indirect_specular[i] };
        }
        parts
    }

    /// Leaves of `mean` what the 5 x 5 pixels around `pixel` bear out.
    fn hold(self, pixel: UVec2, mean: &mut Smoothed) {
        let (mut sum, mut squares, mut count) = (Vec2::ZERO, Vec2::ZERO, 0.0);
        let mut i = 0;
        while i < 25 {
            let at = pixel.as_ivec2() + IVec2::new(i % 5 - 2, i / 5 - 2);
            if at.cmpge(IVec2::ZERO).all() && at.cmplt(self.frame.size.as_ivec2()).all() {
                let Parts { diffuse, specular } = self.at(self.frame.pixel_index(at.as_uvec2()) as usize);
                let here = Vec2::new(luminance(diffuse), luminance(specular));
                sum += here;
                squares += here * here;
                count += 1.0;
            }
            i += 1;
        }
        let middle = sum / count;
        let variance = (squares / count - middle * middle).max(Vec2::ZERO);
        let spread = DEVIATIONS * Vec2::new(variance.x.sqrt(), variance.y.sqrt());
        let (low, high) = (middle - spread, middle + spread);
        mean.diffuse = clamped(mean.diffuse, low.x, high.x);
        mean.specular = clamped(mean.specular, low.y, high.y);
    }
}
