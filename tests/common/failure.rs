//! What a failing image test leaves behind: the picture, what it should be, and their difference.

use glam::{UVec2, Vec3};
use std::path::PathBuf;

/// Writes `name`-{image,reference,difference}.exr to tests/failures and says so in a sentence for the message.
pub fn write(name: &str, size: UVec2, image: &[Vec3], reference: &[Vec3]) -> String {
    let directory = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("failures");
    let difference: Vec<Vec3> = image.iter().zip(reference).map(|(a, b)| (*a - *b).abs()).collect();
    let mut said = format!("pictures in {}", directory.display());
    let folder = std::fs::create_dir_all(&directory).map_err(|e| e.to_string());
    for (what, picture) in [("image", image), ("reference", reference), ("difference", &difference)] {
        let path = directory.join(format!("{name}-{what}.exr"));
        let written = candela::image_io::write_exr(&path, size, picture).map_err(|e| e.to_string());
        if let Err(error) = folder.clone().and(written) {
            said = error;
        }
    }
    said
}
