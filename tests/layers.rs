//! Light in parts: together they are the picture, alone they are what they are called, and who does not ask has none.

use candela::frame::renderer::{FrameOptions, Renderer};
use candela::frame::schedule::{Conditions, Primary, Rotation, Work, schedule};
use candela::scene::{Material, SceneDescription};
use candela_lab::explain::compare::ulps;
use glam::{UVec2, Vec3, Vec4};
use shared::camera::Camera;
use shared::frame::{Settings, features, mode};
use shared::resources::Resource;
use tests::gpu::{assert_no_validation_messages, device, options, renderer};
use tests::scenes::{camera, emitter, kinds, many_lights, occluded, pane, square};

const SIZE: UVec2 = UVec2::new(48, 32);
const PARTS: [Resource; 3] = [Resource::emission, Resource::direct_diffuse, Resource::direct_specular];
/// What rounding alone may put between the two ways to the sum of `terms`, ulp. All are positive, so errors only add up: each way
/// rounds a term at most 12 times, by half an ulp (2.5 in a division), and once more when it is added.
fn rounding(terms: u32) -> u64 {
    14 + u64::from(terms)
}

/// A red metal, a black body, and an emitter and a pane in view.
fn shown() -> SceneDescription {
    let color = |base_color: Vec4, metallic, roughness| Material {
        base_color,
        metallic,
        roughness,
        ..Material::default()
    };
    let mut scene = occluded(many_lights());
    let first = scene.materials.len();
    scene.materials.extend([
        color(Vec4::new(0.9, 0.1, 0.0, 1.0), 1.0, 0.4),
        color(Vec4::new(0.0, 0.0, 0.0, 1.0), 0.0, 0.3),
        emitter(Vec3::new(0.5, 2.0, 1.0)),
        pane(),
    ]);
    let places = [(-1.5, 0.0), (1.5, 0.0), (0.0, 1.0), (0.6, -0.4)];
    let squares = places
        .iter()
        .enumerate()
        .map(|(i, &(x, z))| square(Vec3::new(x, 0.1, z), Vec3::Z * 0.4, Vec3::X * 0.4, first + i));
    scene.meshes[0].primitives.extend(squares);
    scene
}

/// The last of three frames.
struct Frame {
    radiance: Vec<Vec3>,
    emission: Vec<Vec3>,
    /// Under an albedo of 1.
    diffuse: Vec<Vec3>,
    albedo: Vec<Vec3>,
    specular: Vec<Vec3>,
}

fn render(renderer: &mut Renderer, camera: Camera, options: &FrameOptions) -> Vec<Vec3> {
    renderer.restart();
    (0..3).for_each(|_| drop(renderer.render(camera, options).expect("the frame renders")));
    renderer.radiance().expect("the picture is read back")
}

fn in_parts(renderer: &mut Renderer, camera: Camera, options: &FrameOptions) -> Frame {
    let radiance = render(renderer, camera, &FrameOptions { parts: true, ..*options });
    let read = |resource| renderer.read::<Vec3>(resource).expect("it is read back");
    let albedo = renderer.gbuffer().expect("it is read back").iter().map(|texel| texel.diffuse()).collect();
    let [emission, diffuse, specular] = PARTS.map(read);
    Frame { radiance, emission, diffuse, albedo, specular }
}

/// The largest distance between pixels of `a` and of `b`, ulp.
fn distance(a: &[Vec3], b: &[Vec3]) -> u64 {
    let channels = |(a, b): (&Vec3, &Vec3)| (0..3).map(|i| ulps(a[i], b[i])).max();
    a.iter().zip(b).filter_map(channels).max().expect("pixels")
}

impl Frame {
    /// The sum of the parts, with `emissions` times the emission and an albedo of `albedo(the pixel's)`.
    fn sum(&self, emissions: f64, albedo: impl Fn(Vec3) -> Vec3) -> Vec<Vec3> {
        let pixel = |i: usize| {
            let [emission, diffuse, specular, albedo] =
                [self.emission[i], self.diffuse[i], self.specular[i], albedo(self.albedo[i])]
                    .map(Vec3::as_dvec3);
            (emission * emissions + albedo * diffuse + specular).as_vec3()
        };
        (0..self.radiance.len()).map(pixel).collect()
    }
}

