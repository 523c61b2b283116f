//! Lists of lights that cells have seen: each light has one place in a cell's list, where the one that gave most stays.

use bytemuck::{Pod, Zeroable};
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float;

/// Places in a cell's list, a power of two.
pub const LIST: u32 = 64;

/// What is left of an entry's weight after a frame that did not find its light.
const KEPT: f32 = 0.95;
/// Steps of a code in an octave, and its least exponent.
const STEPS: f32 = 4.0;
const LEAST_EXPONENT: f32 = -32.0;
/// Bits of a light's index in a finding.
const INDEX_BITS: u32 = 24;

/// A light that a cell has seen; no light for a weight of 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ListEntry {
    /// Its index in the light buffer.
    pub light: u32,
    /// The most that it gave a pixel, p̂; it fades.
    pub weight: f32,
}

/// The place of `light` in every list: neighbors in the table take different ones.
pub fn place(light: u32) -> u32 {
    light.wrapping_mul(0x9e37_79b9) >> (u32::BITS - LIST.trailing_zeros())
}

/// `light` (below 2^24) gave a pixel p̂ = `target`, as a word of which the greatest one counts.
pub fn finding(light: u32, target: f32) -> u32 {
    let code = ((target.log2() - LEAST_EXPONENT) * STEPS).clamp(1.0, 255.0);
    (code as u32) << INDEX_BITS | light
}

/// An entry after a frame with this finding; 0: none.
pub fn learned(entry: ListEntry, finding: u32) -> ListEntry {
    let weight = entry.weight * KEPT;
    // Below the least that a finding says.
    let faded = ListEntry { weight: if weight < 1e-10 { 0.0 } else { weight }, ..entry };
    if finding == 0 {
        return faded;
    }
    let found = ListEntry {
        light: finding & ((1 << INDEX_BITS) - 1),
        weight: ((finding >> INDEX_BITS) as f32 / STEPS + LEAST_EXPONENT).exp2(),
    };
    if found.weight > faded.weight { found } else { faded }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A finding keeps its light, and its weight within a step of 19 %; of two the greater one is the greater word.
    #[test]
    fn findings_keep_light_and_weight() {
        for light in [0, 1, 77, (1 << 24) - 1] {
            for weight in [1e-8, 0.3, 1.0, 5e4, 1e9] {
                let entry = learned(ListEntry::default(), finding(light, weight));
                assert_eq!(entry.light, light);
                assert!((entry.weight / weight - 1.0).abs() < 0.19, "{weight} became {}", entry.weight);
                assert!(finding(light, weight * 2.0) > finding((1 << 24) - 1, weight));
            }
        }
        for extreme in [0.0, 1e-38, f32::MAX, f32::INFINITY] {
            let entry = learned(ListEntry::default(), finding(5, extreme));
            assert!(entry.light == 5 && entry.weight.is_finite() && entry.weight > 0.0);
        }
    }

    /// The light that gave most stays until it has faded; then the other takes its place, and in the end nobody.
    #[test]
    fn the_strongest_stays() {
        let strong = learned(ListEntry::default(), finding(1, 100.0));
        let mut entry = learned(strong, finding(2, 50.0));
        assert_eq!(entry.light, 1);
        for _ in 0..20 {
            entry = learned(entry, finding(2, 50.0));
        }
        assert_eq!(entry.light, 2);
        for _ in 0..2000 {
            entry = learned(entry, 0);
        }
        assert_eq!(entry.weight, 0.0);
    }

    /// Lights that follow each other, as those of one mesh do, share no place.
    #[test]
    fn neighbors_have_places_of_their_own() {
        for first in [0, 1000, 123_456] {
            let mut places: Vec<u32> = (first..first + 32).map(place).collect();
            places.sort_unstable();
            places.dedup();
            assert!(places.len() > 28, "{} places of 32", places.len());
        }
        assert!((0..100_000).all(|light| place(light) < LIST));
    }
}
