//! Fairy lights: on a fir on the square, over streets, in trees and under eaves. They take what lights are left, from the square outward.

use super::dice::Dice;
use super::green::{self, Tree};
use super::houses::House;
use super::lots::Lot;
use super::materials::{Finish, Part};
use super::plan::{KERB, Plan, Rank, Usage};
use crate::scene::procedural::kit::Kit;
use crate::scene::procedural::shapes::{Outline, Shape, cuboid, lathe, polygon};
use crate::scene::{PlacedLight, PointLight};
use glam::{Affine3A, Quat, Vec2, Vec3};
use std::f32::consts::TAU;

/// Bulbs that are seen on a garland, and its lights while there are garlands left to light.
pub const BULBS: usize = 40;
/// Those of the fir, in garlands.
const FIR: usize = 8;
/// All garlands together, cd, where they have [`USUAL`] lights; other counts change it by their fourth root.
const TOTAL: f64 = 7_000.0;
const USUAL: f64 = 7_000.0;
/// Size of a bulb, and how far its light is from its middle, m.
const BULB: f32 = 0.04;
const CLEAR: f32 = 0.09;

/// Something that carries lights.
#[derive(Clone, Debug)]
pub enum Garland {
    /// A row of them on the big fir; the number of the row.
    Fir(usize),
    /// Over a road of this rank, along its own x axis.
    Over(Rank, Affine3A),
    In(Tree),
    /// Under the eaves of a house of so many bays, in the house's space raised to the eaves.
    Under(usize, Affine3A),
}

/// All garlands, those near the square first.
pub fn garlands(plan: &Plan, trees: &[Tree], lots: &[Lot], designs: &[House]) -> Vec<Garland> {
    let mut sites: Vec<(f32, Garland)> = (0..FIR).map(|row| (0.0, Garland::Fir(row))).collect();
    for place in strings(plan) {
        sites.push((place.1.translation.length(), Garland::Over(place.0, place.1)));
    }
    sites.extend(trees.iter().map(|tree| (tree.foot.length() + 5.0, Garland::In(*tree))));
    for lot in lots {
        let house = &designs[lot.design];
        let place = lot.transform * Affine3A::from_translation(Vec3::Y * house.eaves);
        // Where a corner is mirrored the lights are, too.
        sites.push((lot.distance() + 30.0, Garland::Under(house.bays, place)));
    }
    sites.sort_by(|a, b| a.0.total_cmp(&b.0));
    sites.into_iter().map(|(_, garland)| garland).collect()
}

/// Where strings hang: between houses on both sides of a road.
fn strings(plan: &Plan) -> Vec<(Rank, Affine3A)> {
    let houses = |block: Option<usize>| block.is_some_and(|i| plan.blocks[i].usage == Usage::Houses);
    let mut strings = Vec::new();
    for segment in plan.segments.iter().filter(|segment| segment.blocks.iter().all(|&block| houses(block))) {
        let (center, size) = (segment.road.center(), segment.road.size());
        // Houses at the edge are too low for the long ones.
        if segment.rank == Rank::Avenue && center.length() > 300.0 {
            continue;
        }
        let length = if segment.along_x { size.x } else { size.y };
        let count = (length / 14.0) as usize;
        for k in 0..count {
            let along = length * ((k as f32 + 0.5) / count as f32 - 0.5);
            let at = center + if segment.along_x { Vec2::new(along, 0.0) } else { Vec2::new(0.0, along) };
            let turn = if segment.along_x { 0.25 * TAU } else { 0.0 };
            let place = Vec3::new(at.x, KERB, at.y);
            strings.push((
                segment.rank,
                Affine3A::from_rotation_translation(Quat::from_rotation_y(turn), place),
            ));
        }
    }
    strings
}

/// Span, height of the ends and sag of a string.
fn string(rank: Rank) -> [f32; 3] {
    let span = rank.road() + 2.0 * rank.pavement();
    match rank {
        Rank::Lane => [span, 6.3, 0.7],
        Rank::Street => [span, 6.6, 1.0],
        Rank::Avenue => [span, 10.2, 1.6],
    }
}

fn on_string(rank: Rank, t: f32) -> Vec3 {
    let [span, height, sag] = string(rank);
    let s = 2.0 * t - 1.0;
    Vec3::new(0.5 * span * s, height - sag * (1.0 - s * s), 0.0)
}

