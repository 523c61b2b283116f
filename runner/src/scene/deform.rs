//! Deformation of meshes: morph targets and skins (glTF 2.0, 3.7.2.2 and 3.7.3). Pure functions.
//!
//! A scene's meshes hold what is drawn; here is what they were modelled as, and [`SceneDescription::bend`] makes the one of the
//! other.

use super::animation::{Pose, Track};
use super::{Primitive, SceneDescription};
use glam::{DAffine3, DMat3, DVec3, Vec3};
use rayon::prelude::*;
use shared::math::normalize_or;
use std::collections::HashSet;

/// A mesh that bends.
#[derive(Clone, Debug)]
pub struct Deformed {
    /// Index of the scene's mesh that shows it.
    pub mesh: usize,
    /// As modelled, with what bends them.
    pub rest: Vec<Primitive>,
    /// Weights of the morph targets at rest.
    pub weights: Vec<f64>,
    /// Which of the animation's [`morphs`](super::animation::Animation::morphs) changes them.
    pub morph: Option<usize>,
    /// Joints, where there are any.
    pub skin: Option<Skin>,
}

/// What bends a primitive. Attributes have one entry a vertex, or are empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bends {
    /// Morph targets.
    pub targets: Vec<Target>,
    /// One a vertex, where there is a skin.
    pub influences: Vec<Influences>,
    /// The primitive's normals are those of its triangles, which have corners of their own.
    pub flat: bool,
}

/// What a morph target adds, times its weight.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Target {
    /// m
    pub positions: Vec<Vec3>,
    /// Differences of normals.
    pub normals: Vec<Vec3>,
    /// Differences of tangents.
    pub tangents: Vec<Vec3>,
}

/// The joints that move a vertex: numbers in the skin's list, and weights whose sum is 1. None with a weight: it stays.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Influences {
    /// Indices of joints.
    pub joints: [u16; 8],
    /// Their weights; the sum is 1.
    pub weights: [f32; 8],
}

/// What holds a mesh.
#[derive(Clone, Debug)]
pub struct Skin {
    /// By index.
    pub joints: Vec<Joint>,
    /// The world's zero in the mesh's object space, m: its instance is only moved.
    pub world: DVec3,
    /// What positions of the mesh are relative to, in the space that the inverse bind matrices start from, m.
    pub offset: DVec3,
}

/// A joint of a skin.
#[derive(Clone, Copy, Debug)]
pub struct Joint {
    /// Where it is.
    pub place: JointPlace,
    /// From the mesh as modelled to the joint.
    pub inverse_bind: DAffine3,
}

/// Where a joint is.
#[derive(Clone, Copy, Debug)]
pub enum JointPlace {
    /// Joint to world.
    Resting(DAffine3),
    /// This node of the scene's animation.
    Node(usize),
}

impl SceneDescription {
    /// Bends the meshes that are `wanted` as they are at `time`, s; none: at rest.
    pub fn bend(&mut self, time: Option<f64>, wanted: impl Fn(&Deformed) -> bool) {
        let worlds = self.animation.worlds(time);
        let wanted: Vec<&Deformed> = self.deformed.iter().filter(|deformed| wanted(deformed)).collect();
        // Out of the scene, and back: meshes have lists of their own, which keep their memory.
        let meshes: Vec<_> = wanted
            .into_iter()
            .map(|deformed| (deformed, std::mem::take(&mut self.meshes[deformed.mesh].primitives)))
            .collect();
        let morphs = &self.animation.morphs;
        let bent: Vec<_> = meshes
            .into_par_iter()
            .map(|(deformed, mut primitives)| {
                deformed.bend(&mut primitives, &deformed.weights_at(time, morphs), &worlds);
                (deformed.mesh, primitives)
            })
            .collect();
        for (mesh, primitives) in bent {
            self.meshes[mesh].primitives = primitives;
        }
    }

    /// Does a mesh change its shape with time?
    pub fn bends(&self) -> bool {
        self.deformed.iter().any(Deformed::changes)
    }

