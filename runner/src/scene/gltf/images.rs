//! Images: files, data URIs and buffer views -> RGBA8 texels.

use super::uri::Content;
use super::{Reason, accessors, ktx2, label, one_line, uri};
use crate::scene::Image;
use crate::{files, parallel};
use gltf::Document;
use image::{ImageFormat, ImageReader, Limits};
use std::borrow::Cow;
use std::collections::{BTreeSet, HashMap};
use std::fs::File;
use std::io::{BufRead, BufReader, Cursor, Read, Seek};
use std::path::Path;
use std::sync::Arc;

/// Largest width and height, px: what Vulkan devices of this class take (maxImageDimension2D).
const MAX_SIDE: u32 = 16384;

/// Most texels of all images of a scene: 8 GiB once they are decoded. A file of some kB can name more.
const MAX_TEXELS: u64 = 1 << 31;

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

/// How texels are encoded. The content tells, not the name.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Format {
    /// PNG, JPEG (glTF 2.0) or WebP (EXT_texture_webp).
    Common(ImageFormat),
    /// KHR_texture_basisu
    Ktx2,
}

/// Where an image's bytes are: images that name the same ones are one image.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Source<'a> {
    Uri(&'a str),
    View(usize),
    Nowhere,
}

impl<'a> Source<'a> {
    fn of(document: &'a Document, index: usize) -> Self {
        // Not by `source()`: it takes for granted that one of the two is there.
        let json = &document.as_json().images[index];
        match (&json.uri, json.buffer_view) {
            (Some(uri), _) => Source::Uri(uri),
            (None, Some(view)) => Source::View(view.value()),
            (None, None) => Source::Nowhere,
        }
    }
}

/// An image that has been looked at.
struct Found<'a> {
    name: String,
    content: Content<'a>,
    format: Format,
    width: u32,
    height: u32,
}

/// Extensions that give a texture another image than core glTF's, which is then there for those that don't know them.
const OTHER_SOURCES: [&str; 2] = ["KHR_texture_basisu", "EXT_texture_webp"];

/// Index of the image that a texture shows; none if it has none.
pub fn of(texture: &gltf::Texture) -> Option<usize> {
    let other = |name: &&str| texture.extension_value(name)?.get("source")?.as_u64()?.try_into().ok();
    OTHER_SOURCES.iter().find_map(other).or_else(|| Some(texture.source()?.index()))
}

/// Loads the images that `used` names, on all cores (decoding takes most of a scene's loading time). Error: more texels
/// than [`MAX_TEXELS`], before any is decoded.
pub fn load(document: &Document, used: &BTreeSet<usize>, base: &Path, buffers: &[Vec<u8>]) -> Reason<Images> {
    let mut unique: Vec<(Source, usize)> = Vec::new();
    let mut known: HashMap<Source, usize> = HashMap::new();
    // Extensions name what they like.
    let used = || used.iter().copied().filter(|&index| index < document.images().len());
    for index in used() {
        let source = Source::of(document, index);
        known.entry(source).or_insert_with(|| {
            unique.push((source, index));
            unique.len() - 1
        });
    }
    let found = parallel::map(&unique, |&(source, index)| find(document, source, index, base, buffers));
    let texels: u64 = found.iter().flatten().map(|it| u64::from(it.width) * u64::from(it.height)).sum();
    if texels > MAX_TEXELS {
        return Err(format!(
            "its images have {texels} texels; {MAX_TEXELS} (8 GiB) is the most: scale them down"
        ));
    }
    let images = parallel::map(&found, |found| match found {
        Ok(found) => found.decode().map(Arc::new),
        Err(fault) => Err(fault.clone()),
    });
    Ok(used().map(|index| (index, images[known[&Source::of(document, index)]].clone())).collect())
}

