//! The house with a room to look out of, at the square's south side.

use super::facade::{Face, Opening, Window, alcove, glaze, wall, windows};
use super::houses::{BAY, DEPTH, STOREY};
use super::lots::standing;
use super::materials::{Finish, Part};
use super::plan::{Plan, Side, Usage};
use crate::scene::Bounds;
use crate::scene::procedural::shapes::{Outline, cuboid, lathe, polygon, sphere};
use glam::{Affine3A, Vec2, Vec3};

const BAYS: usize = 4;
pub const WIDTH: f32 = BAYS as f32 * BAY;
const GROUND: f32 = 3.9;
const STOREYS: usize = 5;
pub const EAVES: f32 = GROUND + STOREY * (STOREYS - 1) as f32 + 0.25;
/// The room, in the space of the house; its front is the wall to the street.
pub const ROOM: Bounds =
    Bounds { min: Vec3::new(-3.4, GROUND + 0.1, -5.9), max: Vec3::new(3.4, GROUND + 3.1, -WALL) };
const WALL: f32 = 0.35;
/// Its window, on the wall: from -2.2 to 2.2.
const HOLE: Opening =
    Opening { u: [0.5 * WIDTH - 2.2, 0.5 * WIDTH + 2.2], v: [GROUND + 0.75, GROUND + 2.75] };

/// Where the house stands.
pub struct Place {
    pub block: usize,
    pub side: Side,
    /// The middle of its front.
    pub foot: Vec2,
}

/// In the row that faces the square from the south, near its middle.
pub fn place(plan: &Plan) -> Option<Place> {
    let faces = |plot: &super::plan::Rect| {
        plot.min.y > 58.0 && plot.min.y < 80.0 && plot.min.x < 0.0 && plot.max.x > 0.0
    };
    let block = plan.blocks.iter().position(|block| block.usage == Usage::Houses && faces(&block.plot))?;
    let plot = &plan.blocks[block].plot;
    Some(Place {
        block,
        side: Side::North,
        foot: Vec2::new((-6.0f32).max(plot.min.x + 30.0).min(6.0), plot.min.y),
    })
}

/// From the space of the house to the world.
pub fn transform(plan: &Plan) -> Option<Affine3A> {
    let place = place(plan)?;
    Some(standing(place.foot, place.side, Vec3::ONE))
}

/// Position and target of the room's camera, in the space of the house.
pub const CAMERA: [Vec3; 2] = [Vec3::new(2.6, GROUND + 1.65, -5.3), Vec3::new(-0.7, GROUND + 1.35, 0.0)];

/// Where point lights hang, and how strong they are, cd.
pub const LIGHTS: [(Vec3, f32); 2] =
    [(Vec3::new(-0.6, GROUND + 2.0, -2.9), 75.0), (Vec3::new(-2.85, GROUND + 1.62, -5.2), 28.0)];

/// The house and what is in its room.
pub fn house() -> Part {
    let mut part = Part::default();
    let half = 0.5 * WIDTH;
    let front = Face::new(Vec3::new(-half, 0.0, 0.0), Vec3::X);
    let window = Window { size: Vec2::new(1.25, 1.95), sill: true, cross: true };
    for storey in 0..STOREYS {
        let floor = if storey == 0 { 0.0 } else { GROUND + STOREY * (storey - 1) as f32 };
        let next = if storey + 1 == STOREYS { EAVES } else { GROUND + STOREY * storey as f32 };
        let finish = if storey == 0 { Finish::Stone } else { Finish::Ochre };
        if storey == 1 {
            part.add(finish, &wall(&front, WIDTH, [floor, next], &[HOLE]));
            continue;
        }
        let holes = windows(BAYS, BAY, floor + 0.9, window.size);
        part.add(finish, &wall(&front, WIDTH, [floor, next], &holes));
        for hole in &holes {
            glaze(&mut part, &front, hole, finish, &window);
        }
    }
    let sides = [
        Face::new(Vec3::new(half, 0.0, 0.0), Vec3::NEG_Z),
        Face::new(Vec3::new(half, 0.0, -DEPTH), Vec3::NEG_X),
        Face::new(Vec3::new(-half, 0.0, -DEPTH), Vec3::Z),
    ];
    for (face, width) in sides.iter().zip([DEPTH, WIDTH, DEPTH]) {
        part.add(Finish::Ochre, &wall(face, width, [0.0, EAVES], &[]));
    }
    for (v, out) in [([GROUND - 0.28, GROUND - 0.02], 0.1), ([EAVES - 0.3, EAVES], 0.35)] {
        part.add(Finish::Stone, &front.block([0.0, WIDTH], v, [out, 0.05]));
    }
    let at = |x: f32, z: f32| Vec3::new(x, EAVES, z);
    let deck = [at(-half, 0.0), at(half, 0.0), at(half, -DEPTH), at(-half, -DEPTH)];
    part.add(Finish::Gravel, &polygon(&deck, Vec3::Y));
    part.add(Finish::Ochre, &front.block([0.0, WIDTH], [EAVES, EAVES + 0.8], [0.0, 0.25]));
    inside(&mut part, &front);
    part
}