    /// Meshes that `pose` bends.
    pub fn bent_meshes(&self, pose: &Pose) -> impl Iterator<Item = usize> {
        let changes = self.deformed.iter().filter(|deformed| deformed.changes());
        changes.map(|deformed| deformed.mesh).filter(|_| pose.bent.is_some())
    }

    /// Instances of meshes that `pose` bends.
    pub fn bent_instances(&self, pose: &Pose) -> impl Iterator<Item = usize> {
        let meshes: HashSet<usize> = self.bent_meshes(pose).collect();
        let instances = self.instances.iter().enumerate();
        instances.filter(move |(_, instance)| meshes.contains(&instance.mesh)).map(|(i, _)| i)
    }
}

impl Deformed {
    /// Does its shape change with time?
    pub fn changes(&self) -> bool {
        let moves = |joint: &Joint| matches!(joint.place, JointPlace::Node(_));
        self.morph.is_some() || self.skin.iter().flat_map(|skin| &skin.joints).any(moves)
    }

    /// Weights of its morph targets at `time`, s; `morphs`: the animation's.
    fn weights_at(&self, time: Option<f64>, morphs: &[Vec<Track<f64>>]) -> Vec<f64> {
        match time.zip(self.morph) {
            Some((time, morph)) => morphs[morph].iter().map(|track| track.at(time)).collect(),
            None => self.weights.clone(),
        }
    }

    /// Makes `primitives`, which it has bent before, if there are any, what they are with these `weights` of the morph targets;
    /// `worlds`: of the animation's nodes.
    fn bend(&self, primitives: &mut Vec<Primitive>, weights: &[f64], worlds: &[DAffine3]) {
        let joints = self.skin.as_ref().map(|skin| skin.matrices(worlds));
        let joints = joints.as_deref().unwrap_or_default();
        if primitives.len() != self.rest.len() {
            let plain = |rest: &Primitive| Primitive { bends: Bends::default(), ..rest.clone() };
            *primitives = self.rest.iter().map(plain).collect();
        }
        let both = self.rest.par_iter().zip(primitives);
        both.for_each(|(rest, bent)| rest.bend(bent, weights, joints));
    }
}

impl Skin {
    /// From the mesh as modelled to where each joint carries it, both in the mesh's coordinates.
    fn matrices(&self, worlds: &[DAffine3]) -> Vec<DAffine3> {
        let matrix = |joint: &Joint| {
            let world = match joint.place {
                JointPlace::Resting(world) => world,
                JointPlace::Node(node) => worlds[node],
            };
            let offset = DAffine3::from_translation(self.offset);
            DAffine3::from_translation(self.world) * world * joint.inverse_bind * offset
        };
        self.joints.iter().map(matrix).collect()
    }
}

impl Primitive {
    /// Gives `bent`, which is as this one in all else, the shape of `weights` of the morph targets and of `joints`: what each does
    /// to a vertex.
    fn bend(&self, bent: &mut Primitive, weights: &[f64], joints: &[DAffine3]) {
        let Bends { targets, influences, flat } = &self.bends;
        bent.positions.clone_from(&self.positions);
        bent.normals.clone_from(&self.normals);
        bent.tangents.clone_from(&self.tangents);
        for (target, &weight) in targets.iter().zip(weights) {
            if weight == 0.0 {
                continue;
            }
            let add =
                |to: &mut Vec3, delta: &Vec3| *to = (to.as_dvec3() + delta.as_dvec3() * weight).as_vec3();
            bent.positions.iter_mut().zip(&target.positions).for_each(|(to, delta)| add(to, delta));
            bent.normals.iter_mut().zip(&target.normals).for_each(|(to, delta)| add(to, delta));
            for (to, delta) in bent.tangents.iter_mut().zip(&target.tangents) {
                *to = (to.truncate() + *delta * weight as f32).extend(to.w);
            }
        }
        for (i, influences) in influences.iter().enumerate() {
            let Some(matrix) = influences.blend(joints) else { continue };
            bent.positions[i] = matrix.transform_point3(bent.positions[i].as_dvec3()).as_vec3();
            if let Some(normal) = bent.normals.get_mut(i) {
                // The cofactors: the inverse transpose but for its length, also of what is squeezed flat.
                *normal = (cofactors(matrix.matrix3) * normal.as_dvec3()).as_vec3();
            }
            if let Some(tangent) = bent.tangents.get_mut(i) {
                let turned = matrix.transform_vector3(tangent.truncate().as_dvec3());
                *tangent = turned.as_vec3().extend(tangent.w);
            }
        }
        if *flat {
            bent.face();
        }
        let unit = |v: Vec3, rest: Vec3| if v.is_finite() { normalize_or(v, rest) } else { rest };
        for (normal, &rest) in bent.normals.iter_mut().zip(&self.normals) {
            *normal = unit(*normal, rest);
        }
        for (tangent, &rest) in bent.tangents.iter_mut().zip(&self.tangents) {
            *tangent = unit(tangent.truncate(), rest.truncate()).extend(tangent.w);
        }
        bent.settle(self);
    }

