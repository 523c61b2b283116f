//! Decides what is missing and which commands bring it. Pure: no file is read and nothing is run.

use super::Options;
use super::machine::{DISPLAY, LOADER, MESA, Machine, System, VALIDATION};
use anyhow::{Context, Result};

/// The first Mesa whose lavapipe has VK_KHR_ray_tracing_pipeline (Mesa 24.1.0 release notes, May 2024).
const RAY_TRACING_MESA: (u32, u32) = (24, 1);

/// The release whose own Mesa (22.3) is older, but whose backports (25.0) are not. Later ones bring 25.0 themselves.
const NEEDS_BACKPORTS: &str = "bookworm";

const BACKPORTS_FILE: &str = "/etc/apt/sources.list.d/candela-backports.sources";

pub const TOO_OLD: &str = "the system's Mesa can't trace rays in software: that takes Mesa 24.1, which Debian 12 (backports), Debian 13 and Ubuntu 24.04 have";

#[derive(Debug, PartialEq, Eq)]
pub enum Plan {
    /// Nothing to do; the driver in words.
    Ready(String),
    /// In this order, as root.
    Install(Vec<Action>),
    /// A person has to install it.
    Advise(String),
}

/// A command and what it reads.
#[derive(Debug, PartialEq, Eq)]
pub struct Action {
    pub argv: Vec<String>,
    pub stdin: Option<String>,
}

impl Action {
    fn new(argv: &[&str]) -> Self {
        Self { argv: argv.iter().map(|word| word.to_string()).collect(), stdin: None }
    }

    fn apt_get(words: &[&str]) -> Self {
        Self::new(&[&["env", "DEBIAN_FRONTEND=noninteractive", "apt-get"], words].concat())
    }

    fn write(path: &str, text: String) -> Self {
        Self { stdin: Some(text), ..Self::new(&["tee", path]) }
    }

    /// As a line (or more) for a person's shell.
    pub fn shell(&self, prefix: &str) -> String {
        let line = format!("{prefix}{}", self.argv.join(" "));
        match &self.stdin {
            Some(text) => format!("{line} <<'END'\n{text}END"),
            None => line,
        }
    }
}

/// # Errors
/// Backports are needed and no source shows a mirror for them.
pub fn decide(machine: &Machine, options: &Options) -> Result<Plan> {
    let codename = match &machine.system {
        System::Debian { codename } => codename,
        System::Other(name) => {
            return Ok(elsewhere(name, machine.gpu.as_ref().filter(|_| !options.software)));
        }
    };
    let installed = |package: &str| machine.packages.get(package).map(String::as_str);
    let software = installed(MESA).filter(|version| traces_rays(version));
    let driver = match (&machine.gpu, software) {
        (Some(gpu), _) if !options.software => {
            Some(format!("{gpu}; should it be too old to trace rays: cargo xtask setup --software"))
        }
        (_, Some(version)) => Some(format!("Mesa {version}, lavapipe traces rays in software")),
        _ => None,
    };
    let mut missing = vec![LOADER];
    if options.tests {
        missing.push(VALIDATION);
        missing.extend(DISPLAY);
    }
    missing.retain(|package| installed(package).is_none());
    match driver {
        Some(driver) if missing.is_empty() => Ok(Plan::Ready(driver)),
        Some(_) => Ok(Plan::Install(apt_actions(&missing, None))),
        None if codename == NEEDS_BACKPORTS => {
            backports_actions(machine, codename, &missing).map(Plan::Install)
        }
        None => {
            missing.push(MESA);
            Ok(Plan::Install(apt_actions(&missing, None)))
        }
    }
}

fn elsewhere(system: &str, gpu: Option<&String>) -> Plan {
    match gpu {
        Some(gpu) => Plan::Ready(gpu.clone()),
        None => Plan::Advise(format!(
            "{system}: setup installs on Debian and Ubuntu only. Candela needs the Vulkan loader and a driver with \
             VK_KHR_ray_tracing_pipeline: your GPU's, or Mesa 24.1 or newer (lavapipe, in software); \
             its tests also use the Khronos validation layers."
        )),
    }
}

