//! Frames of points, found on the CPU as on the GPU: every triangle is asked in f64.

use super::*;
use crate::camera::Camera;
use crate::counters::Counters;
use crate::frame::Settings;
use crate::interface::PassConstants;
use crate::math::{CENTER, unpack_place};
use crate::passes::{self, At, variant};
use bytemuck::Zeroable;
use glam::{Affine3A, DVec3, Quat, UVec3};

const SIZE: UVec2 = UVec2::new(48, 32);

/// An error in how points are found.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Plant {
    /// The ray's answer is not looked at: hidden points stay, and those on other triangles.
    Unconfirmed,
    /// What the ray meets beside the point's triangle is taken for the point.
    OtherTriangle,
    /// The place in the pixel is that of the previous frame.
    OldPlace,
}

/// A floor of two triangles, and a box's side before it that hides a part of it; the third instance moves.
struct Hall {
    instances: Vec<InstanceGeometry>,
    positions: Vec<Vec3>,
    indices: Vec<u32>,
}

impl Hall {
    fn new(time: f32) -> Self {
        let square = |u: Vec3, v: Vec3| [-u - v, u - v, u + v, -u + v];
        let place =
            |at: Vec3, turn: f32| Affine3A::from_rotation_translation(Quat::from_rotation_y(turn), at);
        let instances = [
            place(Vec3::ZERO, 0.0),
            place(Vec3::new(0.4, 0.5, 1.0), 0.0),
            place(Vec3::new(-0.8 + 0.05 * time, 0.4, 0.8), 0.1 * time),
        ];
        let squares = [
            square(Vec3::X * 6.0, Vec3::Z * 6.0),
            square(Vec3::X * 0.3, Vec3::Y * 0.5),
            square(Vec3::X * 0.2, Vec3::Y * 0.4),
        ];
        Hall {
            instances: (0..3).map(|i| InstanceGeometry::new(instances[i], 0, 4 * i as u32, 0)).collect(),
            positions: squares.concat(),
            indices: vec![0, 1, 2, 0, 2, 3],
        }
    }

    /// The nearest triangle along `direction`, with the distance.
    fn met(&self, eye: Vec3, direction: Vec3) -> (ScenePoint, f64) {
        let (mut nearest, mut met) = (f64::INFINITY, ScenePoint::default());
        let d = direction.as_dvec3();
        for (instance, geometry) in self.instances.iter().enumerate() {
            for primitive in 0..2 {
                let corner = |i: usize| geometry.relative_to(eye, self.positions[i]).as_dvec3();
                let [a, b, c] = geometry.corners(&self.indices, primitive).map(corner);
                let solved = glam::DMat3::from_cols(d, a - b, a - c).inverse() * a;
                let DVec3 { x: t, y: u, z: v } = solved;
                if u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0 && t < nearest {
                    nearest = t;
                    met = ScenePoint::new(instance as u32, primitive, Vec2::new(u as f32, v as f32));
                }
            }
        }
        (met, nearest)
    }
}

/// What a walk came to.
#[derive(Debug, Default)]
struct Walked {
    /// Pixels that have a surface, those that kept their point, and those that share it with a neighbor.
    seen: usize,
    kept: usize,
    shared: usize,
    /// Kept points that are not what their pixel's ray meets, or do not lie where the pixel looks.
    wrong: usize,
}

/// Frames in which the camera moves by `pan` pixels and `walk` m each; and things do, if `moves`.
fn walk(pan: f32, walk: f32, moves: bool, plant: Option<Plant>) -> Walked {
    let mut walked = Walked::default();
    let pixels = || (0..SIZE.x * SIZE.y).map(|i| UVec2::new(i % SIZE.x, i / SIZE.x));
    let (mut points, mut places) = (Vec::new(), vec![CENTER; (SIZE.x * SIZE.y) as usize]);
    let mut previous_camera = None;
    for index in 0..12 {
        let t = index as f32;
        let hall = Hall::new(if moves { t } else { 0.0 });
        let yaw = pan * t * 0.9 / SIZE.y as f32;
        let forward = Vec3::new(yaw.sin(), -0.35, -yaw.cos());
        let eye = Vec3::new(0.1, 1.4, 4.0 - walk * t);
        let camera = Camera::new(eye, forward, Vec3::Y, 0.9, SIZE);
        let frame = FrameConstants {
            camera,
            previous_camera: previous_camera.replace(camera).unwrap_or(camera),
            size: SIZE,
            index,
            settings: Settings::default(),
            ..FrameConstants::zeroed()
        };
        let at = |pixel: UVec2| {
            At::new(&frame, PassConstants::default(), 0, variant::LASTING, UVec3::new(pixel.x, pixel.y, 0))
        };
        let mut aims = vec![Aim::anew(CENTER); (SIZE.x * SIZE.y) as usize];
        if index > 0 {
            let mut caught = vec![0; aims.len()];
            let Hall { instances, positions, indices } = &hall;
            for pixel in pixels() {
                passes::scatter(
                    at(pixel),
                    instances,
                    positions,
                    indices,
                    &points,
                    Counters::new(&mut caught),
                );
            }
            let mut hops = vec![0; 1];
            let land = |pixel| {
                let hops = Counters::new(&mut hops);
                passes::land(at(pixel), instances, positions, indices, &points, &caught, hops)
            };
            let landings: Vec<u32> = pixels().map(land).collect();
            aims = pixels().map(|pixel| passes::aim(at(pixel), &points, &caught, &landings)).collect();
        }
        let mut next = Vec::new();
        for (i, pixel) in pixels().enumerate() {
            let mut aim = aims[i];
            if plant == Some(Plant::OldPlace)
                && let Some(source) = aim.source()
            {
                aim = Aim::at_point(places[source as usize], source);
            }
            let direction = frame.camera.direction(pixel.as_vec2() + unpack_place(aim.place), SIZE);
            let (hit, _) = hall.met(eye, direction);
            walked.seen += usize::from(!hit.is_none());
            let told = match (plant, aim.source()) {
                (Some(Plant::Unconfirmed), Some(source)) => points[source as usize],
                (Some(Plant::OtherTriangle), Some(source)) if !hit.is_none() => {
                    ScenePoint { barycentrics: hit.barycentrics, ..points[source as usize] }
                }
                _ => hit,
            };
            let aim = if index > 0 { aim.confirmed(&told, &points) } else { aim };
            let point = aim.source().map_or(hit, |source| points[source as usize]);
            if let Some(source) = aim.source() {
                walked.kept += 1;
                walked.shared += usize::from(aims[..i].iter().any(|other| other.source() == Some(source)));
                // Where it is, by f64; what is there, by every triangle.
                let relative = exact(&hall, &point, eye);
                let (seen, distance) = hall.met(eye, direction);
                // Half a step of a place on this picture, at a grazing angle.
                let near = 2e-3 * relative.length();
                let there = direction.as_dvec3() * distance;
                walked.wrong +=
                    usize::from(!seen.shares_triangle_with(&point) || there.distance(relative) > near);
            }
            places[i] = aim.place;
            next.push(point);
        }
        points = next;
    }
    walked
}

