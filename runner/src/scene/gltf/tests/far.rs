//! Files far from zero.

use super::*;
use glam::{DVec3, Vec3};

const FAR: [f64; 3] = [1e5, -3e4, 2e5];

/// Corner `i` of the only triangle list, where instance 0 has it, m.
fn corner(scene: &SceneDescription, i: usize) -> Vec3 {
    let p = scene.meshes[scene.instances[0].mesh].primitives[0].positions[i];
    scene.instances[0].transform.transform_point3(p)
}

/// A quad of 1 m, its light and its camera, with corners and details of 1 mm.
fn detailed(root: [f64; 3]) -> File {
    let mut file = File::quad();
    file.json["scenes"][0]["nodes"] = json!([0]);
    file.json["nodes"] = json!([
        {"children": [1, 2, 3], "translation": root},
        {"mesh": 0, "translation": [0.001, 0.002, 0.003]},
        {"camera": 0, "translation": [0.25, 0.125, 2.001]},
        {"extensions": {"KHR_lights_punctual": {"light": 0}}, "translation": [0.5, 0.5, 1.001]},
    ]);
    file.json["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}}]);
    file.json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    file.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [{"type": "point"}]}});
    file
}

/// All of it keeps its place to 1e-7 m; in f32 around zero the steps would be 8 mm.
#[test]
fn far_nodes_lose_nothing() {
    let (near, far) = (detailed([0.0; 3]).load().unwrap(), detailed(FAR).load().unwrap());
    assert_eq!(near.origin, DVec3::ZERO);
    assert!((far.origin - DVec3::from(FAR)).length() < 1.0, "{}", far.origin);
    let shift = (far.origin - DVec3::from(FAR)).as_vec3();
    let places = |scene: &SceneDescription| {
        let light = scene.lights[0].position().unwrap();
        [corner(scene, 0), corner(scene, 2), scene.cameras[0].position, light]
    };
    for (near, far) in places(&near).into_iter().zip(places(&far)) {
        assert!((far + shift - near).length() < 3e-7, "{near} became {}", far + shift);
    }
    // Negative control: what f32 around zero keeps of one of them.
    let corner = corner(&near, 0).as_dvec3();
    let rounded = (DVec3::from(FAR) + corner).as_vec3().as_dvec3() - DVec3::from(FAR);
    assert!((rounded - corner).length() > 1e-3);
}

/// Vertices that are far by themselves: what the file's numbers still say is kept.
#[test]
fn far_vertices_become_near() {
    let mut file = File::quad();
    let p = |x: f32, y: f32| [100_000.0 + x, y, -200_000.0];
    let corners = [p(0.0, 0.0), p(1.0, 0.0), p(1.0, 1.0), p(0.0, 1.0)].concat();
    let view = file.view(&floats(&corners));
    file.json["accessors"][POSITIONS]["bufferView"] = view.into();
    file.json["nodes"][0]["translation"] = json!([-1.0, 2.0, 0.5]);
    let scene = file.load().unwrap();
    assert!((scene.origin - DVec3::new(99_999.5, 2.5, -199_999.5)).length() < 1e-6, "{}", scene.origin);
    assert!(scene.meshes[0].bounds().radius() < 1.0 && scene.meshes[0].bounds().center().length() < 1.0);
    for (i, exact) in [(0, [99_999.0, 2.0]), (2, [100_000.0, 3.0])] {
        let exact = DVec3::new(exact[0], exact[1], -199_999.5);
        assert!((scene.origin + corner(&scene, i).as_dvec3() - exact).length() < 1e-6);
    }
}

/// A far mesh of far vertices that moves: at each time it is where the file says.
#[test]
fn far_things_move() {
    let mut file = File::quad();
    let corners =
        [[5e4f32, 0.0, 0.0], [5e4 + 1.0, 0.0, 0.0], [5e4 + 1.0, 1.0, 0.0], [5e4, 1.0, 0.0]].concat();
    let view = file.view(&floats(&corners));
    file.json["accessors"][POSITIONS]["bufferView"] = view.into();
    file.json["animations"] = json!([{"channels": [], "samplers": []}]);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    // A quarter turn about z puts (x, y) at (-y, x).
    file.channel(
        0,
        "rotation",
        "STEP",
        &[0.0, 1.0],
        &floats(&[0., 0., 0., 1., 0., 0., half, half]),
        5126,
        "VEC4",
    );
    let mut scene = file.load().unwrap();
    for (time, exact) in [(0.0, DVec3::new(5e4 + 1.0, 1.0, 0.0)), (1.0, DVec3::new(-1.0, 5e4 + 1.0, 0.0))] {
        let pose = scene.pose(time);
        scene.apply(&pose);
        let there = scene.origin + corner(&scene, 2).as_dvec3();
        // The rotation itself has 24 bits: 3 mm over 5e4 m; about the quad's own middle it is exact to 1e-7.
        assert!((there - exact).length() < 6e-3, "at {time} s: {there} instead of {exact}");
        let edge = corner(&scene, 2) - corner(&scene, 3);
        let turned = if time == 0.0 { Vec3::X } else { Vec3::Y };
        assert!((edge - turned).length() < if time == 0.0 { 1e-6 } else { 8e-3 }, "{edge}");
    }
}
