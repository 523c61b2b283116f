//! Animation: moving nodes, their curves, and their poses at a time. Pure functions.
//!
//! Interpolation follows glTF 2.0, appendix C, in f64.

use super::deform::Deformed;
use super::{Bounds, SceneDescription};
use glam::{DAffine3, DQuat, DVec3, DVec4, Vec3};

/// The part of a scene's hierarchy that moves. Default: nothing does.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Animation {
    /// Nodes that move by themselves or with a parent; parents come before their children.
    pub nodes: Vec<Node>,
    /// At most one for each node and property.
    pub channels: Vec<Channel>,
    /// What hangs on which node.
    pub attached: Vec<(Thing, usize)>,
    /// Weights of morph targets: of each mesh that has such a motion, a track a target.
    pub morphs: Vec<Vec<Track<f64>>>,
}

/// One node of the hierarchy.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// Index of a node before this one.
    pub parent: Option<usize>,
    /// Of a node without a moving parent: its resting parent's place in the world.
    pub base: DAffine3,
    /// Relative to its parent, while no channel says otherwise.
    pub rest: Local,
}

/// Where a node stands relative to its parent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Local {
    /// A transform that no channel changes.
    Matrix(DAffine3),
    /// glTF's T R S. The only form that channels can change.
    Trs {
        /// m
        translation: DVec3,
        /// Unit.
        rotation: DQuat,
        /// Along the axes.
        scale: DVec3,
    },
}

/// Something of a scene that can hang on a node, by its index in the scene's list of such things.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Thing {
    /// Of [`SceneDescription::instances`].
    Instance(usize),
    /// Of [`SceneDescription::lights`].
    Light(usize),
    /// Of [`SceneDescription::cameras`].
    Camera(usize),
}

/// A curve and the node it moves.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Index into [`Animation::nodes`].
    pub node: usize,
    /// How it moves.
    pub curve: Curve,
}

/// A property over time.
#[derive(Clone, Debug, PartialEq)]
pub enum Curve {
    /// m
    Translation(Track<DVec3>),
    /// Quaternions as x, y, z, w.
    Rotation(Track<DVec4>),
    /// Factors along the axes.
    Scale(Track<DVec3>),
}

/// Values at times. Before the first and after the last time, theirs hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Track<T> {
    /// Between times.
    pub interpolation: Interpolation,
    /// s, increasing, at least one.
    pub times: Vec<f32>,
    /// One a time; with cubic splines three: in-tangent, value, out-tangent.
    pub values: Vec<T>,
}

/// How values between two times follow from those at them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// The earlier one.
    Step,
    /// Of rotations spherical.
    Linear,
    /// Hermite splines (glTF 2.0, appendix C.5).
    CubicSpline,
}

/// What stands where in the world at one time: all that moves, and nothing else.
///
/// A program that moves things itself fills it in, applies it to the scene, and tells the renderer:
///
/// ```
/// use candela::scene::animation::{Pose, Thing};
/// use candela::scene::{Illumination, SceneSource, load};
/// use candela::shared::glam::{DAffine3, DVec3, Vec3};
///
/// let mut scene = load(&SceneSource::Knot, &Illumination::points(2))?;
/// let above = DAffine3::from_translation(DVec3::new(0.0, 2.0, 0.0));
/// let pose = Pose { places: vec![(Thing::Light(0), above)], bent: None };
/// scene.apply(&pose); // then: renderer.update_scene(&scene, &pose)?;
/// assert_eq!(scene.lights[0].position(), Some(Vec3::new(0.0, 2.0, 0.0)));
/// # Ok::<(), candela::error::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pose {
    /// Object to world of each thing that moves.
    pub places: Vec<(Thing, DAffine3)>,
    /// When the meshes that change their shape have the one that is shown, s; none: no mesh does.
    pub bent: Option<f64>,
}

/// Times at which [`Animation::swept`] looks.
const SWEEP: u32 = 256;

