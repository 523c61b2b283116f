//! What a finished reservoir contributes to its pixel.

use crate::light::LightTable;
use crate::reservoir::StoredReservoir;
use crate::shadow::ShadowRay;
use crate::surface::Surface;
use crate::target::unshadowed;
use glam::Vec3;

/// Radiance that reaches the camera if `ray` meets nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Contribution {
    /// f Le G W, nit, linear RGB.
    pub radiance: Vec3,
    pub ray: ShadowRay,
}

impl Contribution {
    /// No ray is worth tracing for nothing.
    pub fn is_dark(&self) -> bool {
        self.radiance == Vec3::ZERO
    }
}

/// f Le G W of the survivor, and the ray that decides over it.
///
/// Equation (10): Bitterli (6); thesis (4.17).
pub fn contribution(surface: &Surface, lights: LightTable<'_>, reservoir: StoredReservoir) -> Contribution {
    if reservoir.contribution_weight <= 0.0 {
        return Contribution::default();
    }
    let incident = lights.incident(reservoir.sample, surface.position);
    Contribution {
        radiance: unshadowed(surface, &incident) * reservoir.contribution_weight,
        ray: ShadowRay::new(surface, &incident),
    }
}

/// Mean over the reservoirs of a pixel.
#[derive(Clone, Copy, Debug, Default)]
pub struct Average {
    sum: Vec3,
    count: f32,
}

impl Average {
    pub fn add(&mut self, shaded: Contribution, visible: bool) {
        self.count += 1.0;
        if visible {
            self.sum += shaded.radiance;
        }
    }

    /// Nit, linear RGB.
    ///
    /// Equation (29): Bitterli (7); thesis (4.17).
    pub fn radiance(&self) -> Vec3 {
        self.sum / self.count.max(1.0)
    }
}
