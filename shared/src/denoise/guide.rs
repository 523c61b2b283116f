//! What says that two pixels see one surface.

use crate::camera::Camera;
use crate::math::{inverse_sqrt, pack_direction};
use crate::surface::{GBufferTexel, Surface};
use glam::{UVec2, Vec2, Vec3};

/// From where on a pixel lies too far off its neighbor's tangent plane, in pixels' widths there for each pixel between the two. Points
/// lie up to a pixel beside the centers that are assumed here.
const OFF_PLANE: f32 = 2.0;

/// Of a pixel, packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PackedGuide {
    /// Shading normal, as in the G-buffer.
    pub normal: u32,
    /// Geometric normal: octahedral map, 2 x 8 bits; error < 0.02 rad.
    pub plane: u32,
    /// To the camera's plane, m, f32 bits; 0: there is no surface.
    pub depth: u32,
}

impl PackedGuide {
    /// Of `surface`, which `texel` packs and a camera that looks along `forward` sees.
    pub fn new(texel: &GBufferTexel, surface: &Surface, forward: Vec3) -> Self {
        let plane = pack_direction(surface.geometric_normal);
        PackedGuide {
            normal: texel.normal,
            // The upper halves of both coordinates.
            plane: plane >> 8 & 0xff | plane >> 16 & 0xff00,
            depth: (surface.distance * -surface.wo.dot(forward)).max(f32::MIN_POSITIVE).to_bits(),
        }
    }
}

/// The same, unpacked.
#[derive(Clone, Copy, Debug)]
pub struct Guide {
    /// Unit.
    normal: Vec3,
    plane: Vec3,
    /// Relative to the eye, m.
    position: Vec3,
    /// To the camera's plane, m.
    depth: f32,
}

impl Guide {
    /// Of `pixel` in a picture of `size`, through its center.
    pub fn new(packed: PackedGuide, camera: &Camera, pixel: UVec2, size: UVec2) -> Self {
        let depth = f32::from_bits(packed.depth);
        let ndc = (pixel.as_vec2() + 0.5) / size.as_vec2() * 2.0 - Vec2::ONE;
        // The middle of what the upper halves stand for.
        let plane = (packed.plane & 0xff) << 8 | (packed.plane & 0xff00) << 16 | 0x0080_0080;
        Guide {
            normal: direction(packed.normal),
            plane: direction(plane),
            position: (camera.forward + ndc.x * camera.right - ndc.y * camera.up) * depth,
            depth,
        }
    }

    /// 0 to 1: how much of one surface this pixel and `other` see, `apart` pixels away along the farther axis. The same from either
    /// side. `width`: of a pixel at a distance of 1.
    pub fn similarity(&self, other: &Guide, width: f32, apart: f32) -> f32 {
        let cos = self.normal.dot(other.normal).max(0.0);
        // Off the plane halfway between the two.
        let off = (self.plane + other.plane).dot(other.position - self.position).abs();
        let tolerance = OFF_PLANE * apart * width * (self.depth + other.depth);
        let cos2 = cos * cos;
        let cos4 = cos2 * cos2;
        cos4 * cos4 * (1.0 - off / tolerance).max(0.0)
    }
}

/// What [`crate::math::unpack_direction`] gives but for rounding, in fewer instructions: filters unpack many.
fn direction(bits: u32) -> Vec3 {
    let (x, y) = ((((bits << 16) as i32) >> 16) as f32, ((bits as i32) >> 16) as f32);
    let z = 32767.0 - x.abs() - y.abs();
    let fold = (-z).max(0.0);
    let v = Vec3::new(x - fold.copysign(x), y - fold.copysign(y), z);
    v * inverse_sqrt(v.length_squared())
}