impl Animation {
    /// s; 0 where nothing moves.
    pub fn duration(&self) -> f32 {
        let morphs = self.morphs.iter().flatten().filter_map(|track| track.times.last().copied());
        self.channels.iter().filter_map(Channel::end).chain(morphs).fold(0.0, f32::max)
    }

    /// Does anything have another place but cameras?
    pub fn moves_things(&self) -> bool {
        self.attached.iter().any(|(thing, _)| !matches!(thing, Thing::Camera(_)))
    }

    /// Does `thing` move?
    pub fn moves(&self, thing: Thing) -> bool {
        self.attached.iter().any(|&(attached, _)| attached == thing)
    }

    /// Where everything is at `time` (s).
    pub fn pose(&self, time: f64) -> Pose {
        let worlds = self.worlds(Some(time));
        let places = self.attached.iter().map(|&(thing, node)| (thing, worlds[node])).collect();
        Pose { places, bent: None }
    }

    /// Node to world of every node at `time` (s); none: at rest.
    pub fn worlds(&self, time: Option<f64>) -> Vec<DAffine3> {
        let mut locals: Vec<Local> = self.nodes.iter().map(|node| node.rest).collect();
        for channel in self.channels.iter().filter(|_| time.is_some()) {
            channel.curve.apply(time.unwrap_or_default(), &mut locals[channel.node]);
        }
        let mut worlds: Vec<DAffine3> = Vec::with_capacity(locals.len());
        for (node, local) in self.nodes.iter().zip(&locals) {
            let parent = node.parent.map_or(node.base, |parent| worlds[parent]);
            worlds.push(parent * local.affine());
        }
        worlds
    }

    /// Box around all places that moving instances of `scene` reach, as seen at [`SWEEP`] times; empty where none moves.
    pub fn swept(&self, scene: &SceneDescription) -> Bounds {
        let mut bounds = Bounds::default();
        if !self.attached.iter().any(|(thing, _)| matches!(thing, Thing::Instance(_))) {
            return bounds;
        }
        let boxes: Vec<Bounds> = scene.meshes.iter().map(super::Mesh::bounds).collect();
        for i in 0..SWEEP {
            let time = f64::from(self.duration()) * f64::from(i) / f64::from(SWEEP - 1);
            for (instance, world) in self.pose(time).instances() {
                for corner in boxes[scene.instances[instance].mesh].corners() {
                    bounds.add(world.transform_point3(corner).as_vec3());
                }
            }
        }
        bounds
    }
}

impl Pose {
    /// Instances by index, object to world.
    pub fn instances(&self) -> impl Iterator<Item = (usize, DAffine3)> + '_ {
        self.places.iter().filter_map(|&(thing, world)| match thing {
            Thing::Instance(i) => Some((i, world)),
            _ => None,
        })
    }
}

impl SceneDescription {
    /// Where what moves is at `time` (s); see [`SceneDescription::apply`].
    pub fn pose(&self, time: f64) -> Pose {
        Pose { bent: self.bends().then_some(time), ..self.animation.pose(time) }
    }

    /// Does anything change but cameras? Only then does the device need to know the past.
    pub fn changes(&self) -> bool {
        self.animation.moves_things() || self.bends()
    }

    /// Puts everything where `pose` says, and bends what it bends. What has lost its direction (scaled to nothing) keeps the one it
    /// had.
    pub fn apply(&mut self, pose: &Pose) {
        if let Some(time) = pose.bent {
            self.bend(Some(time), Deformed::changes);
        }
        for &(thing, world) in &pose.places {
            match thing {
                Thing::Instance(i) => self.instances[i].transform = world.as_affine3a(),
                Thing::Light(i) => self.lights[i].place(&world),
                Thing::Camera(i) => {
                    self.cameras[i].position = world.translation.as_vec3();
                    if let Some((forward, up)) = view_axes(&world) {
                        (self.cameras[i].forward, self.cameras[i].up) = (forward, up);
                    }
                }
            }
        }
    }
}

