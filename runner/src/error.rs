//! Errors that a user can meet: each names its resource, what is wrong with it and what to do.

use std::path::PathBuf;

#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A scene file that can't be drawn.
    #[error("{}: {reason}", path.display())]
    Scene { path: PathBuf, reason: String },

    #[error("{}: can't {action}: {source}", path.display())]
    File { path: PathBuf, action: &'static str, source: std::io::Error },

    #[error(
        "no Vulkan loader (libvulkan.so.1): {0}; install your GPU's driver, or `cargo xtask setup` for the software one"
    )]
    NoLoader(String),

    /// `seen`: one line a device, with what it lacks.
    #[error("no Vulkan device can trace rays{}; `cargo xtask setup` installs a software one", seen_devices(.seen))]
    NoDevice { seen: Vec<String> },

    #[error(
        "out of memory: {what} needs {bytes} bytes ({device} has no more); use a smaller --size or scene"
    )]
    OutOfMemory { what: String, bytes: u64, device: &'static str },

    #[error("device lost in pass '{0}': the GPU was reset or the driver failed")]
    DeviceLost(String),

    #[error("Vulkan: {what}: {result}")]
    Vulkan { what: String, result: ash::vk::Result },

    #[error("{0}")]
    Usage(String),
}

pub type Result<T, E = Error> = std::result::Result<T, E>;

fn seen_devices(seen: &[String]) -> String {
    if seen.is_empty() { " (none was found)".into() } else { format!(" ({})", seen.join("; ")) }
}
