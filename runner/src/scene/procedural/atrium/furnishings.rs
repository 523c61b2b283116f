//! Furnishings of the hall: vases, the fountain, urns, planters.

use super::materials::{Finish, Part};
use super::plan::{HALF_LENGTH, NAVE, WALL, bay_centers, column_lines};
use super::walls::{APSE, NICHE_SILL, is_door};
use crate::scene::procedural::kit::{Kit, turned};
use crate::scene::procedural::shapes::{Outline, Shape, lathe, patch, planar_tube, sphere, square_turned};
use glam::{Affine3A, Quat, Vec2, Vec3, Vec3Swizzles};
use std::f32::consts::{PI, TAU};

/// An upright cylinder that no light may float in. m.
#[derive(Clone, Copy, Debug)]
pub struct Obstacle {
    /// x and z of its axis.
    pub axis: Vec2,
    pub radius: f32,
    /// Its lower and upper end.
    pub heights: [f32; 2],
}

/// Urns and planters stand before every other column.
const BEFORE_COLUMNS: f32 = NAVE - 0.95;

/// Everything that stands on the floor and is higher than a step.
pub fn obstacles() -> Vec<Obstacle> {
    let standing = |p: Vec3, radius, height| Obstacle { axis: p.xz(), radius, heights: [0.0, height] };
    let urns = urn_places().map(|(_, p)| standing(p, 0.42, 1.95));
    let planters = planter_places().map(|p| standing(p, 1.0, 2.0));
    std::iter::once(standing(Vec3::ZERO, 1.35, 2.35)).chain(urns).chain(planters).collect()
}

fn urn_places() -> impl Iterator<Item = (usize, Vec3)> {
    let lines = column_lines().enumerate().filter(|(i, _)| i % 4 == 2);
    lines.flat_map(|(i, x)| [-1.0, 1.0].map(|side| (i, Vec3::new(x, 0.0, side * BEFORE_COLUMNS))))
}

fn planter_places() -> impl Iterator<Item = Vec3> {
    let lines = column_lines().enumerate().filter(|(i, _)| i % 4 == 0);
    lines.flat_map(|(_, x)| [-1.0, 1.0].map(|side| Vec3::new(x, 0.0, side * BEFORE_COLUMNS)))
}

pub fn add(kit: &mut Kit) {
    kit.single("fountain", fountain());
    let pedestal = kit.mesh("urn-pedestal", urn_pedestal());
    let urns = [kit.mesh("brass-urn", urn(Finish::Brass)), kit.mesh("marble-urn", urn(Finish::GreenMarble))];
    for (i, position) in urn_places() {
        kit.place_at(pedestal, position);
        kit.place_at(urns[i / 4 % 2], position + Vec3::Y * 0.95);
    }
    let planter = kit.mesh("planter", planter());
    let agave = kit.mesh("agave", agave());
    for (i, position) in planter_places().enumerate() {
        kit.place_at(planter, position);
        kit.place(agave, turned(position + Vec3::Y * 0.62, 0.37 * i as f32));
    }
    niche_vases(kit);
    let great = kit.mesh("great-urn", great_urn());
    for side in [-1.0, 1.0] {
        kit.place_at(great, Vec3::new(side * (HALF_LENGTH + 0.1), APSE.sill, 0.0));
    }
}

fn niche_vases(kit: &mut Kit) {
    let shapes = [amphora(), ginger_jar(), slim_vase()];
    let finishes = [Finish::Terracotta, Finish::BlueGlaze, Finish::WhiteMarble, Finish::Bronze];
    let place = |kit: &mut Kit, i: usize, position: Vec3| {
        let (shape, finish) = (i % shapes.len(), finishes[i % finishes.len()]);
        let name = format!("vase-{}-{finish:?}", shape + 1);
        let mesh = kit.scene.meshes.iter().position(|mesh| mesh.name == name);
        let mesh = mesh.unwrap_or_else(|| kit.mesh(&name, Part::of(finish, shapes[shape].clone())));
        kit.place_at(mesh, position);
    };
    let mut number = 0;
    for (i, x) in bay_centers().enumerate().filter(|(i, _)| !is_door(*i)) {
        for side in [1.0, -1.0] {
            place(kit, number + i, Vec3::new(-side * x, NICHE_SILL, side * (WALL + 0.12)));
            number += 1;
        }
    }
    let across = 0.5 * (NAVE + WALL);
    for (i, (x, z)) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)].into_iter().enumerate() {
        place(kit, i, Vec3::new(x * (HALF_LENGTH + 0.12), NICHE_SILL, z * across));
    }
}

