//! The point lights: first the flames of the lamps, then as many more as are asked for, floating in free air.

use super::furnishings::{self, Obstacle};
use super::lamps::{self, KINDS, Kind, flames, mounts};
use super::plan::{
    AISLE_CEILING, GALLERY_CEILING, GALLERY_FLOOR, HALF_LENGTH, NAVE, VAULT_CROWN, VAULT_RADIUS, WALL,
};
use crate::scene::PointLight;
use glam::{Vec2, Vec3, Vec3Swizzles};
use shared::rng::unit_f32;

/// Luminous intensity of all lights together, cd. With it the floor receives about 200 lx.
const TOTAL_INTENSITY: f64 = 22_000.0;

/// Least distance of a filling light from walls, columns and furniture, m.
const CLEARANCE: f32 = 0.15;

/// Half-width of the zone of columns, arches and curtains, where no filling light is.
const COLONNADE: f32 = 0.62;

/// `count` lights, the same for the same count.
pub fn lights(count: usize) -> Vec<PointLight> {
    let mut places = lamp_lights();
    places.truncate(count);
    places.extend(filling().take(count - places.len()));
    let total: f64 = places.iter().map(|&(_, weight)| f64::from(weight)).sum();
    let scale = TOTAL_INTENSITY / total;
    let light = |(i, &(position, weight)): (usize, &(Vec3, f32))| PointLight {
        position,
        intensity: color(i as u32) * (f64::from(weight) * scale) as f32,
        radius: 0.0,
    };
    places.iter().enumerate().map(light).collect()
}

/// Relative intensity of one flame.
fn weight(kind: Kind) -> f32 {
    match kind {
        Kind::Lantern => 4.0,
        Kind::GalleryLantern => 3.0,
        Kind::Chandelier => 2.0,
        Kind::Sconce => 1.5,
        Kind::Candles => 0.5,
        Kind::RibLamp | Kind::CorniceLamp => 0.6,
    }
}

/// (position, weight) of every flame: kind after kind, within a kind lamp after lamp, one flame of each at a time.
fn lamp_lights() -> Vec<(Vec3, f32)> {
    let mut places = Vec::new();
    for kind in KINDS {
        let mounts = mounts(kind);
        for flame in flames(kind) {
            places.extend(mounts.iter().map(|mount| (mount.transform_point3(flame), weight(kind))));
        }
    }
    places
}

/// Points of the R3 sequence (Roberts 2018) in the hall that are in free air; more of them near surfaces.
fn filling() -> impl Iterator<Item = (Vec3, f32)> {
    // Inverse powers of the root of x^4 = x + 1, in 64-bit fixed point: exact for any index.
    const STEP: [u64; 3] = [0xd1b5_4a32_d192_ed03, 0xabc9_8388_fb8f_ac02, 0x8cb9_2ba7_2f3d_8dd7];
    let obstacles = obstacles();
    let size = Vec3::new(2.0 * HALF_LENGTH, VAULT_CROWN, 2.0 * WALL);
    (1u64..).filter_map(move |i| {
        let unit = STEP.map(|step| unit_f32((i.wrapping_mul(step) >> 32) as u32));
        let p = Vec3::from(unit) * size - Vec3::new(HALF_LENGTH, 0.0, WALL);
        let clearance = clearance(p, &obstacles);
        let wanted = clearance < 0.7 || unit_f32(hash(i as u32)) < 0.35;
        (clearance >= CLEARANCE && wanted).then_some((p, 0.6))
    })
}

/// What stands or hangs in the open.
fn obstacles() -> Vec<Obstacle> {
    [furnishings::obstacles(), lamps::obstacles()].concat()
}

/// Distance to the nearest wall, floor, ceiling, colonnade or obstacle, m; negative inside. Never too large.
fn clearance(p: Vec3, obstacles: &[Obstacle]) -> f32 {
    let across = p.z.abs();
    let ends = HALF_LENGTH - p.x.abs();
    // Cornices, dado and sills project by up to this from their walls.
    const RELIEF: f32 = 0.3;
    let room = if across < NAVE {
        let vault = VAULT_RADIUS - Vec2::new(p.y - (VAULT_CROWN - VAULT_RADIUS), across).length() - RELIEF;
        let below_vault = if p.y > VAULT_CROWN - VAULT_RADIUS { vault } else { f32::INFINITY };
        (NAVE - COLONNADE - across).min(p.y).min(below_vault)
    } else {
        let ground = p.y.min(AISLE_CEILING - 0.2 - p.y);
        let gallery = (p.y - GALLERY_FLOOR).min(GALLERY_CEILING - 0.2 - p.y);
        (across - NAVE - COLONNADE).min(WALL - 0.16 - across).min(ground.max(gallery))
    };
    let to_obstacles = obstacles.iter().map(|o| {
        let [low, high] = o.heights;
        (p.xz().distance(o.axis) - o.radius).max(p.y - high).max(low - p.y)
    });
    to_obstacles.fold(room.min(ends - RELIEF), f32::min)
}

fn hash(i: u32) -> u32 {
    let mut h = i.wrapping_mul(0x9e37_79b1);
    h = (h ^ (h >> 16)).wrapping_mul(0x85eb_ca6b);
    h = (h ^ (h >> 13)).wrapping_mul(0xc2b2_ae35);
    h ^ (h >> 16)
}

/// Linear RGB of luminance 1: flames of 2200 to 3400 K, and one in eight saturated.
fn color(i: u32) -> Vec3 {
    let h = hash(i ^ 0x5bd1_e995);
    const ACCENTS: [Vec3; 5] = [
        Vec3::new(1.0, 0.16, 0.05),
        Vec3::new(0.12, 0.35, 1.0),
        Vec3::new(0.10, 0.85, 0.40),
        Vec3::new(0.85, 0.18, 0.90),
        Vec3::new(1.0, 0.55, 0.08),
    ];
    let rgb = if h.is_multiple_of(8) {
        ACCENTS[(h >> 8) as usize % ACCENTS.len()]
    } else {
        let warmth = unit_f32(h.wrapping_mul(0x27d4_eb2d));
        Vec3::new(1.0, 0.60, 0.28).lerp(Vec3::new(1.0, 0.82, 0.60), warmth)
    };
    rgb / shared::math::luminance(rgb)
}
