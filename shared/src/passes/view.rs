//! One of the viewer's views in place of the tone-mapped picture.

use super::At;
use crate::cells::{Cell, cell_of};
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

/// RGBA8, red lowest.
#[allow(clippy::too_many_arguments)]
pub fn view(
    at: At<'_>,
    instances: &[InstanceGeometry],
    materials: &[Material],
    lights: &[Light],
    tree_leaves: &[u32],
    cells: &[Cell],
    beliefs: &[u32],
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
    if at.frame.settings.cells != 0 && !texel.is_empty() {
        let cell = cell_of(at.frame, &at.surface(&texel), at.pixel);
        shown.cell = cell;
        let light = shown.reservoir.sample.light;
        if shown_kind == kind::BELIEVED && light < at.lights(lights).count() {
            let believed = at.beliefs(beliefs, cell);
            let all = cells[cell as usize].visibility;
            shown.believed = believed.of_light(light, tree_leaves[light as usize], at.frame.tree_lights, all);
        }
    }
    let color = if shown_kind == kind::FEATURES && !texel.is_empty() {
        features_color(&materials[instances[texel.instance() as usize].material as usize])
    } else {
        color(shown_kind, at.constants.scale, at.frame, &shown)
    };
    pack_rgba8(color)
}
