//! Small scenes with known answers, as files: one step of a loader or of the estimator each. No function here rounds
//! differently from one machine to another (no sine, no power), so the files can be compared byte by byte.

use super::animation::{Channel, Curve, Interpolation, Local, Node, Thing, Track};
use super::export::to_glb;
use super::procedural::shapes::{Shape, cuboid, polygon};
use super::{Instance, Material, Mesh, PointLight, SceneCamera, SceneDescription};
use crate::error::Result;
use crate::image_io;
use glam::{Affine3A, DAffine3, DQuat, DVec3, DVec4, Mat3, Vec3, Vec4};
use std::path::{Path, PathBuf};

/// File name without its extension, and the scene.
pub fn all() -> Vec<(&'static str, SceneDescription)> {
    vec![
        ("cornell-box", cornell_box()),
        ("emissive-triangles", emissive_triangles()),
        ("point-lights", point_lights()),
        ("occluder", occluder()),
        ("instances", instances()),
        ("moving", moving()),
    ]
}

/// Writes each scene to `directory` as `<name>.glb`; a file that is there already is replaced as a whole.
pub fn write_all(directory: &Path) -> Result<Vec<PathBuf>> {
    image_io::create_folder(directory)?;
    let mut paths = Vec::new();
    for (name, scene) in all() {
        let path = directory.join(format!("{name}.glb"));
        image_io::replace(&path, &to_glb(&scene)?)?;
        paths.push(path);
    }
    Ok(paths)
}

/// Adds `shape` under `material` as an instance of its own.
fn add(scene: &mut SceneDescription, name: &str, shape: Shape, material: Material) {
    let primitive = shape.into_primitive(scene.materials.len(), false);
    scene.materials.push(Material { name: name.into(), ..material });
    scene.instances.push(Instance {
        name: name.into(),
        mesh: scene.meshes.len(),
        transform: Affine3A::IDENTITY,
    });
    scene.meshes.push(Mesh { name: name.into(), primitives: vec![primitive] });
}

fn scene(name: &str, camera: Vec3, target: Vec3) -> SceneDescription {
    let camera = SceneCamera {
        name: "camera".into(),
        position: camera,
        forward: (target - camera).normalize(),
        up: Vec3::Y,
        fov_y: 0.75,
    };
    SceneDescription { name: name.into(), cameras: vec![camera], ..SceneDescription::default() }
}

fn diffuse(color: [f32; 3]) -> Material {
    Material { base_color: Vec4::from((Vec3::from(color), 1.0)), ..Material::default() }
}

/// Black, emitting `nit`.
fn emitter(nit: Vec3, double_sided: bool) -> Material {
    Material { emission: nit, double_sided, ..diffuse([0.0; 3]) }
}

/// A horizontal square around (0, y, 0).
fn square(half: f32, y: f32, facing: Vec3) -> Shape {
    polygon(
        &[(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, z)| Vec3::new(half * x, y, half * z)),
        facing,
    )
}

/// About y, by the angle whose sine is 7/25 and whose cosine is 24/25.
fn turn_7_24_25(sign: f32) -> Mat3 {
    let (sin, cos) = (0.28 * sign, 0.96);
    Mat3::from_cols(Vec3::new(cos, 0.0, -sin), Vec3::Y, Vec3::new(sin, 0.0, cos))
}

