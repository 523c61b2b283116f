//! Resampled paths: each way of reuse has the mean of quadrature, and each planted error is seen by the same comparison.

use crate::frames::{Plant, Sequence, Views, largest_t, luminances, one, quarters, runs, settings};
use crate::truth::Wall;
use crate::truth::bounce;
use crate::world::{World, glossy, grid, matt};
use crate::{FLOOR, KINDS, Kind, between_plates, plates, stage};
use shared::frame::{Settings, indirect};
use shared::glam::{UVec2, Vec3};
use shared::interface::UNBOUNDED;
use shared::material::{Material, Reflectance, flag, slot};
use shared::math::luminance;

const SIZE: UVec2 = UVec2::new(6, 4);
/// A glossy wall that stands nearly in its corner with the floor.
const WALL: Wall = Wall {
    corner: Vec3::new(-1.5, 0.02, -1.0),
    u: Vec3::new(3.0, 0.0, 0.0),
    v: Vec3::new(0.0, 1.5, 0.0),
    reflectance: |uv| Reflectance::from_metallic_roughness(grid(uv), 0.7, 0.35),
};
/// Student's t of one of four quarters, exceeded by chance in 1e-4 of all choices of seeds, which are fixed.
const T_LIMIT: f64 = 4.3;
const RUNS: u32 = 1500;
/// Of quadratures, which are checked against coarser ones.
const QUADRATURE: f64 = 2e-3;

fn views(world: &World) -> Views {
    let eyes = [Vec3::new(0.2, 0.8, 0.1), Vec3::new(0.3, 0.85, 0.12)];
    let views = Views::new(world, SIZE, eyes, Vec3::new(-0.1, -0.8, -0.72));
    let on_floor = |index| views.surfaces(index).iter().all(|x| x.position.y.abs() < 1e-5);
    assert!(on_floor(0) && on_floor(1));
    views
}

/// A floor before it, under a light.
fn open(kind: &Kind) -> World {
    let mut wall = glossy(Vec3::ONE, 0.7, 0.35);
    wall.textures[slot::BASE_COLOR] = 0;
    let mut world = World::default();
    world.square(FLOOR.corner, FLOOR.u, FLOOR.v, glossy(Vec3::new(0.576, 0.48, 0.384), 0.0, 0.5));
    world.square(WALL.corner, WALL.u, WALL.v, wall);
    (kind.light)(&mut world);
    world
}

/// With a black screen of `u` by `v`.
fn screened(mut world: World, corner: Vec3, u: Vec3, v: Vec3) -> World {
    world.square(corner, u, v, Material { flags: flag::DOUBLE_SIDED, ..matt(Vec3::ZERO) });
    world
}

fn lit(kind: &Kind) -> World {
    if kind.name != "point" {
        return open(kind).finished();
    }
    // Askew: edges along a quadrature's cells would fall on them or not.
    let (u, v) = (Vec3::new(0.5, 0.13, 0.05), Vec3::new(-0.17, 0.6, 0.02));
    screened(open(kind), Vec3::new(0.2, 0.9, -0.6), u, v).finished()
}

/// One bounce at the wall of a stage, of each quarter of what frame `index` sees.
fn truth(world: &World, kind: &Kind, views: &Views, index: u32, cells: usize) -> [f64; 4] {
    let view = crate::view(world);
    let shines = |y: &_| (kind.shines)(&view, y);
    let surfaces = views.surfaces(index);
    quarters(SIZE, luminances(surfaces.iter().map(|x| bounce(&view, x, WALL, cells, &shines))))
}