/// The fir: its place, height and radius at the foot of its crown.
const FIR_FOOT: Vec2 = Vec2::ZERO;
const FIR_HEIGHT: f32 = 15.0;
const FIR_RADIUS: f32 = 4.4;
const FIR_CROWN: f32 = 1.6;

/// `t` in 0..1 from its foot to its tip, `turn` around it, `out` of its surface.
fn on_fir(t: f32, turn: f32, out: f32) -> Vec3 {
    let (sin, cos) = turn.sin_cos();
    let r = FIR_RADIUS * (1.0 - t) + 0.05 + out;
    Vec3::new(r * cos, FIR_CROWN + (FIR_HEIGHT - FIR_CROWN) * t, r * sin)
}

/// Bulb `i` of `n`: (middle, the way off it), in the space of the garland.
fn place(garland: &Garland, i: usize, n: usize) -> (Vec3, Vec3) {
    let t = (i as f32 + 0.5) / n as f32;
    match garland {
        Garland::Fir(row) => {
            let turn = TAU * (t * 1.25 + *row as f32 / FIR as f32);
            let (sin, cos) = turn.sin_cos();
            // More where the cone is wide.
            (on_fir(1.0 - (1.0 - 0.96 * t).sqrt(), turn, 0.12), Vec3::new(cos, 0.0, sin))
        }
        Garland::Over(rank, _) => (on_string(*rank, t) - Vec3::Y * 0.06, Vec3::NEG_Y),
        Garland::In(_) => {
            let y = 0.9 - 1.5 * t;
            let (sin, cos) = (2.399_963_2 * i as f32).sin_cos();
            let r = (1.0 - y * y).max(0.0).sqrt();
            let way = Vec3::new(r * cos, y, r * sin);
            (green::CROWN.1 * way * 1.06 + Vec3::Y * green::CROWN.0, way)
        }
        Garland::Under(bays, _) => {
            let half = 0.5 * *bays as f32 * super::houses::BAY - 0.1;
            (Vec3::new(half * (2.0 * t - 1.0), -0.46, 0.3), Vec3::NEG_Y)
        }
    }
}

fn bulb_finish(garland: &Garland, i: usize) -> Finish {
    const COLORS: [Finish; 4] = [Finish::RedBulb, Finish::Bulb, Finish::GreenBulb, Finish::BlueBulb];
    match garland {
        Garland::Fir(row) if row % 2 == 1 => COLORS[i % 4],
        _ => Finish::Bulb,
    }
}

/// Linear RGB of luminance about 1.
fn color(finish: Finish) -> Vec3 {
    match finish {
        Finish::RedBulb => Vec3::new(3.9, 0.2, 0.1),
        Finish::GreenBulb => Vec3::new(0.15, 1.3, 0.25),
        Finish::BlueBulb => Vec3::new(0.5, 0.9, 3.4),
        _ => Vec3::new(1.34, 0.92, 0.42),
    }
}

impl Garland {
    fn transform(&self) -> Affine3A {
        match self {
            Garland::Fir(_) => Affine3A::from_translation(Vec3::new(FIR_FOOT.x, KERB, FIR_FOOT.y)),
            Garland::Over(_, place) | Garland::Under(_, place) => *place,
            Garland::In(tree) => tree.transform(),
        }
    }

    /// Light `i` of `n`, of so many cd.
    fn light(&self, i: usize, n: usize, intensity: f32) -> PlacedLight {
        let (middle, way) = place(self, i, n);
        let position = self.transform().transform_point3(middle + CLEAR * way);
        let bulb = i * BULBS / n.max(1);
        PointLight { position, intensity: color(bulb_finish(self, bulb)) * intensity, radius: 0.0 }.into()
    }

    /// Of the meshes that garlands share.
    fn mesh(&self) -> usize {
        match self {
            Garland::Fir(row) => *row,
            Garland::In(_) => FIR,
            Garland::Over(rank, _) => FIR + 1 + *rank as usize,
            Garland::Under(bays, _) => FIR + 4 + bays - 3,
        }
    }
}

/// Shares `count` lights out: how many each of the first garlands gets.
pub fn shares(count: usize, garlands: usize) -> Vec<usize> {
    let used = (count / BULBS).clamp(1, garlands);
    (0..used).map(|i| count / used + usize::from(i < count % used)).collect()
}

