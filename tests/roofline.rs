//! The kernels of the roofline trace the rays that they say they trace: what they count is what frames show.

use candela::frame::history::History;
use candela::frame::pass::Step;
use candela::frame::renderer::Renderer;
use candela::frame::schedule::{Primary, Work};
use candela::scene::lights::LightTable;
use candela::scene::{PointLight, SceneDescription};
use candela_lab::measure::roofline::{self, Frame};
use glam::{UVec2, Vec3};
use shared::camera::Camera;
use shared::frame::{FrameConstants, Settings};
use shared::passes::Pass;
use shared::passes::pair_targets::PairTargets;
use shared::reservoir::StoredReservoir;
use shared::resources::Binding;
use shared::surface::GBufferTexel;
use tests::gpu::{assert_no_validation_messages, device, options, renderer, restir};
use tests::scenes::{occluded, pane, scene, square};

const SIZE: UVec2 = UVec2::new(64, 48);

/// Squares over a floor that ends in the picture, under point lights.
fn horizon() -> (SceneDescription, Camera) {
    let light = |i: i32| PointLight {
        position: Vec3::new((i % 5) as f32 - 2.0, 1.0 + (i % 3) as f32 * 0.5, (i / 5) as f32 - 2.0),
        intensity: Vec3::splat(2f32.powi(i % 4)),
        radius: 0.0,
    };
    let scene = occluded(scene(vec![], vec![], (0..20).map(light).collect()));
    (scene, Camera::new(Vec3::new(0.0, 2.0, 5.0), Vec3::new(0.0, -1.5, -5.0), Vec3::Y, 1.0, SIZE))
}

/// Of point lights before a black background: a pixel that is empty was missed, and one that is lit has a ray that met nothing.
#[test]
fn hits_are_what_the_frame_shows() {
    let Some(device) = device() else { return };
    let (scene, camera) = horizon();
    let lights = LightTable::new(&scene);
    let mut renderer = renderer(&device, &scene, SIZE, 1);
    // Without reuse a frame does not depend on the ones before, but for its random numbers.
    let settings = Settings { visibility_reuse: 0, temporal: 0, spatial: 0, ..Settings::default() };
    let measured =
        roofline::measure(&mut renderer, &lights, Frame { camera, settings, primary: Primary::Rays }, 1)
            .unwrap();
    // The captured frame comes after the history: the same one once more.
    let radiance = restir(&mut renderer, camera, settings, roofline::HISTORY + 1, 0);
    let gbuffer: Vec<GBufferTexel> = renderer.parts().1.gbuffer().read_vec().unwrap();
    let of = |pass: &str| measured.rays.iter().find(|rays| rays.pass == pass).unwrap();

    let covered = gbuffer.iter().filter(|texel| !texel.is_empty()).count();
    let pixels = SIZE.element_product() as usize;
    let primary = of("gbuffer");
    assert!(covered > pixels / 4 && covered < pixels, "the scene has a background: {covered} of {pixels}");
    assert_eq!((primary.rays, primary.hits), (pixels, covered));

    let count_lit = |picture: &[Vec3]| picture.iter().filter(|c| **c != Vec3::ZERO).count();
    let (lit, shading) = (count_lit(&radiance), of("shade_traced"));
    assert!(shading.hits > 50 && lit > 1000, "{} hidden, {lit} lit", shading.hits);
    assert_eq!(shading.rays - shading.hits, lit);
    // The planted fault: the frame before has other rays.
    let before = restir(&mut renderer, camera, settings, roofline::HISTORY, 0);
    assert_ne!(shading.rays - shading.hits, count_lit(&before));

    assert_eq!(measured.rays.len(), 2, "no reuse, no other rays");
    assert_eq!(measured.copied, 2 * 32 * pixels as u64);
    assert_no_validation_messages(&device);
}

