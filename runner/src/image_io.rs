//! Writing pictures: whole or not at all.

use crate::error::{Error, Result};
use crate::files;
use exr::image::read::image::ReadLayers;
use exr::image::read::layers::ReadChannels;
use exr::image::write::WritableImage;
use exr::image::{AnyChannel, AnyChannels, Encoding, FlatSamples, Layer};
use exr::meta::header::LayerAttributes;
use glam::{UVec2, Vec3};
use image::{ImageFormat, ImageReader, Rgb, Rgb32FImage, RgbaImage};
use shared::tonemap;
use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

/// A file format a picture can be written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureFormat {
    /// 8 bits, tone mapped.
    Png,
    /// 32-bit float radiance, nit, linear Rec. 709.
    Exr,
}

/// The format that `path` ends in.
pub fn format_of(path: &Path) -> Result<PictureFormat> {
    match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
        Some("png") => Ok(PictureFormat::Png),
        Some("exr") => Ok(PictureFormat::Exr),
        _ => Err(Error::Usage(format!("{}: pictures are written as .png or .exr", path.display()))),
    }
}

/// Checks, before any work is done, that a picture can be written to `path`.
pub fn check_writable(path: &Path) -> Result<PictureFormat> {
    let format = format_of(path)?;
    let directory = path.parent().filter(|d| !d.as_os_str().is_empty()).unwrap_or(Path::new("."));
    create_folder(directory)?;
    check_file(path)?;
    Ok(format)
}

/// The same for files in `directory`, which is created.
pub fn check_folder(directory: &Path) -> Result<()> {
    create_folder(directory)?;
    check_file(&directory.join("results"))
}

/// With the folders above it.
pub fn create_folder(directory: &Path) -> Result<()> {
    std::fs::create_dir_all(directory).map_err(Error::write(directory))
}

fn check_file(path: &Path) -> Result<()> {
    let partial = partial(path);
    std::fs::write(&partial, []).and_then(|()| std::fs::remove_file(&partial)).map_err(Error::write(path))
}

/// Writes display values (RGBA8, red lowest, rows from the top).
pub fn write_png(path: &Path, size: UVec2, display: &[u32]) -> Result<()> {
    replace(path, &encode_png(size, display)?)
}

/// Writes radiance (nit, linear RGB, rows from the top) as a display shows it. `exposure`: factor to display values.
pub fn write_tone_mapped(path: &Path, size: UVec2, radiance: &[Vec3], exposure: f32) -> Result<()> {
    replace(path, &encode_tone_mapped(size, radiance, exposure)?)
}

/// A PNG file of radiance as a display shows it.
pub fn encode_tone_mapped(size: UVec2, radiance: &[Vec3], exposure: f32) -> Result<Vec<u8>> {
    let pixel = |&radiance: &Vec3| tonemap::pack_rgba8(tonemap::display(radiance, exposure));
    encode_png(size, &radiance.iter().map(pixel).collect::<Vec<u32>>())
}

/// A PNG file of display values.
pub fn encode_png(size: UVec2, display: &[u32]) -> Result<Vec<u8>> {
    let bytes = bytemuck::cast_slice(display).to_vec();
    let picture = RgbaImage::from_raw(size.x, size.y, bytes)
        .ok_or_else(|| Error::Internal("the picture's size does not match its pixels".into()))?;
    // Opaque: viewers need no alpha.
    let picture = image::DynamicImage::ImageRgba8(picture).into_rgb8();
    let mut encoded = Cursor::new(Vec::new());
    picture.write_to(&mut encoded, ImageFormat::Png).map_err(not_encoded)?;
    Ok(encoded.into_inner())
}

fn not_encoded(error: impl std::fmt::Display) -> Error {
    Error::Internal(format!("can't encode a picture: {error}"))
}

/// Writes radiance (nit, linear RGB, rows from the top).
///
/// ```
/// use candela::image_io::{read_exr, write_exr};
/// use candela::shared::glam::{UVec2, Vec3};
///
/// let (size, radiance) = (UVec2::new(2, 1), [Vec3::X, 1_000.0 * Vec3::ONE]);
/// let path = std::env::temp_dir().join("candela-write-exr.exr");
/// write_exr(&path, size, &radiance)?;
/// assert_eq!(read_exr(&path)?, (size, radiance.to_vec()));
/// # std::fs::remove_file(path).ok();
/// # Ok::<(), candela::error::Error>(())
/// ```
pub fn write_exr(path: &Path, size: UVec2, radiance: &[Vec3]) -> Result<()> {
    replace(path, &encode_exr(size, radiance)?)
}

/// An EXR file of radiance.
pub fn encode_exr(size: UVec2, radiance: &[Vec3]) -> Result<Vec<u8>> {
    let picture =
        Rgb32FImage::from_fn(size.x, size.y, |x, y| Rgb(radiance[(y * size.x + x) as usize].to_array()));
    let mut encoded = Cursor::new(Vec::new());
    picture.write_to(&mut encoded, ImageFormat::OpenExr).map_err(not_encoded)?;
    Ok(encoded.into_inner())
}

