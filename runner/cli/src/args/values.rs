//! Parsers of single values.

use candela::scene::lights::MAX_LIGHTS;
use glam::UVec2;
use shared::interface::UNBOUNDED;
use shared::passes::paths::LONGEST;

pub fn time(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|t: &f64| t.is_finite() && *t >= 0.0)
        .ok_or_else(|| "expected seconds, from 0 on".into())
}

pub fn parse_size(text: &str) -> Result<UVec2, String> {
    let (x, y) = text.split_once('x').ok_or("expected WIDTHxHEIGHT, such as 1280x720")?;
    match (x.parse(), y.parse()) {
        (Ok(x), Ok(y)) if (1..=16384).contains(&x) && (1..=16384).contains(&y) => Ok(UVec2::new(x, y)),
        _ => Err("width and height go from 1 to 16384".into()),
    }
}

/// A number of lights.
pub fn lights(text: &str) -> Result<usize, String> {
    text.parse()
        .ok()
        .filter(|n| *n <= MAX_LIGHTS)
        .ok_or_else(|| format!("expected a number of lights, at most {MAX_LIGHTS}"))
}

/// A number of reflections; `inf` for no end.
pub fn bounces(text: &str) -> Result<u32, String> {
    match text {
        "inf" => Ok(UNBOUNDED),
        _ => text
            .parse()
            .ok()
            .filter(|n| *n <= LONGEST)
            .ok_or_else(|| format!("expected a number of bounces from 0 to {LONGEST}, or inf")),
    }
}

pub fn degrees(text: &str) -> Result<f32, String> {
    text.parse()
        .ok()
        .filter(|x: &f32| x.abs() <= 36000.0)
        .ok_or_else(|| "expected degrees, at most a hundred turns".into())
}

/// Stops of exposure.
pub fn stops(text: &str) -> Result<f32, String> {
    text.parse().ok().filter(|x: &f32| x.abs() <= 64.0).ok_or_else(|| "expected stops, from -64 to 64".into())
}

pub fn positive(text: &str) -> Result<f32, String> {
    text.parse()
        .ok()
        .filter(|x: &f32| x.is_finite() && *x > 0.0)
        .ok_or_else(|| "expected a number above 0".into())
}
