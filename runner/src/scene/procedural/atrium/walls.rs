//! The walls behind the aisles and galleries and at both ends, with niches, doors and windows.

use super::materials::{Finish, Part};
use super::plan::{
    AISLE_CEILING, BAY, BAYS, GALLERY_CEILING, GALLERY_FLOOR, HALF_LENGTH, NAVE, VAULT_CROWN, WALL,
    bay_centers,
};
use super::wall::{MOULDING, Opening, arched_wall, niche, panel, reveal, surround};
use crate::scene::procedural::kit::{Kit, turned};
use crate::scene::procedural::shapes::{
    Outline, Profile, Shape, bevelled_cuboid, cuboid, lathe, polygon, sphere, sweep, tube,
};
use glam::{Affine3A, Mat3, Vec3};

/// What fills the arched opening of a wall bay.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Niche,
    Door,
    Window,
}

/// A stretch of wall.
struct Stretch {
    width: f32,
    heights: [f32; 2],
    face: Finish,
    opening: Opening,
    kind: Kind,
}

/// Side niches, where the vases stand: (half-width, sill, springing), m.
const NICHE: Opening = Opening { half_width: 0.62, sill: 0.75, springing: 2.55 };
const DOOR: Opening = Opening { half_width: 0.75, sill: 0.0, springing: 2.5 };
const WINDOW: Opening = Opening { half_width: 0.55, sill: 6.7, springing: 8.1 };
/// The great niche in the middle of an end wall.
pub const APSE: Opening = Opening { half_width: 1.45, sill: 0.42, springing: 2.9 };
pub const APSE_DEPTH: f32 = 0.95;
pub const NICHE_SILL: f32 = NICHE.sill;

/// Whether the ground-floor bay `i` of a long wall has a door (else a niche).
pub fn is_door(i: usize) -> bool {
    i % 3 == 1
}

pub fn add(kit: &mut Kit) {
    let ground = |kind, opening| Stretch {
        width: BAY,
        heights: [0.0, AISLE_CEILING + 0.02],
        face: Finish::Ashlar,
        opening,
        kind,
    };
    let niche = kit.mesh("niche-bay", stretch(&ground(Kind::Niche, NICHE)));
    let door = kit.mesh("door-bay", stretch(&ground(Kind::Door, DOOR)));
    let window = Stretch {
        width: BAY,
        heights: [GALLERY_FLOOR - 0.02, GALLERY_CEILING + 0.02],
        face: Finish::RedPlaster,
        opening: WINDOW,
        kind: Kind::Window,
    };
    let window = kit.mesh("window-bay", stretch(&window));
    for (i, x) in bay_centers().enumerate() {
        let mesh = if is_door(i) { door } else { niche };
        // The wall's front is +z; it stands at +WALL and looks back into the hall.
        for side in [0.0, 2.0] {
            let at = Vec3::new(if side == 0.0 { x } else { -x }, 0.0, if side == 0.0 { -WALL } else { WALL });
            kit.place(mesh, turned(at, side));
            kit.place(window, turned(at, side));
        }
    }
    end_walls(kit);
    kit.both_sides("dado", dado());
}

fn end_walls(kit: &mut Kit) {
    let storey = |width, opening, kind| Stretch {
        width,
        heights: [0.0, AISLE_CEILING + 0.02],
        face: Finish::Ashlar,
        opening,
        kind,
    };
    let upper = |width| Stretch {
        width,
        heights: [GALLERY_FLOOR - 0.02, GALLERY_CEILING + 0.02],
        face: Finish::RedPlaster,
        opening: WINDOW,
        kind: Kind::Window,
    };
    let mut part = Part::default();
    let mut put = |stretch_: &Stretch, x: f32| {
        part.merge(&stretch(stretch_), Affine3A::from_translation(Vec3::new(x, 0.0, 0.0)));
    };
    put(&storey(4.0, APSE, Kind::Niche), 0.0);
    for side in [-1.0, 1.0] {
        put(&storey(2.4, DOOR, Kind::Door), side * 3.2);
        put(&storey(WALL - NAVE, NICHE, Kind::Niche), side * 0.5 * (WALL + NAVE));
        put(&upper(2.4), side * 3.2);
        put(&upper(WALL - NAVE), side * 0.5 * (WALL + NAVE));
    }
    put(&upper(2.0), -1.0);
    put(&upper(2.0), 1.0);
    part.merge(&lunette(), Affine3A::IDENTITY);
    part.add(Finish::Limestone, &string_course());
    let mesh = kit.mesh("end-wall", part);
    kit.place(mesh, turned(Vec3::new(HALF_LENGTH, 0.0, 0.0), 3.0));
    kit.place(mesh, turned(Vec3::new(-HALF_LENGTH, 0.0, 0.0), 1.0));
}