/// A room of 1 m, open to +z, with a square lamp under its ceiling and two blocks.
fn cornell_box() -> SceneDescription {
    let mut scene = scene("cornell-box", Vec3::new(0.0, 0.5, 1.95), Vec3::new(0.0, 0.5, 0.0));
    let white = || diffuse([0.73, 0.73, 0.73]);
    let side = |x: f32| {
        polygon(
            &[(0.0, -0.5), (1.0, -0.5), (1.0, 0.5), (0.0, 0.5)].map(|(y, z)| Vec3::new(x, y, z)),
            Vec3::X * -x,
        )
    };
    let back = [(-0.5, 0.0), (0.5, 0.0), (0.5, 1.0), (-0.5, 1.0)].map(|(x, y)| Vec3::new(x, y, -0.5));
    add(&mut scene, "floor", square(0.5, 0.0, Vec3::Y), white());
    add(&mut scene, "ceiling", square(0.5, 1.0, Vec3::NEG_Y), white());
    add(&mut scene, "back", polygon(&back, Vec3::Z), white());
    add(&mut scene, "left", side(-0.5), diffuse([0.63, 0.06, 0.05]));
    add(&mut scene, "right", side(0.5), diffuse([0.14, 0.45, 0.09]));
    add(
        &mut scene,
        "lamp",
        square(0.125, 0.995, Vec3::NEG_Y),
        emitter(Vec3::new(5000.0, 3600.0, 1900.0), false),
    );
    let block = |half: Vec3, sign: f32, at: Vec3| {
        let floor_to_top = cuboid(Vec3::new(-half.x, 0.0, -half.z), Vec3::new(half.x, half.y, half.z));
        floor_to_top.moved(Affine3A::from_mat3_translation(turn_7_24_25(sign), at))
    };
    let low = block(Vec3::new(0.15, 0.3, 0.15), -1.0, Vec3::new(0.17, 0.0, 0.13));
    let high = block(Vec3::new(0.15, 0.6, 0.15), 1.0, Vec3::new(-0.17, 0.0, -0.14));
    add(&mut scene, "low block", low, white());
    add(&mut scene, "high block", high, white());
    scene
}

/// Triangles of several colours, sizes and directions over a floor; the upright one shines to both sides.
fn emissive_triangles() -> SceneDescription {
    let mut scene = scene("emissive-triangles", Vec3::new(0.0, 2.0, 5.0), Vec3::new(0.0, 0.6, 0.0));
    add(&mut scene, "floor", square(3.0, 0.0, Vec3::Y), diffuse([0.5, 0.5, 0.5]));
    let triangle = |at: Vec3, a: Vec3, b: Vec3, facing: Vec3| polygon(&[at, at + a, at + b], facing);
    let large = triangle(Vec3::new(-2.0, 1.6, -1.5), Vec3::X * 1.2, Vec3::Z * 1.2, Vec3::NEG_Y);
    let small = triangle(Vec3::new(1.4, 0.5, 1.0), Vec3::X * 0.15, Vec3::Z * 0.15, Vec3::NEG_Y);
    let tilted = triangle(
        Vec3::new(1.0, 1.0, -1.8),
        Vec3::X * 0.8,
        Vec3::new(0.0, 0.6, 0.8),
        Vec3::new(0.0, -0.8, 0.6),
    );
    let sliver = triangle(Vec3::new(-1.0, 0.3, 1.6), Vec3::X * 2.0, Vec3::new(1.0, 0.02, 0.0), Vec3::NEG_Z);
    let upright = triangle(Vec3::new(0.0, 0.1, -0.6), Vec3::Y * 1.2, Vec3::new(0.0, 0.6, 0.9), Vec3::X);
    add(&mut scene, "large", large, emitter(Vec3::new(80.0, 60.0, 30.0), false));
    add(&mut scene, "small", small, emitter(Vec3::new(500.0, 3000.0, 1000.0), false));
    add(&mut scene, "tilted", tilted, emitter(Vec3::new(40.0, 90.0, 400.0), false));
    add(&mut scene, "sliver", sliver, emitter(Vec3::new(2000.0, 300.0, 1500.0), false));
    add(&mut scene, "double-sided", upright, emitter(Vec3::new(300.0, 60.0, 20.0), true));
    scene
}

/// Five by five lights 1 m over a plane that they all reach.
fn point_lights() -> SceneDescription {
    let mut scene = scene("point-lights", Vec3::new(0.0, 3.0, 6.5), Vec3::ZERO);
    add(&mut scene, "plane", square(4.0, 0.0, Vec3::Y), diffuse([0.6, 0.6, 0.6]));
    for i in 0..25u8 {
        let (x, z) = (f32::from(i % 5) - 2.0, f32::from(i / 5) - 2.0);
        let color = Vec3::new(1.0 + f32::from(i % 3), 1.0 + f32::from(i % 4), 1.0 + f32::from(i % 5));
        let position = Vec3::new(1.2 * x, 1.0, 1.2 * z);
        scene.lights.push(PointLight { position, intensity: 2.0 * color, radius: 0.0 }.into());
    }
    scene
}

