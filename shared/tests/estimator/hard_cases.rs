//! Numbers that hurt. Each case names what it found wrong.

use crate::matrix::{base, fresh_cases, in_mode, reuse_cases};
use crate::passes::Sequence;
use crate::statistics::{T_LIMIT, expected, t_of};
use crate::world::{self, World};
use shared::frame::{Settings, mode};
use shared::geometry::{InstanceGeometry, Triangle, VertexAttributes};
use shared::glam::{Affine3A, UVec2, Vec2, Vec3};
use shared::light::{Light, LightSample};
use shared::math::pack_direction;
use shared::rng::{Rng, Stream, unit_f32};
use shared::sampling::square_to_triangle;
use shared::shadow::ShadowRay;

/// Fresh candidates and reuse in both modes have the right mean in `world`, and every value is finite.
fn is_right(name: &str, world: &World) {
    has_the_mean(name, world, &[mode::BIASED, mode::UNBIASED]);
    all_is_finite(name, world);
}

fn has_the_mean(name: &str, world: &World, modes: &[u32]) {
    let settings = Settings { candidates: 8, visibility_reuse: 1, temporal: 1, ..base() };
    let reuse = Settings { spatial: 1, spatial_iterations: 1, ..settings };
    let truth = expected(world, 2);
    assert!(truth.iter().all(|&mean| mean > 0.0), "{name}: {truth:?}");
    let fresh = [
        ("RIS", Settings { temporal: 0, ..settings }),
        ("RIS from tiles", Settings { temporal: 0, tiles: 1, ..settings }),
    ];
    let reuse = modes.iter().map(|&mode| ("reuse", Settings { mode, ..reuse }));
    for (what, settings) in fresh.into_iter().chain(reuse) {
        let t = t_of(&format!("{name}, {what}"), world, &truth, settings, 2, None);
        assert!(t < T_LIMIT, "{name}, {what}, mode {}: {t} standard errors off", settings.mode);
    }
}

/// In no pixel and no reservoir of any case is a NaN, an infinity or a negative number.
fn all_is_finite(name: &str, world: &World) {
    let views = [world.view(0), world.view(1)];
    let cases = [mode::BIASED, mode::UNBIASED].into_iter().flat_map(|m| in_mode(m, reuse_cases()));
    for (case, settings, frames) in fresh_cases().into_iter().chain(cases) {
        let mut sequence = Sequence::new(world, &views, settings, 77, None);
        for _ in 0..frames {
            for (i, radiance) in sequence.next_frame().iter().enumerate() {
                let good = radiance.is_finite() && radiance.min_element() >= 0.0;
                assert!(good, "{name}, {case}: pixel {i} is {radiance}");
            }
            for (i, r) in sequence.reservoirs().iter().enumerate() {
                let weight = r.contribution_weight;
                assert!(weight.is_finite() && weight >= 0.0, "{name}, {case}: reservoir {i} is {r:?}");
                let whole = r.confidence.fract() == 0.0 && r.confidence >= 0.0;
                assert!(whole, "{name}, {case}: reservoir {i} stands for {} candidates", r.confidence);
            }
        }
    }
}

#[test]
fn radiances_over_twelve_orders_of_magnitude() {
    let light = |i: i32| {
        let place = Vec3::new((i as f32 * 2.4).cos(), 1.0 + (i % 3) as f32, (i as f32 * 2.4).sin());
        Light::point(place, Vec3::new(1.0, 0.8, 0.6) * 10f32.powi(i % 13 - 6))
    };
    let lights: Vec<_> = (0..26).map(light).collect();
    is_right("1e-6 to 1e6 cd", &World::new(lights.clone()));
    // And seen alone: what is 1e-12 of the whole still has its exact mass. RIS of one candidate that drew it pays it back.
    let world = World::new(lights);
    let mass: f64 = (0..26).map(|i| mass_of(&world, i)).sum();
    assert!((mass - 1.0).abs() < 1e-6);
    assert!((0..26).all(|i| mass_of(&world, i) > 0.0), "a light of 1e-6 cd is never drawn");
}

/// Probability of a light, from the table's own entries.
fn mass_of(world: &World, light: u32) -> f64 {
    let own = world.alias.get(light as usize).map_or(0.0, |entry| f64::from(entry.pmf));
    let alias = world.alias.iter().find(|entry| entry.alias == light);
    own.max(alias.map_or(0.0, |entry| f64::from(entry.alias_pmf)))
}

