//! A kind of light of one's own, without a GPU: `cargo run --example custom_light`.
//!
//! Glowing tubes, which the list of kinds does not have. Reservoirs, pairwise MIS and shading ask of lights one question, which
//! [`Source`] is: what arrives at a receiver from a sample? A program answers it for its own samples and has all of ReSTIR;
//! docs/adding-a-light.md adds a kind to the shaders as well. Every mean below is that of the integral over all tubes.

use candela_shared::glam::{UVec2, Vec3};
use candela_shared::light::Incident;
use candela_shared::material::Reflectance;
use candela_shared::math::luminance;
use candela_shared::resampling::pairwise::Pairwise;
use candela_shared::resampling::{CrossProposal, Source, target_of};
use candela_shared::reservoir::{Reservoir, Stored};
use candela_shared::rng::{Rng, Stream};
use candela_shared::shading::contribution;
use candela_shared::surface::Surface;
use candela_shared::target::{target_function, unshadowed};

const RUNS: u32 = 20_000;

/// A segment without thickness that radiates with the sine of the angle from its axis.
struct Tube {
    /// World space, m.
    start: Vec3,
    /// From there to its end, m.
    edge: Vec3,
    /// Across the axis, of each metre, cd/m, linear RGB.
    intensity: Vec3,
}

/// A point of a tube: what a reservoir keeps.
#[derive(Clone, Copy, Default, PartialEq)]
struct OnTube {
    tube: u32,
    /// Fraction of the length.
    along: f32,
}

#[derive(Clone, Copy)]
struct Tubes<'a>(&'a [Tube]);

impl Source for Tubes<'_> {
    type Sample = OnTube;

    /// I sinθ / d², lx a metre.
    fn incident(self, sample: OnTube, receiver: Vec3) -> Incident {
        let tube = &self.0[sample.tube as usize];
        let position = tube.start + sample.along * tube.edge;
        let distance = position.distance(receiver);
        let direction = (position - receiver) / distance;
        let sine = direction.cross(tube.edge.normalize()).length();
        let irradiance = tube.intensity * sine / (distance * distance);
        Incident { position, direction, distance, irradiance, ..Incident::default() }
    }
}

impl Tubes<'_> {
    /// A tube by chance, and a point of it: with its density, 1/m.
    fn sample(self, rng: &mut Rng) -> (OnTube, f32) {
        let tube = ((rng.next_f32() * self.0.len() as f32) as usize).min(self.0.len() - 1);
        let density = 1.0 / (self.0.len() as f32 * self.0[tube].edge.length());
        (OnTube { tube: tube as u32, along: rng.next_f32() }, density)
    }

    /// What `surface` reflects of all tubes, by the midpoint rule, nit.
    fn integral(self, surface: &Surface) -> f64 {
        let steps = 2000;
        let points = (0..self.0.len() as u32).flat_map(|tube| (0..steps).map(move |i| (tube, i)));
        let terms = points.map(|(tube, i)| {
            let along = (i as f32 + 0.5) / steps as f32;
            let incident = self.incident(OnTube { tube, along }, surface.position);
            let metres = self.0[tube as usize].edge.length() / steps as f32;
            f64::from(luminance(unshadowed(surface, &incident)) * metres)
        });
        terms.sum()
    }
}

fn main() {
    let mut rng = Rng::new(UVec2::ZERO, 0, 1, Stream::Initial, 0);
    let mut between = |low: f32, high: f32| low + (high - low) * rng.next_f32();
    let tubes: Vec<Tube> = (0..100)
        .map(|_| Tube {
            start: Vec3::new(between(-10.0, 10.0), between(1.0, 4.0), between(-10.0, 10.0)),
            edge: Vec3::new(between(-1.0, 1.0), between(-0.5, 0.5), between(-1.0, 1.0)),
            intensity: Vec3::splat(between(1.0, 20.0)),
        })
        .collect();
    let tubes = Tubes(&tubes);
    let (here, there) = (floor(Vec3::ZERO), floor(Vec3::new(0.3, 0.0, 0.0)));

    println!("integral over 100 lights: {:.4} nit", tubes.integral(&here));
    println!("one sample each, {RUNS} runs:   mean     standard deviation / mean");
    let estimate =
        |reservoir| f64::from(luminance(contribution::<Vec3, _>(&here, tubes, reservoir).radiance));
    for m in [1, 4, 32, 256] {
        let runs = (0..RUNS).map(|run| estimate(ris(&here, tubes, m, run, 0)));
        report(&format!("RIS, M = {m}"), runs.collect());
    }
    let runs = (0..RUNS).map(|run| {
        let (mine, other) = (ris(&here, tubes, 32, run, 0), ris(&there, tubes, 32, run, 1));
        let cross = CrossProposal::new(tubes, &here, mine, &there, other);
        let mut rng = Rng::new(UVec2::new(run, 2), 0, 2, Stream::Spatial, 0);
        let mut merge = Pairwise::new(mine, target_of(&here, tubes, mine), other.confidence, 1.0);
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
fn ris(surface: &Surface, tubes: Tubes, m: u32, run: u32, point: u32) -> Stored<OnTube> {
    let mut rng = Rng::new(UVec2::new(run, point), 0, 2, Stream::Initial, 0);
    let mut reservoir = Reservoir::default();
    for _ in 0..m {
        let (sample, density) = tubes.sample(&mut rng);
        let target = target_function(surface, &tubes.incident(sample, surface.position));
        reservoir.add(sample, target, target / density, 1.0, rng.next_f32());
    }
    reservoir.finish(m as f32)
}

fn report(name: &str, runs: Vec<f64>) {
    let n = runs.len() as f64;
    let mean = runs.iter().sum::<f64>() / n;
    let deviation = (runs.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
    println!("{name:30} {mean:.4} ± {:.4}   {:.3}", deviation / n.sqrt(), deviation / mean);
}
