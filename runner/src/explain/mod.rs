//! One pixel of one frame, replayed on the CPU by the functions that the shaders are made of, and compared with what the GPU
//! computed for it.
//!
//! Each pass is replayed from the GPU's own input to it, so that differences don't add up from pass to pass. Visibility is
//! asked of every triangle, in f64. Not replayed: the primary ray's textures and normal maps (the G-buffer is taken as it is).

mod compare;
mod rays;
pub mod record;
mod replay;
mod temporal;
mod texels;
mod text;

pub use record::Explanation;

use crate::error::{Error, Result};
use crate::frame::history::History;
use crate::frame::pass::{Access, Role, Step};
use crate::frame::recorder::{FrameOptions, Recorder};
use crate::frame::schedule::Work;
use crate::gpu_scene::arrays::{SceneArrays, environment_texels};
use crate::scene::animation::Pose;
use crate::scene::{SceneDescription, lights};
use glam::{Affine3A, UVec2, Vec3};
use rays::{Hit, Occluders};
use record::{PassReport, Shading, SurfaceReport};
use replay::Replay;
use shared::alpha;
use shared::camera::Camera;
use shared::environment::EnvironmentTexel;
use shared::frame::{FrameConstants, mode};
use shared::interface::HitPayload;
use shared::light::found::Emitters;
use shared::light::tile::{TileEntry, Tiles};
use shared::light::{Light, LightTable, Lights, kind};
use shared::motion::{InstanceMotion, PastLights};
use shared::resampling::Pixels;
use shared::reservoir::StoredReservoir;
use shared::surface::GBufferTexel;
use temporal::{Before, TemporalPass};

/// A scene as the replay needs it: what the GPU has, on the CPU.
pub struct World<'a> {
    occluders: Occluders<'a>,
    lights: lights::LightTable,
    environment: Vec<EnvironmentTexel>,
    past: Option<Past>,
}

/// What of a scene was otherwise in the previous frame.
struct Past {
    /// Object to world of each of the scene's instances.
    transforms: Vec<Affine3A>,
    lights: Vec<Light>,
}

impl<'a> World<'a> {
    pub fn new(scene: &'a SceneDescription) -> Result<Self> {
        let lights = lights::LightTable::new(scene);
        let arrays = SceneArrays::new(scene, &lights)?;
        let environment = environment_texels(scene);
        Ok(World { occluders: Occluders { scene, arrays }, lights, environment, past: None })
    }

    /// Moves what `pose` moves to where `scene`, to which it was applied, has it: for the next frame, as
    /// [`crate::frame::renderer::Renderer::update_scene`] does. What was becomes the past.
    pub fn follow(&mut self, scene: &SceneDescription, pose: &Pose) {
        let arrays = &mut self.occluders.arrays;
        self.past = Some(Past { transforms: arrays.transforms.clone(), lights: self.lights.lights.clone() });
        for (i, _) in pose.instances() {
            arrays.place(i, scene.instances[i].transform);
        }
        self.lights.follow(scene, pose);
    }

    /// What has moved since the frame before, for a surface of geometry `geometry`. Its lights keep their indices.
    fn before(&self, geometry: u32) -> Option<Before<'_>> {
        let past = self.past.as_ref()?;
        let arrays = &self.occluders.arrays;
        let instance =
            (0..arrays.transforms.len()).find(|&i| arrays.geometries_of(i).contains(&(geometry as usize)))?;
        let motion = InstanceMotion::between(past.transforms[instance], arrays.transforms[instance]);
        let lights = Lights::untextured(&past.lights);
        let lights = PastLights { lights, previous_to_current: &[], current_to_previous: &[] };
        Some(Before { lights, motion, transforms: &past.transforms })
    }

    fn light_table(&self) -> LightTable<'_> {
        LightTable { lights: Lights::untextured(&self.lights.lights), alias: &self.lights.alias }
    }

    /// The light where a ray from `origin` along `direction` ends, as [`Emitters::light_at`] has it, and what it met there.
    fn light_along(&self, frame: &FrameConstants, origin: Vec3, direction: Vec3) -> (u32, Option<Hit>) {
        let met = self.occluders.surely_met(origin, direction);
        let payload = match &met {
            Some(hit) => {
                HitPayload { hit: 1, instance: hit.geometry, primitive: hit.triangle, ..Default::default() }
            }
            None => HitPayload::default(),
        };
        let instances = &self.occluders.arrays.instances;
        let emitters = Emitters::new(frame, self.features(), instances, &self.environment);
        (emitters.light_at(payload, direction), met)
    }

    fn features(&self) -> u32 {
        self.occluders.arrays.features
    }

    fn kind(&self, light: u32) -> &'static str {
        match self.lights.lights.get(light as usize).map(|light| light.kind) {
            Some(kind::POINT) => "point",
            Some(kind::TRIANGLE) => "triangle",
            Some(kind::SPOT) => "spot",
            Some(kind::DIRECTIONAL) => "directional",
            Some(kind::ENVIRONMENT) => "environment",
            _ => "none",
        }
    }
}

