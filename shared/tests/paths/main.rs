//! The truth of light that bounces, the very body of the GPU's pass, against closed forms and quadrature; and errors planted in
//! it, each of which the same comparison must see. [`resampled`]: the same of the passes that resample it, run by [`frames`].
//!
//! A test compares means of independent paths: |t| < 4.5 is exceeded by chance in 7e-6 of all choices of seeds, which are fixed.

extern crate candela_shared as shared;

mod frames;
mod resampled;
mod truth;
mod world;

use shared::bsdf;
use shared::glam::{DVec3, UVec2, Vec2, Vec3};
use shared::interface::UNBOUNDED;
use shared::light::Light;
use shared::material::{Material, Reflectance, flag, slot};
use shared::passes::paths::{Arrival, Bounce};
use shared::passes::{Silent, Technique, Witness};
use shared::surface::Surface;
use std::f64::consts::PI;
use truth::{Wall, bounce, lit, y};
use world::{Estimate, View, World, glossy, grid, lamp, matt};

const T_LIMIT: f64 = 4.5;

/// One step done wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Plant {
    /// Lights that the table draws weigh as if no ray could find them.
    Balance,
    /// A ray that finds a light compares densities of two measures.
    Measure,
    /// The cosine where a path goes on.
    Cosine,
    /// The density there is that of the diffuse lobe alone.
    Density,
    /// The probability of going on.
    Survival,
}

#[derive(Clone, Copy)]
struct Falsifier(Plant);

impl Witness for Falsifier {
    fn bounces(&mut self, bounce: &mut Bounce) {
        match self.0 {
            Plant::Cosine => bounce.cos = 1.0,
            Plant::Density if bounce.density > 0.0 => bounce.density = bounce.cos / std::f32::consts::PI,
            _ => {}
        }
    }

    fn arrives(&mut self, technique: Technique, arrival: &mut Arrival) {
        match (self.0, technique) {
            (Plant::Balance, Technique::Table) => arrival.found = 0.0,
            (Plant::Measure, Technique::Bsdf) => arrival.drawn *= 0.2,
            _ => {}
        }
    }

    fn survives(&mut self, survival: &mut f32) {
        if self.0 == Plant::Survival {
            *survival = 1.0;
        }
    }
}

fn agrees(what: &str, estimate: Estimate, truth: f64) {
    let t = estimate.t(truth);
    println!("{what}: {estimate:?}, truth {truth}, t {t:.2}");
    assert!(t < T_LIMIT, "{what}: {estimate:?} is not {truth}: t {t:.2}");
}

fn is_seen(what: &str, estimate: Estimate, truth: f64) {
    let t = estimate.t(truth);
    println!("{what}: {estimate:?}, truth {truth}, t {t:.2}");
    assert!(t > T_LIMIT, "{what} was not seen: {estimate:?}, truth {truth}, t {t:.2}");
}

/// Two plates that face each other, emit 1 nit and reflect alike; `half` as long as endless ones are, m.
fn plates(material: Material, half: f32) -> World {
    let mut world = World::default();
    let shining = Material { emission: Vec3::ONE, ..material };
    let (corner, x, z) = (Vec3::new(-half, 0.0, -half), Vec3::X * 2.0 * half, Vec3::Z * 2.0 * half);
    world.square(corner, z, x, shining);
    world.square(corner + Vec3::Y, x, z, shining);
    world.finished()
}

/// Light that leaves such a plate after `bounces` + 1 reflections or fewer, but more than one, at cosθ = `cos`. A ray leaves one
/// plate at the angle at which it meets the other, so L of k + 1 reflections is ∫ f L_k cosθ dω of each angle alone: 200 angles,
/// in cos²θ, by as many in φ.
fn between_plates(reflectance: &Reflectance, cos: f64, bounces: u32) -> f64 {
    const N: usize = 200;
    let node = |i: usize| ((i as f64 + 0.5) / N as f64).sqrt();
    let direction = |cos: f64, phi: f64| {
        let sin = (1.0 - cos * cos).sqrt();
        DVec3::new(sin * phi.cos(), cos, sin * phi.sin()).as_vec3()
    };
    let row = |from: f64| -> Vec<f64> {
        let wo = direction(from, 0.0);
        let kernel = |to: f64| {
            let f = |k: usize| {
                let wi = direction(to, PI * (k as f64 + 0.5) / N as f64);
                y(bsdf::eval::<Vec3>(reflectance, Vec3::Y, wo, wi).as_dvec3())
            };
            // ∫ f cosθ dω = π x the mean of f over cos²θ and φ.
            PI * (0..N).map(f).sum::<f64>() / (N * N) as f64
        };
        (0..N).map(|j| kernel(node(j))).collect()
    };
    let rows: Vec<Vec<f64>> = (0..N).map(|i| row(node(i))).collect();
    let times = |row: &[f64], light: &[f64]| row.iter().zip(light).map(|(k, l)| k * l).sum::<f64>();
    let (seen, mut light, mut sum) = (row(cos), vec![1.0; N], 0.0);
    for _ in 0..bounces.min(200) {
        light = rows.iter().map(|row| times(row, &light)).collect();
        sum += times(&seen, &light);
    }
    sum
}

