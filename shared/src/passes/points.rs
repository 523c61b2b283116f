//! Where the points of the previous frame fall, and where each pixel looks: see [`crate::points`].

use super::{At, variant};
use crate::antialias::quasirandom;
use crate::counters::Counters;
use crate::frame::FrameConstants;
use crate::geometry::InstanceGeometry;
use crate::math::{CENTER, pack_place, unpack_place};
use crate::points::{Aim, Caught, ScenePoint, Triangles};
use crate::resources::Extent;
use crate::rng::hash;
use glam::{IVec2, UVec2, UVec3, UVec4, Vec2, Vec3};

/// A pixel without a catch looks for others' so many pixels away.
const REACH: u32 = 2;
/// How far from its center, along each axis, a pixel shades a point that a neighbor caught, pixels.
const BORROWED: f32 = 1.0;
/// Frames in which each pixel has one turn: to get a point of its own in the place of a borrowed one, and at rest to return to its
/// center. Measured in docs/performance.md.
pub const TURNS: u32 = 16;

/// Throws the point of a pixel of the previous frame into the pixel that it falls into now.
pub fn scatter(
    at: At<'_>,
    instances: &[InstanceGeometry],
    positions: &[Vec3],
    indices: &[u32],
    previous_points: &[ScenePoint],
    mut caught: Counters<'_>,
) {
    let (frame, source) = (at.frame, at.index(Extent::Pixels) as u32);
    let triangles = Triangles { instances, positions, indices };
    if let Some(shown) = triangles.shown(frame, &previous_points[source as usize]) {
        let word = Caught::new(source, frame.pixels(), shown.distance);
        caught.max(frame.pixel_index(shown.pixel(frame.size)), word.0);
    }
}

/// Where in its pixel the point lies that a pixel caught, packed by [`crate::math::pack_place`]: once, for all who ask. And nobody has a
/// new point yet.
pub fn land(
    at: At<'_>,
    instances: &[InstanceGeometry],
    positions: &[Vec3],
    indices: &[u32],
    previous_points: &[ScenePoint],
    caught: &[u32],
    mut hops: Counters<'_>,
) -> u32 {
    if at.pixel == UVec2::ZERO {
        hops.clear();
    }
    let triangles = Triangles { instances, positions, indices };
    if let Some(source) = Caught(caught[at.index(Extent::Pixels)]).source(at.frame.pixels())
        && let Some(shown) = triangles.shown(at.frame, &previous_points[source as usize])
    {
        shown.place_in(at.pixel)
    } else {
        CENTER
    }
}

/// Where a pixel's ray goes.
pub fn aim(at: At<'_>, previous_points: &[ScenePoint], caught: &[u32], landings: &[u32]) -> Aim {
    let frame = at.frame;
    let has_turn = has_turn(frame, at.pixel);
    let home = if at.is(variant::WANDERS) { place_at_rest(frame, at.pixel) } else { CENTER };
    if has_turn && (at.is(variant::RESTS) || at.is(variant::WANDERS)) {
        return Aim::anew(home);
    }
    let own = at.index(Extent::Pixels);
    if let Some(source) = Caught(caught[own]).source(frame.pixels()) {
        return Aim::at_point(landings[own], source);
    }
    let mut distance = BORROWED;
    let mut nearest = Aim::anew(CENTER);
    let mut lattice = Aim::anew(CENTER);
    let mut found = 0;
    let mut i = 1;
    while i < (2 * REACH + 1) * (2 * REACH + 1) {
        let offset = IVec2::new(alternating(i % (2 * REACH + 1)), alternating(i / (2 * REACH + 1)));
        let pixel = at.pixel.as_ivec2() + offset;
        let inside = pixel.cmpge(IVec2::ZERO).all() && pixel.cmplt(frame.size.as_ivec2()).all();
        // What is two pixels away is too far to be borrowed.
        if inside && (found == 0 || offset.abs().max_element() < 2) {
            let index = frame.pixel_index(pixel.as_uvec2()) as usize;
            if let Some(source) = Caught(caught[index]).source(frame.pixels()) {
                if found == 0 {
                    lattice = Aim::anew(landings[index]);
                }
                found += 1;
                let place = unpack_place(landings[index]) + offset.as_vec2();
                let far = (place - 0.5).abs().max_element();
                if far < distance {
                    distance = far;
                    nearest = Aim::at_point(pack_place(place), source);
                }
            }
        }
        i += 1;
    }
    if was_background(at, previous_points) {
        Aim::anew(home)
    } else if distance < BORROWED && !has_turn {
        nearest
    } else {
        lattice
    }
}

/// A pixel, as `hops` lists it.
pub fn pack_pixel(pixel: UVec2) -> u32 {
    pixel.x | pixel.y << 16
}

/// Is `pixel` on `list`?
#[cfg(not(target_arch = "spirv"))]
pub fn is_listed(list: &[u32], pixel: UVec2) -> bool {
    list[1..][..list[0] as usize].contains(&pack_pixel(pixel))
}

/// The thread that stands at `id` of a launch over `size`: for the pixel that `list` has there, or for none.
pub fn listed(list: &[u32], id: UVec3, size: UVec3) -> UVec3 {
    let i = id.y * size.x + id.x;
    if i >= list[0] {
        return UVec3::splat(u32::MAX);
    }
    let pixel = list[1 + i as usize];
    UVec3::new(pixel & 0xffff, pixel >> 16, id.z)
}

/// Did the previous frame see nothing where this pixel looks, very far away? What has no points borrows none: outlines before the
/// sky would grow.
fn was_background(at: At<'_>, previous_points: &[ScenePoint]) -> bool {
    let frame = at.frame;
    let direction = frame.camera.direction(at.pixel.as_vec2() + 0.5, frame.size);
    let place = frame.previous_camera.project(direction, frame.size);
    let inside = place.cmpge(Vec2::ZERO).all() && place.cmplt(frame.size.as_vec2()).all();
    inside && previous_points[frame.pixel_index(place.as_uvec2().min(frame.size - 1)) as usize].is_none()
}

/// Is this the frame, one of [`TURNS`], in which `pixel` gets a new point?
fn has_turn(frame: &FrameConstants, pixel: UVec2) -> bool {
    (first_turn(pixel) + frame.index).is_multiple_of(TURNS)
}

fn first_turn(pixel: UVec2) -> u32 {
    hash(UVec4::new(pixel.x, pixel.y, 0, 0)).x % TURNS
}

/// Where `pixel` looks at rest since its last turn, packed: from turn to turn places cover the pixel evenly. Pixels whose turns are near in time look at the same place in each: when the
/// camera moves on, points fall into pixels one to one.
pub fn place_at_rest(frame: &FrameConstants, pixel: UVec2) -> u32 {
    pack_place(quasirandom((first_turn(pixel) + frame.index) / TURNS))
}

/// 0, -1, 1, -2, 2 ...
fn alternating(i: u32) -> i32 {
    let size = i.div_ceil(2) as i32;
    if i % 2 == 1 { -size } else { size }
}
