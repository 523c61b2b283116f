//! Environment maps: equirectangular pictures (orientation: see `shared::environment`), and one of our own.

mod hdr;

use super::EnvironmentSource;
use crate::error::{Error, Result};
use crate::files;
use glam::{DVec3, UVec2, Vec2, Vec3};
use image::{ImageFormat, ImageReader};
use std::f64::consts::PI;
use std::io::Cursor;

/// Light from infinity: a map of the whole sphere, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    /// Width and height, texels.
    pub size: UVec2,
    /// Radiance of each texel, nit, linear RGB; finite and not negative.
    pub radiance: Vec<Vec3>,
}

/// Is a texel of this radiance a light? Black ones are none.
pub fn shines(radiance: Vec3) -> bool {
    radiance != Vec3::ZERO
}

/// Names [`studio`] where a file's path could stand.
pub const STUDIO: &str = "studio";

/// Larger maps are filtered down to this: every texel is a light of its own.
pub const MAX_SIZE: UVec2 = UVec2::new(1024, 512);

/// Widest and highest map that is read, and most texels.
const MAX_SIDE: u32 = 16384;
const MAX_TEXELS: u32 = MAX_SIDE * MAX_SIDE / 2;
/// Most texels of an OpenEXR for each of its bytes: one color all over, compressed by PIZ, has 5,000. A header of 300 bytes may
/// claim them all.
const MAX_TEXELS_A_BYTE: u64 = 8192;

/// Stands for infinity, which half floats make of what they can't hold: their largest number.
const LARGEST: f32 = 65504.0;

/// nit; a thousand times the sun's disk, and far from the end of f32.
const MAX_RADIANCE: f32 = 1e12;

/// Reads the map of `source` (or makes [`STUDIO`]), its values times the scale as nit, turned, filtered down to
/// [`MAX_SIZE`]; with a warning for each thing in it that is unusual. Errors, one line each: a file that can't be read or
/// decoded, or is too large.
pub fn load(source: &EnvironmentSource) -> Result<(Environment, Vec<String>)> {
    let &EnvironmentSource { ref path, scale, rotation } = source;
    if path.as_os_str() == STUDIO {
        return Ok((fit(studio(scale), MAX_SIZE, rotation), Vec::new()));
    }
    let bytes = files::read(path)?;
    let broken = |reason: String| {
        let reason = reason.replace(char::is_control, " ");
        Error::input(path)(format!("environment map: {reason}"))
    };
    let Picture { size, mut radiance, encoded } = decode(&bytes).map_err(broken)?;
    let mut warnings = Vec::new();
    if encoded {
        let text = "the environment map is a PNG, JPEG or WebP: its brightest white is 1 nit (--environment-scale raises it)";
        warnings.push(text.to_owned());
    }
    if size.x != 2 * size.y {
        let UVec2 { x, y } = size;
        warnings.push(format!(
            "the environment map has {x} x {y} px, not an aspect of 2:1: it is stretched to the whole sphere"
        ));
    }
    let clamped = radiance.iter_mut().filter_map(|texel| clamp(texel, scale).then_some(())).count();
    if clamped > 0 {
        warnings.push(format!(
            "{clamped} texels of the environment map are negative or not finite; they are clamped"
        ));
    }
    Ok((fit(Environment { size, radiance }, MAX_SIZE, rotation), warnings))
}

/// A photographer's studio for looking at models, gray: a bright ceiling that fades to a dark floor, a large soft key
/// light from the left front (glTF models face +Z), a weaker fill from the right and a rim light from behind. `scale`
/// makes nit of it; 1 means that white paper which faces the key light has 1 nit, as white has that files without physical
/// lights emit.
pub fn studio(scale: f32) -> Environment {
    /// What makes white paper before the key light of the numbers below, which are those of a real studio: 850 lx / π.
    const PAPER: f32 = 270.0;
    /// Direction, half angle in degrees, nit.
    const LAMPS: [(Vec3, f32, f32); 3] = [
        (Vec3::new(-0.55, 0.55, 0.63), 32.0, 900.0),
        (Vec3::new(0.85, 0.25, 0.46), 30.0, 250.0),
        (Vec3::new(0.3, 0.8, -0.5), 24.0, 500.0),
    ];
    let size = UVec2::new(256, 128);
    let smooth = |t: f32| {
        let t = t.clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    };
    let radiance = |i: u32| {
        let place = (Vec2::new((i % size.x) as f32, (i / size.x) as f32) + 0.5) / size.as_vec2();
        let (phi, theta) = ((place.x - 0.5) * std::f32::consts::TAU, place.y * std::f32::consts::PI);
        let direction = shared::environment::direction(theta.cos(), phi);
        let room = 30.0 + 120.0 * smooth(0.5 + 0.5 * direction.y);
        let lamp = |(toward, half_angle, nit): (Vec3, f32, f32)| {
            let angle = direction.dot(toward.normalize()).clamp(-1.0, 1.0).acos().to_degrees();
            nit * smooth((half_angle - angle) / (0.5 * half_angle))
        };
        Vec3::splat((room + LAMPS.map(lamp).iter().sum::<f32>()) * (scale / PAPER))
    };
    Environment { size, radiance: (0..size.x * size.y).map(radiance).collect() }
}

