//! Who imports what in `runner`: each room knows only those below it, and each large library has its own room.

use std::fs;
use std::path::Path;
use tests::docs::{files, workspace};

/// A room imports only from those before it.
const ROOMS: [&str; 17] = [
    "error",
    "stdout",
    "files",
    "exposure",
    "parallel",
    "shader_library",
    "startup",
    "image_io",
    "scene",
    "vulkan",
    "gpu_scene",
    "frame",
    "knobs",
    "explain",
    "measure",
    "viewer",
    "cli",
];

/// A library, and the rooms that may name it.
const LIBRARIES: [(&str, &[&str]); 13] = [
    ("ash_window", &["vulkan"]),
    ("clap", &["cli"]),
    ("egui", &["viewer"]),
    ("egui_ash_renderer", &["viewer"]),
    ("egui_winit", &["viewer"]),
    ("exr", &["image_io"]),
    ("gltf", &["scene"]),
    ("gpu_allocator", &["vulkan", "viewer"]),
    ("indicatif", &["cli"]),
    ("raw_window_handle", &["vulkan"]),
    ("toml", &["measure"]),
    ("tracing_subscriber", &["main"]),
    ("winit", &["viewer"]),
];

/// The first part of a file's path: `viewer` of `viewer/panels/help.rs`, `error` of `error.rs`.
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
    let source = workspace().join("runner/src");
    let mut faults_found = Vec::new();
    for file in files(&source, "rs") {
        let inside = file.strip_prefix(&source).unwrap();
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
    assert_eq!(faults("measure", "use crate::cli::view;\nuse indicatif::ProgressBar;").len(), 2);
    assert_eq!(faults("frame", "#[derive(Debug, clap::ValueEnum)]").len(), 1);
    assert_eq!(faults("scene", "use crate::attic::Box;").len(), 1);
    assert_eq!(faults("frame", "use crate::{cli::{args, view}, error::Error, viewer};").len(), 2);
    assert_eq!(
        faults("cli", "use clap;\nuse crate::measure::sweep;\nuse crate::cli::args;"),
        Vec::<String>::new()
    );
    assert_eq!(faults("explain", "explain::clap::x my_clap::y"), Vec::<String>::new());
    assert_eq!(program("a\n// clap::b\n#[cfg(test)]\nmod tests {\nuse clap::c;"), "a");
    assert_eq!(
        (room(Path::new("viewer/gui.rs")), room(Path::new("error.rs"))),
        ("viewer".into(), "error".into())
    );
}
