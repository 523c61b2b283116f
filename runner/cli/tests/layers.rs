//! `--layers`, read back by the EXR library: which channels there are, and that the lights are the picture.

use candela::image_io::read_exr;
use exr::prelude::read_first_flat_layer_from_file;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A folder of this test's own, gone with it.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("candela-layers-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).expect("a folder");
        Folder(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn candela(words: &str, output: &Path) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_candela"));
    command.args(words.split_whitespace()).arg("-o").arg(output);
    command.output().expect("the program starts")
}

/// The file's channels by name; none without a device, where that is allowed.
fn channels(words: &str, path: &Path) -> Option<BTreeMap<String, Vec<f32>>> {
    let output = candela(words, path);
    let errors = String::from_utf8_lossy(&output.stderr);
    if !output.status.success() && std::env::var("CANDELA_ALLOW_NO_GPU").as_deref() == Ok("1") {
        eprintln!("skipped: {errors}");
        return None;
    }
    assert!(output.status.success(), "{words}: {errors}");
    let layer = read_first_flat_layer_from_file(path).expect("an EXR file").layer_data;
    let channels = layer.channel_data.list.iter();
    Some(channels.map(|c| (c.name.to_string(), c.sample_data.values_as_f32().collect())).collect())
}

const NAMES: [&str; 24] = [
    "B",
    "G",
    "R",
    "albedo.B",
    "albedo.G",
    "albedo.R",
    "depth.Z",
    "diffuse.B",
    "diffuse.G",
    "diffuse.R",
    "emission.B",
    "emission.G",
    "emission.R",
    "f0.B",
    "f0.G",
    "f0.R",
    "motion.X",
    "motion.Y",
    "normal.X",
    "normal.Y",
    "normal.Z",
    "specular.B",
    "specular.G",
    "specular.R",
];

#[test]
fn lights_of_the_layers_are_the_picture() {
    let folder = Folder::new("sum");
    for (i, command) in [
        "render knot 50 --size 48x27 --frames 2",
        "render knot 50 --size 48x27 --frames 3 --accumulate --mode biased --environment studio",
        "reference knot 7 --size 48x27 --samples 2",
    ]
    .iter()
    .enumerate()
    {
        let [layers, plain] = ["layers", "plain"].map(|name| folder.0.join(format!("{i}-{name}.exr")));
        let Some(channels) = channels(&format!("{command} --layers"), &layers) else { return };
        let names = NAMES.into_iter().chain((i == 1).then_some("variance.Y"));
        assert!(channels.keys().map(String::as_str).eq(names), "{command}: {:?}", channels.keys());
        assert!(channels["motion.X"].iter().all(|x| *x == 0.0), "stills don't move");
        assert!(candela(command, &plain).status.success());
        let (size, picture) = read_exr(&plain).expect("a picture");
        assert_eq!(read_exr(&layers).expect("a picture for who knows no layers").0, size);
        let mut lit = 0;
        for (c, name) in ["R", "G", "B"].iter().enumerate() {
            let [diffuse, specular, emission] =
                ["diffuse", "specular", "emission"].map(|layer| &channels[&format!("{layer}.{name}")]);
            for (j, pixel) in picture.iter().enumerate() {
                let expected = f64::from(pixel[c]);
                let sum = f64::from(diffuse[j]) + f64::from(specular[j]) + f64::from(emission[j]);
                // Three frames of one reservoir, seven lights: some 20 roundings of 2^-24 at the worst.
                let near = |found: f64| (found - expected).abs() <= 2e-6 * expected;
                assert!(
                    near(sum) && near(channels[*name][j].into()),
                    "{command}: {name} of {j}: {sum}, {expected}"
                );
                lit += usize::from(diffuse[j] > 0.0 && specular[j] > 0.0);
            }
        }
        assert!(lit > 300, "{command}: {lit} lit values say little");
        // The knot stands some meters away; beside it is nothing.
        let depths = &channels["depth.Z"];
        let here: Vec<usize> = (0..depths.len()).filter(|&j| depths[j] < 1e10).collect();
        assert!(here.len() > 100 && here.iter().all(|&j| depths[j] > 0.0 && depths[j] < 100.0));
        let length = |j: usize| {
            ["X", "Y", "Z"].map(|axis| channels[&format!("normal.{axis}")][j].powi(2)).iter().sum::<f32>()
        };
        assert!((0..depths.len()).all(|j| (length(j) - f32::from(depths[j] < 1e10)).abs() < 1e-5));
    }
}

