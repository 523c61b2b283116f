//! Skins and morph targets. The oracle is the closed form of where joints and weights carry a point.

use super::*;
use std::f32::consts::FRAC_PI_2;

/// The quad's corners, m, in the order of its vertices.
const QUAD: [Vec3; 4] = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y];

/// Corners in the world, in the order of the first triangles that name them; and normals.
fn shown(scene: &SceneDescription, instance: usize) -> (Vec<Vec3>, Vec<Vec3>) {
    let Instance { mesh, transform, .. } = scene.instances[instance];
    let primitive = &scene.meshes[mesh].primitives[0];
    let world = |p: &Vec3| transform.transform_point3(*p) + scene.origin.as_vec3();
    (primitive.positions.iter().map(world).collect(), primitive.normals.clone())
}

fn assert_near(found: &[Vec3], expected: &[Vec3], what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}");
    let near = found.iter().zip(expected).all(|(a, b)| (*a - *b).length() < 1e-5);
    assert!(near, "{what}: {found:?} instead of {expected:?}");
}

/// The quad as a bar of two bones: the first holds its lower side (y = 0), the second, at y = 0.5, its upper one, which bends by a
/// quarter turn about z within a second. Nodes: 0 the quad, 1 the skeleton's root, which stands at x = 5, 2 and 3 its bones.
fn bar() -> File {
    let mut file = File::quad();
    file.attribute("JOINTS_0", &[[0u8, 0, 0, 0], [0; 4], [1, 0, 0, 0], [1, 0, 0, 0]].concat(), 5121, "VEC4");
    file.attribute("WEIGHTS_0", &floats(&[1.0, 0.0, 0.0, 0.0].repeat(4)), 5126, "VEC4");
    let unmoved = Mat4::IDENTITY.to_cols_array();
    let from_bone = Mat4::from_translation(Vec3::Y * -0.5).to_cols_array();
    let matrices = file.accessor(&floats(&[unmoved, from_bone].concat()), 5126, "MAT4");
    file.json["skins"] = json!([{"joints": [2, 3], "inverseBindMatrices": matrices}]);
    file.json["nodes"][0]["skin"] = json!(0);
    // Of a skinned node it counts for nothing.
    file.json["nodes"][0]["translation"] = json!([70, 0, 0]);
    let nodes = file.json["nodes"].as_array_mut().unwrap();
    nodes.push(json!({"translation": [5, 0, 0], "children": [2]}));
    nodes.push(json!({"children": [3]}));
    nodes.push(json!({"translation": [0, 0.5, 0]}));
    file.json["scenes"][0]["nodes"] = json!([0, 1]);
    file.json["animations"] = json!([{"samplers": [], "channels": []}]);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let turn = floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, half, half]);
    file.channel(3, "rotation", "LINEAR", &[0.0, 1.0], &turn, 5126, "VEC4");
    file
}

/// Where the upper corners are once the bar has bent by `angle`; the lower ones stay.
fn bent(angle: f32) -> [Vec3; 4] {
    let elbow = Vec3::new(5.0, 0.5, 0.0);
    QUAD.map(|corner| {
        let p = corner + Vec3::X * 5.0;
        let turned = glam::Quat::from_rotation_z(angle) * (p - elbow);
        if corner.y > 0.5 { elbow + turned } else { p }
    })
}

#[test]
fn a_bar_of_two_bones_bends() {
    let mut scene = bar().load().unwrap();
    assert!(scene.bends());
    assert_near(&shown(&scene, 0).0, &bent(0.0), "at rest");
    for time in [0.0f32, 0.25, 0.5, 1.0, 7.0] {
        scene.bend(Some(time.into()), |_| true);
        assert_near(&shown(&scene, 0).0, &bent(FRAC_PI_2 * time.min(1.0)), &format!("{time} s"));
    }
    // Where the bones share a corner, it is in the middle of where each would have it.
    let mut file = bar();
    let half = [0.5, 0.5, 0.0, 0.0].repeat(4);
    file.attribute("JOINTS_0", &[0u8, 1, 0, 0].repeat(4), 5121, "VEC4");
    file.attribute("WEIGHTS_0", &floats(&half), 5126, "VEC4");
    let mut scene = file.load().unwrap();
    scene.bend(Some(1.0), |_| true);
    let elbow = Vec3::new(5.0, 0.5, 0.0);
    let between = QUAD.map(|p| {
        let p = p + Vec3::X * 5.0;
        0.5 * (p + elbow + glam::Quat::from_rotation_z(FRAC_PI_2) * (p - elbow))
    });
    assert_near(&shown(&scene, 0).0, &between, "shared by both bones");
    // Weights count by their share.
    file.attribute("WEIGHTS_0", &floats(&half.iter().map(|w| w * 3.0).collect::<Vec<_>>()), 5126, "VEC4");
    let mut scene = file.load().unwrap();
    scene.bend(Some(1.0), |_| true);
    assert_near(&shown(&scene, 0).0, &between, "weights whose sum is 3");
}

