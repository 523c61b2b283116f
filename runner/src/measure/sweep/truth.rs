//! The picture that all others are judged by.
//!
//! Where the sum over all lights is affordable it is the truth: of a scene with nothing but points, spots and parallel light,
//! and nothing transparent, one pass is exact. Else passes with other random numbers are averaged until their own standard
//! error is small enough. Where there are too many lights for a sum, independent frames of plain resampling take its place: no
//! temporal, no spatial, no visibility reuse, no tiles, whose mean is the same (the tests hold them against the sum).

use super::plan::TruthPlan;
use crate::error::Result;
use crate::frame::renderer::{FrameOptions, Renderer};
use crate::frame::schedule::Work;
use crate::measure::mean::Mean;
use crate::measure::metrics::rel_mse_of_errors;
use glam::{UVec2, Vec3};
use serde::{Deserialize, Serialize};
use shared::camera::Camera;
use shared::frame::{Settings, features, mode};

#[derive(Clone, Debug)]
pub struct Truth {
    pub size: UVec2,
    /// nit, linear RGB, rows from the top.
    pub radiance: Vec<Vec3>,
    pub about: AboutTruth,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct AboutTruth {
    pub key: String,
    pub method: Method,
    /// Passes or frames.
    pub samples: u32,
    /// √relMSE that the truth itself is expected to have; 0 where it is exact.
    pub error: f64,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    #[default]
    SumOverLights,
    IndependentFrames,
}

/// Candidates of a frame that stands in for the sum.
const CANDIDATES: u32 = 128;

/// Far from the seeds of what is judged.
const SEED: u32 = 0x7275_7468;

/// Does one pass give the truth of a scene with these lights and features?
pub struct Lighting {
    pub lights: u32,
    /// Nothing has an extent: no triangles, no environment.
    pub points_only: bool,
    pub features: u32,
}

impl Lighting {
    fn is_exact(&self) -> bool {
        self.points_only && self.features & features::ALPHA == 0
    }
}

/// Renders until the standard error is `plan.error`, or `plan.max_samples` are reached. `tick` is called after each sample.
pub fn converge(
    renderer: &mut Renderer,
    camera: Camera,
    lighting: &Lighting,
    plan: &TruthPlan,
    key: String,
    mut tick: impl FnMut(),
) -> Result<Truth> {
    let size = renderer.size();
    let rays = f64::from(size.x) * f64::from(size.y) * f64::from(lighting.lights);
    let by_sum = rays <= plan.max_rays;
    let work = if by_sum { Work::Reference { lights: lighting.lights } } else { Work::Restir(independent()) };
    let exact = by_sum && lighting.is_exact();
    let samples = if exact { 1 } else { plan.max_samples.max(4) };
    let mut mean = Mean::new(size);
    let mut error = if exact { 0.0 } else { f64::INFINITY };
    renderer.restart();
    while mean.count() < samples {
        let options = FrameOptions { work, seed: SEED, exposure: 1.0, background: Vec3::ZERO };
        renderer.render(camera, &options)?;
        mean.add(&renderer.radiance()?);
        tick();
        // A look at the error costs about as much as a sample: at powers of two.
        if !exact && mean.count() >= 4 && (mean.count().is_power_of_two() || mean.count() == samples) {
            error = rel_mse_of_errors(&mean.standard_errors(), &mean.radiance()).sqrt();
            if error <= plan.error {
                break;
            }
        }
    }
    let method = if by_sum { Method::SumOverLights } else { Method::IndependentFrames };
    let about = AboutTruth { key, method, samples: mean.count(), error };
    Ok(Truth { size, radiance: mean.radiance(), about })
}

fn independent() -> Settings {
    Settings {
        candidates: CANDIDATES,
        visibility_reuse: 0,
        temporal: 0,
        spatial: 0,
        mode: mode::UNBIASED,
        tiles: 0,
        reservoirs: 1,
        ..Settings::default()
    }
}
