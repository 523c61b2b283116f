//! Cloth: tied drapes between the columns and long hangings from the galleries.

use super::materials::{Finish, Part};
use super::plan::{BAY, NAVE, bay_centers};
use crate::scene::procedural::kit::{Kit, turned};
use crate::scene::procedural::shapes::{Shape, patch, sphere, tube};
use glam::{Affine3A, Vec3};
use std::f32::consts::{PI, TAU};

/// Height of the rods, m, and how far behind the middle of the columns they are.
const ROD: f32 = 3.28;
const BEHIND: f32 = 0.24;
const CLOTHS: [Finish; 4] = [Finish::RedCloth, Finish::BlueCloth, Finish::OchreCloth, Finish::GreenCloth];

pub fn add(kit: &mut Kit) {
    let drapes = CLOTHS.map(|cloth| kit.mesh(&format!("drape-{cloth:?}"), drapes(cloth)));
    for (i, x) in bay_centers().enumerate() {
        // Every bay but each third has drapes, in other colours on the other side.
        if i % 3 != 2 {
            let at = Vec3::new(x, 0.0, NAVE + BEHIND);
            kit.place(drapes[i % 4], turned(at, 0.0));
            kit.place(drapes[(i + 2) % 4], turned(at * Vec3::new(1.0, 1.0, -1.0), 2.0));
        }
    }
}

/// A pair of drapes on a rod, tied back to the columns at both sides.
fn drapes(cloth: Finish) -> Part {
    let half = 0.5 * BAY - 0.27;
    let left = drape(half, 0.0);
    // The twin has other folds, so that the pair is no mirror image.
    let right = drape(half, 0.37).moved(Affine3A::from_scale(Vec3::new(-1.0, 1.0, 1.0)));
    let rod = tube(Vec3::new(-half, ROD, 0.0), Vec3::new(half, ROD, 0.0), 0.018, 6);
    let mut brass = rod;
    for side in [-1.0, 1.0] {
        brass.append(&sphere(0.035, 6).shifted(Vec3::new(side * half, ROD, 0.0)));
    }
    Part::of(cloth, left.with(right)).with(Finish::Brass, brass)
}

/// Half of a pair: fixed at x = -half, open towards the middle, drawn together at the tie.
fn drape(half: f32, phase: f32) -> Shape {
    const TIE: f32 = 0.60;
    patch([9, 37], |p| {
        let (v, u) = (p.x, p.y);
        // How far the cloth is gathered: 0 at the rod, 1 at the tie, half way back at the floor.
        let gather =
            if v < TIE { (v / TIE).powf(1.7) } else { 1.0 - 0.55 * ((v - TIE) / (1.0 - TIE)).powf(0.8) };
        let smooth = gather * gather * (3.0 - 2.0 * gather);
        let width = 0.98 * half * (1.0 - 0.80 * smooth);
        // Cloth between folds sags towards the tie.
        let swag = 0.16 * (PI * (v / TIE).min(1.0)).sin() * u * u;
        let wave = TAU * (5.5 * u + phase) + 1.3 * (3.0 * v + 5.0 * u + 7.0 * phase).sin() * (0.3 + 0.3 * v);
        let depth = (0.045 + 0.035 * v) * (1.0 - 0.88 * smooth);
        let z = depth * wave.sin() + 0.08 * depth * (2.3 * wave + 4.0 * v).sin();
        Vec3::new(
            -half + 0.03 + width * u + 0.02 * (1.0 - 0.8 * smooth) * wave.cos(),
            ROD - 0.02 - (ROD - 0.07) * v - swag,
            z,
        )
    })
}
