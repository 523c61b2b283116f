//! The viewer on a virtual display (Xvfb), played by scripts that count frames. Needs `cargo xtask setup --tests`.

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

const SCENES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/scenes");

/// A display of its own; ends with the test.
struct Display {
    server: Child,
    name: String,
}

impl Display {
    /// None where `CANDELA_ALLOW_NO_GPU=1` says that pictures can't be tested here.
    fn open() -> Option<Display> {
        let server = Command::new("Xvfb")
            // Without -noreset it resets when a client leaves, and the next one may find nobody.
            .args(["-displayfd", "1", "-screen", "0", "640x480x24", "-nolisten", "tcp", "-noreset"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn();
        let mut server = match server {
            Ok(server) => server,
            Err(error) if std::env::var("CANDELA_ALLOW_NO_GPU").as_deref() == Ok("1") => {
                eprintln!("skipped: Xvfb: {error}");
                return None;
            }
            Err(error) => panic!("Xvfb: {error}; cargo xtask setup --tests installs it"),
        };
        // The server says its number once it is ready.
        let mut number = String::new();
        let stdout = server.stdout.take().expect("its output is piped");
        BufReader::new(stdout).read_line(&mut number).expect("the server says its number");
        Some(Display { server, name: format!(":{}", number.trim()) })
    }

    fn command(&self, program: &str) -> Command {
        let mut command = Command::new(program);
        command.env("DISPLAY", &self.name).env_remove("WAYLAND_DISPLAY");
        command
    }

    fn viewer(&self, script: &Path) -> Command {
        self.viewer_of("cornell-box.glb", script)
    }

    fn viewer_of(&self, scene: &str, script: &Path) -> Command {
        let mut command = self.command(env!("CARGO_BIN_EXE_candela"));
        if std::env::var("CANDELA_NO_VALIDATION").as_deref() != Ok("1") {
            command.arg("--validate");
        }
        command.arg(format!("{SCENES}/{scene}")).args(["--size", "160x120", "--script"]).arg(script);
        command
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// A folder that goes with the test.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Folder {
        let path = std::env::temp_dir().join(format!("candela-viewer-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).expect("a folder");
        Folder(path)
    }

    fn script(&self, text: &str) -> PathBuf {
        let path = self.0.join("script");
        std::fs::write(&path, text).expect("a script");
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn play(display: &Display, folder: &Folder, text: &str) -> Output {
    display.viewer(&folder.script(text)).output().expect("the viewer starts")
}

fn assert_success(output: &Output) {
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{said}");
}

#[test]
fn every_knob_and_view_and_five_sizes() {
    let Some(display) = Display::open() else { return };
    let folder = Folder::new("knobs");
    let mut text = String::from("frames 2\n");
    for (i, size) in ["200 100", "128 128", "100 200", "64 64", "160 120"].iter().enumerate() {
        text += &format!("resize {size}\nframes 2\nexpect size {}\n", size.replace(' ', "x"));
        // Not only in the first state.
        text += if i == 1 { "key KeyP\n" } else { "" };
    }
    text += "knobs\nkey KeyB\nframes 1\nkey KeyL\nkey Period\nframes 1\n";
    text += &"key KeyG\nframes 1\n".repeat(15);
    text += "key KeyB\nkey KeyX\nframes 4\nexpect reference yes\nexpect compared yes\n";
    text += "click 100 60\nframes 3\nkey KeyF\nframes 1\ndrag left 90 50 120 70\ndrag right 90 50 80 40\nscroll 2\n";
    // The help stays open: a window closes all the same.
    text += "key F1\nframes 1\nkey F1\nkey KeyH\nkey F10\nkey F11\nframes 2\nkey F1\nframes 1\nclose\n";
    assert_success(&play(&display, &folder, &text));
}

/// Off, the mean and its trail start anew; while pixels are explained, no frame's time is lost or counted twice.
#[test]
fn the_error_of_the_mean_leaves_a_trail() {
    let Some(display) = Display::open() else { return };
    let folder = Folder::new("trail");
    let text = "key KeyX\nframes 3\nexpect trail\nkey KeyP\nawait trail yes\nexpect compared yes\n\
                click 40 60\nframes 2\nkey KeyI\nloaded\nframes 3\nexpect whole yes\nkey KeyI\nloaded\nframes 2\n\
                expect whole yes\nkey KeyI\nloaded\nframes 3\nexpect whole yes\nkey KeyI\nloaded\nframes 2\n\
                expect whole yes\nexpect trail yes\nkey KeyP\nframes 3\nexpect trail\nclose\n";
    assert_success(&play(&display, &folder, text));
}

/// The replay agrees with the GPU, whichever side of the divider the pixel is on; the frames go on afterwards.
#[test]
fn the_picked_pixel_is_explained() {
    let Some(display) = Display::open() else { return };
    let folder = Folder::new("explain");
    let text = "frames 2\nkey KeyI\nloaded\nexpect explanation\n\
                click 100 60\nframes 2\nkey KeyI\nloaded\nexpect explanation pixel 100 60 of 160x120\n\
                expect explanation unbiased mode\nexpect explanation pair_merge 0\nexpect explanation differs by rounding alone\nframes 2\n\
                key KeyB\nkey KeyL\nkey KeyU\nframes 2\nkey KeyI\nloaded\nexpect explanation biased mode\nexpect explanation spatial 0\n\
                resize 120 100\nframes 2\nclick 20 60\nkey KeyI\nresize 100 120\nframes 3\nloaded\n\
                expect explanation pixel 20 60 of 120x100\nframes 2\nexpect size 100x120\n\
                click 90 60\nkey KeyB\nkey KeyI\nframes 2\nexpect explanation the reference, which does not resample\n\
                click 10 60\nkey KeyI\ndrop SCENES/point-lights.glb\nloaded\nframes 2\nexpect scene point\n\
                expect explanation\nclick 10 60\nkey KeyI\nclose\n"
        .replace("SCENES", SCENES);
    assert_success(&play(&display, &folder, &text));
}

/// Steps of 1/24 s are exact, so is where the scene and its camera are.
#[test]
fn a_scene_that_moves_is_played() {
    let Some(display) = Display::open() else { return };
    let folder = Folder::new("moving");
    let script = folder.script(
        "frames 2\nexpect time\nkey KeyK\nframes 2\nexpect time 0.0417\nkey KeyJ\nframes 1\nexpect time 0.0000\n\
         key Space\nframes 4\nkey Space\nframes 1\nkey KeyY\nframes 2\nkey KeyB\nkey KeyK\nframes 1\nkey KeyK\n\
         frames 3\nkey KeyX\nkey KeyP\nframes 2\nkey KeyK\nframes 3\nclick 40 60\nframes 2\nkey Space\nkey KeyI\nloaded\n\
         expect explanation held still\nframes 2\nkey Space\nframes 2\nclose\n",
    );
    assert_success(&display.viewer_of("moving.glb", &script).output().expect("the viewer starts"));
    let script = folder.script("frames 1\nexpect time 0.5000\nkey ShiftLeft KeyC\nclose\n");
    let output = display.viewer_of("moving.glb", &script).args(["--time", "0.5"]).output();
    let output = output.expect("the viewer starts");
    assert_success(&output);
    assert!(String::from_utf8_lossy(&output.stdout).contains(" --time 0.5000"));
}

/// A new sky over the same scene, a broken one, and a scene whose upload runs out of memory: what was there stays.
#[test]
fn dropped_skies_and_a_failing_upload() {
    let Some(display) = Display::open() else { return };
    let folder = Folder::new("skies");
    let out = folder.0.display();
    // 2 x 1 texels without run lengths: mantissas and a shared exponent.
    let sky = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\x80\x80\x80\x81\x40\x80\xff\x81";
    std::fs::write(folder.0.join("sky.hdr"), sky).expect("a sky");
    std::fs::write(folder.0.join("broken.hdr"), &sky[..40]).expect("a broken sky");
    let exr = folder.0.join("sky.exr");
    let radiance: Vec<glam::Vec3> = (0..32).map(|i| glam::Vec3::splat(i as f32)).collect();
    candela::image_io::write_exr(&exr, glam::UVec2::new(8, 4), &radiance).expect("another sky");
    let text = format!(
        "frames 2\ndrop {out}/sky.hdr\nloaded\nframes 2\nexpect scene cornell\nexpect source sky.hdr\n\
         drop {out}/broken.hdr\nloaded\nframes 1\nexpect error broken.hdr\nexpect source sky.hdr\n\
         drop {out}/sky.exr\nloaded\nframes 2\nexpect source sky.exr\n\
         fail upload\ndrop {SCENES}/point-lights.glb\nframes 1\nloaded\nframes 2\nexpect error out of memory: acceleration\n\
         expect scene cornell\nexpect source sky.exr\nexpect candidates 32\n\
         drop {SCENES}/moving.glb\ndrop {SCENES}/point-lights.glb\nloaded\nframes 2\nexpect scene point\n\
         drop {SCENES}/cornell-box.glb\nclose\n"
    );
    let text = text
        .replace("expect source sky.hdr", "expect source sky.hdr\nexpect camera [0.5000, 0.6000, 0.7000]");
    let output = display.viewer(&folder.script(&text)).arg("--camera=0.5,0.6,0.7,0,0,0").output();
    assert_success(&output.expect("the viewer starts"));
}

/// No area, no frames: only the resize that a person makes from outside lets the script go on. And the display's density,
/// from the start (as the window system tells it) and changed; four present modes, around and around; fullscreen.
#[test]
fn minimised_windows_come_back_and_density_is_followed() {
    let Some(display) = Display::open() else { return };
    let folder = Folder::new("minimise");
    let script = folder.script(
        "frames 2\nexpect scale 2\nscale 1.5\nframes 2\nexpect scale 1.5\nclick 90 60\nframes 2\nscale 1\nframes 1\n\
         minimise\nsay asleep\nawait size 200x150\nframes 2\nexpect mode FIFO\n\
         key F10\nframes 2\nkey F10\nframes 2\nexpect mode IMMEDIATE\nkey F10\nframes 2\nkey F10\nframes 2\nexpect mode FIFO\n\
         key F11\nframes 2\nexpect fullscreen yes\nkey F11\nframes 2\nexpect fullscreen\nclose\n",
    );
    let mut viewer = display.viewer(&script);
    viewer.env("WINIT_X11_SCALE_FACTOR", "2").stdout(Stdio::piped());
    let mut viewer = viewer.spawn().expect("the viewer starts");
    let mut line = String::new();
    let stdout = viewer.stdout.take().expect("its output is piped");
    BufReader::new(stdout).read_line(&mut line).expect("the viewer says when it sleeps");
    assert_eq!(line.trim(), "asleep");
    let resized = display
        .command("xdotool")
        .args(["search", "--sync", "--onlyvisible", "--name", "Candela", "windowsize", "200", "150"])
        .status();
    if !resized.as_ref().is_ok_and(|status| status.success()) {
        let _ = viewer.kill();
        panic!("xdotool: {resized:?}; cargo xtask setup --tests installs it");
    }
    assert_eq!(viewer.wait().expect("the viewer ends").code(), Some(0));
}

#[test]
fn dropped_files_and_a_screenshot() {
    let Some(display) = Display::open() else { return };
    let folder = Folder::new("files");
    let out = folder.0.display();
    std::fs::write(folder.0.join("broken.glb"), b"glTF, but not really").expect("a broken file");
    let text = format!(
        "frames 2\nexpect scene cornell\ndrop {SCENES}/point-lights.glb\nloaded\nframes 2\nexpect scene point\n\
         drop {out}/broken.glb\nloaded\nframes 1\nexpect error broken.glb\nexpect scene point\n\
         drop notes.txt\nframes 1\nexpect error notes.txt\n\
         key Comma\nframes 1\nsave {out}\nclose\n"
    );
    assert_success(&play(&display, &folder, &text));
    for extension in ["png", "exr", "json"] {
        assert!(folder.0.join(format!("candela-001.{extension}")).exists(), "{extension}");
    }
    let json = std::fs::read_to_string(folder.0.join("candela-001.json")).expect("settings");
    assert!(json.contains("\"candidates\": 16"), "{json}");
    // The same settings give the same picture without a window.
    let rendered = Command::new(env!("CARGO_BIN_EXE_candela"))
        .arg("render")
        .arg(format!("{SCENES}/point-lights.glb"))
        .args(["--size", "16x16", "--frames", "1", "--settings"])
        .arg(folder.0.join("candela-001.json"))
        .arg("-o")
        .arg(folder.0.join("again.png"))
        .output()
        .expect("render starts");
    assert_success(&rendered);
}

#[test]
fn a_failing_device_ends_the_viewer_with_a_message() {
    let Some(display) = Display::open() else { return };
    let folder = Folder::new("failures");
    let failures = [("lost", "device lost in pass", 6), ("memory", "out of memory: buffer 'radiance'", 5)];
    for (failure, said, code) in failures {
        let output = play(&display, &folder, &format!("frames 2\nfail {failure}\n"));
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(code), "{text}");
        assert!(text.contains(said), "{text}");
    }
    // The script's checks can fail.
    let output = play(&display, &folder, "frames 1\nexpect scene elsewhere\nclose\n");
    assert_eq!(output.status.code(), Some(1));
}

#[test]
fn without_a_display_one_line_says_what_works() {
    let output = Command::new(env!("CARGO_BIN_EXE_candela"))
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET")
        .output()
        .expect("the viewer starts");
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!((output.status.code(), text.lines().count()), (Some(4), 1), "{text}");
    assert!(text.contains("no display") && text.contains("candela render"), "{text}");
}

/// A person's keys, through the X server: Escape closes the help first, then the window.
#[test]
fn real_keys_reach_the_window() {
    let Some(display) = Display::open() else { return };
    let folder = Folder::new("keys");
    let mut viewer = display.viewer(&folder.script("")).spawn().expect("the viewer starts");
    let keys = display
        .command("xdotool")
        .args(["search", "--sync", "--onlyvisible", "--name", "Candela", "windowfocus", "--sync"])
        .args(["mousemove", "80", "60", "key", "F1", "key", "Escape", "key", "Escape"])
        .status();
    if !keys.as_ref().is_ok_and(|status| status.success()) {
        let _ = viewer.kill();
        panic!("xdotool: {keys:?}; cargo xtask setup --tests installs it");
    }
    let status = viewer.wait().expect("the viewer ends");
    assert_eq!(status.code(), Some(0));
}