    /// Gives each triangle, which has corners of its own, its own normal.
    pub fn face(&mut self) {
        let normals = self.positions.chunks_exact(3).map(|t| face_normal([t[0], t[1], t[2]]));
        self.normals = normals.flat_map(|normal| [normal; 3]).collect();
    }

    /// What was bent out of all numbers stays where it was at `rest`.
    fn settle(&mut self, rest: &Primitive) {
        let lost = |p: &Vec3| !p.is_finite();
        for (position, &rest) in self.positions.iter_mut().zip(&rest.positions).filter(|(p, _)| lost(p)) {
            *position = rest;
        }
    }
}

/// Unit normal of the front, counter-clockwise; computed in f64 as small triangles underflow f32.
pub fn face_normal(corners: [Vec3; 3]) -> Vec3 {
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    (b - a).cross(c - a).try_normalize().map_or(Vec3::Y, |n| n.as_vec3())
}

impl Influences {
    /// Of up to eight weights; those that are none are 0.
    pub fn new(joints: [f32; 8], weights: [f32; 8]) -> Self {
        let sound = |i: usize| weights[i].is_finite() && weights[i] > 0.0;
        let weights = std::array::from_fn(|i| if sound(i) { weights[i] } else { 0.0 });
        let sum: f32 = weights.iter().sum();
        let share = |weight: f32| if sum > 0.0 && sum.is_finite() { weight / sum } else { 0.0 };
        Influences { joints: joints.map(|joint| joint as u16), weights: weights.map(share) }
    }

    /// Linear blend; none where nothing moves the vertex.
    fn blend(&self, joints: &[DAffine3]) -> Option<DAffine3> {
        let parts = self.joints.iter().zip(&self.weights).filter(|(_, weight)| **weight > 0.0);
        let mut sum: Option<(DMat3, DVec3)> = None;
        for (&joint, &weight) in parts {
            let Some(DAffine3 { matrix3, translation }) = joints.get(usize::from(joint)) else { continue };
            let weight = f64::from(weight);
            let (matrix, moved) = sum.unwrap_or((DMat3::ZERO, DVec3::ZERO));
            sum = Some((matrix + *matrix3 * weight, moved + *translation * weight));
        }
        sum.map(|(matrix3, translation)| DAffine3 { matrix3, translation })
    }
}

fn cofactors(m: DMat3) -> DMat3 {
    let DMat3 { x_axis: x, y_axis: y, z_axis: z } = m;
    // A mirror turns the winding with the normal.
    DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y))
}

impl Bends {
    /// Replaces the vertices by those that `order` names.
    pub fn gather(&mut self, order: &[u32]) {
        fn pick<T: Copy>(values: &mut Vec<T>, order: &[u32]) {
            if !values.is_empty() {
                *values = order.iter().map(|&i| values[i as usize]).collect();
            }
        }
        pick(&mut self.influences, order);
        for target in &mut self.targets {
            pick(&mut target.positions, order);
            pick(&mut target.normals, order);
            pick(&mut target.tangents, order);
        }
    }

    /// Does nothing bend?
    pub fn is_empty(&self) -> bool {
        self.targets.is_empty() && self.influences.is_empty()
    }
}
