//! The square: a town hall with a clock tower, a fountain, stalls of a market.

use super::facade::{Face, Opening, Pane, Window, glaze, wall, windows};
use super::green;
use super::materials::{Finish, Part};
use super::plan::KERB;
use crate::scene::procedural::kit::Kit;
use crate::scene::procedural::shapes::{Outline, cuboid, lathe, polygon, sphere};
use crate::scene::{PlacedLight, PointLight, SpotLight};
use glam::{Affine3A, Quat, Vec2, Vec3};
use std::f32::consts::TAU;

/// The hall's front, its half-width and its depth.
pub const FRONT: f32 = -27.0;
pub const WING: f32 = 22.0;
pub const DEPTH: f32 = 15.0;
pub const EAVES: f32 = 14.5;
/// The tower: half-width, how far it stands before the front, height of its walls and of its tip.
pub const TOWER: f32 = 4.5;
pub const PORCH: f32 = 1.6;
pub const WALLS: f32 = 33.0;
const TIP: f32 = 47.0;
/// The middle of the fountain.
const FOUNTAIN: Vec2 = Vec2::new(0.0, 24.0);

/// Stalls: foot and turn about +Y.
fn stalls() -> Vec<(Vec2, f32)> {
    let mut stalls = Vec::new();
    for k in 0..6 {
        let z = -14.0 + 8.0 * k as f32;
        stalls.push((Vec2::new(-20.0, z), 0.25 * TAU));
        stalls.push((Vec2::new(20.0, z), -0.25 * TAU));
    }
    stalls
}

/// The hall and all that stands around; returns the panes of the hall.
pub fn add(kit: &mut Kit) -> Vec<Pane> {
    let (hall, panes) = hall();
    kit.mesh("town-hall", hall);
    let mesh = kit.scene.meshes.len() - 1;
    kit.place_at(mesh, Vec3::new(0.0, KERB, 0.0));
    let fountain = kit.mesh("fountain", fountain());
    kit.place_at(fountain, Vec3::new(FOUNTAIN.x, KERB, FOUNTAIN.y));
    let stall_meshes = [Finish::RedCloth, Finish::GreenCloth, Finish::BlueCloth]
        .map(|cloth| kit.mesh("stall", stall(cloth)));
    let place = |at: Vec2, turn: f32| {
        Affine3A::from_rotation_translation(Quat::from_rotation_y(turn), Vec3::new(at.x, KERB, at.y))
    };
    for (i, (at, turn)) in stalls().into_iter().enumerate() {
        kit.place(stall_meshes[i % 3], place(at, turn));
    }
    let bench = kit.mesh("square-bench", green::bench());
    for k in 0..8 {
        let angle = TAU * (k as f32 + 0.5) / 8.0;
        let (sin, cos) = angle.sin_cos();
        kit.place(bench, place(FOUNTAIN + 7.5 * Vec2::new(sin, cos), angle + 0.5 * TAU));
    }
    let spot = kit.mesh(
        "ground-spot",
        Part::of(Finish::Iron, cuboid(Vec3::new(-0.15, 0.0, -0.15), Vec3::new(0.15, 0.25, 0.15))),
    );
    for (position, ..) in ground_spots() {
        kit.place_at(spot, Vec3::new(position.x, KERB, position.z));
    }
    panes
}

/// Trees of the square.
pub fn trees() -> Vec<green::Tree> {
    let mut trees = Vec::new();
    for k in 0..8 {
        for x in [-41.5f32, 41.5] {
            let foot = Vec2::new(x, -20.0 + 8.5 * k as f32);
            trees.push(green::Tree { mesh: k % green::TREES, foot, turn: k as f32 + x, size: 0.95 });
        }
    }
    trees
}

/// Feet of the square's lanterns.
pub fn lanterns() -> impl Iterator<Item = Vec2> {
    (0..10).map(|k| Vec2::new(if k % 2 == 0 { -31.0 } else { 31.0 }, -18.0 + 14.5 * (k / 2) as f32))
}

