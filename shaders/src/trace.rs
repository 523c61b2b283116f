//! The only three ways a ray leaves a shader.
//!
//! Loops around a trace are `while` loops over integers: NVIDIA's driver (580.159) loses or repeats iterations of what rust-gpu 0.10
//! makes of `for .. in range` when some rays of a warp are skipped (seen as lights added twice or never by `reference`).

use shared::alpha;
use shared::frame::features;
use shared::glam::Vec3;
use shared::interface::{HitPayload, ShadowPayload, hit_group, miss};
use shared::light::LightTable;
use shared::light::found::Emitters;
use shared::resampling::initial::{Fresh, Glance, Techniques};
use shared::rng::Rng;
use shared::shadow::ShadowRay;
use shared::surface::Surface;
use spirv_std::ray_tracing::{AccelerationStructure, RayFlags};

/// Far enough for every scene, and far from overflow.
const T_MAX: f32 = 1e30;

/// Where nothing is transparent no any-hit shader is bound, and the hardware need not look for one.
fn opacity(features: u32) -> RayFlags {
    if features & features::ALPHA == 0 { RayFlags::OPAQUE } else { RayFlags::NONE }
}

/// The nearest surface from `origin` along `direction` (unit), into `payload`; single-sided ones only from their front.
/// `key`: of [`shared::alpha`].
pub fn trace_primary(
    tlas: &AccelerationStructure,
    features: u32,
    origin: Vec3,
    direction: Vec3,
    key: u32,
    payload: &mut HitPayload,
) {
    *payload = HitPayload { key, ..HitPayload::default() };
    // Instances of double-sided primitives switch culling off.
    let flags = opacity(features) | RayFlags::CULL_BACK_FACING_TRIANGLES;
    // SAFETY: `payload` is a ray payload of the type that the hit and miss shaders declare.
    unsafe {
        tlas.trace_ray(flags, 0xff, 0, 0, miss::PRIMARY as i32, origin, 0.0, direction, T_MAX, payload);
    }
}

/// The nearest surface from `origin` along `direction` (unit) that surely is in the way, into `payload`: both sides of
/// everything, as for shadow rays. For passes whose rays are [`hit_group::NEAREST`]'s too.
fn trace_nearest(
    tlas: &AccelerationStructure,
    features: u32,
    origin: Vec3,
    direction: Vec3,
    payload: &mut HitPayload,
) {
    *payload = HitPayload { key: alpha::SURE_HITS_ONLY, ..HitPayload::default() };
    let (flags, group) = (opacity(features), hit_group::NEAREST as i32);
    // SAFETY: `payload` is a ray payload of the type that the hit and miss shaders declare.
    unsafe {
        tlas.trace_ray(flags, 0xff, group, 0, miss::PRIMARY as i32, origin, 0.0, direction, T_MAX, payload);
    }
}

/// Is nothing between the ends of `ray`? Both sides of everything block it, whatever its material says: a thin wall has
/// a shadow. `key`: of [`shared::alpha`].
pub fn trace_shadow(
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

/// Lets rays along the reflectance of `surface` look for lights, and adds what they find to `fresh`.
pub fn trace_glances(
    tlas: &AccelerationStructure,
    surface: &Surface,
    lights: LightTable<'_>,
    emitters: Emitters<'_>,
    techniques: Techniques,
    fresh: &mut Fresh,
    rng: &mut Rng,
    nearest: &mut HitPayload,
) {
    let mut i = 0;
    while i < techniques.bsdf {
        let glance = Glance::new(surface, rng);
        if glance.is_worth_tracing(surface) {
            trace_nearest(tlas, emitters.features, glance.origin, glance.direction, nearest);
            let light = emitters.light_at(*nearest, glance.direction);
            fresh.add_found(glance.candidate(surface, lights, techniques, light));
        }
        i += 1;
    }
}
