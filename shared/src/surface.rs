//! The visible surface of a pixel, and how the G-buffer keeps it.

use crate::camera::Camera;
use crate::frame::features;
use crate::geometry::SurfacePoint;
use crate::material::{Material, MaterialTexels, NO_TEXTURE, Reflectance, UNLIT_WHITE, flag, slot};
use crate::math::{
    offset_ray_origin, pack_direction, pack_direction24, pack_unorm16, unpack_direction, unpack_direction24,
    unpack_place, unpack_unorm16,
};
use bytemuck::{Pod, Zeroable};
use glam::{UVec2, Vec3};

/// Everything that shading needs to know of one point.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// Where light arrives, world space, m: the point of the triangle, or of the curved surface that the triangle stands for, if
    /// that lies above it (see [`crate::geometry::InstanceGeometry::bulge`]).
    pub position: Vec3,
    /// From the point of the triangle to the camera, m; 0 where a pixel sees no surface. Where a path goes on: the largest number
    /// that `position` was computed from, m, which is what the distance is to a ray's origin.
    pub distance: f32,
    /// Unit direction to the camera, or back along the path.
    pub wo: Vec3,
    /// Of the surface that `position` lies on: the triangle's, or the interpolated one. Unit, on that side.
    pub geometric_normal: Vec3,
    /// Unit shading normal.
    pub normal: Vec3,
    /// How it reflects.
    pub reflectance: Reflectance,
}

/// One pixel of the G-buffer: a [`Surface`] in 32 bytes. All zero: no surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct GBufferTexel {
    /// f32 bits: the position follows from it, the pixel and the camera. 0: no surface. Negative: light arrives above the
    /// triangle, see [`GBufferTexel::lifted`].
    pub distance: u32,
    /// Of the triangle: error < 1e-4 rad. Lifted: of the curved surface, 24 bits, error < 1e-3 rad | the height, see [`pack_lift`].
    pub geometric_normal: u32,
    /// Error < 1e-4 rad.
    pub normal: u32,
    /// diffuse r, g | diffuse b, f0 r | f0 g, b: error <= 0.51/65535 each.
    pub reflectance: [u32; 3],
    /// Roughness, error <= 0.51/65535 | lower 16 of the 24 bits of the place in the pixel.
    pub roughness: u32,
    /// The [`crate::geometry::InstanceGeometry`] that was hit, 24 bits as a hit has them | upper 8 bits of the place.
    pub instance: u32,
}

/// The bits of an instance.
const INSTANCE: u32 = (1 << 24) - 1;

/// Of `distance`: light arrives above the triangle.
const LIFTED: u32 = 1 << 31;
/// The least height that a code stands for, 2^-14, in f32 bits: a small part of a pixel.
const LEAST_LIFT: u32 = (127 - 14) << 23;
/// Of a code, in f32 bits: 16 an octave.
const LIFT_STEP: u32 = 19;

/// A height in parts of the distance to the camera, 2^-14 to 4, in 8 bits; rounded up, by 1/16 at most.
fn pack_lift(part: f32) -> u32 {
    let above = part.to_bits().max(LEAST_LIFT) - LEAST_LIFT;
    ((above + (1 << LIFT_STEP) - 1) >> LIFT_STEP).min(255)
}

fn unpack_lift(code: u32) -> f32 {
    f32::from_bits(LEAST_LIFT + (code << LIFT_STEP))
}

fn pack2(low: f32, high: f32) -> u32 {
    pack_unorm16(low) | pack_unorm16(high) << 16
}

impl GBufferTexel {
    /// The surface that a camera at `eye` sees at `point`; normals are turned to the camera's side.
    pub fn new(
        point: &SurfacePoint,
        normal: Vec3,
        reflectance: Reflectance,
        instance: u32,
        eye: Vec3,
    ) -> Self {
        let to_eye = eye - point.position;
        let side = if point.geometric_normal.dot(to_eye) < 0.0 { -1.0 } else { 1.0 };
        let Reflectance { diffuse, f0, roughness } = reflectance;
        GBufferTexel {
            distance: to_eye.length().to_bits(),
            geometric_normal: pack_direction(point.geometric_normal * side),
            normal: pack_direction(visible_normal(normal * side, to_eye.normalize())),
            reflectance: [pack2(diffuse.x, diffuse.y), pack2(diffuse.z, f0.x), pack2(f0.y, f0.z)],
            roughness: pack_unorm16(roughness),
            instance: instance & INSTANCE,
        }
    }

