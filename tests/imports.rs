//! Who imports what in `runner`: each room knows only those below it, each large library has its own room, and trees of
//! dependencies hold only what a package is for.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Command;
use tests::docs::{files, workspace};

/// The rooms of the library and of the measurements. A room imports only from those before it.
const ROOMS: [&str; 13] = [
    "error",
    "files",
    "exposure",
    "parallel",
    "startup",
    "image_io",
    "scene",
    "vulkan",
    "gpu_scene",
    "frame",
    "knobs",
    "explain",
    "measure",
];

/// A library, and the rooms that may name it.
const LIBRARIES: [(&str, &[&str]); 4] =
    [("exr", &["image_io"]), ("gltf", &["scene"]), ("gpu_allocator", &["vulkan"]), ("toml", &["measure"])];

/// Libraries that show windows, or need one.
const WINDOWS: [&str; 7] =
    ["ash-window", "egui", "egui-winit", "raw-window-handle", "wayland-client", "winit", "x11rb"];

/// Libraries for programs, which a library leaves to those.
const PROGRAMS: [&str; 3] = ["clap", "indicatif", "tracing-subscriber"];

/// The first part of a file's path: `scene` of `scene/gltf/mod.rs`, `error` of `error.rs`.
fn room(file: &Path) -> String {
    let first = file.components().next().map(|part| part.as_os_str().to_string_lossy().into_owned());
    first.unwrap_or_default().trim_end_matches(".rs").to_owned()
}

/// What `text` does not need to build the program, and comments, left out.
fn program(text: &str) -> String {
    let program = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    program.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n")
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Names that follow `before` in `text`, one or those in braces, where `before` begins a word.
fn names_after<'a>(text: &'a str, before: &str) -> Vec<&'a str> {
    let mut names = Vec::new();
    for (at, _) in text.match_indices(before) {
        let rest = &text[at + before.len()..];
        if text[..at].ends_with(|c: char| is_word(c) || c == ':') {
            continue;
        }
        let word = |text: &'a str| text.split(|c| !is_word(c)).next().unwrap_or_default();
        match rest.strip_prefix('{').and_then(|rest| rest.split(';').next()) {
            Some(group) => names.extend(outermost(group).map(|part| word(part.trim()))),
            None => names.push(word(rest)),
        }
    }
    names
}

/// The parts of `a::{b, c}, d` between its own commas.
fn outermost(group: &str) -> impl Iterator<Item = &str> {
    let mut depth = 0;
    group.split(move |c| {
        depth += i32::from(c == '{') - i32::from(c == '}');
        c == ',' && depth == 0
    })
}

/// What is wrong with a file of `room` that says `text`.
fn faults(room: &str, text: &str) -> Vec<String> {
    let place = |name: &str| ROOMS.iter().position(|room| *room == name);
    let mut faults = Vec::new();
    for other in names_after(text, "crate::").into_iter().filter(|&other| other != room) {
        match (place(room), place(other)) {
            (Some(here), Some(there)) if there < here => {}
            (Some(_), Some(_)) => faults.push(format!("{room} imports {other}, which lies above it")),
            _ => faults.push(format!("{room} imports {other}: which of them has no place in ROOMS?")),
        }
    }
    for (library, rooms) in LIBRARIES {
        let uses = text.contains(&format!("use {library};"))
            || !names_after(text, &format!("{library}::")).is_empty();
        if uses && !rooms.contains(&room) {
            faults.push(format!("{room} uses {library}, which belongs to {}", rooms.join(" and ")));
        }
    }
    faults
}

#[test]
fn rooms_know_only_those_below_and_libraries_have_their_rooms() {
    let sources = ["runner/src", "runner/lab/src"].map(|source| workspace().join(source));
    let mut faults_found = Vec::new();
    for file in sources.iter().flat_map(|source| files(source, "rs")) {
        let inside = sources.iter().find_map(|source| file.strip_prefix(source).ok()).unwrap();
        let is_test = inside.components().any(|part| part.as_os_str() == "tests")
            || inside.file_stem().is_some_and(|stem| stem.to_string_lossy().ends_with("tests"));
        if is_test || inside == Path::new("lib.rs") {
            continue;
        }
        let text = program(&fs::read_to_string(&file).unwrap());
        let found = faults(&room(inside), &text);
        faults_found.extend(found.into_iter().map(|fault| format!("{}: {fault}", inside.display())));
    }
    assert!(faults_found.is_empty(), "{}", faults_found.join("\n"));
}

/// Negative control: each kind of fault is seen, and nothing else.
#[test]
fn faults_are_seen() {
    assert_eq!(faults("measure", "use crate::attic::view;\nuse exr::image;").len(), 2);
    assert_eq!(faults("frame", "#[derive(Debug, toml::ValueEnum)]").len(), 1);
    assert_eq!(faults("scene", "use crate::attic::Box;").len(), 1);
    assert_eq!(faults("frame", "use crate::{explain::{rays, text}, error::Error, measure};").len(), 2);
    assert_eq!(
        faults("measure", "use toml;\nuse crate::explain::rays;\nuse crate::measure::sweep;"),
        Vec::<String>::new()
    );
    assert_eq!(faults("explain", "explain::exr::x my_exr::y"), Vec::<String>::new());
    assert_eq!(program("a\n// exr::b\n#[cfg(test)]\nmod tests {\nuse exr::c;"), "a");
    assert_eq!(
        (room(Path::new("vulkan/image.rs")), room(Path::new("error.rs"))),
        ("vulkan".into(), "error".into())
    );
}

/// Names of all packages that `package` is linked from, on this machine.
fn tree(package: &[&str]) -> BTreeSet<String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command.args(["tree", "-e", "normal", "--prefix", "none", "--locked", "--offline", "-p"]).args(package);
    let output = command.current_dir(workspace()).output().expect("cargo runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).expect("it prints text");
    text.lines().filter_map(|line| line.split(' ').next()).map(str::to_owned).collect()
}

fn among(tree: &BTreeSet<String>, names: &[&str]) -> Vec<String> {
    names.iter().filter(|name| tree.contains(**name)).map(|name| name.to_string()).collect()
}

#[test]
fn the_library_has_no_window_and_no_command_line() {
    let library = tree(&["candela-renderer"]);
    assert!(library.contains("ash") && library.contains("candela-shared"), "{library:?}");
    assert_eq!(among(&library, &[WINDOWS.as_slice(), &PROGRAMS].concat()), Vec::<String>::new());
    assert_eq!(
        among(&tree(&["candela-lab"]), &[WINDOWS.as_slice(), &PROGRAMS].concat()),
        Vec::<String>::new()
    );
    let blind = tree(&["candela-cli", "--no-default-features"]);
    assert_eq!(among(&blind, &WINDOWS), Vec::<String>::new());
    // Negative control: the whole program has all of them.
    let whole = tree(&["candela-cli"]);
    assert_eq!(
        among(&whole, &[WINDOWS.as_slice(), &PROGRAMS].concat()).len(),
        WINDOWS.len() + PROGRAMS.len()
    );
}
