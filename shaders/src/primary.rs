//! What a pixel sees: the bodies of the passes that fill the G-buffer. They read images, so they stand here.

use crate::textures::{Place, Textures, corners, triangle, uv_sets};
use crate::trace::Eye;
use shared::alpha;
use shared::environment::{EnvironmentTexel, texel_of};
use shared::frame::{FrameConstants, features};
use shared::geometry::{InstanceGeometry, VertexAttributes};
use shared::glam::{UVec2, Vec2, Vec3};
use shared::interface::HitPayload;
use shared::material::Material;
use shared::passes::At;
use shared::raster;
use shared::ray_cone::{self, Footprint};
use shared::resources::Extent;
use shared::stored_ray::StoredRay;
use shared::surface::{GBufferTexel, PrimaryHit};

/// A point of a triangle of a geometry.
#[derive(Clone, Copy)]
pub struct Hit {
    pub instance: u32,
    pub primitive: u32,
    pub barycentrics: Vec2,
}

/// Scene buffers that tell what a ray from the eye met.
#[derive(Clone, Copy)]
pub struct Scene<'a> {
    pub features: u32,
    pub instances: &'a [InstanceGeometry],
    pub positions: &'a [Vec3],
    pub attributes: &'a [VertexAttributes],
    pub indices: &'a [u32],
    pub materials: &'a [Material],
    pub second_uvs: &'a [Vec2],
    pub environment: &'a [EnvironmentTexel],
}

impl Scene<'_> {
    /// Where the ray along `direction` (unit) meets a triangle that it is known to meet.
    fn hit(self, frame: &FrameConstants, direction: Vec3, instance: u32, primitive: u32) -> Hit {
        let geometry = self.instances[instance as usize];
        let [a, b, c] = corners(&geometry, self.indices, primitive);
        let eye = frame.camera.position;
        let corners = [
            geometry.relative_to(eye, self.positions[a]),
            geometry.relative_to(eye, self.positions[b]),
            geometry.relative_to(eye, self.positions[c]),
        ];
        Hit { instance, primitive, barycentrics: raster::barycentrics(corners, direction) }
    }

    /// The surface at `hit` for a ray along `direction` (unit), and the radiance that it shows unlit.
    fn surface(
        self,
        textures: &Textures,
        frame: &FrameConstants,
        direction: Vec3,
        hit: Hit,
    ) -> (GBufferTexel, Vec3) {
        let eye = frame.camera.position;
        let geometry = self.instances[hit.instance as usize];
        let corners = corners(&geometry, self.indices, hit.primitive);
        let triangle = triangle(self.positions, self.attributes, corners);
        let point = geometry.surface_point(triangle, hit.barycentrics);
        let material = self.materials[geometry.material as usize];
        let uvs = uv_sets(self.features, triangle.uvs(), self.second_uvs, corners);
        let place = Place { uvs, barycentrics: hit.barycentrics, features: self.features };
        let footprint = Footprint::new(
            ray_cone::spread(&frame.camera, frame.size),
            (point.position - eye).length(),
            direction,
            point.geometric_normal,
            geometry.double_area(triangle.positions),
        );
        let texels = place.texels(textures, &material, footprint);
        let seen = PrimaryHit { point, material, texels, features: self.features, instance: hit.instance };
        (seen.texel(eye), seen.emission(eye))
    }

    /// No surface, and the radiance that lies behind the scene along `direction` (unit).
    fn background(self, frame: &FrameConstants, direction: Vec3) -> (GBufferTexel, Vec3) {
        let radiance = if self.features & features::ENVIRONMENT != 0 {
            self.environment[texel_of(direction, frame.environment_size) as usize].radiance
        } else {
            frame.background
        };
        (GBufferTexel::default(), radiance)
    }
}

/// The direction of this pixel's ray, unit.
fn direction(at: At<'_>) -> Vec3 {
    at.frame.camera.direction(at.pixel.as_vec2() + 0.5, at.frame.size)
}

/// What each pixel sees, by a ray: the G-buffer, and the radiance that needs no lighting (emission, background).
pub fn gbuffer(
    at: At<'_>,
    eye: Eye<'_>,
    instances: &[InstanceGeometry],
    positions: &[Vec3],
    attributes: &[VertexAttributes],
    indices: &[u32],
    materials: &[Material],
    second_uvs: &[Vec2],
    environment: &[EnvironmentTexel],
    textures: &Textures,
) -> (GBufferTexel, Vec3) {
    let (frame, features, direction) = (at.frame, at.features, direction(at));
    let scene =
        Scene { features, instances, positions, attributes, indices, materials, second_uvs, environment };
    let key = alpha::primary_key(frame, at.pixel);
    let met = eye.trace(features, frame.camera.position, direction, key);
    if met.hit == 0 {
        scene.background(frame, direction)
    } else {
        let HitPayload { instance, primitive, barycentrics, .. } = met;
        scene.surface(textures, frame, direction, Hit { instance, primitive, barycentrics })
    }
}

/// The same, from the triangle that `visibility` has drawn there.
pub fn gbuffer_raster(
    at: At<'_>,
    instances: &[InstanceGeometry],
    positions: &[Vec3],
    attributes: &[VertexAttributes],
    indices: &[u32],
    materials: &[Material],
    second_uvs: &[Vec2],
    environment: &[EnvironmentTexel],
    textures: &Textures,
    visibility: &[UVec2],
) -> (GBufferTexel, Vec3) {
    let (frame, features, direction) = (at.frame, at.features, direction(at));
    let scene =
        Scene { features, instances, positions, attributes, indices, materials, second_uvs, environment };
    match raster::triangle(visibility[at.index(Extent::Pixels)]) {
        None => scene.background(frame, direction),
        Some((instance, primitive)) => {
            scene.surface(textures, frame, direction, scene.hit(frame, direction, instance, primitive))
        }
    }
}

/// 1 where a stored ray from the eye meets anything.
pub fn roofline_primary(at: At<'_>, eye: Eye<'_>, stored: &[StoredRay]) -> u32 {
    let ray = stored[at.index(Extent::Pixels)];
    if ray.traced == 0 {
        return 0;
    }
    eye.trace(at.features, ray.origin, ray.direction, ray.key).hit
}
