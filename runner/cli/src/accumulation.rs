//! Pictures from frames: their mean, and with `--layers` the layers for compositors and denoisers.

use candela::error::Result;
use candela::frame::renderer::Renderer;
use candela::image_io::{self, Channel, PictureFormat};
use candela_lab::measure::mean::Mean;
use glam::{UVec2, Vec3};
use shared::camera::Camera;
use shared::math::{luminance, unpack_place};
use shared::motion::InstanceMotion;
use shared::resources::Resource;
use shared::surface::GBufferTexel;

/// Depth where a pixel sees nothing that could be lit, m; the number that Blender writes.
pub const NOTHING: f32 = 1e10;

/// The mean of frames, and of paths that are added to them.
pub struct Accumulation {
    frames: Mean,
    /// None before the first ones.
    paths: Option<Mean>,
    /// Where they are asked for.
    layers: Option<Layers>,
}

/// Means of light by where it comes from, nit.
struct Layers {
    emission: Mean,
    direct: Lobes,
    /// None without light that bounces.
    indirect: Option<Lobes>,
    /// What pixels saw: of frames through other places in each pixel it is antialiased as the light is.
    seen: [Mean; SEEN.len()],
}

/// A layer of what a pixel sees: name, its parts, and what it is of a surface.
type SeenLayer = (&'static str, &'static str, fn(&GBufferTexel) -> Vec3);

const SEEN: [SeenLayer; 3] = [
    ("albedo.", "RGB", GBufferTexel::diffuse),
    ("f0.", "RGB", GBufferTexel::f0),
    ("normal.", "XYZ", GBufferTexel::normal),
];

/// Where a frame saw things that the frame after it sees elsewhere.
pub struct Before {
    pub camera: Camera,
    /// The way back of each geometry to that frame; those beyond the end stood still.
    pub motions: Vec<InstanceMotion>,
}

/// Light by the lobes that reflect it.
struct Lobes {
    diffuse: Mean,
    specular: Mean,
}

impl Lobes {
    fn new(size: UVec2) -> Self {
        Lobes { diffuse: Mean::new(size), specular: Mean::new(size) }
    }

    /// One more: these two, the one under an albedo of 1, of the last frame of `renderer`. Gives their sum.
    fn add(&mut self, renderer: &Renderer, diffuse: Resource, specular: Resource) -> Result<Vec<Vec3>> {
        let mut diffuse: Vec<Vec3> = renderer.read(diffuse)?;
        let gbuffer = renderer.gbuffer()?;
        diffuse.iter_mut().zip(&gbuffer).for_each(|(light, texel)| *light *= texel.diffuse());
        let specular: Vec<Vec3> = renderer.read(specular)?;
        self.diffuse.add(&diffuse);
        self.specular.add(&specular);
        Ok(sum(diffuse, &specular))
    }
}

fn sum(mut a: Vec<Vec3>, b: &[Vec3]) -> Vec<Vec3> {
    a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
    a
}

impl Accumulation {
    /// Of no frames yet. `layers`: they will be rendered in parts.
    pub fn new(size: UVec2, layers: bool) -> Self {
        let empty = || Layers {
            emission: Mean::new(size),
            direct: Lobes::new(size),
            indirect: None,
            seen: SEEN.map(|_| Mean::new(size)),
        };
        Accumulation { frames: Mean::new(size), paths: None, layers: layers.then(empty) }
    }

    /// One more: the last frame of `renderer`.
    pub fn add(&mut self, renderer: &Renderer) -> Result<()> {
        self.frames.add(&renderer.radiance()?);
        let Some(layers) = &mut self.layers else { return Ok(()) };
        layers.emission.add(&renderer.read::<Vec3>(Resource::emission)?);
        layers.direct.add(renderer, Resource::direct_diffuse, Resource::direct_specular)?;
        let gbuffer = renderer.gbuffer()?;
        for (mean, (_, _, look)) in layers.seen.iter_mut().zip(SEEN) {
            let look = |texel: &GBufferTexel| if texel.is_empty() { Vec3::ZERO } else { look(texel) };
            mean.add(&gbuffer.iter().map(look).collect::<Vec<_>>());
        }
        if renderer.has_paths() {
            let indirect = layers.indirect.get_or_insert_with(|| Lobes::new(renderer.size()));
            indirect.add(renderer, Resource::indirect_diffuse, Resource::indirect_specular)?;
        }
        Ok(())
    }

    /// One more path a pixel: the last frame of `renderer`, which held them alone.
    pub fn add_paths(&mut self, renderer: &Renderer) -> Result<()> {
        let radiance = match &mut self.layers {
            Some(layers) => {
                let indirect = layers.indirect.get_or_insert_with(|| Lobes::new(renderer.size()));
                indirect.add(renderer, Resource::direct_diffuse, Resource::direct_specular)?
            }
            None => renderer.radiance()?,
        };
        self.paths.get_or_insert_with(|| Mean::new(renderer.size())).add(&radiance);
        Ok(())
    }

    /// The picture, nit.
    pub fn radiance(&self) -> Vec<Vec3> {
        let frames = self.frames.radiance();
        match &self.paths {
            Some(paths) => sum(frames, &paths.radiance()),
            None => frames,
        }
    }

    /// Of each pixel's luminance, nit.
    fn standard_errors(&self) -> Vec<f64> {
        let mut errors = self.frames.standard_errors();
        if let Some(paths) = &self.paths {
            errors.iter_mut().zip(paths.standard_errors()).for_each(|(a, b)| *a = a.hypot(b));
        }
        errors
    }

