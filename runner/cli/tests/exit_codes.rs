//! Exit codes that need no window and no device. Those of a lost device, a lack of memory and a failed check are in viewer.rs
//! and sweep.rs; that of a fault of the program is in error.rs.

use std::path::Path;
use std::process::{Command, Output};

fn candela(args: &[&str]) -> Output {
    // A driver that is not there, so that no device is found on any machine.
    let mut command = Command::new(env!("CARGO_BIN_EXE_candela"));
    command.args(args).env("VK_DRIVER_FILES", "/no-such-driver.json").env_remove("VK_ICD_FILENAMES");
    command.output().expect("the program starts")
}

fn assert_refused(args: &[&str], code: i32, words: &str) {
    let output = candela(args);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{args:?}: {errors}");
    assert!(errors.contains(words), "{args:?}: {errors}");
}

#[test]
fn bad_input_is_2() {
    assert_refused(&["render", "--candidates", "0", "-o", "a.png"], 2, "0 is not in 1..=1024");
    assert_refused(&["info", "no-such-file.glb"], 2, "no-such-file.glb: can't read");
    assert_refused(&["report", "no-such-folder"], 2, "points.json: can't read");
    assert_refused(&["compare", "Cargo.toml", "Cargo.toml"], 2, "Cargo.toml");
}

/// Pipes that nobody writes to, in place of every kind of file: nothing waits for them.
#[test]
#[cfg(unix)]
fn pipes_are_no_input() {
    let folder = std::env::temp_dir().join(format!("candela-pipes-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = |name: &str| folder.join(name).to_string_lossy().into_owned();
    let pipes =
        ["a.glb", "a.gltf", "a.bin", "a.png", "a.hdr", "a.exr", "a.json", "a.toml", "a.md", "points.json"];
    assert!(Command::new("mkfifo").args(pipes.map(path)).status().expect("mkfifo").success());
    let json = r#"{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1]}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"uri": "a.bin", "byteLength": 36}]}"#;
    std::fs::write(folder.join("buffer.gltf"), json).unwrap();
    let output = path("out.png");
    for args in [
        &["info", &path("a.glb")][..],
        &["info", &path("a.gltf")],
        &["info", &path("buffer.gltf")],
        &["info", "knot", "--environment", &path("a.hdr")],
        &["info", "knot", "--environment", &path("a.exr")],
        &["info", "knot", "--environment", &path("a.png")],
        &["render", "knot", "--settings", &path("a.json"), "-o", &output],
        &["sweep", &path("a.toml"), "-o", &path("sweep")],
        &["compare", &path("a.exr"), &path("a.exr")],
        &["report", &path("")],
        &["report", &path(""), "--markdown", &path("a.md")],
        &["view", "knot", "--script", &path("a.toml")],
    ] {
        assert_refused(args, 2, "not a regular file");
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn what_cannot_be_written_is_3() {
    let blocked = Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml/maps");
    assert_refused(&["sweep", "smoke", "-o", &blocked.to_string_lossy()], 3, "can't write");
}

#[test]
fn a_machine_that_cannot_trace_rays_is_4() {
    assert_refused(&["render", "-o", "unused.png"], 4, "Vulkan");
    assert!(!Path::new("unused.png").exists());
}

#[test]
fn help_lists_them() {
    let output = candela(&["--help"]);
    let help = String::from_utf8_lossy(&output.stdout);
    for kind in candela::error::Kind::ALL {
        assert!(help.contains(&format!("  {}  {}", kind.exit_code(), kind.meaning())), "{help}");
    }
}