/// Unbiased reuse, pixel by pixel: a reservoir is empty after the last pass if the pass's second ray met something, and only then.
/// Where something is transparent, temporal reuse asks too, although nothing moves.
#[test]
fn second_rays_of_reuse_decide_over_reservoirs() {
    let Some(device) = device() else { return };
    let (solid, camera) = horizon();
    let mut glazed = solid.clone();
    glazed.materials.push(pane());
    let material = glazed.materials.len() - 1;
    glazed.meshes[0].primitives.push(square(Vec3::new(0.0, 9.0, 9.0), Vec3::X, Vec3::Z, material));
    for (temporal, scene) in [(0, &solid), (1, &glazed)] {
        let mut renderer = renderer(&device, scene, SIZE, 1);
        let lights = LightTable::new(scene);
        // Few candidates and short histories: survivors come from elsewhere often.
        let (candidates, radius, cap) = (1, 10.0, 1.0);
        let settings = Settings {
            candidates,
            pairs: 0,
            radius,
            temporal,
            confidence_cap: cap,
            history_cap: cap,
            ..Settings::default()
        };
        let frame = Frame { camera, settings, primary: Primary::Rays };
        let captured = roofline::capture(&mut renderer, &lights, frame).unwrap();
        let passes: Vec<_> = captured.iter().map(|captured| captured.pass).collect();
        let expected: &[&str] = match temporal {
            0 => &["gbuffer", "initial", "spatial_traced", "spatial_traced"],
            // Histories of the very same points need no ray.
            _ => &["gbuffer", "initial", "spatial_traced", "spatial_traced", "shade_traced"],
        };
        assert_eq!(passes, expected);
        let last = passes.iter().rposition(|&pass| pass == "spatial_traced").unwrap();
        let [asked, hits] = [last - 1, last].map(|i| captured[i].hits(&mut renderer).unwrap());

        restir(&mut renderer, camera, settings, roofline::HISTORY + 1, 0);
        let ended: Vec<StoredReservoir> = renderer.parts().1.shaded_reservoirs().read_vec().unwrap();
        let traced = |i: &usize| captured[last].rays[*i].traced != 0;
        let agrees = |hits: &[u32], i: usize| (hits[i] == 0) == (ended[i].contribution_weight > 0.0);
        let pixels: Vec<usize> = (0..ended.len()).filter(traced).collect();
        let hidden = pixels.iter().filter(|&&i| hits[i] != 0).count();
        assert!(pixels.len() > 100 && hidden > 0, "{hidden} of {} are hidden", pixels.len());
        assert!(pixels.iter().all(|&i| agrees(&hits, i)));
        // The planted fault: the answers to the first rays are other ones.
        assert!(!pixels.iter().all(|&i| agrees(&asked, i)));
    }
    assert_no_validation_messages(&device);
}

/// Reuse in pairs, pixel by pixel: the target at a partner's sample is 0 where the ray there met something, and only there.
#[test]
fn rays_of_pairs_decide_over_targets() {
    let Some(device) = device() else { return };
    let (scene, camera) = horizon();
    let mut renderer = renderer(&device, &scene, SIZE, 1);
    let lights = LightTable::new(&scene);
    let settings = Settings { candidates: 1, temporal: 0, pairs: 1, radius: 16.0, ..Settings::default() };
    let captured =
        roofline::capture(&mut renderer, &lights, Frame { camera, settings, primary: Primary::Rays })
            .unwrap();
    let passes: Vec<_> = captured.iter().map(|captured| captured.pass).collect();
    assert_eq!(passes[passes.len() - 1..], ["pair_targets"]);
    let rays = &captured[captured.len() - 1];
    let hits = rays.hits(&mut renderer).unwrap();

    let targets = |renderer: &mut Renderer, before: u32| {
        restir(renderer, camera, settings, before, 0);
        let frame = options(Work::Restir(settings), 0);
        let (recorder, history) = renderer.parts();
        let mut targets: Vec<PairTargets> = Vec::new();
        let read = |history: &History, _: &FrameConstants, step: &Step| {
            if step.pass == Pass::pair_targets {
                targets = history.read(step.target(Binding::pair_targets).unwrap())?;
            }
            Ok(())
        };
        recorder.render_stepwise(history, camera, &frame, read).unwrap();
        targets
    };
    let traced: Vec<usize> = (0..hits.len()).filter(|&i| rays.rays[i].traced != 0).collect();
    let hidden = traced.iter().filter(|&&i| hits[i] != 0).count();
    assert!(traced.len() > 300 && hidden > 20, "{hidden} of {} are hidden", traced.len());
    let agree =
        |targets: &[PairTargets]| traced.iter().all(|&i| (hits[i] == 0) == (targets[i].partner > 0.0));
    assert!(agree(&targets(&mut renderer, roofline::HISTORY)));
    // The planted fault: the frame before has other partners.
    assert!(!agree(&targets(&mut renderer, roofline::HISTORY - 1)));
    assert_no_validation_messages(&device);
}
