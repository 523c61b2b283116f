//! Maps of numbers as pictures, with a legend.

use candela::error::Result;
use candela::image_io;
use glam::{UVec2, Vec3};
use shared::tonemap::pack_rgba8;
use std::path::Path;

/// How values become colors.
#[derive(Clone, Copy, Debug)]
pub struct Scale {
    pub low: f32,
    pub high: f32,
    /// Colors at equal distances from `low` to `high`, sRGB 0..=255.
    pub colors: &'static [[u8; 3]],
    /// Under the left end, the middle and the right end: capital letters, digits, `.`, `-`, `+`, blanks.
    pub labels: [&'static str; 3],
}

/// FLIP's errors: black is none.
pub const FLIP: Scale = Scale {
    low: 0.0,
    high: 1.0,
    colors: &[[0, 0, 4], [59, 15, 112], [140, 41, 129], [222, 73, 104], [254, 159, 109], [252, 253, 191]],
    labels: ["0", "FLIP 0.5", "1"],
};

/// 2(x - y)/(x + y): blue is too dark, red is too bright.
pub const SIGNED: Scale = Scale {
    low: -2.0,
    high: 2.0,
    colors: &[[33, 102, 172], [146, 197, 222], [247, 247, 247], [244, 165, 130], [178, 24, 43]],
    labels: ["-2 DARK", "0", "BRIGHT +2"],
};

const LEGEND_HEIGHT: u32 = 22;

/// Writes `values` (rows from the top) as a PNG with the scale under it.
pub fn write_png(path: &Path, size: UVec2, values: &[f32], scale: &Scale) -> Result<()> {
    let (whole, pixels) = draw(size, values, scale);
    image_io::write_png(path, whole, &pixels)
}

/// The picture with its legend, and its size.
fn draw(size: UVec2, values: &[f32], scale: &Scale) -> (UVec2, Vec<u32>) {
    let mut pixels: Vec<u32> = values.iter().map(|&v| scale.color(v)).collect();
    let whole = size + UVec2::new(0, LEGEND_HEIGHT);
    pixels.resize((whole.x * whole.y) as usize, WHITE);
    for y in size.y + 1..size.y + 9 {
        for x in 0..size.x {
            let t = x as f32 / (size.x - 1).max(1) as f32;
            pixels[(y * whole.x + x) as usize] = scale.color(scale.low + t * (scale.high - scale.low));
        }
    }
    let [left, middle, right] = scale.labels;
    let y = size.y + 10;
    write_text(&mut pixels, whole, UVec2::new(1, y), left);
    let center = (size.x / 2).saturating_sub(text_width(middle) / 2);
    write_text(&mut pixels, whole, UVec2::new(center, y), middle);
    write_text(&mut pixels, whole, UVec2::new(size.x.saturating_sub(text_width(right) + 1), y), right);
    (whole, pixels)
}

impl Scale {
    fn color(&self, value: f32) -> u32 {
        pack_rgba8(self.rgb(value))
    }

    /// The color of `value`, sRGB 0..=1; beyond the ends, the ends'.
    pub fn rgb(&self, value: f32) -> Vec3 {
        let steps = (self.colors.len() - 1) as f32;
        let t = ((value - self.low) / (self.high - self.low)).clamp(0.0, 1.0) * steps;
        let i = (t as usize).min(self.colors.len() - 2);
        let [a, b] = [i, i + 1].map(|i| Vec3::from(self.colors[i].map(f32::from)));
        a.lerp(b, t - i as f32) / 255.0
    }
}

const BLACK: u32 = 0xff00_0000;
const WHITE: u32 = 0xffff_ffff;
/// Side of a dot of the letters, pixels.
const DOT: u32 = 2;

fn text_width(text: &str) -> u32 {
    4 * DOT * text.len() as u32
}

fn write_text(pixels: &mut [u32], size: UVec2, at: UVec2, text: &str) {
    for (i, letter) in text.chars().enumerate() {
        let dots = glyph(letter);
        for bit in (0..15u32).filter(|bit| dots >> (14 - bit) & 1 == 1) {
            let corner = at + DOT * UVec2::new(4 * i as u32 + bit % 3, bit / 3);
            for (x, y) in (0..DOT).flat_map(|y| (0..DOT).map(move |x| (x, y))) {
                let p = corner + UVec2::new(x, y);
                if p.x < size.x && p.y < size.y {
                    pixels[(p.y * size.x + p.x) as usize] = BLACK;
                }
            }
        }
    }
}

/// Letters of 3 x 5 dots, rows from the top, the highest bit first.
fn glyph(letter: char) -> u16 {
    match letter {
        '0' => 0b111_101_101_101_111,
        '1' => 0b010_110_010_010_111,
        '2' => 0b110_001_010_100_111,
        '5' => 0b111_100_110_001_110,
        'A' => 0b010_101_111_101_101,
        'B' => 0b110_101_110_101_110,
        'D' => 0b110_101_101_101_110,
        'F' => 0b111_100_110_100_100,
        'G' => 0b011_100_101_101_011,
        'H' => 0b101_101_111_101_101,
        'I' => 0b111_010_010_010_111,
        'K' => 0b101_101_110_101_101,
        'L' => 0b100_100_100_100_111,
        'P' => 0b110_101_110_100_100,
        'R' => 0b110_101_110_101_101,
        'T' => 0b111_010_010_010_010,
        '.' => 0b000_000_000_000_010,
        '-' => 0b000_000_111_000_000,
        '+' => 0b000_010_111_010_000,
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_have_the_scales_colors() {
        let (size, pixels) = draw(UVec2::new(4, 1), &[-9.0, 0.0, 2.0, f32::NAN], &SIGNED);
        assert_eq!(size, UVec2::new(4, 1 + LEGEND_HEIGHT));
        let rgb = |i: usize| pixels[i].to_le_bytes()[..3].to_vec();
        assert_eq!((rgb(0), rgb(1), rgb(2)), (vec![33, 102, 172], vec![247; 3], vec![178, 24, 43]));
        // The bar of the legend has the same ends.
        assert_eq!((rgb(2 * 4), rgb(2 * 4 + 3)), (rgb(0), rgb(2)));
    }

    #[test]
    fn every_label_can_be_written() {
        for label in [FLIP, SIGNED].iter().flat_map(|s| s.labels) {
            assert!(label.chars().all(|c| c == ' ' || glyph(c) != 0), "{label}");
        }
    }
}
