//! One pixel of one frame, replayed on the CPU by the bodies of its passes, and compared with the GPU's result.
//!
//! Each body runs from the GPU's own input to it, so that differences don't add up from pass to pass. Visibility is
//! asked of every triangle, in f64. Not replayed: light that bounces, and the primary ray's textures and normal maps (the G-buffer is taken as it is).

pub mod compare;
mod heard;
mod rays;
pub mod record;
mod replay;
mod texels;
mod text;

pub use record::Explanation;

use candela::error::{Error, Result};
use candela::frame::follow::{Follower, Ran};
use candela::frame::history::History;
use candela::frame::pass::Step;
use candela::frame::recorder::{FrameOptions, Recorder};
use candela::frame::schedule::Work;
use candela::gpu_scene::arrays::{SceneArrays, environment_texels};
use candela::scene::animation::Pose;
use candela::scene::{SceneDescription, lights};
use glam::{Affine3A, UVec2, Vec3};
use rays::{Hit, Occluders, Places};
use record::{PassReport, Shading, SurfaceReport, Survivor};
use replay::Replay;
use shared::alpha;
use shared::camera::Camera;
use shared::environment::EnvironmentTexel;
use shared::frame::{FrameConstants, mode};
use shared::light::tree::{self, Tree};
use shared::light::{KINDS, Light};
use shared::math::unpack_place;
use shared::motion::InstanceMotion;
use shared::passes::Body;
use shared::passes::points::is_listed;
use shared::reservoir::StoredReservoir;
use shared::resources::{Binding, Buffers};
use shared::shadow::ShadowRay;
use shared::surface::GBufferTexel;

/// A scene as the replay needs it: what the GPU has, on the CPU.
pub struct World<'a> {
    occluders: Occluders<'a>,
    lights: lights::LightTable,
    /// As the device makes it once; lights that move after that stay where they were in it.
    tree: Tree,
    environment: Vec<EnvironmentTexel>,
    past: Option<Past>,
}

/// What of a scene was otherwise in the previous frame.
struct Past {
    /// Object to world of each of the scene's instances.
    transforms: Vec<Affine3A>,
    /// Object space, m; none: as they are now.
    positions: Option<Vec<Vec3>>,
    lights: Vec<Light>,
    /// Of each instance geometry.
    motions: Vec<InstanceMotion>,
}

impl<'a> World<'a> {
    pub fn new(scene: &'a SceneDescription) -> Result<Self> {
        let lights = lights::LightTable::new(scene);
        let arrays = SceneArrays::new(scene, &lights)?;
        let environment = environment_texels(scene);
        let tree = tree::build(&lights.lights);
        Ok(World { occluders: Occluders { scene, arrays }, lights, tree, environment, past: None })
    }

    /// Moves what `pose` moves to where `scene`, to which it was applied, has it: for the next frame, as
    /// [`candela::frame::renderer::Renderer::update_scene`] does. What was becomes the past.
    pub fn follow(&mut self, scene: &SceneDescription, pose: &Pose) {
        let arrays = &mut self.occluders.arrays;
        let (transforms, lights) = (arrays.transforms.clone(), self.lights.lights.clone());
        for (i, _) in pose.instances() {
            arrays.place(i, scene.instances[i].transform);
        }
        let positions = pose.bent.map(|_| arrays.positions.clone());
        arrays.bend(scene, pose);
        self.lights.follow(scene, pose);
        let mut motions = vec![InstanceMotion::default(); arrays.instances.len()];
        for (i, &before) in transforms.iter().enumerate() {
            motions[arrays.geometries_of(i)].fill(InstanceMotion::between(before, arrays.transforms[i]));
        }
        self.past = Some(Past { transforms, positions, lights, motions });
    }

