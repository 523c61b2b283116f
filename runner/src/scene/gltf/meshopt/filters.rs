//! Filters (appendix B): from elements of a decoded stream to attributes.

use super::Filter;
use std::f32::consts::FRAC_1_SQRT_2;

/// Turns elements of `stride` bytes into what they stand for.
pub fn apply(filter: Filter, stride: usize, bytes: &mut [u8]) {
    match filter {
        Filter::None => {}
        Filter::Octahedral if stride == 4 => {
            bytes.as_chunks_mut::<4>().0.iter_mut().for_each(|v| {
                let [x, y, z] = octahedral([v[0], v[1], v[2]].map(|x| f32::from(x as i8)), 127.0);
                (v[0], v[1], v[2]) = (x as i8 as u8, y as i8 as u8, z as i8 as u8);
            });
        }
        Filter::Octahedral => words(bytes, |[x, y, one, w]| {
            let [x, y, z] = octahedral([x, y, one].map(|x| f32::from(x as i16)), 32767.0);
            [x as i16 as u16, y as i16 as u16, z as i16 as u16, w]
        }),
        Filter::Quaternion => words(bytes, quaternion),
        Filter::Exponential => bytes.as_chunks_mut::<4>().0.iter_mut().for_each(|v| {
            let word = i32::from_le_bytes(*v);
            let (exponent, mantissa) = (word >> 24, word << 8 >> 8);
            // Exact in f64: 24 bits times a power of two.
            *v = ((f64::from(mantissa) * f64::from(exponent).exp2()) as f32).to_le_bytes();
        }),
        Filter::Color if stride == 4 => {
            bytes.as_chunks_mut::<4>().0.iter_mut().for_each(|v| {
                let [y, co, cg, a] = *v;
                let signed = |x: u8| i32::from(x as i8);
                *v = color([i32::from(y), signed(co), signed(cg), i32::from(a)], 255.0).map(|x| x as u8);
            });
        }
        Filter::Color => words(bytes, |[y, co, cg, a]| {
            let signed = |x: u16| i32::from(x as i16);
            color([i32::from(y), signed(co), signed(cg), i32::from(a)], 65535.0).map(|x| x as u16)
        }),
    }
}

/// Applies `f` to each four 16-bit words.
fn words(bytes: &mut [u8], f: impl Fn([u16; 4]) -> [u16; 4]) {
    for element in bytes.as_chunks_mut::<8>().0 {
        let word = |i: usize| u16::from_le_bytes([element[2 * i], element[2 * i + 1]]);
        let [a, b, c, d] = f([word(0), word(1), word(2), word(3)]).map(u16::to_le_bytes);
        *element = [a[0], a[1], b[0], b[1], c[0], c[1], d[0], d[1]];
    }
}

/// A unit vector, times `most`: from two coordinates on the octahedron and what stands for 1 among them (filter 1).
fn octahedral([x, y, one]: [f32; 3], most: f32) -> [f32; 3] {
    let (x, y) = (x / one, y / one);
    let z = 1.0 - x.abs() - y.abs();
    let fold = z.min(0.0);
    let (x, y) = (x - fold.copysign(x), y - fold.copysign(y));
    let length = (x * x + y * y + z * z).sqrt();
    [x, y, z].map(|v| (v / length * most).round())
}

/// A unit quaternion from its three smaller components; the fourth word says which is missing, and what 1 is (filter 2).
fn quaternion([x, y, z, w]: [u16; 4]) -> [u16; 4] {
    let one = f32::from((w | 3) as i16);
    let [x, y, z] = [x, y, z].map(|v| f32::from(v as i16) / one * FRAC_1_SQRT_2);
    let largest = (1.0 - x * x - y * y - z * z).max(0.0).sqrt();
    let place = usize::from(w & 3);
    let mut output = [0; 4];
    for (i, v) in [largest, x, y, z].into_iter().enumerate() {
        output[(place + i) % 4] = (v * 32767.0).round() as i16 as u16;
    }
    output
}

/// RGBA up to `most` from luma, two differences and alpha, whose highest bit says how many bits all have (filter 4).
fn color([y, co, cg, a]: [i32; 4], most: f32) -> [f32; 4] {
    let bits = 32 - a.leading_zeros();
    let full = (1 << bits) - 1;
    let alpha = a & (full >> 1);
    let alpha = alpha << 1 | alpha & 1;
    [y + co - cg, y + cg, y - co - cg, alpha].map(|v| (v as f32 * (most / full as f32)).round())
}