/// 1/M weights have the right mean here too, but not one that 300 runs could see: a pixel's energy hangs on neighbors that find
/// its light once in 1e8 draws.
#[test]
fn lights_a_tenth_of_a_millimetre_away() {
    let mut world = World::new(world::points().everywhere);
    world.eyes = [world.eyes[0]; 2];
    let lit: Vec<Vec3> = world.view(0).surfaces.iter().map(|s| s.position).collect();
    world.lights.extend([5, 50, 100].map(|i| Light::point(lit[i] + Vec3::Y * 1e-4, Vec3::ONE)));
    let near = |i: usize| {
        let p = lit[i] + Vec3::Y * 1e-4;
        Light::triangle([p, p + Vec3::X * 1e-4, p + Vec3::Z * 1e-4], Vec3::splat(1e8), false)
    };
    world.lights.extend([30, 150].map(near));
    let lights = world.lights.clone();
    let world = world.with_lights(lights);
    has_the_mean("1e-4 m", &world, &[mode::UNBIASED]);
    all_is_finite("1e-4 m", &world);
}

#[test]
fn lights_a_hundred_kilometres_away() {
    let direction = |i: i32| Vec3::new((i as f32).cos(), 1.0 + (i % 2) as f32, (i as f32).sin()).normalize();
    let lights = (0..9).map(|i| {
        let place = direction(i) * 1e5;
        match i % 3 {
            0 => Light::point(place, Vec3::splat(3e10)),
            1 => Light::spot(place, -direction(i), Vec3::splat(1e10), 0.0, 0.5),
            _ => {
                let edge = direction(i).any_orthonormal_vector();
                let other = edge.cross(direction(i));
                Light::triangle([place, place + edge * 1e3, place + other * 1e3], Vec3::splat(1e4), true)
            }
        }
    });
    is_right("1e5 m", &World::new(lights.collect()));
}

/// An eye 6 cm above the floor that looks along it (1.5 to 40 degrees), and lights 1 cm above it.
#[test]
fn grazing_angles() {
    let low = |light: Light| Light { position: Vec3::new(light.position.x, 0.01, light.position.z), ..light };
    let mut world = World::new(world::points().everywhere.into_iter().map(low).collect());
    world.eyes = [Vec3::new(0.0, 0.06, 1.0), Vec3::new(0.0, 0.061, 1.0)];
    world.forward = Vec3::new(0.0, -0.43, -1.0);
    is_right("grazing", &world);
}

/// Lights at the very place of a surface, in its plane and under it give nothing, and take nothing from the others.
#[test]
fn lights_on_and_behind_the_surface() {
    let mut world = World::new(world::points().everywhere);
    world.eyes = [world.eyes[0]; 2];
    let truth = expected(&world, 1);
    let place = world.view(0).surfaces[70].position;
    world
        .lights
        .extend([Vec3::ZERO, Vec3::NEG_Y * 1e-3, Vec3::NEG_Y].map(|d| Light::point(place + d, Vec3::ONE)));
    let under = [place, place + Vec3::X, place + Vec3::Z].map(|p| p - Vec3::Y);
    world.lights.push(Light::triangle(under, Vec3::splat(10.0), true));
    let lights = world.lights.clone();
    let world = world.with_lights(lights);
    for (with, without) in expected(&world, 1).iter().zip(&truth) {
        assert!((with / without - 1.0).abs() < 1e-3, "the truth itself changed: {with} and {without}");
    }
    is_right("on and behind", &world);
}

#[test]
fn lights_of_no_power_and_lights_in_one_place() {
    let points = world::points().everywhere;
    let dark = points.iter().map(|light| Light::point(light.position, Vec3::ZERO));
    let lights: Vec<_> = points.iter().copied().chain(dark).chain(points.iter().copied()).collect();
    let world = World::new(lights);
    for (twice, once) in expected(&world, 1).iter().zip(expected(&World::new(points.clone()), 1)) {
        assert!((twice / once - 2.0).abs() < 1e-9);
    }
    is_right("dark and coincident", &world);
    let lights = world.table();
    for i in 0..20_000 {
        let mut rng = Rng::new(UVec2::new(i, 0), 0, 5, Stream::Initial, 0);
        let random = rng.next_u32x4();
        let (sample, _) = lights.sample([random.x, random.y, random.z]);
        assert!(world.lights[sample.light as usize].power > 0.0, "light {} has no power", sample.light);
    }
    // Nothing but darkness is no fault either.
    let night = World::new(vec![Light::point(Vec3::Y, Vec3::ZERO)]);
    assert!(night.alias.is_empty());
    all_is_finite("night", &night);
    all_is_finite("no lights", &World::new(Vec::new()));
}

