//! Animations: what arrives, and what is wrong with those that don't.

use super::*;
use crate::scene::animation::{Curve, Interpolation, Thing};
use glam::{DVec3, DVec4};

/// The quad on a node that slides along x and turns about z, a quad that hangs on it, and one that rests.
fn moving() -> File {
    let mut file = File::quad();
    file.json["scenes"][0]["nodes"] = json!([0, 2]);
    file.json["nodes"] = json!([
        {"name": "slider", "children": [1], "translation": [9, 9, 9]},
        {"name": "rider", "mesh": 0, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,5,0,1]},
        {"name": "rest", "mesh": 0},
    ]);
    file.json["animations"] = json!([{"name": "Go", "channels": [], "samplers": []}]);
    let slide = floats(&[0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 2.0, 0.0, 4.0]);
    file.channel(0, "translation", "LINEAR", &[0.0, 1.0, 3.0], &slide, 5126, "VEC3");
    file
}

impl File {
    /// Adds a channel to the first animation.
    #[allow(clippy::too_many_arguments)]
    pub(super) fn channel(
        &mut self,
        node: usize,
        path: &str,
        interpolation: &str,
        times: &[f32],
        values: &[u8],
        component: u32,
        kind: &str,
    ) {
        let input = self.accessor(&floats(times), 5126, "SCALAR");
        let output = self.accessor(values, component, kind);
        let animation = &mut self.json["animations"][0];
        let sampler = push(
            &mut animation["samplers"],
            json!({"input": input, "output": output, "interpolation": interpolation}),
        );
        let target = json!({"node": node, "path": path});
        push(&mut animation["channels"], json!({"sampler": sampler, "target": target}));
    }
}

#[test]
fn only_what_moves_is_kept() {
    let scene = moving().load().unwrap();
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    assert_eq!(scene.animation.nodes.len(), 2);
    assert_eq!(scene.animation.attached, [(Thing::Instance(0), 1)]);
    // At rest until a pose is applied.
    assert_eq!(scene.instances[0].transform.translation.to_array(), [9.0, 14.0, 9.0]);
    let pose = scene.pose(2.0);
    assert_eq!(pose.places.len(), 1);
    assert_eq!(pose.places[0].1.translation, DVec3::new(2.0, 5.0, 2.0));
    assert!(File::quad().load().unwrap().animation == Default::default());
}

#[test]
fn rotations_come_in_any_format() {
    let words = |q: [i16; 4]| q.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    for (component, bytes) in [
        (5120, vec![0u8, 0, 0, 127, 0, 0, 127, 127]),
        (5122, [words([0, 0, 0, 32767]), words([0, 0, 32767, 32767])].concat()),
        (5126, floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 5.0, 5.0])),
    ] {
        let mut file = moving();
        // The helper counts elements of 1, 2 or 4 bytes by glTF's unsigned codes.
        let unsigned = if component == 5126 { component } else { component + 1 };
        file.channel(0, "rotation", "STEP", &[0.0, 1.0], &bytes, unsigned, "VEC4");
        let accessor = file.json["accessors"].as_array().unwrap().len() - 1;
        file.json["accessors"][accessor]["componentType"] = json!(component);
        file.json["accessors"][accessor]["normalized"] = json!(component != 5126);
        let scene = file.load().unwrap();
        let Curve::Rotation(track) = &scene.animation.channels[1].curve else { panic!("{component}") };
        assert_eq!(track.interpolation, Interpolation::Step);
        let half = std::f64::consts::FRAC_1_SQRT_2;
        assert!((track.values[1] - DVec4::new(0.0, 0.0, half, half)).length() < 1e-6, "{component}");
    }
}

#[test]
fn of_two_channels_for_one_property_the_first_is_played() {
    let mut file = moving();
    let far = floats(&[9.0; 6]);
    file.channel(0, "translation", "STEP", &[0.0, 1.0], &far, 5126, "VEC3");
    file.channel(2, "weights", "STEP", &[0.0, 1.0], &floats(&[1.0; 2]), 5126, "SCALAR");
    let scene = file.load().unwrap();
    assert_eq!(scene.animation.channels.len(), 1);
    assert_eq!(
        scene.warnings,
        ["not played: another channel moves the same property: animation 0 'Go', channel 1"]
    );
}

#[test]
fn nodes_outside_of_the_scene_may_move() {
    let mut file = moving();
    file.json["scenes"][0]["nodes"] = json!([2]);
    let scene = file.load().unwrap();
    assert!(scene.animation.nodes.is_empty());
    assert_eq!(scene.warnings, ["moves a node outside of the scene: animation 0 'Go', channel 0"]);
}

#[test]
fn what_moves_may_start_at_nothing() {
    let mut file = moving();
    file.json["nodes"][0]["scale"] = json!([0, 0, 0]);
    file.channel(0, "scale", "LINEAR", &[0.0, 1.0], &floats(&[0., 0., 0., 1., 1., 1.]), 5126, "VEC3");
    let scene = file.load().unwrap();
    assert_eq!((scene.instances.len(), scene.warnings.len()), (2, 0));
}

