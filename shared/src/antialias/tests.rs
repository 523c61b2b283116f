//! Antialiasing of pictures whose filtered values are known in closed form.

use super::*;
use crate::camera::Camera;
use crate::frame::FrameConstants;
use crate::interface::PassConstants;
use crate::math::{CENTER, unpack_place};
use crate::passes::points::place_at_rest;
use crate::passes::{At, antialias, variant};
use crate::surface::GBufferTexel;
use bytemuck::Zeroable;
use glam::{DVec2, UVec3};

const SIZE: UVec2 = UVec2::new(12, 10);
/// Every pixel has taken 400 places.
const FRAMES: u32 = 16 * 400;

fn pixels() -> impl Iterator<Item = UVec2> {
    (0..SIZE.y).flat_map(|y| (0..SIZE.x).map(move |x| UVec2::new(x, y)))
}

fn frame(index: u32) -> FrameConstants {
    let camera = Camera::new(Vec3::ZERO, -Vec3::Z, Vec3::Y, 0.8, SIZE);
    FrameConstants { camera, previous_camera: camera, size: SIZE, index, ..FrameConstants::zeroed() }
}

/// One more frame of what is seen through `place`, of which `light` is seen at a point of the picture (pixels).
fn add(
    frame: &FrameConstants,
    bits: u32,
    place: impl Fn(&FrameConstants, UVec2) -> u32,
    light: impl Fn(Vec2) -> Vec3,
    before: &[Vec4],
) -> Vec<Vec4> {
    let gbuffer: Vec<_> = pixels().map(|p| GBufferTexel::default().seen_through(place(frame, p))).collect();
    let aliased: Vec<_> =
        pixels().zip(&gbuffer).map(|(p, texel)| light(p.as_vec2() + unpack_place(texel.place()))).collect();
    let at = |p: UVec2| At::new(frame, PassConstants::zeroed(), 0, bits, UVec3::new(p.x, p.y, 0));
    pixels().map(|p| antialias(at(p), &gbuffer, &[], &aliased, before).0).collect()
}

/// The mean of [`FRAMES`] frames at rest.
fn at_rest(place: impl Fn(&FrameConstants, UVec2) -> u32, light: impl Fn(Vec2) -> Vec3) -> Vec<Vec4> {
    (0..FRAMES).fold(Vec::new(), |before, index| {
        let bits = if index == 0 { 0 } else { variant::ANTIALIASED };
        add(&frame(index), bits, &place, &light, &before)
    })
}

/// The half plane beyond an edge through `through`, behind the filter around `center`: integrated in f64 over the pixels that it takes.
fn half_plane(center: DVec2, through: DVec2, normal: DVec2) -> f64 {
    let (mut inside, mut all) = (0.0, 0.0);
    let steps = 240;
    for y in 0..steps {
        for x in 0..steps {
            let offset = (DVec2::new(f64::from(x), f64::from(y)) + 0.5) / f64::from(steps) * 2.0 - 1.0;
            let weight = (-offset.length_squared() / (2.0 * 0.45 * 0.45)).exp();
            all += weight;
            inside += weight * f64::from((center + offset - through).dot(normal) > 0.0);
        }
    }
    inside / all
}

/// Edges that lie anywhere between pixels. Negative control: through the centers of pixels alone it is off by more than ten times as much.
#[test]
fn edges_have_their_filtered_values() {
    let through = DVec2::new(6.3, 5.1);
    for angle in [0.0f64, 0.3, 0.9, 1.4] {
        let normal = DVec2::new(angle.cos(), angle.sin());
        let light = |at: Vec2| Vec3::splat(((at.as_dvec2() - through).dot(normal) > 0.0) as u32 as f32);
        let worst = |place: fn(&FrameConstants, UVec2) -> u32| {
            let mean = at_rest(place, light);
            let inside = |p: UVec2| p.cmpge(UVec2::ONE).all() && p.cmplt(SIZE - 1).all();
            let off = pixels()
                .zip(mean)
                .filter(|(p, _)| inside(*p))
                .map(|(p, mean)| (f64::from(mean.x) - half_plane(p.as_dvec2() + 0.5, through, normal)).abs());
            off.fold(0.0, f64::max)
        };
        let (wandering, centers) = (worst(place_at_rest), worst(|_, _| CENTER));
        assert!(wandering < 0.01, "{angle}: {wandering}");
        assert!(centers > 0.12, "{angle}: {centers}");
    }
}

