//! Means in closed form against a sampler of our own and plain quadrature.

use super::*;
use crate::scene::{Filter, Image};
use shared::rng::{Rng, Stream};
use std::sync::Arc;

const SIZE: UVec2 = UVec2::new(5, 3);
const WRAPS: [Wrap; 3] = [Wrap::Repeat, Wrap::MirroredRepeat, Wrap::ClampToEdge];

fn byte(x: u32, y: u32) -> u8 {
    ((x * 83 + y * 151 + x * y * 29) % 256) as u8
}

fn texture(wrap: [Wrap; 2], linear: bool) -> Texture {
    let texels = (0..SIZE.x * SIZE.y).flat_map(|i| [byte(i % SIZE.x, i / SIZE.x), 255, 0, 255]).collect();
    let image = Image { name: String::new(), width: SIZE.x, height: SIZE.y, texels };
    Texture {
        image: Arc::new(image),
        srgb: false,
        wrap,
        filter: if linear { Filter::LINEAR } else { Filter::NEAREST },
    }
}

/// Red of the texture at `uv`, by the formulas of Vulkan 1.2, sections "Unnormalized Texel Coordinate Operations" to
/// "Texel Filtering".
fn sample(texture: &Texture, uv: DVec2) -> f64 {
    let texel = |i: f64, j: f64| {
        let place = |i: f64, n: u32, wrap: Wrap| {
            let n = f64::from(n);
            let wrapped = match wrap {
                Wrap::Repeat => i - n * (i / n).floor(),
                // (size - 1) - mirror((i mod 2 size) - size), mirror(x) = x >= 0 ? x : -(1 + x)
                Wrap::MirroredRepeat => {
                    let x = i - 2.0 * n * (i / (2.0 * n)).floor() - n;
                    n - 1.0 - if x >= 0.0 { x } else { -(1.0 + x) }
                }
                Wrap::ClampToEdge => i.max(0.0).min(n - 1.0),
            };
            wrapped as u32
        };
        f64::from(byte(place(i, SIZE.x, texture.wrap[0]), place(j, SIZE.y, texture.wrap[1]))) / 255.0
    };
    let p = uv * SIZE.as_dvec2();
    if !texture.filter.magnify_linear {
        return texel(p.x.floor(), p.y.floor());
    }
    let p = p - 0.5;
    let (i, f) = (p.floor(), p - p.floor());
    let row = |j: f64| texel(i.x, j) * (1.0 - f.x) + texel(i.x + 1.0, j) * f.x;
    row(i.y) * (1.0 - f.y) + row(i.y + 1.0) * f.y
}

/// Midpoints of n² congruent triangles.
fn quadrature(texture: &Texture, [a, b, c]: [DVec2; 3], n: u32) -> f64 {
    let mut sum = 0.0;
    for i in 0..n {
        for j in 0..n - i {
            let at = |s: f64, t: f64| {
                let (s, t) = ((f64::from(i) + s) / f64::from(n), (f64::from(j) + t) / f64::from(n));
                sample(texture, a + s * (b - a) + t * (c - a))
            };
            sum += at(1.0 / 3.0, 1.0 / 3.0);
            if j + 1 < n - i {
                sum += at(2.0 / 3.0, 2.0 / 3.0);
            }
        }
    }
    sum / f64::from(n * n)
}

#[test]
fn means_equal_quadrature() {
    let mut rng = Rng::new(UVec2::new(3, 4), 0, 0, Stream::Initial, 0);
    let mut worst_planted = 0f64;
    for wrap in WRAPS.into_iter().flat_map(|u| WRAPS.map(|v| [u, v])) {
        for linear in [false, true] {
            let texture = texture(wrap, linear);
            let map = RadianceMap::new(&texture, Vec3::new(1.0, 1.0, 1.0));
            for size in [0.1, 0.7, 4.0] {
                let mut point = || DVec2::new(rng.next_f32().into(), rng.next_f32().into());
                let middle = point() * 4.0 - 2.0;
                let uvs = [(); 3].map(|()| middle + (point() - 0.5) * size);
                let (mean, expected) = (map.measure(uvs).mean.x, quadrature(&texture, uvs, 400));
                // Nearest texels jump: midpoints miss a share of the edges.
                let limit = if linear { 1e-4 } else { 5e-3 };
                assert!((mean - expected).abs() < limit, "{wrap:?} {linear} {size}: {mean}, not {expected}");
                // Planted: half a texel aside.
                let aside = uvs.map(|uv| uv + 0.5 / SIZE.as_dvec2());
                worst_planted = worst_planted.max((map.measure(aside).mean.x - expected).abs());
            }
        }
    }
    assert!(worst_planted > 0.05, "half a texel aside was not seen: {worst_planted}");
}

/// Bounds hold everywhere in the triangle, and are not far off.
#[test]
fn bounds_hold() {
    let texture = texture([Wrap::Repeat; 2], true);
    let map = RadianceMap::new(&texture, Vec3::X);
    let uvs = [DVec2::new(0.1, 0.2), DVec2::new(0.9, 0.3), DVec2::new(0.4, 1.1)];
    let measure = map.measure(uvs);
    let red = f64::from(luminance(Vec3::X));
    let (mut least, mut most) = (f64::INFINITY, 0f64);
    for i in 0..100 {
        for j in 0..100 - i {
            let at =
                uvs[0] + f64::from(i) / 99.0 * (uvs[1] - uvs[0]) + f64::from(j) / 99.0 * (uvs[2] - uvs[0]);
            let value = red * sample(&texture, at);
            (least, most) = (least.min(value), most.max(value));
        }
    }
    assert!(f64::from(measure.least) <= least + 1e-6 && f64::from(measure.most) >= most - 1e-6);
}

/// Palettes: a triangle whose corners all lie on one place, or on a line.
#[test]
fn triangles_without_an_area_on_the_texture() {
    for linear in [false, true] {
        let texture = texture([Wrap::Repeat; 2], linear);
        let map = RadianceMap::new(&texture, Vec3::ONE);
        let at = DVec2::new(0.33, 0.7);
        let point = map.measure([at; 3]);
        assert!((point.mean.x - sample(&texture, at)).abs() < 1e-3 && !point.divisible);
        let line = [at, at + DVec2::new(0.8, 0.0), at + DVec2::new(0.3, 0.0)];
        let (mean, expected) = (map.measure(line).mean.x, quadrature(&texture, line, 400));
        assert!((mean - expected).abs() < 5e-3, "{mean}, not {expected}");
    }
}

#[test]
fn odd_coordinates_end() {
    for wrap in WRAPS {
        for linear in [false, true] {
            let texture = texture([wrap; 2], linear);
            let map = RadianceMap::new(&texture, Vec3::ONE);
            for x in [1e9, 3e38, 0.0] {
                for y in [1e9, -3e38, 1e-30] {
                    let mean = map.measure([DVec2::ZERO, DVec2::new(x, 0.0), DVec2::new(0.0, y)]).mean;
                    assert!((0.0..=1.0).contains(&mean.x), "{wrap:?} {x} {y}: {mean}");
                }
            }
        }
    }
}

#[test]
fn decoding_follows_the_standard() {
    // IEC 61966-2-1: 188 is 0.5029 linear.
    assert!((srgb_to_linear(188.0 / 255.0) - 0.502_886).abs() < 1e-5);
    assert!((srgb_to_linear(0.04) - 0.04 / 12.92).abs() < 1e-12);
}