/// n' = (M⁻¹)ᵀ n: a joint that stretches x by 2 turns (1, 1, 0) to (1/2, 1, 0).
#[test]
fn normals_follow_the_inverse_transpose() {
    let mut file = bar();
    let tilted = [std::f32::consts::FRAC_1_SQRT_2, std::f32::consts::FRAC_1_SQRT_2, 0.0].repeat(4);
    file.attribute("NORMAL", &floats(&tilted), 5126, "VEC3");
    file.attribute("JOINTS_0", &[0u8; 16], 5121, "VEC4");
    file.json["nodes"][2]["scale"] = json!([2, 1, 1]);
    let scene = file.load().unwrap();
    let (positions, normals) = shown(&scene, 0);
    assert_near(&positions, &QUAD.map(|p| p * Vec3::new(2.0, 1.0, 1.0) + Vec3::X * 5.0), "stretched");
    assert_near(&normals, &[Vec3::new(0.5, 1.0, 0.0).normalize(); 4], "normals");
}

#[test]
fn eight_joints_move_a_corner() {
    let mut file = File::quad();
    file.attribute("JOINTS_0", &[0u8, 1, 2, 3].repeat(4), 5121, "VEC4");
    file.attribute("WEIGHTS_0", &floats(&[0.2; 16]), 5126, "VEC4");
    let fifth: Vec<u8> = [4u16, 9, 9, 9].repeat(4).iter().flat_map(|joint| joint.to_le_bytes()).collect();
    file.attribute("JOINTS_1", &fifth, 5123, "VEC4");
    // Joint 9 is none.
    file.attribute("WEIGHTS_1", &floats(&[0.2, 0.0, 0.0, 0.0].repeat(4)), 5126, "VEC4");
    let nodes = file.json["nodes"].as_array_mut().unwrap();
    nodes[0]["skin"] = json!(0);
    nodes.extend((1..=5).map(|i| json!({"translation": [0, 0, 10 * i]})));
    file.json["skins"] = json!([{"joints": [1, 2, 3, 4, 5]}]);
    file.json["scenes"][0]["nodes"] = json!([0, 1, 2, 3, 4, 5]);
    let scene = file.load().unwrap();
    assert_near(&shown(&scene, 0).0, &QUAD.map(|p| p + Vec3::Z * 30.0), "the mean of five joints");
    assert!(!scene.bends() && scene.warnings.is_empty(), "{:?}", scene.warnings);
}

/// The quad with two morph targets: one lifts its far corner, the other moves all of it.
fn morphing() -> File {
    let mut file = File::quad();
    let lift =
        file.accessor(&floats(&[[0.0; 3], [0.0; 3], [0.0, 0.0, 1.0], [0.0; 3]].concat()), 5126, "VEC3");
    let lean = file.accessor(&floats(&[1.0, 0.0, -1.0].repeat(4)), 5126, "VEC3");
    let shift = file.accessor(&floats(&[0.0, 4.0, 0.0].repeat(4)), 5126, "VEC3");
    file.json["animations"] = json!([{"samplers": [], "channels": []}]);
    file.primitive()["targets"] = json!([{"POSITION": lift}, {"POSITION": shift, "NORMAL": lean}]);
    file
}

fn morphed(lift: f32, shift: f32) -> [Vec3; 4] {
    let mut corners = QUAD.map(|p| p + Vec3::Y * 4.0 * shift);
    corners[2].z += lift;
    corners
}

#[test]
fn morph_targets_have_weights() {
    let mut file = morphing();
    let load = |file: &File| file.load().unwrap();
    assert_near(&shown(&load(&file), 0).0, &QUAD, "no weights are 0");
    file.json["meshes"][0]["weights"] = json!([0.5, 0.25]);
    let scene = load(&file);
    assert_near(&shown(&scene, 0).0, &morphed(0.5, 0.25), "the mesh's weights");
    assert_near(&shown(&scene, 0).1, &[Vec3::new(0.25, 0.0, 0.75).normalize(); 4], "normals");
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    // A second node shows the same mesh in another shape, a third in a third one.
    let nodes = file.json["nodes"].as_array_mut().unwrap();
    nodes.push(json!({"mesh": 0, "weights": [1, 0], "translation": [0, 0, 3]}));
    nodes.push(json!({"mesh": 0, "weights": [0, 1]}));
    file.json["scenes"][0]["nodes"] = json!([0, 1, 2]);
    let scene = load(&file);
    assert_near(&shown(&scene, 0).0, &morphed(0.5, 0.25), "the mesh's weights");
    assert_near(&shown(&scene, 1).0, &morphed(1.0, 0.0).map(|p| p + Vec3::Z * 3.0), "the node's weights");
    assert_near(&shown(&scene, 2).0, &morphed(0.0, 1.0), "the other node's");
}

