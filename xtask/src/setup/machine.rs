//! What this machine is and has, asked of files, dpkg and apt in some ten milliseconds.

use crate::command;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

pub const LOADER: &str = "libvulkan1";
pub const MESA: &str = "mesa-vulkan-drivers";
pub const VALIDATION: &str = "vulkan-validationlayers";
/// A virtual display, a hand to press its keys, and what a window needs of X11.
pub const DISPLAY: [&str; 6] =
    ["xvfb", "xdotool", "libx11-xcb1", "libxcursor1", "libxi6", "libxkbcommon-x11-0"];

#[derive(Clone, Debug)]
pub struct Machine {
    pub system: System,
    /// The driver of a GPU that is really there, in words.
    pub gpu: Option<String>,
    /// Installed Debian packages among [`LOADER`], [`MESA`], [`VALIDATION`] and [`DISPLAY`], with their versions.
    pub packages: BTreeMap<String, String>,
    pub sources: Vec<Source>,
}

/// A package source with Debian's `main` component.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    pub uri: String,
    /// A release's codename, `-backports` and so on behind it.
    pub suite: String,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum System {
    /// Debian, Ubuntu or what is made from them: apt works. The codename is the release's, like `bookworm`.
    Debian {
        codename: String,
    },
    Other(String),
}

impl Machine {
    pub fn inspect() -> Self {
        let release = fs::read_to_string("/etc/os-release").unwrap_or_default();
        let system = system(&release, std::env::consts::OS);
        let debian = matches!(system, System::Debian { .. });
        Self {
            gpu: gpu(Path::new("/")),
            packages: if debian { packages() } else { BTreeMap::new() },
            sources: if debian { sources() } else { Vec::new() },
            system,
        }
    }
}

/// `release`: the text of os-release(5); `os`: the operating system, for want of such a file.
fn system(release: &str, os: &str) -> System {
    let field = |name: &str| {
        let value = release.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix('='));
        value.unwrap_or("").trim_matches(['"', '\'']).to_string()
    };
    let family = format!("{} {}", field("ID"), field("ID_LIKE"));
    if family.split_whitespace().any(|id| id == "debian" || id == "ubuntu") {
        return System::Debian { codename: field("VERSION_CODENAME") };
    }
    let name = field("PRETTY_NAME");
    System::Other(if name.is_empty() { os.to_string() } else { name })
}

/// A driver manifest whose vendor has a device here. Manifests alone prove nothing: Mesa installs all of its own.
fn gpu(root: &Path) -> Option<String> {
    let manifests = ["usr/share/vulkan/icd.d", "usr/local/share/vulkan/icd.d", "etc/vulkan/icd.d"];
    let names = manifests.iter().flat_map(|dir| list(&root.join(dir))).filter_map(|path| {
        let name = path.file_name()?.to_str()?.to_string();
        name.ends_with(".json").then_some(name)
    });
    names.into_iter().find_map(|name| {
        let (key, vendor, pci) = [
            ("nvidia", "NVIDIA", "0x10de"),
            ("radeon", "AMD", "0x1002"),
            ("amd", "AMD", "0x1002"),
            ("intel", "Intel", "0x8086"),
        ]
        .into_iter()
        .find(|(key, ..)| name.contains(key))?;
        let present = (key == "nvidia" && root.join("dev/nvidia0").exists()) || has_render_node(root, pci);
        present.then(|| format!("{vendor} GPU with its driver ({name})"))
    })
}

/// Is there a /dev/dri/renderD* of this PCI vendor? The vendor tells a GPU from a virtual machine's display.
fn has_render_node(root: &Path, pci_vendor: &str) -> bool {
    list(&root.join("dev/dri")).iter().filter_map(|node| node.file_name()).any(|node| {
        let vendor = root.join("sys/class/drm").join(node).join("device/vendor");
        node.to_string_lossy().starts_with("renderD")
            && fs::read_to_string(vendor).is_ok_and(|text| text.trim() == pci_vendor)
    })
}

fn packages() -> BTreeMap<String, String> {
    let format = "-f=${db:Status-Status} ${Package} ${Version}\n";
    let names = [LOADER, MESA, VALIDATION].into_iter().chain(DISPLAY);
    let query = command::try_output(command::program("dpkg-query").args(["-W", format]).args(names));
    parse_packages(&query.unwrap_or_default())
}

/// Lines of `status package version`; a package that was removed but not purged is listed as `config-files`.
fn parse_packages(text: &str) -> BTreeMap<String, String> {
    let words = text.lines().map(|line| line.split_whitespace().collect::<Vec<_>>());
    words
        .filter_map(|words| match words[..] {
            ["installed", package, version] => Some((package.to_string(), version.to_string())),
            _ => None,
        })
        .collect()
}