    /// Sets 0 and 2, as far as bodies read them. Lights keep their indices.
    fn buffers(&self) -> Buffers<'_> {
        let past = self.past.as_ref();
        Buffers {
            lights: &self.lights.lights,
            alias: &self.lights.alias,
            tree_nodes: &self.tree.nodes,
            tree_lights: &self.tree.lights,
            tree_leaves: &self.tree.leaves,
            instances: &self.occluders.arrays.instances,
            environment: &self.environment,
            previous_lights: past.map_or(&[], |past| &past.lights),
            motions: past.map_or(&[], |past| &past.motions),
            ..Buffers::default()
        }
    }

    /// What lies between the ends of `ray`; `before`: in the previous frame.
    fn blocker(&self, ray: ShadowRay, key: u32, before: bool) -> Option<Hit> {
        let now = self.occluders.places();
        let places = self.past.as_ref().filter(|_| before).map_or(now, |past| Places {
            transforms: &past.transforms,
            positions: past.positions.as_deref().unwrap_or(now.positions),
        });
        self.occluders.blocker(places, ray, key)
    }

    /// What a BSDF ray meets.
    fn surely_met(&self, origin: Vec3, direction: Vec3) -> Option<Hit> {
        self.occluders.surely_met(origin, direction)
    }

    fn survivor(&self, reservoir: StoredReservoir) -> Survivor {
        let light = (reservoir.contribution_weight > 0.0).then_some(reservoir.sample.light);
        Survivor {
            light,
            kind: light.map_or("", |light| self.kind(light)),
            uv: reservoir.sample.uv,
            contribution_weight: reservoir.contribution_weight,
            confidence: reservoir.confidence,
        }
    }

    fn features(&self) -> u32 {
        self.occluders.arrays.features
    }

    fn kind(&self, light: u32) -> &'static str {
        let kind = self.lights.lights.get(light as usize).map(|light| light.kind as usize);
        kind.map_or("none", |kind| KINDS[kind].name)
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
            "only ReSTIR frames can be explained: the reference does not resample".into(),
        ));
    };
    // Radiance is explained as a whole.
    let options = &FrameOptions { parts: false, denoise: false, ..*options };
    let mut explainer = Explainer::new(world, pixel);
    let see = |history: &History, frame: &FrameConstants, step: &Step| explainer.see(history, frame, step);
    recorder.render_stepwise(history, camera, options, see)?;
    explainer.explanation(&recorder.device().info().name, history)
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
struct Explainer<'a> {
    world: &'a World<'a>,
    pixel: UVec2,
    follower: Follower,
    frame: Option<FrameConstants>,
    /// The pass that tells pixels of their partners.
    pairs: Option<Ran>,
    texel: GBufferTexel,
    emission: Vec3,
    passes: Vec<PassReport>,
    shading: Option<Shading>,
    indirect: Option<Vec3>,
}

impl<'a> Explainer<'a> {
    fn new(world: &'a World<'a>, pixel: UVec2) -> Self {
        Explainer {
            world,
            pixel,
            follower: Follower::default(),
            frame: None,
            pairs: None,
            texel: GBufferTexel::default(),
            emission: Vec3::ZERO,
            passes: Vec::new(),
            shading: None,
            indirect: None,
        }
    }

    fn see(&mut self, history: &History, frame: &FrameConstants, step: &Step) -> Result<()> {
        let ran = self.follower.see(history, frame, step)?;
        if step.writes(Binding::gbuffer) {
            self.frame = Some(*frame);
            self.texel = ran.left::<GBufferTexel>(Binding::gbuffer)[frame.pixel_index(self.pixel) as usize];
            self.emission = self.radiance(history)?;
        }
        if self.texel.is_empty() {
            return Ok(());
        }
        let scene = self.world.buffers();
        let mut replay =
            Replay { world: self.world, buffers: ran.buffers(&scene), ran: &ran, pixel: self.pixel };
        let lanes = 0..frame.settings.reservoirs;
        match ran.pass.body() {
            Body::initial | Body::initial_met | Body::temporal | Body::spatial => {
                self.passes.extend(lanes.map(|lane| replay.reservoir(lane, None)));
            }
            Body::temporal_hops if is_listed(replay.buffers.hops, self.pixel) => {
                // The pass over points that are kept has left it alone.
                self.passes.truncate(self.passes.len() - lanes.len());
                self.passes.extend(lanes.map(|lane| replay.reservoir(lane, None)));
            }
            Body::pair_targets => self.pairs = Some(ran),
            Body::pair_merge => {
                if let Some(pairs) = &self.pairs {
                    let pairs = Replay { buffers: pairs.buffers(&scene), ran: pairs, ..replay };
                    replay.buffers.gbuffer = pairs.buffers.gbuffer;
                    self.passes.extend(lanes.map(|lane| replay.reservoir(lane, Some(&pairs))));
                }
            }
            Body::shade => self.shading = Some(replay.shading()),
            Body::indirect_shade => {
                let index = frame.pixel_index(self.pixel) as usize;
                self.indirect = Some(self.radiance(history)? - replay.buffers.radiance[index]);
            }
            _ => {}
        }
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
        let surface = (!self.texel.is_empty()).then(|| self.surface(&frame, self.texel, seen.as_ref()));
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
            indirect: self.indirect.map(|light| light.to_array()),
            radiance,
        })
    }

    fn seen(&self, frame: &FrameConstants) -> Option<Hit> {
        let direction =
            frame.camera.direction(self.pixel.as_vec2() + unpack_place(self.texel.place()), frame.size);
        let key = alpha::primary_key(frame, self.pixel);
        self.world.occluders.seen(frame.camera.position, direction, key)
    }

    fn surface(&self, frame: &FrameConstants, texel: GBufferTexel, seen: Option<&Hit>) -> SurfaceReport {
        let surface = texel.unpack(u32::MAX, &frame.camera, self.pixel, frame.size);
        let same = seen.filter(|hit| hit.geometry == texel.instance());
        SurfaceReport {
            position: surface.position.to_array(),
            distance: surface.distance,
            lift: texel.lift(),
            distance_ulps: same.map(|hit| compare::ulps(hit.t as f32, surface.distance)),
            geometric_normal: surface.geometric_normal.to_array(),
            normal: surface.normal.to_array(),
            diffuse: surface.reflectance.diffuse.to_array(),
            f0: surface.reflectance.f0.to_array(),
            roughness: surface.reflectance.roughness,
        }
    }
}
