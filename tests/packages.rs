//! What `cargo package` puts into each package that can be published: all that its code includes, and its licences.

use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Component, Path, PathBuf};
use std::process::Command;
use tests::docs::workspace;

/// crates.io takes no more, compressed.
const MOST_BYTES: u64 = 10 << 20;

fn cargo(arguments: &[&str]) -> String {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo).args(arguments).current_dir(workspace()).output().expect("cargo runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("it prints text")
}

/// Names and folders of the packages that may be published.
fn packages() -> Vec<(String, PathBuf)> {
    let text = cargo(&["metadata", "--no-deps", "--format-version", "1", "--locked", "--offline"]);
    let metadata: Value = serde_json::from_str(&text).expect("it prints JSON");
    let packages = metadata["packages"].as_array().expect("a list");
    let public = packages.iter().filter(|package| package["publish"].is_null());
    let text = |value: &Value| value.as_str().expect("text").to_owned();
    public
        .map(|package| {
            (text(&package["name"]), plain(&Path::new(&text(&package["manifest_path"])).join("..")))
        })
        .collect()
}

/// Literals that `text` includes at compile time, outside of its tests.
fn included(text: &str) -> Vec<&str> {
    let program = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let after =
        ["include_str!(\"", "include_bytes!(\""].into_iter().flat_map(|start| program.split(start).skip(1));
    after.filter_map(|rest| rest.split('"').next()).collect()
}

/// `path` without its `..`.
fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        if part != Component::ParentDir || !plain.pop() {
            plain.push(part);
        }
    }
    plain
}

/// What is wrong with a package in `folder` that consists of `files`.
fn faults(folder: &Path, files: &BTreeSet<PathBuf>) -> Vec<String> {
    let mut wanted: BTreeSet<PathBuf> =
        ["LICENSE-MIT", "LICENSE-APACHE", "Cargo.toml"].map(PathBuf::from).into();
    for file in files.iter().filter(|file| file.extension().is_some_and(|e| e == "rs")) {
        if file.components().any(|part| part.as_os_str().to_string_lossy().contains("tests")) {
            continue;
        }
        let text = fs::read_to_string(folder.join(file)).expect("a listed file exists");
        wanted.extend(included(&text).into_iter().map(|path| plain(&file.with_file_name(path))));
    }
    let lacking = wanted.difference(files).map(|file| format!("{} is missing", file.display()));
    // Before it is compressed, and without what cargo writes itself.
    let bytes: u64 = files.iter().filter_map(|file| Some(fs::metadata(folder.join(file)).ok()?.len())).sum();
    let large = (bytes > MOST_BYTES).then(|| format!("{bytes} bytes are too many"));
    lacking.chain(large).collect()
}

#[test]
fn packages_are_whole() {
    let packages = packages();
    let names: Vec<_> = packages.iter().map(|(name, _)| name.as_str()).collect();
    for name in ["shared", "shaders", "assets", "renderer", "lab", "viewer", "cli"] {
        assert!(names.contains(&format!("candela-{name}").as_str()), "{names:?}");
    }
    for (name, folder) in &packages {
        let list = cargo(&["package", "--list", "--allow-dirty", "--locked", "--offline", "-p", name]);
        let files: BTreeSet<PathBuf> = list.lines().map(PathBuf::from).collect();
        assert_eq!(faults(folder, &files), Vec::<String>::new(), "{name}");
        if name == "candela-assets" {
            // A macro names the shaders.
            let shaders = fs::read_dir(folder.join("shaders")).unwrap().map(|file| file.unwrap().file_name());
            let missing: Vec<_> =
                shaders.filter(|shader| !files.contains(&Path::new("shaders").join(shader))).collect();
            assert!(missing.is_empty(), "{missing:?}");
            // Negative controls: a plan or a licence left out.
            for left_out in ["plans/bench.toml", "LICENSE-MIT"] {
                let fewer = files.iter().filter(|file| *file != Path::new(left_out)).cloned().collect();
                assert_eq!(faults(folder, &fewer), [format!("{left_out} is missing")]);
            }
        }
    }
}
