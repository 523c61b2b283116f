//! Draws from the table, for every kind of light: densities add up to 1, what is reported is what is drawn, and draws
//! follow it. The oracle computes powers, areas and solid angles by formulas of its own, in f64.

use super::kinds::{SAMPLES, quarter};
use super::*;
use crate::alias_table::{self, AliasEntry};
use crate::rng::{Rng, Stream};
use glam::UVec2;

/// A light, its power (lm) and the size of its measure (m², sr, m, or 1) in closed form.
pub struct Known {
    pub light: Light,
    pub power: f64,
    pub measure: f64,
}

/// What these tests ask of every kind; its file answers.
pub trait Sample: Kind {
    /// A light of some size and of the color [`COLOR`] x `strength`.
    fn known(strength: f32) -> Known;

    /// Which quarter of its light a point lies in, by where it is in space (or its direction), not by its random numbers.
    /// Lights without extent have one quarter.
    fn quarter(self, _place: Vec3) -> usize {
        0
    }
}

pub const RADIUS: f32 = 7.0;
pub const COLOR: Vec3 = Vec3::new(3.0, 2.0, 1.0);

/// Red irradiance, lx, of a surface at `receiver`: the mean over a grid of 256 x 256 samples.
pub fn irradiance(light: &Light, receiver: Vec3, normal: Vec3) -> f64 {
    let n = 256;
    let one = |i: i32| {
        let square = Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32;
        let incident = light.sample_li(square, receiver);
        f64::from(incident.irradiance.x * incident.direction.dot(normal) / light.pdf_li().0)
    };
    (0..n * n).map(one).sum::<f64>() / f64::from(n * n)
}

/// Luminance (Rec. 709) of [`COLOR`] x `strength`.
pub fn brightness(strength: f32) -> f64 {
    (0.2126 * 3.0 + 0.7152 * 2.0 + 0.0722) * f64::from(strength)
}

/// Each kind alone, and all together.
fn tables() -> Vec<(&'static str, Vec<Known>)> {
    let of = |known: fn(f32) -> Known| [1.0, 2.0, 3.5, 0.25, 9.0].map(known);
    let mut tables: Vec<_> = SAMPLES.map(|(name, known)| (name, Vec::from(of(known)))).into();
    tables.push(("together", SAMPLES.into_iter().flat_map(|(_, known)| of(known)).collect()));
    tables
}

/// Draws `n` samples: the light, the place on it and the density reported.
fn draws(known: &[Known], alias: &[AliasEntry], n: usize) -> Vec<(LightSample, SourcePdf)> {
    let lights: Vec<Light> = known.iter().map(|k| k.light).collect();
    let table = LightTable { lights: Lights::untextured(&lights), alias };
    let mut rng = Rng::new(UVec2::new(9, 1), 0, 4, Stream::Initial, 0);
    let mut draw = || {
        let r = rng.next_u32x4();
        table.sample([r.x, r.y, r.z])
    };
    (0..n).map(|_| draw()).collect()
}

fn alias_of(known: &[Known]) -> Vec<AliasEntry> {
    build_alias_table(&known.iter().map(|k| k.light).collect::<Vec<_>>())
}

#[test]
fn power_is_that_of_the_closed_form() {
    for (name, known) in tables() {
        for k in known {
            let error = f64::from(k.light.power) / k.power - 1.0;
            assert!(error.abs() < 1e-5, "{name}: {} instead of {} lm", k.light.power, k.power);
        }
    }
}

/// Σ p(light) ∫ p(place | light) = 1, with areas and solid angles from outside; and each p(light) is its share of power.
#[test]
fn densities_add_up_to_one() {
    for (name, known) in tables() {
        let total: f64 = known.iter().map(|k| k.power).sum();
        let alias = alias_of(&known);
        let mut sum = 0.0;
        for (i, k) in known.iter().enumerate() {
            // A density is constant over its light.
            let mass = f64::from(alias[i].pmf * k.light.pdf_li().0) * k.measure;
            assert!((mass / (k.power / total) - 1.0).abs() < 1e-4, "{name}, light {i}: {mass}");
            sum += mass;
        }
        assert!((sum - 1.0).abs() < 1e-6, "{name}: {sum}");
    }
}

/// The mean of 1/p over draws is the size of all lights together: what makes estimates of p right. Within 5 standard
/// errors of n draws; twice the density must be seen.
#[test]
fn the_mean_of_one_over_p_is_the_measure() {
    for (name, known) in tables() {
        let exact: f64 = known.iter().map(|k| k.measure).sum();
        let n = 1 << 16;
        let values: Vec<f64> =
            draws(&known, &alias_of(&known), n).iter().map(|(_, p)| 1.0 / f64::from(p.0)).collect();
        let mean = values.iter().sum::<f64>() / n as f64;
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n as f64;
        let error = (variance / n as f64).sqrt();
        assert!((mean - exact).abs() < 5.0 * error, "{name}: {mean} ± {error} instead of {exact}");
        assert!((mean - 0.5 * exact).abs() > 5.0 * error, "{name}: twice the density was not seen");
    }
}

