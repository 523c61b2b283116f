//! Pictures whose every pixel is known in closed form.

use candela::scene::{DirectionalLight, Material, PointLight, SceneDescription, SpotLight};
use glam::{DVec3, UVec2, Vec3};
use shared::frame::{Settings, mode};
use tests::failure;
use tests::gpu::{assert_no_validation_messages, device, reference, renderer, restir};
use tests::scenes::{camera, floor_bsdf, floor_point, floor_radiance, scene, square};

const SIZE: UVec2 = UVec2::new(96, 64);
const LIGHT: PointLight =
    PointLight { position: Vec3::new(0.4, 2.0, -0.3), intensity: Vec3::new(100.0, 80.0, 60.0), radius: 0.0 };

fn pixels() -> impl Iterator<Item = (usize, UVec2)> {
    (0..SIZE.x * SIZE.y).map(|i| (i as usize, UVec2::new(i % SIZE.x, i / SIZE.x)))
}

/// Largest relative difference of any pixel.
fn largest_error(image: &[Vec3], truth: &[DVec3]) -> f64 {
    let error =
        |(a, b): (&Vec3, &DVec3)| (a.as_dvec3() - *b).abs().max_element() / b.max_element().max(1e-30);
    image.iter().zip(truth).map(error).fold(0.0, f64::max)
}

/// One point light leaves nothing to chance. Tolerance: normals are packed to 1e-4 rad (1e-4 tanθ of the cosine, tanθ
/// < 3 here), colors to 1e-5, and positions to a few ulp.
#[test]
fn one_point_light_over_a_floor() {
    const TOLERANCE: f64 = 5e-4;
    let Some(device) = device() else { return };
    let scene = scene(vec![], vec![], vec![LIGHT]);
    let camera = camera(SIZE);
    let mut renderer = renderer(&device, &scene, SIZE, 1);
    let eye = camera.position.as_dvec3();
    let truth_with = |exponent: f64| -> Vec<DVec3> {
        let radiance = |x: DVec3| {
            let d = (LIGHT.position.as_dvec3() - x).length();
            floor_radiance(x, eye, &LIGHT) * d.powf(2.0 - exponent)
        };
        pixels().map(|(_, p)| floor_point(&camera, p, SIZE).map_or(DVec3::ZERO, radiance)).collect()
    };
    let truth = truth_with(2.0);
    let single = truth.iter().map(|c| c.as_vec3()).collect::<Vec<_>>();
    for (name, image) in [
        ("one-light-restir", restir(&mut renderer, camera, Settings::default(), 3, 1)),
        ("one-light-reference", reference(&mut renderer, camera, 1)),
    ] {
        let error = largest_error(&image, &truth);
        assert!(error < TOLERANCE, "{name}: error {error}; {}", failure::write(name, SIZE, &image, &single));
        // Negative control: a slightly wrong falloff is seen.
        assert!(
            largest_error(&image, &truth_with(2.002)) > TOLERANCE,
            "{name}: the planted error was not seen"
        );
    }
    assert_no_validation_messages(&device);
}

