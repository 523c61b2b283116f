//! What cells believe of the nodes of the light tree: how often a shadow ray to one of their lights arrives. A node of which
//! little is known is believed of as its parent is, so few rays teach a cell that a whole street is hidden, and many that one of its
//! lamps is not.

use crate::light::tree;
use crate::motion::NO_LIGHT;
use crate::rng::hash;
use glam::UVec4;

/// Beliefs for each place of a cell, a power of two: all lie in one table without keys, and what shares a place by its hash is
/// believed of together.
pub const BELIEFS: u32 = 1 << 8;

/// The root of the tree: all lights, also those that are nowhere.
pub const ALL: u32 = 0;

/// Fractions of a ray in a count.
const UNIT: u32 = 32;
/// Of each count a 32nd is forgotten in a frame.
const FORGETS: u32 = 32;
/// Rays that a node's parent answers for before its own count as much: what nobody has asked for is worth asking.
const HOPE: f32 = 1.0;
/// The least that is believed: rare lights that do arrive would be bright specks below it. Measured in docs/performance.md.
const FLOOR: f32 = 0.05;

/// Stands for what `light` is believed to be together with, of the lights that are in no tree: texels of an environment that follow
/// each other.
pub fn far_away(light: u32) -> u32 {
    1 << 31 | light >> 4
}

/// The place of what cell `cell` of so many `cells` believes of `node`.
pub fn place(cells: u32, cell: u32, node: u32) -> u32 {
    hash(UVec4::new(cell, node, 0x5eed, 0)).x & (cells * BELIEFS - 1)
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

/// The fraction of rays that is believed to arrive, in [0, 1], where that of the parent is `prior`.
///
/// Equation (32).
pub fn believed(belief: u32, prior: f32) -> f32 {
    let hope = HOPE * UNIT as f32;
    ((belief & 0xffff) as f32 + hope * prior) / ((belief >> 16) as f32 + hope)
}

/// What a fraction that is believed weighs, in (0, 1].
pub fn weight(fraction: f32) -> f32 {
    fraction.max(FLOOR)
}

/// What one cell believes.
#[derive(Clone, Copy)]
pub struct Beliefs<'a> {
    /// Of all cells.
    pub table: &'a [u32],
    /// How many places for cells that is.
    pub cells: u32,
    /// Which cell.
    pub cell: u32,
}

impl Beliefs<'_> {
    /// The rays to `node`, for [`believed`].
    pub fn rays(&self, node: u32) -> u32 {
        self.table[place(self.cells, self.cell, node) as usize]
    }

    /// Of `light` at `leaf` of a tree of `count`, or in none ([`NO_LIGHT`]), where `all` is believed of all lights.
    pub fn of_light(&self, light: u32, leaf: u32, count: u32, all: f32) -> f32 {
        if leaf == NO_LIGHT {
            return self.of(far_away(light), all);
        }
        let mut fraction = all;
        tree::path(leaf, count, |node| fraction = self.of(node, fraction));
        fraction
    }

    /// Of `node`, see [`believed`].
    pub fn of(&self, node: u32, prior: f32) -> f32 {
        believed(self.rays(node), prior)
    }
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
        assert!(believed(after(200, 40, 0), 1.0) < 0.01);
        assert_eq!(weight(believed(after(200, 40, 0), 1.0)), FLOOR);
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
                assert!((0.0..=1.0).contains(&fraction), "{fraction}");
                assert!((FLOOR..=1.0).contains(&weight(fraction)));
            }
        }
    }

    /// Of a node that nobody has asked for its parent's fraction is believed; rays of its own count more and more.
    #[test]
    fn parents_answer_for_what_is_unknown() {
        for prior in [0.0, 0.3, 1.0] {
            assert_eq!(believed(0, prior), prior);
            let beliefs = [0, 1, 5, 50].map(|rays| believed(learned(0, rays << 16), prior));
            assert!(beliefs.windows(2).all(|pair| pair[1] < pair[0] || prior == 0.0), "{beliefs:?}");
        }
    }
}
