//! The town is checked against its plan in closed form, and its triangles by brute force.

use super::solids::{Solid, on_road, solids};
use super::*;
use crate::scene::lights::LightTable;
use crate::scene::{Bounds, Instance, PlacedLight};
use glam::Mat3;
use plan::HALF;
use std::sync::LazyLock;

static TOWN: LazyLock<SceneDescription> = LazyLock::new(|| town(DEFAULT_LIGHT_COUNT));
static PLAN: LazyLock<Plan> = LazyLock::new(Plan::new);
/// Houses, towers, the hall.
static SOLIDS: LazyLock<Vec<Solid>> = LazyLock::new(|| solids(&PLAN));

fn inside(p: Vec3, depth: f32) -> bool {
    SOLIDS.iter().any(|solid| solid.contains(p, depth))
}

fn in_town(p: Vec3) -> bool {
    p.x.abs() < HALF && p.z.abs() < HALF && (0.05..130.0).contains(&p.y)
}

fn positions(scene: &SceneDescription) -> Vec<Vec3> {
    scene.lights.iter().filter_map(PlacedLight::position).collect()
}

#[test]
fn the_number_of_lights_is_what_was_asked_for() {
    for count in [0, 1, 9, 100, 1000, DEFAULT_LIGHT_COUNT, 150_000] {
        assert_eq!(LightTable::new(&town(count)).lights.len(), count);
    }
}

#[test]
fn light_grows_gently_with_the_number_of_lights() {
    let flux = |count: usize| -> f64 {
        LightTable::new(&town(count)).lights.iter().map(|light| f64::from(light.power)).sum()
    };
    let [few, usual, many] = [1000, DEFAULT_LIGHT_COUNT, 400_000].map(flux);
    assert!(usual > 2.0 * few && usual < 20.0 * few, "{few} lm, {usual} lm");
    assert!(many > usual && many < 1.5 * usual, "{usual} lm, {many} lm");
}

#[test]
fn two_calls_give_the_same_scene() {
    let lights = |scene: &SceneDescription| LightTable::new(scene).lights;
    let (a, b) = (town(3000), town(3000));
    let bits = |scene: &SceneDescription| bytemuck::cast_slice::<_, u8>(&lights(scene)).to_vec();
    assert!(bits(&a) == bits(&b));
    assert!(a.cameras == b.cameras && a.animation == b.animation);
    let vertices = |scene: &SceneDescription| -> Vec<Vec3> {
        scene.meshes.iter().flat_map(|mesh| &mesh.primitives).flat_map(|p| p.positions.clone()).collect()
    };
    assert!(vertices(&a) == vertices(&b));
    let places = |scene: &SceneDescription| -> Vec<_> {
        scene.instances.iter().map(|i| (i.mesh, i.transform)).collect()
    };
    assert!(places(&a) == places(&b));
    assert!(bits(&a) != bits(&town(3001)));
}

#[test]
fn the_size_is_as_documented() {
    let unique: usize = TOWN.meshes.iter().map(super::glow::triangles).sum();
    let (instances, triangles) = (TOWN.instances.len(), TOWN.triangle_count());
    assert!((100_000..500_000).contains(&unique), "{unique} triangles in meshes");
    assert!((7_000..20_000).contains(&instances), "{instances} instances");
    assert!(triangles < 6_000_000, "{triangles} triangles");
    assert!(TOWN.bounds().min.y >= -0.01);
}

/// No light within a house, all within the town, whatever the time.
#[test]
fn lights_are_in_the_open_air() {
    let mut scene = TOWN.clone();
    for time in [0.0, 5.3, 11.9, 20.0] {
        let pose = scene.pose(time);
        scene.apply(&pose);
        for p in positions(&scene) {
            assert!(in_town(p) && !inside(p, 0.0), "{p} at {time} s");
        }
    }
    for p in positions(&town(60_000)) {
        assert!(in_town(p) && !inside(p, 0.0), "{p}");
    }
    // The check sees a lamp that is moved into the house behind it.
    let lamp = lamps::lamps(&PLAN).into_iter().find(|lamp| lamp.foot.length() > 120.0).unwrap();
    let back = -6.0 * lamp.side.outward();
    let position = lamp.light().position().unwrap() + Vec3::new(back.x, 0.0, back.y);
    assert!(inside(position, 0.0));
}

#[test]
fn shining_triangles_are_at_the_surface_of_houses_or_in_their_open_rooms() {
    let lights = LightTable::new(&TOWN).lights;
    let triangles = &lights[TOWN.lights.len()..];
    assert!(triangles.len() > 5000);
    for light in triangles {
        // The deepest are panes, 0.2 m behind their wall.
        assert!(in_town(light.position) && !inside(light.position, 0.3), "{}", light.position);
    }
}

