//! Parsers of single values.

use crate::error::{Error, Result};
use glam::{DVec3, UVec2};

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

pub fn positive(text: &str) -> Result<f32, String> {
    text.parse()
        .ok()
        .filter(|x: &f32| x.is_finite() && *x > 0.0)
        .ok_or_else(|| "expected a number above 0".into())
}

/// `x,y,z,tx,ty,tz[,fov]` as (position, target, fov in degrees), or none if it is no list of numbers.
pub fn parse_view(text: &str) -> Option<Result<(DVec3, DVec3, Option<f64>)>> {
    let numbers: Vec<f64> = text.split(',').map(|n| n.trim().parse().ok()).collect::<Option<_>>()?;
    let finite = numbers.iter().all(|n| n.is_finite());
    match numbers[..] {
        [x, y, z, tx, ty, tz, ref fov @ ..] if finite && fov.len() <= 1 => {
            Some(Ok((DVec3::new(x, y, z), DVec3::new(tx, ty, tz), fov.first().copied())))
        }
        // A single number is a camera's index.
        [_] => None,
        _ => Some(Err(Error::Usage(format!("--camera {text}: expected x,y,z,tx,ty,tz[,fov]")))),
    }
}