fn inside(part: &mut Part, front: &Face) {
    let [floor, ceiling, walls] = alcove(ROOM.min, ROOM.max);
    part.add(Finish::Wood, &floor);
    part.add(Finish::White, &ceiling);
    part.add(Finish::Cream, &walls);
    super::facade::pierce(part, front, &HOLE, Finish::White, WALL);
    // The wall around the window, seen from inside: its u runs the other way.
    let inner = Face::new(Vec3::new(0.5 * WIDTH, 0.0, -WALL), Vec3::NEG_X);
    let [l, r] = [0.5 * WIDTH - ROOM.max.x, 0.5 * WIDTH - ROOM.min.x];
    part.add(Finish::Cream, &inner.quad([l, HOLE.u[0]], [ROOM.min.y, ROOM.max.y], 0.0));
    part.add(Finish::Cream, &inner.quad([HOLE.u[1], r], [ROOM.min.y, ROOM.max.y], 0.0));
    part.add(Finish::Cream, &inner.quad(HOLE.u, [ROOM.min.y, HOLE.v[0]], 0.0));
    part.add(Finish::Cream, &inner.quad(HOLE.u, [HOLE.v[1], ROOM.max.y], 0.0));
    // Bars of the window, a sill and curtains beside it.
    for u in [HOLE.u[0] + 1.45, HOLE.u[0] + 2.9] {
        part.add(Finish::Frame, &front.block([u, u + 0.06], HOLE.v, [-0.1, 0.16]));
    }
    let y = ROOM.min.y;
    part.add(Finish::White, &cuboid(Vec3::new(-2.35, y + 0.58, -0.62), Vec3::new(2.35, y + 0.64, -WALL)));
    for x in [-2.95f32, 2.35] {
        for fold in 0..6 {
            let (a, z) = (x + 0.1 * fold as f32, -WALL - 0.12 - 0.05 * (fold % 2) as f32);
            part.add(
                Finish::RedCloth,
                &cuboid(Vec3::new(a, y + 0.05, z), Vec3::new(a + 0.1, y + 2.8, z + 0.04)),
            );
        }
    }
    table(part, Vec3::new(-0.6, y, -2.9));
    shelf(part, Vec3::new(ROOM.min.x, y, -3.6));
    sofa(part, Vec3::new(2.2, y, -2.6));
    // A rug, a picture, the floor lamp.
    part.add(Finish::BlueCloth, &cuboid(Vec3::new(-2.4, y, -4.4), Vec3::new(1.2, y + 0.02, -1.3)));
    let wall = |x: f32, z: [f32; 2], v: [f32; 2]| {
        cuboid(Vec3::new(x, y + v[0], z[0]), Vec3::new(x + 0.04, y + v[1], z[1]))
    };
    part.add(Finish::Board, &wall(ROOM.max.x - 0.04, [-3.4, -2.0], [1.4, 2.3]));
    part.add(Finish::GreenCloth, &wall(ROOM.max.x - 0.06, [-3.3, -2.1], [1.5, 2.2]));
    let lamp = Vec3::new(LIGHTS[1].0.x, y, LIGHTS[1].0.z);
    let pole = Outline::from(0.16, 0.0).to(0.16, 0.03).to(0.015, 0.04).to(0.015, 1.4).open();
    part.add(Finish::Bronze, &lathe(&pole, 8).shifted(lamp));
    part.add(Finish::Canvas, &shade(0.13, 0.24, 0.32).shifted(lamp + Vec3::new(0.0, 1.42, 0.0)));
    part.add(Finish::WhiteBulb, &sphere(0.045, 8).shifted(LIGHTS[1].0 + Vec3::new(0.0, 0.1, 0.0)));
}

/// A lamp shade, open above and below, both sides of it.
fn shade(top: f32, bottom: f32, height: f32) -> crate::scene::procedural::shapes::Shape {
    let sheet = lathe(&Outline::from(bottom, 0.0).to(top, height).open(), 14);
    sheet.clone().with(sheet.flipped())
}