/// A furnace is closed to 1e-3 (of three bounces 2e-3, of all 4e-3): glTF's dielectric keeps another part of the light at each angle, and a rough metal loses some,
/// which is known.
#[test]
fn furnaces_are_closed() {
    let materials =
        [glossy(Vec3::splat(0.7), 0.0, 0.8), glossy(Vec3::splat(0.9), 1.0, 0.7), matt(Vec3::splat(0.8))];
    for material in materials {
        let world = plates(material, 500.0);
        let view = world.view(Vec3::new(0.5, 0.6, 0.6), Vec3::new(0.3, -0.5, 0.4));
        let cos = f64::from(view.surface.normal.dot(view.surface.wo));
        let truth = |bounces| between_plates(&view.surface.reflectance, cos, bounces);
        for (bounces, allowed) in [(1, 1e-3), (3, 2e-3), (UNBOUNDED, 4e-3)] {
            let (truth, estimate) = (truth(bounces), view.paths(bounces, 400_000, Silent));
            agrees(&format!("{bounces} bounces"), estimate, truth);
            assert!((estimate.mean / truth - 1.0).abs() < allowed, "{estimate:?} is not {truth}");
            assert!(estimate.error < 1.5 * allowed * truth, "{estimate:?}");
        }
        let endless = truth(UNBOUNDED);
        is_seen("Cosine", view.paths(1, 20_000, Falsifier(Plant::Cosine)), truth(1));
        is_seen("Survival", view.paths(UNBOUNDED, 20_000, Falsifier(Plant::Survival)), endless);
        // Emission that the first ray meets is direct light: with it the sum begins one reflection earlier.
        let twice = view.paths(UNBOUNDED, 20_000, Silent);
        let direct = truth(1) * truth(1) / (truth(2) - truth(1));
        is_seen("direct light counted twice", Estimate { mean: twice.mean + direct, ..twice }, endless);
    }
}

/// A white furnace, closed to 1e-3: mirrors that reflect all show the white sky, by whatever way.
#[test]
fn mirrors_under_a_white_sky_are_white() {
    let mut world = World::default();
    let mirror = Material { flags: flag::DOUBLE_SIDED, ..glossy(Vec3::ONE, 1.0, 0.0) };
    world.square(Vec3::new(-5.0, 0.0, -1.0), Vec3::Z * 6.0, Vec3::X * 10.0, mirror);
    world.square(Vec3::new(-1.0, 0.0, -1.0), Vec3::X * 2.5, Vec3::Y * 1.5, mirror);
    world.sky(UVec2::new(8, 4), |_| Vec3::ONE);
    let world = world.finished();
    let view = world.view(Vec3::new(0.2, 1.0, 2.0), Vec3::new(0.0, -1.0, -2.4));
    let estimate = view.paths(UNBOUNDED, 20_000, Silent);
    println!("{estimate:?}");
    assert!((estimate.mean - 1.0).abs() < 1e-3, "{estimate:?}");
    let planted = view.paths(UNBOUNDED, 20_000, Falsifier(Plant::Density));
    assert!((planted.mean - 1.0).abs() > 1e-3, "{planted:?}");
}

const FLOOR: Wall = Wall {
    corner: Vec3::new(-2.0, 0.0, -2.0),
    u: Vec3::new(0.0, 0.0, 4.0),
    v: Vec3::new(4.0, 0.0, 0.0),
    reflectance: |_| Reflectance {
        diffuse: Vec3::new(0.576, 0.48, 0.384),
        f0: Vec3::splat(0.04),
        roughness: 0.5,
    },
};

const WALL: Wall = Wall {
    corner: Vec3::new(-1.5, 0.5, -1.0),
    u: Vec3::new(3.0, 0.0, 0.0),
    v: Vec3::new(0.0, 2.0, 0.0),
    reflectance: |uv| Reflectance::from_metallic_roughness(grid(uv), 0.7, 0.45),
};

