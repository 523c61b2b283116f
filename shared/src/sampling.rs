//! Warps from the unit square: with their inverses.

use glam::{Vec2, Vec3};
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float;

/// Unit square -> barycentric coordinates (b1, b2) of a triangle's second and third vertex, uniform over its
/// area (Turk 1990). b1, b2 >= 0; b1 + b2 <= 1 up to one ulp, which is why nobody takes a root of 1 - b1 - b2.
pub fn square_to_triangle(uv: Vec2) -> Vec2 {
    let root = uv.x.sqrt();
    Vec2::new(root * (1.0 - uv.y), root * uv.y)
}

/// The inverse of [`square_to_triangle`]; (0, 0) at the first vertex, where it is not unique.
pub fn triangle_to_square(barycentrics: Vec2) -> Vec2 {
    let root = barycentrics.x + barycentrics.y;
    Vec2::new((root * root).min(1.0), crate::math::safe_ratio(barycentrics.y, root).min(1.0))
}

/// Unit square -> unit disk, uniform over its area.
pub fn square_to_disk(uv: Vec2) -> Vec2 {
    let angle = core::f32::consts::TAU * uv.y - core::f32::consts::PI;
    let radius = uv.x.sqrt();
    Vec2::new(radius * angle.cos(), radius * angle.sin())
}

/// Unit square -> directions with z above `least`, uniform over their solid angle.
pub fn cap_direction(least: f32, uv: Vec2) -> Vec3 {
    let z = 1.0 - uv.x * (1.0 - least);
    let angle = core::f32::consts::TAU * uv.y - core::f32::consts::PI;
    let radius = ((1.0 - z) * (1.0 + z)).max(0.0).sqrt();
    Vec3::new(radius * angle.cos(), radius * angle.sin(), z)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(n: usize) -> impl Iterator<Item = Vec2> {
        (0..n * n).map(move |i| Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32)
    }

    #[test]
    fn triangle_map_is_inverted() {
        for uv in grid(100) {
            assert!((triangle_to_square(square_to_triangle(uv)) - uv).length() < 1e-5, "{uv}");
        }
        assert_eq!(triangle_to_square(Vec2::ZERO), Vec2::ZERO);
    }

    /// Moments of the uniform triangle in closed form: E[b_i] = 1/3, E[b_i²] = 1/6, E[b1 b2] = 1/12.
    /// Midpoint grid of 400 x 400: its own error is below 1e-4 (the root's singularity at 0).
    #[test]
    fn triangle_is_covered_evenly() {
        let n = 400usize;
        let mut moments = [0.0f64; 5];
        for b in grid(n).map(square_to_triangle).map(|b| b.as_dvec2()) {
            for (m, x) in moments.iter_mut().zip([b.x, b.y, b.x * b.x, b.y * b.y, b.x * b.y]) {
                *m += x / (n * n) as f64;
            }
        }
        for (m, exact) in moments.iter().zip([1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0, 1.0 / 6.0, 1.0 / 12.0]) {
            assert!((m - exact).abs() < 1e-4, "{m} is not {exact}");
        }
    }

    /// Moments of the uniform disk: E[r²] = 1/2, E[x] = E[y] = 0, E[x²] = 1/4.
    #[test]
    fn disk_is_covered_evenly() {
        let n = 400usize;
        let points: Vec<_> = grid(n).map(square_to_disk).map(|p| p.as_dvec2()).collect();
        let mean =
            |f: fn(glam::DVec2) -> f64| points.iter().map(|&p| f(p)).sum::<f64>() / points.len() as f64;
        assert!((mean(|p| p.length_squared()) - 0.5).abs() < 1e-4);
        assert!((mean(|p| p.x * p.x) - 0.25).abs() < 1e-4);
        assert!(mean(|p| p.x).abs() < 1e-4 && mean(|p| p.y).abs() < 1e-4);
    }
}
