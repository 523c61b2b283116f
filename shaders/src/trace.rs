//! The only two ways a ray leaves a shader.
//!
//! Loops around a trace are `while` loops over integers: NVIDIA's driver (580.159) loses or repeats iterations of what rust-gpu 0.10
//! makes of `for .. in range` when some rays of a warp are skipped (seen as lights added twice or never by `reference`).

use shared::glam::Vec3;
use shared::interface::{HitPayload, ShadowPayload, miss};
use shared::shadow::ShadowRay;
use spirv_std::ray_tracing::{AccelerationStructure, RayFlags};

/// Far enough for every scene, and far from overflow.
const T_MAX: f32 = 1e30;

/// The nearest surface from `origin` along `direction` (unit), into `payload`.
pub fn trace_primary(tlas: &AccelerationStructure, origin: Vec3, direction: Vec3, payload: &mut HitPayload) {
    *payload = HitPayload::default();
    // SAFETY: `payload` is a ray payload of the type that the closest-hit and miss shaders declare.
    unsafe {
        tlas.trace_ray(
            RayFlags::OPAQUE,
            0xff,
            0,
            0,
            miss::PRIMARY as i32,
            origin,
            0.0,
            direction,
            T_MAX,
            payload,
        );
    }
}

/// Is nothing between the ends of `ray`?
pub fn trace_shadow(tlas: &AccelerationStructure, ray: ShadowRay, payload: &mut ShadowPayload) -> bool {
    payload.visible = 0;
    let flags = RayFlags::OPAQUE | RayFlags::TERMINATE_ON_FIRST_HIT | RayFlags::SKIP_CLOSEST_HIT_SHADER;
    // SAFETY: `payload` is a ray payload of the type that the shadow miss shader declares; no hit shader runs.
    unsafe {
        tlas.trace_ray(flags, 0xff, 0, 0, miss::SHADOW as i32, ray.origin, 0.0, ray.direction, 1.0, payload);
    }
    payload.visible != 0
}