/// Looks at an image's size, and no further.
fn find<'b>(
    document: &Document,
    source: Source,
    index: usize,
    base: &Path,
    buffers: &'b [Vec<u8>],
) -> Result<Found<'b>, Fault> {
    let of_view = |view: usize| {
        let view = document.views().nth(view).ok_or(format!("buffer view {view} does not exist"))?;
        Ok(Content::Bytes(Cow::Borrowed(accessors::bytes_of(&view, buffers)?)))
    };
    let image = document.images().nth(index);
    let name = image.and_then(|image| image.name()).filter(|name| !name.is_empty());
    let (content, file) = match source {
        Source::Uri(uri) => (uri::find(uri, base), uri::label(uri)),
        Source::View(view) => (of_view(view), label("image", index, name)),
        Source::Nowhere => (Err("neither a uri nor a buffer view".into()), String::new()),
    };
    let content = content.map_err(Fault::Missing)?;
    let (format, width, height) = match &content {
        Content::Bytes(bytes) => look(Cursor::new(bytes))?,
        Content::File(path) => {
            let opened = files::size(path).and_then(|_| File::open(path));
            let file = opened.map_err(|e| missing(&format!("can't read '{}': {e}", path.display())))?;
            look(BufReader::new(file))?
        }
    };
    if width.max(height) > MAX_SIDE {
        return Err(Fault::TooLarge(format!("{width} x {height} px; {MAX_SIDE} on a side is the most")));
    }
    let name = name.map_or(file, str::to_owned);
    Ok(Found { name, content, format, width, height })
}

/// Format, width and height.
fn look(mut source: impl BufRead + Seek) -> Result<(Format, u32, u32), Fault> {
    let mut head = Vec::new();
    let read = source.by_ref().take(ktx2::HEADER as u64).read_to_end(&mut head);
    read.and_then(|_| source.rewind()).map_err(|e| missing(&e))?;
    if head.starts_with(ktx2::MAGIC) {
        let (width, height) = ktx2::size(&head).map_err(|e| broken(&e))?;
        return Ok((Format::Ktx2, width, height));
    }
    let reader = ImageReader::new(source).with_guessed_format().map_err(|e| broken(&e))?;
    // The other formats that the program can write have no place here.
    let Some(format @ (ImageFormat::Png | ImageFormat::Jpeg | ImageFormat::WebP)) = reader.format() else {
        return Err(broken(&"neither PNG, JPEG, WebP nor KTX2"));
    };
    let (width, height) = reader.into_dimensions().map_err(|e| broken(&e))?;
    Ok((Format::Common(format), width, height))
}

impl Found<'_> {
    fn decode(&self) -> Result<Image, Fault> {
        let bytes = match &self.content {
            Content::Bytes(bytes) => Cow::Borrowed(&**bytes),
            Content::File(path) => files::bytes(path).map_err(|e| missing(&e))?.into(),
        };
        let texels = match self.format {
            Format::Ktx2 => ktx2::decode(&bytes).map_err(|e| broken(&e))?,
            Format::Common(format) => {
                let mut decoder = ImageReader::with_format(Cursor::new(&bytes), format);
                let mut limits = Limits::default();
                // 16 bits a channel at the largest size.
                limits.max_alloc = Some(u64::from(MAX_SIDE) * u64::from(MAX_SIDE) * 8);
                decoder.limits(limits);
                decoder.decode().map_err(|e| broken(&e))?.into_rgba8().into_raw()
            }
        };
        let &Found { width, height, .. } = self;
        if texels.len() as u64 != 4 * u64::from(width) * u64::from(height) {
            return Err(broken(&"it changes its size"));
        }
        Ok(Image { name: self.name.clone(), width, height, texels })
    }
}

fn missing(reason: &dyn std::fmt::Display) -> Fault {
    Fault::Missing(one_line(&reason.to_string()))
}

fn broken(reason: &dyn std::fmt::Display) -> Fault {
    missing(&format!("can't decode it: {reason}"))
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

    fn decode(name: String, bytes: &[u8]) -> Result<Image, Fault> {
        let (format, width, height) = look(Cursor::new(bytes))?;
        let content = Content::Bytes(bytes.into());
        Found { name, content, format, width, height }.decode()
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
            assert!(reason.contains("neither PNG, JPEG, WebP nor KTX2"), "{reason}");
        }
        let whole = png(2, 1, &[1, 2, 3, 4, 5, 6]);
        assert!(matches!(decode("x".into(), &whole[..whole.len() - 20]), Err(Fault::Missing(_))));
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
