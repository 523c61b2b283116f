//! Directions against their density, and both against closed forms.

use super::*;
use crate::rng::{Rng, Stream, unit_f32};
use glam::UVec2;

const COSINES: usize = 8;
const ANGLES: usize = 16;
const BINS: usize = COSINES * ANGLES;
const DRAWS: u32 = 1 << 17;

fn direction(cos: f32, phi: f32) -> Vec3 {
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    Vec3::new(sin * phi.cos(), sin * phi.sin(), cos)
}

fn draws(r: Reflectance, n: Vec3, wo: Vec3, seed: u32) -> impl Iterator<Item = Vec3> {
    let mut rng = Rng::new(UVec2::new(3, 4), 0, seed, Stream::Initial, 0);
    (0..DRAWS).map(move |_| {
        let random = rng.next_u32x4();
        let square = Vec2::new(unit_f32(random.y), unit_f32(random.z));
        sample(&r, n, wo, unit_f32(random.x), square)
    })
}

/// Mass of each bin of the upper hemisphere by a midpoint rule in (cosθ, φ).
fn masses(density: impl Fn(Vec3) -> f32) -> Vec<f64> {
    const STEPS: usize = 40;
    let area = core::f64::consts::TAU / (BINS * STEPS * STEPS) as f64;
    let mass = |bin: usize| {
        let at = |i: usize, steps: usize| (i as f32 + 0.5) / steps as f32;
        let sum: f64 = (0..STEPS * STEPS)
            .map(|i| {
                let cos = at(bin / ANGLES * STEPS + i / STEPS, COSINES * STEPS);
                let phi = core::f32::consts::TAU * at(bin % ANGLES * STEPS + i % STEPS, ANGLES * STEPS);
                f64::from(density(direction(cos, phi)))
            })
            .sum();
        sum * area
    };
    (0..BINS).map(mass).collect()
}

/// Chi-square of draws over the bins; the last one holds what fell below the surface.
fn chi2(r: Reflectance, wo: Vec3, masses: &[f64]) -> f64 {
    let mut counts = [0u32; BINS + 1];
    for wi in draws(r, Vec3::Z, wo, 7) {
        assert!((wi.length() - 1.0).abs() < 1e-5, "{wi}");
        let phi = wi.y.atan2(wi.x).rem_euclid(core::f32::consts::TAU);
        let angle = (phi / core::f32::consts::TAU * ANGLES as f32) as usize;
        let cos = ((wi.z * COSINES as f32) as usize).min(COSINES - 1);
        let bin = if wi.z < 0.0 { BINS } else { cos * ANGLES + angle.min(ANGLES - 1) };
        counts[bin] += 1;
    }
    let below = 1.0 - masses.iter().sum::<f64>();
    let all = masses.iter().copied().chain([below]);
    all.zip(counts).filter(|(mass, _)| mass * f64::from(DRAWS) > 5.0).fold(0.0, |sum, (mass, count)| {
        let expected = mass * f64::from(DRAWS);
        sum + (f64::from(count) - expected).powi(2) / expected
    })
}

/// All mass is 1, with what falls below the surface. 128 degrees of freedom at most: 195 is passed in 1e-4 of all cases (fixed seed). The density of another mixture, of
/// another roughness, and one without the mirror's Jacobian must all fail.
#[test]
fn draws_follow_their_density() {
    const LIMIT: f64 = 195.0;
    for roughness in [0.5, 0.75, 1.0] {
        for (metallic, cos) in [(0.0, 0.3), (0.4, 0.9), (1.0, 0.2), (1.0, 0.7)] {
            let r = Reflectance::from_metallic_roughness(Vec3::new(0.9, 0.5, 0.2), metallic, roughness);
            let wo = direction(cos, 0.7);
            let right = masses(|wi| pdf(&r, Vec3::Z, wo, wi).0);
            let total: f64 = right.iter().sum();
            assert!((0.5..1.0 + 2e-3).contains(&total), "{total} above the surface");
            if roughness * metallic == 1.0 {
                // All normals are as many: reflections are even over the cap z > -cosθo, 1 / (1 + cosθo) of it above.
                assert!((total * f64::from(1.0 + cos) - 1.0).abs() < 1e-3, "{total} above the surface");
            }
            let statistic = chi2(r, wo, &right);
            assert!(statistic < LIMIT, "{statistic}: roughness {roughness}, metallic {metallic}, cos {cos}");

            let probability = specular_probability(&r, wo.z);
            let planted = |wi: Vec3, probability: f32, alpha: f32, factor: f32| {
                let half = (wi + wo).normalize();
                let specular = visible_normal_density(Vec3::Z, half, wo.z, alpha) * factor;
                probability * specular + (1.0 - probability) * wi.z * FRAC_1_PI
            };
            let mixture = masses(|wi| planted(wi, 0.8 * probability, alpha(&r), 1.0));
            let wider = masses(|wi| planted(wi, probability, 1.3 * alpha(&r), 1.0));
            let jacobian =
                masses(|wi| planted(wi, probability, alpha(&r), 4.0 * wo.dot((wi + wo).normalize())));
            for (name, wrong) in [("mixture", mixture), ("roughness", wider), ("jacobian", jacobian)] {
                // A specular lobe that is hardly ever drawn hides its faults.
                assert!(
                    probability < 0.2 || chi2(r, wo, &wrong) > LIMIT,
                    "{name} at {probability} was not seen"
                );
            }
        }
    }
}

