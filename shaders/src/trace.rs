//! The only ways a ray leaves a shader.
//!
//! Loops around a trace are `while` loops over integers: NVIDIA's driver (580.159) loses or repeats iterations of what rust-gpu 0.10
//! makes of `for .. in range` when some rays of a warp are skipped (seen as lights added twice or never by `reference`).

use shared::frame::features;
use shared::glam::Vec3;
use shared::interface::{HitPayload, ShadowPayload, hit_group, miss};
use shared::passes::{Question, Visibility};
use shared::shadow::ShadowRay;
use spirv_std::ray_tracing::{AccelerationStructure, RayFlags};

/// Far enough for every scene, and far from overflow.
const T_MAX: f32 = 1e30;

/// Where nothing is transparent no any-hit shader is bound, and the hardware need not look for one.
fn opacity(features: u32) -> RayFlags {
    if features & features::ALPHA == 0 { RayFlags::OPAQUE } else { RayFlags::NONE }
}

/// Rays from the eye.
pub struct Eye<'a> {
    pub tlas: &'a AccelerationStructure,
    pub payload: &'a mut HitPayload,
}

impl Eye<'_> {
    /// The nearest surface from `origin` along `direction` (unit); single-sided ones only from their front. `key`: of
    /// [`shared::alpha`].
    pub fn trace(self, features: u32, origin: Vec3, direction: Vec3, key: u32) -> HitPayload {
        *self.payload = HitPayload { key, ..HitPayload::default() };
        // Instances of double-sided primitives switch culling off.
        let flags = opacity(features) | RayFlags::CULL_BACK_FACING_TRIANGLES;
        let (miss, payload) = (miss::PRIMARY as i32, self.payload);
        // SAFETY: `payload` is a ray payload of the type that the hit and miss shaders declare.
        unsafe { self.tlas.trace_ray(flags, 0xff, 0, 0, miss, origin, 0.0, direction, T_MAX, payload) };
        *payload
    }
}

/// Is nothing between the ends of `ray`? Both sides of everything block it, whatever its material says: a thin wall has
/// a shadow. `key`: of [`shared::alpha`].
fn trace_shadow(
    tlas: &AccelerationStructure,
    features: u32,
    ray: ShadowRay,
    key: u32,
    payload: &mut ShadowPayload,
) -> bool {
    *payload = ShadowPayload { visible: 0, key };
    let flags = opacity(features) | RayFlags::TERMINATE_ON_FIRST_HIT | RayFlags::SKIP_CLOSEST_HIT_SHADER;
    // SAFETY: `payload` is a ray payload of the type that the shadow hit and miss shaders declare.
    unsafe {
        tlas.trace_ray(flags, 0xff, 0, 0, miss::SHADOW as i32, ray.origin, 0.0, ray.direction, 1.0, payload);
    }
    payload.visible != 0
}

/// Shadow rays.
pub struct Traced<'a> {
    pub features: u32,
    pub tlas: &'a AccelerationStructure,
    pub payload: &'a mut ShadowPayload,
}

impl Visibility for Traced<'_> {
    const TRACES: bool = true;

    fn sees(&mut self, _: Question, ray: ShadowRay, key: u32) -> bool {
        trace_shadow(self.tlas, self.features, ray, key, self.payload)
    }
}

/// Shadow rays, and rays that ask what they meet.
pub struct Nearest<'a> {
    pub features: u32,
    pub tlas: &'a AccelerationStructure,
    pub payload: &'a mut ShadowPayload,
    pub nearest: &'a mut HitPayload,
}

impl Visibility for Nearest<'_> {
    const TRACES: bool = true;

    fn sees(&mut self, _: Question, ray: ShadowRay, key: u32) -> bool {
        trace_shadow(self.tlas, self.features, ray, key, self.payload)
    }

    fn nearest(&mut self, origin: Vec3, direction: Vec3, key: u32) -> HitPayload {
        *self.nearest = HitPayload { key, ..HitPayload::default() };
        let (flags, group, miss) = (opacity(self.features), hit_group::NEAREST as i32, miss::PRIMARY as i32);
        let payload = &mut *self.nearest;
        // SAFETY: `payload` is a ray payload of the type that the hit and miss shaders declare.
        unsafe { self.tlas.trace_ray(flags, 0xff, group, 0, miss, origin, 0.0, direction, T_MAX, payload) };
        *self.nearest
    }
}

/// Shadow rays, now and in the previous frame.
pub struct Previous<'a> {
    pub features: u32,
    pub tlas: &'a AccelerationStructure,
    pub previous_tlas: &'a AccelerationStructure,
    pub payload: &'a mut ShadowPayload,
}

impl Visibility for Previous<'_> {
    const TRACES: bool = true;

    fn sees(&mut self, _: Question, ray: ShadowRay, key: u32) -> bool {
        trace_shadow(self.tlas, self.features, ray, key, self.payload)
    }

    fn saw(&mut self, _: Question, ray: ShadowRay, key: u32) -> bool {
        trace_shadow(self.previous_tlas, self.features, ray, key, self.payload)
    }
}
