//! The lamps: where they hang, what they look like, and where their flames are.

use super::furnishings::Obstacle;
use super::materials::{Finish, Part};
use super::plan::{
    ARCH, BAY, BAYS, CORNICE, GALLERY_CEILING, HALF_LENGTH, NAVE, SPRING, VAULT_ANGLE, WALL, bay_centers,
    column_lines,
};
use super::vault::point_on_vault;
use crate::scene::procedural::kit::{Kit, turned};
use crate::scene::procedural::shapes::{Outline, Shape, lathe, planar_tube, sphere, tube};
use glam::{Affine3A, Mat3, Quat, Vec2, Vec3, Vec3Swizzles};
use std::f32::consts::{PI, TAU};

/// In the order in which a small number of lights is spent on them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    Chandelier,
    Lantern,
    GalleryLantern,
    Sconce,
    Candles,
    RibLamp,
    CorniceLamp,
}

pub const KINDS: [Kind; 7] = [
    Kind::Chandelier,
    Kind::Lantern,
    Kind::GalleryLantern,
    Kind::Sconce,
    Kind::Candles,
    Kind::RibLamp,
    Kind::CorniceLamp,
];

const CHANDELIER_CANDLES: usize = 12;
const CHANDELIER_RADIUS: f32 = 0.95;
const RIB_LAMPS: usize = 12;
/// Around the foot of a column: x, z and height of a candle, m.
const CANDLES: [[f32; 3]; 4] =
    [[0.0, 0.0, 0.46], [0.12, 0.05, 0.30], [0.03, -0.13, 0.22], [-0.09, 0.10, 0.16]];
const CHANDELIER_HEIGHT: f32 = 6.7;

/// Where lamps of `kind` are fixed, from the middle of the hall outwards.
pub fn mounts(kind: Kind) -> Vec<Affine3A> {
    let mut mounts = match kind {
        Kind::Chandelier => (-2..=2).map(|i| at(i as f32 * 2.0 * BAY, CHANDELIER_HEIGHT, 0.0)).collect(),
        Kind::Lantern => on_both_sides(bay_centers().map(|x| at(x, SPRING + ARCH - 0.5, NAVE))),
        Kind::GalleryLantern => {
            on_both_sides(bay_centers().map(|x| at(x, GALLERY_CEILING - 0.95, 0.5 * (NAVE + WALL))))
        }
        Kind::Sconce => on_both_sides(column_lines().flat_map(|x| {
            [(1.0, -0.29), (3.0, 0.29)].map(|(turns, z)| turned(Vec3::new(x, 2.1, NAVE + z), turns))
        })),
        Kind::Candles => on_both_sides(column_lines().map(|x| at(x + 0.78, 0.0, NAVE - 0.1))),
        Kind::RibLamp => (0..=BAYS).flat_map(rib_mounts).collect(),
        Kind::CorniceLamp => on_both_sides(
            (0..8 * BAYS).map(|i| at((i as f32 + 0.5) * BAY / 8.0 - HALF_LENGTH, CORNICE, NAVE - 0.50)),
        ),
    };
    mounts.sort_by(|a, b| a.translation.x.abs().total_cmp(&b.translation.x.abs()));
    mounts
}

/// The points of light of a lamp, in the frame of its mount: below or beside its body, never inside it.
pub fn flames(kind: Kind) -> Vec<Vec3> {
    match kind {
        Kind::Chandelier => (0..CHANDELIER_CANDLES).map(|i| on_ring(i) + Vec3::Y * 0.36).collect(),
        Kind::Lantern | Kind::GalleryLantern => vec![Vec3::new(0.0, -0.66, 0.0)],
        Kind::Sconce => vec![Vec3::new(0.27, 0.38, 0.0)],
        Kind::Candles => CANDLES.iter().map(|&[x, z, height]| Vec3::new(x, height + 0.09, z)).collect(),
        Kind::RibLamp => vec![Vec3::new(0.0, -0.17, 0.0)],
        Kind::CorniceLamp => vec![Vec3::new(0.0, 0.17, 0.0)],
    }
}

