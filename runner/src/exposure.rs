//! Automatic exposure: how bright a picture is shown.

use glam::Vec3;
use shared::math::luminance;

/// Display value that the middle brightness of a picture gets.
const MIDDLE_GREY: f32 = 0.18;

/// Of a picture's mean luminance: what is darker does not count as lit.
const LEAST_SEEN: f64 = 1e-3;

/// Factor from nit to display values that shows the geometric mean of the lit pixels' luminance as middle grey, `stops`
/// brighter (Reinhard et al. 2002, eq. 1). 1 for a picture without light.
///
/// ```
/// use candela::exposure::automatic;
/// use candela::shared::glam::Vec3;
///
/// let picture = [Vec3::splat(200.0); 4];
/// assert!((200.0 * automatic(&picture, 0.0) - 0.18).abs() < 1e-4);
/// assert_eq!(automatic(&picture, 1.0), 2.0 * automatic(&picture, 0.0));
/// ```
pub fn automatic(radiance: &[Vec3], stops: f32) -> f32 {
    let lit = || radiance.iter().map(|&c| f64::from(luminance(c))).filter(|l| *l > 0.0 && l.is_finite());
    let arithmetic = lit().sum::<f64>() / lit().count().max(1) as f64;
    // What is next to black is as good as black: a noisy picture, a clean one and a denoised one of the same scene are exposed alike.
    let seen = lit().filter(|l| *l > LEAST_SEEN * arithmetic);
    let (count, sum) = seen.fold((0u64, 0.0), |(n, sum), l| (n + 1, sum + l.ln()));
    if count == 0 {
        return 1.0;
    }
    let mean = (sum / count as f64).exp() as f32;
    // Deep shadow must not blow out what is lit: no more than 1/32 of the arithmetic mean counts.
    let arithmetic = arithmetic as f32;
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

    /// Denoisers leave next to nothing where there was nothing.
    #[test]
    fn what_is_next_to_black_does_not_count() {
        let lit = [Vec3::splat(2.0), Vec3::splat(8.0)];
        let traces = [lit[0], lit[1], Vec3::splat(1e-9), Vec3::splat(1e-5)];
        assert_eq!(automatic(&traces, 0.0), automatic(&lit, 0.0));
        assert!(automatic(&[lit[0], lit[1], Vec3::splat(0.1)], 0.0) > automatic(&lit, 0.0), "shadow counts");
    }

    #[test]
    fn black_pixels_and_broken_ones_do_not_count() {
        let picture = [Vec3::ZERO, Vec3::splat(2.0), Vec3::NAN, Vec3::splat(8.0), Vec3::INFINITY];
        assert!((automatic(&picture, 0.0) - MIDDLE_GREY / 4.0).abs() < 1e-4);
        assert_eq!(automatic(&[Vec3::ZERO], 0.0), 1.0);
    }
}
