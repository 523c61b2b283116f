//! Trees, hedges and benches, and where they stand.

use super::dice::Dice;
use super::materials::{Finish, Part};
use super::plan::{KERB, Plan, Rank, Rect, SIDES, Usage};
use crate::scene::procedural::shapes::{Outline, Shape, bevelled_cuboid, cuboid, lathe, tube};
use glam::{Affine3A, Quat, Vec2, Vec3};
use std::f32::consts::TAU;

/// Tree meshes.
pub const TREES: usize = 3;
/// Height of a crown's middle, and its half-axes, m.
pub const CROWN: (f32, Vec3) = (4.6, Vec3::new(1.9, 2.1, 1.9));

/// A tree in its place.
#[derive(Clone, Copy, Debug)]
pub struct Tree {
    pub mesh: usize,
    pub foot: Vec2,
    pub turn: f32,
    pub size: f32,
}

impl Tree {
    fn new(foot: Vec2, dice: &mut Dice) -> Self {
        Tree { mesh: dice.below(TREES), foot, turn: dice.within(0.0..TAU), size: dice.within(0.8..1.15) }
    }

    pub fn transform(&self) -> Affine3A {
        let foot = Vec3::new(self.foot.x, KERB, self.foot.y);
        let turn = Quat::from_rotation_y(self.turn);
        Affine3A::from_scale_rotation_translation(Vec3::splat(self.size), turn, foot)
    }
}

/// Trees of avenues, parks and of the places around towers.
pub fn trees(plan: &Plan) -> Vec<Tree> {
    let mut trees = Vec::new();
    for (i, block) in plan.blocks.iter().enumerate() {
        let mut dice = Dice::new(60, i);
        for side in SIDES {
            if plan.rank(block, side) != Rank::Avenue {
                continue;
            }
            let [left, right] = block.curb.edge(side);
            let count = (left.distance(right) / 12.0).floor() as usize;
            // Lamps stand in the middles of their shares; trees between them.
            for k in 0..=count {
                let at = left.lerp(right, (k as f32 + 0.02) / (count as f32 + 0.04));
                let inside = at - 1.6 * side.outward();
                if block.curb.inset(1.5).contains(inside) && dice.chance(0.9) {
                    trees.push(Tree::new(inside, &mut dice));
                }
            }
        }
        match block.usage {
            Usage::Park => scatter(&mut trees, &block.plot.inset(3.0), 0.011, &mut dice, |_| true),
            Usage::Towers => {
                // Towers stand at least 4 m from the pavement.
                let edge = block.plot.inset(0.8);
                scatter(&mut trees, &edge, 0.02, &mut dice, |p| !block.plot.inset(1.8).contains(p));
            }
            Usage::Square | Usage::Houses => {}
        }
    }
    trees
}

/// So many trees a square metre, none too near to another or to the paths through the middle.
fn scatter(trees: &mut Vec<Tree>, rect: &Rect, density: f32, dice: &mut Dice, free: impl Fn(Vec2) -> bool) {
    let (first, size) = (trees.len(), rect.size());
    for _ in 0..(size.x * size.y * density) as usize {
        let p = rect.min + size * Vec2::new(dice.unit(), dice.unit());
        let path = (p - rect.center()).abs().min_element() < 3.0;
        if !path && free(p) && trees[first..].iter().all(|tree| tree.foot.distance(p) > 4.5) {
            trees.push(Tree::new(p, dice));
        }
    }
}

/// A tree of about 6.5 m with its foot at the origin.
pub fn tree(number: usize) -> Part {
    let mut dice = Dice::new(61, number);
    let trunk = Outline::from(0.24, 0.0).to(0.16, 0.4).to(0.11, 2.6).to(0.05, 4.8).open();
    let mut part = Part::of(Finish::Bark, lathe(&trunk, 7));
    for k in 0..5 {
        let way = Vec2::from_angle(TAU * (k as f32 + 0.3 * dice.unit()) / 5.0);
        let from = Vec3::new(0.0, dice.within(2.3..3.2), 0.0);
        let to = Vec3::new(1.2 * way.x, from.y + dice.within(1.0..2.0), 1.2 * way.y);
        part.add(Finish::Bark, &tube(from, to, 0.045, 5));
    }
    let mut leaves = Shape::default();
    for _ in 0..190 {
        let way = direction(&mut dice);
        let r = 1.0 - 0.55 * dice.unit() * dice.unit();
        let place = CROWN.1 * way * r + Vec3::Y * CROWN.0;
        leaves.append(&spray(place, (way + 0.7 * direction(&mut dice)).normalize(), dice.within(0.32..0.6)));
    }
    part.with(Finish::Leaf, leaves)
}

