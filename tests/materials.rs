//! What materials make of rays and light, on the device.

use candela::frame::pipelines::hit_groups;
use candela::frame::renderer::Renderer;
use candela::gpu_scene::GpuScene;
use candela::gpu_scene::arrays::SceneArrays;
use candela::gpu_scene::memory::{costs, light_tree};
use candela::scene::lights::{LightEdits, LightTable};
use candela::scene::{AlphaMode, Environment, Filter, Image, Material, PointLight, Primitive, Texture, Wrap};
use glam::{Affine3A, UVec2, Vec2, Vec3};
use shared::bsdf;
use shared::frame::Settings;
use shared::frame::features;
use shared::light::count::LightCount;
use shared::material::{Reflectance, UNLIT_WHITE, UvMap, slot};
use shared::math::luminance;
use shared::passes::Rays;
use std::sync::Arc;
use tests::gpu::{assert_no_validation_messages, device, reference, renderer, restir};
use tests::scenes::{camera, floor_point, floor_radiance, pane, scene, square};
use tests::statistics::{assert_means, block_means, largest_z, replicas};

const SIZE: UVec2 = UVec2::new(96, 64);
const LIGHT: PointLight =
    PointLight { position: Vec3::new(0.4, 2.0, -0.3), intensity: Vec3::new(100.0, 80.0, 60.0), radius: 0.0 };

fn pixels() -> impl Iterator<Item = (usize, UVec2)> {
    (0..SIZE.x * SIZE.y).map(|i| (i as usize, UVec2::new(i % SIZE.x, i / SIZE.x)))
}

/// A quad above the floor, seen from above: u grows along +x, v along +z.
fn lid(center: Vec3, half: f32) -> Primitive {
    let quad = square(center, Vec3::Z * half, Vec3::X * half, 1);
    // Corners: (-z, -x), (+z, -x), (+z, +x), (-z, +x).
    Primitive { uvs: vec![Vec2::ZERO, Vec2::Y, Vec2::ONE, Vec2::X], ..quad }
}

/// A texture of 2 x 2 RGBA texels, not interpolated.
fn texture(texels: [[u8; 4]; 4]) -> Texture {
    let image = Image { name: "test".into(), width: 2, height: 2, texels: texels.concat() };
    Texture { image: Arc::new(image), srgb: false, wrap: [Wrap::Repeat; 2], filter: Filter::NEAREST }
}

/// Single frames that trace one shadow ray a pixel for the one light, and so are exact but for stochastic alpha.
fn exact() -> Settings {
    Settings { spatial: 0, temporal: 0, ..Settings::default() }
}

/// A mask with holes in two of four quarters: its shadow on the floor is the lit quarters' projection, exactly.
#[test]
fn a_mask_has_the_shadow_of_its_solid_part() {
    const CENTER: Vec3 = Vec3::new(0.2, 1.0, 0.1);
    const HALF: f32 = 0.6;
    let Some(device) = device() else { return };
    let (solid, hole) = ([255, 255, 255, 255], [255, 255, 255, 100]);
    let masked = Material {
        alpha: AlphaMode::Mask { cutoff: 0.5 },
        base_color_texture: Some(0),
        double_sided: true,
        ..Material::default()
    };
    let mut scene = scene(vec![lid(CENTER, HALF)], vec![masked], vec![LIGHT]);
    // Rows along v: solid at (u < 1/2, v < 1/2) and (u > 1/2, v > 1/2).
    scene.textures = vec![texture([solid, hole, hole, solid])];
    let camera = camera(SIZE);
    let mut renderer = renderer(&device, &scene, SIZE, 1);
    let images = [reference(&mut renderer, camera, 1), restir(&mut renderer, camera, exact(), 1, 1)];
    let (eye, light) = (camera.position.as_dvec3(), LIGHT.position.as_dvec3());
    // Is the segment stopped? None within 1 mm of an edge.
    let stopped = |a: glam::DVec3, b: glam::DVec3| {
        let t = (f64::from(CENTER.y) - a.y) / (b.y - a.y);
        let at = (a + t * (b - a) - CENTER.as_dvec3()) / f64::from(HALF);
        let near = |x: f64| x.abs() < 2e-3 || (x.abs() - 1.0).abs() < 2e-3;
        if near(at.x) || near(at.z) {
            return None;
        }
        Some(at.x.abs() < 1.0 && at.z.abs() < 1.0 && (at.x < 0.0) == (at.z < 0.0))
    };
    let (mut dark, mut lit) = (0, 0);
    for (i, pixel) in pixels() {
        let Some(x) = floor_point(&camera, pixel, SIZE) else { continue };
        let (Some(false), Some(shadow)) = (stopped(x, eye), stopped(x, light)) else { continue };
        let expected = if shadow { glam::DVec3::ZERO } else { floor_radiance(x, eye, &LIGHT) };
        *(if shadow { &mut dark } else { &mut lit }) += 1;
        for image in &images {
            let error = (image[i].as_dvec3() - expected).abs().max_element();
            assert!(error <= 5e-4 * expected.max_element(), "{pixel}: {} instead of {expected}", image[i]);
        }
    }
    assert!(dark > 200 && lit > 1000, "{dark} dark and {lit} lit pixels");
    assert_no_validation_messages(&device);
}

