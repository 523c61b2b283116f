//! The town's ground plan in closed form, m: x to the east, z to the south, the square in the middle.
//!
//! Lines run from edge to edge; each is a road between kerbs and two pavements. Cells between lines become blocks, some of two cells.

use super::dice::Dice;
use glam::{Vec2, Vec3};
use std::ops::Range;

/// The town lies within this of its middle, along x and z.
pub const HALF: f32 = 500.0;
/// The outermost kerb.
pub const EDGE: f32 = 494.0;
/// Height of pavements over the road.
pub const KERB: f32 = 0.12;

/// How wide a road is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rank {
    Lane,
    Street,
    Avenue,
}

impl Rank {
    /// From kerb to kerb.
    pub fn road(self) -> f32 {
        match self {
            Rank::Lane => 7.0,
            Rank::Street => 11.0,
            Rank::Avenue => 18.0,
        }
    }

    pub fn pavement(self) -> f32 {
        match self {
            Rank::Lane => 2.6,
            Rank::Street => 3.5,
            Rank::Avenue => 6.0,
        }
    }

    /// Where cars stand, from the kerb; lanes have no room for them.
    pub fn parking(self) -> f32 {
        match self {
            Rank::Lane => 0.0,
            Rank::Street | Rank::Avenue => 2.3,
        }
    }

    /// From the kerb to the middle of the lane next to it.
    pub fn lane(self) -> f32 {
        match self {
            Rank::Lane => 1.75,
            Rank::Street => 3.9,
            Rank::Avenue => 4.1,
        }
    }
}

/// A road from edge to edge, along one axis at a place of the other.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    pub at: f32,
    pub rank: Rank,
}

/// Axis-aligned in the plane (x, z).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect {
    pub min: Vec2,
    pub max: Vec2,
}

/// What a block is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Usage {
    Square,
    Park,
    Houses,
    Towers,
}

/// Land between roads.
#[derive(Clone, Debug)]
pub struct Block {
    /// Cells along x and z.
    pub cells: [Range<usize>; 2],
    /// Within its kerbs.
    pub curb: Rect,
    /// Within its pavements.
    pub plot: Rect,
    pub usage: Usage,
}

/// A side of a block, seen from its middle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    North,
    East,
    South,
    West,
}

pub const SIDES: [Side; 4] = [Side::North, Side::East, Side::South, Side::West];

/// The road between two crossings.
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    pub road: Rect,
    pub rank: Rank,
    /// It runs along x.
    pub along_x: bool,
    /// The blocks at its sides, north and south or west and east; none outside the town.
    pub blocks: [Option<usize>; 2],
}

/// The whole town.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Roads along z, by x.
    pub xs: Vec<Line>,
    /// Roads along x, by z.
    pub zs: Vec<Line>,
    pub blocks: Vec<Block>,
    pub segments: Vec<Segment>,
    pub crossings: Vec<Rect>,
}

impl Rect {
    pub fn new(min: Vec2, max: Vec2) -> Self {
        Rect { min, max }
    }

    pub fn around(center: Vec2, size: Vec2) -> Self {
        Rect { min: center - 0.5 * size, max: center + 0.5 * size }
    }

    pub fn contains(&self, p: Vec2) -> bool {
        p.cmpge(self.min).all() && p.cmple(self.max).all()
    }

    pub fn inset(&self, by: f32) -> Rect {
        Rect { min: self.min + by, max: self.max - by }
    }

    pub fn center(&self) -> Vec2 {
        0.5 * (self.min + self.max)
    }

    pub fn size(&self) -> Vec2 {
        self.max - self.min
    }

    /// At a height, counter-clockwise from above.
    pub fn corners(&self, y: f32) -> [Vec3; 4] {
        let (a, b) = (self.min, self.max);
        [(a.x, a.y), (a.x, b.y), (b.x, b.y), (b.x, a.y)].map(|(x, z)| Vec3::new(x, y, z))
    }

    /// The ends of its edge at `side`, from left to right as seen from outside.
    pub fn edge(&self, side: Side) -> [Vec2; 2] {
        let (a, b) = (self.min, self.max);
        let ends = match side {
            Side::North => [(b.x, a.y), (a.x, a.y)],
            Side::East => [(b.x, b.y), (b.x, a.y)],
            Side::South => [(a.x, b.y), (b.x, b.y)],
            Side::West => [(a.x, a.y), (a.x, b.y)],
        };
        ends.map(Vec2::from)
    }
}

