//! Houses in rows: a few dozen designs, each with its street front at z = 0, facing +z, its foot at y = 0, its middle at x = 0.

use super::dice::Dice;
use super::facade::{Face, Opening, Pane, Window, alcove, door, glaze, pierce, wall, windows};
use super::materials::{Finish, Part};
use super::roofs::{self, Roof};
use crate::scene::Bounds;
use crate::scene::procedural::shapes::{cuboid, polygon};
use glam::{Vec2, Vec3};

/// Width of a bay, m.
pub const BAY: f32 = 3.0;
/// Depth of every design, m.
pub const DEPTH: f32 = 12.0;
pub const STOREY: f32 = 3.3;
/// Thickness of walls with open holes.
const WALL: f32 = 0.3;

/// What a house is like.
#[derive(Clone, Copy, Debug)]
pub struct Style {
    pub wall: Finish,
    /// Ground floor and cornice.
    pub base: Finish,
    pub roof: Roof,
    window: Window,
    /// French doors with a railing before some windows.
    balconies: bool,
}

/// A house as a mesh, and what the rest of the town has to know of it.
pub struct House {
    pub part: Part,
    /// Windows of the front, then of the sides and the back.
    pub panes: Vec<Pane>,
    /// Light in the shop, if there is one.
    pub shop: Option<Part>,
    pub bays: usize,
    pub storeys: usize,
    /// It ends a row: its right side has windows too.
    pub corner: bool,
    /// Where the walls end and the roof begins.
    pub eaves: f32,
    /// Its highest point.
    pub top: f32,
    /// Rooms that are open to the street.
    pub hollows: Vec<Bounds>,
}

const STYLES: [Style; 9] = {
    let tall = Window { size: Vec2::new(1.25, 1.95), sill: true, cross: true };
    let plain = Window { size: Vec2::new(1.5, 1.5), sill: true, cross: false };
    let wide = Window { size: Vec2::new(2.2, 1.6), sill: false, cross: false };
    let slate = Roof::Mansard(Finish::Slate);
    let tiles = Roof::Gable(Finish::Tiles);
    [
        Style { wall: Finish::Cream, base: Finish::Stone, roof: slate, window: tall, balconies: true },
        Style {
            wall: Finish::RedBrick,
            base: Finish::Stone,
            roof: Roof::Flat,
            window: tall,
            balconies: false,
        },
        Style { wall: Finish::Ochre, base: Finish::Stone, roof: tiles, window: tall, balconies: false },
        Style {
            wall: Finish::White,
            base: Finish::Concrete,
            roof: Roof::Flat,
            window: plain,
            balconies: true,
        },
        Style { wall: Finish::Rose, base: Finish::Stone, roof: tiles, window: plain, balconies: false },
        Style {
            wall: Finish::DarkBrick,
            base: Finish::Concrete,
            roof: Roof::Flat,
            window: wide,
            balconies: false,
        },
        Style {
            wall: Finish::Concrete,
            base: Finish::Concrete,
            roof: Roof::Flat,
            window: wide,
            balconies: true,
        },
        Style { wall: Finish::Grey, base: Finish::Stone, roof: slate, window: tall, balconies: true },
        Style { wall: Finish::Cream, base: Finish::RedBrick, roof: tiles, window: plain, balconies: false },
    ]
};

/// Storeys of the designs of each style.
const STOREYS: [[usize; 3]; 9] =
    [[4, 5, 6], [4, 5, 6], [2, 3, 4], [5, 6, 7], [2, 3, 4], [4, 5, 6], [5, 7, 8], [4, 5, 5], [2, 2, 3]];

/// All designs: of every style three for rows and two for corners.
pub fn designs() -> Vec<House> {
    let mut designs = Vec::new();
    for (style, storeys) in STYLES.iter().zip(STOREYS) {
        for (i, storeys) in storeys.into_iter().enumerate() {
            let bays = 3 + (designs.len() + i) % 3;
            designs.push(house(style, storeys, bays, false, designs.len()));
            if i > 0 {
                designs.push(house(style, storeys, 4 + i % 2, true, designs.len()));
            }
        }
    }
    designs
}