/// A pane of alpha 1/2 over the whole floor, between it and the light, below the camera's view: the mean of many seeds
/// is half the light. 96 blocks, 64 seeds: |z| < 5.6 is a false alarm in 1e-4 of all seeds, and these are fixed.
#[test]
fn a_blended_pane_halves_the_light_in_the_mean() {
    const SEEDS: u32 = 64;
    const Z_LIMIT: f64 = 5.6;
    let Some(device) = device() else { return };
    let camera = camera(SIZE);
    // The light is below the camera's rays' way: the pane hides under it, beside what the camera sees through.
    // Around the light: every shadow ray crosses it once, near its end; few camera rays do.
    let scene = scene(vec![lid(LIGHT.position - Vec3::Y * 0.02, 0.3)], vec![pane()], vec![LIGHT]);
    let mut renderer = renderer(&device, &scene, SIZE, 1);
    let truth: Vec<Vec3> = pixels()
        .map(|(_, p)| {
            floor_point(&camera, p, SIZE).map_or(Vec3::ZERO, |x| {
                (0.5 * floor_radiance(x, camera.position.as_dvec3(), &LIGHT)).as_vec3()
            })
        })
        .collect();
    let truth: Vec<_> = block_means(&truth, SIZE).into_iter().map(|mean| (mean, 0.0)).collect();
    // Blocks without a camera ray through the pane, whose shadow rays meet it: below the light.
    let under: Vec<usize> = (0..truth.len())
        .filter(|&b| {
            let block = UVec2::new(b as u32 % (SIZE.x / 8), b as u32 / (SIZE.x / 8)) * 8;
            (0..64).all(|i| {
                let pixel = block + UVec2::new(i % 8, i / 8);
                floor_point(&camera, pixel, SIZE).is_some_and(|x| {
                    let meets = |to: glam::DVec3| {
                        let t = (f64::from(LIGHT.position.y) - 0.02 - x.y) / (to.y - x.y);
                        let at = (x + t * (to - x) - LIGHT.position.as_dvec3()).abs();
                        at.x.max(at.z)
                    };
                    meets(LIGHT.position.as_dvec3()) < 0.29 && meets(camera.position.as_dvec3()) > 0.31
                })
            })
        })
        .collect();
    assert!(under.len() > 40, "{} blocks", under.len());
    let pick = |means: &[(f64, f64)]| under.iter().map(|&b| means[b]).collect::<Vec<_>>();
    let with_history = Settings { temporal: 1, spatial: 1, radius: 8.0, ..Settings::default() };
    let cases: [(&str, Settings, u32); 2] = [("one frame", exact(), 1), ("reuse", with_history, 2)];
    let mut check = |name: &str, run: &mut dyn FnMut(&mut _, u32) -> Vec<Vec3>| {
        let means = replicas(SEEDS, SIZE, |seed| run(&mut renderer, seed));
        assert_means(name, &pick(&means), &pick(&truth), Z_LIMIT);
        // Negative control: light that the pane stops twice is seen.
        let off: Vec<_> = truth.iter().map(|&(mean, error)| (mean * 0.5, error)).collect();
        assert!(largest_z(&pick(&means), &pick(&off)).0 > Z_LIMIT, "{name}: half the light was not seen");
    };
    check("reference", &mut |renderer, seed| reference(renderer, camera, seed));
    for (name, settings, frames) in cases {
        check(name, &mut |renderer, seed| restir(renderer, camera, settings, frames, seed));
    }
    assert_no_validation_messages(&device);
}

