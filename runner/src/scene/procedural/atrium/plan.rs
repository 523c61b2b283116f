//! The hall's measures, m. x runs along the nave, y is up, z across; the origin is the middle of the floor.

/// Columns stand at whole multiples of this along x.
pub const BAY: f32 = 2.8;
pub const BAYS: usize = 10;
/// Inner faces of the end walls.
pub const HALF_LENGTH: f32 = 14.0;
/// The column lines, at either side of the nave.
pub const NAVE: f32 = 4.4;
/// Inner faces of the long walls, behind the aisles and the galleries.
pub const WALL: f32 = 8.4;

/// Where the arches of the ground floor start.
pub const SPRING: f32 = 3.5;
/// Their clear half-width.
pub const ARCH: f32 = 1.09;
/// Underside of the gallery.
pub const AISLE_CEILING: f32 = 4.98;
/// Top of the cornice between the storeys, in front of the balustrade.
pub const CORNICE: f32 = 5.62;
pub const GALLERY_FLOOR: f32 = 5.5;
/// Top of the balustrade.
pub const RAIL: f32 = 6.46;
/// Where the arches of the gallery start.
pub const UPPER_SPRING: f32 = 8.4;
pub const UPPER_ARCH: f32 = 0.53;
pub const GALLERY_CEILING: f32 = 9.55;

/// Half-thickness of the arcade walls.
pub const ARCADE: f32 = 0.32;

/// The vault: a circular barrel between the cornices.
pub const VAULT_CROWN: f32 = 12.0;
pub const VAULT_RADIUS: f32 = 5.66;
/// Half of its angle, in half turns.
pub const VAULT_ANGLE: f32 = 0.283;

/// x of the columns that stand free, from one end to the other.
pub fn column_lines() -> impl Iterator<Item = f32> {
    (1..BAYS).map(|i| i as f32 * BAY - HALF_LENGTH)
}

/// x of the middles of the bays.
pub fn bay_centers() -> impl Iterator<Item = f32> {
    (0..BAYS).map(|i| (i as f32 + 0.5) * BAY - HALF_LENGTH)
}
