//! Roofs of houses: flat ones with parapets, gables along the street, mansards with dormers.

use super::dice::Dice;
use super::facade::{Face, Opening, Pane};
use super::houses::{BAY, DEPTH, House, Style};
use super::materials::{Finish, Part};
use crate::scene::procedural::shapes::{cuboid, polygon};
use glam::Vec3;

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Roof {
    Flat,
    Gable(Finish),
    Mansard(Finish),
}

/// The roof of `style` on a house without one.
pub fn add(house: &mut House, style: &Style, width: f32, dice: &mut Dice) {
    let (half, eaves) = (0.5 * width, house.eaves);
    let at = |x: f32, y: f32, z: f32| Vec3::new(x, eaves + y, z);
    let part = &mut house.part;
    let mut chimney = |part: &mut Part, foot: f32, top: f32, z: f32| {
        let x = dice.within(-0.6..0.6) * half;
        let (min, max) =
            (Vec3::new(x - 0.45, eaves + foot, z - 0.3), Vec3::new(x + 0.45, eaves + top, z + 0.3));
        part.add(Finish::RedBrick, &cuboid(min, max));
        eaves + top
    };
    match style.roof {
        Roof::Flat => {
            let deck =
                [at(-half, 0.0, 0.0), at(half, 0.0, 0.0), at(half, 0.0, -DEPTH), at(-half, 0.0, -DEPTH)];
            part.add(Finish::Gravel, &polygon(&deck, Vec3::Y));
            let (t, h) = (0.25, 0.8);
            for [min, max] in [
                [at(-half, 0.0, -t), at(half, h, 0.0)],
                [at(-half, 0.0, -DEPTH), at(half, h, t - DEPTH)],
                [at(-half, 0.0, t - DEPTH), at(t - half, h, -t)],
                [at(half - t, 0.0, t - DEPTH), at(half, h, -t)],
            ] {
                part.add(style.wall, &cuboid(min, max));
            }
            let hut = Vec3::new(dice.within(-0.4..0.4) * half, eaves, dice.within(-8.0..-4.5));
            part.add(
                Finish::Concrete,
                &cuboid(hut - Vec3::new(1.6, 0.0, 1.3), hut + Vec3::new(1.6, 2.4, 1.3)),
            );
            for i in 0..1 + dice.below(3) {
                let foot = Vec3::new(dice.within(-0.8..0.8) * half, eaves, -2.0 - 3.0 * i as f32);
                let size = Vec3::new(0.5, dice.within(0.6..1.1), 0.5);
                part.add(Finish::Steel, &cuboid(foot - Vec3::new(0.5, 0.0, 0.5), foot + size));
            }
            house.top = eaves + 2.4;
        }
        Roof::Gable(finish) => {
            let (rise, over, middle) = (4.2, 0.35, -0.5 * DEPTH);
            let slope = rise / (0.5 * DEPTH);
            let low = -slope * over;
            let front =
                [at(-half, low, over), at(half, low, over), at(half, rise, middle), at(-half, rise, middle)];
            let rear = [
                at(half, low, -DEPTH - over),
                at(-half, low, -DEPTH - over),
                at(-half, rise, middle),
                at(half, rise, middle),
            ];
            let sheet = polygon(&front, Vec3::Y + Vec3::Z).with(polygon(&rear, Vec3::Y - Vec3::Z));
            part.add(finish, &sheet.clone().with(sheet.shifted(Vec3::new(0.0, -0.02, 0.0)).flipped()));
            for (x, out) in [(half, Vec3::X), (-half, Vec3::NEG_X)] {
                let gable = [at(x, 0.0, 0.0), at(x, 0.0, -DEPTH), at(x, rise, middle)];
                part.add(style.wall, &polygon(&gable, out));
            }
            house.top = chimney(part, rise - 2.5, rise + 0.9, middle + 1.6);
        }
        Roof::Mansard(finish) => {
            let (rise, set) = (3.0, 1.2);
            let foot =
                [at(-half, 0.0, 0.0), at(half, 0.0, 0.0), at(half, 0.0, -DEPTH), at(-half, 0.0, -DEPTH)];
            let (f, r) = (-set, set - DEPTH);
            let head = [at(-half, rise, f), at(half, rise, f), at(half, rise, r), at(-half, rise, r)];
            part.add(finish, &polygon(&[foot[0], foot[1], head[1], head[0]], Vec3::Z));
            part.add(finish, &polygon(&[foot[2], foot[3], head[3], head[2]], Vec3::NEG_Z));
            part.add(style.wall, &polygon(&[foot[1], foot[2], head[2], head[1]], Vec3::X));
            part.add(style.wall, &polygon(&[foot[3], foot[0], head[0], head[3]], Vec3::NEG_X));
            part.add(Finish::Gravel, &polygon(&head, Vec3::Y));
            // Dormers.
            for i in 0..house.bays {
                let x = (i as f32 + 0.5) * BAY - half;
                let face = Face::new(at(x - 0.75, 0.0, -0.12), Vec3::X);
                part.add(style.base, &face.block([0.0, 1.5], [0.0, 2.3], [0.0, 1.2]));
                let hole = Opening { u: [0.3, 1.2], v: [0.5, 1.9] };
                part.add(Finish::Glass, &face.quad(hole.u, hole.v, -0.03));
                house.panes.push(Pane::of(face, &hole, -0.03));
            }
            house.top = chimney(part, rise - 0.5, rise + 1.5, -0.5 * DEPTH);
        }
    }
}
