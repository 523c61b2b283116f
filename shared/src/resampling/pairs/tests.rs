use super::*;
use crate::surface::GBufferTexel;
use bytemuck::Zeroable;
use glam::{UVec2, Vec3};

fn frame(size: UVec2, index: u32, radius: f32) -> FrameConstants {
    let settings = Settings { radius, ..Settings::default() };
    FrameConstants { size, index, seed: 3, settings, ..Zeroable::zeroed() }
}

/// Pixels with a partner, and whether every partner's partner is the pixel itself, another one, near, and inside.
fn are_reciprocal(size: UVec2, reach: u32, partner: impl Fn(UVec2) -> Option<UVec2>) -> (u32, bool) {
    let (mut paired, mut all) = (0, true);
    for pixel in (0..size.y).flat_map(|y| (0..size.x).map(move |x| UVec2::new(x, y))) {
        if let Some(other) = partner(pixel) {
            paired += 1;
            let far = (other.as_ivec2() - pixel.as_ivec2()).abs().max_element() as u32;
            all &= other.cmplt(size).all() && other != pixel && far < reach && partner(other) == Some(pixel);
        }
    }
    (paired, all)
}

/// Negative control: partners that every pixel draws for itself.
#[test]
fn partners_choose_each_other() {
    let cases = [([64, 64], 8.0, 8), ([37, 23], 30.0, 32), ([50, 7], 4.0, 4), ([1, 1], 9.0, 16)];
    for (size, radius, reach) in cases {
        let (size, mut paired) = (UVec2::from(size), 0);
        for index in 0..20 {
            let frame = frame(size, index, radius);
            let (some, all) = are_reciprocal(size, reach, |pixel| partner_of(&frame, pixel, index % 3));
            assert!(all, "{size}, radius {radius}, frame {index}");
            paired += some;
        }
        let pixels = 20 * size.x * size.y;
        assert!(paired * 4 >= pixels || size == UVec2::ONE, "{paired} of {pixels} have partners");
    }
    let (size, frame) = (UVec2::splat(64), frame(UVec2::splat(64), 0, 8.0));
    let alone = |pixel: UVec2| partner_of(&frame, pixel, pixel.x + 64 * pixel.y);
    assert!(!are_reciprocal(size, 8, alone).1, "the planted error was not seen");
}

/// From two random places in a square of side s the distance along an axis is d with mass (s - |d|) / s². Chi-square, 14
/// degrees of freedom, false alarm 1e-4 for each axis (fixed seed); the planted error are partners on one side only.
#[test]
fn partners_lie_all_around() {
    const SIDE: i32 = 8;
    const RUNS: u32 = 40_000;
    const LIMIT: f64 = 42.6;
    let chi2 = |pixel: &dyn Fn(u32) -> UVec2, planted: bool| {
        let mut counts = [[0u32; 15]; 2];
        for index in 0..RUNS {
            // A partner far from the image's edge is missing only where a pixel draws itself.
            let frame = frame(UVec2::splat(256), index, SIDE as f32);
            let pixel = pixel(index);
            let offset = match partner_of(&frame, pixel, 1) {
                Some(other) => other.as_ivec2() - pixel.as_ivec2(),
                None => glam::IVec2::ZERO,
            };
            let offset = if planted { offset.abs() } else { offset };
            counts[0][(offset.x + SIDE - 1) as usize] += 1;
            counts[1][(offset.y + SIDE - 1) as usize] += 1;
        }
        counts.map(|counts| {
            let mass = |i: usize| f64::from(SIDE - (i as i32 - SIDE + 1).abs()) / f64::from(SIDE * SIDE);
            let expected = |i: usize| mass(i) * f64::from(RUNS);
            (0..15).map(|i| (f64::from(counts[i]) - expected(i)).powi(2) / expected(i)).sum::<f64>()
        })
    };
    let fixed = |_| UVec2::new(100, 131);
    let [x, y] = chi2(&fixed, false);
    assert!(x < LIMIT && y < LIMIT, "chi-square {x}, {y}");
    assert!(chi2(&fixed, true).iter().all(|&c| c > LIMIT), "the planted error was not seen");
}

/// Iterations and reservoirs pair anew: chance lets 1 pixel in 256 have one partner in two rounds, cell by cell.
#[test]
fn rounds_differ() {
    let frame = frame(UVec2::splat(64), 0, 16.0);
    let pixels = || (0..64).flat_map(|y| (0..64).map(move |x| UVec2::new(x, y)));
    let both = |p, a, b| partner_of(&frame, p, a).is_some_and(|one| partner_of(&frame, p, b) == Some(one));
    let agree = |a, b| pixels().filter(|&p| both(p, a, b)).count();
    for round in 1..8 {
        assert!(agree(0, round) < 200, "round {round}: {} of 4096", agree(0, round));
    }
    assert!(agree(2, 2) > 2048);
}

/// Both of two pixels take each other for similar, or neither: also where a tenth of the one's distance is more than a
/// tenth of the other's.
#[test]
fn similarity_is_mutual() {
    let texel = |distance: f32, normal: Vec3| GBufferTexel {
        distance: distance.to_bits(),
        normal: crate::math::pack_direction(normal.normalize()),
        ..GBufferTexel::default()
    };
    let settings = Settings::default();
    let (mut alike, mut one_sided) = (0, 0);
    for i in 0..40 {
        for j in 0..40 {
            let at = |i: u32| texel(10.0 + 0.1 * i as f32, Vec3::new(0.02 * i as f32, 1.0, 0.1));
            let (a, b) = (at(i), at(j));
            let similar = are_similar(&settings, &a, &b);
            assert_eq!(similar, are_similar(&settings, &b, &a), "{i} {j}");
            alike += u32::from(similar);
            // What a pixel on its own would say.
            let from = |a: &GBufferTexel, b| super::super::is_similar(&settings, a.distance(), a.normal(), b);
            one_sided += u32::from(from(&a, &b) != from(&b, &a));
        }
    }
    assert!(alike > 400 && one_sided > 0, "{alike} alike, {one_sided} one-sided");
    assert!(
        !are_similar(&settings, &GBufferTexel::default(), &texel(10.0, Vec3::Y)),
        "nothing is like nothing"
    );
}
