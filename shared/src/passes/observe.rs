//! What the shadow rays of a frame's fresh candidates saw, for [`super::learn_beliefs`] and [`super::learn_lists`] of the next frame.

use super::At;
use crate::cells::list::{self, LIST};
use crate::cells::{self, belief, cell_of};
use crate::counters::Counters;
use crate::light::{Light, tree};
use crate::math::safe_ratio;
use crate::motion::NO_LIGHT;
use crate::reservoir::StoredReservoir;
use crate::resources::Extent;
use crate::surface::GBufferTexel;
use crate::target::target_function;
use glam::UVec2;

/// Pixels that observe in every frame; of larger pictures one of each 2 x 2, in turns.
const ENOUGH: u32 = 1 << 19;

fn is_asked(at: At<'_>) -> bool {
    let turn = UVec2::new(at.frame.index & 1, at.frame.index >> 1 & 1);
    at.frame.pixels() <= ENOUGH || at.pixel & 1 == turn
}

/// `merged`: the reservoirs as [`super::initial`] left them. A survivor without weight was hidden.
#[allow(clippy::too_many_arguments)]
pub fn observe(
    at: At<'_>,
    lights: &[Light],
    tree_leaves: &[u32],
    gbuffer: &[GBufferTexel],
    merged: &[StoredReservoir],
    mut observations: Counters<'_>,
    mut findings: Counters<'_>,
) {
    if !is_asked(at) {
        return;
    }
    let texel = at.texel(gbuffer);
    let stored = merged[at.index(Extent::Pixels)];
    let light = stored.sample.light;
    let table = at.lights(lights);
    if texel.is_empty() || light >= table.count() {
        return;
    }
    let surface = at.surface(&texel);
    let target = target_function(&surface, &table.incident(stored.sample, surface.position));
    if target <= 0.0 {
        return;
    }
    let cell = cell_of(at.frame, &surface, at.pixel);
    let seen = stored.contribution_weight > 0.0;
    let ray = belief::observation(seen);
    let cells = cells::most(at.frame.size);
    let mut count = |node| {
        observations.add(belief::place(cells, cell, node), ray);
    };
    count(belief::ALL);
    let leaf = tree_leaves[light as usize];
    if leaf == NO_LIGHT {
        count(belief::far_away(light));
    } else {
        tree::path(leaf, at.frame.tree_lights, count);
    }
    if seen {
        // p̂ is per m² (or sr) of lights with extent: all of the light counts.
        let measure = safe_ratio(1.0, table.pdf_li(light).0);
        findings.max(cell * LIST + list::place(light), list::finding(light, target * measure));
    }
}