/// The sum of the parts, in f64, is the picture that another frame shows as a whole; so is what `resolve` makes of them.
#[test]
fn the_parts_are_the_picture() {
    let Some(device) = device() else { return };
    let camera = camera(SIZE);
    let default = Settings { reservoirs: 2, ..Settings::default() };
    let (_, together) = kinds().pop().expect("scenes");
    for (name, scene) in [("lights", occluded(together)), ("materials", shown())] {
        let mut renderer = renderer(&device, &scene, SIZE, 2);
        let lights = renderer.scene().light_count();
        for (case, work) in [
            ("unbiased", Work::Restir(default)),
            ("biased", Work::Restir(Settings { mode: mode::BIASED, ..default })),
            ("reference", Work::Reference { lights }),
        ] {
            let options = options(work, 3);
            let whole = render(&mut renderer, camera, &options);
            let frame = in_parts(&mut renderer, camera, &options);
            let [sum, resolved] =
                [&frame.sum(1.0, |albedo| albedo), &frame.radiance].map(|sum| distance(sum, &whole));
            println!("{name}, {case}: {sum} ulp, resolved {resolved} ulp");
            let terms = if case == "reference" { lights } else { default.reservoirs };
            assert!(sum.max(resolved) <= rounding(terms), "{name}, {case}: {sum} and {resolved} ulp");
            // Negative controls.
            let doubled = distance(&frame.sum(2.0, |albedo| albedo), &whole);
            let white = distance(&frame.sum(1.0, |_| Vec3::ONE), &whole);
            assert!(white > 1000, "{name}, {case}: a forgotten albedo is {white} ulp");
            assert!(name == "lights" || doubled > 1000, "{case}: emission twice is {doubled} ulp");
        }
    }
    assert_no_validation_messages(&device);
}

/// Each part is what it is called: a metal has no diffuse albedo, light on it is finite all the same; only emitters emit.
#[test]
fn parts_are_what_they_are_called() {
    let Some(device) = device() else { return };
    let mut renderer = renderer(&device, &shown(), SIZE, 1);
    let frame = in_parts(&mut renderer, camera(SIZE), &options(Work::Restir(Settings::default()), 3));
    let parts = [&frame.emission, &frame.diffuse, &frame.specular];
    assert!(
        parts.iter().all(|part| part.iter().all(|light| light.is_finite() && light.min_element() >= 0.0))
    );
    let black: Vec<usize> = (0..frame.albedo.len()).filter(|&i| frame.albedo[i] == Vec3::ZERO).collect();
    let lit = |i: &&usize| frame.diffuse[**i] != Vec3::ZERO && frame.specular[**i] != Vec3::ZERO;
    assert!(black.iter().filter(lit).count() > 20, "no light on black bodies");
    let emitting = frame.emission.iter().filter(|&&light| light != Vec3::ZERO);
    assert!(emitting.clone().count() > 5);
    assert!(emitting.clone().all(|&light| light == Vec3::new(0.5, 2.0, 1.0) || light == Vec3::splat(40.0)));
}

/// Work, then the passes of a frame of it.
fn passes(work: Work, parts: bool, features: u32) -> Vec<&'static str> {
    let conditions = Conditions { parts, features, ..Default::default() };
    let (steps, _) = schedule(&work, conditions, Rotation::default());
    let touches = |resource| {
        steps.iter().flat_map(|step| &step.targets).any(|(.., target)| target.resource == resource)
    };
    assert_eq!(PARTS.map(touches), [parts; 3]);
    steps.iter().map(|step| step.pass.stem()).collect()
}

/// Parts cost who asks: one pass and 36 bytes a pixel. Others have no such pass, no such binding, no such memory.
#[test]
fn who_does_not_ask_has_none() {
    let default = Work::Restir(Settings::default());
    for (work, features) in [
        (default, 0),
        (default, features::ALPHA),
        (Work::Reference { lights: 0 }, 0),
        (Work::Reference { lights: 65 }, 0),
    ] {
        let (whole, parts) = (passes(work, false, features), passes(work, true, features));
        assert!(!whole.iter().any(|stem| stem.contains("parts") || *stem == "resolve"), "{whole:?}");
        let of_whole = |stem: &str| stem.replace("_parts", "");
        let expected: Vec<_> =
            parts.iter().filter(|stem| **stem != "resolve").map(|stem| of_whole(stem)).collect();
        if work != (Work::Reference { lights: 0 }) {
            assert_eq!(expected, whole);
        }
        assert_eq!(parts[parts.len() - 2..], ["resolve", "tonemap"]);
    }
    let Some(device) = device() else { return };
    let camera = camera(SIZE);
    let mut renderer = renderer(&device, &shown(), SIZE, 1);
    let options = FrameOptions::new(default, Primary::Rays, 3);
    render(&mut renderer, camera, &options);
    let before = renderer.target_bytes();
    render(&mut renderer, camera, &options);
    assert_eq!(renderer.target_bytes(), before);
    in_parts(&mut renderer, camera, &options);
    let pixels = u64::from(SIZE.element_product());
    assert_eq!(renderer.target_bytes() - before, 36 * pixels);
}
