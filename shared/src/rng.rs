//! Counter-based random numbers: every draw is a hash of (pixel, frame, stream, seed, counter), so one pixel
//! of one frame can be replayed alone, on either machine, with the same bits.

use glam::{UVec2, UVec4};

/// Which part of a frame draws: keeps the numbers of different passes independent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Stream {
    /// Candidates.
    Initial = 1,
    /// Temporal reuse.
    Temporal = 2,
    /// Spatial reuse.
    Spatial = 3,
    /// Points of lights in the reference.
    Reference = 4,
    /// Stochastic alpha of blended surfaces: of primary rays, and in `Shade` of final shadow rays.
    Primary = 5,
    /// See above.
    Shade = 6,
    /// Entries of light tiles, and which block takes which tile.
    Tiles = 7,
    /// Which pixels are partners.
    Pairs = 8,
    /// By how much a pixel's place is shifted among the cells of the world.
    Cells = 9,
    /// Light samples of cells' pools.
    Pools = 10,
    /// Paths of the reference.
    Paths = 11,
    /// Paths that are resampled.
    Indirect = 12,
    /// Paths that go on, and which pixels' do.
    Further = 13,
}

/// Random numbers of one pixel in one pass.
///
/// ```
/// use candela_shared::glam::UVec2;
/// use candela_shared::rng::{Rng, Stream};
///
/// let numbers = |frame| Rng::new(UVec2::new(3, 4), frame, 0, Stream::Initial, 0).next_u32x4();
/// assert_eq!(numbers(7), numbers(7));
/// assert_ne!(numbers(7), numbers(8));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Rng {
    key: UVec4,
    counter: u32,
}

/// The hash `pcg4d` of Jarzynski & Olano 2020, "Hash Functions for GPU Rendering": passes BigCrush.
pub fn hash(v: UVec4) -> UVec4 {
    let (mut x, mut y, mut z, mut w) = (lcg(v.x), lcg(v.y), lcg(v.z), lcg(v.w));
    x = x.wrapping_add(y.wrapping_mul(w));
    y = y.wrapping_add(z.wrapping_mul(x));
    z = z.wrapping_add(x.wrapping_mul(y));
    w = w.wrapping_add(y.wrapping_mul(z));
    x ^= x >> 16;
    y ^= y >> 16;
    z ^= z >> 16;
    w ^= w >> 16;
    x = x.wrapping_add(y.wrapping_mul(w));
    y = y.wrapping_add(z.wrapping_mul(x));
    z = z.wrapping_add(x.wrapping_mul(y));
    w = w.wrapping_add(y.wrapping_mul(z));
    UVec4::new(x, y, z, w)
}

fn lcg(x: u32) -> u32 {
    x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223)
}

/// A float in [0, 1) from the upper 24 bits: every value is a multiple of 2^-24, 1 is never reached.
pub fn unit_f32(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / 16_777_216.0)
}

impl Rng {
    /// The numbers of `pixel` in `frame` for one `stream`; `lane` separates repetitions inside a pass (reservoir
    /// number, spatial iteration).
    pub fn new(pixel: UVec2, frame: u32, seed: u32, stream: Stream, lane: u32) -> Self {
        let place = UVec4::new(pixel.x, pixel.y, frame, seed);
        let key = hash(place) ^ UVec4::new(stream as u32, lane, 0, 0);
        Rng { key, counter: 0 }
    }

    /// Four independent 32-bit numbers.
    pub fn next_u32x4(&mut self) -> UVec4 {
        let bits =
            hash(UVec4::new(self.key.x, self.key.y, self.key.z, self.key.w.wrapping_add(self.counter)));
        self.counter = self.counter.wrapping_add(1);
        bits
    }

    /// A float in [0, 1).
    pub fn next_f32(&mut self) -> f32 {
        unit_f32(self.next_u32x4().x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floats_stay_below_one() {
        assert_eq!(unit_f32(0), 0.0);
        assert!(unit_f32(u32::MAX) < 1.0);
        let mut rng = Rng::new(UVec2::new(3, 5), 7, 11, Stream::Initial, 0);
        assert!((0..100_000).all(|_| (0.0..1.0).contains(&rng.next_f32())));
    }

    /// Chi-square of 256 bins over every component: false alarm 1e-4 for each of the 4 x 4 cases (fixed seeds).
    #[test]
    fn every_axis_is_uniform() {
        const N: usize = 1 << 16;
        // 256 bins, 255 degrees of freedom: quantile 0.9999 (Wilson-Hilferty).
        const LIMIT: f64 = 347.7;
        let by_axis: [fn(u32) -> Rng; 4] = [
            |i| Rng::new(UVec2::new(i, 9), 1, 2, Stream::Initial, 0),
            |i| Rng::new(UVec2::new(9, i), 1, 2, Stream::Initial, 0),
            |i| Rng::new(UVec2::new(9, 9), i, 2, Stream::Spatial, 1),
            |i| Rng::new(UVec2::new(9, 9), 1, i, Stream::Temporal, 0),
        ];
        for (axis, rng) in by_axis.iter().enumerate() {
            let mut bins = [[0u32; 256]; 4];
            for i in 0..N as u32 {
                let bits = rng(i).next_u32x4();
                for (component, bins) in bins.iter_mut().enumerate() {
                    bins[(bits[component] >> 24) as usize] += 1;
                }
            }
            for (component, bins) in bins.iter().enumerate() {
                let expected = N as f64 / 256.0;
                let chi2: f64 = bins.iter().map(|&n| (n as f64 - expected).powi(2) / expected).sum();
                assert!(chi2 < LIMIT, "axis {axis}, component {component}: chi-square {chi2}");
            }
        }
    }

    /// Neighboring pixels, frames, streams and lanes must not repeat one another's numbers.
    #[test]
    fn sequences_differ() {
        let mut seen = std::collections::HashSet::new();
        for pixel in 0..32 {
            for frame in 0..8 {
                for stream in [Stream::Initial, Stream::Temporal, Stream::Spatial, Stream::Reference] {
                    for lane in 0..4 {
                        let mut rng = Rng::new(UVec2::new(pixel, pixel / 2), frame, 0, stream, lane);
                        for _ in 0..4 {
                            assert!(
                                seen.insert(rng.next_u32x4().to_array()),
                                "repeated at pixel {pixel}, frame {frame}"
                            );
                        }
                    }
                }
            }
        }
    }
}