/// A light 2 m over a plane, and a square of 0.6 m half way: its shadow is a square of 1.2 m.
fn occluder() -> SceneDescription {
    let mut scene = scene("occluder", Vec3::new(0.0, 2.5, 3.5), Vec3::ZERO);
    add(&mut scene, "plane", square(2.0, 0.0, Vec3::Y), diffuse([0.5, 0.5, 0.5]));
    let screen = Material { double_sided: true, ..diffuse([0.5, 0.2, 0.1]) };
    add(&mut scene, "screen", square(0.3, 1.0, Vec3::Y), screen);
    let (position, intensity) = (Vec3::new(0.0, 2.0, 0.0), Vec3::splat(100.0));
    scene.lights.push(PointLight { position, intensity, radius: 0.0 }.into());
    scene
}

/// One mesh four times: as it is, turned, stretched unequally, and mirrored. It has no symmetry of its own, and vertex
/// colours.
fn instances() -> SceneDescription {
    let mut scene = scene("instances", Vec3::new(0.0, 2.2, 5.5), Vec3::new(0.0, 0.5, 0.0));
    add(&mut scene, "plane", square(3.5, 0.0, Vec3::Y), diffuse([0.5, 0.5, 0.5]));
    // A flag: a post, and a wedge that points to +x.
    let post = cuboid(Vec3::new(-0.05, 0.0, -0.05), Vec3::new(0.05, 1.0, 0.05));
    let [a, b, c] = [Vec3::new(0.05, 0.6, 0.05), Vec3::new(0.6, 0.7, 0.05), Vec3::new(0.05, 1.0, 0.05)];
    let back = Vec3::new(0.0, 0.0, -0.2);
    let flag = polygon(&[a, b, c], Vec3::Z)
        .with(polygon(&[a + back, b + back, c + back], Vec3::NEG_Z))
        .with(polygon(&[a, b, b + back, a + back], Vec3::NEG_Y))
        .with(polygon(&[b, c, c + back, b + back], Vec3::new(0.5, 1.0, 0.0)));
    let mut primitive = post.with(flag).into_primitive(scene.materials.len(), false);
    let color = |p: &Vec3| Vec4::new(0.2 + p.x.max(0.0), 0.2 + 0.6 * p.y, 0.8 - 0.6 * p.y, 1.0);
    primitive.colors = primitive.positions.iter().map(color).collect();
    scene.materials.push(Material { name: "flag".into(), roughness: 0.5, ..Material::default() });
    scene.meshes.push(Mesh { name: "flag".into(), primitives: vec![primitive] });
    let stretch = Mat3::from_diagonal(Vec3::new(1.5, 0.6, 3.0));
    let mirror = Mat3::from_diagonal(Vec3::new(-1.0, 1.0, 1.0));
    let places = [
        ("as it is", Mat3::IDENTITY, Vec3::new(-2.0, 0.0, 0.0)),
        ("turned", turn_7_24_25(1.0) * turn_7_24_25(1.0) * turn_7_24_25(1.0), Vec3::new(-0.5, 0.0, 0.5)),
        ("stretched", turn_7_24_25(-1.0) * stretch, Vec3::new(0.7, 0.0, -0.8)),
        ("mirrored", mirror, Vec3::new(2.4, 0.0, 0.0)),
    ];
    for (name, linear, at) in places {
        let transform = Affine3A::from_mat3_translation(linear, at);
        scene.instances.push(Instance { name: name.into(), mesh: 1, transform });
    }
    for (x, intensity) in [(-1.5, Vec3::new(60.0, 50.0, 40.0)), (2.0, Vec3::new(30.0, 40.0, 60.0))] {
        scene.lights.push(PointLight { position: Vec3::new(x, 2.5, 2.0), intensity, radius: 0.0 }.into());
    }
    scene
}