#[test]
fn cameras_are_in_the_open_air() {
    let names: Vec<&str> = TOWN.cameras.iter().map(|camera| camera.name.as_str()).collect();
    assert_eq!(names, ["street", "roofs", "square", "room", "drive"]);
    for camera in &TOWN.cameras {
        let p = camera.position;
        assert!(p.y > 1.4 && !inside(p, -0.4), "{}", camera.name);
        assert!(camera.forward.is_normalized() && camera.fov_y > 0.5);
    }
    // The room's is in a house, and one a metre behind it would be in the wall.
    let room = &TOWN.cameras[3];
    assert!(inside(room.position - Vec3::Z * room.forward.z.signum() * 1.5, 0.0));
}

#[test]
fn houses_do_not_overlap() {
    for (i, a) in SOLIDS.iter().enumerate() {
        for (k, b) in SOLIDS[..i].iter().enumerate() {
            // The tower of the hall stands in its front.
            assert!(a.overlap(b) < 0.02 || a.in_square() && b.in_square(), "{i} and {k}: {} m", a.overlap(b));
        }
    }
    assert!(SOLIDS[0].overlap(&SOLIDS[0]) > 5.0);
}

fn on_pavement(foot: Vec2) -> bool {
    PLAN.blocks.iter().any(|block| block.curb.inset(0.25).contains(foot)) && !on_road(&PLAN, foot)
}

#[test]
fn lamps_stand_on_pavements() {
    let lamps = lamps::lamps(&PLAN);
    assert!(lamps.len() > 1500);
    for lamp in &lamps {
        let foot = Vec3::new(lamp.foot.x, KERB, lamp.foot.y);
        assert!(on_pavement(lamp.foot) && !inside(foot + Vec3::Y, -0.3), "{}", lamp.foot);
    }
    let moved = lamps[100].foot + 1.0 * lamps[100].side.outward();
    assert!(!on_pavement(moved) && on_road(&PLAN, moved));
}

#[test]
fn trees_and_cases_stand_where_nobody_drives() {
    for p in TOWN.instances.iter().filter(|i| i.name.starts_with("tree") || i.name.starts_with("poster")) {
        let foot = Vec2::new(p.transform.translation.x, p.transform.translation.z);
        assert!(on_pavement(foot) && !inside(Vec3::new(foot.x, 2.0, foot.y), -0.2), "{} at {foot}", p.name);
    }
}

/// Is a car there between kerbs, with all its corners, whichever way it heads?
fn fits(at: Vec2) -> bool {
    let r = cars::HALF.y;
    [Vec2::ZERO, Vec2::X * r, Vec2::NEG_X * r, Vec2::Y * r, Vec2::NEG_Y * r]
        .iter()
        .all(|&d| on_road(&PLAN, at + d))
}

#[test]
fn the_drive_keeps_to_the_road() {
    let drive = TOWN.cameras.len() - 1;
    let mut scene = TOWN.clone();
    let mut last: Option<(Vec3, Vec3)> = None;
    let (mut turned, mut way) = (0.0, 0.0);
    for k in 0..=480 {
        let pose = scene.pose(f64::from(k) * 0.05);
        scene.apply(&pose);
        let (p, forward) = (scene.cameras[drive].position, scene.cameras[drive].forward);
        assert!(fits(Vec2::new(p.x, p.z)) && !inside(p, -0.9), "{p} at {} s", f64::from(k) * 0.05);
        if let Some((before, heading)) = last {
            // Smooth: under 20 m/s, and 70 degrees a second.
            assert!(p.distance(before) < 1.0 && heading.angle_between(forward) < 0.06, "{p}");
            way += p.distance(before);
            turned += heading.angle_between(forward);
        }
        last = Some((p, forward));
    }
    // About 300 m with four corners.
    assert!((200.0..400.0).contains(&way) && turned > 5.5, "{way} m, {turned} rad");
    assert!(!fits(Vec2::new(136.0, 12.0)), "a path beside the road would be noticed");
}

#[test]
fn moving_cars_keep_to_the_road_and_apart() {
    let rounds = traffic::rounds(&PLAN);
    assert!(rounds.len() > 40);
    for k in 0..60u16 {
        let time = f32::from(k) * traffic::DURATION / 60.0;
        let places: Vec<Vec2> = rounds.iter().map(|round| round.at(time)).collect();
        for (i, &p) in places.iter().enumerate() {
            assert!(fits(p), "{p} at {time} s");
            assert!(places[..i].iter().all(|q| q.distance(p) > 2.0), "{p} at {time} s");
        }
    }
}

