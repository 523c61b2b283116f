//! The parts of a picture, composed: what a denoiser leaves of them.

use super::At;
use crate::resources::Extent;
use crate::surface::GBufferTexel;
use glam::Vec3;

/// Radiance, nit: emission + albedo x diffuse + specular.
pub fn resolve(
    at: At<'_>,
    gbuffer: &[GBufferTexel],
    direct_diffuse: &[Vec3],
    direct_specular: &[Vec3],
    emission: &[Vec3],
) -> Vec3 {
    let i = at.index(Extent::Pixels);
    emission[i] + (gbuffer[i].diffuse() * direct_diffuse[i] + direct_specular[i])
}

/// The same with light that bounces: `radiance` as [`resolve`] left it.
pub fn resolve_indirect(
    at: At<'_>,
    gbuffer: &[GBufferTexel],
    indirect_diffuse: &[Vec3],
    indirect_specular: &[Vec3],
    radiance: Vec3,
) -> Vec3 {
    let i = at.index(Extent::Pixels);
    radiance + (gbuffer[i].diffuse() * indirect_diffuse[i] + indirect_specular[i])
}
