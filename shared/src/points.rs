//! Surface points that last: what a pixel shades is a point of the scene, which it keeps while the point falls into it.
//!
//! How a frame whose camera or things have moved finds its points:
//! 1. `scatter`: each point of the previous frame, on its triangle as that lies now, falls into a pixel; the nearest stays ([`Caught`]).
//! 2. `land` and `aim`: a pixel that caught a point aims at its exact place in the pixel ([`Aim`]). One that caught none borrows the nearest
//!    one that a neighbor caught, within a pixel of its own center; there two pixels shade one point for a while. Where there is none,
//!    or when it is the pixel's turn (once in 16 frames), it aims at a new point, at the place that a neighbor's catch has in its own
//!    pixel: neighbors stay a regular grid, which moves pixel to pixel, one to one.
//! 3. `gbuffer_aimed`: the primary ray goes through that place. It meets the point's triangle: the point is confirmed. It meets
//!    another: something hides the point, or it was never there, and the pixel has a new one.
//! 4. `temporal`: a confirmed point goes on with its reservoir. Nothing has moved: what it saw, it sees. `temporal_hops`: a new point,
//!    listed by `gbuffer_aimed`, takes over the reservoir of the pixel that it was in, as a point through a pixel's center does.
//!
//! At rest points return to the centers of their pixels, each when it is its pixel's turn: after 16 frames a still picture is what
//! it is without all this.
//!
//! Which pixel keeps what is decided by geometry alone, never by a sample: the estimator stays unbiased at the points. It is the
//! backward form of reservoir splatting (Liu et al. 2025), with one point a pixel.

use crate::frame::FrameConstants;
use crate::geometry::InstanceGeometry;
use crate::interface::HitPayload;
use crate::math::pack_place;
use bytemuck::{Pod, Zeroable};
use glam::{UVec2, Vec2, Vec3};

/// A point of a triangle, wherever its instance is. 16 bytes. All zero: none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ScenePoint {
    /// 1 + index of its [`InstanceGeometry`].
    instance: u32,
    /// Triangle within that geometry.
    pub primitive: u32,
    /// Weights of the second and third corner.
    pub barycentrics: Vec2,
}

impl ScenePoint {
    /// Of a hit.
    pub fn new(instance: u32, primitive: u32, barycentrics: Vec2) -> Self {
        ScenePoint { instance: instance + 1, primitive, barycentrics }
    }

    /// Is there no point?
    pub fn is_none(&self) -> bool {
        self.instance == 0
    }

    /// Index of its [`InstanceGeometry`].
    pub fn instance(&self) -> u32 {
        self.instance - 1
    }

    /// Do both lie on one triangle? Seen through one place in the picture they are one point then.
    pub fn shares_triangle_with(&self, other: &ScenePoint) -> bool {
        self.instance == other.instance && self.primitive == other.primitive
    }
}

impl From<HitPayload> for ScenePoint {
    fn from(HitPayload { hit, instance, primitive, barycentrics, .. }: HitPayload) -> Self {
        if hit != 0 { ScenePoint::new(instance, primitive, barycentrics) } else { ScenePoint::default() }
    }
}

/// Where the scene's triangles lie.
#[derive(Clone, Copy)]
pub struct Triangles<'a> {
    /// By index, see [`InstanceGeometry`].
    pub instances: &'a [InstanceGeometry],
    /// Object space, m.
    pub positions: &'a [Vec3],
    /// Three a triangle.
    pub indices: &'a [u32],
}

