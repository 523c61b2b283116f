//! From radiance to display.

use glam::Vec3;
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float;

/// Display value (sRGB-encoded, 0..=1) of `radiance` (nit, linear Rec. 709) under `exposure` (1/nit).
/// Curve: Khronos PBR Neutral (Khronos 2024), which leaves colors below 0.76 as they are.
pub fn display(radiance: Vec3, exposure: f32) -> Vec3 {
    encode(neutral(radiance.max(Vec3::ZERO) * exposure))
}

/// sRGB-encoded, 0..=1, of a linear color.
pub fn encode(color: Vec3) -> Vec3 {
    Vec3::new(srgb(color.x), srgb(color.y), srgb(color.z))
}

fn neutral(color: Vec3) -> Vec3 {
    const START_COMPRESSION: f32 = 0.8 - 0.04;
    const DESATURATION: f32 = 0.15;
    let x = color.min_element();
    let offset = if x < 0.08 { x - 6.25 * x * x } else { 0.04 };
    let color = color - offset;
    let peak = color.max_element();
    if peak < START_COMPRESSION {
        return color;
    }
    let d = 1.0 - START_COMPRESSION;
    let new_peak = 1.0 - d * d / (peak + d - START_COMPRESSION);
    let color = color * (new_peak / peak);
    let g = 1.0 - 1.0 / (DESATURATION * (peak - new_peak) + 1.0);
    color.lerp(Vec3::splat(new_peak), g)
}

/// Linear -> sRGB (IEC 61966-2-1).
fn srgb(x: f32) -> f32 {
    if x <= 0.003_130_8 { 12.92 * x.max(0.0) } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 }
}

/// 8 bits a channel, red lowest, opaque.
pub fn pack_rgba8(color: Vec3) -> u32 {
    let byte = |x: f32| (x.clamp(0.0, 1.0) * 255.0 + 0.5) as u32;
    byte(color.x) | byte(color.y) << 8 | byte(color.z) << 16 | 0xff00_0000
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn black_white_and_grey() {
        assert_eq!(pack_rgba8(display(Vec3::ZERO, 1.0)), 0xff00_0000);
        // Values under 0.76 only lose the Fresnel offset of 4 %: 0.5 -> 0.46 -> sRGB 0.7086.
        assert!((display(Vec3::splat(0.5), 1.0) - Vec3::splat(0.7086)).abs().max_element() < 1e-3);
        let white = display(Vec3::splat(1e9), 1.0);
        assert!(white.min_element() > 0.99 && white.max_element() <= 1.0);
    }

    #[test]
    fn brighter_is_never_darker() {
        let mut last = Vec3::ZERO;
        for i in 0..2000 {
            let shown = display(Vec3::new(1.0, 0.5, 0.2) * 1.01f32.powi(i - 1000), 1.0);
            assert!(shown.cmpge(last - 1e-6).all() && shown.is_finite(), "step {i}: {shown} after {last}");
            last = shown;
        }
    }
}
