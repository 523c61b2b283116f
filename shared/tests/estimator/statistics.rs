//! The mean over independent runs against the truth.

use crate::passes::Sequence;
use crate::plant::Plant;
use crate::truth;
use crate::world::World;
use shared::frame::Settings;
use shared::math::luminance;

/// Independent runs of a whole frame sequence, each with a seed of its own.
pub const RUNS: u32 = 300;
/// Regions of the picture, columns x rows: each mean is tested by itself, so that errors can't cancel.
const REGIONS: [u32; 2] = [3, 2];
/// Student's t with RUNS - 1 degrees of freedom that one of six regions exceeds, on either side, by chance in 1e-4 of all cases
/// (Sidak). That takes the means of 32 pixels over 300 runs for normal; `the_test_alarms_as_often_as_stated` checks it.
pub const T_LIMIT: f64 = 4.38;

/// Mean luminance of each region.
fn regions(world: &World, luminance: impl Iterator<Item = f64>) -> Vec<f64> {
    let [columns, rows] = REGIONS;
    let mut sums = vec![0.0; (columns * rows) as usize];
    for (pixel, value) in world.pixels().zip(luminance) {
        let region = pixel.y * rows / world.size.y * columns + pixel.x * columns / world.size.x;
        sums[region as usize] += value;
    }
    let pixels = f64::from(world.size.x * world.size.y) / f64::from(columns * rows);
    sums.iter().map(|sum| sum / pixels).collect()
}

/// What the last frame of a sequence should show, by region.
pub fn expected(world: &World, frames: u32) -> Vec<f64> {
    let picture = truth::picture(world, &world.view((frames - 1) & 1));
    let rec709 = shared::glam::DVec3::new(0.2126, 0.7152, 0.0722);
    regions(world, picture.iter().map(|c| c.dot(rec709)))
}

/// Each run's last frame, by region.
pub fn runs(
    world: &World,
    settings: Settings,
    frames: u32,
    plant: Option<Plant>,
    seeds: std::ops::Range<u32>,
) -> Vec<Vec<f64>> {
    let views = [world.view(0), world.view(1)];
    let run = |seed| {
        let mut sequence = Sequence::new(world, &views, settings, seed, plant);
        let picture = (0..frames).map(|_| sequence.next_frame()).last().expect("at least one frame");
        regions(world, picture.iter().map(|&c| f64::from(luminance(c))))
    };
    seeds.map(run).collect()
}

/// Student's t of the region that is farthest off.
pub fn largest_t(runs: &[Vec<f64>], truth: &[f64]) -> f64 {
    let n = runs.len() as f64;
    let t = |region: usize| {
        let mean = runs.iter().map(|run| run[region]).sum::<f64>() / n;
        let variance = runs.iter().map(|run| (run[region] - mean).powi(2)).sum::<f64>() / (n - 1.0);
        // Where nothing is left to chance, what is left is the rounding of f32.
        let rounding = 1e-4 * truth[region];
        (mean - truth[region]).abs() / (variance / n + rounding * rounding).sqrt()
    };
    (0..truth.len()).map(t).fold(0.0, f64::max)
}

/// The statistic of one case, which is also printed.
pub fn t_of(
    name: &str,
    world: &World,
    truth: &[f64],
    settings: Settings,
    frames: u32,
    plant: Option<Plant>,
) -> f64 {
    let t = largest_t(&runs(world, settings, frames, plant, 1..RUNS + 1), truth);
    println!("{name}, mode {}: {t:.2} standard errors", settings.mode);
    t
}