impl Triangles<'_> {
    /// `point` relative to `eye` (m), as its triangle lies now.
    pub fn relative_to(self, eye: Vec3, point: &ScenePoint) -> Vec3 {
        let geometry = self.instances[point.instance() as usize];
        let [a, b, c] = geometry.corners(self.indices, point.primitive);
        let a = geometry.relative_to(eye, self.positions[a]);
        let (b, c) =
            (geometry.relative_to(eye, self.positions[b]), geometry.relative_to(eye, self.positions[c]));
        a + point.barycentrics.x * (b - a) + point.barycentrics.y * (c - a)
    }

    /// Where `frame` shows `point`, hidden or not; nowhere outside the picture.
    pub fn shown(self, frame: &FrameConstants, point: &ScenePoint) -> Option<Shown> {
        if point.is_none() {
            return None;
        }
        let relative = self.relative_to(frame.camera.position, point);
        let at = frame.camera.project(relative, frame.size);
        let inside = at.cmpge(Vec2::ZERO).all() && at.cmplt(frame.size.as_vec2()).all();
        if !inside {
            return None;
        }
        Some(Shown { at, distance: relative.length() })
    }
}

/// A point on the picture.
#[derive(Clone, Copy, Debug)]
pub struct Shown {
    /// Pixels, from the upper left corner.
    pub at: Vec2,
    /// To the camera, m.
    pub distance: f32,
}

impl Shown {
    /// The pixel that it lies in.
    pub fn pixel(&self, size: UVec2) -> UVec2 {
        self.at.as_uvec2().min(size - 1)
    }

    /// Its place in `pixel`, packed. Rounding may have it fall beside the pixel by a hair.
    pub fn place_in(&self, pixel: UVec2) -> u32 {
        pack_place(self.at - pixel.as_vec2())
    }
}

/// The point that a pixel caught, in a word of which the greatest is the nearest point; of points that are equally near to
/// what the word can hold, the first. 0: none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Caught(pub u32);

impl Caught {
    /// Of the point of pixel number `source` of the previous frame, of `pixels`, at `distance` (m, 2^-32 to 2^32).
    ///
    /// What the number leaves of the word holds the distance: 11 bits at 1920 x 1080, steps of 3 %.
    pub fn new(source: u32, pixels: u32, distance: f32) -> Self {
        const BITS: u32 = 29;
        let (least, most) = (0x2f80_0000, 0x2f80_0000 + (1 << BITS) - 1);
        let exact = distance.to_bits().max(least).min(most) - least;
        let bits = 32 - index_bits(pixels);
        let steps = if bits < BITS { exact >> (BITS - bits) } else { exact };
        // The farthest step is given up: no point is 0.
        let nearness = (((1u32 << bits.min(BITS)) - 1) - steps).max(1);
        Caught(nearness << index_bits(pixels) | (pixels - 1 - source))
    }

    /// The pixel of the previous frame whose point it is.
    pub fn source(self, pixels: u32) -> Option<u32> {
        if self.0 == 0 { None } else { Some(pixels - 1 - (self.0 & ((1 << index_bits(pixels)) - 1))) }
    }
}

/// Bits that hold the numbers of so many pixels.
fn index_bits(pixels: u32) -> u32 {
    32 - (pixels - 1).leading_zeros()
}

/// Where a pixel's ray goes, and what it looks for there. 8 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Aim {
    /// Place in the pixel, packed by [`pack_place`].
    pub place: u32,
    /// 1 + the number of the pixel of the previous frame whose point this pixel keeps; 0: it has a new one.
    source: u32,
}

impl Aim {
    /// At the point of pixel number `source` of the previous frame.
    pub fn at_point(place: u32, source: u32) -> Self {
        Aim { place, source: source + 1 }
    }

    /// At whatever is there.
    pub fn anew(place: u32) -> Self {
        Aim { place, source: 0 }
    }

    /// Number of the pixel of the previous frame whose point it is.
    pub fn source(&self) -> Option<u32> {
        if self.source == 0 { None } else { Some(self.source - 1) }
    }

    /// Once the ray has met `hit`: does the pixel keep its point?
    pub fn confirmed(self, hit: &ScenePoint, previous_points: &[ScenePoint]) -> Aim {
        if let Some(source) = self.source()
            && hit.shares_triangle_with(&previous_points[source as usize])
        {
            return self;
        }
        Aim::anew(self.place)
    }
}

#[cfg(test)]
mod tests;