fn apt_actions(packages: &[&str], suite: Option<&str>) -> Vec<Action> {
    let mut install = vec!["install", "-y", "--no-install-recommends"];
    install.extend(suite.iter().flat_map(|suite| ["-t", suite]));
    install.extend(packages);
    vec![Action::apt_get(&["update"]), Action::apt_get(&install)]
}

fn backports_actions(machine: &Machine, codename: &str, missing: &[&str]) -> Result<Vec<Action>> {
    let suite = format!("{codename}-backports");
    let uri_of = |suite: &str| machine.sources.iter().find(|s| s.suite == suite).map(|s| &s.uri);
    let mut actions = Vec::new();
    if uri_of(&suite).is_none() {
        // The machine's own mirror.
        let uri = uri_of(codename).with_context(|| {
            format!(
                "no apt source serves '{codename} main'; add one for {suite} by hand, then run this again"
            )
        })?;
        let source = format!("Types: deb\nURIs: {uri}\nSuites: {suite}\nComponents: main\n");
        let why = "# Candela: a Mesa whose software driver traces rays (cargo xtask setup).\n";
        actions.push(Action::write(BACKPORTS_FILE, format!("{why}{source}")));
    }
    actions.extend(apt_actions(&[missing, &[MESA]].concat(), Some(&suite)));
    Ok(actions)
}

