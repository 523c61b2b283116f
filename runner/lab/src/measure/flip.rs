//! LDR-FLIP: how different two pictures look when a viewer flips between them (Andersson et al. 2020). The section numbers
//! are the paper's.
//!
//! Own code after the paper rather than its authors' program: that is C++, and building this program would then need a C++
//! compiler on every user's machine. Its numbers are the test's reference (tools/flip_reference.py).

use glam::{DVec3, Mat3, UVec2, Vec3};
use std::f64::consts::PI;

/// A 0.7 m wide 4K monitor seen from 0.7 m (section 3).
pub const PIXELS_PER_DEGREE: f64 = 0.7 * 3840.0 / 0.7 * PI / 180.0;

/// Exponents and points of sections 4.2 and 5.
const COLOR_EXPONENT: f32 = 0.7;
const FEATURE_EXPONENT: f32 = 0.5;
const BREAK_FRACTION: f32 = 0.4;
const BREAK_ERROR: f32 = 0.95;
/// Width of the feature detectors, degrees.
const FEATURE_WIDTH: f64 = 0.082;

/// The error of each pixel, 0..=1, between two pictures of display values (sRGB-encoded, 0..=1), rows from the top.
pub fn map(reference: &[Vec3], test: &[Vec3], size: UVec2, pixels_per_degree: f64) -> Vec<f32> {
    let pictures = [reference, test].map(|p| {
        let pixels = each(p, |&c| opponent(linear(c)));
        Plane { pixels, width: size.x as usize, height: size.y as usize }
    });
    let seen = pictures.each_ref().map(|p| perceived(p, pixels_per_degree));
    let features = pictures.each_ref().map(|p| features(p, pixels_per_degree));
    let most = color_range();
    let mut errors = vec![0.0; reference.len()];
    in_rows(&mut errors, size.x as usize, |y, row| {
        for (x, error) in row.iter_mut().enumerate() {
            let i = y * size.x as usize + x;
            let color = redistribute(hyab(seen[0][i], seen[1][i]).powf(COLOR_EXPONENT), most);
            let (a, b) = (features[0][i], features[1][i]);
            let feature = (a.edge - b.edge).abs().max((a.point - b.point).abs());
            let feature = (feature * std::f32::consts::FRAC_1_SQRT_2).powf(FEATURE_EXPONENT);
            *error = color.powf(1.0 - feature.min(1.0));
        }
    });
    errors
}

/// Strength of edges and points at a pixel (section 4.3).
#[derive(Clone, Copy, Default)]
struct Feature {
    edge: f32,
    point: f32,
}

struct Plane {
    pixels: Vec<Vec3>,
    width: usize,
    height: usize,
}

impl Plane {
    /// Each pixel of the separable filter `weights`(x) `weights`(y), a weight a channel; what is outside repeats the border.
    fn filtered(&self, across: &[Vec3], down: &[Vec3]) -> Plane {
        self.pass(across, |x, y, d| (clamped(x, d, self.width), y))
            .pass(down, |x, y, d| (x, clamped(y, d, self.height)))
    }

    fn pass(&self, weights: &[Vec3], at: impl Fn(usize, usize, isize) -> (usize, usize) + Sync) -> Plane {
        let radius = weights.len() as isize / 2;
        let mut pixels = vec![Vec3::ZERO; self.pixels.len()];
        in_rows(&mut pixels, self.width, |y, row| {
            for (x, out) in row.iter_mut().enumerate() {
                for (&w, d) in weights.iter().zip(-radius..) {
                    let (sx, sy) = at(x, y, d);
                    *out += w * self.pixels[sy * self.width + sx];
                }
            }
        });
        Plane { pixels, ..*self }
    }
}

fn clamped(at: usize, by: isize, length: usize) -> usize {
    (at as isize + by).clamp(0, length as isize - 1) as usize
}

