//! What a pixel sees: the bodies of the passes that fill the G-buffer. They trace from the eye, so they stand here.

use crate::textures::Bound;
use crate::trace::Eye;
use shared::alpha;
use shared::counters::Counters;
use shared::environment::EnvironmentTexel;
use shared::geometry::{InstanceGeometry, VertexAttributes};
use shared::glam::{UVec2, Vec2, Vec3};
use shared::material::Material;
use shared::math::unpack_place;
use shared::passes::At;
use shared::passes::points::pack_pixel;
use shared::points::{Aim, ScenePoint};
use shared::raster;
use shared::resources::Extent;
use shared::scene::Scene;
use shared::stored_ray::StoredRay;
use shared::surface::GBufferTexel;

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
            $textures: Bound<'_>,
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
    eye.trace(at.features, at.frame.camera.position, direction, key).into()
}

sees! {
    /// What each pixel sees through the frame's place, by a ray.
    gbuffer(eye: Eye<'_>;) -> (GBufferTexel, Vec3, ScenePoint) |at, scene, textures| {
        let direction = direction(at, at.frame.place);
        let point = met(at, eye, direction);
        let (texel, radiance) = scene.seen(textures, at.frame, direction, point);
        (texel.seen_through(at.frame.place), radiance, point)
    }
}

sees! {
    /// The same, from the triangle that `visibility` has drawn there.
    gbuffer_raster(; visibility: &[UVec2]) -> (GBufferTexel, Vec3, ScenePoint) |at, scene, textures| {
        let direction = direction(at, at.frame.place);
        let point = match raster::triangle(visibility[at.index(Extent::Pixels)]) {
            None => ScenePoint::default(),
            Some((instance, primitive)) => scene.hit(at.frame, direction, instance, primitive),
        };
        let (texel, radiance) = scene.seen(textures, at.frame, direction, point);
        (texel.seen_through(at.frame.place), radiance, point)
    }
}

sees! {
    /// What each pixel sees where it aims; with what became of its aim, and no catch. New points are listed.
    gbuffer_aimed(eye: Eye<'_>; previous_points: &[ScenePoint], aim: Aim, _caught: u32, hops: Counters<'_>)
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
        let mut hops = hops;
        if aim.source().is_none() && !hit.is_none() {
            hops.append(pack_pixel(at.pixel));
        }
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
