//! Pictures from frames: their mean, and with `--layers` what compositors and denoisers want beside it.

use crate::error::Result;
use crate::frame::renderer::Renderer;
use crate::image_io::{self, Channel};
use crate::measure::mean::Mean;
use glam::{UVec2, Vec3};
use shared::camera::Camera;
use shared::math::unpack_place;
use shared::resources::Resource;
use shared::surface::GBufferTexel;
use std::path::Path;

/// Depth where a pixel sees nothing that could be lit, m; the number that Blender writes.
pub const NOTHING: f32 = 1e10;

/// The mean of frames.
pub struct Accumulation {
    /// nit
    pub radiance: Mean,
    /// What radiance is the sum of, where layers are asked for.
    parts: Option<Parts>,
}

struct Parts {
    diffuse: Mean,
    specular: Mean,
    emission: Mean,
}

impl Accumulation {
    /// Of no frames yet. `layers`: they will be rendered in parts.
    pub fn new(size: UVec2, layers: bool) -> Self {
        let mean = || Mean::new(size);
        let parts = layers.then(|| Parts { diffuse: mean(), specular: mean(), emission: mean() });
        Accumulation { radiance: mean(), parts }
    }

    /// One more: the last frame of `renderer`.
    pub fn add(&mut self, renderer: &Renderer) -> Result<()> {
        self.radiance.add(&renderer.radiance()?);
        if let Some(parts) = &mut self.parts {
            let mut diffuse: Vec<Vec3> = renderer.read(Resource::direct_diffuse)?;
            let gbuffer = renderer.gbuffer()?;
            diffuse.iter_mut().zip(&gbuffer).for_each(|(light, texel)| *light *= texel.diffuse());
            parts.diffuse.add(&diffuse);
            parts.specular.add(&renderer.read::<Vec3>(Resource::direct_specular)?);
            parts.emission.add(&renderer.read::<Vec3>(Resource::emission)?);
        }
        Ok(())
    }

    /// Writes an .exr; its layers are the parts, and what the last frame of `renderer` saw from `camera`.
    pub fn write_exr(&self, path: &Path, renderer: &Renderer, camera: Camera) -> Result<()> {
        let (size, radiance) = (renderer.size(), self.radiance.radiance());
        let Some(parts) = &self.parts else { return image_io::write_exr(path, size, &radiance) };
        let gbuffer = renderer.gbuffer()?;
        let seen = |look: fn(&GBufferTexel) -> Vec3| -> Vec<Vec3> {
            gbuffer.iter().map(|texel| if texel.is_empty() { Vec3::ZERO } else { look(texel) }).collect()
        };
        let depth = |(i, texel): (usize, &GBufferTexel)| {
            let pixel =
                UVec2::new(i as u32 % size.x, i as u32 / size.x).as_vec2() + unpack_place(texel.place());
            let along = camera.direction(pixel, size).dot(camera.forward);
            if texel.is_empty() { NOTHING } else { texel.distance() * along }
        };
        let depth = Channel::new("depth.Z", gbuffer.iter().enumerate().map(depth).collect());
        let layers = [
            ("", "RGB", radiance),
            ("diffuse.", "RGB", parts.diffuse.radiance()),
            ("specular.", "RGB", parts.specular.radiance()),
            ("emission.", "RGB", parts.emission.radiance()),
            ("albedo.", "RGB", seen(GBufferTexel::diffuse)),
            ("f0.", "RGB", seen(GBufferTexel::f0)),
            ("normal.", "XYZ", seen(GBufferTexel::normal)),
        ];
        let channels = layers.iter().flat_map(|(layer, names, content)| {
            let channel = move |(i, name)| {
                Channel::new(&format!("{layer}{name}"), content.iter().map(|value| value[i]).collect())
            };
            names.chars().enumerate().map(channel)
        });
        image_io::write_channels(path, size, channels.chain([depth]).collect())
    }
}
