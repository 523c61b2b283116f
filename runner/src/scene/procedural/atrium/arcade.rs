//! The arcades of both storeys and the entablature between them.

use super::materials::{Finish, Part};
use super::plan::{
    AISLE_CEILING, ARCADE, ARCH, BAY, BAYS, CORNICE, GALLERY_CEILING, HALF_LENGTH, NAVE, SPRING, UPPER_ARCH,
    UPPER_SPRING, bay_centers, column_lines,
};
use super::wall::{Opening, arched_wall, opening_frames};
use crate::scene::procedural::kit::Kit;
use crate::scene::procedural::shapes::{Outline, Profile, Shape, cuboid, lathe, polygon, sweep};
use glam::{Affine3A, Mat3, Vec2, Vec3};

const UPPER_CORNICE: f32 = 9.82;

pub fn add(kit: &mut Kit) {
    let bay = kit.mesh("arch", ground_arch());
    let tondo = kit.mesh("tondo", tondo());
    for x in bay_centers() {
        kit.place_both(bay, Vec3::new(x, 0.0, NAVE));
    }
    for x in column_lines() {
        kit.place_both(tondo, Vec3::new(x, 4.52, NAVE - ARCADE));
    }
    let upper = kit.mesh("gallery-arch", upper_arch());
    for i in 0..2 * BAYS {
        kit.place_both(upper, Vec3::new((i as f32 + 0.5) * BAY * 0.5 - HALF_LENGTH, 0.0, NAVE));
    }
    kit.both_sides("entablature", entablature());
    kit.both_sides("upper-entablature", upper_entablature());
}

/// A straight run of `profile` (out from the wall plane into the nave, up) along the whole side.
fn along_side(profile: &Profile) -> Shape {
    let turn = Mat3::from_cols(Vec3::NEG_Z, Vec3::Y, Vec3::X);
    let frame = |x: f32| Affine3A::from_mat3_translation(turn, Vec3::new(x, 0.0, NAVE));
    sweep(profile, &[frame(-HALF_LENGTH), frame(HALF_LENGTH)])
}

fn ground_arch() -> Part {
    let wall = Opening { half_width: ARCH + 0.24, sill: SPRING, springing: SPRING };
    let face = arched_wall(&wall, BAY, [SPRING, AISLE_CEILING + 0.02], 13);
    let both = two_faces(face, ARCADE);
    let arch = Opening { half_width: ARCH, sill: SPRING, springing: SPRING };
    let key = cuboid(Vec3::new(-0.11, 0.0, -0.43), Vec3::new(0.11, 0.42, 0.43)).shifted(Vec3::new(
        0.0,
        SPRING + ARCH - 0.035,
        0.0,
    ));
    Part::of(Finish::WhitePlaster, both)
        .with(Finish::Limestone, sweep(&archivolt(), &opening_frames(&arch, 13)))
        .with(Finish::DarkLimestone, key)
}

/// `face` (towards +z) at both sides of a wall of half-thickness `half`.
fn two_faces(face: Shape, half: f32) -> Shape {
    let back = face.clone().moved(Affine3A::from_rotation_y(std::f32::consts::PI));
    face.shifted(Vec3::new(0.0, 0.0, half)).with(back.shifted(Vec3::new(0.0, 0.0, -half)))
}

/// Moulded face, coffered soffit and the face at the other side: (distance out from the arch, across the wall).
fn archivolt() -> Profile {
    let half = Outline::from(0.265, ARCADE - 0.02)
        .to(0.265, ARCADE + 0.05)
        .to(0.235, ARCADE + 0.055)
        .arc((0.205, ARCADE + 0.045), 0.024, (0.4, 1.1), 2)
        .to(0.175, ARCADE + 0.03)
        .to(0.10, ARCADE + 0.03)
        .to(0.10, ARCADE + 0.018)
        .to(0.03, ARCADE + 0.018)
        .arc((0.018, ARCADE + 0.0), 0.018, (0.5, 1.0), 1)
        .to(0.0, ARCADE - 0.06)
        .to(0.035, ARCADE - 0.075)
        .0;
    let mirrored = half.iter().rev().map(|p| Vec2::new(p.x, -p.y));
    Profile::new(&half.iter().copied().chain(mirrored).collect::<Vec<_>>(), false)
}

/// A glazed roundel above each column, facing the nave.
fn tondo() -> Part {
    let rim = Outline::from(0.235, -0.02)
        .to(0.235, 0.03)
        .arc((0.205, 0.03), 0.03, (0.0, 1.0), 3)
        .to(0.175, 0.012)
        .open();
    let dish = Outline::from(0.175, 0.012).to(0.12, 0.006).to(0.075, 0.008).open();
    let boss = Outline::from(0.075, 0.008)
        .to(0.07, 0.03)
        .to(0.055, 0.036)
        .to(0.045, 0.03)
        .arc((0.0, 0.03), 0.035, (0.0, 0.5), 2)
        .open();
    // The axis of the lathe turns to -z, into the nave.
    let facing = Affine3A::from_rotation_x(-std::f32::consts::FRAC_PI_2);
    Part::of(Finish::WhiteGlaze, lathe(&rim, 12).moved(facing))
        .with(Finish::BlueGlaze, lathe(&dish, 12).moved(facing))
        .with(Finish::Gold, lathe(&boss, 8).moved(facing))
}