/// A stretch of wall in the plane z = 0, facing +z, with its frame and filling.
fn stretch(s: &Stretch) -> Part {
    let steps = if s.opening.half_width > 1.0 { 24 } else { 10 };
    let wall = arched_wall(&s.opening, s.width, s.heights, steps);
    let mut part = Part::of(s.face, wall).with(Finish::Limestone, surround(&s.opening, &architrave(), steps));
    if s.opening.sill > s.heights[0] {
        let a = s.opening.half_width + 0.2;
        let ledge = cuboid(Vec3::new(-a, -0.1, -0.02), Vec3::new(a, 0.0, 0.16));
        part.add(Finish::Limestone, &ledge.shifted(Vec3::new(0.0, s.opening.sill - 0.004, 0.0)));
    }
    match s.kind {
        Kind::Niche => {
            let depth = if s.opening.half_width > 1.0 { APSE_DEPTH } else { 0.48 };
            part.add(Finish::RedPlaster, &niche(&s.opening, depth));
        }
        Kind::Door => part.merge(&door(&s.opening), Affine3A::IDENTITY),
        Kind::Window => part.merge(&window(&s.opening), Affine3A::IDENTITY),
    }
    part
}

/// The moulded frame of an opening: (away from it, out of the wall).
fn architrave() -> Profile {
    Outline::from(0.17, -0.02)
        .to(0.17, 0.05)
        .arc((0.145, 0.05), 0.025, (0.0, 1.0), 3)
        .to(0.11, 0.03)
        .to(0.03, 0.03)
        .arc((0.015, 0.02), 0.015, (0.5, 1.0), 1)
        .to(0.0, -MOULDING)
        .open()
}

/// Two leaves with raised panels, ring handles, and a wooden tympanum.
fn door(opening: &Opening) -> Part {
    const DEPTH: f32 = 0.22;
    let a = opening.half_width;
    let mut wood = panel(opening, -DEPTH, 10);
    let mut brass = Shape::default();
    for side in [-1.0f32, 1.0] {
        for [low, high] in [[0.12, 0.75], [0.87, 1.6], [1.72, 2.42]] {
            let (inner, outer) = (side * 0.06, side * (a - 0.07));
            let min = Vec3::new(inner.min(outer), low, -DEPTH - 0.02);
            let max = Vec3::new(inner.max(outer), high, -DEPTH + 0.035);
            wood.append(&bevelled_cuboid(min, max, 0.02));
        }
        brass.append(&ring(0.06, 0.009).shifted(Vec3::new(side * 0.03, 1.2, -DEPTH + 0.03)));
        brass.append(&sphere(0.022, 6).shifted(Vec3::new(side * 0.03, 1.27, -DEPTH + 0.02)));
    }
    let transom = Vec3::new(a, 0.05, 0.06);
    let transom = bevelled_cuboid(-transom, transom, 0.02).shifted(Vec3::new(0.0, 2.5, -DEPTH));
    let fan = (1..6).map(|i| std::f32::consts::PI * i as f32 / 6.0).map(|t| {
        let direction = Vec3::new(t.cos(), t.sin(), 0.0);
        let root = Vec3::new(0.0, 2.5, -DEPTH + 0.01);
        tube(root + 0.1 * direction, root + a * direction, 0.018, 6)
    });
    fan.for_each(|bar| wood.append(&bar));
    Part::of(Finish::Walnut, wood.with(transom))
        .with(Finish::DarkLimestone, reveal(opening, DEPTH, 10))
        .with(Finish::Brass, brass)
}

/// A torus in the plane z = 0.
fn ring(radius: f32, thickness: f32) -> Shape {
    let circle: Vec<_> = (0..5)
        .map(|i| glam::Vec2::from_angle(std::f32::consts::TAU * i as f32 / 5.0))
        .map(|d| glam::Vec2::new(radius, 0.0) + thickness * d)
        .collect();
    lathe(&Profile::new(&circle, true), 12).moved(Affine3A::from_rotation_x(std::f32::consts::FRAC_PI_2))
}

/// Dark panes behind a bronze lattice.
fn window(opening: &Opening) -> Part {
    const DEPTH: f32 = 0.16;
    let (a, crown) = (opening.half_width, opening.springing + opening.half_width);
    let mut lattice = Shape::default();
    for i in -2..=2 {
        let x = i as f32 * a / 3.0;
        let top = opening.springing + (a * a - x * x).sqrt();
        lattice.append(&tube(
            Vec3::new(x, opening.sill, -DEPTH + 0.02),
            Vec3::new(x, top, -DEPTH + 0.02),
            0.016,
            4,
        ));
    }
    let mut y = opening.sill + 0.4;
    while y < crown - 0.1 {
        let reach = (a * a - (y - opening.springing).max(0.0).powi(2)).sqrt();
        lattice.append(&tube(
            Vec3::new(-reach, y, -DEPTH + 0.024),
            Vec3::new(reach, y, -DEPTH + 0.024),
            0.016,
            4,
        ));
        y += 0.4;
    }
    Part::of(Finish::DarkGlass, panel(opening, -DEPTH, 10))
        .with(Finish::Bronze, lattice)
        .with(Finish::DarkLimestone, reveal(opening, DEPTH, 10))
}

