//! What a pixel sees, once it is known which triangle: for both passes that fill the G-buffer.

use crate::textures::{Place, Textures, corners, triangle, uv_sets};
use shared::environment::{EnvironmentTexel, texel_of};
use shared::frame::{FrameConstants, features};
use shared::geometry::{InstanceGeometry, VertexAttributes};
use shared::glam::{Vec2, Vec3};
use shared::material::Material;
use shared::raster;
use shared::ray_cone::{self, Footprint};
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
    pub fn hit(self, frame: &FrameConstants, direction: Vec3, instance: u32, primitive: u32) -> Hit {
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
    pub fn surface(
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
    pub fn background(self, frame: &FrameConstants, direction: Vec3) -> (GBufferTexel, Vec3) {
        let radiance = if self.features & features::ENVIRONMENT != 0 {
            self.environment[texel_of(direction, frame.environment_size) as usize].radiance
        } else {
            frame.background
        };
        (GBufferTexel::default(), radiance)
    }
}
