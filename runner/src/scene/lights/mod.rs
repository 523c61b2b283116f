//! All lights of a scene as the GPU reads them; [`changes`] when they move.

mod changes;
pub mod placed;
#[cfg(test)]
mod tests;

pub use changes::{LightEdits, inverse_map, light_maps};

use super::emission::{Emission, Emitters, Part};
use super::environment::shines;
use super::{AlphaMode, Environment, Instance, Material, Mesh, Primitive, SceneDescription};
use glam::{UVec2, Vec2, Vec3};
use shared::alias_table::AliasEntry;
use shared::light::{self, Light, UNTRACEABLE};
use std::cell::LazyCell;
use std::ops::Range;

/// Most lights of a scene: 1 GiB of them. More would fit no device that is at hand, and counts are `u32`.
pub const MAX_LIGHTS: usize = 1 << 24;

/// No fewer lights than `scene` has, before there are any; but for what [`MAX_ADDED`](super::emission::MAX_ADDED) allows
/// textures and for the environment.
pub fn most(scene: &SceneDescription) -> u64 {
    let emits = |primitive: &&Primitive| scene.materials[primitive.material].emission != Vec3::ZERO;
    let of_mesh = |mesh: &Mesh| -> u64 {
        mesh.primitives.iter().filter(emits).map(|primitive| primitive.indices.len() as u64 / 3).sum()
    };
    let of_meshes: Vec<u64> = scene.meshes.iter().map(of_mesh).collect();
    let triangles: u64 = scene.instances.iter().map(|instance| of_meshes[instance.mesh]).sum();
    triangles + scene.lights.len() as u64
}

/// The lights of a scene, and the table that draws them by their power.
#[derive(Clone, Debug, Default)]
pub struct LightTable {
    /// The scene's placed lights, then those of each emissive primitive of each instance (one a
    /// triangle, or its lit parts where its texture varies, see [`emission`](super::emission)), then the lit texels of
    /// the environment map. Neither transforms nor strengths change the order.
    pub lights: Vec<Light>,
    /// Empty if no light has power.
    pub alias: Vec<AliasEntry>,
    /// Number of placed lights.
    pub placed: usize,
    /// `[instance][primitive]`: its lights.
    pub of_primitives: Vec<Vec<Range<usize>>>,
    /// Index of the first lit texel of the environment map.
    pub first_environment: usize,
    /// How the emission of meshes is divided.
    pub emitters: Emitters,
    /// How many of the lights are parts of textured emitters.
    pub textured: usize,
}

impl LightTable {
    /// All lights of `scene`: placed, emissive triangles, texels of the sky.
    pub fn new(scene: &SceneDescription) -> Self {
        let emitters = Emitters::new(scene);
        let mut lights = placed_lights(scene);
        let placed = lights.len();
        let mut of_primitives = Vec::with_capacity(scene.instances.len());
        let mut textured = 0;
        for instance in &scene.instances {
            let primitives = scene.meshes[instance.mesh].primitives.iter().zip(&emitters.0[instance.mesh]);
            let range = |(primitive, emission): (&Primitive, &Option<Emission>)| {
                let first = lights.len();
                if let Some(emission) = emission {
                    let material = &scene.materials[primitive.material];
                    lights.extend(emitter_lights(instance, primitive, emission, material));
                    textured += match emission {
                        Emission::Even(_) => 0,
                        Emission::Textured(parts) => parts.len(),
                    };
                }
                first..lights.len()
            };
            of_primitives.push(primitives.map(range).collect());
        }
        let first_environment = lights.len();
        lights.extend(environment_lights(scene));
        let alias = light::build_alias_table(&lights);
        LightTable { lights, alias, placed, of_primitives, first_environment, emitters, textured }
    }

    /// The light of the first triangle of a primitive of an instance, if rays that hit its triangles find theirs.
    pub fn traceable(&self, instance: usize, primitive: usize) -> Option<usize> {
        let range = self.of_primitives[instance][primitive].clone();
        self.lights[range.clone()].first().filter(|light| light.flags & UNTRACEABLE == 0).map(|_| range.start)
    }
}