/// Renders the next frame of `history`, of the scene that `world` is of too, and explains `pixel` of it.
///
/// Errors: a pixel outside the picture, a frame that is no ReSTIR frame, what rendering may give.
pub fn next_frame(
    recorder: &mut Recorder,
    history: &mut History,
    world: &World<'_>,
    camera: Camera,
    options: &FrameOptions,
    pixel: UVec2,
) -> Result<Explanation> {
    check_pixel(pixel, history.size())?;
    let Work::Restir(_) = options.work else {
        return Err(Error::Usage(
            "only ReSTIR frames can be explained: the reference resamples nothing".into(),
        ));
    };
    let mut witness = Witness::new(world, pixel);
    let see = |history: &History, frame: &FrameConstants, step: &Step| witness.see(history, frame, step);
    recorder.render_stepwise(history, camera, options, see)?;
    witness.explanation(&recorder.device().info().name, history)
}

/// Errors: a pixel outside a picture of `size`.
pub fn check_pixel(pixel: UVec2, size: UVec2) -> Result<()> {
    if pixel.cmplt(size).all() {
        return Ok(());
    }
    let (last, UVec2 { x, y }) = (size - 1, pixel);
    Err(Error::Usage(format!(
        "pixel {x} {y} is outside the picture of {}x{}: X goes from 0 to {}, Y from 0 to {}",
        size.x, size.y, last.x, last.y
    )))
}

/// Follows a frame step by step.
struct Witness<'a> {
    world: &'a World<'a>,
    pixel: UVec2,
    frame: Option<FrameConstants>,
    gbuffer: Vec<GBufferTexel>,
    /// As the last step left them.
    reservoirs: Vec<StoredReservoir>,
    emission: Vec3,
    passes: Vec<PassReport>,
    shading: Option<Shading>,
}

impl<'a> Witness<'a> {
    fn new(world: &'a World<'a>, pixel: UVec2) -> Self {
        Witness {
            world,
            pixel,
            frame: None,
            gbuffer: Vec::new(),
            reservoirs: Vec::new(),
            emission: Vec3::ZERO,
            passes: Vec::new(),
            shading: None,
        }
    }