/// A glossy floor before a textured wall that is half a metal, and a black screen.
fn stage(wall: Material, screened: bool) -> World {
    let mut world = World::default();
    // A dielectric's diffuse color is not dimmed by its F0.
    world.square(FLOOR.corner, FLOOR.u, FLOOR.v, glossy(Vec3::new(0.576, 0.48, 0.384), 0.0, 0.5));
    world.square(WALL.corner, WALL.u, WALL.v, wall);
    let black = Material { flags: flag::DOUBLE_SIDED, ..matt(Vec3::ZERO) };
    if screened {
        // Askew: edges along a quadrature's cells would fall on them or not.
        let (u, v) = (Vec3::new(0.5, 0.13, 0.05), Vec3::new(-0.17, 0.6, 0.02));
        world.square(Vec3::new(0.2, 0.9, -0.6), u, v, black);
    }
    world
}

fn textured_wall() -> Material {
    let mut wall = glossy(Vec3::ONE, 0.7, 0.45);
    wall.textures[slot::BASE_COLOR] = 0;
    wall.uv_maps = Default::default();
    wall
}

fn view(world: &World) -> View<'_> {
    world.view(Vec3::new(0.6, 1.0, 1.8), Vec3::new(-0.5, -1.0, -1.9))
}

/// A kind of light: how it is put into a world, and what it brings to a point.
struct Kind {
    name: &'static str,
    light: fn(&mut World),
    shines: fn(&View<'_>, &Surface) -> DVec3,
    /// Cells of the wall, along a side: shadows of points have edges.
    cells: usize,
}

const POINT: Vec3 = Vec3::new(0.9, 1.6, 0.4);
const SUN: Vec3 = Vec3::new(0.36, 0.48, 0.8);
const SPOT: (Vec3, Vec3) = (Vec3::new(-0.8, 1.8, 0.9), Vec3::new(0.28, -0.3, -0.912));
const LAMP: [Vec3; 3] = [Vec3::new(-1.1, 1.3, 0.3), Vec3::new(0.0, 0.6, 0.0), Vec3::new(0.7, 0.0, 0.1)];
const SKY: UVec2 = UVec2::new(8, 4);

fn sky(texel: UVec2) -> Vec3 {
    Vec3::new(1.0, 0.5, 0.3 + texel.x as f32 * 0.2) * (1 + (texel.x * 5 + texel.y * 3) % 7) as f32
}

const KINDS: [Kind; 5] = [
    Kind {
        name: "point",
        cells: 320,
        light: |world| world.lights.push(Light::point(POINT, Vec3::new(3.0, 2.0, 1.0))),
        shines: |view, y| {
            let d = (POINT - y.position).as_dvec3();
            lit(view, y, POINT.as_dvec3(), DVec3::new(3.0, 2.0, 1.0) / d.length_squared())
        },
    },
    Kind {
        name: "sun",
        cells: 320,
        light: |world| world.lights.push(Light::directional(SUN, Vec3::new(3.0, 2.0, 1.0), world::RADIUS)),
        shines: |view, y| {
            lit(view, y, y.position.as_dvec3() + SUN.as_dvec3() * 50.0, DVec3::new(3.0, 2.0, 1.0))
        },
    },
    Kind {
        name: "spot",
        cells: 320,
        light: |world| world.lights.push(Light::spot(SPOT.0, SPOT.1, Vec3::new(9.0, 6.0, 3.0), 0.1, 0.6)),
        shines: |view, y| {
            let d = (SPOT.0 - y.position).as_dvec3();
            let (cos, inner, outer) = (-d.normalize().dot(SPOT.1.as_dvec3()), 0.1f64.cos(), 0.6f64.cos());
            let fall_off = ((cos - outer) / (inner - outer)).clamp(0.0, 1.0).powi(2);
            lit(view, y, SPOT.0.as_dvec3(), DVec3::new(9.0, 6.0, 3.0) * fall_off / d.length_squared())
        },
    },
    Kind {
        name: "lamp",
        cells: 64,
        light: |world| world.square(LAMP[0], LAMP[1], LAMP[2], lamp(Vec3::new(8.0, 5.0, 3.0))),
        shines: |view, y| {
            const N: usize = 12;
            let normal = LAMP[1].cross(LAMP[2]).as_dvec3();
            let mut sum = DVec3::ZERO;
            for i in 0..N * N {
                let place = Vec2::new((i % N) as f32 + 0.5, (i / N) as f32 + 0.5) / N as f32;
                let at = (LAMP[0] + LAMP[1] * place.x + LAMP[2] * place.y).as_dvec3();
                let d = y.position.as_dvec3() - at;
                let cos = normal.dot(d.normalize()).max(0.0);
                sum += lit(view, y, at, DVec3::new(8.0, 5.0, 3.0) * (cos / d.length_squared()));
            }
            sum / (N * N) as f64
        },
    },
    Kind {
        name: "sky",
        cells: 48,
        light: |world| world.sky(SKY, sky),
        shines: |view, y| {
            const N: u32 = 4;
            let mut sum = DVec3::ZERO;
            for i in 0..SKY.x * N * SKY.y * N {
                let cell = UVec2::new(i % (SKY.x * N), i / (SKY.x * N));
                let theta = PI * (f64::from(cell.y) + 0.5) / f64::from(SKY.y * N);
                let phi = 2.0 * PI * (f64::from(cell.x) + 0.5) / f64::from(SKY.x * N) - PI;
                let edge = |row: u32| (PI * f64::from(row) / f64::from(SKY.y * N)).cos();
                let solid_angle = (edge(cell.y) - edge(cell.y + 1)) * 2.0 * PI / f64::from(SKY.x * N);
                let d = DVec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin());
                let to = y.position.as_dvec3() + d * 50.0;
                sum += lit(view, y, to, sky(cell / N).as_dvec3() * solid_angle);
            }
            sum
        },
    },
];

