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

const NAMES: [&str; 22] = [
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
        assert_eq!(channels.keys().map(String::as_str).collect::<Vec<_>>(), NAMES, "{command}");
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
