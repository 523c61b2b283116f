//! How far a picture is from the truth.
//!
//! All but chroma and FLIP are over luminance Y = 0.2126 R + 0.7152 G + 0.0722 B of linear radiance in nit: of the picture x, of the
//! reference y, over n pixels, with the reference's mean μ = Σy/n and ε = 10⁻³ μ², δ = 10⁻² μ, so that no number depends on
//! the unit or the exposure. Pixels where either picture is not finite are left out and counted.

use super::flip;
use candela::exposure;
use glam::{UVec2, Vec3};
use serde::{Deserialize, Serialize};
use shared::math::luminance;
use shared::tonemap;

/// Numbers of one picture against one reference.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Metrics {
    /// Σ(x - y)/n, nit: positive where the picture is too bright on the whole.
    pub bias: f64,
    /// Σx / Σy.
    pub energy_ratio: f64,
    /// √(Σ(x - y)²/n), nit.
    pub rmse: f64,
    /// Σ (x - y)²/(y² + ε) / n. Rousselle et al. 2011, eq. 12, with an ε that scales with the picture.
    pub rel_mse: f64,
    /// Σ |x - y|/(y + δ) / n.
    pub mape: f64,
    /// Σ 2|x - y|/(x + y + δ) / n, 0..2.
    pub smape: f64,
    /// Σ|x - y| / Σy: mean absolute error over the reference's mean. Bitterli et al. 2020 report an R-MAE without defining it; this
    /// is what statistics calls so.
    pub r_mae: f64,
    /// √(Σ |X/x - Y/y|² / 3n) over the pixels that are lit in both, of colors X and Y: error of what is left of a color once its
    /// luminance is 1.
    #[serde(default)]
    pub chroma: f64,
    /// Mean LDR-FLIP, 0..1 ([`flip`]), both pictures under the exposure that shows the reference well; not always computed.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub flip: Option<f64>,
    /// Pixels left out.
    #[serde(skip_serializing_if = "is_zero", default)]
    pub not_finite: usize,
}

/// ε and δ as fractions of μ² and μ.
const EPSILON: f64 = 1e-3;
const DELTA: f64 = 1e-2;

/// Everything but FLIP.
pub fn metrics(picture: &[Vec3], reference: &[Vec3]) -> Metrics {
    assert_eq!(picture.len(), reference.len(), "pictures of one size");
    let finite = || picture.iter().zip(reference).filter(|(a, b)| a.is_finite() && b.is_finite());
    let y = |c: &Vec3| f64::from(luminance(*c));
    let (n, total) = finite().fold((0.0f64, 0.0f64), |(n, sum), (_, b)| (n + 1.0, sum + y(b)));
    let mean = total / n.max(1.0);
    let (epsilon, delta) = (EPSILON * mean * mean, DELTA * mean);
    let (mut x_sum, mut squares, mut relative, mut mape, mut smape, mut absolute) =
        (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    let (mut lit, mut chroma) = (0.0f64, 0.0);
    for (a, b) in finite() {
        let (x, y) = (y(a), y(b));
        let d = x - y;
        x_sum += x;
        squares += d * d;
        relative += ratio(d * d, y * y + epsilon);
        mape += ratio(d.abs(), y + delta);
        smape += ratio(2.0 * d.abs(), x + y + delta);
        absolute += d.abs();
        if x > 0.0 && y > 0.0 {
            lit += 1.0;
            chroma += (a.as_dvec3() / x - b.as_dvec3() / y).length_squared() / 3.0;
        }
    }
    let pixels = n.max(1.0);
    Metrics {
        bias: (x_sum - total) / pixels,
        energy_ratio: ratio(x_sum, total),
        rmse: (squares / pixels).sqrt(),
        rel_mse: relative / pixels,
        mape: mape / pixels,
        smape: smape / pixels,
        r_mae: ratio(absolute, total),
        chroma: ratio(chroma, lit).sqrt(),
        flip: None,
        not_finite: picture.len() - n as usize,
    }
}

/// [`metrics`] with FLIP, and FLIP's map.
pub fn with_flip(picture: &[Vec3], reference: &[Vec3], size: UVec2) -> (Metrics, Vec<f32>) {
    let exposure = exposure::automatic(reference, 0.0);
    let shown = |picture: &[Vec3]| -> Vec<Vec3> { picture.iter().map(|&c| shown(c, exposure)).collect() };
    let map = flip::map(&shown(reference), &shown(picture), size, flip::PIXELS_PER_DEGREE);
    let mean = map.iter().map(|&e| f64::from(e)).sum::<f64>() / map.len().max(1) as f64;
    (Metrics { flip: Some(mean), ..metrics(picture, reference) }, map)
}

/// What the display gets, in the 8 bits a channel that a screen has; broken pixels are black.
fn shown(radiance: Vec3, exposure: f32) -> Vec3 {
    let radiance = if radiance.is_finite() { radiance } else { Vec3::ZERO };
    (tonemap::display(radiance, exposure) * 255.0).round() / 255.0
}

/// relMSE of a truth with these standard errors of luminance against the true truth, in expectation: Σ se²/(y² + ε) / n.
pub fn rel_mse_of_errors(errors: &[f64], reference: &[Vec3]) -> f64 {
    let y = |c: &Vec3| f64::from(luminance(*c));
    let n = reference.len().max(1) as f64;
    let mean = reference.iter().map(y).sum::<f64>() / n;
    let one = |(e, c): (&f64, &Vec3)| ratio(e * e, y(c).powi(2) + EPSILON * mean * mean);
    errors.iter().zip(reference).map(one).sum::<f64>() / n
}

/// How a picture moves from one frame to the next while camera and scene stand still.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Stability {
    /// √(mean (x₂ - x₁)²) / μ over consecutive frames: what the eye sees boil.
    pub flicker: f64,
    /// Σ cov(x₁, x₂) / Σ var over pixels, across independent runs: the share of the noise that survives into the next frame. 0:
    /// frames are independent and average out; 1: noise is frozen and looks like texture.
    pub temporal_correlation: f64,
}