/// A picture that has been read.
struct Picture {
    size: UVec2,
    radiance: Vec<Vec3>,
    /// It was made for displays: 8 or 16 bits, sRGB.
    encoded: bool,
}

fn decode(bytes: &[u8]) -> Result<Picture, String> {
    if hdr::is_radiance(bytes) {
        let header = hdr::Header::read(bytes)?;
        check_size(header.size)?;
        return Ok(Picture { size: header.size, radiance: header.decode(bytes)?, encoded: false });
    }
    let format = image::guess_format(bytes).ok();
    let encoded = matches!(format, Some(ImageFormat::Png | ImageFormat::Jpeg | ImageFormat::WebP));
    let Some(format) = format.filter(|&format| encoded || format == ImageFormat::OpenExr) else {
        return Err("neither Radiance (.hdr), OpenEXR (.exr), PNG, JPEG nor WebP".into());
    };
    let reader = || {
        let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
        reader.no_limits();
        reader
    };
    // Before the texels, which a broken file may have very many of.
    let size = UVec2::from(reader().into_dimensions().map_err(|error| error.to_string())?);
    check_size(size)?;
    let UVec2 { x, y } = size;
    let claimed = u64::from(x) * u64::from(y);
    if format == ImageFormat::OpenExr && claimed > MAX_TEXELS_A_BYTE * bytes.len() as u64 {
        return Err(format!("{x} x {y} px in {} bytes: its header is broken, or it is cut off", bytes.len()));
    }
    let texels = reader().decode().map_err(|error| error.to_string())?.into_rgb32f();
    let value = |texel: [f32; 3]| Vec3::from(if encoded { texel.map(srgb_to_linear) } else { texel });
    Ok(Picture { size, radiance: texels.pixels().map(|p| value(p.0)).collect(), encoded })
}

fn check_size(size: UVec2) -> Result<(), String> {
    let UVec2 { x, y } = size;
    match x.min(y) > 0 && x.max(y) <= MAX_SIDE && x * y <= MAX_TEXELS {
        true => Ok(()),
        false => Err(format!("{x} x {y} px; {MAX_SIDE} x {} is the most", MAX_SIDE / 2)),
    }
}

/// IEC 61966-2-1, 0..=1.
fn srgb_to_linear(encoded: f32) -> f32 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// Scales a texel and makes it a radiance; true if it was none.
fn clamp(texel: &mut Vec3, scale: f32) -> bool {
    // NaN fails the comparison.
    let valid = |x: f32| (0.0..f32::INFINITY).contains(&x);
    let was_valid = texel.to_array().into_iter().all(valid);
    let value = |x: f32| if x > 0.0 { x.min(if x == f32::INFINITY { LARGEST } else { x }) } else { 0.0 };
    *texel = Vec3::from(texel.to_array().map(|x| (value(x) * scale).min(MAX_RADIANCE)));
    !was_valid
}