/// Two coincident lights are one of double strength: exact.
#[test]
fn two_coincident_lights_are_one() {
    let light = Light::point(Vec3::new(0.5, 2.0, 0.3), Vec3::splat(50.0));
    let world = World::new(vec![light, light]);
    let views = [world.view(0), world.view(1)];
    let truth = crate::truth::picture(&world, &views[1]);
    for (name, settings, frames) in in_mode(mode::UNBIASED, reuse_cases()) {
        let mut sequence = Sequence::new(&world, &views, settings, 5, None);
        let picture = (0..frames + frames % 2).map(|_| sequence.next_frame()).last().unwrap_or_default();
        for (pixel, truth) in picture.iter().zip(&truth) {
            let error = (pixel.as_dvec3() / *truth - 1.0).abs().max_element();
            assert!(error < 1e-4, "{name}: {pixel} instead of {truth}");
        }
    }
}

/// Where the cross product of two long edges cancels, the normal keeps its digits: within 1e-4 rad of that in f64, down to an
/// aspect of 1e-6.
#[test]
fn slivers_keep_their_normals() {
    let mut rng = Rng::new(UVec2::ZERO, 0, 4, Stream::Initial, 0);
    let mut direction = || {
        let r = rng.next_u32x4();
        (Vec3::new(unit_f32(r.x), unit_f32(r.y), unit_f32(r.z)) - 0.5).normalize()
    };
    for i in 0..3000 {
        let (along, across, width) = (direction(), direction(), 10f32.powi(-(i % 7)));
        let third = if i % 2 == 0 { along } else { 0.5 * along } + across * width;
        let light = Light::triangle([Vec3::ZERO, along, third], Vec3::ONE, false);
        let exact = light.edge1.as_dvec3().cross(light.edge2.as_dvec3()).normalize();
        let normal = light.sample_li(Vec2::splat(0.3), Vec3::Y * 5.0).normal.as_dvec3();
        let error = exact.cross(normal).length();
        assert!(error < 1e-4 && exact.dot(normal) > 0.0, "{width} m wide: {error} rad off");
    }
}

/// Needles and caps of aspect 1e-6 at any angle, triangles of 1e-12 m², and some without any area.
#[test]
fn slivers_and_specks() {
    let mut rng = Rng::new(UVec2::ZERO, 0, 9, Stream::Initial, 0);
    let mut direction = || {
        let r = rng.next_u32x4();
        (Vec3::new(unit_f32(r.x), unit_f32(r.y), unit_f32(r.z)) - 0.5).normalize()
    };
    let mut lights = Vec::new();
    for i in 0..12 {
        let corner = Vec3::new((i % 4) as f32 - 1.5, 0.8 + 0.1 * i as f32, (i / 4) as f32 - 1.0);
        let (along, across) = (direction(), direction());
        let (tip, speck) = (along + across * 1e-6, [along * 1e-6, across * 2e-6]);
        let bright = Vec3::new(3e6, 2e6, 1e6);
        lights.push(match i % 4 {
            0 => Light::triangle([corner, corner + along, corner + tip], bright, true),
            1 => {
                Light::triangle([corner, corner + along, corner + 0.5 * along + across * 1e-6], bright, true)
            }
            2 => Light::triangle([corner, corner + speck[0], corner + speck[1]], bright * 1e6, true),
            _ => Light::triangle([corner, corner + along, corner + 2.0 * along], bright, true),
        });
    }
    is_right("slivers", &World::new(lights));
}

