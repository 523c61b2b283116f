//! The container: the bytes of a .gltf or .glb file -> its JSON and its binary chunk.

use super::Reason;
use serde_json::Value;

const JSON: u32 = u32::from_le_bytes(*b"JSON");
const BIN: u32 = u32::from_le_bytes(*b"BIN\0");

/// The JSON of a file of version 2, and the binary chunk that may follow it.
/// Errors: no glTF, another version, broken JSON.
pub fn open(bytes: &[u8]) -> Reason<(Value, Option<&[u8]>)> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let (text, chunk) = match bytes.strip_prefix(b"glTF") {
        Some(rest) => chunks(rest)?,
        None if bytes.trim_ascii_start().starts_with(b"{") => (bytes, None),
        None => return Err("not glTF: neither JSON nor binary glTF (wrong magic)".into()),
    };
    // Some exporters pad with zeros instead of spaces, and some write names in an encoding of their own.
    let text = String::from_utf8_lossy(text);
    let json: Value =
        serde_json::from_str(text.trim_end_matches('\0')).map_err(|error| format!("broken JSON: {error}"))?;
    check_version(&json)?;
    Ok((json, chunk))
}

/// `rest` follows the magic. A binary chunk that is cut short is what there is of it.
fn chunks(rest: &[u8]) -> Reason<(&[u8], Option<&[u8]>)> {
    let word = |at: usize| {
        rest.get(at..at + 4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])).ok_or("cut short")
    };
    let broken = |reason: &str| format!("binary glTF with a broken header: {reason}");
    match word(0).map_err(broken)? {
        2 => {}
        version => return Err(only_version_2(&format!("{version}"))),
    }
    let (mut at, mut text, mut chunk) = (8, None, None);
    while let (Ok(length), Ok(kind)) = (word(at), word(at + 4)) {
        let start = at + 8;
        let end = start.saturating_add(length as usize);
        match kind {
            JSON if text.is_none() => {
                text = Some(rest.get(start..end).ok_or_else(|| broken("its JSON is cut short"))?);
            }
            BIN if chunk.is_none() => chunk = Some(&rest[start..end.min(rest.len())]),
            _ => {}
        }
        at = end;
    }
    Ok((text.ok_or_else(|| broken("it has no JSON"))?, chunk))
}

fn check_version(json: &Value) -> Reason<()> {
    let text = |name: &str| match json.get("asset")?.get(name)? {
        Value::String(version) => Some(version.clone()),
        Value::Number(version) => Some(version.to_string()),
        _ => None,
    };
    // Lists of things were objects before version 2.
    let old = || json.get("meshes").is_some_and(Value::is_object).then(|| "1.0".to_owned());
    let version = text("minVersion").or_else(|| text("version")).or_else(old);
    match version {
        Some(version) if version == "2.0" || version == "2" => Ok(()),
        // Minor versions stay readable, unless `minVersion` says otherwise.
        Some(version) if version.starts_with("2.") && text("minVersion").is_none() => Ok(()),
        Some(version) => Err(only_version_2(&version)),
        None => Err("not glTF: JSON without the version of an asset".into()),
    }
}

fn only_version_2(version: &str) -> String {
    format!("glTF version {version}; only 2.0 can be read: convert the file, or export it again")
}
