//! A slice of `cargo xtask fuzz` with a fixed seed, and faults that it must find.

use candela::knobs::Knobs;
use candela::scene::{EnvironmentSource, environment, gltf};
use candela_lab::measure::sweep::plan::Plan;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn fuzz(name: &str, arguments: &[&str]) -> (Output, PathBuf) {
    let folder = std::env::temp_dir().join(format!("candela-fuzzing-{name}-{}", std::process::id()));
    let mut fuzz = Command::new(env!("CARGO_BIN_EXE_fuzz"));
    (fuzz.args(arguments).arg("-o").arg(&folder).output().expect("it runs"), folder)
}

/// What is changed is right before: else the readers' first check is all that is tried.
#[test]
fn files_of_the_corpus_are_right() {
    let files = |folder: &str| {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(folder);
        let paths: Vec<PathBuf> =
            folder.read_dir().expect("the folder is there").map(|e| e.unwrap().path()).collect();
        assert!(!paths.is_empty());
        paths
    };
    for path in files("gltf") {
        let scene = gltf::load(&path).unwrap_or_else(|error| panic!("{error}"));
        assert!(
            !scene.instances.is_empty() && !scene.lights.is_empty() && !scene.textures.is_empty(),
            "{scene:?}"
        );
    }
    for path in files("environment") {
        environment::load(&EnvironmentSource::new(path)).unwrap_or_else(|error| panic!("{error}"));
    }
    for path in files("settings") {
        Knobs::read(&path).unwrap_or_else(|error| panic!("{error}"));
    }
    for path in files("plan") {
        Plan::read(&path).unwrap_or_else(|error| panic!("{error}"));
    }
}

/// Files of faults stay for who wants to look at them.
#[test]
fn no_wrong_file_breaks_a_reader() {
    let (run, _) = fuzz("slice", &["--cases", "1500"]);
    let said = String::from_utf8_lossy(&run.stdout);
    assert!(run.status.success(), "{said}{}", String::from_utf8_lossy(&run.stderr));
    assert_eq!(said.lines().filter(|line| line.contains(": 1500 cases, 0 faults")).count(), 4, "{said}");
}

/// The negative control: a panic, an abort, an endless loop and 300 MB for a small file.
#[test]
fn planted_faults_are_found() {
    let (run, folder) = fuzz("planted", &["--target", "planted", "--cases", "60", "--timeout", "4"]);
    let said = String::from_utf8_lossy(&run.stdout);
    assert!(!run.status.success(), "{said}");
    for fault in ["planted", "it died: signal", "no end within 4 s", "memory: too much"] {
        assert!(said.contains(fault), "{fault}: {said}");
    }
    assert_eq!(std::fs::read_dir(&folder).expect("files of faults").count(), 4, "{said}");
    std::fs::remove_dir_all(&folder).expect("it can be removed");
}