/// The reference adds every light exactly once, in as many dispatches as it takes. Tolerance as above, and f32 sums.
#[test]
fn the_reference_sums_every_light_once() {
    let Some(device) = device() else { return };
    // A prime number of lights, so that the last dispatch is not full; each in a place of its own.
    let lights: Vec<_> = (0..211)
        .map(|i| {
            let angle = i as f32 * 2.4;
            let radius = 0.02 * i as f32;
            let position = Vec3::new(radius * angle.cos(), 0.5 + (i % 7) as f32 * 0.2, radius * angle.sin());
            PointLight { position, intensity: Vec3::new(1.0, 2.0, 3.0) * (1.0 + (i % 5) as f32), radius: 0.0 }
        })
        .collect();
    let camera = camera(SIZE);
    let eye = camera.position.as_dvec3();
    let sum_of = |lights: &[PointLight]| -> Vec<DVec3> {
        let sum = |x: DVec3| lights.iter().map(|light| floor_radiance(x, eye, light)).sum();
        pixels().map(|(_, p)| floor_point(&camera, p, SIZE).map_or(DVec3::ZERO, sum)).collect()
    };
    let truth = sum_of(&lights);
    let mut renderer = renderer(&device, &scene(vec![], vec![], lights.clone()), SIZE, 0);
    let image = reference(&mut renderer, camera, 1);
    let error = largest_error(&image, &truth);
    let single = truth.iter().map(|c| c.as_vec3()).collect::<Vec<_>>();
    assert!(error < 1e-3, "error {error}; {}", failure::write("reference-sum", SIZE, &image, &single));
    // Negative control: one light too few, at a border between dispatches, is seen.
    let fewer = [&lights[..64], &lights[65..]].concat();
    assert!(largest_error(&image, &sum_of(&fewer)) > 1e-3, "a lost light was not seen");
    assert_no_validation_messages(&device);
}

/// `scene` must look like `truth`, and not like `planted`: (floor point, eye) -> radiance. Nothing is left to chance.
fn assert_known(name: &str, scene: &SceneDescription, truth: Radiance, planted: Radiance) {
    const TOLERANCE: f64 = 1e-3;
    let Some(device) = device() else { return };
    let camera = camera(SIZE);
    let eye = camera.position.as_dvec3();
    let picture = |radiance: Radiance| -> Vec<DVec3> {
        let of_pixel = |p| floor_point(&camera, p, SIZE).map_or(DVec3::ZERO, |x| radiance(x, eye));
        pixels().map(|(_, p)| of_pixel(p)).collect()
    };
    let (truth, planted) = (picture(truth), picture(planted));
    let brightest = truth.iter().map(|c| c.max_element()).fold(0.0, f64::max);
    let error = |image: &[Vec3], truth: &[DVec3]| {
        let pixel = |(a, b): (&Vec3, &DVec3)| {
            (a.as_dvec3() - *b).abs().max_element() / (b.max_element() + 0.01 * brightest)
        };
        image.iter().zip(truth).map(pixel).fold(0.0, f64::max)
    };
    let mut renderer = renderer(&device, scene, SIZE, 1);
    // Neighbors beyond a cone's edge can't draw its light, for which 1/M has a bias there.
    let settings = Settings { spatial: 0, ..Settings::default() };
    for (kind, image) in [
        ("restir", restir(&mut renderer, camera, settings, 2, 1)),
        ("reference", reference(&mut renderer, camera, 1)),
    ] {
        let single = truth.iter().map(|c| c.as_vec3()).collect::<Vec<_>>();
        let name = format!("{name}-{kind}");
        let found = error(&image, &truth);
        assert!(found < TOLERANCE, "{name}: error {found}; {}", failure::write(&name, SIZE, &image, &single));
        assert!(error(&image, &planted) > TOLERANCE, "{name}: the planted error was not seen");
    }
    assert_no_validation_messages(&device);
}

type Radiance<'a> = &'a dyn Fn(DVec3, DVec3) -> DVec3;

/// A leaning spot whose cone ends within the picture; the extension's attenuation in f64.
#[test]
fn a_spot_over_a_floor() {
    let axis = Vec3::new(0.2, -1.0, -0.1).normalize();
    let (inner_angle, outer_angle) = (0.2f32, 0.6f32);
    let PointLight { position, intensity, .. } = LIGHT;
    let spot = SpotLight { position, axis, intensity, inner_angle, outer_angle, radius: 0.0 };
    let radiance = |x: DVec3, eye: DVec3, power: i32| {
        let [cos_inner, cos_outer] = [inner_angle, outer_angle].map(|a| f64::from(a).cos());
        let cos = (x - position.as_dvec3()).normalize().dot(axis.as_dvec3());
        let t = ((cos - cos_outer) / (cos_inner - cos_outer)).clamp(0.0, 1.0);
        floor_radiance(x, eye, &LIGHT) * t.powi(power)
    };
    let scene = SceneDescription { lights: vec![spot.into()], ..scene(vec![], vec![], vec![]) };
    // The planted error: attenuation that is not squared.
    assert_known("spot", &scene, &|x, eye| radiance(x, eye, 2), &|x, eye| radiance(x, eye, 1));
}

