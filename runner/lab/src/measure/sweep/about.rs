//! The device, program and commit that results were measured with.

use candela::vulkan::DeviceInfo;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::time::{SystemTime, UNIX_EPOCH};

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct About {
    pub program: String,
    /// Of the sources, or "unknown".
    pub commit: String,
    pub device: AboutDevice,
    /// Hash of the compiled shaders.
    pub shaders: String,
    pub command: String,
    /// Date and time, UTC.
    pub date: String,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct AboutDevice {
    pub name: String,
    pub driver: String,
    pub vulkan: String,
}

impl About {
    pub fn new(device: Option<&DeviceInfo>) -> Self {
        let device = device.map(|info| AboutDevice {
            name: info.name.clone(),
            driver: info.driver.clone(),
            vulkan: info.api_version.clone(),
        });
        About {
            program: format!("candela {}", env!("CARGO_PKG_VERSION")),
            commit: commit(),
            device: device.unwrap_or_default(),
            shaders: shaders(),
            command: command(),
            date: date(SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |d| d.as_secs())),
        }
    }
}

/// `CANDELA_COMMIT` now, or when the program was built; else what git says here.
fn commit() -> String {
    let given = std::env::var("CANDELA_COMMIT").ok().or(option_env!("CANDELA_COMMIT").map(str::to_owned));
    let asked = || {
        let git =
            std::process::Command::new("git").args(["rev-parse", "--short=12", "HEAD"]).output().ok()?;
        git.status.success().then(|| String::from_utf8_lossy(&git.stdout).trim().to_owned())
    };
    given.or_else(asked).unwrap_or_else(|| "unknown".into())
}

fn shaders() -> String {
    let mut hash = Sha256::new();
    for (stem, code) in candela_assets::MODULES {
        hash.update(stem);
        hash.update(code);
    }
    hash.finalize()[..6].iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The program without its folder, and its arguments.
fn command() -> String {
    let mut args = std::env::args();
    let program = args.next().unwrap_or_default();
    let name = std::path::Path::new(&program).file_name().map(|n| n.to_string_lossy().into_owned());
    name.into_iter().chain(args).collect::<Vec<_>>().join(" ")
}

/// `2026-01-31 12:05 UTC` of seconds since 1970 (Gregorian calendar: Fliegel & Van Flandern 1968).
fn date(seconds: u64) -> String {
    let (days, minutes) = ((seconds / 86400) as i64, seconds % 86400 / 60);
    let l = days + 2_440_588 + 68_569;
    let n = 4 * l / 146_097;
    let l = l - (146_097 * n + 3) / 4;
    let i = 4000 * (l + 1) / 1_461_001;
    let l = l - 1461 * i / 4 + 31;
    let j = 80 * l / 2447;
    let (day, l) = (l - 2447 * j / 80, j / 11);
    let (month, year) = (j + 2 - 12 * l, 100 * (n - 49) + i + l);
    format!("{year:04}-{month:02}-{day:02} {:02}:{:02} UTC", minutes / 60, minutes % 60)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From `date -u -d @SECONDS`.
    #[test]
    fn dates() {
        assert_eq!(date(0), "1970-01-01 00:00 UTC");
        assert_eq!(date(951_827_696), "2000-02-29 12:34 UTC");
        assert_eq!(date(1_893_455_999), "2029-12-31 23:59 UTC");
    }
}
