//! Tests of hypotheses over pictures.

use glam::{UVec2, Vec3};
use shared::math::luminance;

/// Blocks of 8 x 8 pixels: their mean luminance.
pub fn block_means(picture: &[Vec3], size: UVec2) -> Vec<f64> {
    let blocks = size / 8;
    let mut means = vec![0.0; (blocks.x * blocks.y) as usize];
    for y in 0..blocks.y * 8 {
        for x in 0..blocks.x * 8 {
            let l = f64::from(luminance(picture[(y * size.x + x) as usize]));
            means[(y / 8 * blocks.x + x / 8) as usize] += l / 64.0;
        }
    }
    means
}

/// Mean and standard error of each place over independent pictures' values.
pub fn mean_and_error(samples: &[Vec<f64>]) -> Vec<(f64, f64)> {
    let n = samples.len() as f64;
    (0..samples[0].len())
        .map(|i| {
            let mean = samples.iter().map(|s| s[i]).sum::<f64>() / n;
            let variance = samples.iter().map(|s| (s[i] - mean).powi(2)).sum::<f64>() / (n - 1.0);
            (mean, (variance / n).sqrt())
        })
        .collect()
}

/// The largest |z| of the differences between two sets of means with standard errors, and where.
pub fn largest_z(a: &[(f64, f64)], b: &[(f64, f64)]) -> (f64, usize) {
    let z = |i: usize| {
        let ((x, sx), (y, sy)) = (a[i], b[i]);
        // Rounding of f32 radiance is no bias: 1e-5 of the value.
        let rounding = 1e-5 * x.abs().max(y.abs());
        (x - y).abs() / (sx * sx + sy * sy + rounding * rounding).sqrt().max(f64::MIN_POSITIVE)
    };
    (0..a.len()).map(|i| (z(i), i)).fold((0.0, 0), |best, next| if next.0 > best.0 { next } else { best })
}