fn direction(dice: &mut Dice) -> Vec3 {
    let (y, angle) = (dice.within(-1.0..1.0), dice.within(0.0..TAU));
    let r = (1.0 - y * y).sqrt();
    Vec3::new(r * angle.cos(), y, r * angle.sin())
}

/// Leaves as a folded diamond.
fn spray(place: Vec3, normal: Vec3, size: f32) -> Shape {
    let (u, v) = normal.any_orthonormal_pair();
    let v = if u.cross(v).dot(normal) < 0.0 { -v } else { v };
    let droop = -0.35 * size * normal;
    let corners =
        [place + u * size + droop, place + 0.7 * v * size, place - u * size + droop, place - 0.7 * v * size];
    let mut shape = Shape::default();
    for triangle in [[0, 1, 3], [1, 2, 3]] {
        let [a, b, c] = triangle.map(|i: usize| corners[i]);
        let face = (b - a).cross(c - a).normalize();
        let at = [a, b, c].map(|p| shape.vertex(p, (face + normal).normalize(), Vec2::ZERO));
        shape.triangle(at);
    }
    shape
}

/// 1.8 m long along x, its seat to +z.
pub fn bench() -> Part {
    let block = |min: [f32; 3], max: [f32; 3]| cuboid(min.into(), max.into());
    let mut part = Part::default();
    for z in [-0.2, -0.04, 0.12] {
        part.add(Finish::Wood, &block([-0.9, 0.42, z], [0.9, 0.46, z + 0.13]));
    }
    for y in [0.6, 0.76] {
        part.add(Finish::Wood, &block([-0.9, y, -0.3], [0.9, y + 0.11, -0.26]));
    }
    for x in [-0.75, 0.7] {
        part.add(Finish::Iron, &block([x, 0.0, -0.3], [x + 0.05, 0.9, -0.25]));
        part.add(Finish::Iron, &block([x, 0.0, 0.18], [x + 0.05, 0.42, 0.23]));
    }
    part
}

/// Benches along the paths of parks: foot and turn.
pub fn benches(plan: &Plan) -> Vec<(Vec2, f32)> {
    let mut benches = Vec::new();
    for block in plan.blocks.iter().filter(|block| block.usage == Usage::Park) {
        let (center, half) = (block.plot.center(), 0.5 * block.plot.size());
        for k in 0..6 {
            let along = (k as f32 - 2.5) / 3.2;
            benches.push((center + Vec2::new(along * half.x, -2.2), 0.0));
            benches.push((center + Vec2::new(2.2, along * half.y), -0.25 * TAU));
        }
    }
    benches
}

/// A piece of hedge, 3 m along x.
pub fn hedge() -> Part {
    Part::of(Finish::Hedge, bevelled_cuboid(Vec3::new(-1.5, 0.0, -0.35), Vec3::new(1.5, 1.05, 0.35), 0.12))
}

/// Hedges around parks, with gaps at the paths: foot and turn.
pub fn hedges(plan: &Plan) -> Vec<(Vec2, f32)> {
    let mut hedges = Vec::new();
    for block in plan.blocks.iter().filter(|block| block.usage == Usage::Park) {
        let rect = block.plot.inset(0.6);
        for side in SIDES {
            let [left, right] = rect.edge(side);
            let count = (left.distance(right) / 3.2) as usize;
            for k in 0..count {
                let share = (k as f32 + 0.5) / count as f32;
                if (share - 0.5).abs() * left.distance(right) > 3.5 {
                    hedges.push((left.lerp(right, share), side.turn()));
                }
            }
        }
    }
    hedges
}
