//! Tests of hypotheses over pictures.

use glam::{UVec2, Vec3};
use shared::math::luminance;
use statrs::distribution::{ContinuousCDF, StudentsT};

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

/// `means` are those of `truth`: no block is `limit` standard errors off.
pub fn assert_means(name: &str, means: &[(f64, f64)], truth: &[(f64, f64)], limit: f64) {
    let (z, block) = largest_z(means, truth);
    println!("{name}: largest z {z:.2} in block {block}");
    let [found, expected] = [means[block], truth[block]];
    assert!(z < limit, "{name}: block {block} is off by {z} standard errors: {found:?} and not {expected:?}");
}

/// Means of blocks of pictures of `size` over so many runs, which have seeds from 1 on.
pub fn replicas(count: u32, size: UVec2, run: impl FnMut(u32) -> Vec<Vec3>) -> Vec<(f64, f64)> {
    let samples: Vec<_> = (1..=count).map(run).map(|picture| block_means(&picture, size)).collect();
    mean_and_error(&samples)
}

/// Per-pixel test of two pictures, each known from independent samples. See [`compare_pixels`].
pub struct PixelTest {
    /// Two-sided p-value of each pixel.
    pub p_values: Vec<f64>,
    /// Pixels whose p-value is below what Sidak's correction leaves of 1 % for all of them.
    pub failing: usize,
    /// Pixels in the largest 4-connected cluster of those.
    pub largest_cluster: usize,
    /// Median over the pixels of the first picture's standard deviation in units of its mean, and the 99 % quantile.
    pub spread: [f64; 2],
}

impl PixelTest {
    /// At least 99.75 % of the pixels pass, and no more than 6 that fail touch.
    pub fn passes(&self) -> bool {
        self.failing as f64 <= 0.0025 * self.p_values.len() as f64 && self.largest_cluster <= 6
    }
}

/// Welch's t-test in each pixel of pictures `size` wide and high: have `samples` and `reference` (one picture's values a sample) the
/// same mean?
///
/// It takes the samples of a pixel for independent and their mean for normal. The latter is false for few samples of a heavy tail,
/// for which the test alarms too often; [`PixelTest::passes`] leaves room for it. How much is measured by
/// `the_pixel_test_alarms_as_rarely_as_stated` in tests/pixels.rs.
pub fn compare_pixels(samples: &[Vec<f64>], reference: &[Vec<f64>], size: UVec2) -> PixelTest {
    let (a, b) = (mean_and_error(samples), mean_and_error(reference));
    let degrees = [samples, reference].map(|s| s.len() as f64 - 1.0);
    let p_values: Vec<f64> = a
        .iter()
        .zip(&b)
        .map(|(&(x, sx), &(y, sy))| {
            // Rounding of f32 radiance is no bias: 1e-5 of the value.
            let rounding = 1e-5 * x.abs().max(y.abs());
            let variance = sx * sx + sy * sy + rounding * rounding;
            if variance == 0.0 {
                return if x == y { 1.0 } else { 0.0 };
            }
            // Welch and Satterthwaite.
            let df = variance * variance / (sx.powi(4) / degrees[0] + sy.powi(4) / degrees[1]);
            student_p((x - y) / variance.sqrt(), df.clamp(1.0, 1e6))
        })
        .collect();
    let limit = 1.0 - 0.99f64.powf(1.0 / p_values.len() as f64);
    let fails: Vec<bool> = p_values.iter().map(|&p| p < limit).collect();
    let mut spreads: Vec<f64> = a
        .iter()
        .filter(|(mean, _)| *mean > 0.0)
        .map(|(mean, error)| error * (samples.len() as f64).sqrt() / mean)
        .collect();
    spreads.sort_by(f64::total_cmp);
    let quantile =
        |q: f64| spreads.get((q * (spreads.len().max(1) - 1) as f64) as usize).copied().unwrap_or(0.0);
    PixelTest {
        failing: fails.iter().filter(|&&f| f).count(),
        largest_cluster: largest_cluster(&fails, size),
        spread: [quantile(0.5), quantile(0.99)],
        p_values,
    }
}

/// Size of the largest 4-connected cluster of marked pixels.
pub fn largest_cluster(marked: &[bool], size: UVec2) -> usize {
    let mut left = marked.to_vec();
    let mut largest = 0;
    for start in 0..left.len() {
        let (mut stack, mut count) = (vec![start], 0);
        while let Some(i) = stack.pop() {
            if !std::mem::take(&mut left[i]) {
                continue;
            }
            count += 1;
            let (x, width) = (i % size.x as usize, size.x as usize);
            let neighbors =
                [(x > 0, -1), (x + 1 < width, 1), (true, -(width as isize)), (true, width as isize)];
            for (exists, step) in neighbors {
                let place = i as isize + step;
                if exists && (0..left.len() as isize).contains(&place) {
                    stack.push(place as usize);
                }
            }
        }
        largest = largest.max(count);
    }
    largest
}

/// Probability that |T| >= |`t`| for Student's t with `df` degrees of freedom.
pub fn student_p(t: f64, df: f64) -> f64 {
    StudentsT::new(0.0, 1.0, df).map_or(f64::NAN, |student| 2.0 * student.sf(t.abs()))
}