/// Does any hit group of such rays run an any-hit shader?
fn any_hit(rays: Rays, features: u32) -> bool {
    hit_groups(rays, features).iter().any(|group| group.any_hit.is_some())
}

#[test]
fn scenes_without_alpha_have_no_any_hit() {
    let Some(device) = device() else { return };
    let with = |alpha| {
        let material = Material { alpha, ..Material::default() };
        GpuScene::new(&device, &scene(vec![lid(Vec3::Y, 0.5)], vec![material], vec![LIGHT]))
            .unwrap()
            .features()
    };
    for rays in [Rays::Primary, Rays::Shadow, Rays::Both] {
        assert!(!any_hit(rays, with(AlphaMode::Opaque) | features::TEXTURES | features::UV_MAPS));
        assert!(any_hit(rays, with(AlphaMode::Blend)));
        assert!(any_hit(rays, with(AlphaMode::Mask { cutoff: 0.5 })));
    }
}

/// What a scene has not, it pays nothing for: no buffer byte, no image, no hit shader. (Passes do not ask for scenes, and
/// pipelines are specialised with the same bits, so their code is gone too. All 11 bindings of set 0 exist always, as the
/// shaders' SPIR-V names them; a buffer without content has 16 bytes of memory.)
#[test]
fn unused_features_cost_nothing() {
    let Some(device) = device() else { return };
    let textured = Material { base_color_texture: Some(0), ..Material::default() };
    let mut second_set = textured.clone();
    second_set.uv_maps[slot::BASE_COLOR].set = 1;
    let normal_mapped = Material { normal_texture: Some(0), ..Material::default() };
    let glowing = Material { emission: Vec3::ONE, ..Material::default() };
    let lamp = Material { alpha: AlphaMode::Blend, ..glowing.clone() };
    let screen = Material { emissive_texture: Some(0), ..glowing.clone() };
    let blended = Material { alpha: AlphaMode::Blend, ..Material::default() };
    let sky = Environment { size: UVec2::new(4, 2), radiance: vec![Vec3::ONE; 8] };
    let plain = ["geometry", "materials", "point lights", "alias table"];
    type Case<'a> = (&'a str, Material, Option<Environment>, u32, &'a [&'a str]);
    let cases: [Case; 9] = [
        ("nothing", Material::default(), None, 0, &[]),
        ("texture", textured, None, features::TEXTURES, &["base color textures"]),
        (
            "second set",
            second_set,
            None,
            features::TEXTURES | features::UV_MAPS,
            &["second uv set", "base color textures"],
        ),
        ("normals", normal_mapped, None, features::TEXTURES | features::NORMAL_MAPS, &["normal maps"]),
        ("emission", glowing, None, features::TRACEABLE, &["emissive triangles"]),
        ("glass lamp", lamp, None, features::ALPHA, &["emissive triangles"]),
        ("screen", screen, None, features::TEXTURES, &["emissive triangles", "emissive textures"]),
        ("alpha", blended, None, features::ALPHA, &[]),
        (
            "sky",
            Material::default(),
            Some(sky),
            features::ENVIRONMENT | features::TRACEABLE,
            &["environment lights", "environment map"],
        ),
    ];
    for (name, material, environment, expected_features, expected) in cases {
        let has_texture = material.textures().iter().any(Option::is_some);
        let mut scene = scene(vec![lid(Vec3::Y, 0.5)], vec![material], vec![LIGHT]);
        scene.environment = environment;
        if has_texture {
            scene.textures = vec![texture([[255; 4]; 4])];
        }
        let gpu = GpuScene::new(&device, &scene).unwrap();
        let lights = LightTable::new(&scene);
        let costs = costs(&scene, &lights, &SceneArrays::new(&scene, &lights).unwrap());
        let names: Vec<_> = costs.iter().map(|c| c.feature).filter(|f| !plain.contains(f)).collect();
        assert_eq!(names, expected, "{name}");
        assert_eq!(gpu.features() & !features::LIGHT_KINDS, expected_features, "{name}");
        assert_eq!(gpu.image_count(), usize::from(has_texture), "{name}");
        // The list is what the device has, byte for byte.
        let images = ["base color textures", "normal maps", "emissive textures"];
        let listed: u64 = costs.iter().filter(|c| !images.contains(&c.feature)).map(|c| c.bytes).sum();
        assert_eq!(gpu.bytes(), listed, "{name}");
        let transparent = ["alpha", "glass lamp"].contains(&name);
        let any_hits = [Rays::Primary, Rays::Shadow, Rays::Both].map(|rays| any_hit(rays, gpu.features()));
        assert_eq!(any_hits, [transparent; 3], "{name}");
        // BSDF candidates, and the hit group of their rays, where a ray can find a light; none without visibility reuse.
        let traceable = ["emission", "sky"].contains(&name);
        assert_eq!(hit_groups(Rays::Both, gpu.features()).len(), 1 + usize::from(traceable), "{name}");
        let found = |settings: Settings| settings.bsdf_candidates(gpu.features());
        assert_eq!(found(Settings::default()), u32::from(traceable), "{name}");
        assert_eq!(found(Settings { visibility_reuse: 0, ..Settings::default() }), 0, "{name}");
    }
}