/// The first garlands with their bulbs and `count` lights; the fir stands there in any case.
pub fn add(kit: &mut Kit, garlands: &[Garland], count: usize) -> Vec<PlacedLight> {
    let fir = kit.mesh("fir", fir());
    kit.place_at(fir, Vec3::new(FIR_FOOT.x, KERB, FIR_FOOT.y));
    if count == 0 {
        return Vec::new();
    }
    let sample = |garland: Garland| bulbs(&garland);
    let mut parts: Vec<Part> = (0..FIR).map(|row| sample(Garland::Fir(row))).collect();
    let tree = Tree { mesh: 0, foot: Vec2::ZERO, turn: 0.0, size: 1.0 };
    parts.push(sample(Garland::In(tree)));
    for rank in [Rank::Lane, Rank::Street, Rank::Avenue] {
        parts.push(sample(Garland::Over(rank, Affine3A::IDENTITY)).with(Finish::Board, wire(rank)));
    }
    parts.extend((3..=5).map(|bays| sample(Garland::Under(bays, Affine3A::IDENTITY))));
    let meshes: Vec<usize> =
        parts.into_iter().enumerate().map(|(i, part)| kit.mesh(&format!("garland-{i}"), part)).collect();
    let shares = shares(count, garlands.len());
    let each = (TOTAL * (count as f64 / USUAL).powf(0.25) / count as f64) as f32;
    let mut lights = Vec::with_capacity(count);
    for (garland, n) in garlands.iter().zip(shares) {
        kit.place(meshes[garland.mesh()], garland.transform());
        lights.extend((0..n).map(|i| garland.light(i, n, each)));
    }
    lights
}

fn bulbs(garland: &Garland) -> Part {
    let mut part = Part::default();
    for i in 0..BULBS {
        part.add(bulb_finish(garland, i), &bulb(place(garland, i, BULBS).0));
    }
    part
}

/// An octahedron.
fn bulb(at: Vec3) -> Shape {
    let mut shape = Shape::default();
    for octant in 0..8 {
        let sign = |bit: usize| if octant >> bit & 1 == 0 { BULB } else { -BULB };
        let corners = [Vec3::X * sign(0), Vec3::Y * sign(1), Vec3::Z * sign(2)];
        shape.append(&polygon(&corners.map(|c| at + c), corners.iter().sum()));
    }
    shape
}

fn wire(rank: Rank) -> Shape {
    let mut shape = Shape::default();
    for k in 0..12 {
        let (a, b) = (on_string(rank, k as f32 / 12.0), on_string(rank, (k + 1) as f32 / 12.0));
        shape.append(&crate::scene::procedural::shapes::tube(a, b, 0.012, 3));
    }
    shape
}

fn fir() -> Part {
    let trunk = Outline::from(0.4, 0.0).to(0.22, FIR_CROWN + 1.0).open();
    let mut part = Part::of(Finish::Bark, lathe(&trunk, 8));
    part.add(Finish::Wood, &cuboid(Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 0.5, 1.0)));
    let mut dice = Dice::new(110, 0);
    let mut needles = Shape::default();
    for i in 0..620 {
        let t = 1.0 - (1.0 - (i as f32 + dice.unit()) / 620.0).sqrt();
        let turn = 2.399_963_2 * i as f32;
        let tip = on_fir(t, turn, dice.within(-0.25..0.02));
        let (sin, cos) = turn.sin_cos();
        let out = Vec3::new(cos, 0.0, sin);
        let side = Vec3::new(-sin, 0.0, cos);
        let size = 0.75 * (1.0 - 0.6 * t);
        let back = tip - out * 1.4 * size + Vec3::Y * 0.55 * size;
        let normal = (out + 0.9 * Vec3::Y).normalize();
        needles.append(&polygon(&[back - side * 0.55 * size, tip, back + side * 0.55 * size], normal));
    }
    part.add(Finish::Leaf, &needles);
    let star = bulb(Vec3::ZERO).moved(Affine3A::from_scale(Vec3::splat(9.0)));
    part.with(Finish::WhiteBulb, star.shifted(Vec3::Y * (FIR_HEIGHT + 0.3)))
}