/// The large lamps, as cylinders.
pub fn obstacles() -> Vec<Obstacle> {
    let around = |kind, radius, [low, high]: [f32; 2]| {
        mounts(kind).into_iter().map(move |mount| {
            let p = Vec3::from(mount.translation);
            Obstacle { axis: p.xz(), radius, heights: [p.y + low, p.y + high] }
        })
    };
    around(Kind::Chandelier, 1.1, [-0.5, 0.7]).chain(around(Kind::GalleryLantern, 0.2, [-0.6, 1.0])).collect()
}

pub fn add(kit: &mut Kit) {
    let rod = kit.mesh("rod", Part::of(Finish::Iron, tube(Vec3::ZERO, Vec3::Y, 0.009, 6)));
    for kind in KINDS {
        let mesh = kit.mesh(&format!("{kind:?}"), body(kind));
        for mount in mounts(kind) {
            kit.place(mesh, mount);
            let above = match kind {
                Kind::Chandelier => Some(point_on_vault(0.0, 0.0, 0.0).y - 0.1),
                Kind::Lantern => Some(SPRING + ARCH + 0.05),
                Kind::GalleryLantern => Some(GALLERY_CEILING),
                _ => None,
            };
            if let Some(above) = above {
                let length = above - mount.translation.y;
                kit.place(rod, mount * Affine3A::from_scale(Vec3::new(1.0, length, 1.0)));
            }
        }
    }
}

fn at(x: f32, y: f32, z: f32) -> Affine3A {
    Affine3A::from_translation(Vec3::new(x, y, z))
}

fn on_both_sides(mounts: impl Iterator<Item = Affine3A>) -> Vec<Affine3A> {
    let half_turn = Affine3A::from_quat(super::kit::HALF_TURN);
    mounts.flat_map(|mount| [mount, half_turn * mount]).collect()
}

/// Lamps under rib `i`; +y of their frames is into the vault. The end ribs touch the walls: theirs hang further in.
fn rib_mounts(i: usize) -> impl Iterator<Item = Affine3A> {
    let line = i as f32 * BAY - HALF_LENGTH;
    let x = line.clamp(0.15 - HALF_LENGTH, HALF_LENGTH - 0.15);
    (0..RIB_LAMPS).map(move |k| {
        let angle = PI * VAULT_ANGLE * 0.94 * (2.0 * (k as f32 + 0.5) / RIB_LAMPS as f32 - 1.0);
        let turn = Quat::from_rotation_x(angle);
        Affine3A::from_rotation_translation(turn, point_on_vault(angle, x, -0.115))
    })
}

fn on_ring(i: usize) -> Vec3 {
    let direction = Vec2::from_angle(TAU * (i as f32 + 0.5) / CHANDELIER_CANDLES as f32) * CHANDELIER_RADIUS;
    Vec3::new(direction.x, 0.0, direction.y)
}

fn body(kind: Kind) -> Part {
    match kind {
        Kind::Chandelier => chandelier(),
        Kind::Lantern | Kind::GalleryLantern => lantern(),
        Kind::Sconce => sconce(),
        Kind::Candles => candles(),
        Kind::RibLamp => Part::of(Finish::Brass, pendant()),
        Kind::CorniceLamp => small_lamp(),
    }
}

/// A candle from height 0, of `radius`.
fn candle(radius: f32, height: f32, segments: usize) -> Shape {
    let outline = Outline::from(radius, 0.0).to(radius, height).to(0.0, height + radius * 0.1);
    lathe(&outline.open(), segments)
}

/// A ring with candles on arms around a turned stem.
fn chandelier() -> Part {
    let stem = Outline::from(0.0, -0.42)
        .arc((0.0, -0.36), 0.055, (-0.45, 0.3), 3)
        .to(0.03, -0.27)
        .arc((0.02, -0.10), 0.13, (-0.4, 0.4), 3)
        .to(0.04, 0.06)
        .to(0.055, 0.08)
        .to(0.03, 0.12)
        .to(0.022, 0.5)
        .arc((0.015, 0.55), 0.04, (-0.4, 0.4), 3)
        .to(0.0, 0.6)
        .open();
    let hoop = Outline::from(0.975, -0.035).to(0.975, 0.035).to(0.925, 0.035).to(0.925, -0.035).closed();
    let cup = Outline::from(0.0, 0.03).to(0.02, 0.03).to(0.055, 0.075).to(0.06, 0.10).to(0.018, 0.08).open();
    let mut brass = lathe(&stem, 10).with(lathe(&hoop, 24));
    let mut wax = Shape::default();
    for i in 0..CHANDELIER_CANDLES {
        brass.append(&lathe(&cup, 5).shifted(on_ring(i)));
        wax.append(&candle(0.022, 0.14, 6).shifted(on_ring(i) + Vec3::Y * 0.075));
    }
    for i in 0..6 {
        let arm = planar_tube(
            [5, 4],
            |t| Vec2::new(0.03 + 0.91 * t, 0.10 - 0.26 * (PI * t).sin() - 0.1 * t),
            |_| Vec2::splat(0.014),
        );
        brass.append(&arm.moved(Affine3A::from_rotation_y(TAU * i as f32 / 6.0)));
    }
    Part::of(Finish::Brass, brass).with(Finish::Wax, wax)
}