/// The light tree is there from the first frame on that draws from it: a tree of n lights has 2n - 1 nodes of 32 bytes, and a leaf and
/// a place of 4 bytes each a light. Other lights have none before the next such frame.
#[test]
fn a_light_tree_is_made_for_those_who_draw_from_it() {
    let Some(device) = device() else { return };
    let lit = |n: usize| scene(vec![lid(Vec3::Y, 0.5)], vec![Material::default()], vec![LIGHT; n]);
    let mut renderer = renderer(&device, &lit(3), SIZE, 1);
    let bytes = renderer.scene().bytes();
    let added = |renderer: &Renderer, bytes: u64| renderer.scene().bytes() - bytes;
    restir(&mut renderer, camera(SIZE), Settings::default(), 1, 1);
    assert_eq!(added(&renderer, bytes), 0);
    let drawn = Settings { cells: 1, ..Settings::default() };
    restir(&mut renderer, camera(SIZE), drawn, 2, 1);
    assert_eq!(added(&renderer, bytes), 5 * 32 + 3 * 8);
    assert_eq!(light_tree(LightCount::of(&LightTable::new(&lit(3)).lights)).bytes, 5 * 32 + 3 * 8);
    renderer.replace_lights(&lit(5), &LightEdits::default()).unwrap();
    // This frame stages the change.
    restir(&mut renderer, camera(SIZE), Settings::default(), 1, 1);
    let bytes = renderer.scene().bytes();
    restir(&mut renderer, camera(SIZE), drawn, 1, 1);
    assert_eq!(added(&renderer, bytes), 9 * 32 + 5 * 8);
    assert_no_validation_messages(&device);
}

/// The pixel that sees `point`.
fn pixel_of(point: Vec3) -> usize {
    let camera = camera(SIZE);
    let place = camera.project(point - camera.position, SIZE).as_uvec2();
    (place.y * SIZE.x + place.x) as usize
}

/// Each corner of an unlit quad shows the texel that its uv set and transform name.
#[test]
fn textures_lie_where_sets_and_transforms_put_them() {
    let Some(device) = device() else { return };
    let [black, red, green, blue] = [[0, 0, 0, 255], [255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255]];
    let colors = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    let camera = camera(SIZE);
    // Half a texture to the right; a quarter turn: (u, v) -> (v, 1 - u).
    let shift = UvMap { u: Vec3::new(1.0, 0.0, 0.5), ..UvMap::default() };
    let turn = UvMap { u: Vec3::new(0.0, 1.0, 0.0), v: Vec3::new(-1.0, 0.0, 1.0), set: 0 };
    let second = UvMap { set: 1, ..UvMap::default() };
    // What the quarters (u < 1/2, v < 1/2), (u > 1/2, v < 1/2), (.., v > 1/2), .. show.
    let cases = [
        (UvMap::default(), [0, 1, 2, 3]),
        (shift, [1, 0, 3, 2]),
        (turn, [2, 0, 3, 1]),
        // The second set is mirrored in u.
        (second, [1, 0, 3, 2]),
    ];
    for (map, expected) in cases {
        let mut material = Material { unlit: true, base_color_texture: Some(0), ..Material::default() };
        material.uv_maps[slot::BASE_COLOR] = map;
        let mut quad = lid(Vec3::Y * 0.5, 1.0);
        quad.second_uvs = quad.uvs.iter().map(|uv| Vec2::new(1.0 - uv.x, uv.y)).collect();
        let mut scene = scene(vec![quad], vec![material], vec![LIGHT]);
        scene.textures = vec![texture([black, red, green, blue])];
        let mut renderer = renderer(&device, &scene, SIZE, 1);
        let image = restir(&mut renderer, camera, exact(), 1, 1);
        for (i, texel) in expected.into_iter().enumerate() {
            let (x, z) = ([-0.5, 0.5][i % 2], [-0.5, 0.5][i / 2]);
            let seen = image[pixel_of(Vec3::new(x, 0.5, z))];
            let error = (seen - colors[texel] * UNLIT_WHITE).abs().max_element();
            assert!(error < 1e-3, "quarter {i} of {map:?}: {seen}");
        }
    }
    assert_no_validation_messages(&device);
}