/// Lights that shine at any count: in stalls, at the hall's front, in the fountain.
pub fn lights() -> Vec<PlacedLight> {
    let mut lights: Vec<PlacedLight> = stalls()
        .into_iter()
        .map(|(at, _)| {
            let position = Vec3::new(at.x, KERB + 2.25, at.y);
            PointLight { position, intensity: Vec3::new(1.35, 0.92, 0.42) * 24.0, radius: 0.0 }.into()
        })
        .collect();
    for (position, target, intensity, outer) in ground_spots() {
        let axis = (target - position).normalize();
        let intensity = Vec3::new(1.25, 0.95, 0.55) * intensity;
        lights.push(
            SpotLight {
                position,
                axis,
                intensity,
                inner_angle: 0.4 * outer,
                outer_angle: outer,
                radius: 0.0,
            }
            .into(),
        );
    }
    for k in 0..4 {
        let way = Vec2::from_angle(TAU * (k as f32 + 0.5) / 4.0);
        let at = FOUNTAIN + 1.9 * way;
        let position = Vec3::new(at.x, KERB + 0.62, at.y);
        let target = Vec3::new(FOUNTAIN.x, KERB + 2.6, FOUNTAIN.y);
        let axis = (target - position).normalize();
        let intensity = Vec3::new(0.75, 1.05, 1.25) * 30.0;
        lights.push(
            SpotLight { position, axis, intensity, inner_angle: 0.3, outer_angle: 0.9, radius: 0.0 }.into(),
        );
    }
    lights
}

/// Place, target, cd, half-angle of the lights that shine up the hall.
fn ground_spots() -> Vec<(Vec3, Vec3, f32, f32)> {
    let mut spots = Vec::new();
    for k in 0..8 {
        let x = -19.25 + 5.5 * k as f32;
        let foot = Vec3::new(x, KERB + 0.35, FRONT + 4.0);
        spots.push((foot, Vec3::new(x, 9.0, FRONT), 120.0, 0.75));
    }
    for x in [-9.0, 9.0f32] {
        let foot = Vec3::new(x, KERB + 0.35, FRONT + 17.0);
        spots.push((foot, Vec3::new(0.0, 27.0, FRONT + PORCH), 2600.0, 0.3));
    }
    spots
}

fn hall() -> (Part, Vec<Pane>) {
    let (mut part, mut panes) = (Part::default(), Vec::new());
    let window = Window { size: Vec2::new(1.5, 2.6), sill: true, cross: true };
    let width = WING - TOWER;
    let bay = width / 5.0;
    for left in [-WING, TOWER] {
        let face = Face::new(Vec3::new(left, 0.0, FRONT), Vec3::X);
        for (storey, floor) in [0.0, 4.8, 9.6].into_iter().enumerate() {
            let next = if storey == 2 { EAVES } else { floor + 4.8 };
            let holes = windows(5, bay, floor + 1.1, window.size);
            part.add(Finish::Stone, &wall(&face, width, [floor, next], &holes));
            panes.extend(holes.iter().map(|hole| glaze(&mut part, &face, hole, Finish::Stone, &window)));
            part.add(Finish::White, &face.block([0.0, width], [next - 0.3, next - 0.05], [0.15, 0.05]));
        }
        for i in 0..=5 {
            let u = (i as f32 * bay).clamp(0.3, width - 0.3);
            part.add(Finish::White, &face.block([u - 0.28, u + 0.28], [0.0, EAVES - 0.35], [0.14, 0.05]));
        }
    }
    let sides = [
        (Face::new(Vec3::new(WING, 0.0, FRONT), Vec3::NEG_Z), DEPTH),
        (Face::new(Vec3::new(WING, 0.0, FRONT - DEPTH), Vec3::NEG_X), 2.0 * WING),
        (Face::new(Vec3::new(-WING, 0.0, FRONT - DEPTH), Vec3::Z), DEPTH),
    ];
    for (face, width) in sides {
        let count = (width / bay) as usize;
        for (storey, floor) in [0.0, 4.8, 9.6].into_iter().enumerate() {
            let next = if storey == 2 { EAVES } else { floor + 4.8 };
            let holes = windows(count, width / count as f32, floor + 1.1, window.size);
            part.add(Finish::Stone, &wall(&face, width, [floor, next], &holes));
            panes.extend(holes.iter().map(|hole| glaze(&mut part, &face, hole, Finish::Stone, &window)));
        }
    }
    hipped(&mut part);
    clock_tower(&mut part);
    (part, panes)
}

/// The roof, with its eaves.
fn hipped(part: &mut Part) {
    let (over, rise) = (0.6, 6.0);
    let (x, front, rear) = (WING + over, FRONT + over, FRONT - DEPTH - over);
    let middle = 0.5 * (front + rear);
    let at = |x: f32, y: f32, z: f32| Vec3::new(x, EAVES + y, z);
    let (a, b, c, d) = (at(-x, 0.0, front), at(x, 0.0, front), at(x, 0.0, rear), at(-x, 0.0, rear));
    let (l, r) = (at(-x + 7.0, rise, middle), at(x - 7.0, rise, middle));
    let slopes = polygon(&[a, b, r, l], Vec3::new(0.0, 1.0, 1.0))
        .with(polygon(&[c, d, l, r], Vec3::new(0.0, 1.0, -1.0)))
        .with(polygon(&[b, c, r], Vec3::new(1.0, 1.0, 0.0)))
        .with(polygon(&[d, a, l], Vec3::new(-1.0, 1.0, 0.0)));
    part.add(Finish::Slate, &slopes);
    part.add(Finish::White, &polygon(&[a, b, c, d], Vec3::NEG_Y));
}