    fn see(&mut self, history: &History, frame: &FrameConstants, step: &Step) -> Result<()> {
        if step.pass.uses.contains(&(Role::GBuffer, Access::Write)) {
            self.frame = Some(*frame);
            self.gbuffer = history.read_role(step, Role::GBuffer)?;
            self.emission = self.radiance(history)?;
        }
        // Before the G-buffer is filled there is nothing to follow either.
        let Some(texel) = self.gbuffer.get(frame.pixel_index(self.pixel) as usize).filter(|t| !t.is_empty())
        else {
            return Ok(());
        };
        let replay = Replay {
            world: self.world,
            frame: *frame,
            pixel: self.pixel,
            surface: texel.unpack(&frame.camera, self.pixel, frame.size),
            gbuffer: &self.gbuffer,
        };
        let stem = step.pass.stem;
        let lanes = 0..frame.settings.reservoirs;
        let mut reports = Vec::new();
        match stem {
            "initial" | "initial_tiled" => {
                let tiled = stem == "initial_tiled";
                let entries: Vec<TileEntry> =
                    if tiled { history.read_role(step, Role::TileEntries)? } else { vec![] };
                let points: Vec<u32> =
                    if tiled { history.read_role(step, Role::TilePoints)? } else { vec![] };
                let tiles = tiled.then_some(Tiles { entries: &entries, points: &points });
                let after = history.read_role(step, Role::ReservoirsOut)?;
                reports.extend(lanes.map(|lane| replay.initial(stem, lane, tiles, &after)));
                self.reservoirs = after;
            }
            "temporal"
            | "temporal_unbiased"
            | "temporal_known"
            | "temporal_moving"
            | "temporal_unbiased_moving" => {
                let before = if stem.ends_with("_moving") { self.world.before(texel.instance) } else { None };
                let gbuffer: Vec<GBufferTexel> = history.read_role(step, Role::PreviousGBuffer)?;
                let ended: Vec<StoredReservoir> = history.read_role(step, Role::ReservoirsHistory)?;
                let previous = Pixels { gbuffer: &gbuffer, reservoirs: &ended };
                let after: Vec<_> = history.read_role(step, Role::ReservoirsOut)?;
                reports.extend(lanes.map(|lane| {
                    let pass = TemporalPass { stem, lane, previous, before };
                    pass.replay(&replay, &self.reservoirs, &after)
                }));
                self.reservoirs = after;
            }
            "spatial" | "spatial_unbiased" => {
                let before: Vec<_> = history.read_role(step, Role::ReservoirsIn)?;
                let after: Vec<_> = history.read_role(step, Role::ReservoirsOut)?;
                let iteration = step.constants.iteration;
                reports.extend(lanes.map(|lane| replay.spatial(stem, iteration, lane, &before, &after)));
            }
            "pair_merge" => {
                let before: Vec<_> = history.read_role(step, Role::ReservoirsIn)?;
                let after: Vec<_> = history.read_role(step, Role::ReservoirsOut)?;
                let iteration = step.constants.iteration;
                reports.extend(lanes.map(|lane| replay.pair_merge(stem, iteration, lane, &before, &after)));
            }
            "shade" | "shade_known" => {
                let before: Vec<_> = history.read_role(step, Role::ReservoirsIn)?;
                self.shading = Some(replay.shade(&before, self.emission, self.radiance(history)?));
            }
            _ => {}
        }
        self.passes.extend(reports);
        Ok(())
    }

    fn radiance(&self, history: &History) -> Result<Vec3> {
        Ok(history.radiance()?[(self.pixel.y * history.size().x + self.pixel.x) as usize])
    }

    fn explanation(self, device: &str, history: &History) -> Result<Explanation> {
        let radiance = self.radiance(history)?.to_array();
        let Some(frame) = self.frame else {
            return Err(Error::Internal("the frame has no G-buffer pass: nothing to explain".into()));
        };
        let seen = self.seen(&frame);
        let texel = self.gbuffer[frame.pixel_index(self.pixel) as usize];
        let surface = (!texel.is_empty()).then(|| self.surface(&frame, texel, seen.as_ref()));
        Ok(Explanation {
            device: device.into(),
            scene: self.world.occluders.scene.name.clone(),
            pixel: self.pixel.to_array(),
            size: frame.size.to_array(),
            frame: frame.index,
            seed: frame.seed,
            mode: if frame.settings.mode == mode::BIASED { "biased" } else { "unbiased" },
            lights: self.world.lights.lights.len() as u32,
            seen,
            surface,
            emission: self.emission.to_array(),
            passes: self.passes,
            shading: self.shading,
            radiance,
        })
    }

    fn seen(&self, frame: &FrameConstants) -> Option<Hit> {
        let direction = frame.camera.direction(self.pixel.as_vec2() + 0.5, frame.size);
        let key = alpha::primary_key(frame, self.pixel);
        self.world.occluders.seen(frame.camera.position, direction, key)
    }

    fn surface(&self, frame: &FrameConstants, texel: GBufferTexel, seen: Option<&Hit>) -> SurfaceReport {
        let surface = texel.unpack(&frame.camera, self.pixel, frame.size);
        let same = seen.filter(|hit| hit.geometry == texel.instance);
        SurfaceReport {
            position: surface.position.to_array(),
            distance: surface.distance,
            distance_ulps: same.map(|hit| compare::ulps(hit.t as f32, surface.distance)),
            geometric_normal: surface.geometric_normal.to_array(),
            normal: surface.normal.to_array(),
            diffuse: surface.reflectance.diffuse.to_array(),
            f0: surface.reflectance.f0.to_array(),
            roughness: surface.reflectance.roughness,
        }
    }
}
