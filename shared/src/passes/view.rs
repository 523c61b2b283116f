//! One of the viewer's views in place of the tone-mapped picture.

use super::At;
use crate::geometry::InstanceGeometry;
use crate::light::Light;
use crate::material::Material;
use crate::reservoir::StoredReservoir;
use crate::resources::Extent;
use crate::surface::GBufferTexel;
use crate::target::unshadowed;
use crate::tonemap::pack_rgba8;
use crate::view::{Pixel, color, features_color, kind};
use glam::Vec3;

#[allow(clippy::too_many_arguments)]
pub fn view(
    at: At<'_>,
    instances: &[InstanceGeometry],
    materials: &[Material],
    lights: &[Light],
    gbuffer: &[GBufferTexel],
    reservoirs: &[StoredReservoir],
    radiance: &[Vec3],
    mean: &[Vec3],
    reference: &[Vec3],
) -> u32 {
    let index = at.index(Extent::Pixels);
    let shown_kind = at.constants.view;
    let texel = gbuffer[index];
    let mut shown = Pixel::new(texel, radiance[index]);
    // Reference frames have no reservoirs.
    if at.frame.settings.reservoirs > 0 {
        shown.reservoir = reservoirs[index];
    }
    if at.constants.count > 0 {
        shown.mean = mean[index];
    }
    if shown_kind == kind::DIFFERENCE {
        shown.reference = reference[index];
    }
    if shown_kind == kind::VISIBILITY && !texel.is_empty() {
        let surface = at.surface(&texel);
        let incident = at.lights(lights).incident(shown.reservoir.sample, surface.position);
        shown.unshadowed = unshadowed::<Vec3>(&surface, &incident) * shown.reservoir.contribution_weight;
    }
    let color = if shown_kind == kind::FEATURES && !texel.is_empty() {
        features_color(&materials[instances[texel.instance as usize].material as usize])
    } else {
        color(shown_kind, at.constants.scale, at.frame, &shown)
    };
    pack_rgba8(color)
}
