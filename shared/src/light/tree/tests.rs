use super::*;
use crate::light::kinds::SAMPLES;
use crate::light::{Light, LightSample, Lights};
use crate::rng::Stream;
use core::f32::consts::{PI, TAU};
use glam::UVec2;

fn rng(i: u32) -> Rng {
    Rng::new(UVec2::new(i, 7), 0, 11, Stream::Pools, 0)
}

fn in_cube(rng: &mut Rng, size: f32) -> Vec3 {
    let random = rng.next_u32x4();
    (Vec3::new(unit_f32(random.x), unit_f32(random.y), unit_f32(random.z)) - 0.5) * size
}

fn direction(rng: &mut Rng) -> Vec3 {
    let random = rng.next_u32x4();
    let (z, phi) = (unit_f32(random.x) * 2.0 - 1.0, unit_f32(random.y) * TAU);
    let r = (1.0 - z * z).max(0.0).sqrt();
    Vec3::new(r * phi.cos(), r * phi.sin(), z)
}

/// `count` lights of every kind in turns, some of them dark, in a cube of 20 m.
fn lights(count: usize, seed: u32) -> Vec<Light> {
    let mut rng = rng(seed);
    let light = |i: usize| {
        let (_, known) = SAMPLES[i % SAMPLES.len()];
        let light = known(0.1 + unit_f32(rng.next_u32x4().x) * 3.0).light;
        let strength = if i % 11 == 3 { 0.0 } else { 10f32.powf(unit_f32(rng.next_u32x4().x) * 6.0 - 3.0) };
        Light {
            position: light.position + in_cube(&mut rng, 20.0),
            emission: light.emission * strength,
            ..light
        }
    };
    (0..count).map(light).collect()
}

fn receiver(rng: &mut Rng) -> Receiver {
    let radius = 10f32.powf(unit_f32(rng.next_u32x4().x) * 4.0 - 3.0);
    Receiver { center: in_cube(rng, 60.0), radius, normal: direction(rng) }
}

/// Rays of every node, by chance, of which a part arrived.
fn beliefs(seed: u32) -> Vec<u32> {
    let ray = |i: u32| {
        let random = rng(seed ^ i).next_u32x4();
        let asked = random.x >> 20;
        asked << 16 | (unit_f32(random.y) * asked as f32) as u32
    };
    (0..1 << 12).map(ray).collect()
}

fn of_cell(table: &[u32]) -> Beliefs<'_> {
    Beliefs { table, cells: table.len() as u32 / belief::BELIEFS, cell: 3 }
}

/// For any receiver, and any number of lights, what is told of all lights together is 1, and of each what it is drawn with: the
/// sum in f64 within 1e-5.
#[test]
fn probabilities_add_up_to_one() {
    let mut rng = rng(1);
    for count in (1..40).chain([100, 1000, 3333]) {
        let lights = lights(count, count as u32);
        let tree = build(&lights);
        let known = beliefs(count as u32);
        for _ in 0..20 {
            let receiver = receiver(&mut rng);
            let pmf = |light| f64::from(tree.view().draw(light, &receiver, &of_cell(&known), 0.4).pmf.0);
            let sum: f64 = (0..count as u32).map(pmf).sum();
            let somewhere = !tree.lights.is_empty();
            assert!((sum - if somewhere { 1.0 } else { 0.0 }).abs() < 1e-5, "{count} lights: {sum}");
        }
    }
}

/// Chi-square over 24 lights, false alarm 1e-4 for each of 6 receivers (fixed seeds); probabilities of another receiver are seen
/// to be wrong.
#[test]
fn draws_follow_their_probabilities() {
    const N: usize = 40_000;
    let lights: Vec<Light> = (0..24).map(|i| Light::point(in_cube(&mut rng(i), 20.0), Vec3::ONE)).collect();
    let tree = build(&lights);
    let known = beliefs(1);
    let draw = |light, receiver: &Receiver| tree.view().draw(light, receiver, &of_cell(&known), 0.4);
    let mut rng = rng(99);
    for _ in 0..6 {
        let [receiver, other] = [receiver(&mut rng), receiver(&mut rng)];
        let mut counts = [0u32; 24];
        for _ in 0..N {
            let drawn = tree.view().sample(&receiver, &of_cell(&known), 0.4, &mut rng);
            assert_eq!(drawn, draw(drawn.light, &receiver));
            counts[drawn.light as usize] += 1;
        }
        let chi2 = |receiver: &Receiver| -> f64 {
            let term = |(light, &count): (u32, &u32)| {
                let expected = f64::from(draw(light, receiver).pmf.0) * N as f64;
                (f64::from(count) - expected).powi(2) / expected
            };
            (0..).zip(&counts).map(term).sum()
        };
        // 23 degrees of freedom, quantile 0.9999.
        assert!(chi2(&receiver) < 55.5, "{}", chi2(&receiver));
        assert!(chi2(&other) > 55.5, "the planted error was not seen");
    }
}

