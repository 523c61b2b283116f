//! Antialiasing over time: the mean of each pixel over the places in it that frames have looked through.

use super::{At, variant};
use crate::antialias::{Bounds, MEAN_WEIGHT, filter, sample};
use crate::denoise::share;
use crate::math::unpack_place;
use crate::motion::InstanceMotion;
use crate::resampling::reprojection::Before;
use crate::resources::Extent;
use crate::surface::GBufferTexel;
use glam::{IVec2, UVec2, Vec2, Vec3, Vec4};

/// Frames that a mean has at most where neither camera nor scene has changed.
const AT_REST: f32 = 4096.0;
/// The same otherwise: more are smoother, and lose more light where the pixels around don't bear them out.
const IN_MOTION: f32 = 12.0;

/// Radiance of a pixel, nit, as its mean with the number of its frames, and alone. `aliased`: of this frame, each pixel through one
/// place.
pub fn antialias(
    at: At<'_>,
    gbuffer: &[GBufferTexel],
    motions: &[InstanceMotion],
    aliased: &[Vec3],
    previous_antialiased: &[Vec4],
) -> (Vec4, Vec3) {
    let (frame, own) = (at.frame, at.index(Extent::Pixels));
    let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
    let mut bounds = Bounds::default();
    let mut nearest = at.pixel;
    let mut depth = f32::INFINITY;
    let mut i = 0;
    while i < 9 {
        let offset = IVec2::new(i % 3 - 1, i / 3 - 1);
        let pixel = at.pixel.as_ivec2() + offset;
        if pixel.cmpge(IVec2::ZERO).all() && pixel.cmplt(frame.size.as_ivec2()).all() {
            let index = frame.pixel_index(pixel.as_uvec2()) as usize;
            let (texel, light) = (gbuffer[index], aliased[index]);
            let weight = filter(unpack_place(texel.place()) + offset.as_vec2() - 0.5);
            sum += weight * light;
            weights += weight;
            bounds.add(light);
            if !texel.is_empty() && texel.distance() < depth {
                depth = texel.distance();
                nearest = pixel.as_uvec2();
            }
        }
        i += 1;
    }
    let seen = sum / weights;
    let moves = at.is(variant::MOVING) || frame.camera != frame.previous_camera;
    let mut mean = Vec4::ZERO;
    if at.is(variant::ANTIALIASED) {
        if moves {
            let before = at.pixel.as_vec2() + 0.5
                - motion(at, nearest, &gbuffer[frame.pixel_index(nearest) as usize], motions);
            if before.cmpge(Vec2::ZERO).all() && before.cmplt(frame.size.as_vec2()).all() {
                let found = sample(previous_antialiased, frame.size, before);
                mean = bounds.hold(found.truncate()).extend(found.w.min(IN_MOTION));
            }
        } else {
            mean = previous_antialiased[own];
            mean.w = mean.w.min(AT_REST);
        }
    }
    let frames = mean.w + 1.0;
    // Frames whose places lie far from the center say less.
    let part = if mean.w > 0.0 { (share(frames) * weights / MEAN_WEIGHT).min(1.0) } else { 1.0 };
    let radiance = mean.truncate() + (seen - mean.truncate()) * part;
    (radiance.extend(frames), radiance)
}

/// How far what `pixel` sees has moved on the picture since the frame before, pixels.
fn motion(at: At<'_>, pixel: UVec2, texel: &GBufferTexel, motions: &[InstanceMotion]) -> Vec2 {
    let frame = at.frame;
    if texel.is_empty() {
        // Very far away.
        let center = pixel.as_vec2() + 0.5;
        return center
            - frame.previous_camera.project(frame.camera.direction(center, frame.size), frame.size);
    }
    let surface = texel.unpack(at.features, &frame.camera, pixel, frame.size);
    let mut then = Before::still(frame, &surface);
    if at.is(variant::MOVING) {
        then = then.moved(&surface, &motions[texel.instance() as usize]);
    }
    pixel.as_vec2() + unpack_place(texel.place()) - frame.previous_camera.project(then.relative, frame.size)
}