/// The lights of one emissive primitive of one instance.
fn emitter_lights(
    instance: &Instance,
    primitive: &Primitive,
    emission: &Emission,
    material: &Material,
) -> Vec<Light> {
    let double_sided = material.double_sided;
    let mut lights: Vec<Light> = match emission {
        Emission::Even(radiance) => triangle_lights(instance, primitive, *radiance, double_sided).collect(),
        Emission::Textured(parts) => {
            parts.iter().map(|part| part_light(instance, primitive, part, double_sided)).collect()
        }
    };
    if !is_traceable(material) {
        lights.iter_mut().for_each(|light| light.flags |= UNTRACEABLE);
    }
    lights
}

/// Do rays that hit a triangle of this material know its light? Parts of textures are not looked for, and rays pass what is
/// transparent, which as a light is solid.
pub fn is_traceable(material: &Material) -> bool {
    let even = material.emission != Vec3::ZERO && material.emissive_texture.is_none();
    even && material.alpha == AlphaMode::Opaque
}

/// Does the scene bring light of its own?
pub fn is_lit(scene: &SceneDescription) -> bool {
    let shines = |light: &Light| light.power > 0.0;
    let emits = |instance: &Instance| {
        let mut primitives = scene.meshes[instance.mesh].primitives.iter();
        primitives.any(|primitive| scene.materials[primitive.material].emission != Vec3::ZERO)
    };
    placed_lights(scene).iter().any(shines)
        || environment_lights(scene).iter().any(shines)
        // Textures may be black.
        || scene.instances.iter().any(emits) && LightTable::new(scene).lights.iter().any(shines)
}

fn placed_lights(scene: &SceneDescription) -> Vec<Light> {
    // It takes a look at every vertex.
    let radius = LazyCell::new(|| scene.radius());
    scene.lights.iter().map(|light| light.light(|| *radius)).collect()
}

fn environment_lights(scene: &SceneDescription) -> Vec<Light> {
    let Some(Environment { size, radiance }) = &scene.environment else { return Vec::new() };
    let radius = scene.radius();
    let lit = radiance.iter().enumerate().filter(|(_, radiance)| shines(**radiance));
    lit.map(|(i, &radiance)| {
        let texel = UVec2::new(i as u32 % size.x, i as u32 / size.x);
        Light::environment(texel, *size, radiance, radius)
    })
    .collect()
}

fn triangle_lights(
    instance: &Instance,
    primitive: &Primitive,
    radiance: Vec3,
    double_sided: bool,
) -> impl Iterator<Item = Light> {
    primitive.indices.chunks_exact(3).map(move |t| {
        let vertices = wound(instance, corners(instance, primitive, t));
        Light::triangle(vertices, radiance, double_sided)
    })
}

/// The light of a part: its edges are shares of the triangle's, so that no area is lost where coordinates are coarse.
fn part_light(instance: &Instance, primitive: &Primitive, part: &Part, double_sided: bool) -> Light {
    let t = &primitive.indices[3 * part.triangle as usize..][..3];
    let [a, b, c] = corners(instance, primitive, t).map(Vec3::as_dvec3);
    let along = |weights: Vec2| f64::from(weights.x) * (b - a) + f64::from(weights.y) * (c - a);
    let [first, second, third] = wound(instance, part.corners);
    let position = (a + along(first)).as_vec3();
    let edges = [second - first, third - first].map(along);
    Light::triangle_between(position, edges, part.radiance, double_sided)
}

/// World space, m.
fn corners(instance: &Instance, primitive: &Primitive, triangle: &[u32]) -> [Vec3; 3] {
    [triangle[0], triangle[1], triangle[2]]
        .map(|i| instance.transform.transform_point3(primitive.positions[i as usize]))
}

/// Corners in the order that faces outward: a mirror turns the winding, but the outside stays outside.
fn wound<T>(instance: &Instance, [a, b, c]: [T; 3]) -> [T; 3] {
    if instance.transform.matrix3.determinant() < 0.0 { [a, c, b] } else { [a, b, c] }
}