/// A mirror-like and a fully rough floor; some pixels look straight into a light's reflection.
#[test]
fn roughness_zero_and_one() {
    for roughness in [0.0, 1.0] {
        let mut world = World::new(world::points().everywhere);
        world.eyes = [world.eyes[0]; 2];
        world.reflectance.roughness = roughness;
        for i in [20, 90, 160] {
            let s = world.view(0).surfaces[i];
            let mirrored = Vec3::new(-s.wo.x, s.wo.y, -s.wo.z);
            world.lights.push(Light::point(s.position + mirrored * 2.0, Vec3::ONE));
        }
        let lights = world.lights.clone();
        let world = world.with_lights(lights);
        is_right(&format!("roughness {roughness}"), &world);
    }
}

/// Where no neighbor is similar, spatial reuse leaves every reservoir as it is.
#[test]
fn rejected_neighbors_change_nothing() {
    let world = World::new(world::points().somewhere).behind_a_screen();
    let views = [world.view(0), world.view(1)];
    for mode in [mode::BIASED, mode::UNBIASED] {
        let alone = Settings { mode, visibility_reuse: 1, ..base() };
        let rejecting = Settings { spatial: 1, normal_threshold: 2.0, ..alone };
        let [a, b] =
            [alone, rejecting].map(|settings| Sequence::new(&world, &views, settings, 3, None).next_frame());
        for (i, (a, b)) in a.iter().zip(&b).enumerate() {
            assert!(
                (*a - *b).abs().max_element() <= 1e-6 * a.max_element(),
                "mode {mode}, pixel {i}: {a} {b}"
            );
        }
    }
}

/// Pixels that see no light at all stay black beside pixels that do, whatever is merged.
#[test]
fn empty_reservoirs_stay_empty() {
    let mut world = World::new(vec![
        Light::spot(Vec3::new(-0.9, 1.0, 0.3), Vec3::NEG_Y, Vec3::splat(5.0), 0.2, 0.4),
        Light::spot(Vec3::new(0.9, 1.0, 0.3), Vec3::NEG_Y, Vec3::splat(5.0), 0.2, 0.4),
    ]);
    world.eyes = [world.eyes[0]; 2];
    let views = [world.view(0), world.view(1)];
    let truth = crate::truth::picture(&world, &views[0]);
    assert!(
        truth.iter().any(|c| c.x == 0.0) && truth.iter().any(|c| c.x > 0.0),
        "both kinds are in the picture"
    );
    let cases = [mode::BIASED, mode::UNBIASED].into_iter().flat_map(|mode| in_mode(mode, reuse_cases()));
    for (name, settings, frames) in cases {
        let mut sequence = Sequence::new(&world, &views, settings, 6, None);
        for _ in 0..frames {
            for (i, (pixel, truth)) in sequence.next_frame().iter().zip(&truth).enumerate() {
                assert!(truth.x > 0.0 || *pixel == Vec3::ZERO, "{name}: pixel {i} is {pixel}");
            }
        }
    }
}

/// 1,024 candidates and histories of 20 times as many: counts stay whole, weights finite, means right. Frames of a run repeat
/// one another, so the runs are what is counted: Student's t, 11 degrees of freedom, false alarm 1e-4 a view (fixed seeds).
#[test]
fn a_thousand_candidates_with_caps() {
    const T_LIMIT: f64 = 5.92;
    let mut world = World::new(world::points().somewhere).behind_a_screen();
    world.size = UVec2::new(6, 4);
    let settings = Settings {
        candidates: 1024,
        visibility_reuse: 1,
        temporal: 1,
        spatial: 1,
        spatial_iterations: 2,
        neighbors: 8,
        mode: mode::UNBIASED,
        ..base()
    };
    let views = [world.view(0), world.view(1)];
    let truth = [0, 1].map(|v| crate::truth::picture(&world, &views[v]).iter().map(|c| c.x).sum::<f64>());
    let (mut sums, runs, frames) = ([[0.0f64; 2]; 2], 12.0, 80);
    for seed in 1..=12 {
        let mut sequence = Sequence::new(&world, &views, settings, seed, None);
        let mut means = [0.0f64; 2];
        for frame in 0..frames {
            let picture = sequence.next_frame();
            means[frame & 1] += picture.iter().map(|c| f64::from(c.x)).sum::<f64>() / (frames / 2) as f64;
            for r in sequence.reservoirs() {
                // (1 + 20) M after temporal reuse, at most nine times that after each spatial pass.
                assert!(
                    r.confidence.fract() == 0.0 && r.confidence <= 21.0 * 1024.0 * 81.0,
                    "{}",
                    r.confidence
                );
                assert!(r.contribution_weight.is_finite());
            }
        }
        for view in 0..2 {
            let error = means[view] / truth[view] - 1.0;
            sums[view] = [sums[view][0] + error, sums[view][1] + error * error];
        }
    }
    for [sum, squares] in sums {
        let (mean, variance) = (sum / runs, (squares - sum * sum / runs) / (runs - 1.0));
        let t = mean / (variance / runs).sqrt();
        println!("relative error {mean:+.4}, noise of a run {:.4}, t = {t:.2}", variance.sqrt());
        assert!(t.abs() < T_LIMIT, "off by {mean} of the truth, t = {t}");
    }
}