fn house(style: &Style, storeys: usize, bays: usize, corner: bool, number: usize) -> House {
    let mut dice = Dice::new(10, number);
    let width = bays as f32 * BAY;
    let shop = storeys > 2 && dice.chance(0.62);
    let ground = if shop { 4.2 } else { 3.7 };
    let eaves = ground + STOREY * (storeys - 1) as f32 + 0.25;
    let mut house = House {
        part: Part::default(),
        panes: Vec::new(),
        shop: None,
        bays,
        storeys,
        corner,
        eaves,
        top: eaves,
        hollows: Vec::new(),
    };
    let half = 0.5 * width;
    let front = Face::new(Vec3::new(-half, 0.0, 0.0), Vec3::X);
    ground_floor(&mut house, style, &front, ground, shop, &mut dice);
    let right = Face::new(Vec3::new(half, 0.0, 0.0), Vec3::NEG_Z);
    let left = Face::new(Vec3::new(-half, 0.0, -DEPTH), Vec3::Z);
    let back = Face::new(Vec3::new(half, 0.0, -DEPTH), Vec3::NEG_X);
    storey_walls(&mut house, style, &front, bays, [1, storeys], ground, true);
    if corner {
        storey_walls(&mut house, style, &right, 4, [0, storeys], ground, true);
    } else {
        house.part.add(style.wall, &wall(&right, DEPTH, [0.0, eaves], &[]));
    }
    house.part.add(style.wall, &wall(&left, DEPTH, [0.0, eaves], &[]));
    storey_walls(&mut house, style, &back, bays, [0, storeys], ground, false);
    cornice(&mut house, style, &front, width, ground, corner);
    roofs::add(&mut house, style, width, &mut dice);
    house
}

fn ground_floor(house: &mut House, style: &Style, front: &Face, ground: f32, shop: bool, dice: &mut Dice) {
    let bays = house.bays;
    let entry = dice.below(2) * (bays - 1);
    let hole = |i: usize| {
        let middle = (i as f32 + 0.5) * BAY;
        let across = |w: f32| [middle - 0.5 * w, middle + 0.5 * w];
        match (i == entry, shop) {
            (true, _) => Opening { u: across(1.3), v: [0.04, 2.95] },
            (false, true) => Opening { u: across(2.5), v: [0.45, 3.2] },
            (false, false) => {
                let w = style.window.size.x.min(1.6);
                Opening { u: across(w), v: [1.0, 2.75] }
            }
        }
    };
    let holes: Vec<Opening> = (0..bays).map(hole).collect();
    house.part.add(style.base, &wall(front, bays as f32 * BAY, [0.0, ground], &holes));
    for (i, hole) in holes.iter().enumerate() {
        let pane = match (i == entry, shop) {
            (true, _) => door(&mut house.part, front, hole, style.base),
            (false, true) => {
                pierce(&mut house.part, front, hole, style.base, WALL);
                continue;
            }
            (false, false) => glaze(&mut house.part, front, hole, style.base, &style.window),
        };
        house.panes.push(pane);
    }
    if shop {
        let first = if entry == 0 { 1.0 } else { 0.0 };
        let at = |bay: f32| (bay - 0.5 * bays as f32) * BAY;
        let inside = [at(first) + 0.12, at(first + bays as f32 - 1.0) - 0.12];
        furnish(house, inside, dice);
    }
}

/// A lit shop behind the front, between two x.
fn furnish(house: &mut House, [l, r]: [f32; 2], dice: &mut Dice) {
    let (min, max) = (Vec3::new(l, 0.2, -3.2), Vec3::new(r, 3.5, -WALL));
    let [floor, ceiling, walls] = alcove(min, max);
    let paint = dice.pick(&[Finish::White, Finish::Cream, Finish::Rose, Finish::Wood]);
    let part = &mut house.part;
    part.add(Finish::Wood, &floor);
    part.add(Finish::White, &ceiling);
    part.add(paint, &walls);
    // Shelves with goods at the back, a counter or a display at the window.
    let goods = [
        Finish::RedCloth,
        Finish::GreenCloth,
        Finish::BlueCloth,
        Finish::Canvas,
        Finish::Bronze,
        Finish::White,
    ];
    for level in [0.8, 1.4, 2.0] {
        part.add(
            Finish::Wood,
            &cuboid(Vec3::new(l + 0.1, level, -3.18), Vec3::new(r - 0.1, level + 0.04, -2.8)),
        );
        let mut x = l + 0.2;
        while x < r - 0.6 {
            let size = Vec3::new(dice.within(0.18..0.5), dice.within(0.15..0.42), 0.25);
            if dice.chance(0.8) {
                let foot = Vec3::new(x, level + 0.04, -3.1);
                part.add(dice.pick(&goods), &cuboid(foot, foot + size));
            }
            x += size.x + 0.12;
        }
    }
    let middle = 0.5 * (l + r) + dice.within(-0.6..0.6);
    part.add(Finish::Wood, &cuboid(Vec3::new(middle - 0.9, 0.2, -1.7), Vec3::new(middle + 0.9, 1.15, -1.1)));
    let foot = Vec3::new(middle - 0.4, 1.15, -1.5);
    part.add(dice.pick(&goods), &cuboid(foot, foot + Vec3::new(0.35, 0.3, 0.3)));
    let mut panels = Part::default();
    let count = ((r - l) / BAY).round().max(1.0) as usize;
    for i in 0..count {
        let x = l + (r - l) * (i as f32 + 0.5) / count as f32;
        let at = |dx: f32, dz: f32| Vec3::new(x + dx, 3.46, -1.3 + dz);
        let corners = [at(-0.6, -0.15), at(-0.6, 0.15), at(0.6, 0.15), at(0.6, -0.15)];
        panels.add(Finish::ShopPanel, &polygon(&corners, Vec3::NEG_Y));
    }
    house.shop = Some(panels);
    house.hollows.push(Bounds { min, max });
    if dice.chance(0.6) {
        awning(&mut house.part, [l, r], dice);
    }
}