fn clock_tower(part: &mut Part) {
    let front = FRONT + PORCH;
    let middle = Vec3::new(0.0, 0.0, front - TOWER);
    let face = Face::new(Vec3::new(-TOWER, 0.0, front), Vec3::X);
    let gate = Opening { u: [TOWER - 1.5, TOWER + 1.5], v: [0.0, 4.2] };
    part.add(Finish::Stone, &wall(&face, 2.0 * TOWER, [0.0, 6.0], &[gate]));
    super::facade::pierce(part, &face, &gate, Finish::White, 0.5);
    part.add(Finish::Door, &face.quad(gate.u, gate.v, 0.5));
    part.add(Finish::Stone, &face.quad([0.0, 2.0 * TOWER], [6.0, WALLS], 0.0));
    let turned = |quarter: usize| {
        Affine3A::from_translation(middle) * Affine3A::from_rotation_y(0.25 * TAU * quarter as f32)
    };
    for quarter in 0..4 {
        let side = Face::new(Vec3::new(-TOWER, 0.0, TOWER), Vec3::X);
        let mut sheet = Part::default();
        if quarter > 0 {
            sheet.add(Finish::Stone, &side.quad([0.0, 2.0 * TOWER], [0.0, WALLS], 0.0));
        }
        // The clock: a dark ring, hands and marks before a shining dial, which is a mesh of its own.
        let ring = Outline::from(2.05, -0.02).to(2.05, 0.1).to(1.85, 0.1).to(1.85, 0.05).open();
        let upright = Affine3A::from_rotation_translation(
            Quat::from_rotation_x(0.25 * TAU),
            Vec3::new(0.0, DIAL.y, TOWER),
        );
        sheet.add(Finish::Bronze, &lathe(&ring, 24).moved(upright));
        for hour in 0..12 {
            let turn = Affine3A::from_translation(Vec3::new(0.0, DIAL.y, TOWER))
                * Affine3A::from_rotation_z(TAU * hour as f32 / 12.0);
            let mark = cuboid(Vec3::new(-0.06, 1.4, 0.1), Vec3::new(0.06, 1.75, 0.12));
            sheet.add(Finish::Board, &mark.moved(turn));
        }
        for (turn, length) in [(-0.9f32, 1.1), (1.9, 1.6)] {
            let turn =
                Affine3A::from_translation(Vec3::new(0.0, DIAL.y, TOWER)) * Affine3A::from_rotation_z(turn);
            sheet.add(
                Finish::Board,
                &cuboid(Vec3::new(-0.07, -0.25, 0.13), Vec3::new(0.07, length, 0.15)).moved(turn),
            );
        }
        for y in [16.0, 24.5, WALLS - 0.6] {
            sheet.add(Finish::White, &side.block([-0.25, 2.0 * TOWER + 0.25], [y, y + 0.4], [0.25, 0.1]));
        }
        for u in [0.0, 2.0 * TOWER - 0.7] {
            sheet.add(Finish::White, &side.block([u, u + 0.7], [0.0, WALLS - 0.6], [0.12, 0.1]));
        }
        part.merge(&sheet, turned(quarter));
    }
    let at = |x: f32, y: f32, z: f32| middle + Vec3::new(x, y, z);
    let (e, m) = (TOWER + 0.5, 2.0f32);
    let rim = [at(-e, WALLS, e), at(e, WALLS, e), at(e, WALLS, -e), at(-e, WALLS, -e)];
    let neck = [at(-m, 39.0, m), at(m, 39.0, m), at(m, 39.0, -m), at(-m, 39.0, -m)];
    part.add(Finish::White, &polygon(&rim, Vec3::NEG_Y));
    for i in 0..4 {
        let j = (i + 1) % 4;
        let out = rim[i] + rim[j] - 2.0 * middle;
        let out = Vec3::new(out.x, 2.0, out.z);
        part.add(Finish::Copper, &polygon(&[rim[i], rim[j], neck[j], neck[i]], out));
        part.add(Finish::Copper, &polygon(&[neck[i], neck[j], at(0.0, TIP, 0.0)], out));
    }
    part.add(Finish::Bronze, &sphere(0.4, 10).shifted(at(0.0, TIP + 0.2, 0.0)));
}

