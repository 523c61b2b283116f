//! The denoiser on pictures whose answer is known without it.

use super::*;
use crate::camera::Camera;
use crate::frame::{FrameConstants, Settings};
use crate::geometry::SurfacePoint;
use crate::interface::PassConstants;
use crate::material::Reflectance;
use crate::math::luminance;
use crate::passes::{At, denoise_spatial, denoise_temporal, denoise_variance, resolve_denoised, variant};
use crate::surface::GBufferTexel;
use bytemuck::Zeroable;
use glam::{UVec2, UVec3, Vec2};

const SIZE: UVec2 = UVec2::new(48, 32);
const ALBEDO: Vec3 = Vec3::new(0.5, 0.25, 0.75);

fn pixels() -> impl Iterator<Item = UVec2> {
    (0..SIZE.y).flat_map(|y| (0..SIZE.x).map(move |x| UVec2::new(x, y)))
}

fn frame() -> FrameConstants {
    let camera = Camera::new(Vec3::ZERO, -Vec3::Z, Vec3::Y, 0.8, SIZE);
    FrameConstants {
        camera,
        previous_camera: camera,
        size: SIZE,
        index: 1,
        settings: Settings::default(),
        ..FrameConstants::zeroed()
    }
}

/// What each pixel sees: the point at `distance` (m) behind its center, with `normal`. None: nothing.
fn surfaces(see: impl Fn(UVec2, Vec3) -> Option<(f32, Vec3)>) -> Vec<GBufferTexel> {
    let eye = Vec3::ZERO;
    pixels()
        .map(|pixel| {
            let direction = frame().camera.direction(pixel.as_vec2() + 0.5, SIZE);
            let Some((distance, normal)) = see(pixel, direction) else { return GBufferTexel::default() };
            let point = SurfacePoint {
                position: direction * distance,
                geometric_normal: normal,
                normal,
                tangent: Vec3::X,
                tangent_sign: 1.0,
                uv: Vec2::ZERO,
                color: Vec3::ONE,
            };
            let reflectance = Reflectance { diffuse: ALBEDO, f0: Vec3::splat(0.04), roughness: 1.0 };
            GBufferTexel::new(&point, normal, reflectance, 0, eye)
        })
        .collect()
}

/// A wall 5 m ahead.
fn wall() -> Vec<GBufferTexel> {
    surfaces(|_, direction| Some((5.0 / -direction.z, Vec3::Z)))
}

/// A frame of `diffuse` light, after the means of the frame before.
struct Denoised {
    smoothed: Vec<Smoothed>,
    filtered: Vec<Filtered>,
    radiance: Vec<Vec3>,
}

fn denoise(
    gbuffer: &[GBufferTexel],
    diffuse: &[Vec3],
    before: Option<&[Smoothed]>,
    changed: bool,
) -> Denoised {
    let frame = frame();
    let black = vec![Vec3::ZERO; diffuse.len()];
    let motions = [Zeroable::zeroed()];
    let at = |pixel: UVec2, variant: u32, iteration: u32| {
        let constants = PassConstants { iteration, ..PassConstants::zeroed() };
        At::new(&frame, constants, 0, variant, UVec3::new(pixel.x, pixel.y, 0))
    };
    let bits = before.map_or(0, |_| variant::DENOISED) | if changed { variant::MOVING } else { 0 };
    let none = vec![Smoothed::default(); diffuse.len()];
    let (smoothed, mut filtered): (Vec<_>, Vec<_>) = pixels()
        .map(|pixel| {
            let before = before.unwrap_or(&none);
            let at = at(pixel, bits, 0);
            denoise_temporal(at, gbuffer, gbuffer, &[], &motions, diffuse, &black, &[], &[], before)
        })
        .unzip();
    filtered = pixels().map(|pixel| denoise_variance(at(pixel, 0, 0), &smoothed, &filtered)).collect();
    for iteration in 0..ITERATIONS {
        filtered = pixels().map(|pixel| denoise_spatial(at(pixel, 0, iteration), &filtered)).collect();
    }
    let radiance = pixels()
        .map(|pixel| resolve_denoised(at(pixel, 0, 0), gbuffer, &black, &smoothed, &filtered))
        .collect();
    Denoised { smoothed, filtered, radiance }
}

/// Numbers in 0..1, the same ones every time.
fn noise(count: usize) -> Vec<f32> {
    let mut state = 0x9e37_79b9u32;
    let mut next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / 16_777_216.0
    };
    (0..count).map(|_| next()).collect()
}

fn sum(light: impl Iterator<Item = f32>) -> f64 {
    light.map(f64::from).sum()
}

#[test]
fn even_light_stays_as_it_is() {
    let light = Vec3::new(3.0, 40.0, 0.5);
    let Denoised { radiance, .. } = denoise(&wall(), &[light; 1536], None, false);
    let worst =
        radiance.iter().map(|&r| (r / (ALBEDO * light) - 1.0).abs().max_element()).fold(0.0, f32::max);
    // The G-buffer's albedo has 16 bits.
    assert!(worst < 1e-4, "{worst}");
}