/// Barycentric coordinates may add up to more than 1 by an ulp: nothing becomes NaN, no point leaves its triangle.
#[test]
fn barycentric_sums_above_one() {
    let corners = [Vec3::new(0.1, 0.2, 0.3), Vec3::new(1.3, 0.1, -0.4), Vec3::new(0.7, 1.9, 0.2)];
    let light = Light::triangle(corners, Vec3::ONE, true);
    let above = (0..1 << 16).map(|i| LightSample { light: 0, uv: 0xffff | i << 16 }).filter(|s| {
        let b = square_to_triangle(s.square());
        b.x + b.y >= 1.0
    });
    let normals = [Vec3::X, Vec3::Y, Vec3::Z].map(pack_direction);
    let attributes =
        normals.map(|normal| VertexAttributes { normal, color: 0xffff_ffff, ..Default::default() });
    let geometry = InstanceGeometry::new(Affine3A::IDENTITY, 0, 0, 0);
    let sums =
        [Vec2::new(0.5, 0.500_000_1), Vec2::new(1.0, f32::EPSILON), Vec2::new(0.300_000_04, 0.700_000_1)];
    for b in sums {
        assert!(b.x + b.y > 1.0);
        let point = geometry.surface_point(Triangle { positions: corners, attributes }, b);
        assert!(point.position.is_finite() && (point.normal.length() - 1.0).abs() < 1e-6, "{b}: {point:?}");
        assert!((point.color - Vec3::ONE).abs().max_element() < 1e-6, "{b}: {}", point.color);
    }
    for sample in above {
        let incident = light.sample_li(sample.square(), Vec3::new(0.5, 3.0, 4.0));
        assert!(incident.irradiance.is_finite() && incident.position.is_finite(), "{sample:?}: {incident:?}");
    }
}

/// A light and a surface that nearly touch: the shadow ray stays between them, however coarse the numbers they come from, and so
/// meets neither.
#[test]
fn shadow_rays_stay_between_their_ends() {
    for distance in [0.1f32, 1.0, 10.0, 100.0] {
        for height in [1e-5f32, 1e-4, 1e-3, 1.0].map(|h| h * distance) {
            let mut world = World::new(Vec::new());
            world.eyes = [Vec3::new(0.0, 1.0, 1.0) * distance; 2];
            let surface = world.view(0).surfaces[100];
            let p = surface.position + Vec3::Y * height;
            let light =
                Light::triangle([p, p + Vec3::X * distance, p + Vec3::Z * distance], Vec3::ONE, false);
            let incident = light.sample_li(Vec2::new(0.01, 0.5), surface.position);
            assert!(incident.irradiance.x > 0.0);
            let ray = ShadowRay::new(&surface, &incident);
            let (from, to) = (ray.origin.y, ray.origin.y + ray.direction.y);
            let floor = surface.position.y;
            let inside = floor < from && from < to && to < p.y;
            assert!(
                inside,
                "{distance} m away, {height} m apart: from {from} to {to}, floor at {floor}, light at {}",
                p.y
            );
        }
    }
}

/// A scene without lights is dark, not an error, and its candidates count.
#[test]
fn no_candidates_are_no_light() {
    let world = World::new(Vec::new());
    let views = [world.view(0), world.view(1)];
    let mut sequence = Sequence::new(&world, &views, Settings { candidates: 32, ..base() }, 0, None);
    assert!(sequence.next_frame().iter().all(|&radiance| radiance == Vec3::ZERO));
    assert!(sequence.reservoirs().iter().all(|r| r.contribution_weight == 0.0 && r.confidence == 32.0));
}
