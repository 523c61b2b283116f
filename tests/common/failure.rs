//! What a failing image test leaves behind: the picture, what it should be, and their difference.

use glam::{UVec2, Vec3};
use std::path::PathBuf;

/// Writes `name`-{image,reference,difference}.exr to tests/failures and says so in a sentence for the message.
pub fn write(name: &str, size: UVec2, image: &[Vec3], reference: &[Vec3]) -> String {
    let difference: Vec<Vec3> = image.iter().zip(reference).map(|(a, b)| (*a - *b).abs()).collect();
    write_all(name, size, &[("image", image), ("reference", reference), ("difference", &difference)])
}

/// Writes the mean pictures' luminance, and -log10 of each pixel's p-value.
pub fn write_test(name: &str, size: UVec2, image: &[f64], reference: &[f64], p_values: &[f64]) -> String {
    let grey = |values: &[f64]| values.iter().map(|&v| Vec3::splat(v as f32)).collect::<Vec<_>>();
    let map: Vec<f64> = p_values.iter().map(|p| -p.max(1e-30).log10()).collect();
    let pictures = [image, reference, &map].map(grey);
    write_all(name, size, &[("image", &pictures[0]), ("reference", &pictures[1]), ("p-values", &pictures[2])])
}

fn write_all(name: &str, size: UVec2, pictures: &[(&str, &[Vec3])]) -> String {
    let directory = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("failures");
    let mut said = format!("pictures in {}", directory.display());
    let folder = std::fs::create_dir_all(&directory).map_err(|e| e.to_string());
    for (what, picture) in pictures {
        let path = directory.join(format!("{name}-{what}.exr"));
        let written = candela::image_io::write_exr(&path, size, picture).map_err(|e| e.to_string());
        if let Err(error) = folder.clone().and(written) {
            said = error;
        }
    }
    said
}