/// Each kind: its points lie in its box, and no light leaves its cone, seen from anywhere.
#[test]
fn lights_are_within_their_bounds() {
    let mut rng = rng(5);
    let (mut lit, mut dark) = (0, 0);
    for (name, known) in SAMPLES {
        let light = known(1.5).light;
        let Some(bound) = light.bound() else { continue };
        let lights = [light];
        for _ in 0..5000 {
            let sample = LightSample { light: 0, uv: rng.next_u32x4().x };
            let receiver = in_cube(&mut rng, 20.0);
            let incident = Lights::untextured(&lights).incident(sample, receiver);
            let slack = Vec3::splat(1e-5);
            let p = incident.position;
            assert!(p.cmpge(bound.min - slack).all() && p.cmple(bound.max + slack).all(), "{name}: {p}");
            let angle = (-incident.direction.dot(bound.axis)).clamp(-1.0, 1.0).acos();
            if incident.irradiance.max_element() > 0.0 {
                assert!(angle <= bound.angle + 1e-3, "{name}: {angle} rad from its axis");
                lit += 1;
            } else {
                dark += 1;
            }
        }
    }
    assert!(lit > 1000 && dark > 1000, "{lit} and {dark}");
}

/// A node's cone, as stored, holds the directions of all lights below it.
#[test]
fn nodes_hold_the_cones_below_them() {
    let mut rng = rng(6);
    let mut narrow = 0;
    for i in 0..500 {
        let middle = direction(&mut rng);
        let lights: Vec<Light> = (0..1 + i % 5)
            .map(|_| {
                let axis = (middle + direction(&mut rng) * 0.7).normalize();
                let outer = 0.05 + unit_f32(rng.next_u32x4().x);
                Light::spot(in_cube(&mut rng, 1.0), axis, Vec3::ONE, 0.0, outer)
            })
            .collect();
        let root = build(&lights).nodes[0];
        let widest = (root.cone >> 16) as f32 * (PI / 65535.0);
        narrow += u32::from(widest < 2.5);
        for bound in lights.iter().filter_map(Light::bound) {
            let reach = root.axis().dot(bound.axis).clamp(-1.0, 1.0).acos() + bound.angle;
            assert!(reach <= widest + 1e-3 || widest > PI - 1e-3, "{reach} of {widest} rad");
        }
    }
    assert!(narrow > 200, "cones that say nothing: only {narrow} are narrow");
}

/// A lamp at hand is drawn before one of equal strength far away, and a spot that shines elsewhere after one that shines here.
#[test]
fn what_matters_is_drawn_more_often() {
    let spot = |x: f32, axis| Light::spot(Vec3::new(x, 3.0, 0.0), axis, Vec3::ONE, 0.2, 0.5);
    let lights = [
        Light::point(Vec3::Y * 2.0, Vec3::ONE),
        Light::point(Vec3::new(90.0, 2.0, 0.0), Vec3::ONE),
        spot(-0.5, Vec3::NEG_Y),
        spot(0.5, Vec3::Y),
    ];
    let tree = build(&lights);
    let receiver = Receiver { center: Vec3::ZERO, radius: 0.1, normal: Vec3::Y };
    let nothing = [0; belief::BELIEFS as usize];
    let pmf = |i| tree.view().draw(i, &receiver, &of_cell(&nothing), 1.0).pmf.0;
    assert!(pmf(0) > 1000.0 * pmf(1), "{} and {}", pmf(0), pmf(1));
    assert!(pmf(2) > 10.0 * pmf(3), "{} and {}", pmf(2), pmf(3));
}

/// What is believed of a node counts for all lights below it, and its own rays for a light more than its parents'.
#[test]
fn hidden_branches_are_drawn_rarely() {
    let lamps = |x: f32| (0..8).map(move |i| Light::point(Vec3::new(x, 5.0, i as f32), Vec3::ONE));
    let lights: Vec<Light> = lamps(-20.0).chain(lamps(20.0)).collect();
    let tree = build(&lights);
    let receiver = Receiver { center: Vec3::ZERO, radius: 0.5, normal: Vec3::Y };
    let mut table = vec![0; 1 << 12];
    let chance = |table: &[u32], light| {
        let Draw { pmf, visibility, .. } = tree.view().draw(light, &receiver, &of_cell(table), 1.0);
        (pmf.0, visibility)
    };
    let before = chance(&table, 3);
    // Every ray to the first eight lights but one was asked for, and none arrived.
    let observe = |table: &mut [u32], light: u32, seen| {
        path(tree.leaves[light as usize], 16, |node| {
            let place = belief::place(16, 3, node) as usize;
            table[place] = belief::learned(table[place], belief::observation(seen) * 40);
        });
    };
    (0..8).filter(|&light| light != 3).for_each(|light| observe(&mut table, light, false));
    let unknown = chance(&table, 3);
    assert!(unknown.0 < 0.3 * before.0 && unknown.1 < 0.2, "{unknown:?} after {before:?}");
    observe(&mut table, 3, true);
    let seen = chance(&table, 3);
    let hidden = chance(&table, 2);
    assert!(seen.1 > 0.9 && hidden.1 < 0.1, "{seen:?}, {hidden:?}");
    assert!(seen.0 > 5.0 * hidden.0, "{seen:?}, {hidden:?}");
}