/// A number of each pixel, rows from the top: `R`, or `albedo.R` of a layer.
pub struct Channel(AnyChannel<FlatSamples>);

impl Channel {
    /// One value a pixel, rows from the top.
    pub fn new(name: &str, values: Vec<f32>) -> Self {
        Channel(AnyChannel::new(name, FlatSamples::F32(values)))
    }
}

/// An EXR file of channels. Who knows no layers finds R, G and B in it.
pub fn encode_channels(size: UVec2, channels: Vec<Channel>) -> Result<Vec<u8>> {
    let channels = AnyChannels::sort(channels.into_iter().map(|channel| channel.0).collect());
    let size = (size.x as usize, size.y as usize);
    let layer = Layer::new(size, LayerAttributes::default(), Encoding::SMALL_LOSSLESS, channels);
    let mut encoded = Cursor::new(Vec::new());
    let written = exr::image::Image::from_layer(layer).write().non_parallel().to_buffered(&mut encoded);
    written.map_err(not_encoded)?;
    Ok(encoded.into_inner())
}

/// The channels of an EXR file, by name.
pub struct Layers {
    /// Pixels.
    pub size: UVec2,
    /// One value a pixel, rows from the top.
    channels: BTreeMap<String, Vec<f32>>,
}

impl Layers {
    /// Three channels as vectors; none if one of them is missing.
    pub fn colors(&self, names: [&str; 3]) -> Option<Vec<Vec3>> {
        let [r, g, b] = names.map(|name| self.channels.get(name));
        let (r, g, b) = (r?, g?, b?);
        Some(r.iter().zip(g).zip(b).map(|((r, g), b)| Vec3::new(*r, *g, *b)).collect())
    }
}

/// Reads the channels of an EXR file, those of layers too.
pub fn read_layers(path: &Path) -> Result<Layers> {
    let bytes = files::read(path)?;
    let read = exr::image::read::read().no_deep_data().largest_resolution_level().all_channels();
    let read = read.first_valid_layer().all_attributes().non_parallel();
    let layer = read.from_buffered(Cursor::new(bytes)).map_err(Error::input(path))?.layer_data;
    let size = UVec2::new(layer.size.0 as u32, layer.size.1 as u32);
    let channels = layer.channel_data.list.into_iter();
    let values = |samples: FlatSamples| samples.values_as_f32().collect();
    let channels = channels.map(|c| (c.name.to_string(), values(c.sample_data))).collect();
    Ok(Layers { size, channels })
}

/// Reads an EXR file back: size and radiance.
pub fn read_exr(path: &Path) -> Result<(UVec2, Vec<Vec3>)> {
    let bytes = files::read(path)?;
    let reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format();
    let picture = reader.map_err(|e| undecodable(path, e.into()))?.decode();
    let picture = picture.map_err(|e| undecodable(path, e))?.into_rgb32f();
    let size = UVec2::new(picture.width(), picture.height());
    Ok((size, picture.pixels().map(|p| Vec3::from_array(p.0)).collect()))
}

fn undecodable(path: &Path, error: image::ImageError) -> Error {
    match error {
        image::ImageError::IoError(error) => Error::read(path)(error),
        broken => Error::input(path)(broken),
    }
}

/// Where a file is written before it has its name; jobs on several machines may write the same file.
fn partial(path: &Path) -> PathBuf {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |d| d.as_nanos());
    let mut name = path.as_os_str().to_owned();
    name.push(format!(".{:x}-{now:x}.partial", std::process::id()));
    name.into()
}

/// Writes beside and renames, so that a reader never sees half a picture.
pub fn replace(path: &Path, bytes: &[u8]) -> Result<()> {
    let partial = partial(path);
    let written = std::fs::write(&partial, bytes).and_then(|()| std::fs::rename(&partial, path));
    written.map_err(|source| {
        // Half a file is no use to anyone.
        let _ = std::fs::remove_file(&partial);
        Error::write(path)(source)
    })
}

/// A JPEG of `color` (display values, 0..=1) over `size` pixels.
pub fn jpeg(size: UVec2, color: impl Fn(u32, u32) -> Vec3) -> Result<Vec<u8>> {
    let picture = image::RgbImage::from_fn(size.x, size.y, |x, y| {
        Rgb((color(x, y).clamp(Vec3::ZERO, Vec3::ONE) * 255.0 + 0.5).to_array().map(|c| c as u8))
    });
    let mut encoded = Vec::new();
    image::codecs::jpeg::JpegEncoder::new_with_quality(&mut encoded, 90)
        .encode_image(&picture)
        .map_err(not_encoded)?;
    Ok(encoded)
}
