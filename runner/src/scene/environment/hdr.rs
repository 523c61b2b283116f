//! Radiance pictures (.hdr, .pic) as they are found: any magic word (`#?RADIANCE`, `#?RGBE`), all eight orientations, and
//! EXPOSURE and COLORCORR, which their values have to be divided by (Ward 1994, "The RADIANCE picture file format").
//! The scanlines themselves are read by the image crate, which knows one header.

use glam::{UVec2, Vec3};
use image::{ImageFormat, ImageReader};
use std::io::Cursor;

/// Bytes of a header, at most.
const MAX_HEADER: usize = 1 << 16;

/// How a picture's values lie in its file.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// Width and height, px.
    pub size: UVec2,
    /// What the values were multiplied by.
    exposure: Vec3,
    /// Scanlines are columns.
    columns: bool,
    /// x grows, and y falls, in the order of the file.
    along: [bool; 2],
    /// Bytes before the scanlines.
    length: usize,
}

pub fn is_radiance(bytes: &[u8]) -> bool {
    bytes.starts_with(b"#?")
}

impl Header {
    /// Errors: no end, a format that is not RGBE, no size.
    pub fn read(bytes: &[u8]) -> Result<Header, String> {
        let mut exposure = Vec3::ONE;
        let mut place = 0;
        let mut line = || {
            let rest = &bytes[place..bytes.len().min(MAX_HEADER)];
            let end = rest.iter().position(|&b| b == b'\n').ok_or("its header has no end")?;
            place += end + 1;
            Ok::<_, String>((String::from_utf8_lossy(&rest[..end]).trim().to_owned(), place))
        };
        loop {
            let (text, _) = line()?;
            let Some((name, value)) = text.split_once('=') else {
                // Comments, and the commands that made the picture.
                if text.is_empty() { break } else { continue }
            };
            let numbers: Vec<f32> = value.split_whitespace().filter_map(|word| word.parse().ok()).collect();
            match (name.trim(), &numbers[..]) {
                ("FORMAT", _) if value.trim() != "32-bit_rle_rgbe" => {
                    return Err(format!("FORMAT={}; 32-bit_rle_rgbe can be read", value.trim()));
                }
                ("EXPOSURE", &[e]) => exposure *= e,
                ("COLORCORR", &[r, g, b]) => exposure *= Vec3::new(r, g, b),
                _ => {}
            }
        }
        if !(exposure.is_finite() && exposure.min_element() > 0.0) {
            return Err(format!("its exposure is {exposure}"));
        }
        let (text, length) = line()?;
        let words: Vec<&str> = text.split_whitespace().collect();
        let axis = |word| str::strip_prefix(word, ['+', '-']);
        let side = |word: &str| word.parse().ok().filter(|&n: &u32| n > 0);
        if let &[first, scanlines, second, pixels] = &words[..]
            && let (Some(scanlines), Some(pixels)) = (side(scanlines), side(pixels))
        {
            let (x, y, size, columns) = match (axis(first), axis(second)) {
                (Some("Y"), Some("X")) => (second, first, UVec2::new(pixels, scanlines), false),
                (Some("X"), Some("Y")) => (first, second, UVec2::new(scanlines, pixels), true),
                _ => return Err(format!("its size is '{text}'")),
            };
            return Ok(Header { size, exposure, columns, along: [x == "+X", y == "-Y"], length });
        }
        Err(format!("its size is '{text}'"))
    }

    /// Radiance of each pixel, rows from the top. `bytes`: of the file that the header was read from.
    pub fn decode(&self, bytes: &[u8]) -> Result<Vec<Vec3>, String> {
        let UVec2 { x: width, y: height } = self.size;
        let (scanlines, pixels) = if self.columns { (width, height) } else { (height, width) };
        let header = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {scanlines} +X {pixels}\n");
        let usual = [header.as_bytes(), &bytes[self.length..]].concat();
        let mut reader = ImageReader::with_format(Cursor::new(usual), ImageFormat::Hdr);
        reader.no_limits();
        let picture = reader.decode().map_err(|error| error.to_string())?.into_rgb32f();
        let value = |i: u32| {
            let (x, y) = (i % width, i / width);
            let x = if self.along[0] { x } else { width - 1 - x };
            let y = if self.along[1] { y } else { height - 1 - y };
            let place = if self.columns { (y, x) } else { (x, y) };
            Vec3::from_array(picture.get_pixel(place.0, place.1).0) / self.exposure
        };
        Ok((0..width * height).map(value).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A 3 x 2 picture whose value is 1 + x + 3 y from its upper left corner, written the way `size` says.
    fn picture(lines: &str, size: &str, pixels: [u8; 6]) -> Vec<u8> {
        let mut bytes = format!("#?RGBE\n{lines}FORMAT=32-bit_rle_rgbe\n\n{size}\n").into_bytes();
        // Mantissa 32 n, exponent 8: n.
        pixels.iter().for_each(|n| bytes.extend([32 * n, 32 * n, 32 * n, 131]));
        bytes
    }

    #[test]
    fn eight_orientations_are_one_picture() {
        for (size, pixels) in [
            ("-Y 2 +X 3", [1, 2, 3, 4, 5, 6]),
            ("+Y 2 +X 3", [4, 5, 6, 1, 2, 3]),
            ("-Y 2 -X 3", [3, 2, 1, 6, 5, 4]),
            ("+Y 2 -X 3", [6, 5, 4, 3, 2, 1]),
            ("+X 3 -Y 2", [1, 4, 2, 5, 3, 6]),
            ("+X 3 +Y 2", [4, 1, 5, 2, 6, 3]),
            ("-X 3 -Y 2", [3, 6, 2, 5, 1, 4]),
            ("-X 3 +Y 2", [6, 3, 5, 2, 4, 1]),
        ] {
            let bytes = picture("", size, pixels);
            let header = Header::read(&bytes).unwrap();
            assert_eq!(header.size, UVec2::new(3, 2), "{size}");
            let expected: Vec<Vec3> = (1..=6).map(|n| Vec3::splat(n as f32)).collect();
            assert_eq!(header.decode(&bytes).unwrap(), expected, "{size}");
        }
    }

    #[test]
    fn exposures_multiply_and_are_taken_out() {
        let lines = "# made by hand\npfilt -1\nEXPOSURE=2\nEXPOSURE= 4\nCOLORCORR=1 2 4\n";
        let bytes = picture(lines, "-Y 2 +X 3", [1, 2, 3, 4, 5, 6]);
        let radiance = Header::read(&bytes).unwrap().decode(&bytes).unwrap();
        assert_eq!(radiance[5], Vec3::new(6.0 / 8.0, 6.0 / 16.0, 6.0 / 32.0));
    }

    #[test]
    fn broken_headers_say_what_is_wrong() {
        for (text, words) in [
            ("#?RGBE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n", "xyze"),
            ("#?RGBE\nEXPOSURE=0\n\n-Y 1 +X 1\n", "exposure"),
            ("#?RGBE\nEXPOSURE=nan\n\n-Y 1 +X 1\n", "exposure"),
            ("#?RGBE\n\n-Y 1 +Z 1\n", "-Y 1 +Z 1"),
            ("#?RGBE\n\n-Y 1 é 1\n", "-Y 1 é 1"),
            ("#?RGBE\n\n-Y 0 +X 1\n", "-Y 0 +X 1"),
            ("#?RGBE\n\n-Y 1 +X 1", "no end"),
        ] {
            let error = Header::read(text.as_bytes()).unwrap_err();
            assert!(error.contains(words), "{text}: {error}");
        }
    }
}
