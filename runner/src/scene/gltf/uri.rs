//! URIs of glTF: a file beside the scene, or data in the URI itself.

use super::Reason;
use crate::files;
use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use std::borrow::Cow;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

/// Files with and without padding exist.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// What a URI stands for.
pub enum Content<'a> {
    Bytes(Cow<'a, [u8]>),
    /// Not yet opened.
    File(PathBuf),
}

/// Where `uri` points to; file names are relative to `base`. Errors: other schemes, broken base64.
pub fn find(uri: &str, base: &Path) -> Reason<Content<'static>> {
    if is_data(uri) {
        return Ok(Content::Bytes(read_data(uri)?.into()));
    }
    if uri.contains("://") || uri.starts_with("file:") {
        return Err(format!("'{}': only relative file names and data: URIs can be read", label(uri)));
    }
    let path = base.join(percent_decoded(uri));
    let path = if path.exists() { path } else { other_spelling(uri, base).unwrap_or(path) };
    Ok(Content::File(path))
}

/// The file that `uri` means as exporters spell it: as it is, percent signs included; with backslashes; in another case.
fn other_spelling(uri: &str, base: &Path) -> Option<PathBuf> {
    let literal = base.join(uri);
    if literal.exists() {
        return Some(literal);
    }
    let mut path = base.to_owned();
    for part in percent_decoded(uri).split(['/', '\\']).filter(|part| !part.is_empty()) {
        let exact = path.join(part);
        path = if exact.exists() { exact } else { path.join(in_any_case(&path, part)?) };
    }
    Some(path)
}

/// The entry of a folder whose name is `part` but for its case.
fn in_any_case(folder: &Path, part: &str) -> Option<OsString> {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let names = fs::read_dir(folder).ok()?.flatten().map(|entry| entry.file_name());
    let part = part.to_lowercase();
    names.into_iter().find(|name| name.to_str().is_some_and(|name| name.to_lowercase() == part))
}

/// The bytes of `uri`. Errors: as [`find`], no such file.
pub fn read(uri: &str, base: &Path) -> Reason<Vec<u8>> {
    match find(uri, base)? {
        Content::Bytes(bytes) => Ok(bytes.into_owned()),
        Content::File(path) => files::bytes(&path)
            .map_err(|error| format!("can't read '{}': {error}", label(&path.display().to_string()))),
    }
}

/// What to call a URI in a message: its name, or the head of it.
pub fn label(uri: &str) -> String {
    let (part, most) =
        if is_data(uri) { (uri.split(',').next().unwrap_or_default(), 40) } else { (uri, 200) };
    let head: String = part.chars().take(most).collect();
    if head.len() < uri.len() { format!("{head}...") } else { head }
}

fn is_data(uri: &str) -> bool {
    uri.get(..5).is_some_and(|scheme| scheme.eq_ignore_ascii_case("data:"))
}

fn read_data(uri: &str) -> Reason<Vec<u8>> {
    let Some((_, payload)) = uri.split_once(";base64,") else {
        return Err(format!("'{}': a data URI must be base64", label(uri)));
    };
    BASE64.decode(payload).map_err(|error| format!("'{}': broken base64: {error}", label(uri)))
}

/// `%20` and the like as the bytes they stand for (RFC 3986, 2.1); what is no valid escape stays as it is.
fn percent_decoded(uri: &str) -> String {
    let bytes = uri.as_bytes();
    let mut decoded = Vec::with_capacity(bytes.len());
    let mut i = 0;
    while i < bytes.len() {
        let escape = uri.get(i + 1..i + 3).filter(|_| bytes[i] == b'%');
        match escape.and_then(|hex| u8::from_str_radix(hex, 16).ok()) {
            Some(byte) => {
                decoded.push(byte);
                i += 3;
            }
            None => {
                decoded.push(bytes[i]);
                i += 1;
            }
        }
    }
    String::from_utf8(decoded).unwrap_or_else(|_| uri.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percent_escapes_are_decoded() {
        assert_eq!(percent_decoded("a%20b%2Fc"), "a b/c");
        assert_eq!(percent_decoded("%C3%A9.png"), "é.png");
        // No escape, cut short, not UTF-8, a character of two bytes behind the sign.
        for literal in ["100%.png", "a%2", "a%", "%ff", "%é1"] {
            assert_eq!(percent_decoded(literal), literal);
        }
    }

    #[test]
    fn data_uris_keep_their_length() {
        for (payload, data) in [("TWFu", "Man"), ("TWE=", "Ma"), ("TQ==", "M")] {
            let uri = format!("data:application/octet-stream;base64,{payload}");
            assert_eq!(read(&uri, Path::new("")).unwrap(), data.as_bytes());
        }
        assert!(read("data:text/plain,Man", Path::new("")).unwrap_err().contains("must be base64"));
        assert!(read("data:;base64,T!", Path::new("")).unwrap_err().contains("broken base64"));
        assert!(
            read("https://example.org/a.bin", Path::new("")).unwrap_err().contains("https://example.org")
        );
    }
}