impl Side {
    /// Unit, away from the block.
    pub fn outward(self) -> Vec2 {
        match self {
            Side::North => Vec2::NEG_Y,
            Side::East => Vec2::X,
            Side::South => Vec2::Y,
            Side::West => Vec2::NEG_X,
        }
    }

    /// Turn about +Y that takes +Z there, radians.
    pub fn turn(self) -> f32 {
        let quarters = match self {
            Side::South => 0.0,
            Side::East => 1.0,
            Side::North => 2.0,
            Side::West => 3.0,
        };
        std::f32::consts::FRAC_PI_2 * quarters
    }
}

impl Block {
    /// How far its middle is from that of the town.
    pub fn distance(&self) -> f32 {
        self.plot.center().length()
    }
}

/// Lines whose place the town's looks depend on: edges, ring, the square's sides, the axis through it.
const FIXED_X: [Line; 6] = [
    Line { at: -485.0, rank: Rank::Avenue },
    Line { at: -236.0, rank: Rank::Avenue },
    Line { at: -56.0, rank: Rank::Street },
    Line { at: 56.0, rank: Rank::Street },
    Line { at: 241.0, rank: Rank::Avenue },
    Line { at: 485.0, rank: Rank::Avenue },
];
const FIXED_Z: [Line; 7] = [
    Line { at: -485.0, rank: Rank::Avenue },
    Line { at: -228.0, rank: Rank::Avenue },
    Line { at: -58.0, rank: Rank::Street },
    Line { at: 0.0, rank: Rank::Avenue },
    Line { at: 58.0, rank: Rank::Street },
    Line { at: 233.0, rank: Rank::Avenue },
    Line { at: 485.0, rank: Rank::Avenue },
];
/// Mean distance of the lines between them.
const PITCH: f32 = 60.0;
/// Blocks of two cells, without the square.
const DOUBLES: usize = 22;
/// Where towers stand, apart from some elsewhere: north-east, outside the ring.
const TOWERS: Vec2 = Vec2::new(330.0, -300.0);

impl Plan {
    pub fn new() -> Self {
        let xs = lines(&FIXED_X, 1);
        let zs = lines(&FIXED_Z, 2);
        let mut plan = Plan { xs, zs, blocks: Vec::new(), segments: Vec::new(), crossings: Vec::new() };
        let owners = plan.divide();
        plan.use_blocks();
        plan.roads(&owners);
        plan
    }

    /// Makes the blocks; returns whose each cell is (by x, then z).
    fn divide(&mut self) -> Vec<Vec<usize>> {
        let [nx, nz] = [self.xs.len() - 1, self.zs.len() - 1];
        let mut owners = vec![vec![usize::MAX; nz]; nx];
        let column = self.xs.iter().position(|line| line.at == -56.0).unwrap_or(0);
        let row = self.zs.iter().position(|line| line.at == -58.0).unwrap_or(0);
        let mut ranges = vec![[column..column + 1, row..row + 2]];
        let mut dice = Dice::new(3, 0);
        let free = |[x, z]: &[Range<usize>; 2], owners: &[Vec<usize>]| {
            x.clone().all(|i| z.clone().all(|j| owners[i][j] == usize::MAX))
        };
        take(&mut owners, &ranges[0], 0);
        while ranges.len() <= DOUBLES {
            let (i, j) = (dice.below(nx - 1), dice.below(nz - 1));
            // Across lanes alone: greater roads go through.
            let (range, between) = match dice.chance(0.5) {
                true => ([i..i + 2, j..j + 1], self.xs[i + 1].rank),
                false => ([i..i + 1, j..j + 2], self.zs[j + 1].rank),
            };
            if between == Rank::Lane && free(&range, &owners) {
                take(&mut owners, &range, ranges.len());
                ranges.push(range);
            }
        }
        for i in 0..nx {
            for j in 0..nz {
                let range = [i..i + 1, j..j + 1];
                if free(&range, &owners) {
                    take(&mut owners, &range, ranges.len());
                    ranges.push(range);
                }
            }
        }
        self.blocks = ranges.into_iter().map(|cells| self.block(cells)).collect();
        owners
    }

