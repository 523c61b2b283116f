//! Images: files, data URIs and buffer views -> RGBA8 texels.

use super::{Reason, accessors, label, one_line, uri};
use crate::parallel;
use crate::scene::Image;
use gltf::Document;
use image::{ImageFormat, ImageReader, Limits};
use std::collections::{BTreeSet, HashMap};
use std::io::Cursor;
use std::path::Path;
use std::sync::Arc;

/// Largest width and height, px: what Vulkan devices of this class take (maxImageDimension2D).
const MAX_SIDE: u32 = 16384;

/// Why there is no image.
#[derive(Clone, Debug, PartialEq)]
pub enum Fault {
    /// Missing or broken: drawn with a stand-in.
    Missing(String),
    /// Can't be drawn on any device.
    TooLarge(String),
}

/// Images by their index in the document.
pub type Images = HashMap<usize, Result<Arc<Image>, Fault>>;

/// Loads the images that `used` names, on all cores (decoding takes most of a scene's loading time).
pub fn load(document: &Document, used: &BTreeSet<usize>, base: &Path, buffers: &[Vec<u8>]) -> Images {
    let sources: Vec<gltf::Image> = document.images().filter(|image| used.contains(&image.index())).collect();
    let images = parallel::map(&sources, |source| load_one(document, source, base, buffers).map(Arc::new));
    sources.iter().map(gltf::Image::index).zip(images).collect()
}

fn load_one(
    document: &Document,
    source: &gltf::Image,
    base: &Path,
    buffers: &[Vec<u8>],
) -> Result<Image, Fault> {
    let (bytes, file) = read(document, source, base, buffers).map_err(Fault::Missing)?;
    let name = source.name().filter(|name| !name.is_empty()).map(str::to_owned).unwrap_or(file);
    decode(name, &bytes)
}

/// The encoded bytes, and what to call them.
fn read(
    document: &Document,
    source: &gltf::Image,
    base: &Path,
    buffers: &[Vec<u8>],
) -> Reason<(Vec<u8>, String)> {
    // Not by `source.source()`: it takes for granted that one of the two is there.
    let json = &document.as_json().images[source.index()];
    if let Some(uri) = &json.uri {
        return Ok((uri::read(uri, base)?, uri::label(uri)));
    }
    let view = json.buffer_view.and_then(|view| document.views().nth(view.value()));
    let view = view.ok_or("neither a uri nor a buffer view")?;
    Ok((accessors::bytes_of(&view, buffers)?.to_vec(), label("image", source.index(), source.name())))
}

/// Decodes PNG, JPEG (glTF 2.0) or WebP (EXT_texture_webp); the content decides which, not the name.
fn decode(name: String, bytes: &[u8]) -> Result<Image, Fault> {
    let missing =
        |error: &dyn std::fmt::Display| Fault::Missing(one_line(&format!("can't decode it: {error}")));
    let reader = || ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|e| missing(&e));
    // The other formats that the program can write have no place here.
    if !matches!(reader()?.format(), Some(ImageFormat::Png | ImageFormat::Jpeg | ImageFormat::WebP)) {
        return Err(missing(&"neither PNG, JPEG nor WebP"));
    }
    let (width, height) = reader()?.into_dimensions().map_err(|e| missing(&e))?;
    if width.max(height) > MAX_SIDE {
        return Err(Fault::TooLarge(format!("{width} x {height} px; {MAX_SIDE} on a side is the most")));
    }
    let mut decoder = reader()?;
    let mut limits = Limits::default();
    // 16 bits a channel at the largest size.
    limits.max_alloc = Some(u64::from(MAX_SIDE) * u64::from(MAX_SIDE) * 8);
    decoder.limits(limits);
    let texels = decoder.decode().map_err(|e| missing(&e))?.into_rgba8().into_raw();
    Ok(Image { name, width, height, texels })
}

/// One texel that stands for a missing image.
pub fn stand_in(name: &str, texel: [u8; 4]) -> Arc<Image> {
    Arc::new(Image { name: name.to_owned(), width: 1, height: 1, texels: texel.to_vec() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec2;
    use shared::rng::{Rng, Stream};

    fn encoded(format: ImageFormat, width: u32, height: u32, texels: &[u8]) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        image::write_buffer_with_format(&mut bytes, texels, width, height, image::ColorType::Rgb8, format)
            .unwrap();
        bytes.into_inner()
    }

    fn png(width: u32, height: u32, texels: &[u8]) -> Vec<u8> {
        encoded(ImageFormat::Png, width, height, texels)
    }

    #[test]
    fn texels_become_rgba() {
        let image = decode("x".into(), &png(2, 1, &[1, 2, 3, 4, 5, 6])).unwrap();
        assert_eq!((image.width, image.height), (2, 1));
        assert_eq!(image.texels, [1, 2, 3, 255, 4, 5, 6, 255]);
    }

    #[test]
    fn bad_images_are_faults() {
        // Nothing; a Radiance file, which the image crate could read.
        for other in [&b"no image"[..], b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n\x80\x80\x80\x80"]
        {
            let Err(Fault::Missing(reason)) = decode("x".into(), other) else { panic!("{other:?}") };
            assert!(reason.contains("neither PNG, JPEG nor WebP"), "{reason}");
        }
        let whole = png(2, 1, &[1, 2, 3, 4, 5, 6]);
        assert!(matches!(decode("x".into(), &whole[..whole.len() - 20]), Err(Fault::Missing(_))));
        let wide = png(MAX_SIDE + 1, 1, &vec![0; 3 * (MAX_SIDE as usize + 1)]);
        let expected = "16385 x 1 px; 16384 on a side is the most".to_owned();
        assert_eq!(decode("x".into(), &wide).unwrap_err(), Fault::TooLarge(expected));
    }

    /// A panic in a decoder would fail the test.
    #[test]
    fn flipped_bits_do_not_panic() {
        let texels: Vec<u8> = (0..12 * 10 * 3).map(|i| (i * 37 % 251) as u8).collect();
        let mut rng = Rng::new(UVec2::new(8, 8), 0, 0, Stream::Initial, 0);
        for format in [ImageFormat::Png, ImageFormat::Jpeg, ImageFormat::WebP] {
            let whole = encoded(format, 12, 10, &texels);
            let mut decoded = 0;
            for _ in 0..500 {
                let mut broken = whole.clone();
                for word in rng.next_u32x4().to_array() {
                    let i = (word >> 3) as usize % broken.len();
                    broken[i] ^= 1 << (word & 7);
                }
                if let Ok(image) = decode("x".into(), &broken) {
                    assert_eq!(image.texels.len(), image.width as usize * image.height as usize * 4);
                    decoded += 1;
                }
            }
            assert!(decode("x".into(), &whole).is_ok() && decoded < 500, "{format:?}: {decoded} of 500");
        }
    }
}