/// What can't be played is left out, with a line that names the animation, the channel and the fault.
#[test]
fn faults_are_named_and_not_played() {
    let three = || floats(&[0.0; 9]);
    type Fault = (&'static str, &'static str, Vec<f32>, Vec<u8>, u32, &'static str, &'static str);
    let faults: [Fault; 8] = [
        (
            "translation",
            "LINEAR",
            vec![0.0, 2.0, 1.0],
            three(),
            5126,
            "VEC3",
            "key 2 at 1 s comes before key 1 at 2 s",
        ),
        (
            "translation",
            "STEP",
            vec![0.0, f32::NAN, 1.0],
            three(),
            5126,
            "VEC3",
            "key 1: NaN s is not a time",
        ),
        ("translation", "STEP", vec![-1.0, 0.0, 1.0], three(), 5126, "VEC3", "key 0: -1 s is not a time"),
        ("scale", "LINEAR", vec![0.0, 1.0], three(), 5126, "VEC3", "3 values for 2 keys"),
        (
            "scale",
            "CUBICSPLINE",
            vec![0.0, 1.0, 2.0],
            three(),
            5126,
            "VEC3",
            "3 values for 3 keys of CubicSpline",
        ),
        (
            "scale",
            "STEP",
            vec![0.0],
            floats(&[0.0, f32::INFINITY, 0.0]),
            5126,
            "VEC3",
            "key 0: its value is not finite",
        ),
        ("rotation", "STEP", vec![0.0], floats(&[0.0; 4]), 5126, "VEC4", "key 0: 0 is not a rotation"),
        ("rotation", "STEP", vec![0.0], three()[..12].to_vec(), 5126, "VEC3", "values: accessor"),
    ];
    for (path, interpolation, times, values, component, kind, fault) in faults {
        let mut file = moving();
        // Not the node that moves already.
        file.channel(2, path, interpolation, &times, &values, component, kind);
        let scene = file.load().unwrap();
        assert_eq!(scene.animation.channels.len(), 1);
        let [line] = &scene.warnings[..] else { panic!("{:?}", scene.warnings) };
        assert!(
            line.starts_with("not played: animation 0 'Go', channel 1: ") && line.contains(fault),
            "{line}"
        );
    }
    let mut file = moving();
    file.channel(1, "translation", "STEP", &[0.0], &floats(&[0.0; 3]), 5126, "VEC3");
    assert_eq!(
        file.load().unwrap().warnings,
        [
            "not played: animation 0 'Go', channel 1: its node has a matrix; only translation, rotation, scale can move"
        ]
    );
}

#[test]
fn of_keys_at_one_time_the_last_counts() {
    let mut file = moving();
    let jump = floats(&[0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 6.0, 0.0, 0.0, 8.0, 0.0, 0.0]);
    file.channel(2, "translation", "LINEAR", &[0.0, 1.0, 1.0, 2.0], &jump, 5126, "VEC3");
    let scene = file.load().unwrap();
    let x =
        |time| scene.pose(time).places.iter().find(|p| p.0 == Thing::Instance(1)).unwrap().1.translation.x;
    assert_eq!([x(0.5), x(1.0), x(1.5), x(2.0)], [1.0, 6.0, 7.0, 8.0]);
    assert_eq!(
        scene.warnings,
        ["several keys at one time: the last one counts: animation 0 'Go', channel 1"]
    );
}

/// Channels name samplers of their own animation, not those of the one before it.
#[test]
fn an_animation_without_samplers_moves_nothing() {
    for samplers in [Value::Null, json!("none")] {
        let mut file = moving();
        let channel = json!({"sampler": 0, "target": {"node": 2, "path": "translation"}});
        push(&mut file.json["animations"], json!({"channels": [channel], "samplers": samplers}));
        let scene = file.load().unwrap();
        assert_eq!(scene.animation.channels.len(), 1);
        let warnings = scene.warnings.concat();
        assert!(warnings.contains("animation sampler 0 of 0 does not exist"), "{warnings}");
    }
}

/// What glTF 2.0 does not know, or an extension means, must not keep the rest from moving.
#[test]
fn channels_that_can_not_be_read_go_alone() {
    let target = |target: Value| {
        move |file: &mut File| {
            let animation = &mut file.json["animations"][0];
            push(&mut animation["channels"], json!({"sampler": 0, "target": target}));
        }
    };
    let sampler = |key: &'static str, value: Value| {
        move |file: &mut File| {
            file.channel(2, "scale", "STEP", &[0.0], &floats(&[1.0; 3]), 5126, "VEC3");
            file.json["animations"][0]["samplers"][1][key] = value;
        }
    };
    type Change = Box<dyn FnOnce(&mut File)>;
    let changes: [(Change, &str); 8] = [
        (Box::new(target(json!({"node": 2, "path": "colour"}))), "\"colour\" is not one of translation"),
        (Box::new(target(json!({"path": "translation"}))), "it has no node"),
        (
            Box::new(target(
                json!({"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": "/nodes/0"}}}),
            )),
            "target: it has no node",
        ),
        (Box::new(target(json!({"node": 77, "path": "scale"}))), "node 77 of 3 does not exist"),
        (
            Box::new(|file| _ = push(&mut file.json["animations"][0]["channels"], json!(null))),
            "it is not an object",
        ),
        (Box::new(sampler("input", json!(77))), "accessor 77 of"),
        (Box::new(sampler("output", json!(-1))), "-1 is not an index"),
        (Box::new(sampler("interpolation", json!("SMOOTH"))), "\"SMOOTH\" is not one of LINEAR"),
    ];
    for (change, fault) in changes {
        let mut file = moving();
        change(&mut file);
        let scene = file.load().unwrap();
        assert_eq!(scene.animation.channels.len(), 1, "{fault}");
        let [line] = &scene.warnings[..] else { panic!("{:?}", scene.warnings) };
        assert!(
            line.starts_with("ignored as unreadable: animation 0 'Go', 1: ") && line.contains(fault),
            "{line}"
        );
    }
    // An animation that is none at all.
    let mut file = moving();
    push(&mut file.json["animations"], json!({"name": "empty"}));
    push(&mut file.json["animations"], json!(7));
    assert_eq!(file.load().unwrap().animation.channels.len(), 1);
}
