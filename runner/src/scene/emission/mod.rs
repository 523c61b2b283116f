//! Emission: emissive materials -> triangles of constant radiance.
//!
//! A triangle whose texture varies is divided into parts, each of which emits the exact mean of its own piece of the
//! texture, so that lights are drawn by what the texture shows there and no energy is lost or gained. The rule, for each
//! primitive by itself:
//!
//! - **Step**: the part with the largest possible error, (largest - least luminance in it) x area, becomes four by the
//!   middles of its edges; their areas are exactly a quarter, their mean is the mean before. Dark parts (mean 0) are dropped.
//! - **Bound**: it ends when no part's error exceeds [`TOLERANCE`] of the primitive's flux, or those left are not larger
//!   than a texel.
//! - **Budget**: at most [`MAX_ADDED`] lights more than triangles in the scene; each placed primitive has the same share.
//!
//! Division looks at object space and texture alone, so that moving things keep their lights, and instances share it.

mod polygon;
mod radiance_map;

use super::{Material, Mesh, Primitive, SceneDescription};
use glam::{DVec2, Vec2, Vec3};
use radiance_map::{Measure, RadianceMap};
use shared::material::slot;
use shared::math::luminance;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Lights that textures may add to a scene: 5 MiB of lights and alias table.
pub const MAX_ADDED: usize = 1 << 16;

/// Largest error that one part may have, as a share of its primitive's flux.
const TOLERANCE: f64 = 1.0 / 1024.0;

/// What a primitive emits.
#[derive(Clone, Debug, PartialEq)]
pub enum Emission {
    /// The same radiance everywhere, nit.
    Even(Vec3),
    /// Parts of its triangles.
    Textured(Vec<Part>),
}

/// A part of a triangle, of even radiance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// Index of the triangle in its primitive.
    pub triangle: u32,
    /// Barycentric coordinates of its corners: weights of the triangle's second and third.
    pub corners: [Vec2; 3],
    /// nit, linear RGB
    pub radiance: Vec3,
}

/// `[mesh][primitive]`: the emission of those that have any.
#[derive(Clone, Debug, Default)]
pub struct Emitters(pub Vec<Vec<Option<Emission>>>);

impl Emitters {
    /// Of all meshes of `scene`.
    pub fn new(scene: &SceneDescription) -> Self {
        let even = |primitive: &Primitive| {
            let material = &scene.materials[primitive.material];
            let emits = material.emission != Vec3::ZERO && material.emissive_texture.is_none();
            emits.then_some(Emission::Even(material.emission))
        };
        let mut emitters: Vec<Vec<_>> =
            scene.meshes.iter().map(|mesh| mesh.primitives.iter().map(even).collect()).collect();
        let share = MAX_ADDED / placed(scene).max(1);
        for (i, material) in scene.materials.iter().enumerate() {
            let worn = |mesh: &Mesh| mesh.primitives.iter().any(|primitive| primitive.material == i);
            if !is_textured(material) || !scene.meshes.iter().any(worn) {
                continue;
            }
            let Some(texture) = material.emissive_texture.map(|t| &scene.textures[t]) else { continue };
            let map = RadianceMap::new(texture, material.emission);
            for (mesh, emitters) in scene.meshes.iter().zip(&mut emitters) {
                for (primitive, emitter) in mesh.primitives.iter().zip(emitters) {
                    if primitive.material == i {
                        *emitter = Some(Emission::Textured(divide(primitive, material, &map, share)));
                    }
                }
            }
        }
        Emitters(emitters)
    }
}

/// Whether a material's emission has a texture.
pub fn is_textured(material: &Material) -> bool {
    material.emission != Vec3::ZERO && material.emissive_texture.is_some()
}