#[test]
fn sunlight_on_a_floor() {
    let direction = Vec3::new(1.0, 2.0, -2.0) / 3.0;
    let sun = DirectionalLight { direction, illuminance: Vec3::new(9e4, 8e4, 7e4) };
    let radiance = |x: DVec3, eye: DVec3, factor: f64| {
        let wi = direction.as_dvec3();
        floor_bsdf(wi, (eye - x).normalize()) * sun.illuminance.as_dvec3() * wi.y * factor
    };
    let scene = SceneDescription { lights: vec![sun.into()], ..scene(vec![], vec![], vec![]) };
    assert_known("sun", &scene, &|x, eye| radiance(x, eye, 1.0), &|x, eye| radiance(x, eye, 1.002));
}

const OCCLUDER: Vec3 = Vec3::new(0.2, 1.0, 0.1);
const HALF: f64 = 0.35;

/// How far the segment from `a` to `b` passes the occluder's edge: positive inside, m; none where it misses the plane.
fn depth_inside(a: DVec3, b: DVec3) -> Option<f64> {
    let t = (f64::from(OCCLUDER.y) - a.y) / (b.y - a.y);
    let at = (a + t * (b - a) - OCCLUDER.as_dvec3()).abs();
    (0.0..1.0).contains(&t).then_some(HALF - at.x.max(at.z))
}

/// Settings under which the biased mode is exact for one light: with visibility reuse, a neighbor's empty reservoir
/// would darken the lit side of the edge.
fn exact_settings() -> [Settings; 2] {
    let default = Settings { mode: mode::BIASED, spatial_iterations: 2, ..Settings::default() };
    [Settings { visibility_reuse: 0, ..default }, Settings { spatial: 0, ..default }]
}

/// A hard shadow: away from its edge (1e-4 m), every pixel is either dark or exactly as lit as without the occluder.
#[test]
fn hard_shadow_of_a_square() {
    let Some(device) = device() else { return };
    let (u, v) = (Vec3::Z * HALF as f32, Vec3::X * HALF as f32);
    let scene = scene(vec![square(OCCLUDER, u, v, 1)], vec![Material::default()], vec![LIGHT]);
    let camera = camera(SIZE);
    let mut renderer = renderer(&device, &scene, SIZE, 1);
    let (eye, light) = (camera.position.as_dvec3(), LIGHT.position.as_dvec3());
    let mut images = vec![reference(&mut renderer, camera, 1)];
    images.extend(exact_settings().map(|settings| restir(&mut renderer, camera, settings, 3, 1)));
    let (mut dark, mut lit) = (0, 0);
    for (i, pixel) in pixels() {
        let Some(x) = floor_point(&camera, pixel, SIZE) else { continue };
        let covered = depth_inside(x, eye).unwrap_or(-1.0);
        let shadow = depth_inside(x, light).unwrap_or(-1.0);
        if covered > -1e-4 || shadow.abs() < 1e-4 {
            continue;
        }
        let expected = if shadow > 0.0 { DVec3::ZERO } else { floor_radiance(x, eye, &LIGHT) };
        *(if shadow > 0.0 { &mut dark } else { &mut lit }) += 1;
        for image in &images {
            let error = (image[i].as_dvec3() - expected).abs().max_element();
            assert!(error <= 5e-4 * expected.max_element(), "{pixel}: {} instead of {expected}", image[i]);
        }
    }
    // The picture shows both.
    assert!(dark > 100 && lit > 1000, "{dark} dark and {lit} lit pixels");
    assert_no_validation_messages(&device);
}