/// Turn by turn, in any 16 of them, every quarter of a pixel's width and height is looked through 4 +- 2 times.
#[test]
fn places_cover_the_pixel() {
    for pixel in [UVec2::ZERO, UVec2::new(7, 3), UVec2::new(1919, 1079)] {
        let places: Vec<_> = (0..64).map(|i| unpack_place(place_at_rest(&frame(16 * i), pixel))).collect();
        for sixteen in places.windows(16) {
            for part in 0..4 {
                let has = |x: f32| (x * 4.0) as i32 == part;
                let (x, y) = (
                    sixteen.iter().filter(|p| has(p.x)).count(),
                    sixteen.iter().filter(|p| has(p.y)).count(),
                );
                assert!((2..=6).contains(&x) && (2..=6).contains(&y), "{pixel} {part}: {x} and {y}");
            }
        }
        // It stays in between.
        let stays =
            (0..16).filter(|&i| place_at_rest(&frame(i), pixel) != place_at_rest(&frame(i + 1), pixel));
        assert_eq!(stays.count(), 1);
    }
}

#[test]
fn even_light_stays_as_it_is() {
    let light = Vec3::new(3.0, 40.0, 0.5);
    for mean in at_rest(place_at_rest, |_| light) {
        assert!((mean.truncate() / light - 1.0).abs().max_element() < 1e-5, "{mean}");
    }
}

/// A moving picture takes its mean along: a ramp that passes by at 0.3 pixels a frame stays a ramp.
#[test]
fn means_go_with_the_picture() {
    let speed = 0.3;
    // Narrow: a turn moves all of the picture alike.
    let camera = |forward: Vec3| Camera::new(Vec3::ZERO, forward, Vec3::Y, 0.05, SIZE);
    let focal = 0.5 * SIZE.x as f32 / camera(-Vec3::Z).right.length();
    let turned = |index: u32| {
        // Far away a turn by this moves the middle of the picture by `speed` to the left.
        let angle = speed * index as f32 / focal;
        camera(Vec3::new(angle.sin(), 0.0, -angle.cos()))
    };
    let ramp = |index: u32| move |at: Vec2| Vec3::splat(10.0 + at.x + speed * index as f32);
    let mut mean = Vec::new();
    for index in 0..20 {
        let previous = turned(index.max(1) - 1);
        let moving = FrameConstants { camera: turned(index), previous_camera: previous, ..frame(index) };
        let bits = if index == 0 { 0 } else { variant::ANTIALIASED };
        mean = add(&moving, bits, |_, _| CENTER, ramp(index), &mean);
    }
    for (p, mean) in pixels().zip(&mean) {
        let expected = ramp(19)(p.as_vec2() + 0.5).x;
        // What has come in over the right border of late had no past.
        let border = p.x < 2 || p.x + 6 >= SIZE.x;
        assert!(border || (mean.x / expected - 1.0).abs() < 0.005, "{p}: {} for {expected}", mean.x);
        assert!(border || mean.w == 13.0, "{p}: {}", mean.w);
    }
}

