//! What a glTF URI points to: a file beside the scene or data in the URI itself.

use super::Reason;
use crate::files;
use std::borrow::Cow;
use std::path::{Path, PathBuf};

/// What a URI stands for.
pub enum Content<'a> {
    Bytes(Cow<'a, [u8]>),
    /// Not yet opened.
    File(PathBuf),
}

/// Where `uri` points to; file names are relative to `base`. Errors: other schemes, broken base64.
pub fn find(uri: &str, base: &Path) -> Reason<Content<'static>> {
    if uri.starts_with("data:") {
        return Ok(Content::Bytes(read_data(uri)?.into()));
    }
    if uri.contains("://") || uri.starts_with("file:") {
        return Err(format!("'{uri}': only relative file names and data: URIs can be read"));
    }
    let decoded = percent_decoded(uri);
    let path = base.join(&decoded);
    // Some exporters write file names as they are, percent signs included.
    let literal = base.join(uri);
    Ok(Content::File(if !path.exists() && literal.exists() { literal } else { path }))
}

/// The bytes of `uri`. Errors: as [`find`], no such file.
pub fn read(uri: &str, base: &Path) -> Reason<Vec<u8>> {
    match find(uri, base)? {
        Content::Bytes(bytes) => Ok(bytes.into_owned()),
        Content::File(path) => {
            files::bytes(&path).map_err(|error| format!("can't read '{}': {error}", path.display()))
        }
    }
}

/// What to call a URI in a message: its name, or the head of its data.
pub fn label(uri: &str) -> String {
    if uri.starts_with("data:") {
        format!("{}...", uri.chars().take_while(|&c| c != ',').take(40).collect::<String>())
    } else {
        uri.to_owned()
    }
}

fn read_data(uri: &str) -> Reason<Vec<u8>> {
    let Some((_, payload)) = uri.split_once(";base64,") else {
        return Err(format!("'{}': a data URI must be base64", label(uri)));
    };
    // The decoder of the gltf crate pads to whole words; what it adds is no data.
    let length = payload.trim_end_matches('=').len() * 3 / 4;
    let padded = gltf::buffer::Data::from_source(gltf::buffer::Source::Uri(uri), None)
        .map_err(|error| format!("'{}': broken base64: {error}", label(uri)))?;
    let mut data = padded.0;
    data.truncate(length);
    Ok(data)
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