/// Of two consecutive frames each of independent runs. Zero correlation for fewer than two runs.
pub fn stability(runs: &[[Vec<f32>; 2]]) -> Stability {
    let Some(first) = runs.first() else { return Stability::default() };
    let (k, pixels) = (runs.len() as f64, first[0].len());
    let (mut moved, mut total, mut covariance, mut variance) = (0.0, 0.0, 0.0, 0.0);
    for i in 0..pixels {
        let pair = |run: &[Vec<f32>; 2]| (f64::from(run[0][i]), f64::from(run[1][i]));
        let (m1, m2) = runs.iter().map(pair).fold((0.0, 0.0), |(a, b), (x, y)| (a + x / k, b + y / k));
        total += m1 + m2;
        for (x, y) in runs.iter().map(pair) {
            moved += (y - x).powi(2);
            covariance += (x - m1) * (y - m2);
            variance += 0.5 * ((x - m1).powi(2) + (y - m2).powi(2));
        }
    }
    let mean = total / (2.0 * pixels.max(1) as f64);
    let rms = (moved / (k * pixels.max(1) as f64)).sqrt();
    Stability { flicker: ratio(rms, mean), temporal_correlation: ratio(covariance, variance) }
}

/// 0 where there is nothing to divide by.
fn ratio(a: f64, b: f64) -> f64 {
    if b > 0.0 { a / b } else { 0.0 }
}

