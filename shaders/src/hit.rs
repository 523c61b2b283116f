//! What rays report: closest hit and misses.

use shared::glam::Vec2;
use shared::interface::{HitPayload, ShadowPayload};
use spirv_std::spirv;

/// Says which triangle was hit and where; the ray generation shader looks the rest up.
#[spirv(closest_hit(entry_point_name = "closest_hit"))]
pub fn closest_hit(
    #[spirv(incoming_ray_payload)] payload: &mut HitPayload,
    #[spirv(hit_attribute)] barycentrics: &Vec2,
    #[spirv(instance_custom_index)] instance: usize,
    #[spirv(ray_geometry_index)] geometry: usize,
    #[spirv(primitive_id)] primitive: usize,
) {
    *payload = HitPayload {
        hit: 1,
        instance: (instance + geometry) as u32,
        primitive: primitive as u32,
        barycentrics: *barycentrics,
    };
}

/// A primary ray that leaves the scene.
#[spirv(miss(entry_point_name = "primary_miss"))]
pub fn primary_miss(#[spirv(incoming_ray_payload)] payload: &mut HitPayload) {
    payload.hit = 0;
}

/// A shadow ray that reached its end.
#[spirv(miss(entry_point_name = "shadow_miss"))]
pub fn shadow_miss(#[spirv(incoming_ray_payload)] payload: &mut ShadowPayload) {
    payload.visible = 1;
}