/// Seen along the normal, tan²θ_h / (α² + tan²θ_h) of the specular lobe is uniform, in closed form and at any width: the
/// mean of N draws is 1/2 within 5 deviations of 1/√(12 N).
#[test]
fn narrow_lobes_have_their_width() {
    for roughness in [0.0, 0.1, 0.4] {
        let r = Reflectance::from_metallic_roughness(Vec3::ONE, 1.0, roughness);
        let a2 = alpha(&r).powi(2);
        let n = Vec3::new(0.36, -0.48, 0.8);
        let mean = draws(r, n, n, 11)
            .map(|wi| {
                let half = (wi + n).normalize();
                let (sin2, cos2) = (n.cross(half).length_squared(), n.dot(half).powi(2));
                f64::from(sin2 / (sin2 + a2 * cos2))
            })
            .sum::<f64>()
            / f64::from(DRAWS);
        assert!((mean - 0.5).abs() < 5.0 / (12.0 * f64::from(DRAWS)).sqrt(), "roughness {roughness}: {mean}");
    }
}

/// A white furnace by its own draws: f cosθ / p of a white metal is G2/G1 <= 1, and its mean is 1 for a mirror, which loses
/// nothing.
#[test]
fn a_mirror_of_draws_loses_nothing() {
    for (roughness, least) in [(0.0, 0.998), (0.3, 0.97), (1.0, 0.3)] {
        for cos in [0.1, 0.5, 1.0] {
            let r = Reflectance::from_metallic_roughness(Vec3::ONE, 1.0, roughness);
            let wo = direction(cos, 1.0);
            let weights = draws(r, Vec3::Z, wo, 13).map(|wi| {
                let weight =
                    safe_ratio(eval::<Vec3>(&r, Vec3::Z, wo, wi).x * wi.z, pdf(&r, Vec3::Z, wo, wi).0);
                assert!(weight < 1.001, "{weight}: roughness {roughness}, cos {cos}");
                f64::from(weight)
            });
            let albedo = weights.sum::<f64>() / f64::from(DRAWS);
            assert!(
                (least * f64::from(cos.min(0.5) * 2.0).powf(0.1)..1.001).contains(&albedo),
                "{albedo}: {roughness}, {cos}"
            );
        }
    }
}

/// A lobe is drawn by what it reflects: a mirror is all specular, a black dielectric too, a white one at normal incidence by 4 %.
#[test]
fn lobes_are_drawn_by_their_albedos() {
    let probability = |color: f32, metallic: f32, cos: f32| {
        let r = Reflectance::from_metallic_roughness(Vec3::splat(color), metallic, 0.2);
        specular_probability(&r, cos)
    };
    assert_eq!((probability(1.0, 1.0, 0.5), probability(0.0, 0.0, 1.0)), (1.0, 1.0));
    assert!((probability(1.0, 0.0, 1.0) - 0.04).abs() < 1e-6 && probability(1.0, 0.0, 0.0) == 1.0);
    let black = Reflectance { diffuse: Vec3::ZERO, f0: Vec3::ZERO, roughness: 0.5 };
    assert_eq!(specular_probability(&black, 1.0), 0.0);
    for square in [Vec2::ZERO, Vec2::splat(0.5), Vec2::ONE] {
        for roughness in [0.0, 1.0] {
            let r = Reflectance { roughness, ..Reflectance::from_metallic_roughness(Vec3::ONE, 1.0, 0.0) };
            for cos in [1e-7, 0.5, 1.0] {
                for lobe in [0.0, 1.0] {
                    assert!(sample(&r, Vec3::Z, direction(cos, 1.0), lobe, square).is_finite());
                }
            }
        }
    }
}