/// `point` relative to `eye`.
fn exact(hall: &Hall, point: &ScenePoint, eye: Vec3) -> DVec3 {
    let g = &hall.instances[point.instance() as usize];
    let world = |i: usize| {
        let p = hall.positions[i].as_dvec3();
        g.axis_x.as_dvec3() * p.x
            + g.axis_y.as_dvec3() * p.y
            + g.axis_z.as_dvec3() * p.z
            + g.translation.as_dvec3()
    };
    let [a, b, c] = g.corners(&hall.indices, point.primitive).map(world);
    let Vec2 { x, y } = point.barycentrics;
    a + (b - a) * f64::from(x) + (c - a) * f64::from(y) - eye.as_dvec3()
}

/// Under pans, walks and moving things, a pixel keeps a point only while it sees it, and most keep theirs: of a pan, nearly all.
#[test]
fn points_are_kept_where_they_are_seen() {
    for (pan, step, moves, least) in [
        (0.0, 0.0, false, 0.999),
        (0.37, 0.0, false, 0.95),
        (1.37, 0.0, false, 0.92),
        (0.37, 0.03, false, 0.92),
        (0.37, 0.03, true, 0.9),
    ] {
        let walked = walk(pan, step, moves, None);
        let later = walked.seen as f64 * 11.0 / 12.0;
        println!("pan {pan}, walk {step}: {walked:?}, {:.3} kept", walked.kept as f64 / later);
        assert_eq!(walked.wrong, 0, "pan {pan}, walk {step}");
        assert!(walked.kept as f64 > least * later, "pan {pan}, walk {step}: {walked:?}");
        assert!(walked.shared as f64 <= 0.25 * later, "pan {pan}, walk {step}: {walked:?}");
    }
}

/// Negative controls.
#[test]
fn wrong_points_are_seen() {
    for plant in [Plant::Unconfirmed, Plant::OtherTriangle, Plant::OldPlace] {
        let walked = walk(0.37, 0.03, true, Some(plant));
        assert!(walked.wrong > 20, "{plant:?} was not seen: {walked:?}");
    }
}

#[test]
fn the_nearest_point_is_caught() {
    for pixels in [1, 2, 48 * 32, 1920 * 1080, 3840 * 2160] {
        let all: Vec<Caught> =
            (0..60).map(|i| Caught::new((i * 7919) % pixels, pixels, 1.3f32.powi(i as i32 - 30))).collect();
        for (i, caught) in all.iter().enumerate() {
            assert_eq!(caught.source(pixels), Some((i as u32 * 7919) % pixels));
            assert!(all[..i].iter().all(|nearer| nearer > caught), "{i} of {pixels} pixels");
        }
        assert_eq!(Caught(0).source(pixels), None);
        // Of two at one distance the first.
        assert!(pixels < 2 || Caught::new(0, pixels, 3.0) > Caught::new(1, pixels, 3.0));
        for distance in [0.0, 1e-30, 1e30, f32::INFINITY] {
            assert_eq!(Caught::new(pixels - 1, pixels, distance).source(pixels), Some(pixels - 1));
        }
    }
}

#[test]
fn places_survive_packing() {
    assert_eq!(unpack_place(CENTER), Vec2::splat(0.5));
    for i in 0..2000 {
        let place = Vec2::new(i as f32, (i * 37 % 2000) as f32) / 1000.0 - 0.5;
        let error = (unpack_place(pack_place(place)) - place).abs().max_element();
        // The last step of the range is the one before its end.
        assert!(error <= 1.0 / 4096.0 + 1e-6, "{place} is off by {error}");
    }
    let texel = crate::surface::GBufferTexel::default().seen_through(pack_place(Vec2::new(0.1, 0.9)));
    assert!(texel.is_empty() && texel.instance() == 0 && texel.roughness() == 0.0);
    assert_eq!(texel.place(), pack_place(Vec2::new(0.1, 0.9)));
}
