//! The columns of both storeys.

use super::materials::{Finish, Part};
use super::plan::{BAY, BAYS, GALLERY_FLOOR, HALF_LENGTH, NAVE, RAIL, SPRING, UPPER_SPRING, column_lines};
use crate::scene::procedural::kit::Kit;
use crate::scene::procedural::shapes::{Outline, Shape, lathe, patch, square_turned, tube_section};
use glam::{Affine3A, Quat, Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// Shaft of the ground floor: heights, m.
const SHAFT: [f32; 2] = [0.52, 2.86];
const FLUTES: usize = 16;

pub fn add(kit: &mut Kit) {
    let column = kit.mesh("column", ground_column());
    for x in column_lines() {
        kit.place_both(column, Vec3::new(x, 0.0, NAVE));
    }
    let pier = kit.mesh("pier", pier());
    for x in [-HALF_LENGTH, HALF_LENGTH] {
        kit.place_both(pier, Vec3::new(x, 0.0, NAVE));
    }
    let upper = kit.mesh("gallery-column", upper_column());
    let pedestal = kit.mesh("pedestal", pedestal());
    for i in 0..=2 * BAYS {
        let at = Vec3::new(i as f32 * BAY * 0.5 - HALF_LENGTH, 0.0, NAVE);
        kit.place_both(pedestal, at);
        kit.place_both(upper, at);
    }
}

/// Radius of the ground-floor shaft: entasis, widest at a third.
fn shaft_radius(v: f32) -> f32 {
    0.305 - 0.045 * v * v
}

fn ground_column() -> Part {
    let plinth = Outline::from(0.44, 0.0).to(0.44, 0.15).to(0.425, 0.165).to(0.0, 0.165).open();
    // Attic base: torus, scotia between fillets, torus.
    let base = Outline::from(0.34, 0.16)
        .arc((0.355, 0.225), 0.062, (-0.5, 0.5), 4)
        .to(0.355, 0.30)
        .arc((0.385, 0.345), 0.042, (1.35, 0.65), 3)
        .to(0.335, 0.39)
        .arc((0.335, 0.435), 0.043, (-0.5, 0.5), 4)
        .to(0.325, 0.485)
        .arc((0.356, 0.52), 0.038, (1.2, 1.0), 2)
        .to(0.28, 0.525)
        .open();
    let stone = square_turned(&plinth).with(lathe(&base, 16)).with(fluted_shaft()).with(capital());
    Part::of(Finish::Limestone, stone)
}

/// Flutes with fillets between them, fading out at both ends.
fn fluted_shaft() -> Shape {
    let mut shape = Shape::default();
    let height = |v: f32| SHAFT[0] + (SHAFT[1] - SHAFT[0]) * v;
    let pitch = TAU / FLUTES as f32;
    for k in 0..FLUTES {
        let start = k as f32 * pitch;
        let point = |v: f32, angle: f32, depth: f32| {
            let r = shaft_radius(v) - depth;
            Vec3::new(r * angle.cos(), height(v), r * angle.sin())
        };
        let flute = patch([3, 3], |p| {
            let v = shaft_station(p.x);
            let end = ((v * (1.0 - v)) / 0.035).clamp(0.0, 1.0).sqrt();
            point(v, start + 0.78 * pitch * p.y, 0.034 * end * (PI * p.y).sin())
        });
        let fillet = patch([3, 1], |p| point(shaft_station(p.x), start + pitch * (0.78 + 0.22 * p.y), 0.0));
        shape.append(&flute);
        shape.append(&fillet);
    }
    shape
}

/// Stations along the shaft, dense where the flutes end.
fn shaft_station(u: f32) -> f32 {
    0.5 - 0.5 * (PI * u).cos()
}

/// A bell with two rows of leaves, corner scrolls and a moulded abacus.
fn capital() -> Shape {
    let bell = Outline::from(0.24, 2.84)
        .arc((0.278, 2.885), 0.026, (-0.5, 0.5), 3)
        .to(0.25, 2.92)
        .to(0.252, 3.05)
        .to(0.272, 3.18)
        .to(0.31, 3.28)
        .to(0.345, 3.335)
        .open();
    let abacus = Outline::from(0.0, 3.32)
        .to(0.355, 3.32)
        .arc((0.355, 3.36), 0.04, (-0.5, 0.0), 4)
        .to(0.405, 3.37)
        .to(0.405, 3.44)
        .to(0.42, 3.45)
        .to(0.42, SPRING)
        .to(0.0, SPRING)
        .open();
    let mut shape = lathe(&bell, 12).with(square_turned(&abacus));
    for k in 0..8 {
        let turn = |offset: f32| Affine3A::from_rotation_y(TAU * (k as f32 + offset) / 8.0);
        shape.append(&leaf(0.21, 0.055).shifted(Vec3::new(0.262, 2.89, 0.0)).moved(turn(0.0)));
        shape.append(&leaf(0.36, 0.085).shifted(Vec3::new(0.255, 2.89, 0.0)).moved(turn(0.5)));
    }
    for k in 0..4 {
        shape.append(&scroll().moved(Affine3A::from_rotation_y(TAU * (k as f32 + 0.5) / 4.0)));
    }
    shape
}

/// An acanthus leaf of `height` whose tip curls out by `curl`, m; it grows up at x = 0 and leans to +x.
fn leaf(height: f32, curl: f32) -> Shape {
    let curve = move |t: f32| {
        let t = t.min(1.0);
        let over = ((t - 0.55) / 0.45).max(0.0);
        let rise = t.min(0.55) / 0.55 * 0.86 + 0.14 * (PI * 0.75 * over).sin() * 1.2;
        Vec2::new(0.012 + 0.25 * curl * t * t + curl * (1.0 - (PI * 0.5 * over).cos()), height * rise)
    };
    let radii = |t: f32| {
        let width = 0.072 * (1.0 - t.powi(4)).max(0.0).sqrt() * (0.72 + 0.28 * (PI * 5.0 * t).cos().abs());
        Vec2::new(0.019 * (1.0 - t.powi(6)).max(0.0).sqrt(), width)
    };
    // Front and back meet in a sharp rim.
    tube_section([4, 2], curve, radii, [0.5, 1.5]).with(tube_section([4, 2], curve, radii, [1.5, 2.5]))
}

/// A scroll under a corner of the abacus: a disc with a raised rim and eye.
fn scroll() -> Shape {
    let side = Outline::from(0.0, -0.035)
        .to(0.05, -0.036)
        .arc((0.05, 0.0), 0.036, (-0.5, 0.5), 3)
        .to(0.0, 0.035)
        .open();
    let upright = Affine3A::from_quat(Quat::from_rotation_x(PI / 2.0));
    lathe(&side, 7).moved(upright).shifted(Vec3::new(0.435, 3.245, 0.0))
}

/// The square pier that ends a colonnade at the end wall.
fn pier() -> Part {
    let outline = Outline::from(0.44, 0.0)
        .to(0.44, 0.30)
        .to(0.40, 0.34)
        .arc((0.40, 0.40), 0.04, (-0.5, 0.5), 4)
        .to(0.36, 0.47)
        .to(0.36, 3.1)
        .to(0.385, 3.12)
        .to(0.385, 3.18)
        .to(0.36, 3.2)
        .to(0.36, 3.28)
        .arc((0.36, 3.36), 0.055, (-0.5, 0.0), 4)
        .to(0.425, 3.38)
        .to(0.425, SPRING)
        .to(0.0, SPRING)
        .open();
    Part::of(Finish::Limestone, square_turned(&outline))
}

/// Carries a gallery column and ends the balustrade.
fn pedestal() -> Part {
    let y = GALLERY_FLOOR;
    let outline = Outline::from(0.19, y)
        .to(0.19, y + 0.12)
        .to(0.165, y + 0.15)
        .to(0.165, RAIL - 0.14)
        .to(0.195, RAIL - 0.10)
        .to(0.195, RAIL)
        .to(0.0, RAIL)
        .open();
    Part::of(Finish::Limestone, square_turned(&outline))
}

fn upper_column() -> Part {
    let (y, top) = (RAIL, UPPER_SPRING);
    let plinth = Outline::from(0.175, y).to(0.175, y + 0.06).to(0.0, y + 0.06).open();
    let turned_part = Outline::from(0.13, y + 0.055)
        .arc((0.145, y + 0.09), 0.03, (-0.5, 0.5), 3)
        .to(0.135, y + 0.135)
        .arc((0.135, y + 0.16), 0.022, (-0.5, 0.5), 3)
        .to(0.118, y + 0.20)
        .to(0.100, top - 0.32)
        .arc((0.104, top - 0.30), 0.018, (-0.5, 0.5), 2)
        .to(0.100, top - 0.27)
        .to(0.13, top - 0.12)
        .to(0.165, top - 0.085)
        .open();
    let abacus = Outline::from(0.0, top - 0.09)
        .to(0.18, top - 0.09)
        .to(0.20, top - 0.06)
        .to(0.20, top)
        .to(0.0, top)
        .open();
    let stone = square_turned(&plinth).with(square_turned(&abacus));
    Part::of(Finish::Limestone, stone).with(Finish::WhiteMarble, lathe(&turned_part, 8))
}