/// The middle of a dial, seen from the tower's axis.
const DIAL: Vec3 = Vec3::new(0.0, 29.0, TOWER);

/// The four dials; they shine at any count.
pub fn dials() -> Part {
    let middle = Vec3::new(0.0, KERB, FRONT + PORCH - TOWER);
    let corners: Vec<Vec3> =
        (0..12).map(|i| (Vec2::from_angle(TAU * i as f32 / 12.0) * 1.8).extend(0.06) + DIAL).collect();
    let mut part = Part::default();
    for quarter in 0..4 {
        let turn =
            Affine3A::from_translation(middle) * Affine3A::from_rotation_y(0.25 * TAU * quarter as f32);
        part.add(Finish::Dial, &polygon(&corners, Vec3::Z).moved(turn));
    }
    part
}

fn fountain() -> Part {
    let basin = Outline::from(4.2, 0.0).to(4.2, 0.55).to(4.3, 0.62).to(3.85, 0.62).to(3.85, 0.2).open();
    let water = Outline::from(3.86, 0.5).to(1.2, 0.5).open();
    let column = Outline::from(1.3, 0.0)
        .to(1.3, 0.6)
        .to(0.6, 0.8)
        .to(0.45, 1.5)
        .to(1.5, 1.75)
        .to(1.7, 1.95)
        .to(1.55, 1.95)
        .to(0.5, 1.8)
        .to(0.38, 2.2)
        .to(0.5, 2.6)
        .to(0.5, 2.75)
        .to(0.0, 2.75)
        .open();
    let robe = Outline::from(0.42, 2.75)
        .to(0.36, 3.3)
        .to(0.22, 3.9)
        .to(0.3, 4.25)
        .to(0.2, 4.45)
        .to(0.08, 4.5)
        .to(0.08, 4.6)
        .open();
    let arm =
        crate::scene::procedural::shapes::tube(Vec3::new(0.15, 4.3, 0.0), Vec3::new(0.6, 5.0, 0.1), 0.07, 6);
    let figure = lathe(&robe, 12).with(sphere(0.17, 12).shifted(Vec3::new(0.0, 4.72, 0.0))).with(arm);
    Part::of(Finish::Stone, lathe(&basin, 28).with(lathe(&column, 16)))
        .with(Finish::Water, lathe(&water, 28))
        .with(Finish::Bronze, figure)
}

/// A stall that is open to +z.
fn stall(cloth: Finish) -> Part {
    let block = |min: [f32; 3], max: [f32; 3]| cuboid(min.into(), max.into());
    let mut part = Part::of(Finish::Wood, block([-1.6, 0.0, 0.55], [1.6, 0.95, 0.65]));
    part.add(Finish::Wood, &block([-1.7, 0.95, 0.35], [1.7, 1.0, 1.0]));
    part.add(Finish::Wood, &block([-1.6, 0.0, -1.2], [1.6, 2.3, -1.14]));
    for x in [-1.6, 1.54] {
        part.add(Finish::Wood, &block([x, 0.0, -1.14], [x + 0.06, 2.3, 0.55]));
        part.add(Finish::Wood, &block([x, 0.0, 0.9], [x + 0.06, 2.5, 0.96]));
    }
    for i in 0..8 {
        let x = |k: usize| -1.85 + 3.7 * k as f32 / 8.0;
        for (z, drop) in [([-1.45f32, 0.0], [0.0f32, 0.7]), ([0.0, 1.45], [0.7, 0.0])] {
            let at = |x: f32, k: usize| Vec3::new(x, 2.45 + drop[k], z[k]);
            let sheet = polygon(&[at(x(i), 0), at(x(i), 1), at(x(i + 1), 1), at(x(i + 1), 0)], Vec3::Y);
            let finish = if i % 2 == 0 { cloth } else { Finish::Canvas };
            part.add(finish, &sheet.clone().with(sheet.flipped()));
        }
    }
    let mut dice = super::dice::Dice::new(100, cloth as usize);
    let goods = [Finish::RedCloth, Finish::Ochre, Finish::Bronze, Finish::White, Finish::GreenCloth];
    for i in 0..9 {
        let foot = Vec3::new(-1.5 + 0.33 * i as f32, 1.0, 0.45);
        let size = Vec3::new(0.24, dice.within(0.1..0.3), 0.3);
        part.add(dice.pick(&goods), &cuboid(foot, foot + size));
    }
    part.add(Finish::Bulb, &sphere(0.06, 6).shifted(Vec3::new(0.0, 2.38, 0.0)));
    part
}