    /// Light arrives `lift` m above its point, on a curved surface of unit normal `normal` there, on the camera's side.
    pub fn lifted(self, lift: f32, normal: Vec3) -> Self {
        let code = pack_lift(lift / self.distance());
        let geometric_normal = pack_direction24(normal) | code << 24;
        GBufferTexel { distance: self.distance | LIFTED, geometric_normal, ..self }
    }

    fn is_lifted(&self) -> bool {
        self.distance & LIFTED != 0
    }

    /// How far above its point light arrives, m.
    pub fn lift(&self) -> f32 {
        if self.is_lifted() { unpack_lift(self.geometric_normal >> 24) * self.distance() } else { 0.0 }
    }

    /// Seen through the place in its pixel that `place` packs (see [`crate::math::pack_place`]), not through its center.
    pub fn seen_through(self, place: u32) -> Self {
        let roughness = self.roughness & 0xffff | place << 16;
        GBufferTexel { roughness, instance: self.instance & INSTANCE | (place >> 16) << 24, ..self }
    }

    /// Place in the pixel through which it was seen, packed.
    pub fn place(&self) -> u32 {
        self.roughness >> 16 | (self.instance >> 24) << 16
    }

    /// Index of the [`crate::geometry::InstanceGeometry`] that was hit.
    pub fn instance(&self) -> u32 {
        self.instance & INSTANCE
    }

    /// Does the pixel see no surface?
    pub fn is_empty(&self) -> bool {
        self.distance == 0
    }

    /// Distance to the camera, m.
    pub fn distance(&self) -> f32 {
        f32::from_bits(self.distance & !LIFTED)
    }

    /// The shading normal.
    pub fn normal(&self) -> Vec3 {
        unpack_direction(self.normal)
    }

    /// Of the surface that light arrives at: the triangle's, or the curved one's.
    pub fn geometric_normal(&self) -> Vec3 {
        if self.is_lifted() {
            unpack_direction24(self.geometric_normal)
        } else {
            unpack_direction(self.geometric_normal)
        }
    }

    /// Specular reflectance at normal incidence.
    pub fn f0(&self) -> Vec3 {
        let [_, br, gb] = self.reflectance;
        Vec3::new(unpack_unorm16(br >> 16), unpack_unorm16(gb), unpack_unorm16(gb >> 16))
    }

    /// Perceptual roughness, 0..=1.
    pub fn roughness(&self) -> f32 {
        unpack_unorm16(self.roughness)
    }

    /// Albedo of the diffuse lobe.
    pub fn diffuse(&self) -> Vec3 {
        let [rg, b, _] = self.reflectance;
        Vec3::new(unpack_unorm16(rg), unpack_unorm16(rg >> 16), unpack_unorm16(b))
    }

    /// The surface of `pixel` seen by `camera` in an image of `size`, in a scene with `features` (any more do no harm).
    pub fn unpack(&self, features: u32, camera: &Camera, pixel: UVec2, size: UVec2) -> Surface {
        let direction = camera.direction(pixel.as_vec2() + unpack_place(self.place()), size);
        let distance = self.distance();
        let mut position = camera.position + direction * distance;
        let mut geometric_normal = unpack_direction(self.geometric_normal);
        if features & features::SMOOTH != 0 && self.is_lifted() {
            geometric_normal = self.geometric_normal();
            position += geometric_normal * self.lift();
        }
        Surface {
            position,
            distance,
            wo: -direction,
            geometric_normal,
            normal: self.normal(),
            reflectance: Reflectance { diffuse: self.diffuse(), f0: self.f0(), roughness: self.roughness() },
        }
    }
}

/// What a ray met, with all that was looked up for it.
#[derive(Clone, Copy, Debug)]
pub struct PrimaryHit {
    /// Where.
    pub point: SurfacePoint,
    /// Of what.
    pub material: Material,
    /// Read there.
    pub texels: MaterialTexels,
    /// How far off the triangle the curved surface that it stands for lies, in front, m; 0 where nobody asks.
    pub bulge: f32,
    /// [`features`] of the scene.
    pub features: u32,
    /// Index of the [`crate::geometry::InstanceGeometry`].
    pub instance: u32,
}

