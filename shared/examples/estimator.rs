//! ReSTIR by hand, without a GPU: `cargo run --example estimator`.
//!
//! One point of a floor under 1,000 lights. RIS (Bitterli et al. 2020, Alg. 3) draws M candidates by power and keeps one; its
//! estimate has the mean of the sum over all lights for every M, and less spread the greater M is. Then two points beside each other
//! keep one sample each, and the first merges both by pairwise MIS (Wyman et al. 2023): the same mean from twice the candidates.

use candela_shared::glam::{UVec2, Vec2, Vec3};
use candela_shared::light::{Light, LightSample, LightTable, Lights, build_alias_table};
use candela_shared::material::Reflectance;
use candela_shared::math::luminance;
use candela_shared::resampling::initial::{Fresh, Techniques, candidate};
use candela_shared::resampling::pairwise::Pairwise;
use candela_shared::resampling::{CrossProposal, target_of};
use candela_shared::reservoir::StoredReservoir;
use candela_shared::rng::{Rng, Stream};
use candela_shared::shading::contribution;
use candela_shared::surface::Surface;
use candela_shared::target::unshadowed;

const RUNS: u32 = 20_000;

fn main() {
    let mut rng = Rng::new(UVec2::ZERO, 0, 1, Stream::Initial, 0);
    let mut between = |low: f32, high: f32| low + (high - low) * rng.next_f32();
    let lights: Vec<Light> = (0..1000)
        .map(|_| {
            let position = Vec3::new(between(-20.0, 20.0), between(0.5, 5.0), between(-20.0, 20.0));
            Light::point(position, Vec3::splat(between(0.1, 10.0)))
        })
        .collect();
    let alias = build_alias_table(&lights);
    let table = LightTable { lights: Lights::untextured(&lights), alias: &alias };
    let (here, there) = (floor(Vec3::ZERO), floor(Vec3::new(0.3, 0.0, 0.0)));

    let sum: f64 = (0..table.lights.count())
        .map(|light| {
            let incident = table.incident(LightSample::at(light, Vec2::ZERO), here.position);
            f64::from(luminance(unshadowed(&here, &incident)))
        })
        .sum();
    println!("sum over 1,000 lights: {sum:.4} nit");
    println!("one sample each, {RUNS} runs:   mean     standard deviation / mean");

    let estimate =
        |reservoir| f64::from(luminance(contribution::<Vec3, _>(&here, table, reservoir).radiance));
    for m in [1, 4, 32, 256] {
        let runs = (0..RUNS).map(|run| estimate(ris(&here, table, m, run, 0)));
        report(&format!("RIS, M = {m}"), runs.collect());
    }
    let runs = (0..RUNS).map(|run| {
        let (mine, other) = (ris(&here, table, 32, run, 0), ris(&there, table, 32, run, 1));
        let cross = CrossProposal::new(table, &here, mine, &there, other);
        let target = target_of(&here, table, mine);
        let mut rng = Rng::new(UVec2::new(run, 2), 0, 2, Stream::Spatial, 0);
        let mut merge = Pairwise::new(mine, target, other.confidence, 1.0);
        merge.add(other, cross.targets, rng.next_f32());
        merge.add_canonical(rng.next_f32());
        estimate(merge.finish())
    });
    report("M = 32 at two points, merged", runs.collect());
}

/// A gray floor, seen from above.
fn floor(position: Vec3) -> Surface {
    Surface {
        position,
        distance: 3.0,
        wo: Vec3::Y,
        geometric_normal: Vec3::Y,
        normal: Vec3::Y,
        reflectance: Reflectance { diffuse: Vec3::splat(0.5), f0: Vec3::splat(0.04), roughness: 0.8 },
    }
}

/// One survivor of `m` candidates.
fn ris(surface: &Surface, table: LightTable<'_>, m: u32, run: u32, point: u32) -> StoredReservoir {
    let techniques = Techniques { lights: m, bsdf: 0 };
    let mut rng = Rng::new(UVec2::new(run, point), 0, 2, Stream::Initial, 0);
    let mut fresh = Fresh::default();
    for _ in 0..m {
        fresh.add(candidate(surface, table, techniques, &mut rng));
    }
    fresh.finish(surface, table).reservoir
}

fn report(name: &str, runs: Vec<f64>) {
    let n = runs.len() as f64;
    let mean = runs.iter().sum::<f64>() / n;
    let deviation = (runs.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
    println!("{name:30} {mean:.4} ± {:.4}   {:.3}", deviation / n.sqrt(), deviation / mean);
}
