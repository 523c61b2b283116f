//! Light whose color counts more than its strength.

use crate::math::luminance;
use glam::Vec3;

/// Steps of the greatest channel's power of two.
const STEPS: f32 = 262_144.0;

/// Three channels of 18 bits under one exponent of 8 bits: errors are below 4e-6 of the greatest channel. Nothing negative.
pub fn pack_color(color: Vec3) -> [u32; 2] {
    let most = color.max_element();
    let exponent = most.to_bits() >> 23;
    // Denormal or 0; infinite, not a number, or negative.
    if exponent == 0 || exponent >= 255 {
        return [0; 2];
    }
    // 2^(exponent - 126) is more than any channel.
    let step = |x: f32| ((x / power(exponent) * (0.5 * STEPS) + 0.5) as u32).min(STEPS as u32 - 1);
    let (r, g, b) = (step(color.x), step(color.y), step(color.z));
    [r | g << 18, g >> 14 | b << 4 | exponent << 22]
}

/// The color that [`pack_color`] packed.
pub fn unpack_color([low, high]: [u32; 2]) -> Vec3 {
    let exponent = high >> 22 & 0xff;
    if exponent == 0 {
        return Vec3::ZERO;
    }
    let mask = STEPS as u32 - 1;
    let channels = [low & mask, (low >> 18 | high << 14) & mask, high >> 4 & mask];
    Vec3::new(channels[0] as f32, channels[1] as f32, channels[2] as f32) * (power(exponent) / (0.5 * STEPS))
}

/// 2^(exponent - 127)
fn power(exponent: u32) -> f32 {
    f32::from_bits(exponent << 23)
}

/// Light of `luminance` (nit) and the color of `color`; where that has none, of `fallback`.
pub fn colored(light: f32, color: Vec3, fallback: Vec3) -> Vec3 {
    let of_color = luminance(color);
    if of_color > 0.0 { color * (light / of_color) } else { fallback }
}
