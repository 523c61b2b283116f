//! Neon words over shops, and posters that shine at the kerbs of avenues.

use super::dice::Dice;
use super::materials::{Finish, Part};
use super::plan::{KERB, Plan, Rank, SIDES};
use super::textures::POSTERS;
use crate::scene::procedural::shapes::{Shape, cuboid, polygon};
use glam::{Affine3A, Quat, Vec2, Vec3};

type Stroke = [[u8; 2]; 2];

/// Strokes of a letter on a grid of 3 x 5 points.
fn strokes(letter: char) -> &'static [Stroke] {
    match letter {
        'A' => &[[[0, 0], [0, 3]], [[0, 3], [1, 4]], [[1, 4], [2, 3]], [[2, 3], [2, 0]], [[0, 2], [2, 2]]],
        'B' => &[[[0, 0], [0, 4]], [[0, 4], [2, 3]], [[2, 3], [0, 2]], [[0, 2], [2, 1]], [[2, 1], [0, 0]]],
        'C' => &[[[2, 4], [0, 4]], [[0, 4], [0, 0]], [[0, 0], [2, 0]]],
        'D' => &[[[0, 0], [0, 4]], [[0, 4], [2, 3]], [[2, 3], [2, 1]], [[2, 1], [0, 0]]],
        'E' => &[[[0, 0], [0, 4]], [[0, 4], [2, 4]], [[0, 2], [2, 2]], [[0, 0], [2, 0]]],
        'F' => &[[[0, 0], [0, 4]], [[0, 4], [2, 4]], [[0, 2], [2, 2]]],
        'H' => &[[[0, 0], [0, 4]], [[2, 0], [2, 4]], [[0, 2], [2, 2]]],
        'I' => &[[[1, 0], [1, 4]]],
        'K' => &[[[0, 0], [0, 4]], [[0, 2], [2, 4]], [[0, 2], [2, 0]]],
        'L' => &[[[0, 4], [0, 0]], [[0, 0], [2, 0]]],
        'M' => &[[[0, 0], [0, 4]], [[0, 4], [1, 2]], [[1, 2], [2, 4]], [[2, 4], [2, 0]]],
        'N' => &[[[0, 0], [0, 4]], [[0, 4], [2, 0]], [[2, 0], [2, 4]]],
        'O' => &[[[0, 0], [0, 4]], [[0, 4], [2, 4]], [[2, 4], [2, 0]], [[2, 0], [0, 0]]],
        'R' => &[[[0, 0], [0, 4]], [[0, 4], [2, 4]], [[2, 4], [2, 2]], [[2, 2], [0, 2]], [[0, 2], [2, 0]]],
        'S' => &[[[2, 4], [0, 4]], [[0, 4], [0, 2]], [[0, 2], [2, 2]], [[2, 2], [2, 0]], [[2, 0], [0, 0]]],
        'T' => &[[[0, 4], [2, 4]], [[1, 4], [1, 0]]],
        _ => &[],
    }
}

pub const WORDS: [(&str, Finish); 8] = [
    ("HOTEL", Finish::RedNeon),
    ("BAR", Finish::PinkNeon),
    ("CAFE", Finish::WarmNeon),
    ("CINEMA", Finish::BlueNeon),
    ("BOOKS", Finish::GreenNeon),
    ("BREAD", Finish::WarmNeon),
    ("SHOES", Finish::BlueNeon),
    ("TEA", Finish::GreenNeon),
];

/// Grid step and width of a stroke, m.
const UNIT: f32 = 0.125;
const WIDTH: f32 = 0.05;
/// Height of a word's foot over that of the house: between the ground floor's cornice and the windows above.
const FOOT: f32 = 4.36;

/// A board with a word, in the space of a house, before the middle of its front.
pub fn word(text: &str, finish: Finish) -> Part {
    let advance = 3.1 * UNIT;
    let half = 0.5 * (text.chars().count() as f32 * advance - 1.1 * UNIT);
    let board = cuboid(
        Vec3::new(-half - 0.12, FOOT - 0.09, 0.0),
        Vec3::new(half + 0.12, FOOT + 4.0 * UNIT + 0.09, 0.1),
    );
    let mut part = Part::of(Finish::Board, board);
    for (i, letter) in text.chars().enumerate() {
        let left = i as f32 * advance - half;
        for stroke in strokes(letter) {
            let [a, b] =
                stroke.map(|[x, y]| Vec2::new(left + f32::from(x) * UNIT, FOOT + f32::from(y) * UNIT));
            part.add(finish, &tube(a, b));
        }
    }
    part
}

/// A flat stroke, its ends kept off those of others.
fn tube(a: Vec2, b: Vec2) -> Shape {
    let way = (b - a).normalize();
    let (a, b, side) = (a + 0.035 * way, b - 0.035 * way, 0.5 * WIDTH * way.perp());
    let at = |p: Vec2| p.extend(0.14);
    polygon(&[at(a - side), at(b - side), at(b + side), at(a + side)], Vec3::Z)
}

/// A case on a foot, in which posters face +z and -z; their material is that of poster `number`.
pub fn case() -> Part {
    let block = |min: [f32; 3], max: [f32; 3]| cuboid(min.into(), max.into());
    Part::of(Finish::Iron, block([-0.68, 0.35, -0.09], [0.68, 2.35, 0.09]))
        .with(Finish::Iron, block([-0.5, 0.0, -0.06], [0.5, 0.35, 0.06]))
}

/// The two shining faces.
pub fn poster() -> Part {
    let mut part = Part::default();
    for (sign, out) in [(1.0f32, Vec3::Z), (-1.0, Vec3::NEG_Z)] {
        let z = 0.115 * sign;
        let corners =
            [(-0.6, 0.45), (0.6, 0.45), (0.6, 2.25), (-0.6, 2.25)].map(|(x, y)| Vec3::new(x * sign, y, z));
        let mut face = polygon(&corners, out);
        face.uvs = [(0.0, 1.0), (1.0, 1.0), (1.0, 0.0), (0.0, 0.0)].map(Vec2::from).to_vec();
        part.add(Finish::Poster, &face);
    }
    part
}

/// Cases at the kerbs of avenues, near the town's middle first: (poster, place).
pub fn cases(plan: &Plan) -> Vec<(usize, Affine3A)> {
    let mut cases = Vec::new();
    for (i, block) in plan.blocks.iter().enumerate() {
        let mut dice = Dice::new(90, i);
        for side in SIDES.into_iter().filter(|&side| plan.rank(block, side) == Rank::Avenue) {
            let [left, right] = block.curb.edge(side);
            for share in [0.14, 0.86] {
                let foot = left.lerp(right, share) - 2.9 * side.outward();
                // They face along the pavement.
                let turn = Quat::from_rotation_y(side.turn() + std::f32::consts::FRAC_PI_2);
                let place = Affine3A::from_rotation_translation(turn, Vec3::new(foot.x, KERB, foot.y));
                cases.push((dice.below(POSTERS), place));
            }
        }
    }
    cases.sort_by(|a, b| a.1.translation.length().total_cmp(&b.1.translation.length()));
    cases
}