/// Turned by `degrees` about +Y (from +Z to +X, as nodes of glTF turn), and box filtered to at most `largest`: each new
/// texel is the mean over its solid angle, so that no light is lost or gained.
pub fn fit(map: Environment, largest: UVec2, degrees: f32) -> Environment {
    let size = map.size.min(largest);
    let turn = f64::from(degrees) / 360.0;
    if size == map.size && turn == 0.0 {
        return map;
    }
    let columns = match turn {
        0.0 => shares(map.size.x, size.x, |u| u),
        turn => turned(map.size.x, size.x, turn),
    };
    let rows = shares(map.size.y, size.y, |v| -(PI * v).cos());
    let row_mean = |row: &[Vec3], shares: &[(usize, f64)]| -> DVec3 {
        shares.iter().map(|&(x, share)| row[x].as_dvec3() * share).sum()
    };
    let mut radiance = Vec::with_capacity((size.x * size.y) as usize);
    for shares in &rows {
        let mut means = vec![DVec3::ZERO; size.x as usize];
        for &(y, share) in shares {
            let row = &map.radiance[y * map.size.x as usize..][..map.size.x as usize];
            for (mean, columns) in means.iter_mut().zip(&columns) {
                *mean += share * row_mean(row, columns);
            }
        }
        radiance.extend(means.iter().map(|mean| mean.as_vec3()));
    }
    Environment { size, radiance }
}

/// As [`shares`], of a circle that is turned: cell 0 begins `turn` of it later.
fn turned(from: u32, to: u32, turn: f64) -> Vec<Vec<(usize, f64)>> {
    let edge = |i: u32| (f64::from(i) / f64::from(to) + turn) * f64::from(from);
    let cell = |i: u32| {
        let (start, end) = (edge(i), edge(i + 1));
        let share = |j: i64| {
            let overlap = ((j + 1) as f64).min(end) - (j as f64).max(start);
            (j.rem_euclid(from.into()) as usize, overlap / (end - start))
        };
        (start.floor() as i64..end.ceil() as i64).map(share).collect()
    };
    (0..to).map(cell).collect()
}

