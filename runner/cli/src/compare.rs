//! `candela compare`: how far a picture is from the truth.

use candela::error::{Error, Result};
use candela::image_io;
use candela_lab::measure::heatmap;
use candela_lab::measure::metrics::{self, Metrics};
use clap::Args;
use glam::Vec3;
use shared::math::luminance;
use std::path::PathBuf;

#[derive(Args, Clone, Debug)]
pub struct CompareArgs {
    /// The picture: .exr, linear radiance.
    pub picture: PathBuf,
    /// The truth: .exr of the same size.
    pub reference: PathBuf,
    /// Print the numbers as JSON.
    #[arg(long)]
    pub json: bool,
    /// Write heat maps of the error to this folder: flip.png and signed.png.
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
}

pub fn run(args: &CompareArgs) -> Result<()> {
    let (size, picture) = image_io::read_exr(&args.picture)?;
    let (other, reference) = image_io::read_exr(&args.reference)?;
    if size != other {
        return Err(Error::Usage(format!(
            "{} is {}x{} and {} is {}x{}: pictures of one size can be compared",
            args.picture.display(),
            size.x,
            size.y,
            args.reference.display(),
            other.x,
            other.y
        )));
    }
    if let Some(directory) = &args.output {
        image_io::create_folder(directory)?;
    }
    let (metrics, flip) = metrics::with_flip(&picture, &reference, size);
    if args.json {
        println!("{}", serde_json::to_string_pretty(&metrics).map_err(Error::internal)?);
    } else {
        print(&metrics);
    }
    if let Some(directory) = &args.output {
        heatmap::write_png(&directory.join("flip.png"), size, &flip, &heatmap::FLIP)?;
        let signed: Vec<f32> = picture.iter().zip(&reference).map(|(a, b)| signed(*a, *b)).collect();
        heatmap::write_png(&directory.join("signed.png"), size, &signed, &heatmap::SIGNED)?;
    }
    Ok(())
}

/// 2(x - y)/(x + y) of luminance; 0 where both are black.
fn signed(a: Vec3, b: Vec3) -> f32 {
    let (x, y) = (luminance(a), luminance(b));
    if x + y > 0.0 { 2.0 * (x - y) / (x + y) } else { 0.0 }
}

fn print(m: &Metrics) {
    println!("bias          {:+.4e} nit", m.bias);
    println!("energy ratio  {:.5}", m.energy_ratio);
    println!("RMSE          {:.4e} nit", m.rmse);
    println!("relMSE        {:.4e}", m.rel_mse);
    println!("MAPE          {:.4e}", m.mape);
    println!("SMAPE         {:.4e}", m.smape);
    println!("chroma error  {:.4e}", m.chroma);
    println!("R-MAE         {:.4e}", m.r_mae);
    if let Some(flip) = m.flip {
        println!("FLIP          {flip:.4}");
    }
    if m.not_finite > 0 {
        println!("not finite    {} pixels, left out", m.not_finite);
    }
}
