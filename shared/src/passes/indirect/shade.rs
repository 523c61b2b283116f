//! What paths bring to their pixels. No ray: reuse has asked.

use crate::bounced::Bounced;
use crate::passes::{At, Visibility, Witness};
use crate::reflected::{Parts, Reflected};
use crate::reservoir::StoredPath;
use crate::shading::contribution;
use crate::surface::GBufferTexel;
use crate::textures::Texels;
use glam::Vec3;

/// Radiance with what the paths bring, nit.
pub fn whole<T: Texels>(
    at: At<'_>,
    _: impl Visibility,
    note: impl Witness,
    source: Bounced<'_, T>,
    gbuffer: &[GBufferTexel],
    paths: &[StoredPath],
    radiance: Vec3,
) -> Vec3 {
    radiance + lit::<Vec3, T>(at, note, source, gbuffer, paths)
}

/// What the paths bring, in parts: diffuse under an albedo of 1, specular, nit.
pub fn parts<T: Texels>(
    at: At<'_>,
    _: impl Visibility,
    note: impl Witness,
    source: Bounced<'_, T>,
    gbuffer: &[GBufferTexel],
    paths: &[StoredPath],
) -> (Vec3, Vec3) {
    lit::<Parts, T>(at, note, source, gbuffer, paths).apart()
}

fn lit<L: Reflected, T: Texels>(
    at: At<'_>,
    mut note: impl Witness,
    source: Bounced<'_, T>,
    gbuffer: &[GBufferTexel],
    paths: &[StoredPath],
) -> L {
    let texel = at.texel(gbuffer);
    if texel.is_empty() {
        return L::default();
    }
    let stored = paths[at.frame.pixel_index(at.pixel) as usize];
    let mut shaded = contribution::<L, _>(&at.surface(&texel), source, stored);
    note.brings(stored, &mut shaded);
    shaded.radiance
}
