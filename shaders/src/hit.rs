//! What rays report: closest hit and misses; and the hits that transparent surfaces let through.

use crate::textures::{Bound, Textures};
use shared::alpha::is_let_through;
use shared::geometry::{InstanceGeometry, VertexAttributes, vertex_alpha};
use shared::glam::Vec2;
use shared::interface::{HitPayload, ShadowPayload};
use shared::material::Material;
use shared::textures::{Place, uv_sets};
use spirv_std::arch::ignore_intersection;
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
        key: payload.key,
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

/// Scene buffers that decide over a transparent hit.
#[derive(Clone, Copy)]
pub struct Transparency<'a> {
    pub features: u32,
    pub instances: &'a [InstanceGeometry],
    pub attributes: &'a [VertexAttributes],
    pub indices: &'a [u32],
    pub materials: &'a [Material],
    pub second_uvs: &'a [Vec2],
}

impl Transparency<'_> {
    /// Does the ray with `key` go through this triangle at `barycentrics`?
    pub fn lets_through(
        self,
        textures: &Textures,
        instance: u32,
        primitive: u32,
        barycentrics: Vec2,
        key: u32,
    ) -> bool {
        let geometry = self.instances[instance as usize];
        let corners = geometry.corners(self.indices, primitive);
        let attributes =
            [self.attributes[corners[0]], self.attributes[corners[1]], self.attributes[corners[2]]];
        let uvs = [attributes[0].uv, attributes[1].uv, attributes[2].uv];
        let uvs = uv_sets(self.features, uvs, self.second_uvs, corners);
        let material = self.materials[geometry.material as usize];
        let texel = Place { uvs, barycentrics, features: self.features }.alpha(Bound(textures), &material);
        let alpha = material.alpha * texel * vertex_alpha(attributes, barycentrics);
        is_let_through(&material, alpha, key, instance, primitive)
    }
}

/// An entry point that decides over a transparent hit: parameters of its own, then the buffers of [`Transparency`], which its
/// body gets as `$scene` with the textures.
macro_rules! transparency {
    ($(#[$meta:meta])* $name:ident($($own:tt)*) |$scene:ident, $textures:ident| $body:block) => {
        $(#[$meta])*
        pub fn $name(
            $($own)*
            #[spirv(spec_constant(id = 0, default = 0))] features: u32,
            #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] instances: &[InstanceGeometry],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] attributes: &[VertexAttributes],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] indices: &[u32],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 5)] materials: &[Material],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 8)] second_uvs: &[Vec2],
            #[spirv(descriptor_set = 0, binding = 32)] $textures: &Textures,
        ) {
            let $scene = Transparency { features, instances, attributes, indices, materials, second_uvs };
            $body
        }
    };
}
pub(crate) use transparency;

/// An any-hit shader of rays with this payload: a masked or blended triangle lets them pass or not.
macro_rules! any_hit {
    ($stem:ident $name:tt $payload:ty) => {
        transparency! {
            #[spirv(any_hit(entry_point_name = $name))]
            $stem(
                #[spirv(incoming_ray_payload)] payload: &mut $payload,
                #[spirv(hit_attribute)] barycentrics: &Vec2,
                #[spirv(instance_custom_index)] instance: usize,
                #[spirv(ray_geometry_index)] geometry: usize,
                #[spirv(primitive_id)] primitive: usize,
            ) |scene, textures| {
                let instance = (instance + geometry) as u32;
                if scene.lets_through(textures, instance, primitive as u32, *barycentrics, payload.key) {
                    // SAFETY: this is an any-hit shader.
                    unsafe { ignore_intersection() }
                }
            }
        }
    };
}

any_hit!(primary_any_hit "primary_any_hit" HitPayload);
any_hit!(shadow_any_hit "shadow_any_hit" ShadowPayload);
