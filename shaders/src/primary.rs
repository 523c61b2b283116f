//! What a pixel sees: the bodies of the passes that fill the G-buffer. They read images, so they stand here.

use crate::textures::{Place, Textures, triangle, uv_sets};
use crate::trace::Eye;
use shared::alpha;
use shared::environment::{EnvironmentTexel, texel_of};
use shared::frame::{FrameConstants, features};
use shared::geometry::{InstanceGeometry, VertexAttributes};
use shared::glam::{UVec2, Vec2, Vec3};
use shared::interface::HitPayload;
use shared::material::Material;
use shared::math::{CENTER, unpack_place};
use shared::passes::At;
use shared::points::{Aim, ScenePoint};
use shared::raster;
use shared::ray_cone::{self, Footprint};
use shared::resources::Extent;
use shared::stored_ray::StoredRay;
use shared::surface::{GBufferTexel, PrimaryHit};

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
    fn hit(self, frame: &FrameConstants, direction: Vec3, instance: u32, primitive: u32) -> ScenePoint {
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

    /// The surface at `hit`, if there is one, for a ray along `direction` (unit), and the radiance that is there unlit.
    fn seen(
        self,
        textures: &Textures,
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
        textures: &Textures,
        frame: &FrameConstants,
        direction: Vec3,
        hit: ScenePoint,
    ) -> (GBufferTexel, Vec3) {
        let eye = frame.camera.position;
        let geometry = self.instances[hit.instance() as usize];
        let corners = geometry.corners(self.indices, hit.primitive);
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
        let seen = PrimaryHit { point, material, texels, features: self.features, instance: hit.instance() };
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

/// A body that gives the G-buffer's texel, the radiance that needs no lighting (emission, background), and the point of the scene.
/// `$first` and `$last` are its arguments before and after the scene's buffers. `$code` has the scene, and gives all it writes.
macro_rules! sees {
    ($(#[$doc:meta])* $name:ident($($first:ident: $first_type:ty)?; $($last:ident: $last_type:ty),*) -> $out:ty
        |$at:ident, $scene:ident, $textures:ident| $code:expr) => {
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
            $textures: &Textures,
            $($last: $last_type,)*
        ) -> $out {
            let features = $at.features;
            let $scene =
                Scene { features, instances, positions, attributes, indices, materials, second_uvs, environment };
            $code
        }
    };
}

/// Of the ray through the place in `at`'s pixel that `place` packs.
fn direction(at: At<'_>, place: u32) -> Vec3 {
    at.frame.camera.direction(at.pixel.as_vec2() + unpack_place(place), at.frame.size)
}

/// What a ray from the eye meets.
fn met(at: At<'_>, eye: Eye<'_>, direction: Vec3) -> ScenePoint {
    let key = alpha::primary_key(at.frame, at.pixel);
    let HitPayload { hit, instance, primitive, barycentrics, .. } =
        eye.trace(at.features, at.frame.camera.position, direction, key);
    if hit != 0 { ScenePoint::new(instance, primitive, barycentrics) } else { ScenePoint::default() }
}

sees! {
    /// What each pixel's center sees, by a ray.
    gbuffer(eye: Eye<'_>;) -> (GBufferTexel, Vec3, ScenePoint) |at, scene, textures| {
        let direction = direction(at, CENTER);
        let point = met(at, eye, direction);
        let (texel, radiance) = scene.seen(textures, at.frame, direction, point);
        (texel, radiance, point)
    }
}

sees! {
    /// The same, from the triangle that `visibility` has drawn there.
    gbuffer_raster(; visibility: &[UVec2]) -> (GBufferTexel, Vec3, ScenePoint) |at, scene, textures| {
        let direction = direction(at, CENTER);
        let point = match raster::triangle(visibility[at.index(Extent::Pixels)]) {
            None => ScenePoint::default(),
            Some((instance, primitive)) => scene.hit(at.frame, direction, instance, primitive),
        };
        let (texel, radiance) = scene.seen(textures, at.frame, direction, point);
        (texel, radiance, point)
    }
}

sees! {
    /// What each pixel sees where it aims; with what became of its aim, and no catch.
    gbuffer_aimed(eye: Eye<'_>; previous_points: &[ScenePoint], aim: Aim, _caught: u32)
        -> (Aim, u32, GBufferTexel, Vec3, ScenePoint) |at, scene, textures|
    {
        let direction = direction(at, aim.place);
        let hit = met(at, eye, direction);
        let aim = aim.confirmed(&hit, previous_points);
        // A point that is kept is kept exactly, however often it is seen through another place.
        let point = match aim.source() {
            Some(source) => previous_points[source as usize],
            None => hit,
        };
        let (texel, radiance) = scene.seen(textures, at.frame, direction, hit);
        (aim, 0, texel.seen_through(aim.place), radiance, point)
    }
}

sees! {
    /// What each pixel saw in the previous frame, from where it saw it.
    gbuffer_kept(; previous_gbuffer: &[GBufferTexel], previous_points: &[ScenePoint])
        -> (GBufferTexel, Vec3, ScenePoint) |at, scene, textures|
    {
        let index = at.index(Extent::Pixels);
        let (texel, point) = (previous_gbuffer[index], previous_points[index]);
        let (_, radiance) = scene.seen(textures, at.frame, direction(at, texel.place()), point);
        (texel, radiance, point)
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
