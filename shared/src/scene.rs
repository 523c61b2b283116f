//! The scene as rays meet it: from the indices of a hit to its surface.

use crate::environment::{EnvironmentTexel, texel_of};
use crate::frame::{FrameConstants, features};
use crate::geometry::{InstanceGeometry, SurfacePoint, VertexAttributes};
use crate::material::Material;
use crate::points::ScenePoint;
use crate::raster;
use crate::ray_cone::{self, Footprint};
use crate::surface::{GBufferTexel, PrimaryHit};
use crate::textures::{Place, Texels, triangle, uv_sets};
use glam::{Vec2, Vec3};

/// Scene buffers that tell what a ray met.
#[derive(Clone, Copy)]
pub struct Scene<'a> {
    /// [`crate::frame::features`]
    pub features: u32,
    /// By index; geometry of a primitive each.
    pub instances: &'a [InstanceGeometry],
    /// Of vertices, object space, m.
    pub positions: &'a [Vec3],
    /// Of vertices.
    pub attributes: &'a [VertexAttributes],
    /// Three a triangle.
    pub indices: &'a [u32],
    /// By index.
    pub materials: &'a [Material],
    /// Of vertices, where the scene has uvs of set 1.
    pub second_uvs: &'a [Vec2],
    /// Texels of the map, rows from the top.
    pub environment: &'a [EnvironmentTexel],
}

impl Scene<'_> {
    /// Where the ray from the eye along `direction` (unit) meets a triangle that it is known to meet.
    pub fn hit(self, frame: &FrameConstants, direction: Vec3, instance: u32, primitive: u32) -> ScenePoint {
        let geometry = self.instances[instance as usize];
        let [a, b, c] = geometry.corners(self.indices, primitive);
        let eye = frame.camera.position;
        let corners = [
            geometry.relative_to(eye, self.positions[a]),
            geometry.relative_to(eye, self.positions[b]),
            geometry.relative_to(eye, self.positions[c]),
        ];
        ScenePoint::new(instance, primitive, raster::barycentrics(corners, direction))
    }

    /// The surface at `hit`, if there is one, for a ray from the eye along `direction` (unit), and the radiance that is there unlit.
    pub fn seen(
        self,
        textures: impl Texels,
        frame: &FrameConstants,
        direction: Vec3,
        hit: ScenePoint,
    ) -> (GBufferTexel, Vec3) {
        if hit.is_none() {
            self.background(frame, direction)
        } else {
            self.surface(textures, frame, direction, hit)
        }
    }

    fn surface(
        self,
        textures: impl Texels,
        frame: &FrameConstants,
        direction: Vec3,
        hit: ScenePoint,
    ) -> (GBufferTexel, Vec3) {
        let eye = frame.camera.position;
        let spread = ray_cone::spread(&frame.camera, frame.size);
        let Met { seen, .. } = self.at(textures, hit, |point, double_area| {
            let distance = (point.position - eye).length();
            Footprint::new(spread, distance, direction, point.geometric_normal, double_area)
        });
        (seen.texel(eye), seen.emission(eye))
    }

    /// What any other ray met at `hit`. Textures are read at their finest level: who integrates over what such rays meet filters
    /// them by that.
    pub fn met(self, textures: impl Texels, hit: ScenePoint) -> Met {
        self.at(textures, hit, |_, _| Footprint::POINT)
    }

    /// What is at `hit`. Textures are read under the `footprint` of the point and twice the area of its triangle, m².
    fn at(
        self,
        textures: impl Texels,
        hit: ScenePoint,
        footprint: impl FnOnce(&SurfacePoint, f32) -> Footprint,
    ) -> Met {
        let geometry = self.instances[hit.instance() as usize];
        let corners = geometry.corners(self.indices, hit.primitive);
        let triangle = triangle(self.positions, self.attributes, corners);
        let point = geometry.surface_point(triangle, hit.barycentrics);
        let material = self.materials[geometry.material as usize];
        let uvs = uv_sets(self.features, triangle.uvs(), self.second_uvs, corners);
        let place = Place { uvs, barycentrics: hit.barycentrics, features: self.features };
        let footprint = footprint(&point, geometry.double_area(triangle.positions));
        let texels = place.texels(textures, &material, footprint);
        let bulge = if self.features & features::SMOOTH != 0 {
            geometry.bulge(triangle, hit.barycentrics)
        } else {
            0.0
        };
        let seen =
            PrimaryHit { point, material, texels, bulge, features: self.features, instance: hit.instance() };
        Met { seen, magnitude: geometry.magnitude(triangle.positions) }
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

/// What a ray met.
#[derive(Clone, Copy, Debug)]
pub struct Met {
    /// With its material.
    pub seen: PrimaryHit,
    /// Largest number that its position was computed from, m (see [`crate::math::offset_ray_origin`]).
    pub magnitude: f32,
}
