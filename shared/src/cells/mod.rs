//! Cells of the world that receive light: they learn which lights they see, and light is drawn for them.
//!
//! A cell is a cube around what the camera sees, about as wide as a sixteenth of its distance, with one of six main directions of
//! its surfaces. Pixels choose theirs a little at random, so that no edges show. Between frames a cell keeps
//! - **beliefs** ([`belief`]): how many of the shadow rays to the lights below each node of the light tree arrived,
//! - a **list** ([`list`]) of lights that were seen from it, with what they gave.
//!
//! In each frame it is given a **pool** ([`pool`]) of light samples that its pixels take their candidates from. All that was
//! learned is what earlier frames saw, the same for every pixel of a frame: it changes probabilities that are known exactly, and
//! targets that may be any positive numbers, so what is wrong or out of date costs noise and never the mean.
//!
//! Cells have no keys: those that share a place by their hash share what they learn.

pub mod belief;
pub mod list;
pub mod pool;

use crate::frame::FrameConstants;
use crate::light::tree::Receiver;
use crate::ray_cone;
use crate::rng::{Rng, Stream, hash, unit_f32};
use crate::surface::Surface;
use bytemuck::{Pod, Zeroable};
use glam::{UVec2, UVec4, Vec3};

/// Most and fewest places of cells.
const MOST: u32 = 1 << 14;
const FEWEST: u32 = 1 << 8;
/// Samples of a pool, a power of two; and from so many lights on, where fewer would be the same for too many pixels. Measured in
/// docs/performance.md.
const POOL: u32 = 128;
const MANY_LIGHTS: u32 = 4096;
const POOL_OF_MANY: u32 = 1024;
/// There is room for so many samples for each place; larger pools have fewer.
const ROOM: u32 = 256;
/// Threads in a row of a launch over cells.
pub const ROW: u32 = 256;

/// Width of a cell as a fraction of its distance from the camera, up to rounding to powers of two; and at least so many pixels.
const WIDTH: f32 = 1.0 / 16.0;
const PIXELS: f32 = 8.0;
/// How far pixels choose cells beside their own, in cells.
const JITTER: f32 = 0.5;
/// Shift of all cells in cells: floors at 0 m lie within them.
const SHIFT: f32 = 0.37;

/// A cell as it is in one frame. 36 bytes; all zero where no pixel has it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Cell {
    /// Its extent and the plane of its surfaces.
    pub receiver: Receiver,
    /// Σ of the weights of its list.
    pub list_weight: f32,
    /// The fraction of all of its shadow rays that arrived.
    pub visibility: f32,
}

/// The cube that a surface lies in.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cube {
    /// Its number in x, y, z, in cubes of this width.
    number: [i32; 3],
    /// m, a power of two.
    width: f32,
    /// Main direction of the surface: 0, 2, 4 for x, y, z, and 1 more where it is negative.
    direction: u32,
}

impl Cube {
    /// For what `pixel` sees. Every frame shifts it a little along its surface.
    fn of(frame: &FrameConstants, surface: &Surface, pixel: UVec2) -> Self {
        let fraction = WIDTH.max(PIXELS * ray_cone::spread(&frame.camera, frame.size));
        // The next power of two above: no logarithm, which devices round differently.
        let bits = (surface.distance * fraction).clamp(1e-30, 1e30).to_bits() & 0x7f80_0000;
        let width = f32::from_bits(bits + 0x0080_0000);
        let random = Rng::new(pixel, frame.index, frame.seed, Stream::Cells, 0).next_u32x4();
        let shift = (Vec3::new(unit_f32(random.x), unit_f32(random.y), unit_f32(random.z)) - 0.5) * JITTER;
        let n = surface.geometric_normal.abs();
        let (axis, along) = if n.x >= n.y && n.x >= n.z {
            (surface.geometric_normal.x, Vec3::X)
        } else if n.y >= n.z {
            (surface.geometric_normal.y, Vec3::Y)
        } else {
            (surface.geometric_normal.z, Vec3::Z)
        };
        let direction = (along.y as u32 + 2 * along.z as u32) * 2 + u32::from(axis < 0.0);
        let place = (surface.position / width + shift * (Vec3::ONE - along) + SHIFT).floor();
        let place = place.clamp(Vec3::splat(-2e9), Vec3::splat(2e9));
        Cube { number: [place.x as i32, place.y as i32, place.z as i32], width, direction }
    }

    /// The hash of its cell.
    fn key(&self) -> u32 {
        let [x, y, z] = self.number;
        let key = UVec4::new(x as u32, y as u32, z as u32, self.width.to_bits() | self.direction);
        hash(key).x
    }

    /// Its middle, but for the height of the surface in it, which is that of `surface`.
    fn receiver(&self, surface: &Surface) -> Receiver {
        let [x, y, z] = self.number;
        let middle = (Vec3::new(x as f32, y as f32, z as f32) + (0.5 - SHIFT)) * self.width;
        let normal = surface.geometric_normal;
        let height = (surface.position - middle).dot(normal);
        Receiver { center: middle + height * normal, radius: 0.7 * self.width, normal }
    }
}

/// Most places of cells for a picture of `size`, a power of two: a 16th of its pixels, and not more where cells keep their width.
pub fn most(size: UVec2) -> u32 {
    let places = size.x * size.y / 16;
    (1 << (u32::BITS - places.leading_zeros())).clamp(FEWEST, MOST)
}

/// Threads of a launch over the samples of all pools.
pub fn samples(size: UVec2) -> UVec2 {
    UVec2::new(POOL_OF_MANY, most(size) * ROOM / POOL_OF_MANY)
}

/// Samples of the pool of a cell.
pub fn pool(frame: &FrameConstants) -> u32 {
    if frame.tree_lights >= MANY_LIGHTS { POOL_OF_MANY } else { POOL }
}

/// Places of cells, a power of two.
pub fn count(frame: &FrameConstants) -> u32 {
    most(frame.size) / (pool(frame) / ROOM).max(1)
}

/// The cell of what `pixel` sees: its place.
pub fn cell_of(frame: &FrameConstants, surface: &Surface, pixel: UVec2) -> u32 {
    Cube::of(frame, surface, pixel).key() & (count(frame) - 1)
}

impl Cell {
    /// As one of its pixels sees it.
    pub fn of(
        frame: &FrameConstants,
        surface: &Surface,
        pixel: UVec2,
        list_weight: f32,
        visibility: f32,
    ) -> Self {
        Cell { receiver: Cube::of(frame, surface, pixel).receiver(surface), list_weight, visibility }
    }

    /// Does no pixel have it?
    pub fn is_empty(&self) -> bool {
        self.receiver.radius <= 0.0
    }
}
