//! `cargo xtask models`: third-party test models, fetched on demand through the package managers that carry them.
//! They are not needed to run Candela and are never committed.

use crate::command;
use anyhow::{Context, Result, bail, ensure};
use sha2::{Digest, Sha256};
use std::fs;
use std::path::{Path, PathBuf};

struct Model {
    name: &'static str,
    credit: &'static str,
    package: Package,
    /// The model's folder in the package.
    folder: &'static str,
    files: &'static [File],
}

/// What carries files of others.
pub enum Package {
    /// On crates.io: name, version.
    Crate(&'static str, &'static str),
    /// On PyPI: name, version.
    Wheel(&'static str, &'static str),
}

struct File {
    name: &'static str,
    sha256: &'static str,
}

const MODELS: [Model; 2] = [
    Model {
        name: "WaterBottle",
        credit: "CC0 1.0, Microsoft 2017, from Khronos glTF-Sample-Assets; textures scaled down to 256 x 256 by the package",
        package: Package::Crate("scena", "1.1.0"),
        folder: "tests/assets/gltf/khronos/WaterBottle",
        files: &[
            File {
                name: "WaterBottle.gltf",
                sha256: "0596f4e61dc781439d254fdfb5e3462daf1762c18715e3e3ac13001aa8f3f547",
            },
            File {
                name: "WaterBottle.bin",
                sha256: "e4921f2d0c0a03cf65286bd195f3688d4f99d7b6a58f25935e70d516d744156e",
            },
            File {
                name: "WaterBottle_baseColor.png",
                sha256: "d9b96cd4fee4a6e2ee6899f08eccc9734772c9690831abaeb93d11f16980f987",
            },
            File {
                name: "WaterBottle_emissive.png",
                sha256: "44d760ec04f62596b192e04facb3d9c53623b00d412b73eb40d75b46e058a36c",
            },
            File {
                name: "WaterBottle_normal.png",
                sha256: "123122881f208f382bf1247c86894c4e3e785ab49189f0075363e14a1b69df38",
            },
            File {
                name: "WaterBottle_occlusionRoughnessMetallic.png",
                sha256: "6ffb7f2447dd6fb5329392817940dad5216f8d234ab9c48d3eb21ca35fd47f5c",
            },
        ],
    },
    Model {
        name: "Suzanne",
        credit: "CC0 1.0, Norbert Nopper, UX3D 2017, from Khronos glTF-Sample-Assets; without textures and tangents",
        package: Package::Wheel("filly", "0.2.1"),
        folder: "filly/samples",
        files: &[File {
            name: "suzanne.glb",
            sha256: "175a8ddefb9dcf1f0929c2a6faffff81f13d9b1c67a580dcc4d82b18d78a6157",
        }],
    },
];

pub fn run() -> Result<()> {
    for model in &MODELS {
        let to = command::root().join("models").join(model.name);
        if !model
            .files
            .iter()
            .all(|file| fs::read(to.join(file.name)).is_ok_and(|bytes| sha256(&bytes) == file.sha256))
        {
            fetch(model, &to).with_context(|| format!("model '{}'", model.name))?;
        }
        println!(
            "models/{}/{}: {}; {}",
            model.name,
            model.files[0].name,
            model.credit,
            model.package.describe()
        );
    }
    Ok(())
}

fn fetch(model: &Model, to: &Path) -> Result<()> {
    let scratch = Scratch::new("models")?;
    let from = model.package.download(&scratch.0)?.join(model.folder);
    fs::create_dir_all(to).with_context(|| format!("can't create {}", to.display()))?;
    model.files.iter().try_for_each(|file| install(file, &from, to))
}

impl Package {
    fn describe(&self) -> String {
        match self {
            Self::Crate(name, version) => format!("crates.io: {name} {version}"),
            Self::Wheel(name, version) => format!("PyPI: {name} {version}"),
        }
    }

