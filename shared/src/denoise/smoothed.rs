//! The mean of a surface point over frames.

use crate::frame::FrameConstants;
use crate::math::luminance;
use crate::reflected::Parts;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// Frames that a mean has at most where neither camera nor scene has changed.
const AT_REST: f32 = 256.0;
/// Of diffuse light while the camera moves.
const IN_MOTION: f32 = 64.0;
/// Of specular light while the camera moves, for a roughness of 1, and on the smoothest surface, which reflects something else with
/// each step.
const SPECULAR_IN_MOTION: f32 = 32.0;
const LEAST_SPECULAR: f32 = 4.0;
/// Where the scene has changed since the frame before.
const CHANGED: f32 = 8.0;
/// Of the mean that a new point takes over from the point that was nearest.
const ANOTHER_POINT: f32 = 2.0;
/// Frames of a mean weigh like a power of their number: reservoirs grow, so later ones are better.
const GROWTH: f32 = 3.0;

/// Light of a surface point, the mean over frames. 32 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Smoothed {
    /// Under an albedo of 1, nit.
    pub diffuse: Vec3,
    /// How many frames it is the mean of.
    pub diffuse_frames: f32,
    /// nit
    pub specular: Vec3,
    /// How many frames it is the mean of.
    pub specular_frames: f32,
}

impl Smoothed {
    /// As it counts in the next frame, for a point of `roughness`. `same_point`: it is the mean of that very point. `changed`: the
    /// scene is not what it was.
    pub fn lasting(self, frame: &FrameConstants, same_point: bool, changed: bool, roughness: f32) -> Self {
        let rests = frame.camera == frame.previous_camera;
        let most = if changed {
            CHANGED
        } else if rests {
            AT_REST
        } else {
            IN_MOTION
        };
        // At rest another point of the surface in the same pixel goes on with the pixel's mean.
        let goes_on = same_point || rests && !changed;
        let most = if goes_on { most } else { most.min(ANOTHER_POINT) };
        let most_specular =
            if rests { most } else { most.min(LEAST_SPECULAR.max(SPECULAR_IN_MOTION * roughness)) };
        Smoothed {
            diffuse_frames: self.diffuse_frames.min(most),
            specular_frames: self.specular_frames.min(most_specular),
            ..self
        }
    }

    /// One frame more.
    pub fn with(self, fresh: Parts) -> Self {
        let (diffuse_frames, specular_frames) = (self.diffuse_frames + 1.0, self.specular_frames + 1.0);
        Smoothed {
            diffuse: self.diffuse + (fresh.diffuse - self.diffuse) * share(diffuse_frames),
            diffuse_frames,
            specular: self.specular + (fresh.specular - self.specular) * share(specular_frames),
            specular_frames,
        }
    }
}

/// Of frame number `frames` in a mean: weights of 1, 3, 6, 10 ...
pub fn share(frames: f32) -> f32 {
    GROWTH / (frames + GROWTH - 1.0)
}

/// `mean` (nit), its luminance brought into the range from `low` to `high` of what is seen around it now: light that was switched off is
/// gone with it.
pub fn clamped(mean: Vec3, low: f32, high: f32) -> Vec3 {
    let strength = luminance(mean);
    if strength > high {
        mean * (high / strength)
    } else if strength < low && strength > 0.0 {
        mean * (low / strength)
    } else {
        mean
    }
}