/// (forward, up) of a camera at `world`, unit; none if it is scaled to nothing.
pub fn view_axes(world: &DAffine3) -> Option<(Vec3, Vec3)> {
    let forward = -world.matrix3.z_axis.normalize_or_zero();
    let up = world.matrix3.y_axis;
    let up = (up - forward * forward.dot(up)).normalize_or_zero();
    (forward != DVec3::ZERO && up != DVec3::ZERO).then(|| (forward.as_vec3(), up.as_vec3()))
}

impl Local {
    /// As one transform.
    pub fn affine(&self) -> DAffine3 {
        match *self {
            Local::Matrix(affine) => affine,
            Local::Trs { translation, rotation, scale } => {
                DAffine3::from_scale_rotation_translation(scale, rotation, translation)
            }
        }
    }
}

impl Channel {
    fn end(&self) -> Option<f32> {
        let (Curve::Translation(Track { times, .. })
        | Curve::Rotation(Track { times, .. })
        | Curve::Scale(Track { times, .. })) = &self.curve;
        times.last().copied()
    }
}

impl Curve {
    fn apply(&self, time: f64, local: &mut Local) {
        let Local::Trs { translation, rotation, scale } = local else { return };
        match self {
            Curve::Translation(track) => *translation = track.at(time),
            Curve::Scale(track) => *scale = track.at(time),
            // Splines leave the unit sphere.
            Curve::Rotation(track) => *rotation = DQuat::from_vec4(track.at(time).normalize_or(DVec4::W)),
        }
    }
}

/// What a [`Track`] interpolates.
pub trait Value: Copy + std::ops::Add<Output = Self> + std::ops::Mul<f64, Output = Self> {
    /// From `a` (t = 0) to `b` (t = 1).
    fn between(a: Self, b: Self, t: f64) -> Self;
}

impl Value for f64 {
    fn between(a: Self, b: Self, t: f64) -> Self {
        a + (b - a) * t
    }
}

impl Value for DVec3 {
    fn between(a: Self, b: Self, t: f64) -> Self {
        a.lerp(b, t)
    }
}

impl Value for DVec4 {
    /// Spherical, the shorter way round (appendix C.4).
    fn between(a: Self, b: Self, t: f64) -> Self {
        let cos = a.dot(b);
        let b = if cos < 0.0 { -b } else { b };
        let angle = cos.abs().min(1.0).acos();
        // The chord is the arc to within 1e-13 there.
        if angle < 1e-6 {
            return a.lerp(b, t);
        }
        (a * (angle * (1.0 - t)).sin() + b * (angle * t).sin()) / angle.sin()
    }
}

impl<T: Value> Track<T> {
    /// The value at `time`, s.
    pub fn at(&self, time: f64) -> T {
        let value = |key: usize| match self.interpolation {
            Interpolation::CubicSpline => self.values[3 * key + 1],
            _ => self.values[key],
        };
        let after = self.times.partition_point(|&key| f64::from(key) <= time);
        if after == 0 || after == self.times.len() {
            return value(after.saturating_sub(1));
        }
        let key = after - 1;
        let (start, end) = (f64::from(self.times[key]), f64::from(self.times[after]));
        let (length, t) = (end - start, (time - start) / (end - start));
        match self.interpolation {
            Interpolation::Step => value(key),
            Interpolation::Linear => T::between(value(key), value(after), t),
            Interpolation::CubicSpline => {
                // Appendix C.5.
                let (out_tangent, in_tangent) = (self.values[3 * key + 2], self.values[3 * after]);
                let (t2, t3) = (t * t, t * t * t);
                value(key) * (2.0 * t3 - 3.0 * t2 + 1.0)
                    + out_tangent * (length * (t3 - 2.0 * t2 + t))
                    + value(after) * (-2.0 * t3 + 3.0 * t2)
                    + in_tangent * (length * (t3 - t2))
            }
        }
    }
}

#[cfg(test)]
#[path = "animation_tests.rs"]
mod tests;