    /// Downloads the package and returns the folder of its contents, in `scratch` or in cargo's cache.
    pub fn download(&self, scratch: &Path) -> Result<PathBuf> {
        match self {
            Self::Crate(name, version) => {
                // `info` unpacks this one crate; `fetch` would download all that it depends on.
                let info = ["info", "--quiet", "--registry", "crates-io", &format!("{name}@{version}")];
                command::output(command::cargo().current_dir(scratch).args(info))?;
                unpacked_crate(&cargo_home()?.join("registry/src"), &format!("{name}-{version}"))
            }
            Self::Wheel(name, version) => {
                // One wheel for everybody, whatever Python and system runs this: it is only unpacked.
                let wheel = ["--python-version", "3.11", "--platform", "manylinux_2_28_x86_64"];
                // pip takes no platform to include another one.
                let older = ["--platform", "manylinux2014_x86_64"];
                let mut pip = command::program("python3");
                pip.args(["-m", "pip", "--disable-pip-version-check", "download", "--quiet", "--no-deps"]);
                pip.args(["--only-binary=:all:"]).args(wheel).args(older).arg("--dest").arg(scratch);
                command::run(pip.arg(format!("{name}=={version}"))).context("needs python3 with pip")?;
                let wheel = only_entry(scratch)?;
                let contents = scratch.join("contents");
                command::run(
                    command::program("python3").args(["-m", "zipfile", "-e"]).arg(wheel).arg(&contents),
                )?;
                Ok(contents)
            }
        }
    }
}

fn cargo_home() -> Result<PathBuf> {
    let home = || std::env::home_dir().map(|home| home.join(".cargo"));
    std::env::var_os("CARGO_HOME")
        .map(PathBuf::from)
        .or_else(home)
        .context("no home directory: set CARGO_HOME")
}

/// `src`: cargo's folder of unpacked crates, with one folder a registry.
fn unpacked_crate(src: &Path, name: &str) -> Result<PathBuf> {
    let registries = fs::read_dir(src).with_context(|| format!("can't read {}", src.display()))?;
    let mut found = registries.filter_map(|registry| Some(registry.ok()?.path().join(name)));
    found.find(|path| path.is_dir()).with_context(|| format!("cargo left no {name} in {}", src.display()))
}

fn only_entry(dir: &Path) -> Result<PathBuf> {
    let entry = fs::read_dir(dir)?.next().with_context(|| format!("{} is empty", dir.display()))?;
    Ok(entry?.path())
}

/// Copies `from/name` to `to/name` if its bytes are the pinned ones; under its final name a file is always whole.
fn install(file: &File, from: &Path, to: &Path) -> Result<()> {
    let source = from.join(file.name);
    let bytes = fs::read(&source).with_context(|| format!("can't read {}", source.display()))?;
    let sum = sha256(&bytes);
    ensure!(sum == file.sha256, "{} has sha256 {sum}, expected {}: not installed", file.name, file.sha256);
    let (part, whole) = (to.join(format!("{}.part", file.name)), to.join(file.name));
    fs::write(&part, bytes).with_context(|| format!("can't write {}", part.display()))?;
    fs::rename(&part, &whole).with_context(|| format!("can't write {}", whole.display()))
}

fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// A folder for downloads, gone when dropped.
pub struct Scratch(pub PathBuf);

impl Scratch {
    pub fn new(name: &str) -> Result<Self> {
        let path = std::env::temp_dir().join(format!("candela-{name}-{}", std::process::id()));
        match fs::remove_dir_all(&path) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                bail!("can't empty {}: {error}", path.display())
            }
            _ => fs::create_dir_all(&path).with_context(|| format!("can't create {}", path.display()))?,
        }
        Ok(Self(path))
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        // A left-over in the temporary folder is no reason to fail.
        let _ = fs::remove_dir_all(&self.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// FIPS 180-2, appendix B.1.
    const ABC: File =
        File { name: "abc", sha256: "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad" };

    #[test]
    fn a_file_is_installed_only_with_the_pinned_bytes() {
        let scratch = Scratch::new("models").unwrap();
        let (from, to) = (scratch.0.join("from"), scratch.0.join("to"));
        fs::create_dir_all(&from).unwrap();
        fs::create_dir_all(&to).unwrap();

        fs::write(from.join("abc"), "abd").unwrap();
        let error = install(&ABC, &from, &to).unwrap_err().to_string();
        assert!(error.contains("abc has sha256") && error.contains(ABC.sha256), "{error}");
        assert_eq!(fs::read_dir(&to).unwrap().count(), 0);

        fs::write(from.join("abc"), "abc").unwrap();
        install(&ABC, &from, &to).unwrap();
        let installed: Vec<_> = fs::read_dir(&to).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        assert_eq!(installed, ["abc"]);
        assert_eq!(fs::read(to.join("abc")).unwrap(), b"abc");
    }
}