impl PrimaryHit {
    /// The G-buffer's view of it for a camera at `eye` (m). An unlit surface is none: nothing is to be lit.
    pub fn texel(&self, eye: Vec3) -> GBufferTexel {
        if self.material.has(flag::UNLIT) {
            return GBufferTexel::default();
        }
        let texel = GBufferTexel::new(&self.point, self.normal(), self.reflectance(), self.instance, eye);
        let Lit { lift, normal, .. } = self.lit(eye - self.point.position);
        if lift > 0.0 { texel.lifted(lift, normal) } else { texel }
    }

    /// Where light arrives that leaves toward `wo`.
    fn lit(&self, wo: Vec3) -> Lit {
        let SurfacePoint { position, geometric_normal, normal, .. } = self.point;
        let side = if self.is_front(wo) { 1.0 } else { -1.0 };
        // Normals that disagree with the front tell of no surface.
        let lift = if normal.dot(geometric_normal) > 0.0 { self.bulge * side } else { 0.0 };
        if lift > 0.0 {
            Lit { position: position + normal * (side * lift), normal: normal * side, lift }
        } else {
            Lit { position, normal: geometric_normal * side, lift: 0.0 }
        }
    }

    /// The same for light that leaves along `wo` (unit), unpacked. `magnitude`: largest number that the position was computed
    /// from, m.
    pub fn surface(&self, wo: Vec3, magnitude: f32) -> Surface {
        let side = if self.is_front(wo) { 1.0 } else { -1.0 };
        let Lit { position, normal: geometric_normal, .. } = self.lit(wo);
        Surface {
            position,
            distance: magnitude,
            wo,
            geometric_normal,
            normal: visible_normal(self.normal() * side, wo),
            reflectance: self.reflectance(),
        }
    }

    /// Does it reflect light along `wo` (unit)? Unlit surfaces and the backs of single-sided ones only block it.
    pub fn reflects(&self, wo: Vec3) -> bool {
        !self.material.has(flag::UNLIT) & (self.is_front(wo) | self.material.has(flag::DOUBLE_SIDED))
    }

    /// Does `wo` look at its front?
    pub fn is_front(&self, wo: Vec3) -> bool {
        self.point.geometric_normal.dot(wo) >= 0.0
    }

    /// The shading normal, on the front.
    fn normal(&self) -> Vec3 {
        let has_normal_map = self.material.textures[slot::NORMAL] != NO_TEXTURE;
        let mapped = self.features & features::NORMAL_MAPS != 0 && has_normal_map;
        if mapped {
            self.point.mapped_normal(self.texels.normal, self.material.normal_scale)
        } else {
            self.point.normal
        }
    }

    fn reflectance(&self) -> Reflectance {
        self.material.reflectance(&self.texels, self.point.color)
    }

    /// Radiance toward `eye` that the surface shows without light, nit: a single-sided one emits from its front only;
    /// an unlit one shows its base color, [`UNLIT_WHITE`] for white.
    pub fn emission(&self, eye: Vec3) -> Vec3 {
        if self.material.has(flag::UNLIT) {
            return self.material.base_color(&self.texels, self.point.color) * UNLIT_WHITE;
        }
        let from_front = self.point.geometric_normal.dot(eye - self.point.position) > 0.0;
        if from_front || self.material.has(flag::DOUBLE_SIDED) {
            self.material.emission * self.texels.emission
        } else {
            Vec3::ZERO
        }
    }
}

/// Where light arrives.
struct Lit {
    /// World space, m.
    position: Vec3,
    /// Of the surface there, unit.
    normal: Vec3,
    /// Its height above the triangle, m.
    lift: f32,
}

/// Interpolated and mapped normals may point away from the camera at silhouettes, where the BSDF would be black:
/// such a normal is bent back just into view (|cos| = 0.01).
fn visible_normal(normal: Vec3, wo: Vec3) -> Vec3 {
    const LEAST_COS: f32 = 0.01;
    let cos = normal.dot(wo);
    if cos >= LEAST_COS { normal } else { (normal + (LEAST_COS - cos) * wo).normalize() }
}

impl Surface {
    /// Do both see the same, to the last bit?
    pub fn is_same_point(&self, other: &Surface) -> bool {
        self.position == other.position
            && self.geometric_normal == other.geometric_normal
            && self.distance == other.distance
    }