/// For each of `to` cells of the unit interval: which of `from` cells it covers, each with its share of the cell in a
/// measure whose integral up to a place is `measure`.
fn shares(from: u32, to: u32, measure: impl Fn(f64) -> f64) -> Vec<Vec<(usize, f64)>> {
    let edge = |i: u32, n: u32| f64::from(i) / f64::from(n);
    let cell = |i: u32| {
        let (start, end) = (edge(i, to), edge(i + 1, to));
        let all = measure(end) - measure(start);
        // Integers: no rounding may lose a cell.
        let first = (u64::from(i) * u64::from(from) / u64::from(to)) as u32;
        let last = ((u64::from(i + 1) * u64::from(from)).div_ceil(u64::from(to))) as u32;
        let share = |j: u32| {
            let overlap = measure(edge(j + 1, from).min(end)) - measure(edge(j, from).max(start));
            (j as usize, overlap / all)
        };
        (first..last).map(share).collect()
    };
    (0..to).map(cell).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image_io;
    use std::path::{Path, PathBuf};

    fn file(name: &str, bytes: &[u8]) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("candela-environment-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }

    fn load(path: &Path, scale: f32) -> Result<(Environment, Vec<String>)> {
        super::load(&EnvironmentSource { scale, ..EnvironmentSource::new(path.into()) })
    }

    fn hdr(width: u32, height: u32, texel: [f32; 3]) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        image::Rgb32FImage::from_pixel(width, height, image::Rgb(texel))
            .write_to(&mut bytes, ImageFormat::Hdr)
            .unwrap();
        bytes.into_inner()
    }

    #[test]
    fn both_formats_are_read_and_scaled() {
        let (map, warnings) = load(&file("sky.hdr", &hdr(8, 4, [1.0, 2.0, 0.5])), 100.0).unwrap();
        assert_eq!(
            (map.size, map.radiance[31], warnings),
            (UVec2::new(8, 4), Vec3::new(100.0, 200.0, 50.0), vec![])
        );
        let path = file("sky.exr", &[]);
        let radiance: Vec<Vec3> = (0..8).map(|i| Vec3::new(i as f32, 0.25, 1e5)).collect();
        image_io::write_exr(&path, UVec2::new(4, 2), &radiance).unwrap();
        assert_eq!(load(&path, 1.0).unwrap().0.radiance, radiance);
    }

    /// The strength that it says, by the sum over its texels; and the key light is where it says.
    #[test]
    fn the_studio_has_its_key_light() {
        let (map, _) = load(Path::new(STUDIO), 1.0).unwrap();
        let lights = |toward: Vec3| -> f32 {
            let texel = |(i, l): (usize, &Vec3)| {
                let (x, y) = (i as u32 % map.size.x, i as u32 / map.size.x);
                let light = shared::light::Light::environment(UVec2::new(x, y), map.size, *l, 1.0);
                let from = light.sample_li(Vec2::splat(0.5), Vec3::ZERO).direction;
                l.x * from.dot(toward).max(0.0) * light.area
            };
            map.radiance.iter().enumerate().map(texel).sum()
        };
        let key = lights(Vec3::new(-0.55, 0.55, 0.63).normalize());
        // White paper of 1 nit is lit by π lx.
        assert!((0.9..1.1).contains(&(key / std::f32::consts::PI)), "{key} lx");
        assert!(lights(Vec3::NEG_Y) < 0.5 * key && lights(Vec3::Z) > lights(Vec3::X));
        assert_eq!(load(Path::new(STUDIO), 2.0).unwrap().0.radiance[100], 2.0 * map.radiance[100]);
    }

    #[test]
    fn bad_files_make_one_line() {
        let whole = hdr(64, 32, [1.0; 3]);
        for (name, bytes, part) in [
            ("empty.hdr", &b""[..], "neither Radiance"),
            ("png.hdr", b"\x89PNG\r\n\x1a\n", "environment map"),
            ("cut.hdr", &whole[..whole.len() / 2], "environment map"),
            ("header.hdr", &whole[..20], "environment map"),
            ("cut.exr", b"\x76\x2f\x31\x01\x02\0\0\0", "environment map"),
            ("wide.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16384 +X 32768\n", "16384 x 8192"),
            ("high.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16384 +X 16384\n", "16384 x 8192"),
        ] {
            let path = file(name, bytes);
            let message = load(&path, 1.0).unwrap_err().to_string();
            assert!(
                message.contains(part) && message.contains(name) && message.lines().count() == 1,
                "{message}"
            );
        }
        let message = load(Path::new("/nowhere/sky.hdr"), 1.0).unwrap_err().to_string();
        assert!(message.contains("/nowhere/sky.hdr: can't read"), "{message}");
    }

    /// Middle gray and white of an sRGB display; a square is stretched, and both are said.
    #[test]
    fn ordinary_pictures_are_decoded_with_a_warning() {
        let mut bytes = Cursor::new(Vec::new());
        let picture = image::RgbImage::from_fn(2, 2, |x, _| image::Rgb([if x == 0 { 188 } else { 255 }; 3]));
        picture.write_to(&mut bytes, ImageFormat::Png).unwrap();
        let (map, warnings) = load(&file("square.png", bytes.get_ref()), 2.0).unwrap();
        assert_eq!((map.size, map.radiance[1]), (UVec2::splat(2), Vec3::splat(2.0)));
        // 188 / 255 stands for 0.5029.
        assert!((map.radiance[0].x - 1.0058).abs() < 1e-3, "{}", map.radiance[0].x);
        assert!(warnings.len() == 2 && warnings[0].contains("PNG, JPEG or WebP"), "{warnings:?}");
        assert!(warnings[1].contains("2 x 2 px"), "{warnings:?}");
    }

    /// A lamp at +X comes to -Z by a quarter turn, as a node with that rotation about +Y; by an odd angle no light is lost.
    #[test]
    fn maps_turn_as_nodes_do() {
        let size = UVec2::new(16, 8);
        let place = |direction: Vec3| shared::environment::texel_of(direction.normalize(), size) as usize;
        let near = |axis: Vec3| axis + Vec3::new(0.1, 0.1, 0.1);
        let mut radiance = vec![Vec3::ZERO; 128];
        radiance[place(near(Vec3::X))] = Vec3::ONE;
        let map = Environment { size, radiance };
        let rotation = glam::Quat::from_rotation_y(90f32.to_radians());
        let turned = fit(map.clone(), size, 90.0);
        let lit = place(rotation * near(Vec3::X));
        for (i, texel) in turned.radiance.iter().enumerate() {
            assert_eq!(*texel, if i == lit { Vec3::ONE } else { Vec3::ZERO }, "{i}, lit {lit}");
        }
        assert_eq!(fit(turned, size, -90.0), map);
        for (largest, degrees) in [(size, 7.3), (size, -400.0), (UVec2::new(8, 4), 123.4)] {
            let odd = fit(map.clone(), largest, degrees);
            let sum: f32 = odd.radiance.iter().map(|l| l.x).sum();
            // A texel of the smaller map is two wide, and two rows high: by their solid angles.
            let share = 0.5 * (0.375 * PI).cos() / (0.25 * PI).cos();
            let expected = if largest == size { 1.0 } else { share as f32 };
            assert!((sum / expected - 1.0).abs() < 1e-5, "{degrees} degrees: {sum}");
            assert!(odd.radiance.iter().filter(|l| l.x > 1e-6).count() <= 2, "{degrees}");
        }
    }

    /// A small file that claims the largest map is refused before memory is taken.
    #[test]
    fn a_header_alone_is_no_map() {
        let path = file("claims.exr", &[]);
        image_io::write_exr(&path, UVec2::new(2, 1), &[Vec3::ONE; 2]).unwrap();
        let mut bytes = std::fs::read(&path).unwrap();
        assert!(load(&path, 1.0).is_ok());
        // Both windows: xMin, yMin, xMax, yMax of 2 x 1 texels.
        let window = [0i32, 0, 1, 0].map(i32::to_le_bytes).concat();
        let largest = [0i32, 0, 16383, 8191].map(i32::to_le_bytes).concat();
        let places: Vec<usize> = (0..bytes.len() - 16).filter(|&i| bytes[i..i + 16] == window[..]).collect();
        assert_eq!(places.len(), 2);
        places.iter().for_each(|&i| bytes[i..i + 16].copy_from_slice(&largest));
        let name = b"chunkCount\0int\0";
        let chunks = bytes.windows(name.len()).position(|w| w == name).unwrap() + name.len() + 4;
        // By the compression: of so many rows, or tiles of 64 x 64.
        let errors = [8192, 512, 256, 32, 256 * 128].map(|count| {
            bytes[chunks..chunks + 4].copy_from_slice(&i32::to_le_bytes(count));
            std::fs::write(&path, &bytes).unwrap();
            load(&path, 1.0).unwrap_err().to_string()
        });
        assert!(errors.iter().any(|error| error.contains("16384 x 8192 px in")), "{errors:?}");
    }

    #[test]
    fn texels_that_are_no_radiance_are_clamped() {
        let path = file("odd.exr", &[]);
        let odd = [Vec3::new(f32::NAN, -1.0, 2.0), Vec3::new(f32::INFINITY, 1.0, 1.0)];
        image_io::write_exr(&path, UVec2::new(2, 1), &odd).unwrap();
        let (map, warnings) = load(&path, 2.0).unwrap();
        assert_eq!(map.radiance, [Vec3::new(0.0, 0.0, 4.0), Vec3::new(2.0 * 65504.0, 2.0, 2.0)]);
        assert!(warnings[0].starts_with("2 texels") && warnings.len() == 1);
    }

    /// ∫ L dω before and after; sizes that divide and that don't.
    #[test]
    fn filtering_keeps_the_light() {
        let integral = |map: &Environment| -> DVec3 {
            let edge = |y: u32| (PI * f64::from(y) / f64::from(map.size.y)).cos();
            let weight = |i: usize| {
                let y = i as u32 / map.size.x;
                (edge(y) - edge(y + 1)) * 2.0 * PI / f64::from(map.size.x)
            };
            map.radiance.iter().enumerate().map(|(i, l)| l.as_dvec3() * weight(i)).sum()
        };
        let size = UVec2::new(60, 30);
        let mut radiance: Vec<Vec3> = (0..1800).map(|i| Vec3::new((i * 37 % 101) as f32, 1.0, 0.0)).collect();
        // A sun in one texel.
        radiance[700].z = 1e6;
        let map = Environment { size, radiance };
        for largest in [UVec2::new(30, 15), UVec2::new(14, 7), UVec2::new(44, 22), UVec2::new(2, 1)] {
            let small = fit(map.clone(), largest, 0.0);
            assert_eq!((small.size, small.radiance.len() as u32), (largest, largest.x * largest.y));
            let error = (integral(&small) / integral(&map) - 1.0).abs().max_element();
            assert!(error < 1e-6, "{largest}: {error}");
            assert!(small.radiance.iter().all(|l| (l.y - 1.0).abs() < 1e-6), "a constant stays one");
        }
        assert_eq!(fit(map.clone(), MAX_SIZE, 0.0), map);
    }
}