/// `version`: a Debian version, `[epoch:]upstream[-revision]`.
fn traces_rays(version: &str) -> bool {
    let upstream = version.split_once(':').map_or(version, |(_, rest)| rest);
    let mut numbers =
        upstream.split(|c: char| !c.is_ascii_digit()).map_while(|digits| digits.parse::<u32>().ok());
    let (major, minor) = (numbers.next().unwrap_or(0), numbers.next().unwrap_or(0));
    (major, minor) >= RAY_TRACING_MESA
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setup::machine::Source;

    const PLAIN: Options = Options { tests: false, software: false };
    const TESTS: Options = Options { tests: true, software: false };

    fn source(suite: &str) -> Source {
        Source { uri: "http://mirror.example/debian/".into(), suite: suite.into() }
    }

    fn debian(codename: &str, packages: &[(&str, &str)]) -> Machine {
        Machine {
            system: System::Debian { codename: codename.into() },
            gpu: None,
            packages: packages
                .iter()
                .map(|(name, version)| (name.to_string(), version.to_string()))
                .collect(),
            sources: vec![source("bookworm")],
        }
    }

    /// The plan's commands as a person would type them.
    fn commands(machine: &Machine, options: &Options) -> Vec<String> {
        match decide(machine, options).unwrap() {
            Plan::Install(actions) => actions.iter().map(|action| action.shell("")).collect(),
            plan => panic!("{plan:?}"),
        }
    }

    const UPDATE: &str = "env DEBIAN_FRONTEND=noninteractive apt-get update";
    const INSTALL: &str = "env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends";

    #[test]
    fn mesa_versions() {
        // (version, does its lavapipe trace rays): Debian 11, 12, 12 backports, Ubuntu 22.04, 24.04, 24.04 updates.
        let known = [
            ("20.3.5-1", false),
            ("22.3.6-1+deb12u2", false),
            ("25.0.7-2~bpo12+1", true),
            ("23.2.1-1ubuntu3.1~22.04.3", false),
            ("24.0.5-1ubuntu1", false),
            ("25.2.8-0ubuntu0.24.04.1", true),
            ("24.1.0~rc1-1", true),
            ("2:24.2.0-1", true),
            ("100.0", true),
            ("git", false),
            ("", false),
        ];
        for (version, expected) in known {
            assert_eq!(traces_rays(version), expected, "{version}");
        }
    }

    #[test]
    fn nothing_to_do_when_all_is_there() {
        let driver = [(LOADER, "1.3.239.0-1"), (MESA, "25.0.7-2~bpo12+1"), (VALIDATION, "1.3")];
        let all: Vec<_> = driver.into_iter().chain(DISPLAY.map(|name| (name, "1"))).collect();
        let machine = debian("bookworm", &all);
        let plan = decide(&machine, &TESTS).unwrap();
        assert!(matches!(&plan, Plan::Ready(driver) if driver.contains("25.0.7")), "{plan:?}");
        // Negative control: any one package less is work.
        for package in [LOADER, MESA, VALIDATION].into_iter().chain(DISPLAY) {
            let mut less = machine.clone();
            less.packages.remove(package);
            assert!(commands(&less, &TESTS).iter().any(|line| line.contains(package)), "{package}");
        }
    }

    #[test]
    fn a_bare_debian_12_gets_backports_from_its_own_mirror() {
        let lines = commands(&debian("bookworm", &[]), &TESTS);
        let [source, update, install] = lines.as_slice() else { panic!("{lines:?}") };
        assert!(
            source.starts_with("tee /etc/apt/sources.list.d/candela-backports.sources <<'END'\n"),
            "{source}"
        );
        assert!(
            source.contains("\nURIs: http://mirror.example/debian/\nSuites: bookworm-backports\n"),
            "{source}"
        );
        assert!(source.ends_with("\nComponents: main\nEND"), "{source}");
        assert_eq!(update, UPDATE);
        assert_eq!(
            install,
            &format!(
                "{INSTALL} -t bookworm-backports libvulkan1 vulkan-validationlayers {} mesa-vulkan-drivers",
                DISPLAY.join(" ")
            )
        );
    }

    #[test]
    fn debian_12_with_its_old_mesa_is_upgraded_and_a_known_source_is_not_added_twice() {
        let mut machine = debian("bookworm", &[(LOADER, "1.3.239.0-1"), (MESA, "22.3.6-1+deb12u2")]);
        machine.sources.push(source("bookworm-backports"));
        let install = format!("{INSTALL} -t bookworm-backports mesa-vulkan-drivers");
        assert_eq!(commands(&machine, &PLAIN), [UPDATE.to_string(), install]);
    }

    #[test]
    fn later_releases_use_their_own_suite() {
        let install = format!("{INSTALL} libvulkan1 mesa-vulkan-drivers");
        for codename in ["trixie", "noble"] {
            assert_eq!(commands(&debian(codename, &[]), &PLAIN), [UPDATE.to_string(), install.clone()]);
        }
    }

    #[test]
    fn debian_12_without_a_mirror_is_an_error() {
        let mut machine = debian("bookworm", &[]);
        machine.sources.clear();
        let error = decide(&machine, &PLAIN).unwrap_err().to_string();
        assert!(error.contains("'bookworm main'"), "{error}");
    }

    #[test]
    fn a_gpu_needs_the_loader_only() {
        let mut machine = debian("bookworm", &[]);
        machine.gpu = Some("NVIDIA GPU".into());
        assert_eq!(commands(&machine, &PLAIN), [UPDATE.to_string(), format!("{INSTALL} libvulkan1")]);
        machine.packages.insert(LOADER.into(), "1.3.239.0-1".into());
        assert!(
            matches!(decide(&machine, &PLAIN).unwrap(), Plan::Ready(driver) if driver.starts_with("NVIDIA GPU"))
        );
        // Asked for, the software driver comes all the same.
        let software = Options { software: true, ..PLAIN };
        assert!(commands(&machine, &software)[2].ends_with("-t bookworm-backports mesa-vulkan-drivers"));
    }

    #[test]
    fn other_systems_get_advice_and_no_command() {
        let system = System::Other("Fedora Linux 42".into());
        let mut machine = Machine { system, ..debian("", &[]) };
        assert!(
            matches!(decide(&machine, &PLAIN).unwrap(), Plan::Advise(text) if text.starts_with("Fedora Linux 42: "))
        );
        machine.gpu = Some("AMD GPU".into());
        assert_eq!(decide(&machine, &TESTS).unwrap(), Plan::Ready("AMD GPU".into()));
    }
}
