//! Pools of light samples: each frame draws one for every cell, and its pixels take their candidates from it.
//!
//! A sample comes from the cell's list, from the light tree, or from the alias table over all lights, each a fixed share of the
//! pool: whichever it came from, its density is that of the whole mixture.

use super::Cell;
use super::belief::Beliefs;
use super::list::{self, LIST, ListEntry};
use crate::light::LightTable;
use crate::light::tree::{Draw, LightTree};
use crate::motion::NO_LIGHT;
use crate::pdf::{Pmf, SourcePdf};
use crate::rng::Rng;

/// What a cell's lights are drawn from.
#[derive(Clone, Copy)]
pub struct Sources<'a> {
    /// All lights, by power.
    pub table: LightTable<'a>,
    /// The light tree, which the cell walks.
    pub tree: LightTree<'a>,
    /// Of all cells.
    pub lists: &'a [ListEntry],
    /// What the cell believes of the nodes of the tree.
    pub beliefs: Beliefs<'a>,
    /// Which cell.
    pub place: u32,
    /// Its content.
    pub cell: Cell,
    /// Samples of its pool.
    pub pool: u32,
}

/// How many samples of a pool each source gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Shares {
    list: u32,
    tree: u32,
    table: u32,
}

impl Sources<'_> {
    /// A quarter is the table's: it alone has light from infinity, and every other light that the rest may forget. Measured in
    /// docs/performance.md.
    fn shares(&self) -> Shares {
        let list = if self.cell.list_weight > 0.0 { self.pool / 4 } else { 0 };
        let tree = if self.tree.count > 0 { self.pool - self.pool / 4 - list } else { 0 };
        Shares { list, tree, table: self.pool - list - tree }
    }

    /// What entry `entry` of the pool is drawn from.
    #[cfg(not(target_arch = "spirv"))]
    pub fn name(&self, entry: u32) -> &'static str {
        let shares = self.shares();
        if entry < shares.list {
            "list"
        } else if entry < shares.list + shares.tree {
            "tree"
        } else {
            "table"
        }
    }

    /// Draws entry `entry` of the pool; its probability is that in the whole pool.
    pub fn sample(&self, entry: u32, rng: &mut Rng) -> Draw {
        let shares = self.shares();
        if entry >= shares.list && entry < shares.list + shares.tree {
            let Sources { cell, beliefs, .. } = self;
            return self.mixed(self.tree.sample(&cell.receiver, beliefs, cell.visibility, rng));
        }
        let light = if entry < shares.list {
            self.sample_list(rng)
        } else {
            let random = rng.next_u32x4();
            self.table.sample([random.x, random.y, random.z]).0.light
        };
        // A list may name lights that are no more.
        if light < self.table.lights.count() { self.draw(light) } else { Draw::none() }
    }

    fn sample_list(&self, rng: &mut Rng) -> u32 {
        let mut left = rng.next_f32() * self.cell.list_weight;
        let mut light = NO_LIGHT;
        let mut i = 0;
        while i < LIST && left >= 0.0 {
            let entry = self.lists[(self.place * LIST + i) as usize];
            if entry.weight > 0.0 {
                // Rounding may lead past the end: then the last one is it.
                light = entry.light;
                left -= entry.weight;
            }
            i += 1;
        }
        light
    }

    /// The draw of `light`, which there must be, as [`Sources::sample`] makes it of an entry that is picked evenly.
    pub fn draw(&self, light: u32) -> Draw {
        self.mixed(self.tree.draw(light, &self.cell.receiver, &self.beliefs, self.cell.visibility))
    }

    /// The same where the tree's is known.
    ///
    /// Equation (30).
    fn mixed(&self, by_tree: Draw) -> Draw {
        let Draw { light, pmf, .. } = by_tree;
        let shares = self.shares();
        let entry = self.lists[(self.place * LIST + list::place(light)) as usize];
        let listed =
            if shares.list > 0 && entry.light == light { entry.weight / self.cell.list_weight } else { 0.0 };
        // Where no light has power there is no table.
        let table = if self.table.alias.is_empty() { 0.0 } else { self.table.pmf(light).0 };
        let sum = shares.list as f32 * listed + shares.tree as f32 * pmf.0 + shares.table as f32 * table;
        Draw { pmf: Pmf(sum / self.pool as f32), ..by_tree }
    }

    /// The density of a sample on `light`, in the light's own measure; 0 for no light.
    pub fn pdf(&self, light: u32) -> SourcePdf {
        if light >= self.table.lights.count() {
            return SourcePdf(0.0);
        }
        self.draw(light).pmf.and_on_light(self.table.lights.pdf_li(light))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells::belief;
    use crate::light::tree::{self, Receiver};
    use crate::light::{Light, Lights, build_alias_table};
    use crate::rng::Stream;
    use glam::{UVec2, Vec3};

    fn lights() -> Vec<Light> {
        let point = |i: u32| {
            Light::point(Vec3::new((i % 5) as f32, 1.0, i as f32), Vec3::splat(1.0 + (i % 7) as f32))
        };
        let sun = |i: u32| Light::directional(Vec3::Y, Vec3::splat(0.01 * i as f32), 9.0);
        (0..30).map(point).chain((1..4).map(sun)).collect()
    }

    /// With nothing listed, with a little, with half of the lights: probabilities of all lights add up to 1 in f64 within 1e-5, and
    /// pools are drawn with them (chi-square, 32 degrees of freedom, false alarm 1e-4 each, fixed seeds).
    #[test]
    fn pools_follow_their_mixture() {
        let lights = lights();
        let alias = build_alias_table(&lights);
        let tree = tree::build(&lights);
        let table = LightTable { lights: Lights::untextured(&lights), alias: &alias };
        let receiver = Receiver { center: Vec3::new(1.0, 0.0, 7.0), radius: 0.5, normal: Vec3::Y };
        let place = 77;
        let mut lists = vec![ListEntry::default(); (100 * LIST) as usize];
        // Some rays to every node, of which a part arrived.
        let known: Vec<u32> = (0..belief::BELIEFS).map(|i| ((i % 50) << 16) + i % 50 * (i % 7) / 7).collect();
        const POOL: u32 = 128;
        for listed in [0, 1, 17] {
            for light in (0..listed).map(|i| i * 31 % 33) {
                let weight = 0.1 + light as f32;
                lists[(place * LIST + list::place(light)) as usize] = ListEntry { light, weight };
            }
            let weights = lists[(place * LIST) as usize..][..LIST as usize].iter().map(|entry| entry.weight);
            let cell = Cell { receiver, list_weight: weights.sum(), visibility: 0.6 };
            for view in [tree.view(), LightTree { count: 0, ..tree.view() }] {
                let beliefs = Beliefs { table: &known, cells: 1, cell: 0 };
                let sources = Sources { table, tree: view, lists: &lists, beliefs, place, cell, pool: POOL };
                let pmf = |light| f64::from(sources.draw(light).pmf.0);
                let sum: f64 = (0..33).map(pmf).sum();
                assert!((sum - 1.0).abs() < 1e-5, "{listed} listed: {sum}");
                let mut counts = [0u32; 33];
                const POOLS: u32 = 400;
                for i in 0..POOLS * POOL {
                    let mut rng = Rng::new(UVec2::new(i, listed), view.count, 3, Stream::Pools, 0);
                    let drawn = sources.sample(i % POOL, &mut rng);
                    assert_eq!(drawn, sources.draw(drawn.light));
                    counts[drawn.light as usize] += 1;
                }
                let chi2: f64 = (0..33)
                    .map(|i| (pmf(i) * f64::from(POOLS * POOL), f64::from(counts[i as usize])))
                    .map(|(expected, n)| (n - expected).powi(2) / expected)
                    .sum();
                assert!(chi2 < 68.0, "{listed} listed: {chi2}");
                assert!(counts.iter().all(|&n| n > 0), "a light is never drawn: {counts:?}");
            }
        }
    }
}