fn awning(part: &mut Part, [l, r]: [f32; 2], dice: &mut Dice) {
    let cloth = dice.pick(&[Finish::RedCloth, Finish::GreenCloth, Finish::BlueCloth]);
    let stripes = ((r - l) / 0.5).round() as usize;
    for i in 0..stripes {
        let x = |k: usize| l + (r - l) * k as f32 / stripes as f32;
        let (a, b) = (x(i), x(i + 1));
        let slope = [
            Vec3::new(a, 3.55, 0.02),
            Vec3::new(a, 3.05, 1.25),
            Vec3::new(b, 3.05, 1.25),
            Vec3::new(b, 3.55, 0.02),
        ];
        let hem = [
            Vec3::new(a, 2.85, 1.25),
            Vec3::new(b, 2.85, 1.25),
            Vec3::new(b, 3.05, 1.25),
            Vec3::new(a, 3.05, 1.25),
        ];
        let sheet = polygon(&slope, Vec3::Y).with(polygon(&hem, Vec3::Z));
        let finish = if i % 2 == 0 { cloth } else { Finish::Canvas };
        part.add(finish, &sheet.clone().with(sheet.flipped()));
    }
}

/// Walls of the storeys `from..to` with their windows; storey 0 is the ground floor.
fn storey_walls(
    house: &mut House,
    style: &Style,
    face: &Face,
    bays: usize,
    [from, to]: [usize; 2],
    ground: f32,
    rich: bool,
) {
    let width = bays as f32 * BAY;
    for storey in from..to {
        let floor = if storey == 0 { 0.0 } else { ground + STOREY * (storey - 1) as f32 };
        let next = if storey + 1 == to { house.eaves } else { ground + STOREY * storey as f32 };
        let size = if storey == 0 { Vec2::new(style.window.size.x.min(1.6), 1.7) } else { style.window.size };
        let holes = windows(bays, BAY, floor + 0.9, size);
        let finish = if storey == 0 { style.base } else { style.wall };
        house.part.add(finish, &wall(face, width, [floor, next], &holes));
        let window =
            Window { sill: style.window.sill && rich, cross: style.window.cross && rich, ..style.window };
        for (i, hole) in holes.iter().enumerate() {
            house.panes.push(glaze(&mut house.part, face, hole, finish, &window));
            if style.balconies && rich && storey > 0 && (i + storey) % 3 == 1 {
                balcony(&mut house.part, face, hole, floor);
            }
        }
    }
}

fn balcony(part: &mut Part, face: &Face, hole: &Opening, floor: f32) {
    let [l, r] = [hole.u[0] - 0.4, hole.u[1] + 0.4];
    part.add(Finish::Concrete, &face.block([l, r], [floor - 0.12, floor + 0.02], [0.95, 0.0]));
    for v in [0.5, 1.0] {
        part.add(Finish::Iron, &face.block([l, r], [floor + v, floor + v + 0.05], [0.95, -0.9]));
        for u in [l, r - 0.05] {
            part.add(Finish::Iron, &face.block([u, u + 0.05], [floor + v, floor + v + 0.05], [0.9, 0.0]));
        }
    }
    for u in [l, 0.5 * (l + r), r - 0.05] {
        part.add(Finish::Iron, &face.block([u, u + 0.05], [floor + 0.02, floor + 1.0], [0.949, -0.9]));
    }
}

fn cornice(house: &mut House, style: &Style, front: &Face, width: f32, ground: f32, corner: bool) {
    let mut band = |v: [f32; 2], out: f32| {
        // Round the corner it goes on at the right side.
        let end = if corner { width + out } else { width };
        house.part.add(style.base, &front.block([0.0, end], v, [out, 0.05]));
        if corner {
            let side = Face::new(front.at(width, 0.0, 0.0), Vec3::NEG_Z);
            house.part.add(style.base, &side.block([0.05, DEPTH], v, [out, 0.05]));
        }
    };
    band([ground - 0.28, ground - 0.02], 0.1);
    let eaves = house.eaves;
    band([eaves - 0.38, eaves - 0.16], 0.2);
    band([eaves - 0.16, eaves], 0.38);
}