/// Within 2 s: the camera flies a spline, a block turns about itself and slides, a lamp of two triangles swings up on a turning
/// arm, and a point light steps from place to place.
fn moving() -> SceneDescription {
    let mut scene = scene("moving", Vec3::new(0.0, 2.0, 4.5), Vec3::new(0.0, 0.5, 0.0));
    add(&mut scene, "floor", square(3.0, 0.0, Vec3::Y), diffuse([0.5, 0.5, 0.5]));
    let half = Vec3::new(0.25, 0.4, 0.25);
    add(&mut scene, "block", cuboid(-half, half), diffuse([0.7, 0.3, 0.1]));
    add(&mut scene, "lamp", square(0.3, 0.0, Vec3::NEG_Y), emitter(Vec3::new(60.0, 80.0, 120.0), false));
    let (position, intensity) = (Vec3::new(-1.0, 1.5, 1.0), Vec3::new(20.0, 14.0, 6.0));
    scene.lights.push(PointLight { position, intensity, radius: 0.0 }.into());
    let still = Local::Trs { translation: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: DVec3::ONE };
    let node = |parent| Node { parent, base: DAffine3::IDENTITY, rest: still };
    // camera, block, arm, lamp at the arm's end, light
    scene.animation.nodes = vec![node(None), node(None), node(None), node(Some(2)), node(None)];
    scene.animation.attached =
        vec![(Thing::Camera(0), 0), (Thing::Instance(1), 1), (Thing::Instance(2), 3), (Thing::Light(0), 4)];
    fn track<T>(interpolation: Interpolation, times: &[f32], values: Vec<T>) -> Track<T> {
        Track { interpolation, times: times.to_vec(), values }
    }
    use Interpolation::{CubicSpline, Linear, Step};
    let v = DVec3::new;
    // Looks down by the angle with sine 7/25: half of it has sine 1/sqrt(50), cosine 7/sqrt(50).
    let down = DVec4::new(-0.141_421_35, 0.0, 0.0, 0.989_949_5);
    let fly = vec![
        v(0.0, 0.0, 0.0),
        v(-0.6, 1.8, 4.5),
        v(0.6, 0.0, 0.0),
        v(0.6, 0.0, 0.0),
        v(0.6, 1.6, 4.2),
        v(0.0, 0.0, 0.0),
    ];
    let quarters = [(0.0, 1.0), (0.6, 0.8), (1.0, 0.0)].map(|(sin, cos)| DVec4::new(0.0, sin, 0.0, cos));
    let slide = vec![v(-0.9, 0.4, 0.0), v(0.3, 0.4, 0.5), v(0.8, 0.4, -0.4)];
    let swing = vec![DVec4::new(0.0, 0.0, -0.28, 0.96), DVec4::new(0.0, 0.0, 0.28, 0.96)];
    let jumps = vec![v(-1.2, 1.4, 0.9), v(-0.4, 1.8, 1.2)];
    let curves = [
        (0, Curve::Translation(track(CubicSpline, &[0.0, 2.0], fly))),
        (0, Curve::Rotation(track(Step, &[0.0], vec![down]))),
        (1, Curve::Rotation(track(Linear, &[0.0, 1.0, 2.0], quarters.to_vec()))),
        (1, Curve::Translation(track(Linear, &[0.0, 0.75, 2.0], slide))),
        (2, Curve::Rotation(track(Linear, &[0.0, 2.0], swing))),
        (3, Curve::Translation(track(Step, &[0.0], vec![v(0.0, 1.6, 0.0)]))),
        (3, Curve::Scale(track(Linear, &[0.0, 2.0], vec![v(1.0, 1.0, 1.0), v(1.5, 1.0, 1.5)]))),
        (4, Curve::Translation(track(Step, &[0.0, 1.0], jumps))),
    ];
    scene.animation.channels = curves.map(|(node, curve)| Channel { node, curve }).to_vec();
    let start = scene.pose(0.0);
    scene.apply(&start);
    scene
}

#[cfg(test)]
mod tests {
    use super::*;

