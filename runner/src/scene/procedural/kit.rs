//! Collects meshes and instances of a generated scene.

use super::shapes::Shape;
use crate::scene::{Instance, Mesh, SceneDescription};
use glam::{Affine3A, Quat, Vec3};
use std::collections::BTreeMap;

/// A material of a generated scene.
pub trait Finish: Copy + Ord {
    /// Into `SceneDescription::materials`.
    fn index(self) -> usize;

    /// Its meshes need tangents.
    fn has_normal_map(self) -> bool {
        false
    }

    /// What its textures cover before they repeat, m.
    fn repeat(self) -> f32 {
        1.0
    }
}

/// A mesh under construction: one primitive for each finish.
#[derive(Clone)]
pub struct Part<F>(BTreeMap<F, Shape>);

impl<F> Default for Part<F> {
    fn default() -> Self {
        Part(BTreeMap::new())
    }
}

impl<F: Finish> Part<F> {
    pub fn of(finish: F, shape: Shape) -> Self {
        Part::default().with(finish, shape)
    }

    pub fn with(mut self, finish: F, shape: Shape) -> Self {
        self.add(finish, &shape);
        self
    }

    pub fn triangles(&self) -> usize {
        self.0.values().map(|shape| shape.indices.len() / 3).sum()
    }

    pub fn add(&mut self, finish: F, shape: &Shape) {
        self.0.entry(finish).or_default().append(shape);
    }

    /// Adds all of `other`, moved.
    pub fn merge(&mut self, other: &Part<F>, transform: Affine3A) {
        for (&finish, shape) in &other.0 {
            self.add(finish, &shape.clone().moved(transform));
        }
    }
}

/// The scene so far.
pub struct Kit {
    pub scene: SceneDescription,
}

impl Kit {
    /// Adds a mesh, returns its index.
    pub fn mesh<F: Finish>(&mut self, name: &str, part: Part<F>) -> usize {
        let primitives = part.0.into_iter().map(|(finish, mut shape)| {
            if finish.repeat() != 1.0 {
                shape.uvs.iter_mut().for_each(|uv| *uv /= finish.repeat());
            }
            shape.into_primitive(finish.index(), finish.has_normal_map())
        });
        self.scene.meshes.push(Mesh { name: name.into(), primitives: primitives.collect() });
        self.scene.meshes.len() - 1
    }

    /// An instance of `mesh`, named after it.
    pub fn place(&mut self, mesh: usize, transform: Affine3A) {
        let name = self.scene.meshes[mesh].name.clone();
        self.scene.instances.push(Instance { name, mesh, transform });
    }

    pub fn place_at(&mut self, mesh: usize, position: Vec3) {
        self.place(mesh, Affine3A::from_translation(position));
    }

    /// An instance on the side of positive z and one turned to the other side.
    pub fn place_both(&mut self, mesh: usize, position: Vec3) {
        self.place_at(mesh, position);
        self.place(mesh, Affine3A::from_quat(HALF_TURN) * Affine3A::from_translation(position));
    }

    /// A mesh that occurs once, where it was modelled.
    pub fn single<F: Finish>(&mut self, name: &str, part: Part<F>) {
        let mesh = self.mesh(name, part);
        self.place_at(mesh, Vec3::ZERO);
    }

    /// A mesh of the side of positive z, with its half-turned twin.
    pub fn both_sides<F: Finish>(&mut self, name: &str, part: Part<F>) {
        let mesh = self.mesh(name, part);
        self.place_both(mesh, Vec3::ZERO);
    }
}

/// Half a turn about the y axis, with exact zeros.
pub const HALF_TURN: Quat = Quat::from_xyzw(0.0, 1.0, 0.0, 0.0);

/// A quarter-turn step about y: `turns` of 90 degrees.
pub fn turned(position: Vec3, turns: f32) -> Affine3A {
    Affine3A::from_rotation_translation(Quat::from_rotation_y(std::f32::consts::FRAC_PI_2 * turns), position)
}