#[test]
fn weights_move() {
    let mut file = morphing();
    file.json["meshes"][0]["weights"] = json!([0.5, 0.25]);
    let values = floats(&[0.0, 1.0, 1.0, 0.0, 0.5, 0.5]);
    file.channel(0, "weights", "LINEAR", &[0.0, 1.0, 3.0], &values, 5126, "SCALAR");
    let mut scene = file.load().unwrap();
    assert_eq!(scene.animation.duration(), 3.0);
    assert_near(&shown(&scene, 0).0, &morphed(0.5, 0.25), "at rest");
    for (time, lift, shift) in
        [(0.0, 0.0, 1.0), (0.25, 0.25, 0.75), (1.0, 1.0, 0.0), (2.0, 0.75, 0.25), (9.0, 0.5, 0.5)]
    {
        scene.bend(Some(time), |_| true);
        assert_near(&shown(&scene, 0).0, &morphed(lift, shift), &format!("{time} s"));
    }
    // In-tangents, values and out-tangents of all targets: flat tangents give 3t² - 2t³.
    let mut file = morphing();
    let spline = floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
    file.channel(0, "weights", "CUBICSPLINE", &[0.0, 1.0], &spline, 5126, "SCALAR");
    let mut scene = file.load().unwrap();
    scene.bend(Some(0.25), |_| true);
    let eased = 3.0 * 0.0625 - 2.0 * 0.015625;
    assert_near(&shown(&scene, 0).0, &morphed(eased, 1.0 - eased), "a spline");
}

/// Without normals a surface is flat, whatever its shape (glTF 2.0, 3.7.2.2).
#[test]
fn flat_normals_are_those_of_the_shape() {
    let mut file = morphing();
    file.primitive()["attributes"].as_object_mut().unwrap().remove("NORMAL");
    file.json["meshes"][0]["weights"] = json!([1, 0]);
    let (positions, normals) = shown(&file.load().unwrap(), 0);
    for (t, normals) in positions.chunks_exact(3).zip(normals.chunks_exact(3)) {
        let face = (t[1] - t[0]).cross(t[2] - t[0]).normalize();
        assert!(face.z < 0.99, "it is bent: {face}");
        assert_near(normals, &[face; 3], "the triangle's normal");
    }
}

#[test]
fn broken_bends_leave_meshes_as_modelled() {
    type Fault = (&'static str, fn(&mut File));
    let faults: [Fault; 5] = [
        ("joint 1 is outside of the scene", |file| file.json["nodes"][2]["children"] = json!([])),
        ("joint 2 has no inverse bind matrix", |file| file.json["skins"][0]["joints"] = json!([2, 3, 1])),
        ("not finite", |file| {
            let broken = file.accessor(&floats(&[f32::NAN; 32]), 5126, "MAT4");
            file.json["skins"][0]["inverseBindMatrices"] = json!(broken);
        }),
        ("a skin without joints and weights", |file| {
            file.primitive()["attributes"].as_object_mut().unwrap().remove("WEIGHTS_0");
        }),
        ("WEIGHTS_0 is broken", |file| file.attribute("WEIGHTS_0", &floats(&[1.0; 8]), 5126, "VEC4")),
    ];
    for (text, plant) in faults {
        let mut file = bar();
        plant(&mut file);
        let mut scene = file.load().unwrap();
        scene.bend(Some(1.0), |_| true);
        assert_near(&shown(&scene, 0).0, &QUAD, text);
        assert!(scene.warnings.iter().any(|w| w.contains(text)), "{text}: {:?}", scene.warnings);
    }
    let mut file = morphing();
    let short = file.accessor(&floats(&[1.0; 6]), 5126, "VEC3");
    file.primitive()["targets"][0]["POSITION"] = json!(short);
    file.json["meshes"][0]["weights"] = json!([1, 1]);
    let scene = file.load().unwrap();
    assert_near(&shown(&scene, 0).0, &morphed(0.0, 1.0), "one target is left");
    assert!(scene.warnings[0].contains("target 0: 2 elements for 4 vertices"), "{:?}", scene.warnings);
}
