//! Small mathematics that every other module needs.

use glam::{Vec2, Vec3};
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float;

/// Luminance of linear Rec. 709 RGB, in the unit of its argument (ITU-R BT.709-6, item 3.2).
pub fn luminance(rgb: Vec3) -> f32 {
    rgb.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

/// `numerator / denominator`, or 0 where the quotient is no finite number or the denominator is not positive.
pub fn safe_ratio(numerator: f32, denominator: f32) -> f32 {
    let quotient = numerator / denominator;
    // The comparisons are false for NaN, so a NaN operand gives 0 as well. One select and no branch: this is everywhere.
    if (denominator > 0.0) & (quotient.abs() <= f32::MAX) { quotient } else { 0.0 }
}

/// 1/√x: one instruction on the GPU (2 ulp), where a root and a division are many.
pub fn inverse_sqrt(x: f32) -> f32 {
    #[cfg(not(target_arch = "spirv"))]
    let result = 1.0 / x.sqrt();
    #[cfg(target_arch = "spirv")]
    let result: f32;
    // SAFETY: pure arithmetic; 32 is InverseSqrt.
    #[cfg(target_arch = "spirv")]
    unsafe {
        core::arch::asm!(
            "%glsl = OpExtInstImport \"GLSL.std.450\"",
            "{result} = OpExtInst typeof{x} %glsl 32 {x}",
            x = in(reg) x,
            result = out(reg) result,
        );
    }
    result
}

/// `v / |v|`, or `fallback` for a vector without a direction. Scales first, so lengths whose square would
/// under- or overflow are handled.
pub fn normalize_or(v: Vec3, fallback: Vec3) -> Vec3 {
    let largest = v.abs().max_element();
    if largest > 0.0 && largest <= f32::MAX {
        let scaled = v / largest;
        scaled / scaled.length()
    } else {
        fallback
    }
}

/// Two unit vectors that make a right-handed frame with the unit vector `n` (Duff et al. 2017, "Building an Orthonormal
/// Basis, Revisited").
pub fn basis(n: Vec3) -> (Vec3, Vec3) {
    let sign = sign_not_zero(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    (Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), Vec3::new(b, sign + n.y * n.y * a, -n.y))
}

/// `a` x `b`, accurate also for nearly parallel vectors, where the products cancel (Kahan's difference of products: each
/// component within 2 ulp where the device fuses multiply-adds, as without it where not).
pub fn cross(a: Vec3, b: Vec3) -> Vec3 {
    Vec3::new(
        difference_of_products(a.y, b.z, a.z, b.y),
        difference_of_products(a.z, b.x, a.x, b.z),
        difference_of_products(a.x, b.y, a.y, b.x),
    )
}

/// `a b - c d`
fn difference_of_products(a: f32, b: f32, c: f32, d: f32) -> f32 {
    let cd = c * d;
    let error = (-c).mul_add(d, cd);
    a.mul_add(b, -cd) + error
}

/// 0..=65535 nearest to `x` in [0, 1]; error of the round trip <= 0.51/65535 (half a step, and f32's rounding).
pub fn pack_unorm16(x: f32) -> u32 {
    (x.clamp(0.0, 1.0) * 65535.0 + 0.5) as u32
}

/// The value [`pack_unorm16`] packed into the low 16 bits.
pub fn unpack_unorm16(bits: u32) -> f32 {
    (bits & 0xffff) as f32 / 65535.0
}

fn pack_snorm16(x: f32) -> u32 {
    // floor(x + 0.5) and not round(): halves round differently on the two sides.
    ((x.clamp(-1.0, 1.0) * 32767.0 + 0.5).floor() as i32 as u32) & 0xffff
}

fn unpack_snorm16(bits: u32) -> f32 {
    ((bits << 16) as i32 >> 16) as f32 / 32767.0
}

/// Sign that is never 0.
fn sign_not_zero(x: f32) -> f32 {
    if x >= 0.0 { 1.0 } else { -1.0 }
}

/// A unit vector in 32 bits: octahedral map, 2 x 16 bits (Cigolle et al. 2014, "oct32").
/// Angular error of the round trip < 1e-4 rad.
pub fn pack_direction(v: Vec3) -> u32 {
    let folded = octahedral(v);
    pack_snorm16(folded.x) | pack_snorm16(folded.y) << 16
}

/// The octahedral map of a unit vector: a place in [-1, 1]².
fn octahedral(v: Vec3) -> Vec2 {
    let p = v / (v.x.abs() + v.y.abs() + v.z.abs());
    if p.z >= 0.0 {
        Vec2::new(p.x, p.y)
    } else {
        Vec2::new((1.0 - p.y.abs()) * sign_not_zero(p.x), (1.0 - p.x.abs()) * sign_not_zero(p.y))
    }
}

/// The unit vector that [`pack_direction`] packed.
pub fn unpack_direction(bits: u32) -> Vec3 {
    unfolded(unpack_snorm16(bits), unpack_snorm16(bits >> 16))
}

/// The unit vector at (x, y) of the octahedral map.
fn unfolded(x: f32, y: f32) -> Vec3 {
    let z = 1.0 - x.abs() - y.abs();
    let fold = (-z).max(0.0);
    Vec3::new(x - fold * sign_not_zero(x), y - fold * sign_not_zero(y), z).normalize()
}

/// The same in the lower 24 bits, 2 x 12. Angular error of the round trip < 1e-3 rad.
pub fn pack_direction24(v: Vec3) -> u32 {
    let folded = octahedral(v);
    let step = |x: f32| ((x.clamp(-1.0, 1.0) * 2047.0 + 0.5).floor() as i32 as u32) & 0xfff;
    step(folded.x) | step(folded.y) << 12
}

/// The unit vector that [`pack_direction24`] packed.
pub fn unpack_direction24(bits: u32) -> Vec3 {
    let place = |bits: u32| ((bits << 20) as i32 >> 20) as f32 / 2047.0;
    unfolded(place(bits), place(bits >> 12))
}

/// Moves a ray's end off a surface, along its geometric normal (unit, on the ray's side), so that rounding
/// can't make the ray hit that same surface.
///
/// The step is 128 to 256 ulp, as in Wächter & Binder 2019, "A Fast and Robust Method for Avoiding
/// Self-Intersection", but of the largest number that the position was computed from, which is what its rounding
/// error scales with: its own coordinates and `magnitude` (for a primary hit the distance to the camera, for a light
/// its size; m). That makes it free of world units and of a special case at the origin. `room`: how far the ray's other end lies
/// above the surface, m; a quarter of it at most is taken, so that two ends that nearly touch don't pass each other.
pub fn offset_ray_origin(position: Vec3, normal: Vec3, magnitude: f32, room: f32) -> Vec3 {
    const STEP: f32 = 1.0 / 65536.0;
    let step = STEP * position.abs().max_element().max(magnitude);
    position + normal * step.min(0.25 * room.max(0.0))
}

/// Steps of a place, each way.
const PLACES: u32 = 4096;

/// A pixel's center, packed.
pub const CENTER: u32 = 0;

/// A place in a pixel ((0, 0) its upper left corner, (1, 1) its lower right one) or up to half a pixel beside it, in 24 bits.
pub fn pack_place(place: Vec2) -> u32 {
    let step =
        |x: f32| (((x + 0.5) * (PLACES / 2) as f32 + 0.5).max(0.0) as u32).min(PLACES - 1) ^ (PLACES / 2);
    step(place.x) | step(place.y) << 12
}

/// Error <= 1/4096: f32 tells places of a picture of 1920 pixels apart by no less than half of that.
pub fn unpack_place(bits: u32) -> Vec2 {
    let place = |bits: u32| ((bits % PLACES) ^ (PLACES / 2)) as f32 / (PLACES / 2) as f32 - 0.5;
    Vec2::new(place(bits), place(bits >> 12))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn directions() -> impl Iterator<Item = Vec3> {
        // Fibonacci sphere, plus the axes and the folds of the octahedron.
        let spiral = (0..10_000).map(|i| {
            let z = 1.0 - 2.0 * (i as f32 + 0.5) / 10_000.0;
            let phi = i as f32 * 2.399_963_2;
            let r = (1.0 - z * z).sqrt();
            Vec3::new(r * phi.cos(), r * phi.sin(), z)
        });
        let corners =
            (0..27).map(|i| Vec3::new((i % 3) as f32, (i / 3 % 3) as f32, (i / 9) as f32) - Vec3::ONE);
        spiral.chain(corners.filter(|c| *c != Vec3::ZERO).map(Vec3::normalize))
    }

    #[test]
    fn directions_survive_packing() {
        for v in directions() {
            let error = unpack_direction(pack_direction(v)).cross(v).length();
            assert!(error < 1e-4, "{v} is off by {error} rad");
            assert!(unpack_direction(pack_direction(v)).dot(v) > 0.0, "{v} turned around");
            let short = unpack_direction24(pack_direction24(v) | 0xab00_0000);
            assert!(short.cross(v).length() < 1e-3 && short.dot(v) > 0.0, "{v} became {short}");
        }
    }

    #[test]
    fn frames_are_right_handed() {
        for n in directions() {
            let (t, b) = basis(n);
            assert!((t.cross(b) - n).length() < 1e-6 && t.dot(b).abs() < 1e-6, "{n}");
        }
    }

    #[test]
    fn unorm16_round_trip() {
        for i in 0..=100_000 {
            let x = i as f32 / 100_000.0;
            assert!((unpack_unorm16(pack_unorm16(x)) - x).abs() <= 0.51 / 65535.0);
        }
        assert_eq!((pack_unorm16(-1.0), pack_unorm16(2.0), pack_unorm16(f32::NAN)), (0, 65535, 0));
    }

    #[test]
    fn ratios_are_finite() {
        for n in [0.0, 1.0, -1.0, f32::MAX, f32::INFINITY, f32::NAN, f32::MIN_POSITIVE] {
            for d in [0.0, -1.0, 1e-45, f32::MIN_POSITIVE, 1.0, f32::INFINITY, f32::NAN] {
                assert!(safe_ratio(n, d).is_finite(), "{n} / {d}");
            }
        }
        assert_eq!(safe_ratio(6.0, 3.0), 2.0);
    }

    #[test]
    fn normalize_has_no_scale() {
        for scale in [1e-38, 1e-20, 1.0, 1e20, 1e38] {
            let n = normalize_or(Vec3::new(1.0, -2.0, 2.0) * scale, Vec3::Y);
            assert!((n - Vec3::new(1.0, -2.0, 2.0) / 3.0).length() < 1e-6, "scale {scale}: {n}");
        }
        assert_eq!(normalize_or(Vec3::ZERO, Vec3::Y), Vec3::Y);
        assert_eq!(normalize_or(Vec3::splat(f32::NAN), Vec3::Y), Vec3::Y);
    }

    /// A point computed in f32 from a triangle's corners lies off its plane by rounding; the offset must exceed that
    /// (the error in f64) for triangles up to 16 times the magnitude, at any scale and place.
    #[test]
    fn offsets_exceed_the_error_of_a_computed_point() {
        let mut rng = crate::rng::Rng::new(glam::UVec2::ZERO, 0, 0, crate::rng::Stream::Initial, 0);
        for i in 0..200_000 {
            let mut point = || {
                let r = rng.next_u32x4();
                Vec3::new(r.x as f32, r.y as f32, r.z as f32) / 4_294_967_296.0 - 0.5
            };
            let scale = 10f32.powi(i % 11 - 5);
            let corners = [point(), point(), point()].map(|p| p * 16.0 * scale);
            let b = point().abs();
            let p = corners[0] + b.x * (corners[1] - corners[0]) + b.y * (corners[2] - corners[0]);
            let [a, e1, e2] =
                [corners[0], corners[1] - corners[0], corners[2] - corners[0]].map(|v| v.as_dvec3());
            let normal = e1.cross(e2).normalize();
            let error = (p.as_dvec3() - a).dot(normal).abs();
            let moved = offset_ray_origin(p, normal.as_vec3(), scale, f32::MAX).as_dvec3();
            let height = (moved - a).dot(normal);
            assert!(height > error, "{p} is off by {error} and rises to {height} only");
            assert!(
                height <= f64::from(p.abs().max_element().max(scale)) / 30_000.0,
                "needlessly far: {height}"
            );
        }
    }
}
