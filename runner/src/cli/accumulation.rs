//! Pictures from frames: their mean, and with `--layers` what compositors and denoisers want beside it.

use crate::error::Result;
use crate::frame::renderer::Renderer;
use crate::image_io::{self, Channel};
use crate::measure::mean::Mean;
use glam::{UVec2, Vec3};
use shared::camera::Camera;
use shared::math::luminance;
use shared::math::unpack_place;
use shared::resources::Resource;
use shared::surface::GBufferTexel;
use std::path::Path;

/// Depth where a pixel sees nothing that could be lit, m; the number that Blender writes.
pub const NOTHING: f32 = 1e10;

/// The mean of frames, and of paths that are added to them.
pub struct Accumulation {
    frames: Light,
    /// None before the first ones.
    paths: Option<Light>,
    /// Of the frames, where layers are asked for, nit.
    emission: Option<Mean>,
}

/// Means, nit.
struct Light {
    radiance: Mean,
    /// By the lobes that reflect it, where layers are asked for.
    lobes: Option<Lobes>,
}

struct Lobes {
    diffuse: Mean,
    specular: Mean,
}

impl Light {
    fn new(size: UVec2, layers: bool) -> Self {
        let mean = || Mean::new(size);
        Light { radiance: mean(), lobes: layers.then(|| Lobes { diffuse: mean(), specular: mean() }) }
    }

    /// The lobes of the last frame of `renderer`, where they are asked for: their sum.
    fn add_lobes(&mut self, renderer: &Renderer) -> Result<Option<Vec<Vec3>>> {
        let Some(lobes) = &mut self.lobes else { return Ok(None) };
        let mut diffuse: Vec<Vec3> = renderer.read(Resource::direct_diffuse)?;
        let gbuffer = renderer.gbuffer()?;
        diffuse.iter_mut().zip(&gbuffer).for_each(|(light, texel)| *light *= texel.diffuse());
        let specular: Vec<Vec3> = renderer.read(Resource::direct_specular)?;
        lobes.diffuse.add(&diffuse);
        lobes.specular.add(&specular);
        Ok(Some(sum(diffuse, &specular)))
    }
}

fn sum(mut a: Vec<Vec3>, b: &[Vec3]) -> Vec<Vec3> {
    a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
    a
}

impl Accumulation {
    /// Of no frames yet. `layers`: they will be rendered in parts.
    pub fn new(size: UVec2, layers: bool) -> Self {
        let emission = layers.then(|| Mean::new(size));
        Accumulation { frames: Light::new(size, layers), paths: None, emission }
    }

    /// One more: the last frame of `renderer`.
    pub fn add(&mut self, renderer: &Renderer) -> Result<()> {
        self.frames.radiance.add(&renderer.radiance()?);
        self.frames.add_lobes(renderer)?;
        if let Some(emission) = &mut self.emission {
            emission.add(&renderer.read::<Vec3>(Resource::emission)?);
        }
        Ok(())
    }

    /// One more path a pixel: the last frame of `renderer`, which held them alone.
    pub fn add_paths(&mut self, renderer: &Renderer) -> Result<()> {
        let layers = self.emission.is_some();
        let paths = self.paths.get_or_insert_with(|| Light::new(renderer.size(), layers));
        let radiance = match paths.add_lobes(renderer)? {
            Some(radiance) => radiance,
            None => renderer.radiance()?,
        };
        paths.radiance.add(&radiance);
        Ok(())
    }

    /// The picture, nit.
    pub fn radiance(&self) -> Vec<Vec3> {
        self.light(|light| Some(&light.radiance)).unwrap_or_default()
    }

    /// Mean of the pixels' standard errors over the mean luminance.
    pub fn relative_standard_error(&self) -> f64 {
        let mut errors = self.frames.radiance.standard_errors();
        if let Some(paths) = &self.paths {
            errors.iter_mut().zip(paths.radiance.standard_errors()).for_each(|(a, b)| *a = a.hypot(b));
        }
        let error: f64 = errors.iter().sum();
        let luminance: f64 = self.radiance().iter().map(|&c| f64::from(luminance(c))).sum();
        if luminance > 0.0 { error / luminance } else { 0.0 }
    }

    /// Of frames and paths together.
    fn light(&self, mean: impl Fn(&Light) -> Option<&Mean>) -> Option<Vec<Vec3>> {
        let frames = mean(&self.frames)?.radiance();
        Some(match self.paths.as_ref().and_then(mean) {
            Some(paths) => sum(frames, &paths.radiance()),
            None => frames,
        })
    }

    /// Writes an .exr; its layers are the parts, and what the last frame of `renderer` saw from `camera`.
    pub fn write_exr(&self, path: &Path, renderer: &Renderer, camera: Camera) -> Result<()> {
        let (size, radiance) = (renderer.size(), self.radiance());
        let lobe = |of: fn(&Lobes) -> &Mean| self.light(|light| light.lobes.as_ref().map(of));
        let layers = (lobe(|lobes| &lobes.diffuse), lobe(|lobes| &lobes.specular), &self.emission);
        let (Some(diffuse), Some(specular), Some(emission)) = layers else {
            return image_io::write_exr(path, size, &radiance);
        };
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
            ("diffuse.", "RGB", diffuse),
            ("specular.", "RGB", specular),
            ("emission.", "RGB", emission.radiance()),
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