fn table(part: &mut Part, at: Vec3) {
    let top = Outline::from(0.0, 0.70).to(0.75, 0.70).to(0.75, 0.74).to(0.0, 0.74).open();
    part.add(Finish::Wood, &lathe(&top, 24).shifted(at));
    let leg = Outline::from(0.32, 0.02).to(0.30, 0.06).to(0.05, 0.09).to(0.05, 0.70).open();
    part.add(Finish::Wood, &lathe(&leg, 10).shifted(at));
    let cup = Outline::from(0.0, 0.742).to(0.04, 0.742).to(0.05, 0.83).to(0.045, 0.83).to(0.04, 0.75).open();
    for (x, z) in [(-0.4, 0.1), (0.25, -0.35)] {
        part.add(Finish::White, &lathe(&cup, 10).shifted(at + Vec3::new(x, 0.0, z)));
    }
    let bowl = Outline::from(0.05, 0.742).to(0.16, 0.80).to(0.2, 0.86).to(0.185, 0.86).to(0.0, 0.78).open();
    part.add(Finish::BlueCar, &lathe(&bowl, 16).shifted(at + Vec3::new(0.05, 0.0, 0.12)));
    for (i, x) in [-0.05f32, 0.06, 0.0].into_iter().enumerate() {
        let fruit = at + Vec3::new(0.05 + x, 0.86, 0.08 + 0.06 * i as f32);
        part.add(if i == 1 { Finish::RedCar } else { Finish::Ochre }, &sphere(0.045, 10).shifted(fruit));
    }
    for (angle, out) in [(0.4f32, 1.05), (2.3, 1.05), (4.2, 1.1)] {
        chair(part, Affine3A::from_rotation_translation(glam::Quat::from_rotation_y(angle), at), out);
    }
    // The lamp over it hangs from the ceiling.
    let lamp = LIGHTS[0].0;
    part.add(Finish::GreenCloth, &shade(0.07, 0.3, 0.22).shifted(lamp + Vec3::new(0.0, 0.03, 0.0)));
    part.add(Finish::WhiteBulb, &sphere(0.05, 8).shifted(lamp + Vec3::new(0.0, 0.13, 0.0)));
    let cable =
        cuboid(lamp + Vec3::new(-0.006, 0.25, -0.006), Vec3::new(lamp.x + 0.006, ROOM.max.y, lamp.z + 0.006));
    part.add(Finish::Iron, &cable);
}

fn chair(part: &mut Part, place: Affine3A, out: f32) {
    let mut chair = Part::default();
    let mut rod = |min: [f32; 3], max: [f32; 3]| chair.add(Finish::Wood, &cuboid(min.into(), max.into()));
    rod([-0.22, 0.44, out - 0.22], [0.22, 0.48, out + 0.22]);
    rod([-0.2, 0.62, out + 0.19], [0.2, 0.92, out + 0.22]);
    for (x, z) in [(-0.21, -0.21), (0.17, -0.21), (-0.21, 0.18), (0.17, 0.18)] {
        let top = if z > 0.0 { 0.95 } else { 0.44 };
        rod([x, 0.0, out + z], [x + 0.04, top, out + z + 0.04]);
    }
    part.merge(&chair, place);
}

fn shelf(part: &mut Part, at: Vec3) {
    let mut dice = super::dice::Dice::new(30, 0);
    let frame = |min: Vec3, max: Vec3| cuboid(at + min, at + max);
    for side in [0.0, 2.0] {
        part.add(Finish::Wood, &frame(Vec3::new(0.0, 0.0, side), Vec3::new(0.34, 2.3, side + 0.04)));
    }
    let books = [
        Finish::RedCloth,
        Finish::GreenCloth,
        Finish::BlueCloth,
        Finish::Canvas,
        Finish::Ochre,
        Finish::Board,
    ];
    for level in 0..6 {
        let y = 0.06 + 0.44 * level as f32;
        part.add(Finish::Wood, &frame(Vec3::new(0.0, y, 0.04), Vec3::new(0.34, y + 0.03, 2.0)));
        let mut z = 0.08;
        while level < 5 && z < 1.9 {
            let (thick, tall) = (dice.within(0.025..0.06), dice.within(0.22..0.34));
            if dice.chance(0.85) {
                let max = Vec3::new(dice.within(0.2..0.27), y + 0.03 + tall, z + thick);
                part.add(dice.pick(&books), &frame(Vec3::new(0.02, y + 0.03, z), max));
            }
            z += thick + 0.004;
        }
    }
}

fn sofa(part: &mut Part, at: Vec3) {
    let piece = |min: [f32; 3], max: [f32; 3]| {
        crate::scene::procedural::shapes::bevelled_cuboid(at + Vec3::from(min), at + Vec3::from(max), 0.05)
    };
    let cloth = Finish::GreenCloth;
    part.add(cloth, &piece([0.0, 0.1, -1.0], [0.95, 0.45, 1.0]));
    part.add(cloth, &piece([0.75, 0.35, -1.0], [1.1, 0.95, 1.0]));
    part.add(cloth, &piece([0.0, 0.3, -1.15], [1.05, 0.68, -0.95]));
    part.add(cloth, &piece([0.0, 0.3, 0.95], [1.05, 0.68, 1.15]));
    part.add(Finish::Canvas, &piece([0.45, 0.45, -0.85], [0.75, 0.85, -0.4]));
}
