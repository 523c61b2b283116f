use super::*;
use crate::scene::{Instance, Mesh, PlacedLight, PointLight, Primitive, SceneCamera, SpotLight};
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2};

fn track<T>(interpolation: Interpolation, times: &[f32], values: Vec<T>) -> Track<T> {
    Track { interpolation, times: times.to_vec(), values }
}

fn x(values: &[f64]) -> Vec<DVec3> {
    values.iter().map(|&x| DVec3::X * x).collect()
}

#[test]
fn steps_hold_and_lines_join() {
    let times = [1.0, 3.0, 4.0];
    let step = track(Interpolation::Step, &times, x(&[5.0, 7.0, -1.0]));
    let linear = track(Interpolation::Linear, &times, x(&[5.0, 7.0, -1.0]));
    for (time, stepped, joined) in [
        (0.0, 5.0, 5.0),
        (1.0, 5.0, 5.0),
        (1.5, 5.0, 5.5),
        (2.9999, 5.0, 6.9999),
        (3.0, 7.0, 7.0),
        (3.25, 7.0, 5.0),
        (4.0, -1.0, -1.0),
        (1e9, -1.0, -1.0),
    ] {
        assert_eq!(step.at(time).x, stepped, "at {time}");
        assert!((linear.at(time).x - joined).abs() < 1e-6, "at {time}: {}", linear.at(time));
    }
}

/// By hand: keys 1 (out-tangent 2) and 3 (in-tangent -1), 2 s apart. At the middle the basis of appendix C.5 is 1/2, 1/8, 1/2,
/// -1/8: 1/2 + 2·2/8 + 3/2 + 2·1/8 = 2.75. At a quarter: 27/32, 9/64, 5/32, -3/64: 0.84375 + 0.5625 + 0.46875 + 0.09375.
#[test]
fn cubic_splines_follow_the_specification() {
    let values = x(&[9.0, 1.0, 2.0, -1.0, 3.0, 9.0]);
    let spline = track(Interpolation::CubicSpline, &[1.0, 3.0], values);
    for (time, expected) in [(0.0, 1.0), (1.0, 1.0), (2.0, 2.75), (1.5, 1.96875), (3.0, 3.0), (4.0, 3.0)] {
        assert!((spline.at(time).x - expected).abs() < 1e-12, "at {time}: {}", spline.at(time));
    }
    // The derivative at the ends is the tangent: (p(ε) - p(0)) / ε.
    assert!(((spline.at(1.0 + 1e-6).x - 1.0) / 1e-6 - 2.0).abs() < 1e-4);
    assert!(((3.0 - spline.at(3.0 - 1e-6).x) / 1e-6 + 1.0).abs() < 1e-4);
}

/// A quarter turn about z: a third of the way is 30°, whichever sign the file gave the quaternion.
#[test]
fn rotations_turn_evenly_and_the_short_way() {
    let end = DVec4::new(0.0, 0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2);
    for end in [end, -end] {
        let turn = track(Interpolation::Linear, &[0.0, 3.0], vec![DVec4::W, end]);
        let expected = DVec4::new(0.0, 0.0, 0.258_819_045_102_520_8, 0.965_925_826_289_068_3);
        let found = turn.at(1.0);
        assert!((found - expected).abs().max_element() < 1e-14, "{found}");
    }
    // Negative control: a straight line between quaternions, made unit, is 1.1° off there.
    let chord = DVec4::W.lerp(end, 1.0 / 3.0).normalize();
    assert!((chord - DVec4::new(0.0, 0.0, 0.258_819, 0.965_926)).length() > 5e-3);
    // Keys that are (almost) the same, or opposite, give rotations.
    for other in [DVec4::W, DVec4::new(0.0, 0.0, 1e-9, 1.0), DVec4::X, -DVec4::W] {
        let still = track(Interpolation::Linear, &[0.0, 1.0], vec![DVec4::W, other]);
        assert!((still.at(0.5).length() - 1.0).abs() < 1e-12, "{other}");
    }
}

fn trs(translation: DVec3) -> Local {
    Local::Trs { translation, rotation: DQuat::IDENTITY, scale: DVec3::ONE }
}

fn spot(axis: Vec3) -> PlacedLight {
    let (inner_angle, outer_angle) = (0.1, 0.2);
    SpotLight { position: Vec3::ZERO, axis, intensity: Vec3::ONE, inner_angle, outer_angle, radius: 0.0 }
        .into()
}

