//! Smooth surfaces: what BSDF candidates find, against closed forms and the reference.

use candela::scene::SceneDescription;
use glam::{DVec3, UVec2, Vec3, Vec4};
use shared::frame::{Settings, mode};
use tests::gpu::{assert_no_validation_messages, device, reference, renderer, restir, small};
use tests::scenes::{camera, emitter, floor_point, kinds, occluded, pane, scene, sky, square};
use tests::statistics::{assert_means, replicas};

const SIZE: UVec2 = UVec2::new(64, 48);
/// Half the side of a square lamp over the floor, m, and its middle.
const HALF: f64 = 2.0;
const LAMP: DVec3 = DVec3::new(0.0, 3.0, -3.75);
const LAMP_RADIANCE: Vec3 = Vec3::new(20.0, 30.0, 40.0);

/// `scene` with a white metal for its floor.
fn metal(mut scene: SceneDescription, roughness: f32) -> SceneDescription {
    let floor = &mut scene.materials[0];
    (floor.base_color, floor.metallic, floor.roughness) = (Vec4::ONE, 1.0, roughness);
    scene
}

fn lamp() -> SceneDescription {
    let [u, v] = [Vec3::X, Vec3::Z].map(|axis| axis * HALF as f32);
    scene(vec![square(LAMP.as_vec3(), u, v, 1)], vec![emitter(LAMP_RADIANCE)], vec![])
}

/// Radiance that a perfect mirror shows at `x`, and none near an edge of what it mirrors, where a lobe of 1 mrad mixes.
type Mirrored = fn(DVec3, DVec3) -> Option<Vec3>;

fn lamp_mirrored(x: DVec3, wi: DVec3) -> Option<Vec3> {
    let at = x + wi * ((LAMP.y - x.y) / wi.y) - LAMP;
    let (inside, edge) = (at.x.abs().max(at.z.abs()), 0.08);
    // The diagonal parts its two triangles.
    let clear = (inside - HALF).abs() > edge && (inside > HALF || (at.x - at.z).abs() > edge);
    clear.then_some(if inside < HALF { LAMP_RADIANCE } else { Vec3::ZERO })
}

fn sky_mirrored(_: DVec3, wi: DVec3) -> Option<Vec3> {
    use std::f64::consts::{PI, TAU};
    let map = sky().environment?;
    let place = [0.5 + wi.z.atan2(wi.x) / TAU, wi.y.acos() / PI];
    let [u, v] = [place[0] * f64::from(map.size.x), place[1] * f64::from(map.size.y)];
    let clear = [u, v].iter().all(|t| (t.fract() - 0.5).abs() < 0.47);
    clear.then(|| map.radiance[(v as u32 * map.size.x + u as u32) as usize])
}

/// Pixels of the floor with the radiance of a perfect mirror.
fn mirror_pixels(mirrored: Mirrored) -> Vec<(usize, Vec3)> {
    let camera = camera(SIZE);
    let pixels = (0..SIZE.x * SIZE.y).map(|i| UVec2::new(i % SIZE.x, i / SIZE.x));
    let radiance = |(i, pixel)| {
        let x = floor_point(&camera, pixel, SIZE)?;
        let wo = (camera.position.as_dvec3() - x).normalize();
        Some((i, mirrored(x, DVec3::new(-wo.x, wo.y, -wo.z))?))
    };
    pixels.enumerate().filter_map(radiance).collect()
}

/// The share of those pixels that a mean of a few frames shows within 20 %, or 0.2 nit: GGX's lobe has long tails, which
/// light candidates fill, one in some ten frames.
fn share_right(image: &[Vec3], truth: &[(usize, Vec3)]) -> f64 {
    let near = |&&(i, truth): &&(usize, Vec3)| {
        (image[i] - truth).abs().max_element() <= 0.2 * truth.max_element().max(1.0)
    };
    truth.iter().filter(near).count() as f64 / truth.len() as f64
}

