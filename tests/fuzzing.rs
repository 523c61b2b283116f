//! A slice of `cargo xtask fuzz` with a fixed seed, and faults that it must find.

use std::path::PathBuf;
use std::process::{Command, Output};

fn fuzz(name: &str, arguments: &[&str]) -> (Output, PathBuf) {
    let folder = std::env::temp_dir().join(format!("candela-fuzzing-{name}-{}", std::process::id()));
    let mut fuzz = Command::new(env!("CARGO_BIN_EXE_fuzz"));
    (fuzz.args(arguments).arg("-o").arg(&folder).output().expect("it runs"), folder)
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
    let (run, folder) = fuzz("planted", &["--target", "planted", "--cases", "60", "--timeout", "2"]);
    let said = String::from_utf8_lossy(&run.stdout);
    assert!(!run.status.success(), "{said}");
    for fault in ["planted", "it died: signal", "no end within 2 s", "memory: too much"] {
        assert!(said.contains(fault), "{fault}: {said}");
    }
    assert_eq!(std::fs::read_dir(&folder).expect("files of faults").count(), 4, "{said}");
    std::fs::remove_dir_all(&folder).expect("it can be removed");
}