/// A turntable at (10, 0, 0) that makes a quarter turn about z in 1 s; on it, 2 m out, an arm that slides along it, and at its
/// end everything that can hang on a node.
fn turntable() -> SceneDescription {
    let quarter = vec![DVec4::W, DVec4::new(0.0, 0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2)];
    let nodes = vec![
        Node { parent: None, base: DAffine3::from_translation(DVec3::X * 10.0), rest: trs(DVec3::ZERO) },
        Node { parent: Some(0), base: DAffine3::IDENTITY, rest: trs(DVec3::X * 2.0) },
        Node {
            parent: Some(1),
            base: DAffine3::IDENTITY,
            rest: Local::Matrix(DAffine3::from_rotation_y(FRAC_PI_2)),
        },
    ];
    let channel = |node, curve| Channel { node, curve };
    let slide = track(Interpolation::Linear, &[0.0, 2.0], vec![DVec3::X * 2.0, DVec3::X * 4.0]);
    let channels = vec![
        channel(0, Curve::Rotation(track(Interpolation::Linear, &[0.0, 1.0], quarter))),
        channel(1, Curve::Translation(slide)),
    ];
    let things = [Thing::Instance(0), Thing::Light(0), Thing::Light(1), Thing::Camera(0)];
    let triangle = Primitive {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        indices: vec![0, 1, 2],
        ..Primitive::default()
    };
    SceneDescription {
        meshes: vec![Mesh { name: String::new(), primitives: vec![triangle] }],
        instances: vec![Instance { name: String::new(), mesh: 0, transform: Default::default() }],
        lights: vec![
            PointLight { position: Vec3::ZERO, intensity: Vec3::ONE, radius: 0.0 }.into(),
            spot(Vec3::Y),
        ],
        cameras: vec![SceneCamera {
            name: "arm".into(),
            position: Vec3::ZERO,
            forward: Vec3::Z,
            up: Vec3::Y,
            fov_y: 1.0,
        }],
        animation: Animation {
            nodes,
            channels,
            attached: things.map(|thing| (thing, 2)).to_vec(),
            morphs: vec![],
        },
        ..SceneDescription::default()
    }
}

#[test]
fn poses_compose_from_the_root() {
    let mut scene = turntable();
    assert_eq!(scene.animation.duration(), 2.0);
    scene.apply(&scene.pose(0.0));
    // The arm's end looks along -z of its matrix, turned about y: along -x.
    assert!((scene.cameras[0].position - Vec3::X * 12.0).length() < 1e-6);
    assert!((scene.cameras[0].forward - Vec3::NEG_X).length() < 1e-6);
    scene.apply(&scene.pose(1.0));
    // A quarter turn later, 3 m out: it is above the table's middle and looks back down at it.
    let expected = Vec3::new(10.0, 3.0, 0.0);
    assert!((scene.cameras[0].position - expected).length() < 1e-6, "{}", scene.cameras[0].position);
    assert!((scene.cameras[0].forward - Vec3::NEG_Y).length() < 1e-6);
    assert!((scene.cameras[0].up - Vec3::NEG_X).length() < 1e-6 || scene.cameras[0].up.dot(Vec3::Z) < 1e-6);
    assert!((scene.lights[0].position().unwrap() - expected).length() < 1e-6);
    let PlacedLight::Spot(spot) = scene.lights[1] else { panic!("{:?}", scene.lights) };
    assert!((spot.axis - Vec3::NEG_Y).length() < 1e-6);
    let tip = scene.instances[0].transform.transform_point3(Vec3::X);
    // The mesh's x is the matrix's -z.
    assert!((tip - (expected + Vec3::NEG_Z)).length() < 1e-6, "{tip}");
    // After the end nothing moves any more.
    assert_eq!(scene.pose(2.0), scene.pose(99.0));
}

#[test]
fn the_sphere_of_a_scene_holds_all_poses() {
    let mut scene = turntable();
    let radius = scene.radius();
    let swept = scene.animation.swept(&scene);
    for i in 0..=40 {
        scene.apply(&scene.pose(f64::from(i) * 0.05));
        let at = scene.bounds();
        let slack = Vec3::splat(0.02);
        assert!(at.min.cmpge(swept.min - slack).all() && at.max.cmple(swept.max + slack).all());
        assert!(radius >= 0.99 * at.radius());
    }
    assert!(SceneDescription::default().animation.swept(&scene).min.x > 0.0, "empty");
}

#[test]
fn what_is_scaled_to_nothing_keeps_its_direction() {
    let mut scene = turntable();
    let nothing = DAffine3::from_scale(DVec3::ZERO);
    let places = scene.animation.attached.iter().map(|&(thing, _)| (thing, nothing)).collect();
    scene.apply(&Pose { places, bent: None });
    assert_eq!((scene.lights[1], scene.cameras[0].forward), (spot(Vec3::Y), Vec3::Z));
}

#[test]
fn only_cameras_ask_nothing_of_the_device() {
    let mut animation = turntable().animation;
    assert!(
        animation.moves_things() && animation.moves(Thing::Camera(0)) && !animation.moves(Thing::Camera(1))
    );
    animation.attached.retain(|(thing, _)| matches!(thing, Thing::Camera(_)));
    assert!(!animation.moves_things());
    assert!(!Animation::default().moves_things());
}