/// As apt itself reads its files, before any `update`. An architecture each has a line.
fn sources() -> Vec<Source> {
    let format = "$(REPO_URI) $(RELEASE) $(COMPONENT)";
    let query = ["indextargets", "--no-release-info", "--format", format, "Created-By: Packages"];
    parse_sources(&command::try_output(command::program("apt-get").args(query)).unwrap_or_default())
}

/// Lines of `uri suite component`.
fn parse_sources(text: &str) -> Vec<Source> {
    let words = text.lines().map(|line| line.split_whitespace().collect::<Vec<_>>());
    words
        .filter_map(|words| match words[..] {
            [uri, suite, "main"] => Some(Source { uri: uri.into(), suite: suite.into() }),
            _ => None,
        })
        .collect()
}

/// The directory's entries in order; none if it can't be read.
fn list(dir: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(dir).into_iter().flatten().filter_map(|entry| Some(entry.ok()?.path()));
    let mut paths: Vec<_> = entries.collect();
    paths.sort();
    paths
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A directory that stands for `/`, with these files.
    fn tree(name: &str, files: &[(&str, &str)]) -> PathBuf {
        let root = std::env::temp_dir().join(format!("candela-xtask-{name}-{}", std::process::id()));
        for (path, text) in files {
            let path = root.join(path);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        root
    }

    fn gpu_of(name: &str, files: &[(&str, &str)]) -> Option<String> {
        let root = tree(name, files);
        let found = gpu(&root);
        fs::remove_dir_all(&root).unwrap();
        found
    }

    #[test]
    fn systems() {
        let bookworm =
            "PRETTY_NAME=\"Debian GNU/Linux 12 (bookworm)\"\nVERSION_CODENAME=bookworm\nID=debian\n";
        assert_eq!(system(bookworm, "linux"), System::Debian { codename: "bookworm".into() });
        let mint = "ID=linuxmint\nID_LIKE=\"ubuntu debian\"\nVERSION_CODENAME=wilma\n";
        assert_eq!(system(mint, "linux"), System::Debian { codename: "wilma".into() });
        let fedora = "NAME=\"Fedora Linux\"\nID=fedora\nPRETTY_NAME=\"Fedora Linux 42\"\n";
        assert_eq!(system(fedora, "linux"), System::Other("Fedora Linux 42".into()));
        assert_eq!(system("", "macos"), System::Other("macos".into()));
    }

    #[test]
    fn a_gpu_needs_both_manifest_and_device() {
        let manifest = ("etc/vulkan/icd.d/nvidia_icd.json", "{}");
        let device = ("dev/nvidia0", "");
        assert!(gpu_of("nvidia", &[manifest, device]).unwrap().contains("NVIDIA"));
        assert_eq!(gpu_of("no-device", &[manifest]), None);
        assert_eq!(gpu_of("no-driver", &[device]), None);
    }

    #[test]
    fn mesa_manifests_count_only_with_their_vendors_device() {
        let mesa = ["intel_icd.json", "lvp_icd.json", "radeon_icd.json"]
            .map(|n| format!("usr/share/vulkan/icd.d/{n}"));
        let files = |vendor| {
            let mut files: Vec<_> = mesa.iter().map(|path| (path.as_str(), "{}")).collect();
            files.extend([("dev/dri/renderD128", ""), ("sys/class/drm/renderD128/device/vendor", vendor)]);
            files
        };
        assert!(gpu_of("amd", &files("0x1002\n")).unwrap().starts_with("AMD GPU"));
        assert!(gpu_of("intel", &files("0x8086\n")).unwrap().starts_with("Intel GPU"));
        assert_eq!(gpu_of("virtio", &files("0x1af4\n")), None);
    }

    #[test]
    fn only_installed_packages_count() {
        let found =
            parse_packages("installed libvulkan1 1.3.239.0-1\nconfig-files mesa-vulkan-drivers 22.3.6-1\n\n");
        assert_eq!(found, BTreeMap::from([(LOADER.to_string(), "1.3.239.0-1".to_string())]));
    }

    #[test]
    fn sources_are_those_with_main() {
        let text =
            "http://a.example/debian/ bookworm main\nhttp://a.example/debian/ bookworm contrib\nE: broken\n";
        let main = Source { uri: "http://a.example/debian/".into(), suite: "bookworm".into() };
        assert_eq!(parse_sources(text), [main]);
    }
}