fn amphora() -> Shape {
    let outline = Outline::from(0.15, 0.0)
        .to(0.15, 0.03)
        .to(0.09, 0.07)
        .to(0.10, 0.11)
        .to(0.20, 0.32)
        .to(0.265, 0.58)
        .to(0.27, 0.72)
        .to(0.22, 0.88)
        .to(0.11, 0.99)
        .to(0.085, 1.06)
        .to(0.085, 1.22)
        .to(0.13, 1.27)
        .to(0.125, 1.29)
        .to(0.06, 1.24)
        .to(0.0, 1.22);
    let body = lathe(&smooth(&outline).open(), 12);
    let handle = planar_tube(
        [8, 5],
        |t| {
            Vec2::new(
                0.08 + 0.30 * (PI * t.clamp(0.0, 1.0)).sin() * (1.0 - 0.35 * t) + 0.11 * t,
                1.22 - 0.42 * t,
            )
        },
        |_| Vec2::new(0.015, 0.024),
    );
    let other = handle.clone().moved(Affine3A::from_rotation_y(PI));
    // Handles to the left and right as seen from the hall.
    body.with(handle).with(other)
}

fn ginger_jar() -> Shape {
    let outline = Outline::from(0.17, 0.0)
        .to(0.18, 0.06)
        .to(0.24, 0.32)
        .to(0.30, 0.56)
        .to(0.30, 0.72)
        .to(0.22, 0.86)
        .to(0.15, 0.90)
        .to(0.15, 0.96)
        .to(0.20, 0.97)
        .to(0.20, 1.02)
        .to(0.12, 1.09)
        .to(0.03, 1.12)
        .arc((0.0, 1.16), 0.04, (-0.25, 0.5), 5);
    lathe(&smooth(&outline).open(), 12)
}

fn slim_vase() -> Shape {
    let outline = Outline::from(0.14, 0.0)
        .to(0.14, 0.04)
        .to(0.06, 0.09)
        .to(0.06, 0.14)
        .to(0.14, 0.36)
        .to(0.19, 0.66)
        .to(0.18, 0.90)
        .to(0.09, 1.16)
        .to(0.07, 1.32)
        .to(0.15, 1.50)
        .to(0.14, 1.51)
        .to(0.05, 1.38)
        .to(0.0, 1.36);
    lathe(&smooth(&outline).open(), 12)
}

/// Chaikin's corner cutting, once: a turned body has no hard edges. The ends stay.
fn smooth(outline: &Outline) -> Outline {
    let points = &outline.0;
    let mut cut = vec![points[0]];
    for pair in points.windows(2) {
        cut.push(pair[0].lerp(pair[1], 0.25));
        cut.push(pair[0].lerp(pair[1], 0.75));
    }
    cut.push(points[points.len() - 1]);
    Outline(cut)
}

/// A basin with a smaller bowl above it and a brass finial; dry.
fn fountain() -> Part {
    let step = Outline::from(1.3, 0.006).to(1.3, 0.14).to(1.27, 0.17).to(0.0, 0.17).open();
    let foot = Outline::from(0.48, 0.17)
        .to(0.48, 0.24)
        .arc((0.44, 0.29), 0.05, (-0.5, 0.5), 6)
        .to(0.34, 0.36)
        .to(0.22, 0.46)
        .to(0.20, 0.58)
        .to(0.27, 0.68)
        .open();
    let bowl = smooth(
        &Outline::from(0.25, 0.66)
            .to(0.55, 0.72)
            .to(0.92, 0.86)
            .to(1.08, 1.02)
            .to(1.14, 1.03)
            .to(1.14, 1.08)
            .to(1.04, 1.08)
            .to(0.86, 0.93)
            .to(0.5, 0.84)
            .to(0.12, 0.83),
    );
    let stem = Outline::from(0.17, 0.82)
        .to(0.17, 0.88)
        .arc((0.12, 0.93), 0.05, (-0.5, 0.5), 5)
        .to(0.09, 1.05)
        .to(0.08, 1.3)
        .to(0.12, 1.42)
        .to(0.10, 1.46)
        .open();
    let upper = smooth(
        &Outline::from(0.08, 1.44)
            .to(0.28, 1.48)
            .to(0.46, 1.60)
            .to(0.52, 1.66)
            .to(0.52, 1.69)
            .to(0.46, 1.68)
            .to(0.26, 1.57)
            .to(0.05, 1.55),
    );
    let finial = Outline::from(0.08, 1.54)
        .to(0.08, 1.60)
        .to(0.04, 1.66)
        .arc((0.0, 1.82), 0.14, (-0.4, 0.4), 8)
        .to(0.03, 1.98)
        .to(0.05, 2.02)
        .to(0.0, 2.22)
        .open();
    Part::of(Finish::BlackMarble, lathe(&step, 40))
        .with(Finish::WhiteMarble, lathe(&foot, 28).with(lathe(&bowl.open(), 44)))
        .with(Finish::RedMarble, lathe(&stem, 20))
        .with(Finish::WhiteMarble, lathe(&upper.open(), 32))
        .with(Finish::Brass, lathe(&finial, 22))
}

