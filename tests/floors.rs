//! The kernels that measure floors trace the rays that they say they trace: what they count is what frames show.

use candela::measure::floors::{self, Kind};
use candela::scene::PointLight;
use candela::scene::lights::LightTable;
use glam::{UVec2, Vec3};
use shared::camera::Camera;
use shared::frame::Settings;
use shared::surface::GBufferTexel;
use tests::gpu::{assert_no_validation_messages, device, renderer, restir};
use tests::scenes::{occluded, scene};

const SIZE: UVec2 = UVec2::new(64, 48);

/// Of point lights before a black background: a pixel that is empty was missed, and one that is lit has a ray that met nothing.
#[test]
fn hits_are_what_the_frame_shows() {
    let Some(device) = device() else { return };
    let light = |i: i32| PointLight {
        position: Vec3::new((i % 5) as f32 - 2.0, 1.0 + (i % 3) as f32 * 0.5, (i / 5) as f32 - 2.0),
        intensity: Vec3::splat(2f32.powi(i % 4)),
    };
    let scene = occluded(scene(vec![], vec![], (0..20).map(light).collect()));
    // A horizon in the picture.
    let camera = Camera::new(Vec3::new(0.0, 2.0, 5.0), Vec3::new(0.0, -1.5, -5.0), Vec3::Y, 1.0, SIZE);
    let lights = LightTable::new(&scene);
    let mut renderer = renderer(&device, &scene, SIZE, 1);
    // Without reuse a frame does not depend on the ones before, but for its random numbers.
    let settings = Settings { visibility_reuse: 0, temporal: 0, spatial: 0, ..Settings::default() };
    let measured = floors::measure(&mut renderer, &lights, camera, settings, 1).unwrap();
    // The captured frame comes after the history: the same one once more.
    let radiance = restir(&mut renderer, camera, settings, floors::HISTORY + 1, 0);
    let gbuffer: Vec<GBufferTexel> = renderer.parts().1.gbuffer().read_vec().unwrap();
    let of = |kind: Kind| measured.rays.iter().find(|rays| rays.kind == kind).unwrap();

    let covered = gbuffer.iter().filter(|texel| !texel.is_empty()).count();
    let pixels = SIZE.element_product() as usize;
    let primary = of(Kind::Primary);
    assert!(covered > pixels / 4 && covered < pixels, "the scene has a background: {covered} of {pixels}");
    assert_eq!((primary.rays, primary.hits), (pixels, covered));

    let count_lit = |picture: &[Vec3]| picture.iter().filter(|c| **c != Vec3::ZERO).count();
    let (lit, shading) = (count_lit(&radiance), of(Kind::Shading));
    assert!(shading.hits > 50 && lit > 1000, "{} hidden, {lit} lit", shading.hits);
    assert_eq!(shading.rays - shading.hits, lit);
    // The planted fault: the frame before has other rays.
    let before = restir(&mut renderer, camera, settings, floors::HISTORY, 0);
    assert_ne!(shading.rays - shading.hits, count_lit(&before));

    assert!(of(Kind::Visibility).rays <= covered && of(Kind::Visibility).rays > covered / 2);
    assert!(of(Kind::Neighbor).rays <= covered && of(Kind::Neighbor).hits > 0);
    assert_eq!(measured.copied, 2 * 32 * pixels as u64);
    assert_no_validation_messages(&device);
}