#[test]
fn a_round_ends_where_it_began() {
    let pose = |time: f64| TOWN.pose(time).places;
    let (start, end) = (pose(0.0), pose(f64::from(traffic::DURATION)));
    assert_eq!(start.len(), end.len());
    for ((thing, a), (_, b)) in start
        .iter()
        .zip(&end)
        .filter(|((thing, _), _)| !matches!(thing, crate::scene::animation::Thing::Camera(_)))
    {
        assert!(a.translation.distance(b.translation) < 0.02, "{thing:?}");
    }
    // What rests is where time 0 puts it.
    let mut scene = TOWN.clone();
    scene.apply(&TOWN.pose(0.0));
    for (a, b) in positions(&scene).iter().zip(positions(&TOWN)) {
        assert!(a.distance(b) < 1e-3, "{a}");
    }
}

#[test]
fn vertices_are_sound() {
    for mesh in &TOWN.meshes {
        for p in &mesh.primitives {
            let (name, n) = (&mesh.name, p.positions.len());
            assert!(p.normals.len() == n && p.uvs.len() == n, "{name}");
            assert!(
                p.indices.len().is_multiple_of(3) && p.indices.iter().all(|&i| (i as usize) < n),
                "{name}"
            );
            assert!(p.normals.iter().all(|v| (v.length() - 1.0).abs() < 1e-4), "{name}");
            for t in p.indices.chunks_exact(3) {
                let [a, b, c] = [t[0], t[1], t[2]].map(|i| p.positions[i as usize]);
                let cross = (b - a).cross(c - a);
                assert!(cross.length() > 1e-8, "{name}");
                assert!([t[0], t[1], t[2]].iter().all(|&i| p.normals[i as usize].dot(cross) > 0.0), "{name}");
            }
        }
    }
}

#[test]
fn every_material_and_texture_is_used() {
    let scene = town(100_000);
    let drawn = |i: usize| {
        let of = |instance: &Instance| &scene.meshes[instance.mesh].primitives;
        scene.instances.iter().flat_map(of).any(|p| p.material == i)
    };
    for (i, material) in scene.materials.iter().enumerate() {
        assert!(drawn(i), "{}", material.name);
    }
    for i in 0..scene.textures.len() {
        assert!(scene.materials.iter().any(|m| m.textures().contains(&Some(i))), "texture {i}");
    }
}

/// The triangles near `p`, in world space.
fn near(p: Vec3, reach: f32) -> Vec<[Vec3; 3]> {
    let boxes: Vec<Bounds> = TOWN.meshes.iter().map(crate::scene::Mesh::bounds).collect();
    let mut triangles = Vec::new();
    for instance in &TOWN.instances {
        let bounds = boxes[instance.mesh];
        let local = instance.transform.inverse().transform_point3(p);
        let scale = Mat3::from(instance.transform.matrix3).determinant().abs().cbrt();
        if local.clamp(bounds.min, bounds.max).distance(local) * scale > 2.0 * reach {
            continue;
        }
        for primitive in &TOWN.meshes[instance.mesh].primitives {
            for t in primitive.indices.chunks_exact(3) {
                let at = |i: u32| instance.transform.transform_point3(primitive.positions[i as usize]);
                triangles.push([t[0], t[1], t[2]].map(at));
            }
        }
    }
    triangles
}

fn distance([a, b, c]: [Vec3; 3], p: Vec3) -> f32 {
    let n = (b - a).cross(c - a).normalize();
    if [(a, b), (b, c), (c, a)].iter().all(|&(s, e)| (e - s).cross(p - s).dot(n) >= 0.0) {
        return (p - a).dot(n).abs();
    }
    let edge = |(s, e): (Vec3, Vec3)| {
        p.distance(s.lerp(e, ((p - s).dot(e - s) / (e - s).length_squared()).clamp(0.0, 1.0)))
    };
    [(a, b), (b, c), (c, a)].map(edge).into_iter().fold(f32::INFINITY, f32::min)
}

/// Lights are not in their own lamps: no triangle is within 15 mm. Of each kind some.
#[test]
fn lights_do_not_touch_anything() {
    let places = positions(&TOWN);
    for p in places.iter().step_by(331) {
        let least = near(*p, 0.1).into_iter().map(|t| distance(t, *p)).fold(f32::INFINITY, f32::min);
        assert!(least > 0.015, "{p}: {least} m");
    }
    // A light in the middle of a bulb would be seen.
    let lamp = lamps::lamps(&PLAN)[0];
    let bulb = lamp.transform().transform_point3(Vec3::new(0.0, 4.241, 0.0));
    assert!(near(bulb, 0.1).into_iter().any(|t| distance(t, bulb) < 0.015));
}