    fn committed() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/scenes")
    }

    /// After a wanted change of a scene: `cargo test -p candela-renderer --lib rewrite_the_committed_files -- --ignored`.
    #[test]
    #[ignore = "writes to assets/scenes"]
    fn rewrite_the_committed_files() {
        write_all(&committed()).unwrap();
    }

    #[test]
    fn committed_files_are_what_the_generator_writes() {
        for (name, scene) in all() {
            let path = committed().join(format!("{name}.glb"));
            let on_disk = std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            assert!(on_disk == to_glb(&scene).unwrap(), "{name}.glb is not what the generator writes");
            assert!(on_disk.len() < 100_000, "{name}.glb has {} bytes", on_disk.len());
        }
    }

    /// Parsed by the `gltf` crate, which also validates.
    #[test]
    fn files_say_what_the_scenes_are() {
        for (name, scene) in all() {
            let (document, buffers, _) = gltf::import(committed().join(format!("{name}.glb"))).unwrap();
            let mut triangles = 0;
            for mesh in document.nodes().filter_map(|node| node.mesh()) {
                for primitive in mesh.primitives() {
                    let reader = primitive.reader(|buffer| Some(&buffers[buffer.index()]));
                    triangles += reader.read_indices().unwrap().into_u32().count() / 3;
                }
            }
            assert_eq!(triangles, scene.triangle_count(), "{name}");
            assert_eq!(document.cameras().count(), 1, "{name}");
            assert_eq!(document.lights().map_or(0, |lights| lights.len()), scene.lights.len(), "{name}");
            let emitting = document.materials().filter(|m| m.emissive_factor() != [0.0; 3]).count();
            assert_eq!(
                emitting,
                match name {
                    "cornell-box" => 1,
                    "emissive-triangles" => 5,
                    "moving" => 1,
                    _ => 0,
                },
                "{name}"
            );
        }
    }

    #[test]
    fn writing_replaces_and_leaves_nothing_behind() {
        let directory = std::env::temp_dir().join(format!("candela-fixtures-{}", std::process::id()));
        let first = write_all(&directory).unwrap();
        assert_eq!(write_all(&directory).unwrap(), first);
        let entries = std::fs::read_dir(&directory).unwrap().count();
        std::fs::remove_dir_all(&directory).unwrap();
        assert_eq!(entries, all().len());
        // A directory can't be made under a file.
        let error = write_all(&committed().join("occluder.glb/below")).unwrap_err().to_string();
        assert!(error.contains("below: can't write"), "{error}");
    }

    /// The loader gives the motion back that the exporter wrote (f32 in the file).
    #[test]
    fn motion_survives_the_file() {
        let scene = moving();
        let loaded = crate::scene::gltf::load(&committed().join("moving.glb")).unwrap();
        assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
        assert_eq!(loaded.animation.duration(), 2.0);
        for time in [0.0, 0.3, 0.75, 1.0, 1.7, 5.0] {
            let (mut ours, mut theirs) = (scene.clone(), loaded.clone());
            ours.apply(&scene.pose(time));
            theirs.apply(&loaded.pose(time));
            let transforms =
                |s: &SceneDescription| s.instances.iter().map(|i| i.transform).collect::<Vec<_>>();
            for (a, b) in transforms(&ours).iter().zip(transforms(&theirs)) {
                assert!(a.abs_diff_eq(b, 1e-5), "at {time}: {a} {b}");
            }
            let light = |s: &SceneDescription| s.lights[0].position().unwrap();
            assert!(light(&ours).abs_diff_eq(light(&theirs), 1e-5));
            assert!(ours.cameras[0].position.abs_diff_eq(theirs.cameras[0].position, 1e-5), "at {time}");
            assert!(ours.cameras[0].forward.abs_diff_eq(theirs.cameras[0].forward, 1e-5));
        }
        let still = |s: &SceneDescription| s.lights[0].position();
        let mut later = scene.clone();
        later.apply(&scene.pose(1.0));
        assert_ne!(still(&later), still(&scene), "it does move");
    }

    #[test]
    fn instances_cover_a_mirror_and_a_stretch() {
        let linear: Vec<Mat3> =
            instances().instances.iter().map(|i| Mat3::from(i.transform.matrix3)).collect();
        assert_eq!(linear.iter().filter(|m| m.determinant() < 0.0).count(), 1);
        let uneven = |m: &&Mat3| m.x_axis.length() > 1.2 * m.y_axis.length();
        assert_eq!(linear.iter().filter(uneven).count(), 1);
    }
}
