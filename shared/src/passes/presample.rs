//! The light tiles of the frame: what [`super::initial`] draws from where lights are many.

use super::At;
use crate::alias_table::AliasEntry;
use crate::light::Light;
use crate::light::tile::{TileEntry, presample as draw};

/// An entry of a tile, and the point of its light.
pub fn presample(at: At<'_>, lights: &[Light], alias: &[AliasEntry]) -> (TileEntry, u32) {
    draw(at.light_table(lights, alias), at.pixel.y, at.pixel.x, at.frame)
}