/// Each kind of light after one reflection at a textured, glossy wall, partly behind a screen; and errors planted in that.
#[test]
fn one_bounce_under_every_kind_of_light() {
    for kind in &KINDS {
        let mut world = stage(textured_wall(), true);
        (kind.light)(&mut world);
        let world = world.finished();
        let view = view(&world);
        let truth = |n| y(bounce(&view, &view.surface, WALL, n, &|y| (kind.shines)(&view, y)));
        let (exact, coarse) = (truth(kind.cells), truth(kind.cells * 3 / 4));
        assert!((coarse / exact - 1.0).abs() < 3e-3, "{}: quadrature {coarse} and {exact}", kind.name);
        agrees(kind.name, view.paths(1, 500_000, Silent), exact);
        let planted = match kind.name {
            "lamp" | "sky" => &[Plant::Cosine, Plant::Density, Plant::Balance, Plant::Measure][..],
            _ => &[Plant::Cosine, Plant::Density],
        };
        for &plant in planted {
            is_seen(&format!("{}: {plant:?}", kind.name), view.paths(1, 60_000, Falsifier(plant)), exact);
        }
    }
}

/// Light that went from the floor to the wall and back.
#[test]
fn two_bounces_under_a_point_light() {
    let mut world = stage(textured_wall(), false);
    (KINDS[0].light)(&mut world);
    let world = world.finished();
    let view = view(&world);
    let shines = |y: &Surface| (KINDS[0].shines)(&view, y);
    let from_floor = |y: &Surface| shines(y) + bounce(&view, y, FLOOR, 32, &shines);
    let exact = y(bounce(&view, &view.surface, WALL, 20, &from_floor));
    let estimate = view.paths(2, 800_000, Silent);
    agrees("two bounces", estimate, exact);
    let one = y(bounce(&view, &view.surface, WALL, 20, &shines));
    is_seen("the second bounce left out", Estimate { mean: one, ..estimate }, exact);
}

/// The back of a single-sided wall blocks light and reflects none; that of a double-sided one reflects.
#[test]
fn backs_reflect_where_they_are_double_sided() {
    let light = |flags| {
        let mut world = World::default();
        world.square(FLOOR.corner, FLOOR.u, FLOOR.v, matt(Vec3::ONE));
        let wall = Material { flags, ..matt(Vec3::ONE) };
        world.square(WALL.corner, WALL.v, WALL.u, wall);
        world.lights.push(Light::point(POINT, Vec3::ONE));
        let world = world.finished();
        view(&world).paths(1, 10_000, Silent)
    };
    assert_eq!(light(0).mean, 0.0);
    assert!(light(flag::DOUBLE_SIDED).mean > 0.0);
}

/// A pane of alpha 1/2 before the wall is passed twice: a quarter arrives.
#[test]
fn panes_are_passed_with_their_probability() {
    let light = |alpha: Option<f32>| {
        let mut world = World::default();
        world.square(FLOOR.corner, FLOOR.u, FLOOR.v, matt(Vec3::ONE));
        world.square(WALL.corner, WALL.u, WALL.v, matt(Vec3::ONE));
        if let Some(alpha) = alpha {
            let pane = Material { alpha, flags: flag::BLEND | flag::DOUBLE_SIDED, ..matt(Vec3::ZERO) };
            let around = Vec3::new(-0.5, -0.4, 0.05);
            world.square(WALL.corner + around, WALL.u + Vec3::X, WALL.v + Vec3::Y, pane);
        }
        world.lights.push(Light::point(POINT, Vec3::ONE));
        let world = world.finished();
        view(&world).paths(1, 200_000, Silent)
    };
    let clear = light(None);
    let through = light(Some(0.5));
    let error = through.error.hypot(clear.error / 4.0);
    agrees("a pane", Estimate { error, ..through }, clear.mean / 4.0);
    is_seen("passed once", Estimate { error, ..through }, clear.mean / 2.0);
}
