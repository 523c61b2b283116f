//! The coffered barrel vault over the nave and its ribs.

use super::materials::{Finish, Part};
use super::plan::{BAY, BAYS, HALF_LENGTH, VAULT_ANGLE, VAULT_CROWN, VAULT_RADIUS, bay_centers};
use crate::scene::procedural::kit::Kit;
use crate::scene::procedural::shapes::{Outline, Shape, lathe, patch, sweep};
use glam::{Affine3A, Mat3, Quat, Vec3};
use std::f32::consts::PI;

/// Half-width of a rib, m.
const RIB: f32 = 0.2;
/// Coffers across the vault and along one bay.
const CELLS: [usize; 2] = [8, 2];

pub fn add(kit: &mut Kit) {
    let bay = kit.mesh("vault-bay", coffers());
    for x in bay_centers() {
        kit.place_at(bay, Vec3::new(x, 0.0, 0.0));
    }
    let rib = kit.mesh("rib", rib());
    for i in 0..=BAYS {
        kit.place_at(rib, Vec3::new(i as f32 * BAY - HALF_LENGTH, 0.0, 0.0));
    }
}

/// A frame on the vault at `angle` from its crown (towards +z), `x` along the nave: x = radius outward, z = along the
/// nave.
fn on_vault(angle: f32, x: f32) -> Affine3A {
    let (sin, cos) = angle.sin_cos();
    let out = Vec3::new(0.0, cos, sin);
    let turn = Mat3::from_cols(out, Vec3::X.cross(out), Vec3::X);
    let center = Vec3::new(x, VAULT_CROWN - VAULT_RADIUS, 0.0);
    Affine3A::from_mat3_translation(turn, center + VAULT_RADIUS * out)
}

/// The point at `rise` (m) behind the vault's surface.
pub fn point_on_vault(angle: f32, x: f32, rise: f32) -> Vec3 {
    on_vault(angle, x).transform_point3(Vec3::new(rise, 0.0, 0.0))
}

/// Two rows of stepped coffers, each with a gilded rosette.
fn coffers() -> Part {
    let mut part = Part::default();
    let rosette = rosette();
    let cell = [2.0 * PI * VAULT_ANGLE / CELLS[0] as f32, (BAY - 2.0 * RIB) / CELLS[1] as f32];
    for i in 0..CELLS[0] {
        for j in 0..CELLS[1] {
            let angle = (i as f32 + 0.5) * cell[0] - PI * VAULT_ANGLE;
            let x = (j as f32 + 0.5) * cell[1] - 0.5 * BAY + RIB;
            add_coffer(&mut part, [angle, x], cell);
            // The rosette's axis, +y, turns to face the hall.
            let inward = Affine3A::from_quat(Quat::from_rotation_x(angle + PI));
            part.add(Finish::Gold, &rosette.clone().moved(inward).shifted(point_on_vault(angle, x, 0.245)));
        }
    }
    part
}

/// Rings of a coffer from its edge inwards: (size, rise) with the size relative to the cell.
const RINGS: [(f32, f32); 6] =
    [(1.0, 0.0), (0.84, 0.0), (0.84, 0.12), (0.68, 0.13), (0.68, 0.24), (0.0, 0.25)];

fn add_coffer(part: &mut Part, [angle, x]: [f32; 2], cell: [f32; 2]) {
    for (ring, pair) in RINGS.windows(2).enumerate() {
        let finish = match ring {
            4 => Finish::BlueCoffer,
            3 => Finish::Gold,
            _ => Finish::WhitePlaster,
        };
        for side in 0..4 {
            // Around the square: the outer and inner point at `along` of this side.
            let point = |depth: f32, along: f32| {
                let size = 0.5 * (pair[0].0 + (pair[1].0 - pair[0].0) * depth);
                let rise = pair[0].1 + (pair[1].1 - pair[0].1) * depth;
                let t = 2.0 * along - 1.0;
                let (a, b) = [(t, 1.0), (1.0, -t), (-t, -1.0), (-1.0, t)][side];
                point_on_vault(angle + size * a * cell[0], x + size * b * cell[1], rise)
            };
            // The sides that run around the vault need more steps than those along it.
            let steps = if side % 2 == 0 { 2 } else { 1 };
            part.add(finish, &patch([1, steps], |p| point(p.x, p.y)).flipped());
        }
    }
}

/// A flower of eight petals around a knob, its axis +y.
fn rosette() -> Shape {
    let petals = patch([1, 16], |p| {
        let turn = 2.0 * PI * if p.y == 1.0 { 0.0 } else { p.y };
        let petal = 0.72 + 0.28 * (4.0 * turn).cos().abs();
        let r = 0.06 + (0.23 * petal - 0.06) * p.x;
        Vec3::new(r * turn.cos(), 0.05 * (1.0 - p.x), -r * turn.sin())
    });
    let knob = Outline::from(0.075, 0.0).arc((0.0, 0.03), 0.07, (0.0, 0.5), 1).open();
    petals.with(lathe(&knob, 5))
}

/// A moulded transverse rib, hanging below the coffers.
fn rib() -> Part {
    // (radius outward, across): left to right as seen along the vault.
    let outline = Outline::from(0.03, RIB)
        .to(-0.03, RIB)
        .arc((-0.045, RIB - 0.03), 0.028, (0.3, 1.0), 2)
        .to(-0.075, RIB - 0.058)
        .to(-0.115, RIB - 0.07)
        .to(-0.115, -RIB + 0.07)
        .to(-0.075, -RIB + 0.058)
        .arc((-0.045, -RIB + 0.03), 0.028, (-1.0, -0.3), 2)
        .to(-0.03, -RIB)
        .to(0.03, -RIB)
        .open();
    let frame = |i: usize| {
        let angle = PI * VAULT_ANGLE * (1.0 - 2.0 * i as f32 / 16.0);
        let (sin, cos) = angle.sin_cos();
        let out = Vec3::new(0.0, cos, sin);
        let turn = Mat3::from_cols(out, Vec3::X, out.cross(Vec3::X));
        Affine3A::from_mat3_translation(
            turn,
            Vec3::new(0.0, VAULT_CROWN - VAULT_RADIUS, 0.0) + VAULT_RADIUS * out,
        )
    };
    let frames: Vec<_> = (0..=16).map(frame).collect();
    Part::of(Finish::Limestone, sweep(&outline, &frames))
}