/// What the eye makes of a picture at this distance: contrast sensitivity (section 4.1), then Hunt-adjusted L*a*b*.
fn perceived(picture: &Plane, pixels_per_degree: f64) -> Vec<Vec3> {
    // Sums of Gaussians, table 1: amplitude and width of the achromatic, red-green, blue-yellow channels.
    const A: [DVec3; 2] = [DVec3::new(1.0, 1.0, 34.1), DVec3::new(0.0, 0.0, 13.5)];
    const B: [DVec3; 2] = [DVec3::new(0.0047, 0.0053, 0.04), DVec3::new(1e-5, 1e-5, 0.025)];
    let radius = (3.0 * (0.04 / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil() as i32;
    let gaussian = |b: DVec3| -> Vec<DVec3> {
        let at = |i: i32| DVec3::splat(-(PI * f64::from(i) / pixels_per_degree).powi(2)) / b;
        (-radius..=radius).map(|i| at(i).exp()).collect()
    };
    let parts = B.map(gaussian);
    let sums = parts.each_ref().map(|w| w.iter().copied().sum::<DVec3>());
    let amplitudes =
        [0, 1].map(|i| A[i] * DVec3::from(((DVec3::splat(PI) / B[i]).to_array()).map(f64::sqrt)));
    let total = amplitudes[0] * sums[0] * sums[0] + amplitudes[1] * sums[1] * sums[1];
    let filtered = [0, 1].map(|i| {
        let down: Vec<Vec3> = parts[i].iter().map(|w| w.as_vec3()).collect();
        let scale = amplitudes[i] / total;
        picture.filtered(&parts[i].iter().map(|w| (*w * scale).as_vec3()).collect::<Vec<_>>(), &down).pixels
    });
    let from_xyz = TO_XYZ.inverse();
    let mut seen = vec![Vec3::ZERO; picture.pixels.len()];
    in_rows(&mut seen, picture.width, |y, row| {
        let first = y * picture.width;
        for (i, seen) in (first..).zip(row) {
            *seen = hunt(lab(from_xyz * from_opponent(filtered[0][i] + filtered[1][i])));
        }
    });
    seen
}

/// Edges and points of the achromatic channel (section 4.3).
fn features(picture: &Plane, pixels_per_degree: f64) -> Vec<Feature> {
    let deviation = 0.5 * FEATURE_WIDTH * pixels_per_degree;
    let radius = (3.0 * deviation).ceil() as i32;
    let weights = |of: &dyn Fn(f64) -> f64| -> Vec<f64> {
        let gaussian = |x: f64| (-x * x / (2.0 * deviation * deviation)).exp();
        (-radius..=radius).map(f64::from).map(|x| of(x) * gaussian(x)).collect()
    };
    let smooth = normalized(weights(&|_| 1.0));
    let slope = normalized(weights(&|x| -x));
    let bend = normalized(weights(&|x| x * x / (deviation * deviation) - 1.0));
    // In one filter run: slope and bend along one axis, smooth along the other, in the first two channels.
    let achromatic = Plane {
        pixels: picture.pixels.iter().map(|c| Vec3::splat((c.x + 16.0) / 116.0)).collect(),
        ..*picture
    };
    let detect: Vec<Vec3> = slope.iter().zip(&bend).map(|(&s, &b)| Vec3::new(s, b, 0.0)).collect();
    let blur: Vec<Vec3> = smooth.iter().map(|&w| Vec3::splat(w)).collect();
    let (across, down) = (achromatic.filtered(&detect, &blur), achromatic.filtered(&blur, &detect));
    let strength = |(a, b): (&Vec3, &Vec3)| Feature { edge: a.x.hypot(b.x), point: a.y.hypot(b.y) };
    across.pixels.iter().zip(&down.pixels).map(strength).collect()
}

/// Positive weights sum to 1, negative ones to -1.
fn normalized(weights: Vec<f64>) -> Vec<f32> {
    let sum = |sign: f64| weights.iter().map(|w| (w * sign).max(0.0)).sum::<f64>();
    let (plus, minus) = (sum(1.0), sum(-1.0));
    weights.iter().map(|&w| (w / if w > 0.0 { plus } else { minus.max(f64::MIN_POSITIVE) }) as f32).collect()
}

/// The distance of section 4.2: city block in lightness, Euclidean in chroma.
fn hyab(a: Vec3, b: Vec3) -> f32 {
    let d = a - b;
    d.x.abs() + d.y.hypot(d.z)
}

/// The largest color error: between green and blue.
fn color_range() -> f32 {
    let seen = |c: Vec3| hunt(lab(c));
    hyab(seen(Vec3::Y), seen(Vec3::Z)).powf(COLOR_EXPONENT)
}

/// Small errors take most of the range (section 4.2).
fn redistribute(error: f32, most: f32) -> f32 {
    let at = BREAK_FRACTION * most;
    if error < at {
        BREAK_ERROR / at * error
    } else {
        BREAK_ERROR + (error - at) / (most - at) * (1.0 - BREAK_ERROR)
    }
}

/// Colors fade where it is dark.
fn hunt(lab: Vec3) -> Vec3 {
    Vec3::new(lab.x, 0.01 * lab.x * lab.y, 0.01 * lab.x * lab.z)
}

fn lab(linear: Vec3) -> Vec3 {
    let f = |t: f32| {
        const DELTA: f32 = 6.0 / 29.0;
        if t > DELTA.powi(3) { t.cbrt() } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
    };
    let xyz = TO_XYZ * linear.clamp(Vec3::ZERO, Vec3::ONE) / white();
    let (x, y, z) = (f(xyz.x), f(xyz.y), f(xyz.z));
    Vec3::new(116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z))
}

/// Linear RGB -> Y Cx Cz, the linear opponent space of section 4.1.
fn opponent(linear: Vec3) -> Vec3 {
    let c = TO_XYZ * linear / white();
    Vec3::new(116.0 * c.y - 16.0, 500.0 * (c.x - c.y), 200.0 * (c.y - c.z))
}

/// Y Cx Cz -> XYZ.
fn from_opponent(c: Vec3) -> Vec3 {
    let y = (c.x + 16.0) / 116.0;
    Vec3::new(y + c.y / 500.0, y, y - c.z / 200.0) * white()
}

/// IEC 61966-2-1.
fn linear(encoded: Vec3) -> Vec3 {
    let channel = |c: f32| if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) };
    Vec3::new(channel(encoded.x), channel(encoded.y), channel(encoded.z))
}