fn urn_pedestal() -> Part {
    let outline = Outline::from(0.34, 0.0)
        .to(0.34, 0.12)
        .to(0.30, 0.16)
        .to(0.27, 0.20)
        .to(0.27, 0.80)
        .to(0.30, 0.84)
        .to(0.33, 0.87)
        .to(0.33, 0.95)
        .to(0.0, 0.95)
        .open();
    Part::of(Finish::RedMarble, square_turned(&outline))
}

/// A gadrooned urn with a lid.
fn urn(finish: Finish) -> Part {
    let foot = Outline::from(0.17, 0.0)
        .to(0.17, 0.035)
        .to(0.13, 0.05)
        .to(0.06, 0.09)
        .to(0.06, 0.13)
        .to(0.09, 0.15)
        .open();
    // Lobes on the lower half of the body.
    let body = patch([6, 40], |p| {
        let angle = TAU * if p.y == 1.0 { 0.0 } else { p.y };
        let lobe = 1.0 + 0.045 * (8.0 * angle).sin().abs() * (PI * p.x).sin();
        let r = (0.08 + 0.25 * (PI * 0.5 * p.x).sin()) * lobe;
        Vec3::new(r * angle.cos(), 0.14 + 0.30 * p.x * p.x + 0.03 * p.x, r * angle.sin())
    });
    let upper = Outline::from(0.33, 0.47)
        .arc((0.335, 0.485), 0.018, (-0.5, 0.5), 4)
        .to(0.30, 0.52)
        .to(0.22, 0.58)
        .to(0.21, 0.64)
        .to(0.27, 0.69)
        .to(0.27, 0.72)
        .to(0.17, 0.77)
        .to(0.06, 0.82)
        .to(0.03, 0.85)
        .arc((0.0, 0.90), 0.05, (-0.3, 0.5), 6)
        .open();
    Part::of(finish, lathe(&foot, 20).with(body).with(lathe(&upper, 26)))
}

/// The urn in the great niche, on its own pedestal.
fn great_urn() -> Part {
    let pedestal = Outline::from(0.5, 0.0)
        .to(0.5, 0.14)
        .to(0.44, 0.20)
        .to(0.40, 0.24)
        .to(0.40, 0.72)
        .to(0.44, 0.78)
        .to(0.48, 0.82)
        .to(0.48, 0.90)
        .to(0.0, 0.90)
        .open();
    let urn_at = Affine3A::from_scale_rotation_translation(Vec3::splat(1.75), Quat::IDENTITY, Vec3::Y * 0.9);
    let mut part = Part::of(Finish::BlackMarble, square_turned(&pedestal));
    part.merge(&urn(Finish::Brass), urn_at);
    part
}

fn planter() -> Part {
    let pot = Outline::from(0.26, 0.0)
        .to(0.27, 0.03)
        .to(0.36, 0.50)
        .to(0.41, 0.52)
        .to(0.42, 0.60)
        .arc((0.40, 0.62), 0.025, (0.0, 0.9), 4)
        .to(0.35, 0.58)
        .to(0.34, 0.54)
        .open();
    let soil = Outline::from(0.35, 0.55).to(0.2, 0.57).to(0.0, 0.58).open();
    let mut part = Part::of(Finish::Terracotta, lathe(&pot, 16)).with(Finish::Soil, lathe(&soil, 14));
    for i in 0..8 {
        let angle = TAU * i as f32 / 8.0;
        let boss = sphere(0.035, 6).shifted(Vec3::new(0.325 * angle.cos(), 0.33, 0.325 * angle.sin()));
        part.add(Finish::Terracotta, &boss);
    }
    part
}

/// Arching blades in three whorls.
fn agave() -> Part {
    let mut shape = Shape::default();
    for i in 0..30 {
        // The golden angle spreads the blades; outer ones are longer and lean further.
        let outer = 1.0 - i as f32 / 30.0;
        let length = 0.75 + 0.35 * outer;
        let lean = 0.16 + 0.62 * outer;
        let blade = patch([5, 2], |p| {
            let bend = lean * (0.55 + 0.9 * p.x);
            let along = length * p.x;
            let center = Vec2::new(along * bend.sin(), along * bend.cos().max(-0.2));
            let width = 0.055 * (1.0 - p.x.powi(3)) * (0.6 + 1.4 * p.x * (1.0 - p.x));
            let across = 2.0 * p.y - 1.0;
            let fold = 0.35 * width * across * across;
            Vec3::new(center.x - fold * bend.cos(), center.y + fold * bend.sin(), width * across)
        });
        shape.append(&blade.flipped().moved(Affine3A::from_rotation_y(2.399_963 * i as f32)));
    }
    Part::of(Finish::Leaf, shape)
}
