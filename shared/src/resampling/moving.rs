//! A merge with the history where instances or lights have changed since the previous frame.

use super::pairwise::CrossTargets;
use super::{CrossProposal, target_of};
use crate::light::{LightSample, LightTable};
use crate::motion::PastLights;
use crate::reservoir::StoredReservoir;
use crate::shadow::ShadowRay;
use crate::surface::Surface;
use crate::target::target_function;

/// `history` of the surface `there` of the previous frame, against `current` of `surface`.
///
/// The history's pixel, its surface and the lights it saw are the previous frame's, and so must be what the ray is traced
/// among. Its targets are densities over this frame's samples, hence the Jacobian (Lin et al. 2022, "Generalized Resampled
/// Importance Sampling", eq. 13: shift mappings).
pub fn cross(
    lights: LightTable<'_>,
    past: PastLights<'_>,
    surface: &Surface,
    current: StoredReservoir,
    there: &Surface,
    history: StoredReservoir,
) -> CrossProposal {
    let neighbor = past.carried(lights.lights, history);
    let target = |now: LightSample, before: LightSample, weight: f32| {
        let incident = past.lights.incident(before, there.position);
        let jacobian = past.jacobian(lights.lights, now.light, before.light);
        (if weight > 0.0 { target_function(there, &incident) * jacobian } else { 0.0 }, incident)
    };
    let (neighbor_at_neighbor, _) = target(neighbor.sample, history.sample, neighbor.contribution_weight);
    let (canonical_at_neighbor, incident) =
        target(current.sample, past.before(current.sample), current.contribution_weight);
    let neighbor_at_canonical = target_of(surface, lights, neighbor);
    let targets = CrossTargets { neighbor_at_canonical, neighbor_at_neighbor, canonical_at_neighbor };
    CrossProposal { neighbor, targets, ray: ShadowRay::new(there, &incident), same_point: 0 }
}
