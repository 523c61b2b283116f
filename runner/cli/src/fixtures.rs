//! `candela fixtures DIRECTORY`: rewrites the test scenes of `assets/scenes`.

use candela::error::Result;
use std::path::Path;

pub fn run(directory: &Path) -> Result<()> {
    for path in candela::scene::fixtures::write_all(directory)? {
        println!("{}", path.display());
    }
    Ok(())
}