#[test]
fn what_is_reported_is_what_is_stored() {
    for (name, known) in tables() {
        let alias = alias_of(&known);
        for (sample, p) in draws(&known, &alias, 1000) {
            let i = sample.light as usize;
            assert_eq!(p.0, alias[i].pmf * known[i].light.pdf_li().0, "{name}, light {i}");
        }
    }
}

/// Chi-square over lights and quarters of equal measure, against powers in closed form. The limit is the quantile of
/// 1 - 1e-5 (Wilson & Hilferty 1931): with ten tables at most, a false alarm comes in 1e-4 of all choices of the seed.
#[test]
fn draws_follow_power_and_are_uniform_on_each_light() {
    for (name, known) in tables() {
        let n = 1 << 18;
        let total: f64 = known.iter().map(|k| k.power).sum();
        let statistic = |alias: &[AliasEntry]| {
            let mut counts = vec![[0u32; 4]; known.len()];
            for (sample, _) in draws(&known, alias, n) {
                let i = sample.light as usize;
                let place = known[i].light.place(sample.square(), u32::MAX).position;
                counts[i][quarter(&known[i].light, place)] += 1;
            }
            let (mut chi2, mut bins) = (0.0, 0);
            for (k, counts) in known.iter().zip(counts) {
                let quarters = if k.light.has_extent() { 4 } else { 1 };
                for count in &counts[..quarters] {
                    let expected = n as f64 * k.power / total / quarters as f64;
                    chi2 += (f64::from(*count) - expected).powi(2) / expected;
                    bins += 1;
                }
            }
            let df = f64::from(bins - 1);
            let limit = df * (1.0 - 2.0 / (9.0 * df) + 4.265 * (2.0 / (9.0 * df)).sqrt()).powi(3);
            (chi2, limit)
        };
        let (chi2, limit) = statistic(&alias_of(&known));
        assert!(chi2 < limit, "{name}: chi-square {chi2}, limit {limit}");
        // Planted: 10 % more of the strongest light.
        let most = known.iter().map(|k| k.power).fold(0.0, f64::max);
        let planted = |k: &Known| if k.power == most { 1.1 * most } else { k.power };
        let planted: Vec<f64> = known.iter().map(planted).collect();
        let (chi2, limit) = statistic(&alias_table::build(&planted));
        assert!(chi2 > limit, "{name}: the planted error was not seen, {chi2} of {limit}");
    }
}

/// Samples of a light without extent become one and the same; of others they stay apart, or all would fall on one point.
#[test]
fn only_lights_without_extent_have_one_sample() {
    use crate::reservoir::StoredReservoir;
    for (name, known) in SAMPLES {
        let light = known(1.0).light;
        let at = |x: f32| light.place(Vec2::splat(x), u32::MAX).position;
        assert_eq!(light.has_extent(), at(0.2) != at(0.7), "{name}");
        if kinds::is_shape(light.kind, Shape::Point, u32::MAX) && !light.has_extent() {
            assert_eq!(light.position, at(0.5), "{name}: where points are");
        }
        let lights = [light];
        let table = LightTable { lights: Lights::untextured(&lights), alias: &[] };
        let sample = LightSample { light: 0, uv: 0x4000_8000 };
        let kept = table.canonical(StoredReservoir { sample, ..StoredReservoir::default() }).sample;
        assert_eq!(kept == sample, light.has_extent(), "{name}");
    }
}

/// What a scene has not is compiled away, and what it has is there: with the bit of its kind alone, a light is what it is with
/// all. (The last kind needs no bit.)
#[test]
fn a_kind_needs_its_own_feature_alone() {
    use crate::frame::features::light_kind;
    let receiver = Vec3::new(0.3, -0.8, 0.4);
    let of = |light: &Light, features| {
        let square = Vec2::new(0.3, 0.6);
        let incident = light.sample_li_among(features, square, receiver);
        (incident.position, incident.irradiance, incident.solid_angle, light.pdf_li_among(features))
    };
    for (i, (name, known)) in SAMPLES.into_iter().enumerate() {
        let Known { light, .. } = known(2.0);
        assert_eq!(light.kind, i as u32, "{name}");
        assert_eq!(of(&light, light_kind(light.kind)), of(&light, u32::MAX), "{name}");
        if light.kind + 1 < kind::COUNT {
            assert_ne!(of(&light, 0), of(&light, u32::MAX), "{name}: its feature does nothing");
        }
    }
}