    /// Of each pixel's mean luminance, nit², as if frames were independent.
    fn variances(&self) -> Vec<f32> {
        self.standard_errors().iter().map(|error| (error * error) as f32).collect()
    }

    /// Mean of the pixels' standard errors over the mean luminance.
    pub fn relative_standard_error(&self) -> f64 {
        let error: f64 = self.standard_errors().iter().sum();
        let luminance: f64 = self.radiance().iter().map(|&c| f64::from(luminance(c))).sum();
        if luminance > 0.0 { error / luminance } else { 0.0 }
    }

    /// The picture, with layers where they are asked for: the parts, and what the last frame of `renderer` saw from `camera`; `before`:
    /// the frame before it, if there was one.
    pub fn content(&self, renderer: &Renderer, camera: Camera, before: Option<&Before>) -> Result<Content> {
        let (size, radiance) = (renderer.size(), self.radiance());
        let Some(Layers { emission, direct, indirect, seen }) = &self.layers else {
            return Ok(Content::new(size, radiance));
        };
        let (mut diffuse, mut specular) = (direct.diffuse.radiance(), direct.specular.radiance());
        let mut bounced = Vec::new();
        if let Some(lobes) = indirect {
            diffuse = sum(diffuse, &lobes.diffuse.radiance());
            specular = sum(specular, &lobes.specular.radiance());
            bounced.push(("indirect.", "RGB", sum(lobes.diffuse.radiance(), &lobes.specular.radiance())));
        }
        let gbuffer = renderer.gbuffer()?;
        let place = |i: usize, texel: &GBufferTexel| {
            UVec2::new(i as u32 % size.x, i as u32 / size.x).as_vec2() + unpack_place(texel.place())
        };
        let depth = |(i, texel): (usize, &GBufferTexel)| {
            let along = camera.direction(place(i, texel), size).dot(camera.forward);
            if texel.is_empty() { NOTHING } else { texel.distance() * along }
        };
        let depth = Channel::new("depth.Z", gbuffer.iter().enumerate().map(depth).collect());
        let motion = |(i, texel): (usize, &GBufferTexel)| {
            let (Some(before), false) = (before, texel.is_empty()) else { return Vec3::ZERO };
            let at = place(i, texel);
            let way = camera.direction(at, size) * texel.distance();
            let back = before.motions.get(texel.instance() as usize).copied().unwrap_or_default();
            let moved = camera.position - before.camera.position + back.displacement(camera.position + way);
            (before.camera.project(way + moved, size) - at).extend(0.0)
        };
        let motion = gbuffer.iter().enumerate().map(motion).collect::<Vec<_>>();
        let variance = (self.frames.count() > 1).then(|| Channel::new("variance.Y", self.variances()));
        let layers = [
            ("diffuse.", "RGB", diffuse),
            ("specular.", "RGB", specular),
            ("emission.", "RGB", emission.radiance()),
            ("motion.", "XY", motion),
        ];
        let seen = SEEN.iter().zip(seen).map(|((name, parts, _), mean)| (*name, *parts, mean.radiance()));
        let layers: Vec<_> = layers.into_iter().chain(bounced).chain(seen).collect();
        let layers = layers.iter();
        let channels = layers.flat_map(|(layer, names, content)| channels(layer, names, content));
        Ok(Content { size, radiance, layers: channels.chain([depth]).chain(variance).collect() })
    }
}

/// A number of each pixel for each of `names`, of a layer.
fn channels(layer: &str, names: &str, content: &[Vec3]) -> impl Iterator<Item = Channel> {
    let channel = |(i, name)| {
        Channel::new(&format!("{layer}{name}"), content.iter().map(|value: &Vec3| value[i]).collect())
    };
    names.chars().enumerate().map(channel).collect::<Vec<_>>().into_iter()
}

/// What will be a picture's file.
pub struct Content {
    size: UVec2,
    /// nit
    radiance: Vec<Vec3>,
    layers: Vec<Channel>,
}

impl Content {
    /// Without layers.
    pub fn new(size: UVec2, radiance: Vec<Vec3>) -> Self {
        Content { size, radiance, layers: Vec::new() }
    }

    /// What the last frame of `renderer` saw from `camera`. `before`: the frame before it, if there was one. `layers`: it was rendered
    /// in parts.
    pub fn of_frame(
        renderer: &Renderer,
        camera: Camera,
        before: Option<&Before>,
        layers: bool,
    ) -> Result<Self> {
        if !layers {
            return Ok(Content::new(renderer.size(), renderer.radiance()?));
        }
        let mut frame = Accumulation::new(renderer.size(), layers);
        frame.add(renderer)?;
        frame.content(renderer, camera, before)
    }

    /// Rows from the top, nit.
    pub fn radiance(&self) -> &[Vec3] {
        &self.radiance
    }

    /// The file. `exposure`: factor to display values, where the format has such.
    pub fn encode(self, format: PictureFormat, exposure: f32) -> Result<Vec<u8>> {
        match format {
            PictureFormat::Exr if self.layers.is_empty() => image_io::encode_exr(self.size, &self.radiance),
            PictureFormat::Exr => {
                let picture = channels("", "RGB", &self.radiance);
                image_io::encode_channels(self.size, picture.chain(self.layers).collect())
            }
            PictureFormat::Png => image_io::encode_tone_mapped(self.size, &self.radiance, exposure),
        }
    }
}