/// A picture that can't have layers is refused before anything is done.
#[test]
fn pictures_for_displays_have_no_layers() {
    let folder = Folder::new("png");
    let path = folder.0.join("sub").join("a.png");
    let output = candela("render knot 5 --size 8x8 --layers", &path);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!((output.status.code(), errors.lines().count()), (Some(2), 1), "{errors}");
    assert!(errors.contains("a.png: layers need an .exr"), "{errors}");
    assert!(!path.parent().expect("a folder").exists());
}

/// Two means of 16 independent frames that differ in their seeds alone: |a - b| is less than √(variance of a + variance of b) in 68 %
/// of the pixels if they are normal, in 67 % by Student's t. Their tails are heavier; four times the variance would give 95 %, a
/// quarter of it 38 %. Some 900 lit pixels: a standard error of 1.6 %.
#[test]
fn variance_is_what_means_differ_by() {
    let folder = Folder::new("variance");
    let command = "render knot 50 --size 48x27 --frames 16 --accumulate --no-temporal --no-spatial --layers";
    let mut means = Vec::new();
    for seed in 0..2 {
        let path = folder.0.join(format!("{seed}.exr"));
        let Some(channels) = channels(&format!("{command} --seed {seed}"), &path) else { return };
        let of = |i: usize| 0.2126 * channels["R"][i] + 0.7152 * channels["G"][i] + 0.0722 * channels["B"][i];
        let variance = &channels["variance.Y"];
        means.push((0..variance.len()).map(|i| (of(i), variance[i])).collect::<Vec<_>>());
    }
    let pairs = means[0].iter().zip(&means[1]).filter(|(a, b)| a.1 + b.1 > 0.0);
    let within: Vec<bool> = pairs.map(|(a, b)| (a.0 - b.0).powi(2) < a.1 + b.1).collect();
    let share = within.iter().filter(|w| **w).count() as f64 / within.len() as f64;
    assert!(within.len() > 500 && (0.58..0.78).contains(&share), "{share} of {}", within.len());
}

/// Motion of a moving camera before a block that turns and slides, against the scene's own poses: the point of each pixel, from its
/// depth, on the floor (gray) or on the block (red), goes back with the instance.
#[test]
fn motion_is_what_the_scene_says() {
    use candela::scene::{Illumination, SceneSource, load};
    use glam::{UVec2, Vec2};
    let size = UVec2::new(64, 36);
    let folder = Folder::new("motion");
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/scenes/moving.glb");
    let pattern = folder.0.join("p-##.exr");
    let command =
        format!("render {file} --size 64x36 --frames 4..6 --fps 8 --layers --camera-path 0 --pixel-centers");
    let output = candela(&command, &pattern);
    if !output.status.success() && std::env::var("CANDELA_ALLOW_NO_GPU").as_deref() == Ok("1") {
        return;
    }
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let source = SceneSource::File(file.into());
    let posed = |frame: u32| {
        let mut scene = load(&source, &Illumination::points(0)).expect("it loads");
        let pose = scene.pose(f64::from(frame) / 8.0);
        scene.apply(&pose);
        scene
    };
    for frame in [4, 5] {
        let layer =
            read_first_flat_layer_from_file(folder.0.join(format!("p-{frame:02}.exr"))).expect("an EXR file");
        let list = layer.layer_data.channel_data.list;
        let channel = |name: &str| -> Vec<f32> {
            let found = list.iter().find(|c| c.name.to_string() == name).expect("a channel of that name");
            found.sample_data.values_as_f32().collect()
        };
        let [x, y, depth, red, green] =
            ["motion.X", "motion.Y", "depth.Z", "albedo.R", "albedo.G"].map(channel);
        let (now, before) = (posed(frame), posed(frame - 1));
        let [camera, last] = [&now, &before].map(|scene| scene.cameras[0].seen_in(size));
        let block = now.instances.iter().position(|i| i.name == "block").expect("the block");
        let mut met = [0; 2];
        for i in (0..depth.len()).filter(|i| depth[*i] < 1e9 && red[*i] > 0.1) {
            let at = Vec2::new((i as u32 % size.x) as f32 + 0.5, (i as u32 / size.x) as f32 + 0.5);
            let way = camera.direction(at, size);
            let point = camera.position + way * (depth[i] / way.dot(camera.forward));
            let on_block = red[i] > 1.5 * green[i];
            let was = match on_block {
                true => {
                    let back = before.instances[block].transform * now.instances[block].transform.inverse();
                    back.transform_point3(point)
                }
                false => point,
            };
            let expected = last.project(was - last.position, size) - at;
            let found = Vec2::new(x[i], y[i]);
            assert!(found.distance(expected) < 0.02, "{at}: {found}, not {expected}");
            met[usize::from(on_block)] += usize::from(expected.length() > 0.2);
        }
        assert!(met[0] > 200 && met[1] > 20, "{met:?} pixels moved");
    }
}