/// Kernels are symmetric: what rises evenly stays, away from the picture's edge.
#[test]
fn ramps_stay_as_they_are() {
    let light: Vec<_> = pixels().map(|p| Vec3::splat(10.0 + p.x as f32 + 0.5 * p.y as f32)).collect();
    let Denoised { filtered, .. } = denoise(&wall(), &light, None, false);
    for ((pixel, light), filtered) in pixels().zip(&light).zip(&filtered) {
        let inside = pixel.cmpge(UVec2::splat(15)).all() && pixel.cmplt(SIZE - 15).all();
        let off = filtered.luminance() / luminance(*light) - 1.0;
        // Points of a wall are not evenly far apart in directions; similarity hangs on it by a little.
        assert!(!inside || off.abs() < 1e-3, "{pixel}: {off}");
    }
}

/// What one pixel loses its neighbors get, whatever the light: noise, specks, edges of things.
#[test]
fn the_sum_of_light_stays() {
    let noise = noise(1536);
    let speckled: Vec<_> =
        noise.iter().map(|&x| Vec3::splat(if x > 0.99 { 1000.0 } else { x * x })).collect();
    let steps = surfaces(|pixel, direction| {
        let distance = if pixel.x / 7 % 2 == 0 { 5.0 } else { 3.0 };
        (pixel.y > 3).then_some((distance / -direction.z, Vec3::Z))
    });
    for gbuffer in [wall(), steps] {
        let lit = |i: usize| !gbuffer[i].is_empty();
        let Denoised { smoothed, filtered, .. } = denoise(&gbuffer, &speckled, None, false);
        let before = sum(smoothed.iter().map(|s| luminance(s.diffuse)));
        let after = sum(filtered.iter().map(Filtered::luminance));
        assert!((after / before - 1.0).abs() < 1e-4, "{after} of {before}");
        assert!(filtered.iter().enumerate().all(|(i, f)| lit(i) || f.is_empty()));
        // Negative control: it does filter, and a filter that loses a thousandth is seen.
        let moved =
            smoothed.iter().zip(&filtered).filter(|(s, f)| luminance(s.diffuse) != f.luminance()).count();
        assert!(moved > 700, "{moved}");
        assert!((0.999 * after / before - 1.0).abs() > 1e-4);
    }
}

/// Noise of two colors under even luminance: the color noise goes, more than four fifths of it.
#[test]
fn color_noise_goes() {
    let (red, blue) = (Vec3::new(1.0, 0.2, 0.1), Vec3::new(0.1, 0.2, 1.0));
    let (red, blue) = (red / luminance(red), blue / luminance(blue));
    let light: Vec<_> = noise(1536).into_iter().map(|x| if x < 0.5 { red } else { blue }).collect();
    let Denoised { radiance, .. } = denoise(&wall(), &light, None, false);
    let spread = |light: &mut dyn Iterator<Item = f32>| {
        let all: Vec<f64> = light.map(f64::from).collect();
        let mean = all.iter().sum::<f64>() / all.len() as f64;
        (all.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / all.len() as f64).sqrt()
    };
    let before = spread(&mut light.iter().map(|c| c.x - c.z));
    let after = spread(&mut radiance.iter().map(|&c| (c / ALBEDO).x - (c / ALBEDO).z));
    assert!(after < 0.2 * before, "{after} of {before}");
    for r in &radiance {
        assert!((luminance(*r / ALBEDO) - 1.0).abs() < 1e-3, "luminance was even");
    }
}

/// A lit and a dark half: no light crosses an edge in depth or in direction. Where there is none, it does.
#[test]
fn light_does_not_leak() {
    let half = SIZE.x / 2;
    let flat = wall();
    let step =
        surfaces(|pixel, direction| Some((if pixel.x < half { 5.0 } else { 3.0 } / -direction.z, Vec3::Z)));
    let corner = surfaces(|pixel, direction| {
        let side = Vec3::new(-1.0, 0.0, 0.1).normalize();
        Some((5.0 / -direction.z, if pixel.x < half { Vec3::Z } else { side }))
    });
    let light: Vec<_> = noise(1536)
        .into_iter()
        .zip(pixels())
        .map(|(x, pixel)| Vec3::splat(if pixel.x < half { 1.0 + x } else { 0.0 }))
        .collect();
    let leaked = |gbuffer: &[GBufferTexel]| {
        let Denoised { radiance, .. } = denoise(gbuffer, &light, None, false);
        sum(pixels().zip(radiance).filter(|(pixel, _)| pixel.x >= half).map(|(_, r)| luminance(r)))
    };
    assert_eq!(leaked(&step), 0.0);
    assert_eq!(leaked(&corner), 0.0);
    assert!(leaked(&flat) > 0.0, "negative control: one surface");
}