/// A six-sided lantern that hangs below its mount; the glass is left out, so that only its frame casts shadows.
fn lantern() -> Part {
    let roof = Outline::from(0.14, -0.16)
        .to(0.15, -0.15)
        .to(0.11, -0.09)
        .to(0.05, -0.05)
        .to(0.03, -0.01)
        .to(0.0, 0.01)
        .open();
    let under = Outline::from(0.0, -0.155).to(0.14, -0.16).open();
    let foot =
        Outline::from(0.0, -0.54).to(0.018, -0.53).to(0.06, -0.47).to(0.115, -0.44).to(0.0, -0.44).open();
    let mut brass = lathe(&roof, 6).with(lathe(&under, 6)).with(lathe(&foot, 6));
    for i in 0..6 {
        let d = Vec2::from_angle(TAU * i as f32 / 6.0);
        let post = |r: f32, y: f32| Vec3::new(r * d.x, y, r * d.y);
        brass.append(&tube(post(0.096, -0.444), post(0.135, -0.155), 0.007, 4));
    }
    Part::of(Finish::Brass, brass).with(Finish::Wax, candle(0.03, 0.12, 6).shifted(Vec3::Y * -0.44))
}

/// An arm that leaves the column along +x, with a cup and a candle.
fn sconce() -> Part {
    let plate = Outline::from(0.07, -0.02).to(0.07, 0.012).to(0.05, 0.022).to(0.0, 0.03).open();
    let facing = Affine3A::from_mat3(Mat3::from_cols(Vec3::NEG_Y, Vec3::X, Vec3::Z));
    let arm = planar_tube(
        [5, 4],
        |t| Vec2::new(0.27 * (PI * 0.5 * t).sin(), 0.1 * t * t - 0.14 * (PI * t).sin()),
        |_| Vec2::splat(0.012),
    );
    let cup = Outline::from(0.0, 0.08)
        .to(0.02, 0.08)
        .to(0.02, 0.10)
        .to(0.065, 0.125)
        .to(0.07, 0.15)
        .to(0.02, 0.13)
        .open();
    let out = Vec3::X * 0.27;
    let brass = lathe(&plate, 6).moved(facing).with(arm).with(lathe(&cup, 6).shifted(out));
    Part::of(Finish::Brass, brass).with(Finish::Wax, candle(0.025, 0.15, 6).shifted(out + Vec3::Y * 0.125))
}

fn candles() -> Part {
    let dish = Outline::from(0.055, 0.0).to(0.06, 0.012).to(0.045, 0.008).to(0.0, 0.008).open();
    let mut part = Part::default();
    for [x, z, height] in CANDLES {
        let foot = Vec3::new(x, 0.0, z);
        part.add(Finish::Bronze, &lathe(&dish, 6).shifted(foot));
        part.add(Finish::Wax, &candle(0.036, height - 0.01, 6).shifted(foot + Vec3::Y * 0.008));
    }
    part
}

/// A small brass bell under a rib.
fn pendant() -> Shape {
    let bell = Outline::from(0.0, -0.075).to(0.034, -0.06).to(0.022, -0.02).to(0.006, 0.02);
    lathe(&bell.open(), 5)
}

/// A glass on the cornice.
fn small_lamp() -> Part {
    let foot = Outline::from(0.034, 0.0).to(0.012, 0.03).open();
    Part::of(Finish::Brass, lathe(&foot, 6))
        .with(Finish::WhiteGlaze, sphere(0.03, 6).shifted(Vec3::Y * 0.052))
}