/// Mirrors of roughness 0 show a lamp and the sky as geometry says, in both modes, from the table and from tiles; without
/// BSDF candidates the very test fails. Every hundredth pixel may be off by chance.
#[test]
fn mirrors_show_what_they_mirror() {
    let Some(device) = device() else { return };
    let camera = camera(SIZE);
    for (name, open, mirrored) in [("lamp", lamp(), lamp_mirrored as Mirrored), ("sky", sky(), sky_mirrored)]
    {
        let mut renderer = renderer(&device, &metal(open, 0.0), SIZE, 1);
        let truth = mirror_pixels(mirrored);
        assert!(truth.len() > 1000, "{name}: {} pixels", truth.len());
        let lit: Vec<_> = truth.iter().copied().filter(|(_, l)| *l != Vec3::ZERO).collect();
        let mut share = |settings: Settings, truth: &[(usize, Vec3)]| {
            let frames: Vec<_> =
                (0..24).map(|seed| restir(&mut renderer, camera, settings, 2, seed)).collect();
            let mean = |i: usize| frames.iter().map(|frame| frame[i]).sum::<Vec3>() / frames.len() as f32;
            share_right(&(0..frames[0].len()).map(mean).collect::<Vec<_>>(), truth)
        };
        let alone = Settings { spatial: 0, temporal: 0, ..Settings::default() };
        let reuse =
            Settings { radius: 6.0, spatial_iterations: 2, mode: mode::BIASED, ..Settings::default() };
        for (case, settings) in [
            ("alone", alone),
            ("tiles", Settings { tiles: 1, ..alone }),
            ("cells", Settings { cells: 1, ..alone }),
            ("unbiased", Settings { mode: mode::UNBIASED, ..reuse }),
        ] {
            let right = share(settings, &truth);
            println!("{name}, {case}: {right}");
            assert!(right > 0.99, "{name}, {case}: only {right} of the pixels are right");
        }
        let without = share(Settings { bsdf_candidates: 0, ..alone }, &lit);
        println!("{name}, without: {without}");
        assert!(lit.len() > 200 && without < 0.5, "{name}: {without} of the pixels are right without");
    }
    assert_no_validation_messages(&device);
}

/// A mirror that looks through a pane of alpha 1/2 shows half, in the mean: the found sample draws its alpha once. Binomial
/// over some 100,000 draws: |z| < 4.9 is a false alarm in 1e-6.
#[test]
fn mirrors_look_through_panes() {
    let Some(device) = device() else { return };
    let camera = camera(SIZE);
    let wall = square(Vec3::new(0.0, 10.0, -10.5), Vec3::X * 40.0, Vec3::Y * 15.0, 1);
    let mut behind = scene(vec![wall], vec![pane()], vec![]);
    behind.environment = sky().environment;
    let mut renderer = renderer(&device, &metal(behind, 0.0), SIZE, 1);
    let truth: Vec<_> = mirror_pixels(sky_mirrored).into_iter().filter(|(_, l)| *l != Vec3::ZERO).collect();
    for mode in [mode::BIASED, mode::UNBIASED] {
        let settings = Settings { spatial: 0, temporal: 0, mode, ..Settings::default() };
        let (mut shown, mut draws) = (0.0, 0.0);
        for seed in 0..48 {
            let image = restir(&mut renderer, camera, settings, 1, seed);
            for &(i, l) in &truth {
                shown += f64::from(image[i].y / l.y).min(2.0);
                draws += 1.0;
            }
        }
        let z = (shown - 0.5 * draws) / (0.25 * draws).sqrt();
        println!("mode {mode}: {} of {draws}, z {z:.2}", shown / draws);
        assert!(z.abs() < 4.9, "mode {mode}: {} of the light instead of half", shown / draws);
    }
    assert_no_validation_messages(&device);
}

/// A glossy floor has the reference's mean in every block, among shadows, with every kind of light. 48 blocks, Student's t of
/// 47 degrees of freedom: a false alarm in 1e-4 of all cases (fixed seeds).
#[test]
fn glossy_floors_have_the_mean_of_the_reference() {
    const REPLICAS: u32 = 48;
    const Z_LIMIT: f64 = 5.9;
    let Some(device) = device() else { return };
    let camera = camera(SIZE);
    let replicas = |run: &mut dyn FnMut(u32) -> Vec<Vec3>| replicas(REPLICAS, SIZE, run);
    let base = small(mode::UNBIASED);
    for (kind, open) in
        kinds().into_iter().filter(|(kind, _)| ["triangles", "sky", "together"].contains(kind))
    {
        let mut renderer = renderer(&device, &metal(occluded(open), 0.45), SIZE, 1);
        let truth = replicas(&mut |seed| reference(&mut renderer, camera, 1000 + seed));
        for (name, settings, frames) in [
            ("alone", Settings { temporal: 0, spatial: 0, ..base }, 1),
            ("cells, 2 BSDF", Settings { temporal: 0, spatial: 0, cells: 1, bsdf_candidates: 2, ..base }, 3),
            ("tiles, 4 BSDF", Settings { temporal: 0, spatial: 0, tiles: 1, bsdf_candidates: 4, ..base }, 1),
            ("temporal and spatial", Settings { spatial_iterations: 1, ..base }, 3),
        ] {
            let means = replicas(&mut |seed| restir(&mut renderer, camera, settings, frames, seed));
            assert_means(&format!("{kind}, {name}"), &means, &truth, Z_LIMIT);
        }
    }
    assert_no_validation_messages(&device);
}