/// Means of later frames weigh more; the weights are binomials.
#[test]
fn a_mean_goes_on() {
    let gbuffer = wall();
    let mut before: Option<Vec<Smoothed>> = None;
    let values = [8.0, 3.0, 5.0, 1.0];
    for value in values {
        before = Some(denoise(&gbuffer, &[Vec3::splat(value); 1536], before.as_deref(), false).smoothed);
    }
    let weights = [1.0, 3.0, 6.0, 10.0];
    let expected = values.iter().zip(weights).map(|(v, w)| v * w).sum::<f32>() / 20.0;
    let smoothed = before.expect("frames")[700];
    assert_eq!(smoothed.diffuse_frames, 4.0);
    assert!((smoothed.diffuse.x - expected).abs() < 1e-5, "{} for {expected}", smoothed.diffuse.x);
}

/// A light that is switched off is gone in the very frame where the program knows that something has changed.
#[test]
fn light_that_was_switched_off_is_gone() {
    let gbuffer = wall();
    let noise = noise(1536);
    let lit: Vec<_> = noise.iter().map(|&x| Vec3::splat(5.0 + x)).collect();
    let dim: Vec<_> = noise.iter().map(|&x| Vec3::splat(0.1 * (0.5 + x))).collect();
    let mut before = None;
    for _ in 0..20 {
        before = Some(denoise(&gbuffer, &lit, before.as_deref(), false).smoothed);
    }
    let left = |changed| {
        let after = denoise(&gbuffer, &dim, before.as_deref(), changed);
        sum(after.radiance.iter().map(|&r| luminance(r / ALBEDO))) / 1536.0
    };
    assert!(left(true) < 0.2, "{}", left(true));
    assert!(left(false) > 2.0, "negative control: it lags where nothing is known to have changed");
}

/// Whatever broken light comes in, its pixel is the only one that shows it, for as long as it comes.
#[test]
fn nothing_but_finite_numbers_leaves() {
    let mut light: Vec<_> = noise(1536).into_iter().map(Vec3::splat).collect();
    light[700] = Vec3::splat(1e30);
    light[701] = Vec3::ZERO;
    light[900] = Vec3::splat(1e-38);
    let Denoised { radiance, .. } = denoise(&wall(), &light, None, false);
    assert!(radiance.iter().all(|r| r.is_finite()));
}

#[test]
fn colors_survive_packing() {
    for i in 0..4000 {
        let strength = 2f32.powf((i % 250) as f32 - 125.0);
        let t = i as f32 / 4000.0;
        let color = Vec3::new(t, 1.0 - t, (37.0 * t).fract()) * strength;
        let back = unpack_color(pack_color(color));
        assert!(
            (back - color).abs().max_element() <= 4e-6 * color.max_element(),
            "{color} came back as {back}"
        );
    }
    for none in [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY] {
        assert_eq!(unpack_color(pack_color(none)), Vec3::ZERO);
    }
    assert_eq!(size_of::<Filtered>(), 32);
    assert_eq!(size_of::<Smoothed>(), 32);
}

/// Both sides of a pair give it one weight: what they exchange is the same.
#[test]
fn similarity_is_symmetric() {
    let gbuffer = surfaces(|pixel, direction| {
        let tilt = Vec3::new(0.3 * (pixel.x as f32).sin(), 0.2 * (pixel.y as f32).cos(), 1.0).normalize();
        Some((5.0 + 0.1 * (pixel.x as f32 * 0.7).sin() / -direction.z, tilt))
    });
    let frame = frame();
    let guides: Vec<_> = pixels()
        .zip(&gbuffer)
        .map(|(pixel, texel)| {
            let surface = texel.unpack(u32::MAX, &frame.camera, pixel, SIZE);
            Guide::new(PackedGuide::new(texel, &surface, frame.camera.forward), &frame.camera, pixel, SIZE)
        })
        .collect();
    for i in 1..guides.len() {
        let (a, b) = (&guides[i - 1], &guides[i]);
        assert_eq!(a.similarity(b, 0.02, 1.0), b.similarity(a, 0.02, 1.0));
        assert!(a.similarity(a, 0.02, 1.0) > 0.99);
    }
}

/// Where something has changed, means are held against all of the light, what has bounced too. Negative control: against direct light
/// alone five sixths would be gone.
#[test]
fn what_bounces_stays_where_something_changes() {
    let (frame, gbuffer) = (frame(), wall());
    let (direct, bounced) = (vec![Vec3::ONE; 1536], vec![Vec3::splat(5.0); 1536]);
    let (black, motions) = (vec![Vec3::ZERO; 1536], [Zeroable::zeroed()]);
    let mean = Smoothed { diffuse: Vec3::splat(6.0), diffuse_frames: 8.0, ..Smoothed::default() };
    let before = vec![mean; 1536];
    let bits = variant::BOUNCED | variant::DENOISED | variant::MOVING;
    let after = |bits: u32| {
        let middle = UVec3::new(SIZE.x / 2, SIZE.y / 2, 0);
        let at = At::new(&frame, PassConstants::zeroed(), 0, bits, middle);
        denoise_temporal(at, &gbuffer, &gbuffer, &[], &motions, &direct, &black, &bounced, &black, &before).0
    };
    assert!((after(bits).diffuse.x - 6.0).abs() < 1e-4, "{:?}", after(bits));
    assert!((after(bits & !variant::BOUNCED).diffuse.x - 1.0).abs() < 1e-4);
}
