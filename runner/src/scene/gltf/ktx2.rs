//! KTX2 textures of Basis Universal (KHR_texture_basisu): ETC1S and UASTC -> RGBA8.

use super::Reason;
use basisu::{DecodeFlags, SourceFormat, TargetFormat, Transcoder};
use std::panic::catch_unwind;

/// What a KTX2 file begins with (KTX 2.0, 3.1).
pub const MAGIC: &[u8] = b"\xabKTX 20\xbb\r\n\x1a\n";
/// Bytes of the header, the index and the first level's place.
pub const HEADER: usize = 80 + 24;
/// Bytes of a block of 4 x 4 texels in UASTC.
const BLOCK: u64 = 16;

fn number(bytes: &[u8], at: usize) -> Reason<u64> {
    let word = |at: usize| bytes.get(at..at + 8)?.try_into().ok().map(u64::from_le_bytes);
    word(at).ok_or_else(|| "KTX2 cut short".into())
}

/// Width and height, texels. `bytes` has at least the [`HEADER`].
pub fn size(bytes: &[u8]) -> Reason<(u32, u32)> {
    let size = number(bytes, 20)?;
    match (size as u32, (size >> 32) as u32) {
        (width, height) if width > 0 && height > 0 => Ok((width, height)),
        (width, height) => Err(format!("KTX2 of {width} x {height} texels")),
    }
}

/// The finest level, rows from the top. Errors: other codecs than the extension has, broken streams.
pub fn decode(bytes: &[u8]) -> Reason<Vec<u8>> {
    let (width, height) = size(bytes)?;
    let blocks = u64::from(width.div_ceil(4)) * u64::from(height.div_ceil(4));
    let [offset, length, uncompressed] = [number(bytes, 80)?, number(bytes, 88)?, number(bytes, 96)?];
    if offset.checked_add(length).is_none_or(|end| end > bytes.len() as u64) {
        return Err("KTX2 cut short".into());
    }
    // Faces and layers are none in this extension, so this is all that a level has.
    if uncompressed > BLOCK * blocks {
        return Err(format!("KTX2 level of {uncompressed} bytes for {width} x {height} texels"));
    }
    // A fault of the decoder's must not cost the scene.
    catch_unwind(|| transcode(bytes)).unwrap_or_else(|_| Err("broken KTX2".into()))
}

fn transcode(bytes: &[u8]) -> Reason<Vec<u8>> {
    let other = "KTX2 that is neither ETC1S nor UASTC, as KHR_texture_basisu requires";
    let texture = Transcoder::new(bytes).map_err(|_| other.to_owned())?;
    if !matches!(texture.source_format(), SourceFormat::Etc1s | SourceFormat::UastcLdr) {
        return Err(other.into());
    }
    texture
        .transcode(0, TargetFormat::Rgba32, DecodeFlags::NONE)
        .map_err(|error| format!("broken KTX2: {error:?}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec2;
    use shared::rng::{Rng, Stream};

    /// Patterns of 18 x 10 texels, encoded by Binomial's basisu 1.16.3, and the PNG that the same program made of each (UASTC
    /// through ASTC, ETC1S through ETC1; neither step loses anything).
    const FILES: [(&str, &[u8], &[u8]); 2] = [
        ("UASTC, Zstandard", include_bytes!("tests/ktx2/uastc.ktx2"), include_bytes!("tests/ktx2/uastc.png")),
        ("ETC1S", include_bytes!("tests/ktx2/etc1s.ktx2"), include_bytes!("tests/ktx2/etc1s.png")),
    ];

    #[test]
    fn texels_are_those_of_the_encoder() {
        for (name, file, expected) in FILES {
            let expected = image::load_from_memory(expected).unwrap().into_rgba8();
            assert_eq!(size(file).unwrap(), expected.dimensions());
            assert_eq!(decode(file).unwrap(), expected.into_raw(), "{name}");
        }
    }

    #[test]
    fn hostile_headers_are_one_line() {
        let file = FILES[0].1;
        let with = |at: usize, value: u64| {
            let mut broken = file.to_vec();
            broken[at..at + 8].copy_from_slice(&value.to_le_bytes());
            decode(&broken).unwrap_err()
        };
        for (at, value, words) in [
            (12, 37 + (1 << 32), "neither ETC1S nor UASTC"),
            (20, 18, "KTX2 of 18 x 0 texels"),
            (80, u64::MAX - 8, "cut short"),
            (96, 1 << 60, "KTX2 level of"),
            (96, 100, "broken KTX2"),
        ] {
            let error = with(at, value);
            assert!(error.contains(words) && error.lines().count() == 1, "{value} at {at}: {error}");
        }
    }

    /// Texels or an error, whatever the bytes are.
    #[test]
    fn flipped_bits_are_survived() {
        let mut rng = Rng::new(UVec2::new(8, 8), 0, 0, Stream::Initial, 0);
        for (name, file, _) in FILES {
            let mut failed = 0;
            for i in 0..4000 {
                let mut broken = file.to_vec();
                for word in rng.next_u32x4().to_array() {
                    // One byte in four flips of them lies in the header; the size stays.
                    let at = (word >> 3) as usize % broken.len();
                    if !(20..28).contains(&at) {
                        broken[at] ^= 1 << (word & 7);
                    }
                }
                broken.truncate(broken.len() - i % 3);
                match decode(&broken) {
                    Ok(texels) => assert_eq!(texels.len(), 18 * 10 * 4),
                    Err(_) => failed += 1,
                }
            }
            assert!((1..4000).contains(&failed), "{name}: {failed}");
        }
    }
}