/// What was there before is gone with what the pixels around show now; what they bear out stays.
#[test]
fn what_is_gone_is_gone() {
    let bits = variant::ANTIALIASED | variant::MOVING;
    let before = vec![Vec4::new(1000.0, 1000.0, 1000.0, 64.0); pixels().count()];
    let noise = |at: Vec2| Vec3::splat(1.0 + 0.1 * ((at.x * 7.0 + at.y * 3.0).sin()));
    for mean in add(&frame(1), bits, |_, _| CENTER, noise, &before) {
        assert!(mean.x < 1.3, "{mean}");
    }
    // Negative control: nobody asks while nothing has changed.
    let kept = add(&frame(1), variant::ANTIALIASED, |_, _| CENTER, noise, &before);
    assert!(kept.iter().all(|mean| mean.x > 900.0));
    let borne_out = vec![Vec4::new(1.02, 1.02, 1.02, 64.0); pixels().count()];
    let inner = pixels().zip(add(&frame(1), bits, |_, _| CENTER, noise, &borne_out));
    let kept = inner.filter(|(_, mean)| (mean.x - 1.02).abs() < 0.02).count();
    assert!(kept > SIZE.element_product() as usize / 2, "{kept}");
}

#[test]
fn nothing_is_not_a_number() {
    for light in [0.0, 1e-38, 1e30] {
        let spot = |at: Vec2| if at.x < 4.0 { Vec3::splat(light) } else { Vec3::ZERO };
        for bits in [variant::ANTIALIASED, variant::ANTIALIASED | variant::MOVING] {
            let before = vec![Vec4::new(light, 0.0, 1.0, 3.0); pixels().count()];
            let mean = add(&frame(1), bits, |_, _| CENTER, spot, &before);
            assert!(mean.iter().all(|mean| mean.is_finite() && mean.cmpge(Vec4::ZERO).all()), "{light}");
        }
    }
}

/// Moments of 4,096 places are those of the filters, in closed form or integrated in f64. Negative control: those of the others are not.
#[test]
fn places_of_a_mean_lie_like_the_filter() {
    let gaussian = |x: f64| (-x * x / (2.0 * 0.45 * 0.45)).exp();
    let integral = |of: &dyn Fn(f64) -> f64| {
        (0..20_000).map(|i| of((f64::from(i) + 0.5) / 10_000.0 - 1.0)).sum::<f64>() / 10_000.0
    };
    let weights = integral(&gaussian);
    // Of cosines over a width w: w²/12 + Σ (-1)^k a_k w²/(2 π² k² a_0), with signs as they are around the middle.
    let pi2 = std::f64::consts::PI.powi(2);
    let harris = 1.5 * 1.5 * (1.0 / 12.0 - (0.48829 - 0.14128 / 4.0 + 0.01168 / 9.0) / (2.0 * pi2 * 0.35875));
    let filters = [
        (PixelFilter::Box, 1.0 / 12.0),
        (PixelFilter::Gaussian, integral(&|x| x * x * gaussian(x)) / weights),
        (PixelFilter::BlackmanHarris, harris),
    ];
    for (i, (filter, second)) in filters.into_iter().enumerate() {
        let offsets: Vec<DVec2> =
            (0..4096).map(|frame| unpack_place(filter.place(frame)).as_dvec2() - 0.5).collect();
        let mean = |of: &dyn Fn(DVec2) -> f64| offsets.iter().map(|&x| of(x)).sum::<f64>() / 4096.0;
        assert!(mean(&|x| x.x).abs() < 1e-3 && mean(&|x| x.y).abs() < 1e-3);
        for along in [mean(&|x| x.x * x.x), mean(&|x| x.y * x.y)] {
            assert!((along / second - 1.0).abs() < 0.005, "{filter:?}: {along} for {second}");
            let others = filters.iter().enumerate().filter(|(j, _)| *j != i);
            others.for_each(|(_, other)| {
                assert!((along / other.1 - 1.0).abs() > 0.2, "{filter:?} as {other:?}")
            });
        }
        assert!(mean(&|x| x.x * x.y).abs() < 1e-3);
    }
    assert!((f64::from(MEAN_WEIGHT) / weights.powi(2) - 1.0).abs() < 1e-4);
}