fn is_zero(n: &usize) -> bool {
    *n == 0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(values: &[f32]) -> Vec<Vec3> {
        values.iter().map(|&v| Vec3::splat(v)).collect()
    }

    /// By hand: y = 1, 2, 4, 1 (μ = 2, ε = 0.004, δ = 0.02), x = 1, 3, 2, 0: differences 0, 1, -2, -1.
    #[test]
    fn numbers_computed_by_hand() {
        let m = metrics(&grey(&[1.0, 3.0, 2.0, 0.0]), &grey(&[1.0, 2.0, 4.0, 1.0]));
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-6, "{a} is not {b}");
        close(m.bias, -0.5);
        close(m.energy_ratio, 0.75);
        close(m.rmse, 1.5f64.sqrt());
        close(m.rel_mse, (1.0 / 4.004 + 4.0 / 16.004 + 1.0 / 1.004) / 4.0);
        close(m.mape, (1.0 / 2.02 + 2.0 / 4.02 + 1.0 / 1.02) / 4.0);
        close(m.smape, (2.0 / 5.02 + 4.0 / 6.02 + 2.0 / 1.02) / 4.0);
        close(m.r_mae, 0.5);
    }

    #[test]
    fn luminance_weighs_the_channels() {
        let m = metrics(&[Vec3::new(2.0, 1.0, 1.0)], &[Vec3::ONE]);
        assert!((m.bias - 0.2126).abs() < 1e-6 && (m.rel_mse - 0.2126f64.powi(2) / 1.001).abs() < 1e-6);
    }

    /// By hand: red of luminance 2 beside white: (1/0.2126 - 1, -1, -1); a black pixel and one twice as bright add nothing.
    #[test]
    fn chroma_knows_no_luminance() {
        let red = Vec3::new(2.0 / 0.2126, 0.0, 0.0);
        let picture = [red, Vec3::ZERO, Vec3::splat(2.0)];
        let off = (1.0 / 0.2126f64 - 1.0).powi(2) + 2.0;
        let m = metrics(&picture, &[Vec3::ONE; 3]);
        assert!((m.chroma - (off / 3.0 / 2.0).sqrt()).abs() < 1e-5, "{}", m.chroma);
        assert_eq!(metrics(&grey(&[1.0, 3.0]), &grey(&[2.0, 1.0])).chroma, 0.0);
    }

    #[test]
    fn relative_numbers_do_not_know_the_unit() {
        let (a, b) = (grey(&[1.0, 3.0, 2.0, 0.0]), grey(&[1.0, 2.0, 4.0, 1.0]));
        let scaled = |v: &[Vec3]| v.iter().map(|c| *c * 1e3).collect::<Vec<_>>();
        let (m, s) = (metrics(&a, &b), metrics(&scaled(&a), &scaled(&b)));
        for (x, y) in [(m.rel_mse, s.rel_mse), (m.mape, s.mape), (m.smape, s.smape), (m.r_mae, s.r_mae)] {
            assert!((x / y - 1.0).abs() < 1e-5);
        }
        assert!((s.rmse / m.rmse - 1e3).abs() < 1e-2);
    }

    #[test]
    fn equal_pictures_and_black_ones() {
        let a = grey(&[1.0, 0.0, 5.0]);
        assert_eq!(metrics(&a, &a), Metrics { energy_ratio: 1.0, ..Metrics::default() });
        let m = metrics(&grey(&[0.0; 3]), &grey(&[0.0; 3]));
        assert_eq!(m, Metrics::default());
        assert_eq!(with_flip(&a, &a, UVec2::new(3, 1)).0.flip, Some(0.0));
    }

    #[test]
    fn broken_pixels_are_left_out_and_counted() {
        let m = metrics(&grey(&[f32::NAN, 2.0, f32::INFINITY]), &grey(&[1.0, 1.0, 1.0]));
        assert_eq!((m.not_finite, m.rmse), (2, 1.0));
    }

    /// Two pixels with standard errors 0.1 and 0.2 around 1 and 3 (μ = 2, ε = 0.004).
    #[test]
    fn error_of_a_truth() {
        let expected = (0.01 / 1.004 + 0.04 / 9.004) / 2.0;
        assert!((rel_mse_of_errors(&[0.1, 0.2], &grey(&[1.0, 3.0])) - expected).abs() < 1e-9);
    }

    /// By hand: three runs of one pixel: (1, 2), (2, 3), (3, 4): the noise is all kept, each frame one brighter.
    #[test]
    fn frozen_noise_and_fresh_noise() {
        let runs = |pairs: &[(f32, f32)]| pairs.iter().map(|&(a, b)| [vec![a], vec![b]]).collect::<Vec<_>>();
        let frozen = stability(&runs(&[(1.0, 2.0), (2.0, 3.0), (3.0, 4.0)]));
        assert!(
            (frozen.temporal_correlation - 1.0).abs() < 1e-9 && (frozen.flicker - 1.0 / 2.5).abs() < 1e-9
        );
        // Means 2 and 2; deviations (-1, 0), (0, 1), (1, -1): covariance -1, variances 2 and 2; moves 1, 1, -2.
        let fresh = stability(&runs(&[(1.0, 2.0), (2.0, 3.0), (3.0, 1.0)]));
        assert!(
            (fresh.temporal_correlation + 0.5).abs() < 1e-9
                && (fresh.flicker - 2f64.sqrt() / 2.0).abs() < 1e-9
        );
        assert_eq!(stability(&[]), Stability::default());
    }
}
