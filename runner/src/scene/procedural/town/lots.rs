//! Positions of houses: rows along the sides of the blocks.

use super::dice::Dice;
use super::houses::{BAY, DEPTH, House};
use super::plan::{Block, KERB, Plan, SIDES, Side, Usage};
use super::room;
use glam::{Affine3A, Quat, Vec2, Vec3};

/// A house of a design in its place.
#[derive(Clone, Debug)]
pub struct Lot {
    pub design: usize,
    pub block: usize,
    pub side: Side,
    /// Of the house's space into the world: turned by quarters, stretched along its axes, at some ends mirrored.
    pub transform: Affine3A,
}

/// Between the backs of rows that share a block.
const YARD: f32 = 1.0;

/// All lots; `designs` says what houses there are.
pub fn lots(plan: &Plan, designs: &[House]) -> Vec<Lot> {
    let mut lots = Vec::new();
    for (i, block) in plan.blocks.iter().enumerate() {
        if block.usage == Usage::Houses {
            for side in SIDES {
                row(&mut lots, plan, i, side, designs);
            }
        }
    }
    lots
}

/// Depth of the rows of a block.
fn depth(block: &Block) -> f32 {
    (0.5 * (block.plot.size().min_element() - YARD)).clamp(6.0, DEPTH)
}

/// The houses along one side; those at north and south reach the block's corners.
fn row(lots: &mut Vec<Lot>, plan: &Plan, index: usize, side: Side, designs: &[House]) {
    let block = &plan.blocks[index];
    let depth = depth(block);
    let [mut left, right] = block.plot.edge(side);
    let along = (right - left).normalize();
    let mut length = left.distance(right);
    let ends = matches!(side, Side::North | Side::South);
    if !ends {
        left += depth * along;
        length -= 2.0 * depth;
        if length < 2.0 * BAY {
            return;
        }
    }
    let mut dice = Dice::new(20, 4 * index + side as usize);
    // A house of its own has its place in the row.
    let gap = room::place(plan).filter(|place| (place.block, place.side) == (index, side));
    let mut runs = vec![([0.0, length], [ends; 2])];
    if let Some(place) = gap {
        let at = (place.foot - left).dot(along);
        let half = 0.5 * room::WIDTH;
        runs = vec![([0.0, at - half], [ends, false]), ([at + half, length], [false, ends])];
    }
    for ([from, to], corners) in runs {
        let chosen = choose(block, designs, to - from, corners, &mut dice);
        let native: f32 = chosen.iter().map(|&i| width(&designs[i])).sum();
        let stretch = (to - from) / native;
        let mut at = from;
        for (k, &design) in chosen.iter().enumerate() {
            let width = width(&designs[design]) * stretch;
            let middle = left + (at + 0.5 * width) * along;
            // Designs have their corner at the right.
            let mirror = if designs[design].corner && k == 0 { -1.0 } else { 1.0 };
            let scale = Vec3::new(stretch * mirror, 1.0, depth / DEPTH);
            let transform = standing(middle, side, scale);
            lots.push(Lot { design, block: index, side, transform });
            at += width;
        }
    }
}

/// From the space of a house to where its front faces `side`.
pub fn standing(foot: Vec2, side: Side, scale: Vec3) -> Affine3A {
    let place = Vec3::new(foot.x, KERB, foot.y);
    Affine3A::from_scale_rotation_translation(scale, quarter(side), place)
}

/// Exact quarters of a turn.
fn quarter(side: Side) -> Quat {
    let h = std::f32::consts::FRAC_1_SQRT_2;
    match side {
        Side::South => Quat::IDENTITY,
        Side::East => Quat::from_xyzw(0.0, h, 0.0, h),
        Side::North => Quat::from_xyzw(0.0, 1.0, 0.0, 0.0),
        Side::West => Quat::from_xyzw(0.0, -h, 0.0, h),
    }
}

pub fn width(house: &House) -> f32 {
    house.bays as f32 * BAY
}

/// Designs that fill `length` with the least stretching; of some draws the best.
fn choose(block: &Block, designs: &[House], length: f32, corners: [bool; 2], dice: &mut Dice) -> Vec<usize> {
    let distance = block.distance();
    // Low at the edge, high at the ring, middling in the old town.
    let storeys = match distance {
        d if d < 130.0 => 4..=6,
        d if d < 330.0 => 4..=8,
        d if d < 430.0 => 3..=5,
        _ => 2..=4,
    };
    let fits = |corner: bool| -> Vec<usize> {
        let fit = |house: &House| house.corner == corner && storeys.contains(&house.storeys);
        (0..designs.len()).filter(|&i| fit(&designs[i])).collect()
    };
    let (inner, outer) = (fits(false), fits(true));
    let count = (length / 12.0).round().max(1.0) as usize;
    let mut best: (f32, Vec<usize>) = (f32::INFINITY, Vec::new());
    for trial in 0..24 {
        let count = (count + trial % 3).saturating_sub(1).max(if corners == [true; 2] { 2 } else { 1 });
        let at_end = |k: usize| (k == 0 && corners[0]) || (k + 1 == count && corners[1]);
        let chosen: Vec<usize> =
            (0..count).map(|k| dice.pick(if at_end(k) { &outer } else { &inner })).collect();
        let native: f32 = chosen.iter().map(|&i| width(&designs[i])).sum();
        let strain = (length / native).ln().abs();
        if strain < best.0 {
            best = (strain, chosen);
        }
    }
    best.1
}

impl Lot {
    /// How far the front's middle is from that of the town.
    pub fn distance(&self) -> f32 {
        self.transform.translation.length()
    }
}