/// Primitives with textured emission, as often as they are placed.
fn placed(scene: &SceneDescription) -> usize {
    let textured = |primitive: &&Primitive| is_textured(&scene.materials[primitive.material]);
    let of_mesh: Vec<usize> =
        scene.meshes.iter().map(|mesh| mesh.primitives.iter().filter(textured).count()).collect();
    scene.instances.iter().map(|instance| of_mesh[instance.mesh]).sum()
}

/// A part that may be divided further.
struct Open {
    part: Part,
    uvs: [DVec2; 3],
    /// Object space, m²
    area: f64,
    measure: Measure,
}

impl Open {
    fn flux(&self) -> f64 {
        f64::from(luminance(self.measure.mean.as_vec3())) * self.area
    }

    /// Bound of ∫ |luminance - its mean|.
    fn error(&self) -> f64 {
        if self.measure.divisible {
            f64::from(self.measure.most - self.measure.least) * self.area
        } else {
            0.0
        }
    }

    fn divided(&self, map: &RadianceMap) -> impl Iterator<Item = Open> {
        let ([a, b, c], [u, v, w]) = (self.part.corners, self.uvs);
        let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(p, q)| 0.5 * (p + q));
        let [uv, vw, wu] = [(u, v), (v, w), (w, u)].map(|(p, q)| 0.5 * (p + q));
        let parts = [
            ([a, ab, ca], [u, uv, wu]),
            ([ab, b, bc], [uv, v, vw]),
            ([ca, bc, c], [wu, vw, w]),
            ([bc, ca, ab], [vw, wu, uv]),
        ];
        let open = |(corners, uvs)| Open::new(self.part.triangle, corners, uvs, 0.25 * self.area, map);
        parts.map(open).into_iter().filter(|open| open.measure.most > 0.0)
    }

    fn new(triangle: u32, corners: [Vec2; 3], uvs: [DVec2; 3], area: f64, map: &RadianceMap) -> Self {
        let measure = map.measure(uvs);
        let part = Part { triangle, corners, radiance: measure.mean.as_vec3() };
        Open { part, uvs, area, measure }
    }
}

impl PartialEq for Open {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Open {}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        self.error().total_cmp(&other.error()).then(other.part.triangle.cmp(&self.part.triangle))
    }
}

/// The lit parts of a primitive's triangles, in the order of the triangles; at most `budget` more than these.
fn divide(primitive: &Primitive, material: &Material, map: &RadianceMap, budget: usize) -> Vec<Part> {
    let uv_map = material.uv_maps[slot::EMISSIVE];
    let uvs = if uv_map.set == 0 { &primitive.uvs } else { &primitive.second_uvs };
    let uv = |i: u32| uv_map.apply(uvs.get(i as usize).copied().unwrap_or_default()).as_dvec2();
    let whole = |(i, t): (usize, &[u32])| {
        let [a, b, c] = [t[0], t[1], t[2]].map(|i| primitive.positions[i as usize].as_dvec3());
        let area = 0.5 * (b - a).cross(c - a).length();
        let corners = [Vec2::ZERO, Vec2::X, Vec2::Y];
        Open::new(i as u32, corners, [t[0], t[1], t[2]].map(uv), area, map)
    };
    let triangles = primitive.indices.chunks_exact(3).enumerate().map(whole);
    let mut heap: BinaryHeap<Open> = triangles.filter(|open| open.measure.most > 0.0).collect();
    let tolerance = TOLERANCE * heap.iter().map(Open::flux).sum::<f64>();
    // A division may add three.
    let limit = (heap.len() + budget).saturating_sub(3);
    while let Some(worst) = heap.peek()
        && worst.error() > tolerance
        && heap.len() <= limit
    {
        let Some(worst) = heap.pop() else { break };
        heap.extend(worst.divided(map));
    }
    let mut parts: Vec<Part> = heap.into_iter().map(|open| open.part).collect();
    let place = |part: &Part| (part.triangle, part.corners.map(|c| [c.x.to_bits(), c.y.to_bits()]));
    parts.sort_unstable_by_key(place);
    parts
}

#[cfg(test)]
mod tests;
