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

/// A body that gives the G-buffer's texel and the radiance that needs no lighting (emission, background): `$hit` is what
/// the pixel's ray meets.
macro_rules! sees {
    ($(#[$doc:meta])* $name:ident($($first:ident: $first_type:ty)?; $($last:ident: $last_type:ty)?)
        |$at:ident, $scene:ident, $direction:ident| $hit:expr) => {
        $(#[$doc])*
        pub fn $name(
            $at: At<'_>,
            $($first: $first_type,)?
            instances: &[InstanceGeometry],
            positions: &[Vec3],
            attributes: &[VertexAttributes],
            indices: &[u32],
            materials: &[Material],
            second_uvs: &[Vec2],
            environment: &[EnvironmentTexel],
            textures: &Textures,
            $($last: $last_type,)?
        ) -> (GBufferTexel, Vec3) {
            let (frame, features) = ($at.frame, $at.features);
            let $direction = frame.camera.direction($at.pixel.as_vec2() + 0.5, frame.size);
            let $scene =
                Scene { features, instances, positions, attributes, indices, materials, second_uvs, environment };
            match $hit {
                None => $scene.background(frame, $direction),
                Some(hit) => $scene.surface(textures, frame, $direction, hit),
            }
        }
    };
}

sees! {
    /// What each pixel sees, by a ray.
    gbuffer(eye: Eye<'_>;) |at, scene, direction| {
        let key = alpha::primary_key(at.frame, at.pixel);
        let met = eye.trace(scene.features, at.frame.camera.position, direction, key);
        let HitPayload { instance, primitive, barycentrics, .. } = met;
        (met.hit != 0).then_some(Hit { instance, primitive, barycentrics })
    }
}

sees! {
    /// The same, from the triangle that `visibility` has drawn there.
    gbuffer_raster(; visibility: &[UVec2]) |at, scene, direction| {
        let seen = raster::triangle(visibility[at.index(Extent::Pixels)]);
        seen.map(|(instance, primitive)| scene.hit(at.frame, direction, instance, primitive))
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
