//! Automatic exposure: how bright a picture is shown.

use glam::Vec3;
use shared::math::luminance;

/// Display value that the middle brightness of a picture gets.
const MIDDLE_GREY: f32 = 0.18;

/// Factor from nit to display values that shows the geometric mean of the lit pixels' luminance as middle grey, `stops`
/// brighter (Reinhard et al. 2002, eq. 1). 1 for a picture without light.
pub fn automatic(radiance: &[Vec3], stops: f32) -> f32 {
    let lit = || radiance.iter().map(|&c| luminance(c)).filter(|l| *l > 0.0 && l.is_finite());
    let (count, sum) = lit().fold((0u64, 0.0f64), |(n, sum), l| (n + 1, sum + f64::from(l).ln()));
    if count == 0 {
        return 1.0;
    }
    let mean = (sum / count as f64).exp() as f32;
    // Deep shadow must not blow out what is lit: no more than 1/32 of the arithmetic mean counts.
    let arithmetic = (lit().map(f64::from).sum::<f64>() / count as f64) as f32;
    MIDDLE_GREY * stops.exp2() / mean.max(arithmetic / 32.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uniform_pictures_become_middle_grey() {
        for level in [1e-3, 1.0, 1e5] {
            let exposure = automatic(&[Vec3::splat(level); 10], 0.0);
            assert!((exposure * level - MIDDLE_GREY).abs() < 1e-4);
            assert!((automatic(&[Vec3::splat(level); 10], 2.0) / exposure - 4.0).abs() < 1e-4);
        }
    }

    #[test]
    fn black_pixels_and_broken_ones_do_not_count() {
        let picture = [Vec3::ZERO, Vec3::splat(2.0), Vec3::NAN, Vec3::splat(8.0), Vec3::INFINITY];
        assert!((automatic(&picture, 0.0) - MIDDLE_GREY / 4.0).abs() < 1e-4);
        assert_eq!(automatic(&[Vec3::ZERO], 0.0), 1.0);
    }
}
