//! Random choices: the same case gives the same ones everywhere.

use glam::UVec2;
use shared::rng::{Rng, Stream};

pub struct Dice(Rng);

impl Dice {
    pub fn new(seed: u32, target: u32, case: u64) -> Self {
        Dice(Rng::new(UVec2::new(case as u32, (case >> 32) as u32), target, seed, Stream::Initial, 0))
    }

    pub fn bits(&mut self) -> u32 {
        self.0.next_u32x4().x
    }

    /// Below `n`, which is above 0.
    pub fn below(&mut self, n: usize) -> usize {
        ((u64::from(self.bits()) * n as u64) >> 32) as usize
    }

    pub fn one_in(&mut self, n: usize) -> bool {
        self.below(n) == 0
    }

    pub fn of<'a, T>(&mut self, list: &'a [T]) -> &'a T {
        &list[self.below(list.len())]
    }
}
