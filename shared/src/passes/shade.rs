//! The radiance of a pixel from its reservoirs, with a ray each unless they are known to hold visible samples.

use super::{At, Question, Visibility, Witness};
use crate::alias_table::AliasEntry;
use crate::alpha;
use crate::light::{Light, LightTable};
use crate::reflected::{Parts, Reflected};
use crate::resampling::reservoir_index;
use crate::reservoir::StoredReservoir;
use crate::rng::Stream;
use crate::shading::{Average, contribution};
use crate::surface::GBufferTexel;
use glam::Vec3;

/// `radiance`: what the pixel shows unlit, nit.
#[allow(clippy::too_many_arguments)]
pub fn shade(
    at: At<'_>,
    rays: impl Visibility,
    note: impl Witness,
    lights: &[Light],
    alias: &[AliasEntry],
    gbuffer: &[GBufferTexel],
    reservoirs: &[StoredReservoir],
    radiance: Vec3,
) -> Vec3 {
    radiance + lit::<Vec3>(at, rays, note, at.light_table(lights, alias), gbuffer, reservoirs)
}

/// The same light in [`Parts`] beside `radiance`: diffuse, specular, nit.
pub fn shade_parts(
    at: At<'_>,
    rays: impl Visibility,
    note: impl Witness,
    lights: &[Light],
    alias: &[AliasEntry],
    gbuffer: &[GBufferTexel],
    reservoirs: &[StoredReservoir],
) -> (Vec3, Vec3) {
    lit::<Parts>(at, rays, note, at.light_table(lights, alias), gbuffer, reservoirs).apart()
}

/// The light that the pixel's reservoirs bring to its surface.
fn lit<L: Reflected>(
    at: At<'_>,
    mut rays: impl Visibility,
    mut note: impl Witness,
    table: LightTable<'_>,
    gbuffer: &[GBufferTexel],
    reservoirs: &[StoredReservoir],
) -> L {
    let texel = at.texel(gbuffer);
    if texel.is_empty() {
        return L::default();
    }
    let surface = at.surface(&texel);
    let mut rng = at.rng(Stream::Shade);
    let mut lit = Average::<L>::default();
    let mut lane = 0;
    while lane < at.frame.settings.reservoirs {
        let stored = reservoirs[reservoir_index(at.frame, at.pixel, lane) as usize];
        let mut shaded = contribution::<L, _>(&surface, table, stored);
        note.shaded(stored, &mut shaded);
        let key = alpha::key(rng.next_u32x4().x);
        let visible = !shaded.is_dark() && rays.sees(Question::Shade, shaded.ray, key);
        note.lit(&shaded, visible);
        lit.add(shaded, visible);
        lane += 1;
    }
    lit.radiance()
}
