//! What a finished reservoir contributes to its pixel.

use crate::light::Incident;
use crate::reflected::Reflected;
use crate::resampling::Source;
use crate::reservoir::Stored;
use crate::shadow::ShadowRay;
use crate::surface::Surface;
use crate::target::unshadowed;
use glam::Vec3;

/// Radiance that reaches the camera if `ray` meets nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Contribution<L = Vec3> {
    /// f Le G W, nit, linear RGB.
    pub radiance: L,
    /// To the light.
    pub ray: ShadowRay,
}

impl<L: Reflected> Contribution<L> {
    /// f Le G `weight`.
    pub fn new(surface: &Surface, incident: &Incident, weight: f32) -> Self {
        Contribution {
            radiance: unshadowed::<L>(surface, incident) * weight,
            ray: ShadowRay::new(surface, incident),
        }
    }

    /// No ray is worth tracing for nothing.
    pub fn is_dark(&self) -> bool {
        self.radiance == L::default()
    }
}

/// f Le G W of the survivor, and the ray that decides over it.
///
/// Equation (10): Bitterli (6); thesis (4.17).
pub fn contribution<L: Reflected, S: Source>(
    surface: &Surface,
    source: S,
    reservoir: Stored<S::Sample>,
) -> Contribution<L> {
    if reservoir.contribution_weight <= 0.0 {
        return Contribution::default();
    }
    let incident = source.incident(reservoir.sample, surface.position);
    Contribution::new(surface, &incident, reservoir.contribution_weight)
}

/// Mean over the reservoirs of a pixel.
#[derive(Clone, Copy, Debug, Default)]
pub struct Average<L = Vec3> {
    sum: L,
    count: f32,
}

impl<L: Reflected> Average<L> {
    /// One reservoir more; dark where its light is hidden.
    pub fn add(&mut self, shaded: Contribution<L>, visible: bool) {
        self.count += 1.0;
        if visible {
            self.sum += shaded.radiance;
        }
    }

    /// Nit, linear RGB.
    ///
    /// Equation (29): Bitterli (7); thesis (4.17).
    pub fn radiance(&self) -> L {
        self.sum / self.count.max(1.0)
    }
}