    /// Where a ray starts that leaves this surface for a point `room` m above it.
    pub fn ray_origin(&self, room: f32) -> Vec3 {
        offset_ray_origin(self.position, self.geometric_normal, self.distance, room)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;

    fn point(position: Vec3, normal: Vec3) -> SurfacePoint {
        SurfacePoint {
            position,
            geometric_normal: normal,
            normal,
            tangent: Vec3::X,
            tangent_sign: 1.0,
            uv: Vec2::ZERO,
            color: Vec3::ONE,
        }
    }

    #[test]
    fn a_surface_survives_packing() {
        let size = UVec2::new(640, 360);
        let camera = Camera::new(Vec3::new(0.5, 1.5, 4.0), Vec3::new(0.1, -0.2, -1.0), Vec3::Y, 0.9, size);
        for i in 0..2000u32 {
            let pixel = UVec2::new(i * 7 % 640, i * 13 % 360);
            let distance = 10f32.powf((i % 13) as f32 * 0.5 - 2.0);
            let position = camera.position + camera.direction(pixel.as_vec2() + 0.5, size) * distance;
            let t = i as f32 / 2000.0;
            let normal = Vec3::new(t - 0.5, 0.3, 0.8 - t).normalize();
            let reflectance = Reflectance::from_metallic_roughness(Vec3::new(t, 0.01, 1.0 - t), 0.3, t);
            let texel = GBufferTexel::new(&point(position, normal), normal, reflectance, i, camera.position);
            let s = texel.unpack(u32::MAX, &camera, pixel, size);
            let ulp = distance.max(camera.position.abs().max_element()) * f32::EPSILON;
            assert!(
                (s.position - position).abs().max_element() <= 4.0 * ulp,
                "{} for {position}",
                s.position
            );
            assert!(s.geometric_normal.dot(s.wo) > -1e-3, "the normal is on the camera's side");
            assert!(s.normal.dot(s.wo) >= 0.0099);
            assert!((s.reflectance.diffuse - reflectance.diffuse).abs().max_element() < 1e-5);
            assert!((s.reflectance.f0 - reflectance.f0).abs().max_element() < 1e-5);
            assert!((s.reflectance.roughness - t).abs() < 1e-5);
            assert!(!texel.is_empty() && texel.instance() == i);
        }
        assert!(GBufferTexel::default().is_empty());
        assert_eq!(size_of::<GBufferTexel>(), 32);
    }

    /// Heights come back, never lower and by at most 1/16 higher, with all else that a texel keeps; a scene that is not smooth
    /// does not ask for them.
    #[test]
    fn heights_survive_packing() {
        let size = UVec2::new(640, 360);
        let camera = Camera::new(Vec3::new(0.5, 1.5, 4.0), Vec3::new(0.1, -0.2, -1.0), Vec3::Y, 0.9, size);
        let pixel = UVec2::new(300, 200);
        let position = camera.position + camera.direction(pixel.as_vec2() + 0.5, size) * 5.0;
        let normal = Vec3::new(0.2, 0.3, 0.8).normalize();
        let reflectance = Reflectance::from_metallic_roughness(Vec3::splat(0.3), 0.3, 0.5);
        let flat = GBufferTexel::new(&point(position, Vec3::Z), normal, reflectance, 7, camera.position);
        let unlifted = flat.unpack(u32::MAX, &camera, pixel, size);
        for i in 1..1000 {
            let lift = 5.0 * 10f32.powf(i as f32 / 1000.0 * 3.0 - 3.0);
            let texel = flat.lifted(lift, normal);
            assert!(texel.lift() >= lift && texel.lift() <= lift * 1.0626, "{} for {lift}", texel.lift());
            let s = texel.unpack(features::SMOOTH, &camera, pixel, size);
            assert!(
                (s.position - unlifted.position - normal * texel.lift()).length()
                    < 1e-3 * texel.lift() + 1e-6
            );
            assert!(s.geometric_normal.dot(normal) > 0.999_999 && s.normal == unlifted.normal);
            assert_eq!((s.distance, s.wo, texel.instance()), (unlifted.distance, unlifted.wo, 7));
            assert!(!texel.is_empty() && texel.unpack(0, &camera, pixel, size).position == unlifted.position);
        }
        assert_eq!(flat.lift(), 0.0);
    }
}