/// Linear sRGB -> CIE XYZ (D65).
const TO_XYZ: Mat3 = Mat3::from_cols(
    Vec3::new(0.412_386_57, 0.212_636_82, 0.019_330_62),
    Vec3::new(0.357_591_5, 0.715_183, 0.119_197_16),
    Vec3::new(0.180_450_46, 0.072_180_2, 0.950_372_6),
);

fn white() -> Vec3 {
    TO_XYZ * Vec3::ONE
}

/// `f` of each, on all processors.
fn each<A: Sync, B: Send + Clone + Default>(values: &[A], f: impl Fn(&A) -> B + Sync) -> Vec<B> {
    const BLOCK: usize = 1024;
    let mut results = vec![B::default(); values.len()];
    in_rows(&mut results, BLOCK, |block, row| {
        for (result, value) in row.iter_mut().zip(&values[block * BLOCK..]) {
            *result = f(value);
        }
    });
    results
}

/// Fills `out` row by row on all processors.
fn in_rows<T: Send>(out: &mut [T], width: usize, fill: impl Fn(usize, &mut [T]) + Sync) {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let rows = out.len().div_ceil(width.max(1)).div_ceil(threads).max(1);
    std::thread::scope(|scope| {
        for (block, chunk) in out.chunks_mut(rows * width.max(1)).enumerate() {
            let fill = &fill;
            scope.spawn(move || {
                for (y, row) in chunk.chunks_mut(width.max(1)).enumerate() {
                    fill(block * rows + y, row);
                }
            });
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(serde::Deserialize)]
    struct Fixture {
        pixels_per_degree: f64,
        width: u32,
        height: u32,
        reference: String,
        test: String,
        mean: f64,
        map: Vec<f32>,
    }

    fn picture(hex: &str) -> Vec<Vec3> {
        let byte = |i: usize| u8::from_str_radix(&hex[i..i + 2], 16).unwrap();
        let bytes: Vec<f32> = (0..hex.len()).step_by(2).map(|i| f32::from(byte(i)) / 255.0).collect();
        bytes.chunks_exact(3).map(Vec3::from_slice).collect()
    }

    /// The authors' own program, pixel by pixel; a planted error of one constant is seen.
    #[test]
    fn agrees_with_the_authors_program() {
        let f: Fixture = serde_json::from_str(include_str!("fixtures/flip.json")).unwrap();
        assert!((PIXELS_PER_DEGREE - f.pixels_per_degree).abs() < 1e-4);
        let size = UVec2::new(f.width, f.height);
        let (reference, test) = (picture(&f.reference), picture(&f.test));
        let worst = |ppd: f64| {
            let ours = map(&reference, &test, size, ppd);
            let mean = ours.iter().map(|&e| f64::from(e)).sum::<f64>() / ours.len() as f64;
            let pixel = ours.iter().zip(&f.map).map(|(a, b)| (a - b).abs()).fold(0.0f32, f32::max);
            (pixel, (mean - f.mean).abs())
        };
        let (pixel, mean) = worst(PIXELS_PER_DEGREE);
        assert!(pixel < 1e-3 && mean < 1e-5, "pixels differ by {pixel}, means by {mean}");
        assert!(worst(0.9 * PIXELS_PER_DEGREE).0 > 1e-2);
    }

    #[test]
    fn black_against_white_is_the_worst() {
        let size = UVec2::new(4, 4);
        let map = map(&[Vec3::ZERO; 16], &[Vec3::ONE; 16], size, PIXELS_PER_DEGREE);
        // The paper's scale ends at green against blue, beyond which nothing in gamut goes by much.
        assert!(map.iter().all(|e| *e > 0.95 && *e <= 1.0), "{map:?}");
    }
}
