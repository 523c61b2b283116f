//! `candela denoise`: stills through Open Image Denoise. Pictures of known truth, made here: no device is needed.

use candela::image_io::{Channel, encode_channels, read_exr};
use glam::{UVec2, Vec3};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const SIZE: UVec2 = UVec2::new(96, 64);

/// A folder of this test's own, gone with it.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("candela-stills-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).expect("a folder");
        Folder(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn denoise(from: &Path, to: &Path) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_candela"));
    command.arg("denoise").arg(from).arg("-o").arg(to).output().expect("the program starts")
}

/// Light that falls off to the right, on a board of two albedos.
fn truth() -> (Vec<Vec3>, Vec<Vec3>) {
    let pixels = (0..SIZE.element_product()).map(|i| UVec2::new(i % SIZE.x, i / SIZE.x));
    let albedo = |p: UVec2| if (p.x / 12 + p.y / 12).is_multiple_of(2) { 0.8 } else { 0.1 };
    pixels.map(|p| (Vec3::splat(albedo(p) * (40.0 - 0.3 * p.x as f32)), Vec3::splat(albedo(p)))).unzip()
}

/// [`truth`] under noise of a standard deviation of 35 %, with the layers that `render --layers` writes if they are asked for.
fn write_noisy(path: &Path, layers: bool) {
    let (truth, albedo) = truth();
    let mut state = 7u32;
    let mut uniform = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 24) as f32
    };
    let noisy: Vec<Vec3> = truth.iter().map(|c| *c * (1.0 + 1.2 * (uniform() - 0.5))).collect();
    let up = vec![Vec3::Y; noisy.len()];
    let none = vec![Vec3::ZERO; noisy.len()];
    let mut content = vec![("", "RGB", &noisy)];
    if layers {
        content.extend([("albedo.", "RGB", &albedo), ("f0.", "RGB", &none), ("normal.", "XYZ", &up)]);
    }
    let channels = content.iter().flat_map(|(layer, names, values)| {
        let channel = |(i, name): (usize, char)| {
            Channel::new(&format!("{layer}{name}"), values.iter().map(|v: &Vec3| v[i]).collect())
        };
        names.chars().enumerate().map(channel).collect::<Vec<_>>()
    });
    std::fs::write(path, encode_channels(SIZE, channels.collect()).expect("it encodes"))
        .expect("it is written");
}

/// √(Σ(x - y)²/Σy²).
fn error(picture: &[Vec3]) -> f32 {
    let truth = truth().0;
    let squares: f32 = picture.iter().zip(&truth).map(|(a, b)| (*a - *b).length_squared()).sum();
    (squares / truth.iter().map(|c| c.length_squared()).sum::<f32>()).sqrt()
}

/// Less than a third of the noise is left where layers tell of the board, and the light is all there; without layers more is left.
#[cfg(feature = "oidn")]
#[test]
fn stills_lose_their_noise_and_keep_their_edges() {
    let folder = Folder::new("clean");
    let path = |name: &str| folder.0.join(name);
    let clean = |layers: bool, note: bool| {
        write_noisy(&path("noisy.exr"), layers);
        let output = denoise(&path("noisy.exr"), &path("clean.exr"));
        let errors = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success() && errors.contains("sharper") == note, "{errors}");
        read_exr(&path("clean.exr")).expect("it is read").1
    };
    let (guided, alone) = (clean(true, false), clean(false, true));
    let noisy = error(&read_exr(&path("noisy.exr")).expect("it is read").1);
    assert!((0.3..0.4).contains(&noisy), "{noisy}");
    assert!(
        error(&guided) < noisy / 3.0 && error(&guided) < error(&alone),
        "{noisy} {} {}",
        error(&guided),
        error(&alone)
    );
    let sum = |picture: &[Vec3]| picture.iter().map(|c| c.element_sum()).sum::<f32>();
    let energy = sum(&guided) / sum(&truth().0);
    assert!((energy - 1.0).abs() < 0.02, "{energy}");
    let output = denoise(&path("noisy.exr"), &path("clean.png"));
    assert!(output.status.success() && path("clean.png").exists());
}

/// One line that says how to get it; nothing is written.
#[cfg(not(feature = "oidn"))]
#[test]
fn a_build_without_the_library_says_how_to_get_it() {
    let folder = Folder::new("absent");
    let path = |name: &str| folder.0.join(name);
    write_noisy(&path("noisy.exr"), true);
    let output = denoise(&path("noisy.exr"), &path("clean.exr"));
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(4), "{errors}");
    assert!(errors.contains("--features oidn") && errors.trim_end().lines().count() == 1, "{errors}");
    assert!(!path("clean.exr").exists());
    assert!((0.3..0.4).contains(&error(&read_exr(&path("noisy.exr")).expect("it is read").1)));
}

#[test]
fn what_is_no_picture_is_one_line() {
    let folder = Folder::new("wrong");
    let path = |name: &str| folder.0.join(name);
    std::fs::write(path("text.exr"), "not a picture").expect("it is written");
    let gray = vec![Channel::new("Y", vec![1.0; SIZE.element_product() as usize])];
    std::fs::write(path("gray.exr"), encode_channels(SIZE, gray).expect("it encodes"))
        .expect("it is written");
    for (from, to, words) in [
        ("absent.exr", "out.exr", "can't read"),
        ("text.exr", "out.exr", "text.exr"),
        ("gray.exr", "out.exr", "no channels R, G and B"),
        ("gray.exr", "out.jpg", ".png or .exr"),
    ] {
        let output = denoise(&path(from), &path(to));
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{errors}");
        assert!(errors.contains(words) && errors.trim_end().lines().count() == 1, "{from}: {errors}");
        assert!(!path(to).exists());
    }
}