    fn block(&self, cells: [Range<usize>; 2]) -> Block {
        let [x, z] = &cells;
        let lines = [&self.xs[x.start], &self.zs[z.start], &self.xs[x.end], &self.zs[z.end]];
        let at = |width: fn(Rank) -> f32| {
            let [west, north, east, south] = lines;
            let half = |line: &Line| 0.5 * width(line.rank);
            let min = Vec2::new(west.at + half(west), north.at + half(north));
            Rect { min, max: Vec2::new(east.at - half(east), south.at - half(south)) }
        };
        let (curb, plot) = (at(Rank::road), at(|rank| rank.road() + 2.0 * rank.pavement()));
        Block { curb, plot, usage: Usage::Houses, cells }
    }

    fn use_blocks(&mut self) {
        self.blocks[0].usage = Usage::Square;
        let mut dice = Dice::new(4, 0);
        let (mut parks, mut towers) = (0, 0);
        for (i, block) in self.blocks.iter_mut().enumerate().skip(1) {
            let distance = block.distance();
            let double = i <= DOUBLES;
            if double && parks < 6 && distance > 95.0 && dice.chance(0.5) {
                block.usage = Usage::Park;
                parks += 1;
            } else if block.plot.size().min_element() > 28.0 {
                let near = block.plot.center().distance(TOWERS);
                let likely = match (near, distance) {
                    (..105.0, _) => 0.85,
                    (_, 330.0..) => 0.06,
                    _ => 0.0,
                };
                if towers < 22 && dice.chance(likely) {
                    block.usage = Usage::Towers;
                    towers += 1;
                }
            }
        }
    }

    fn roads(&mut self, owners: &[Vec<usize>]) {
        let owner = |i: Option<usize>, j: Option<usize>| Some(*owners.get(i?)?.get(j?)?);
        let half = |line: &Line| 0.5 * line.rank.road();
        for (k, x) in self.xs.iter().enumerate() {
            for (j, pair) in self.zs.windows(2).enumerate() {
                let blocks = [owner(k.checked_sub(1), Some(j)), owner(Some(k), Some(j))];
                let min = Vec2::new(x.at - half(x), pair[0].at + half(&pair[0]));
                let max = Vec2::new(x.at + half(x), pair[1].at - half(&pair[1]));
                if blocks[0] != blocks[1] {
                    let road = Rect { min, max };
                    self.segments.push(Segment { road, rank: x.rank, along_x: false, blocks });
                }
            }
            for z in &self.zs {
                let size = 2.0 * Vec2::new(half(x), half(z));
                self.crossings.push(Rect::around(Vec2::new(x.at, z.at), size));
            }
        }
        for (k, z) in self.zs.iter().enumerate() {
            for (i, pair) in self.xs.windows(2).enumerate() {
                let blocks = [owner(Some(i), k.checked_sub(1)), owner(Some(i), Some(k))];
                let min = Vec2::new(pair[0].at + half(&pair[0]), z.at - half(z));
                let max = Vec2::new(pair[1].at - half(&pair[1]), z.at + half(z));
                if blocks[0] != blocks[1] {
                    let road = Rect { min, max };
                    self.segments.push(Segment { road, rank: z.rank, along_x: true, blocks });
                }
            }
        }
    }

    /// Of the road at a side of a block.
    pub fn rank(&self, block: &Block, side: Side) -> Rank {
        let [x, z] = &block.cells;
        match side {
            Side::North => self.zs[z.start].rank,
            Side::South => self.zs[z.end].rank,
            Side::West => self.xs[x.start].rank,
            Side::East => self.xs[x.end].rank,
        }
    }
}

fn take(owners: &mut [Vec<usize>], [x, z]: &[Range<usize>; 2], block: usize) {
    for column in &mut owners[x.clone()] {
        column[z.clone()].fill(block);
    }
}

/// The fixed lines and others between them, unevenly.
fn lines(fixed: &[Line], purpose: usize) -> Vec<Line> {
    let mut dice = Dice::new(1, purpose);
    let mut lines = vec![fixed[0]];
    for pair in fixed.windows(2) {
        let gap = pair[1].at - pair[0].at;
        let parts = if gap < 1.9 * PITCH { 1 } else { (gap / PITCH).round() as usize };
        for i in 1..parts {
            let even = gap * i as f32 / parts as f32;
            let rank = if dice.chance(0.45) { Rank::Lane } else { Rank::Street };
            // Whole decimetres are enough.
            let at = (10.0 * (pair[0].at + even + dice.within(-7.0..7.0))).round() / 10.0;
            lines.push(Line { at, rank });
        }
        lines.push(pair[1]);
    }
    lines
}
