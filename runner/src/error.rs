//! Errors that a user can meet: each names its resource, what is wrong with it and what to do, and has a kind, which is the
//! program's exit code.

use std::fmt::{self, Display, Formatter};
use std::io;
use std::path::{Path, PathBuf};

/// Of everything that can fail.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// What went wrong, in the words of a message; [`Error::kind`] says whose fault it is.
///
/// ```
/// use candela::error::Kind;
/// use candela::image_io::format_of;
///
/// let error = format_of("picture.gif".as_ref()).unwrap_err();
/// assert_eq!(error.to_string(), "picture.gif: pictures are written as .png or .exr");
/// assert_eq!(error.kind(), Kind::Input);
/// ```
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "messages name the fields of variants")]
pub enum Error {
    /// What was asked for can't be done, whatever the machine.
    #[error("{0}")]
    Usage(String),

    /// A scene, picture, plan, document or script that can be read and is wrong.
    #[error("{}: {reason}", path.display())]
    Input { path: PathBuf, reason: String },

    /// The file isn't there, or isn't ours.
    #[error("{}: can't read: {source}", path.display())]
    Read { path: PathBuf, source: io::Error },

    /// Nothing can be written there.
    #[error("{}: can't write: {source}", path.display())]
    Write { path: PathBuf, source: io::Error },

    /// Everything ran, and what it was to find out is bad.
    #[error("{0}")]
    Check(String),

    /// A limit or a missing ability of this device, its driver or the display.
    #[error("{0}")]
    Unsupported(String),

    /// No libvulkan.
    #[error(
        "no Vulkan loader (libvulkan.so.1): {0}; install your GPU's driver, or `cargo xtask setup` for the software one"
    )]
    NoLoader(String),

    /// `seen`: one line a device, with what it lacks.
    #[error("no Vulkan device can trace rays{}; `cargo xtask setup` installs a software one", seen_devices(.seen))]
    NoDevice { seen: Vec<String> },

    /// An allocation that failed, or would.
    #[error("out of memory: {what} needs {bytes} bytes ({device} has {left}); use a smaller --size or scene")]
    OutOfMemory { what: String, bytes: u64, device: &'static str, left: Left },

    /// The system has no more of them.
    #[error("can't start a thread to {to}: {source}")]
    NoThread { to: &'static str, source: io::Error },

    /// In the pass that is named.
    #[error("device lost in pass '{0}': the GPU was reset or the driver failed")]
    DeviceLost(String),

    /// A call that failed, by what it was for.
    #[error("Vulkan: {what}: {result}")]
    Vulkan { what: String, result: ash::vk::Result },

    /// What libraries between us and the device or the display say.
    #[error("{0}")]
    Platform(String),

    /// A broken promise of the code.
    #[error("internal error: {0}; please report it")]
    Internal(String),
}

/// What memory there is where there is too little.
#[derive(Clone, Copy, Debug)]
pub enum Left {
    /// An allocation failed.
    Less,
    /// So much is left.
    Bytes(u64),
}

impl Display for Left {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        match self {
            Left::Less => write!(f, "no more"),
            Left::Bytes(bytes) => write!(f, "{bytes} left"),
        }
    }
}

/// What an error means for whoever started the program: its exit code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Kind {
    /// Everything ran, and its result is bad.
    Check = 1,
    /// Also that of clap.
    Input = 2,
    /// Nothing can be written there.
    Output = 3,
    /// This machine can't.
    Unsupported = 4,
    /// No memory, or no thread.
    Exhausted = 5,
    /// The driver or the window system failed.
    Platform = 6,
    /// A fault of the program.
    Internal = 7,
}

impl Kind {
    /// In the order of their codes.
    pub const ALL: [Kind; 7] = [
        Kind::Check,
        Kind::Input,
        Kind::Output,
        Kind::Unsupported,
        Kind::Exhausted,
        Kind::Platform,
        Kind::Internal,
    ];

    /// 1 to 7.
    pub fn exit_code(self) -> u8 {
        self as u8
    }

    /// For `--help` and docs/command-line.md.
    pub fn meaning(self) -> &'static str {
        match self {
            Kind::Check => {
                "a check failed: points of a sweep, the validation layer (--validate), a script's expectation"
            }
            Kind::Input => "bad input: the command line, or a file that it names is missing or wrong",
            Kind::Output => "a file or folder can't be written",
            Kind::Unsupported => {
                "this machine can't: no Vulkan, no device that traces rays, no display, a limit of the device"
            }
            Kind::Exhausted => "out of memory or threads",
            Kind::Platform => "the device, its driver or the window system failed",
            Kind::Internal => "a fault of the program: please report it",
        }
    }
}

impl Error {
    /// What it means for whoever started the program.
    pub fn kind(&self) -> Kind {
        match self {
            Error::Usage(_) | Error::Input { .. } | Error::Read { .. } => Kind::Input,
            Error::Write { .. } => Kind::Output,
            Error::Check(_) => Kind::Check,
            Error::Unsupported(_) | Error::NoLoader(_) | Error::NoDevice { .. } => Kind::Unsupported,
            Error::OutOfMemory { .. } | Error::NoThread { .. } => Kind::Exhausted,
            Error::DeviceLost(_) | Error::Vulkan { .. } | Error::Platform(_) => Kind::Platform,
            Error::Internal(_) => Kind::Internal,
        }
    }

    /// For `map_err`: what is wrong in the file at `path`.
    pub fn input<R: Display>(path: &Path) -> impl Fn(R) -> Error {
        move |reason| Error::Input { path: path.into(), reason: reason.to_string() }
    }

    /// For `map_err`: the file at `path` can't be read.
    pub fn read(path: &Path) -> impl Fn(io::Error) -> Error {
        move |source| Error::Read { path: path.into(), source }
    }

    /// For `map_err`: the file or folder at `path` can't be written.
    pub fn write(path: &Path) -> impl Fn(io::Error) -> Error {
        move |source| Error::Write { path: path.into(), source }
    }

    /// For `map_err`: what only a fault of the program can bring about.
    pub fn internal(error: impl Display) -> Error {
        Error::Internal(error.to_string())
    }
}

fn seen_devices(seen: &[String]) -> String {
    if seen.is_empty() { " (none was found)".into() } else { format!(" ({})", seen.join("; ")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What scripts rely on.
    #[test]
    fn each_kind_has_its_exit_code() {
        assert_eq!(Kind::ALL.map(Kind::exit_code), [1, 2, 3, 4, 5, 6, 7]);
        let path = Path::new("a");
        let text = || "b".to_owned();
        let io = || io::Error::other("c");
        let lost = ash::vk::Result::ERROR_INITIALIZATION_FAILED;
        for (error, code) in [
            (Error::Check(text()), 1),
            (Error::Usage(text()), 2),
            (Error::input(path)("b"), 2),
            (Error::read(path)(io()), 2),
            (Error::write(path)(io()), 3),
            (Error::Unsupported(text()), 4),
            (Error::NoLoader(text()), 4),
            (Error::NoDevice { seen: Vec::new() }, 4),
            (Error::OutOfMemory { what: text(), bytes: 1, device: "the GPU", left: Left::Less }, 5),
            (Error::NoThread { to: "wait", source: io() }, 5),
            (Error::DeviceLost(text()), 6),
            (Error::Vulkan { what: text(), result: lost }, 6),
            (Error::Platform(text()), 6),
            (Error::internal("b"), 7),
        ] {
            assert_eq!(error.kind().exit_code(), code, "{error}");
        }
    }
}