/// The end wall above the cornice: plain, with a round window under the vault.
fn lunette() -> Part {
    let (low, high) = (GALLERY_CEILING, VAULT_CROWN + 0.1);
    let corners = [(-NAVE, low), (NAVE, low), (NAVE, high), (-NAVE, high)].map(|(x, y)| Vec3::new(x, y, 0.0));
    let rim = Outline::from(0.86, -0.02)
        .to(0.86, 0.08)
        .arc((0.80, 0.09), 0.06, (0.0, 1.0), 4)
        .to(0.70, 0.05)
        .to(0.66, 0.05)
        .to(0.64, 0.01)
        .open();
    let facing = Affine3A::from_translation(Vec3::new(0.0, 10.85, 0.0))
        * Affine3A::from_rotation_x(std::f32::consts::FRAC_PI_2);
    let glass = Outline::from(0.66, 0.012).to(0.0, 0.012).open();
    let mut tracery = ring(0.22, 0.03).shifted(Vec3::new(0.0, 0.0, 0.02));
    for i in 0..8 {
        let d = Vec3::from((glam::Vec2::from_angle(std::f32::consts::TAU * i as f32 / 8.0), 0.0));
        tracery.append(&tube(0.22 * d + 0.02 * Vec3::Z, 0.65 * d + 0.02 * Vec3::Z, 0.022, 6));
    }
    Part::of(Finish::WhitePlaster, polygon(&corners, Vec3::Z))
        .with(Finish::Limestone, lathe(&rim, 32).moved(facing))
        .with(Finish::DarkGlass, lathe(&glass, 32).moved(facing))
        .with(Finish::Bronze, tracery.shifted(Vec3::new(0.0, 10.85, 0.0)))
}

/// Bands that continue both entablatures across an end wall.
fn string_course() -> Shape {
    let lower = Outline::from(-0.01, AISLE_CEILING - 0.02)
        .to(0.06, AISLE_CEILING - 0.02)
        .to(0.06, 5.16)
        .to(0.03, 5.18)
        .to(0.03, 5.36)
        .to(0.16, 5.45)
        .arc((0.16, 5.51), 0.06, (-0.5, 0.0), 4)
        .to(0.26, 5.55)
        .to(0.26, 5.61)
        .to(-0.01, 5.63)
        .open();
    let upper = Outline::from(-0.01, 9.2)
        .to(0.04, 9.2)
        .to(0.04, 9.44)
        .to(0.2, 9.55)
        .to(0.24, 9.8)
        .to(-0.01, 9.8)
        .open();
    let across = |profile: &Profile, half: f32| {
        // Out of the wall, up, along -x.
        let turn = Mat3::from_cols(Vec3::Z, Vec3::Y, Vec3::NEG_X);
        let frames = [half, -half].map(|x| Affine3A::from_mat3_translation(turn, Vec3::new(x, 0.0, 0.0)));
        sweep(profile, &frames)
    };
    across(&lower, NAVE - 0.3).with(across(&upper, NAVE - 0.15))
}

/// A marble skirting along a long wall and a rail above it, interrupted by the doors.
fn dado() -> Part {
    let skirting =
        Outline::from(-0.01, 0.0).to(0.045, 0.0).to(0.045, 0.16).to(0.02, 0.2).to(-0.01, 0.2).open();
    let rail = Outline::from(-0.01, 3.35)
        .to(0.03, 3.35)
        .arc((0.03, 3.4), 0.05, (-0.5, 0.5), 5)
        .to(0.03, 3.46)
        .to(0.10, 3.5)
        .to(0.10, 3.54)
        .to(-0.01, 3.56)
        .open();
    let turn = Mat3::from_cols(Vec3::NEG_Z, Vec3::Y, Vec3::X);
    let run = |profile: &Profile, x: [f32; 2]| {
        sweep(profile, &x.map(|x| Affine3A::from_mat3_translation(turn, Vec3::new(x, 0.0, WALL))))
    };
    // This wall is the turned one: its bays run from +x to -x.
    let mut part = Part::of(Finish::Limestone, run(&rail, [-HALF_LENGTH, HALF_LENGTH]));
    let mut start = -HALF_LENGTH;
    for i in (0..BAYS).rev() {
        let x = -((i as f32 + 0.5) * BAY - HALF_LENGTH);
        if is_door(i) {
            part.add(Finish::BlackMarble, &run(&skirting, [start, x - DOOR.half_width - 0.16]));
            start = x + DOOR.half_width + 0.16;
        }
    }
    part.with(Finish::BlackMarble, run(&skirting, [start, HALF_LENGTH]))
}
