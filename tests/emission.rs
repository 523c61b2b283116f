//! A screen with a picture on it lights a floor: textured emission on the device, against quadrature over the texture.

use candela::scene::{Filter, Image, Material, SceneDescription, Texture, Wrap};
use glam::{DVec2, DVec3, UVec2, Vec2, Vec3};
use shared::frame::{Settings, mode};
use std::sync::Arc;
use tests::gpu::{assert_no_validation_messages, device, reference, renderer, restir, small};
use tests::scenes::{camera, emitter, floor_bsdf, floor_point, scene, square};
use tests::statistics::{assert_means, block_means, largest_z, mean_and_error};

const SIZE: UVec2 = UVec2::new(64, 48);
const REPLICAS: u32 = 32;
/// Over 48 blocks with Student's t of 31 degrees of freedom: a false alarm in 1e-4 of all runs a case (Sidak).
const Z_LIMIT: f64 = 6.5;

const CENTER: Vec3 = Vec3::new(0.0, 1.2, 0.0);
const HALF: f32 = 1.0;
const EMISSION: Vec3 = Vec3::new(40.0, 30.0, 20.0);
/// Rows from v = 0: one bright corner, one dim one, the rest dark.
const TEXELS: [[u8; 4]; 16] = {
    let mut texels = [[0, 0, 0, 255]; 16];
    texels[0] = [255, 255, 255, 255];
    texels[1] = [60, 120, 255, 255];
    texels[15] = [40, 40, 40, 255];
    texels
};

/// The screen above the floor, face down; u along +x, v along +z.
fn screen(texels: &[[u8; 4]], side: u32) -> SceneDescription {
    let mut quad = square(CENTER, Vec3::X * HALF, Vec3::Z * HALF, 1);
    // u x v = x × z = -y: it faces the floor. Corners: (-x, -z), (+x, -z), (+x, +z), (-x, +z).
    quad.uvs = vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
    let glow = Material { emissive_texture: Some(0), ..emitter(EMISSION) };
    let mut scene = scene(vec![quad], vec![glow], vec![]);
    let image = Image { name: "screen".into(), width: side, height: side, texels: texels.concat() };
    scene.textures = vec![Texture {
        image: Arc::new(image),
        srgb: false,
        wrap: [Wrap::ClampToEdge; 2],
        filter: Filter::NEAREST,
    }];
    scene
}

/// What the floor shows at `x`: ∫ f L cosθ cosθ' / d² dA by midpoints, each texel on its own 16 x 16 points.
fn floor_radiance(x: DVec3, eye: DVec3) -> DVec3 {
    const N: u32 = 16;
    let side = 2.0 * f64::from(HALF) / f64::from(4 * N);
    let mut sum = DVec3::ZERO;
    for (texel, rgb) in TEXELS.iter().enumerate() {
        let value = DVec3::new(f64::from(rgb[0]), f64::from(rgb[1]), f64::from(rgb[2])) / 255.0;
        if value == DVec3::ZERO {
            continue;
        }
        let first = DVec2::new((texel % 4) as f64, (texel / 4) as f64) * f64::from(N);
        for i in 0..N * N {
            let place = (first + DVec2::new(f64::from(i % N), f64::from(i / N)) + 0.5) * side;
            let p = CENTER.as_dvec3() + DVec3::new(place.x, 0.0, place.y)
                - DVec3::new(1.0, 0.0, 1.0) * f64::from(HALF);
            let to_light = p - x;
            let wi = to_light.normalize();
            let weight = wi.y * wi.y / to_light.length_squared() * side * side;
            sum += floor_bsdf(wi, (eye - x).normalize()) * value * EMISSION.as_dvec3() * weight;
        }
    }
    sum
}

#[test]
fn a_screen_lights_the_floor_with_its_picture() {
    let Some(device) = device() else { return };
    let camera = camera(SIZE);
    let eye = camera.position.as_dvec3();
    let bounds = |x: DVec3| {
        // Where the ray to the floor passes the screen.
        let t = (f64::from(CENTER.y) - eye.y) / (x.y - eye.y);
        (eye + t * (x - eye)).abs()
    };
    let mut truth = vec![Vec3::ZERO; (SIZE.x * SIZE.y) as usize];
    let mut clear = vec![true; truth.len()];
    for (i, pixel) in truth.iter_mut().enumerate() {
        let place = UVec2::new(i as u32 % SIZE.x, i as u32 / SIZE.x);
        let x = floor_point(&camera, place, SIZE);
        clear[i] = x.is_some_and(|x| bounds(x).x.max(bounds(x).z) > f64::from(HALF) + 0.01);
        if let (Some(x), true) = (x, clear[i]) {
            *pixel = floor_radiance(x, eye).as_vec3();
        }
    }
    // Pixels that see the screen's back, or its edge, say nothing of its light.
    let masked = |picture: Vec<Vec3>| {
        let pixels: Vec<Vec3> =
            picture.iter().zip(&clear).map(|(l, &clear)| if clear { *l } else { Vec3::ZERO }).collect();
        block_means(&pixels, SIZE)
    };
    let exact: Vec<_> = masked(truth.clone()).into_iter().map(|mean| (mean, 0.0)).collect();
    assert!(clear.iter().filter(|&&c| c).count() > 2000 && truth.iter().all(|l| l.is_finite()));

    let base = small(mode::UNBIASED);
    let mut lit = renderer(&device, &screen(&TEXELS, 4), SIZE, 1);
    // Dark texels are no lights.
    assert!((3..100).contains(&lit.scene().light_count()), "{} lights", lit.scene().light_count());
    let mut mean = |run: &mut dyn FnMut(&mut _, u32) -> Vec<Vec3>| {
        let samples: Vec<_> = (1..=REPLICAS).map(|seed| masked(run(&mut lit, seed))).collect();
        mean_and_error(&samples)
    };
    let pictures = [
        ("reference", mean(&mut |r, seed| reference(r, camera, seed))),
        (
            "RIS",
            mean(&mut |r, seed| restir(r, camera, Settings { temporal: 0, spatial: 0, ..base }, 1, seed)),
        ),
        ("reuse", mean(&mut |r, seed| restir(r, camera, base, 3, seed))),
    ];
    for (name, means) in &pictures {
        assert_means(name, means, &exact, Z_LIMIT);
    }

    // Negative control: the same energy spread evenly, as an average of the texture would be, is seen at once.
    let average = TEXELS.iter().fold([0u32; 3], |sum, t| std::array::from_fn(|c| sum[c] + u32::from(t[c])));
    let [r, g, b] = average.map(|sum| (f64::from(sum) / 16.0).round() as u8);
    let mut even = renderer(&device, &screen(&[[r, g, b, 255]], 1), SIZE, 1);
    let samples: Vec<_> = (1..=REPLICAS).map(|seed| masked(reference(&mut even, camera, seed))).collect();
    let z = largest_z(&mean_and_error(&samples), &exact).0;
    assert!(z > 4.0 * Z_LIMIT, "an even screen was not seen: {z}");
    assert_no_validation_messages(&device);
}