/// Architrave, coloured frieze, dentils and cornice towards the nave.
fn entablature() -> Part {
    let face = ARCADE;
    let architrave = Outline::from(face - 0.02, AISLE_CEILING)
        .to(face + 0.03, AISLE_CEILING)
        .to(face + 0.03, 5.05)
        .to(face + 0.05, 5.055)
        .to(face + 0.05, 5.12)
        .arc((face + 0.055, 5.145), 0.025, (-0.5, 0.5), 5)
        .to(face + 0.02, 5.18)
        .open();
    let frieze = Outline::from(face + 0.02, 5.18).to(face + 0.02, 5.36).open();
    let cornice = Outline::from(face + 0.02, 5.36)
        .to(face + 0.05, 5.365)
        .to(face + 0.06, 5.45)
        .to(face + 0.18, 5.46)
        .arc((face + 0.18, 5.51), 0.05, (-0.5, 0.0), 4)
        .to(face + 0.25, 5.525)
        .to(face + 0.25, 5.57)
        .to(face + 0.26, 5.59)
        .to(face + 0.32, 5.60)
        .to(face + 0.34, CORNICE)
        .to(0.14, CORNICE + 0.012)
        .open();
    let mut part = Part::of(Finish::Limestone, along_side(&architrave).with(along_side(&cornice)))
        .with(Finish::GreenMarble, along_side(&frieze));
    part.add(Finish::Limestone, &dentils(NAVE - face - 0.05, 5.385, [0.10, 0.078, 0.09]));
    part
}

/// Small blocks in a row under a cornice; their backs are inside it. `size`: along x, up, out into the nave.
fn dentils(z: f32, y: f32, size: [f32; 3]) -> Shape {
    let mut row = Shape::default();
    let pitch = size[0] * 2.0;
    let count = (2.0 * HALF_LENGTH / pitch) as usize;
    for i in 0..count {
        let x = (i as f32 + 0.5) * pitch - HALF_LENGTH;
        let (low, high) =
            (Vec3::new(x - size[0] / 2.0, y, z - size[2]), Vec3::new(x + size[0] / 2.0, y + size[1], z));
        row.append(&open_block(low, high));
    }
    row
}

/// The faces of a box that look into the nave: front, bottom and the two ends.
fn open_block(low: Vec3, high: Vec3) -> Shape {
    let corner = |x: bool, y: bool, z: bool| {
        Vec3::new(
            if x { high.x } else { low.x },
            if y { high.y } else { low.y },
            if z { high.z } else { low.z },
        )
    };
    let quad = |c: [(bool, bool, bool); 4], outward| polygon(&c.map(|(x, y, z)| corner(x, y, z)), outward);
    let (o, i) = (false, true);
    quad([(o, o, o), (i, o, o), (i, i, o), (o, i, o)], Vec3::NEG_Z)
        .with(quad([(o, o, o), (i, o, o), (i, o, i), (o, o, i)], Vec3::NEG_Y))
        .with(quad([(o, o, o), (o, i, o), (o, i, i), (o, o, i)], Vec3::NEG_X))
        .with(quad([(i, o, o), (i, i, o), (i, i, i), (i, o, i)], Vec3::X))
}

const UPPER_HALF: f32 = 0.16;

fn upper_arch() -> Part {
    let wall = Opening { half_width: UPPER_ARCH + 0.12, sill: UPPER_SPRING, springing: UPPER_SPRING };
    let both =
        two_faces(arched_wall(&wall, BAY * 0.5, [UPPER_SPRING, GALLERY_CEILING + 0.02], 8), UPPER_HALF);
    let arch = Opening { half_width: UPPER_ARCH, sill: UPPER_SPRING, springing: UPPER_SPRING };
    let half = Outline::from(0.135, UPPER_HALF - 0.01)
        .to(0.135, UPPER_HALF + 0.03)
        .arc((0.105, UPPER_HALF + 0.025), 0.018, (0.4, 1.1), 2)
        .to(0.08, UPPER_HALF + 0.018)
        .to(0.0, UPPER_HALF + 0.012)
        .0;
    let mirrored = half.iter().rev().map(|p| Vec2::new(p.x, -p.y));
    let profile = Profile::new(&half.iter().copied().chain(mirrored).collect::<Vec<_>>(), false);
    Part::of(Finish::WhitePlaster, both).with(Finish::Limestone, sweep(&profile, &opening_frames(&arch, 8)))
}

/// The cornice that carries the vault.
fn upper_entablature() -> Part {
    let face = UPPER_HALF;
    let outline = Outline::from(face - 0.02, 9.2)
        .to(face + 0.02, 9.2)
        .arc((face + 0.02, 9.225), 0.025, (-0.5, 0.5), 4)
        .to(face + 0.02, 9.26)
        .to(face + 0.02, 9.44)
        .to(face + 0.05, 9.45)
        .to(face + 0.06, 9.54)
        .to(face + 0.18, 9.55)
        .arc((face + 0.18, 9.6), 0.05, (-0.5, 0.0), 4)
        .to(face + 0.26, 9.62)
        .arc((face + 0.36, 9.66), 0.08, (0.92, 0.55), 5)
        .to(face + 0.38, 9.76)
        .to(face + 0.38, UPPER_CORNICE)
        .to(0.14, UPPER_CORNICE)
        .to(0.14, UPPER_CORNICE + 0.3)
        .open();
    Part::of(Finish::Limestone, along_side(&outline))
        .with(Finish::Limestone, dentils(NAVE - face - 0.05, 9.465, [0.10, 0.09, 0.09]))
        .with(Finish::RedMarble, along_side(&Outline::from(face + 0.026, 9.29).to(face + 0.026, 9.41).open()))
}