/// A single-sided quad that turns its back is not there for the camera, mirrored or not, but for its shadow.
#[test]
fn backs_of_single_sided_surfaces_only_cast_shadows() {
    let Some(device) = device() else { return };
    let camera = camera(SIZE);
    let place = Vec3::new(0.0, 0.5, 0.0);
    for mirrored in [false, true] {
        for double_sided in [false, true] {
            for faces_up in [false, true] {
                let glow = Material { double_sided, unlit: true, ..Material::default() };
                let mut scene = scene(vec![], vec![glow], vec![LIGHT]);
                let half = if faces_up { Vec3::Z } else { -Vec3::Z };
                let quad = square(Vec3::ZERO, half, Vec3::X, 1);
                scene.meshes.push(candela::scene::Mesh { name: "quad".into(), primitives: vec![quad] });
                let scale = Vec3::new(if mirrored { -1.0 } else { 1.0 }, 1.0, 1.0);
                let transform = Affine3A::from_translation(place) * Affine3A::from_scale(scale);
                scene.instances.push(candela::scene::Instance { name: "quad".into(), mesh: 1, transform });
                let mut renderer = renderer(&device, &scene, SIZE, 1);
                let image = restir(&mut renderer, camera, exact(), 1, 1);
                // The floor is darker.
                let seen = luminance(image[pixel_of(place)]) > 0.9 * UNLIT_WHITE;
                assert_eq!(seen, faces_up || double_sided, "{mirrored} {double_sided} {faces_up}");
            }
        }
    }
    assert_no_validation_messages(&device);
}

fn direction(cos: f32, phi: f32) -> Vec3 {
    let sin = (1.0 - cos * cos).sqrt();
    Vec3::new(sin * phi.cos(), sin * phi.sin(), cos)
}

/// White furnace and reciprocity for both workflows. A diffuse white under a specular color makes no energy where the
/// specular color is at least 1/2: there (1 - max) takes more than Schlick's rise gives.
#[test]
fn both_workflows_keep_energy_and_are_reciprocal() {
    const N: usize = 200;
    for roughness in [0.3, 0.6, 1.0] {
        let models = [
            Reflectance::from_metallic_roughness(Vec3::ONE, 1.0, roughness),
            Reflectance::from_specular_glossiness(Vec3::ONE, Vec3::splat(0.5), roughness),
            Reflectance::from_specular_glossiness(Vec3::ONE, Vec3::new(1.0, 0.6, 0.2), roughness),
        ];
        for model in models {
            for cos in [0.1, 0.5, 0.9] {
                let wo = direction(cos, 0.3);
                let mut sum = glam::DVec3::ZERO;
                for i in 0..N * N {
                    // Midpoints in (cos², φ).
                    let wi = direction(
                        (((i % N) as f32 + 0.5) / N as f32).sqrt(),
                        std::f32::consts::TAU * ((i / N) as f32 + 0.5) / N as f32,
                    );
                    let f: Vec3 = bsdf::eval(&model, Vec3::Z, wo, wi);
                    let back: Vec3 = bsdf::eval(&model, Vec3::Z, wi, wo);
                    assert!((f - back).abs().max_element() <= 1e-4 * f.max_element(), "{f} and {back}");
                    sum += f.as_dvec3();
                }
                let albedo = (sum * std::f64::consts::PI / (N * N) as f64).max_element();
                assert!((0.3..1.01).contains(&albedo), "albedo {albedo}: {model:?}, cos {cos}");
            }
        }
    }
}
