//! Small pictures for reports: JPEG in Base64.

use super::truth::Truth;
use crate::measure::heatmap;
use base64::Engine;
use candela::error::Result;
use candela::{exposure, image_io};
use glam::{UVec2, Vec3};

/// Largest part of a picture that reports show, pixels.
const SHOWN: UVec2 = UVec2::new(640, 360);

/// The middle of a picture, under the truth's exposure.
pub fn part(radiance: &[Vec3], truth: &Truth) -> Result<String> {
    let exposure = exposure::automatic(&truth.radiance, 0.0);
    let (corner, part) = middle(truth.size);
    encode(part, |at| {
        let c = radiance[index(corner + at, truth.size)];
        shared::tonemap::display(if c.is_finite() { c } else { Vec3::ZERO }, exposure)
    })
}

/// The same part of a map of FLIP at half the size: each of its pixels is the mean of four.
pub fn error_map(flip: &[f32], size: UVec2) -> Result<String> {
    let (corner, part) = middle(size);
    encode((part / 2).max(UVec2::ONE), |at| {
        let corners = [UVec2::ZERO, UVec2::X, UVec2::Y, UVec2::ONE].map(|d| (2 * at + d).min(part - 1));
        let mean = corners.map(|p| flip[index(corner + p, size)]).iter().sum::<f32>() / 4.0;
        heatmap::FLIP.rgb(mean)
    })
}

/// The corner and the size of what is shown.
fn middle(size: UVec2) -> (UVec2, UVec2) {
    let part = SHOWN.min(size);
    ((size - part) / 2, part)
}

fn index(at: UVec2, size: UVec2) -> usize {
    (at.y * size.x + at.x) as usize
}

fn encode(size: UVec2, color: impl Fn(UVec2) -> Vec3) -> Result<String> {
    let jpeg = image_io::jpeg(size, |x, y| color(UVec2::new(x, y)))?;
    Ok(base64::engine::general_purpose::STANDARD.encode(jpeg))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Black left, white right: the map shows FLIP's ends there, also where a side is odd.
    #[test]
    fn maps_show_the_middle_at_half_the_size() {
        for size in [UVec2::new(700, 400), UVec2::new(9, 5), UVec2::ONE] {
            let flip: Vec<f32> =
                (0..size.element_product()).map(|i| f32::from(i % size.x >= size.x / 2)).collect();
            let bytes =
                base64::engine::general_purpose::STANDARD.decode(error_map(&flip, size).unwrap()).unwrap();
            let picture = image::load_from_memory(&bytes).unwrap().into_rgb8();
            let shown = (SHOWN.min(size) / 2).max(UVec2::ONE);
            assert_eq!((picture.width(), picture.height()), shown.into());
            let bright = |x: u32| picture.get_pixel(x, 0).0.iter().map(|c| u32::from(*c)).sum::<u32>();
            assert!(bright(shown.x - 1) > 600 && (size == UVec2::ONE || bright(0) < 60), "{size}");
        }
    }
}
