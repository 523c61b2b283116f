//! Reading files that others made: regular ones alone, since a pipe or a device may never end.

use crate::error::{Error, Result};
use std::path::Path;
use std::{fs, io};

/// Largest document (settings, a plan, results, a script), bytes.
const MAX_TEXT: u64 = 64 << 20;

/// As `fs::read`. Errors: no regular file, or one that can't be read.
pub fn bytes(path: &Path) -> io::Result<Vec<u8>> {
    size(path)?;
    fs::read(path)
}

/// As [`bytes`], with the file's name in the error.
pub fn read(path: &Path) -> Result<Vec<u8>> {
    bytes(path).map_err(Error::read(path))
}

/// A document. Errors: as [`bytes`], more than [`MAX_TEXT`], no UTF-8.
pub fn read_text(path: &Path) -> Result<String> {
    let text = || {
        if size(path)? > MAX_TEXT {
            return Err(io::Error::other(format!("a document has at most {} MiB", MAX_TEXT >> 20)));
        }
        fs::read_to_string(path)
    };
    text().map_err(Error::read(path))
}

/// Its bytes, asked for before it is opened: opening a pipe waits for its writer. Error: no regular file.
pub fn size(path: &Path) -> io::Result<u64> {
    let metadata = fs::metadata(path)?;
    if metadata.is_file() { Ok(metadata.len()) } else { Err(io::Error::other("not a regular file")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Folders and, where there are such, devices that never end and files larger than any memory.
    #[test]
    fn only_regular_files_are_read() {
        let folder = std::env::temp_dir().join(format!("candela-files-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let (plain, large) = (folder.join("plain"), folder.join("large"));
        fs::write(&plain, "text").unwrap();
        // Sparse: it takes no place.
        fs::File::create(&large).and_then(|file| file.set_len(1 << 40)).unwrap();
        assert_eq!((bytes(&plain).unwrap(), read_text(&plain).unwrap()), (b"text".to_vec(), "text".into()));
        let mut refused = vec![(folder.clone(), "not a regular file")];
        if cfg!(unix) {
            refused.push(("/dev/zero".into(), "not a regular file"));
        }
        for (path, reason) in &refused {
            for error in [read(path).unwrap_err().to_string(), read_text(path).unwrap_err().to_string()] {
                assert!(error.contains(reason) && error.contains(&path.display().to_string()), "{error}");
            }
        }
        assert!(read_text(&large).unwrap_err().to_string().contains("64 MiB"));
        fs::remove_dir_all(&folder).unwrap();
    }
}