type Case = (&'static str, Settings, u32);

fn cases() -> [Case; 6] {
    let fresh = Settings { temporal: 0, spatial: 0, ..one() };
    let pairs = Settings { spatial: 1, ..fresh };
    let history = Settings { temporal: 1, ..fresh };
    [
        ("fresh", fresh, 1),
        ("pairs", pairs, 1),
        ("pairs, 3 times", Settings { spatial_iterations: 3, ..pairs }, 1),
        ("history", history, 4),
        ("history, cap 1", Settings { confidence_cap: 1.0, ..history }, 4),
        ("history and pairs, 2 times", Settings { spatial_iterations: 2, temporal: 1, ..pairs }, 4),
    ]
}

/// A point behind a screen, and a lamp that rays find.
#[test]
fn reuse_has_the_mean_of_quadrature() {
    for (kind, cells) in [(&KINDS[0], 160), (&KINDS[3], 80)] {
        let world = lit(kind);
        let views = views(&world);
        let exact = [0, 1].map(|index| truth(&world, kind, &views, index, cells));
        let coarse = truth(&world, kind, &views, 1, cells * 3 / 4);
        let agree = coarse.iter().zip(exact[1]).all(|(a, b)| (a / b - 1.0).abs() < 2.0 * QUADRATURE);
        assert!(agree, "{}: quadratures {coarse:?} and {exact:?}", kind.name);
        for (name, settings, frames) in cases() {
            let runs = runs(&world, &views, settings, frames, None, RUNS);
            let t = largest_t(&runs, exact[(frames as usize - 1) & 1], QUADRATURE);
            println!("{}, {name}: {t:.2} standard errors", kind.name);
            assert!(t < T_LIMIT, "{}, {name}: {t} standard errors off", kind.name);
        }
    }
}

fn is_seen(plant: Plant, kind: &Kind, (_, settings, frames): Case) {
    let world = lit(kind);
    let views = views(&world);
    let exact = truth(&world, kind, &views, frames - 1, if kind.name == "lamp" { 80 } else { 160 });
    let t = largest_t(&runs(&world, &views, settings, frames, Some(plant), RUNS), exact, QUADRATURE);
    println!("{plant:?}: {t:.2} standard errors");
    assert!(t > T_LIMIT, "{plant:?} was not seen: {t} standard errors");
}

#[test]
fn planted_errors_are_seen() {
    let [fresh, pairs, often, _, _, both] = cases();
    let (point, lamp) = (&KINDS[0], &KINDS[3]);
    is_seen(Plant::Geometry, point, fresh);
    is_seen(Plant::Reflectance, point, both);
    is_seen(Plant::Balance, lamp, fresh);
    is_seen(Plant::EmptyForgotten, point, pairs);
    is_seen(Plant::ForeignTarget, point, often);
}

/// All bounces between two plates that face each other, in closed form.
#[test]
fn furnaces_are_closed_by_reuse() {
    let world = plates(glossy(Vec3::splat(0.7), 0.0, 0.8), 60.0);
    let eyes = [Vec3::new(0.5, 0.6, 0.6), Vec3::new(0.52, 0.6, 0.62)];
    let views = Views::new(&world, SIZE, eyes, Vec3::new(0.3, -0.5, 0.4));
    // Pixels differ by 2e-3 at most.
    let of = |bounces| {
        let x = views.surfaces(0)[8];
        [between_plates(&x.reflectance, f64::from(x.normal.dot(x.wo)), bounces); 4]
    };
    // What x2 emits, once reflected: as if the series began one bounce earlier.
    let emission = of(1)[0].powi(2) / (of(2)[0] - of(1)[0]);
    for (mode, bounces) in [(indirect::ONE, 1), (indirect::FULL, UNBOUNDED)] {
        let (all, exact) = (settings(mode), of(bounces));
        let fresh = Settings { temporal: 0, spatial: 0, ..all };
        for (name, settings, frames) in [("fresh", fresh, 1), ("reuse", all, 3)] {
            let t = largest_t(&runs(&world, &views, settings, frames, None, RUNS), exact, QUADRATURE);
            println!("{bounces} bounces, {name}: {t:.2} standard errors of {exact:?}");
            assert!(t < T_LIMIT, "{bounces} bounces, {name}: {t} standard errors off");
        }
        // Negative controls: emission that the first ray meets, counted once more; a path that goes on for nothing.
        let runs_of = |plant| runs(&world, &views, fresh, 1, plant, RUNS);
        let twice = exact.map(|light| light + emission);
        assert!(largest_t(&runs_of(None), twice, QUADRATURE) > T_LIMIT, "emission counted twice");
        if mode == indirect::FULL {
            for plant in [Plant::Survival, Plant::Alone] {
                let t = largest_t(&runs_of(Some(plant)), exact, QUADRATURE);
                println!("{plant:?}: {t:.2} standard errors");
                assert!(t > T_LIMIT, "{plant:?} was not seen: {t}");
            }
        }
    }
}

/// A screen comes between the wall and its light. What histories know is out of date, and dropped.
#[test]
fn histories_of_another_scene_are_dropped() {
    let kind = &KINDS[0];
    let before = open(kind).finished();
    let after = screened(open(kind), Vec3::new(-0.7, 0.55, -0.45), Vec3::X * 1.2, Vec3::Y * 1.5).finished();
    let views = views(&before);
    let exact = truth(&after, kind, &views, 3, 160);
    let run = |plant, seed| {
        let mut sequence = Sequence::new(&before, &views, one(), seed, plant);
        (0..3).for_each(|_| drop(sequence.next_frame()));
        sequence.change(&after);
        let light = sequence.next_frame();
        quarters(SIZE, light.iter().map(|&light| f64::from(luminance(light))))
    };
    let runs = |plant| (1..=RUNS).map(|seed| run(plant, seed)).collect::<Vec<_>>();
    let (t, stale) =
        (largest_t(&runs(None), exact, QUADRATURE), largest_t(&runs(Some(Plant::Stale)), exact, QUADRATURE));
    println!("{t:.2} standard errors, stale {stale:.2}");
    assert!(t < T_LIMIT && stale > T_LIMIT, "{t} and {stale}");
}

/// Two rooms over one floor, under one ceiling, with a wall between them at x = 0; the one at x < 0 is lit.
fn rooms() -> World {
    let mut world = World::default();
    let white = Material { flags: flag::DOUBLE_SIDED, ..matt(Vec3::ONE) };
    world.square(Vec3::new(-3.0, 0.0, -3.0), Vec3::Z * 6.0, Vec3::X * 6.0, white);
    world.square(Vec3::new(-3.0, 2.0, -3.0), Vec3::X * 6.0, Vec3::Z * 6.0, white);
    for x in [-3.0, 0.0, 3.0] {
        world.square(Vec3::new(x, 0.0, -3.0), Vec3::Y * 2.0, Vec3::Z * 6.0, white);
    }
    for z in [-3.0, 3.0] {
        world.square(Vec3::new(-3.0, 0.0, z), Vec3::X * 6.0, Vec3::Y * 2.0, white);
    }
    world.lights.push(shared::light::Light::point(Vec3::new(-1.0, 1.5, 0.5), Vec3::splat(1000.0)));
    world.finished()
}

/// A lit room behind a wall: not one photon.
#[test]
fn walls_leak_nothing() {
    let world = rooms();
    let eyes = |x: f32| [Vec3::new(x, 1.0, 1.0), Vec3::new(x * 1.02, 1.0, 1.02)];
    let forward = |x: f32| Vec3::new(-x, -0.3, -1.5);
    let light = |x: f32| {
        let views = Views::new(&world, SIZE, eyes(x), forward(x));
        let mut sequence = Sequence::new(&world, &views, settings(indirect::FULL), 1, None);
        (0..60).map(|_| sequence.next_frame().iter().sum::<Vec3>()).sum::<Vec3>()
    };
    assert_eq!(light(1.5), Vec3::ZERO);
    assert!(light(-1.5).min_element() > 0.0);
}

/// Cameras in the plane of the wall see the floor of both rooms, a pixel of either beside the other: reuse crosses the wall, its
/// light does not. Rays left out are seen: they let light into the dark, or take it from where it is.
#[test]
fn rays_decide_at_a_wall() {
    let world = rooms();
    // Turned by a part of a pixel from frame to frame, so that pixels beside the wall have histories on its other side.
    let eyes = [Vec3::new(0.0, 1.8, 0.5), Vec3::new(0.0, 1.7, 0.4)];
    let views =
        Views::turned(&world, SIZE, eyes, [Vec3::new(0.03, -1.0, -0.4), Vec3::new(-0.03, -1.0, -0.3)]);
    let sums = |settings, frames, plant| {
        let (mut dark, mut lit) = (0.0, Vec::new());
        for seed in 1..=RUNS {
            let mut sequence = Sequence::new(&world, &views, settings, seed, plant);
            let last = (0..frames).map(|_| sequence.next_frame()).last().expect("a frame");
            let mut sum = 0.0;
            for (x, light) in views.surfaces(frames - 1).iter().zip(&last) {
                let light = f64::from(luminance(*light));
                if x.position.x > 0.0 { dark += light } else { sum += light }
            }
            lit.push([sum; 4]);
        }
        (dark, lit)
    };
    let [fresh, pairs, _, history, ..] = cases().map(|(_, settings, _)| settings);
    let mean = |runs: &[[f64; 4]]| runs.iter().map(|run| run[0]).sum::<f64>() / runs.len() as f64;
    // Pixels in the dark have histories in the light in one of the two views, the others in the other.
    for (plant, settings, frames) in [
        (None, pairs, 4),
        (None, history, 4),
        (None, history, 5),
        (Some(Plant::PartnerRay), pairs, 4),
        (Some(Plant::SurvivorRay), history, 4),
        (Some(Plant::HistoryRay), history, 5),
    ] {
        let (dark, lit) = sums(fresh, frames, None);
        assert_eq!(dark, 0.0);
        let exact = [mean(&lit); 4];
        let error = largest_t(&lit, [0.0; 4], 0.0).recip();
        let (dark, lit) = sums(settings, frames, plant);
        let t = largest_t(&lit, exact, error);
        println!("{plant:?}: {dark} in the dark, {t:.2} standard errors where it is lit");
        match plant {
            None => assert!(dark == 0.0 && t < T_LIMIT, "{dark} in the dark, {t}"),
            Some(Plant::HistoryRay) => assert!(t > T_LIMIT, "{t}"),
            Some(_) => assert!(dark > 0.0, "{plant:?}"),
        }
    }
}

/// 10,000 frames of all bounces, beside a corner, a smooth metal and a pane: finite, and as bright at the end as at the beginning.
#[test]
fn ten_thousand_frames_keep_their_energy() {
    let mut world = stage(Material { flags: flag::DOUBLE_SIDED, ..glossy(Vec3::splat(0.9), 1.0, 0.1) }, true);
    (KINDS[3].light)(&mut world);
    let side = Material { flags: flag::DOUBLE_SIDED, ..matt(Vec3::splat(0.9)) };
    world.square(Vec3::new(0.45, 0.0, -2.0), Vec3::Z * 4.0, Vec3::Y, side);
    let pane = Material { alpha: 0.5, flags: flag::BLEND | flag::DOUBLE_SIDED, ..matt(Vec3::ONE) };
    world.square(Vec3::new(-2.0, 0.3, -0.6), Vec3::X * 2.0, Vec3::Y, pane);
    let world = world.finished();
    let eyes = [Vec3::new(0.2, 1.0, 1.8), Vec3::new(0.22, 1.02, 1.83)];
    let views = Views::new(&world, UVec2::new(4, 2), eyes, Vec3::new(-0.1, -0.9, -1.9));
    let mut sequence = Sequence::new(&world, &views, settings(indirect::FULL), 1, None);
    let batches: Vec<f64> = (0..200)
        .map(|_| {
            let frame = |_| {
                let light = sequence.next_frame();
                assert!(light.iter().all(|c| c.is_finite()), "frame {}", sequence.index);
                light.iter().map(|&c| f64::from(luminance(c))).sum::<f64>()
            };
            (0..50).map(frame).sum::<f64>() / 50.0
        })
        .collect();
    let of = |batches: &[f64]| {
        let n = batches.len() as f64;
        let mean = batches.iter().sum::<f64>() / n;
        (mean, (batches.iter().map(|b| (b - mean).powi(2)).sum::<f64>() / (n - 1.0) / n).sqrt())
    };
    let (first, last) = (of(&batches[..100]), of(&batches[100..]));
    let t = (first.0 - last.0).abs() / first.1.hypot(last.1);
    println!("{first:?}, {last:?}: t {t:.2}");
    assert!(t < T_LIMIT, "{first:?} and {last:?}");
}
