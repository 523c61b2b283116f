//! What cells believe of clusters of lights: how often a shadow ray to one of them arrives.

use crate::motion::NO_LIGHT;
use crate::rng::hash;
use glam::UVec4;

/// Beliefs for each place of a cell, a power of two: all lie in one table without keys, and what shares a place by its hash is
/// believed of together.
pub const BELIEFS: u32 = 1 << 8;

/// Most clusters of the lights of a tree, as powers of two; fewer lights are each by itself.
const CLUSTERS_LOG2: u32 = 13;
/// Fractions of a ray in a count.
const UNIT: u32 = 32;
/// Of each count a 32nd is forgotten in a frame.
const FORGETS: u32 = 32;
/// Rays that arrived before any was asked for: what nobody has asked for is worth asking.
const HOPE: f32 = 0.3;
/// The least that is believed: rare lights that do arrive would be bright specks below it. Measured in docs/performance.md.
const FLOOR: f32 = 0.05;

/// The cluster of `light`, which lies at `leaf` of a light tree of `count`: neighbors in the tree, or texels of an environment that
/// follow each other.
pub fn cluster_of(light: u32, leaf: u32, mut count: u32) -> u32 {
    if leaf == NO_LIGHT {
        return 1 << 31 | light >> 4;
    }
    let mut cluster = leaf;
    while count > 1 << CLUSTERS_LOG2 {
        cluster >>= 1;
        count >>= 1;
    }
    cluster
}

/// Stands for all clusters together.
pub const ALL: u32 = u32::MAX;

/// The place of what cell `cell` of so many `cells` believes of `cluster`.
pub fn place(cells: u32, cell: u32, cluster: u32) -> u32 {
    hash(UVec4::new(cell, cluster, 0x5eed, 0)).x & (cells * BELIEFS - 1)
}

/// A ray, as it is counted in a frame: asked in the upper half, seen in the lower.
pub fn observation(seen: bool) -> u32 {
    1 << 16 | u32::from(seen)
}

/// A belief with the rays of a frame, `observed`; what is older counts less. Both halves are in rays / [`UNIT`].
pub fn learned(belief: u32, observed: u32) -> u32 {
    let kept = |count: u32| count - count.div_ceil(FORGETS);
    let mut asked = kept(belief >> 16) + UNIT * (observed >> 16);
    let mut seen = kept(belief & 0xffff) + UNIT * (observed & 0xffff);
    while asked > 0xffff {
        asked >>= 1;
        seen >>= 1;
    }
    asked << 16 | seen.min(asked)
}

/// The fraction of rays that is believed to arrive, in (0, 1]; `prior` where none was asked for.
///
/// Equation (32).
pub fn believed(belief: u32, prior: f32) -> f32 {
    let hope = HOPE * UNIT as f32;
    let fraction = ((belief & 0xffff) as f32 + hope * prior) / ((belief >> 16) as f32 + hope);
    fraction.clamp(FLOOR, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(frames: u32, rays: u32, seen: u32) -> u32 {
        (0..frames).fold(0, |belief, _| learned(belief, rays << 16 | seen))
    }

    /// A fraction that stays the same is believed in the end; what is no longer observed is forgotten; nothing overflows.
    #[test]
    fn beliefs_follow_what_is_seen() {
        for (rays, seen) in [(40, 10), (7, 7), (1000, 900), (60_000, 30_000)] {
            let belief = believed(after(200, rays, seen), 1.0);
            let fraction = seen as f32 / rays as f32;
            assert!((belief - fraction).abs() < 0.01, "{belief} instead of {fraction}");
        }
        assert_eq!(believed(after(200, 40, 0), 1.0), FLOOR);
        let forgotten = (0..400).fold(after(200, 40, 0), |belief, _| learned(belief, 0));
        assert_eq!((forgotten, believed(forgotten, 0.7)), (0, 0.7));
        // Within a second or two at 60 frames a second.
        let turned = (0..60).fold(after(200, 40, 0), |belief, _| learned(belief, 40 << 16 | 40));
        assert!(believed(turned, 1.0) > 0.7);
    }

    /// Whatever the words are, also those that overflowed, the belief is a fraction.
    #[test]
    fn every_word_is_a_fraction() {
        for word in (0..=u32::MAX).step_by(65_521) {
            for prior in [0.05, 1.0] {
                let fraction = believed(learned(word, word.rotate_left(7)), prior);
                assert!((FLOOR..=1.0).contains(&fraction));
                assert!((FLOOR..=1.0).contains(&believed(word, prior)));
            }
        }
    }

    /// Few lights are each by itself; of many at most 2^13 clusters of neighbors are left.
    #[test]
    fn clusters_are_neighbors() {
        assert!((0..8192).all(|leaf| cluster_of(9, leaf, 8192) == leaf));
        let clusters = |count: u32| cluster_of(0, count - 1, count) + 1;
        for count in [8193, 20_000, 1_000_000, 16_000_000] {
            assert!((4096..=8192).contains(&clusters(count)), "{count}: {}", clusters(count));
        }
        assert_ne!(cluster_of(3, NO_LIGHT, 10), cluster_of(3, 3, 10));
    }
}
