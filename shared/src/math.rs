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
    // The comparisons are false for NaN, so a NaN operand gives 0 as well.
    if denominator > 0.0 {
        let quotient = numerator / denominator;
        if quotient.abs() <= f32::MAX { quotient } else { 0.0 }
    } else {
        0.0
    }
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

/// 0..=65535 nearest to `x` in [0, 1]; error of the round trip <= 0.5/65535.
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
    let p = v / (v.x.abs() + v.y.abs() + v.z.abs());
    let folded = if p.z >= 0.0 {
        Vec2::new(p.x, p.y)
    } else {
        Vec2::new((1.0 - p.y.abs()) * sign_not_zero(p.x), (1.0 - p.x.abs()) * sign_not_zero(p.y))
    };
    pack_snorm16(folded.x) | pack_snorm16(folded.y) << 16
}

/// The unit vector that [`pack_direction`] packed.
pub fn unpack_direction(bits: u32) -> Vec3 {
    let x = unpack_snorm16(bits);
    let y = unpack_snorm16(bits >> 16);
    let z = 1.0 - x.abs() - y.abs();
    let fold = (-z).max(0.0);
    Vec3::new(x - fold * sign_not_zero(x), y - fold * sign_not_zero(y), z).normalize()
}

/// Moves a ray's end off a surface, along its geometric normal (unit, on the ray's side), so that rounding
/// can't make the ray hit that same surface (Wächter & Binder 2019, "A Fast and Robust Method for Avoiding
/// Self-Intersection": 256 ulp of the position, 1/65536 near the origin).
///
/// `magnitude` is the largest number that the position was computed from beside itself (for a primary hit
/// the distance to the camera): its rounding is part of the position's error, so it sets the ulp as well.
pub fn offset_ray_origin(position: Vec3, normal: Vec3, magnitude: f32) -> Vec3 {
    Vec3::new(
        offset_coordinate(position.x, normal.x, magnitude),
        offset_coordinate(position.y, normal.y, magnitude),
        offset_coordinate(position.z, normal.z, magnitude),
    )
}

fn offset_coordinate(position: f32, normal: f32, magnitude: f32) -> f32 {
    const ORIGIN: f32 = 1.0 / 32.0;
    const FLOAT_SCALE: f32 = 1.0 / 65536.0;
    const INT_SCALE: f32 = 256.0;
    if position.abs() < magnitude {
        // The same step in ulps, taken at `magnitude`: 256 ulp lie between 2^-16 and 2^-15 of a number.
        return position + normal * FLOAT_SCALE * magnitude.max(ORIGIN);
    }
    if position.abs() < ORIGIN {
        return position + FLOAT_SCALE * normal;
    }
    let steps = (INT_SCALE * normal) as i32;
    let toward = if position < 0.0 { -steps } else { steps };
    f32::from_bits((position.to_bits() as i32).wrapping_add(toward) as u32)
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
        }
    }

    #[test]
    fn unorm16_round_trip() {
        for i in 0..=100_000 {
            let x = i as f32 / 100_000.0;
            assert!((unpack_unorm16(pack_unorm16(x)) - x).abs() <= 0.5001 / 65535.0);
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

    #[test]
    fn offsets_leave_the_surface_by_a_bounded_number_of_ulps() {
        for p in [0.0f32, 0.01, 1.0, -7.5, 1e3, -1e5] {
            for n in [-1.0f32, -0.3, 0.3, 1.0] {
                for magnitude in [0.0, 1.0, 1e4] {
                    let moved = offset_coordinate(p, n, magnitude) - p;
                    let scale = p.abs().max(magnitude).max(1.0 / 32.0);
                    assert!(moved * n > 0.0, "{p} + {n} at {magnitude} did not move outward: {moved}");
                    assert!(
                        moved.abs() <= scale * n.abs() / 32767.0 * 1.01 + scale * f32::EPSILON,
                        "{p} {n}: {moved}"
                    );
                }
            }
        }
    }
}
