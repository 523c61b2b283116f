//! All lights of a scene as the GPU reads them, and lights to add to a scene that has too few.

use super::animation::{Pose, Thing};
use super::emission::{Emission, Emitters, Part};
use super::{DirectionalLight, Environment, Instance, PointLight, Primitive, SceneDescription};
use glam::{UVec2, Vec2, Vec3};
use shared::alias_table::AliasEntry;
use shared::light::{self, Light, kind};
use shared::math::luminance;
use shared::motion::NO_LIGHT;
use shared::rng::{Rng, Stream};
use std::f32::consts::PI;
use std::ops::Range;

/// The lights of a scene, and the table that draws them by their power.
#[derive(Clone, Debug, Default)]
pub struct LightTable {
    /// Point, spot, directional lights in their order, then those of each emissive primitive of each instance (one a
    /// triangle, or its lit parts where its texture varies, see [`emission`](super::emission)), then the lit texels of
    /// the environment map. Neither transforms nor strengths change the order.
    pub lights: Vec<Light>,
    /// Empty if no light has power.
    pub alias: Vec<AliasEntry>,
    /// `[instance][primitive]`: its lights.
    pub of_primitives: Vec<Vec<Range<usize>>>,
    /// How the emission of meshes is divided.
    pub emitters: Emitters,
    /// How many of the lights are parts of textured emitters.
    pub textured: usize,
}

impl LightTable {
    pub fn new(scene: &SceneDescription) -> Self {
        Self::with_emitters(scene, Emitters::new(scene))
    }

    /// With the emission of `scene`'s meshes already divided: it stays the same while things only move.
    pub fn with_emitters(scene: &SceneDescription, emitters: Emitters) -> Self {
        let mut lights = punctual_lights(scene);
        let mut of_primitives = Vec::with_capacity(scene.instances.len());
        let mut textured = 0;
        for instance in &scene.instances {
            let primitives = scene.meshes[instance.mesh].primitives.iter().zip(&emitters.0[instance.mesh]);
            let range = |(primitive, emission): (&Primitive, &Option<Emission>)| {
                let first = lights.len();
                if let Some(emission) = emission {
                    let double_sided = scene.materials[primitive.material].double_sided;
                    lights.extend(emitter_lights(instance, primitive, emission, double_sided));
                    textured += match emission {
                        Emission::Even(_) => 0,
                        Emission::Textured(parts) => parts.len(),
                    };
                }
                first..lights.len()
            };
            of_primitives.push(primitives.map(range).collect());
        }
        lights.extend(environment_lights(scene));
        let alias = light::build_alias_table(&lights);
        LightTable { lights, alias, of_primitives, emitters, textured }
    }
}

/// The lights of one emissive primitive of one instance.
fn emitter_lights(
    instance: &Instance,
    primitive: &Primitive,
    emission: &Emission,
    double_sided: bool,
) -> Vec<Light> {
    match emission {
        Emission::Even(radiance) => triangle_lights(instance, primitive, *radiance, double_sided).collect(),
        Emission::Textured(parts) => {
            parts.iter().map(|part| part_light(instance, primitive, part, double_sided)).collect()
        }
    }
}

/// Does the scene bring light of its own?
pub fn is_lit(scene: &SceneDescription) -> bool {
    let shines = |light: &Light| light.power > 0.0;
    let emits = |instance: &Instance| {
        let mut primitives = scene.meshes[instance.mesh].primitives.iter();
        primitives.any(|primitive| scene.materials[primitive.material].emission != Vec3::ZERO)
    };
    punctual_lights(scene).iter().any(shines)
        || environment_lights(scene).iter().any(shines)
        // Textures may be black.
        || scene.instances.iter().any(emits) && LightTable::new(scene).lights.iter().any(shines)
}

/// Which of the former lights is which, by index in the scene's lists; `None` for one that is gone. A list that is not given
/// stays in its order: what is new is at its end.
#[derive(Clone, Debug, Default)]
pub struct LightEdits {
    pub points: Option<Vec<Option<usize>>>,
    pub spots: Option<Vec<Option<usize>>>,
    pub directionals: Option<Vec<Option<usize>>>,
}

/// By how much a light's power may leave what the alias table was built from: any table is right, this one is good.
const POWER_TOLERANCE: f32 = 1e-3;

impl LightTable {
    /// Moves the lights that `pose` moved, in a `scene` that it was applied to. Gives the ranges of lights that changed, and
    /// whether the alias table did.
    pub fn follow(&mut self, scene: &SceneDescription, pose: &Pose) -> (Vec<Range<usize>>, bool) {
        let spots = scene.point_lights.len();
        let suns = spots + scene.spot_lights.len();
        let mut changed = Vec::new();
        for &(thing, _) in &pose.places {
            match thing {
                Thing::PointLight(i) => {
                    let l = &scene.point_lights[i];
                    changed.push(self.set(i, Light::point(l.position, l.intensity)));
                }
                Thing::SpotLight(i) => {
                    let l = &scene.spot_lights[i];
                    let light = Light::spot(l.position, l.axis, l.intensity, l.inner_angle, l.outer_angle);
                    changed.push(self.set(spots + i, light));
                }
                Thing::DirectionalLight(i) => {
                    let (l, at) = (&scene.directional_lights[i], suns + i);
                    let radius = self.lights[at].edge2.x;
                    changed.push(self.set(at, Light::directional(l.direction, l.illuminance, radius)));
                }
                Thing::Instance(i) => {
                    let instance = &scene.instances[i];
                    let primitives = &scene.meshes[instance.mesh].primitives;
                    for (p, primitive) in primitives.iter().enumerate() {
                        let Some(emission) = &self.emitters.0[instance.mesh][p] else { continue };
                        let double_sided = scene.materials[primitive.material].double_sided;
                        let range = self.of_primitives[i][p].clone();
                        let moved = emitter_lights(instance, primitive, emission, double_sided);
                        for (at, light) in range.clone().zip(moved) {
                            self.set(at, light);
                        }
                        changed.push(range);
                    }
                }
                Thing::Camera(_) => {}
            }
        }
        let stale = changed.iter().any(|range| {
            let off = |light: &Light| {
                let (built, now) = (light.power, power_of(light));
                (now - built).abs() > POWER_TOLERANCE * now.max(built)
            };
            self.lights[range.clone()].iter().any(off)
        });
        if stale {
            for range in &changed {
                self.lights[range.clone()].iter_mut().for_each(|light| light.power = power_of(light));
            }
            self.alias = light::build_alias_table(&self.lights);
        }
        (changed, stale)
    }

    /// Puts a light in place of another one, whose power it keeps: that is what the alias table knows.
    fn set(&mut self, index: usize, light: Light) -> Range<usize> {
        let power = self.lights[index].power;
        self.lights[index] = Light { power, ..light };
        index..index + 1
    }
}

/// As a weight of the alias table.
fn power_of(light: &Light) -> f32 {
    light.power().min(f32::MAX)
}

/// For each light of `before` its index in `now`, and the inverse; [`NO_LIGHT`] for those that only one of them has. Triangles
/// belong together by instance, primitive and their place in it; texels of the environment by their order.
pub fn light_maps(before: &LightTable, now: &LightTable, edits: &LightEdits) -> [Vec<u32>; 2] {
    let mut map = vec![NO_LIGHT; before.lights.len()];
    let mut join = |from: usize, to: usize, count: usize| {
        (0..count).for_each(|i| map[from + i] = (to + i) as u32);
    };
    let (mut from, mut to) = (0, 0);
    for (kind, edit) in
        [(kind::POINT, &edits.points), (kind::SPOT, &edits.spots), (kind::DIRECTIONAL, &edits.directionals)]
    {
        let [old, new] = [before, now].map(|table| table.lights.iter().filter(|l| l.kind == kind).count());
        match edit {
            None => join(from, to, old.min(new)),
            Some(places) => {
                for (i, place) in places.iter().enumerate().take(old) {
                    if let Some(place) = place.filter(|&place| place < new) {
                        join(from + i, to + place, 1);
                    }
                }
            }
        }
        (from, to) = (from + old, to + new);
    }
    for (old, new) in before.of_primitives.iter().flatten().zip(now.of_primitives.iter().flatten()) {
        join(old.start, new.start, old.len().min(new.len()));
    }
    let [old, new] = [before, now]
        .map(|table| table.lights.iter().rev().take_while(|l| l.kind == kind::ENVIRONMENT).count());
    join(before.lights.len() - old, now.lights.len() - new, old.min(new));
    let inverse = inverse_map(&map, now.lights.len());
    [map, inverse]
}

/// The inverse of a map of light indices onto `count` lights.
pub fn inverse_map(map: &[u32], count: usize) -> Vec<u32> {
    let mut inverse = vec![NO_LIGHT; count];
    for (from, &to) in map.iter().enumerate() {
        if let Some(place) = inverse.get_mut(to as usize) {
            *place = from as u32;
        }
    }
    inverse
}

fn punctual_lights(scene: &SceneDescription) -> Vec<Light> {
    let points = scene.point_lights.iter().map(|l| Light::point(l.position, l.intensity));
    let spots = scene
        .spot_lights
        .iter()
        .map(|l| Light::spot(l.position, l.axis, l.intensity, l.inner_angle, l.outer_angle));
    let mut lights: Vec<Light> = points.chain(spots).collect();
    if !scene.directional_lights.is_empty() {
        let radius = scene.radius();
        let light = |l: &DirectionalLight| Light::directional(l.direction, l.illuminance, radius);
        lights.extend(scene.directional_lights.iter().map(light));
    }
    lights
}

fn environment_lights(scene: &SceneDescription) -> Vec<Light> {
    let Some(Environment { size, radiance }) = &scene.environment else { return Vec::new() };
    let radius = scene.radius();
    let lit = radiance.iter().enumerate().filter(|(_, radiance)| **radiance != Vec3::ZERO);
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

/// Mean illuminance that [`scatter`] aims at, lx: a well-lit office.
const SCATTERED_ILLUMINANCE: f32 = 500.0;

/// Adds `count` equally strong point lights of random hue, uniformly in the scene's bounds (shrunk by 1 % on each
/// side, so that none lies in a wall). The same seed gives the same lights.
///
/// Together they emit Φ = E A, with E = 500 lx and A the surface area of the bounds: if all of the flux
/// met that surface, its mean illuminance would be E, whatever the scene's size and the number of lights. Each
/// light has the luminous intensity Φ / (4π count).
pub fn scatter(scene: &mut SceneDescription, count: usize, seed: u64) {
    let bounds = scene.bounds();
    let extent = bounds.extent();
    if count == 0 || extent.min_element() < 0.0 {
        return;
    }
    let area = 2.0 * (extent.x * extent.y + extent.y * extent.z + extent.z * extent.x);
    let intensity = SCATTERED_ILLUMINANCE * area / (4.0 * PI * count as f32);
    for i in 0..count as u64 {
        // No pass draws from this lane.
        let place = UVec2::new(i as u32, (i >> 32) as u32);
        let mut rng = Rng::new(place, (seed >> 32) as u32, seed as u32, Stream::Initial, u32::MAX);
        let unit = Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32());
        let color = moderate_color(rng.next_f32());
        let position = bounds.min + extent * (0.01 + 0.98 * unit);
        scene.point_lights.push(PointLight { position, intensity: color * intensity });
    }
}

/// Linear RGB of luminance 1: the fully saturated color of `hue` (0..1, once around), mixed half and half with white.
fn moderate_color(hue: f32) -> Vec3 {
    let channel = |shift: f32| ((((hue + shift).fract() * 6.0) - 3.0).abs() - 1.0).clamp(0.0, 1.0);
    let color = Vec3::new(channel(0.0), channel(2.0 / 3.0), channel(1.0 / 3.0)).lerp(Vec3::ONE, 0.5);
    color / luminance(color)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Filter, Image, Material, Mesh, Texture, Wrap};
    use glam::Affine3A;
    use shared::light::kind;
    use std::sync::Arc;

    /// A box of 2 x 4 x 6 m by its diagonal triangle, and one light triangle of 2 m² in the xy plane that faces +z.
    fn scene() -> SceneDescription {
        let triangles = |positions: Vec<Vec3>, material| Primitive {
            material,
            indices: (0..positions.len() as u32).collect(),
            normals: vec![Vec3::Z; positions.len()],
            positions,
            ..Primitive::default()
        };
        let wall = triangles(vec![Vec3::ZERO, Vec3::new(2.0, 4.0, 0.0), Vec3::new(0.0, 4.0, 6.0)], 0);
        let corners = [Vec3::ZERO, Vec3::X * 2.0, Vec3::Y * 2.0];
        // The second one has no area.
        let glow = triangles([corners, [Vec3::ZERO, Vec3::X, Vec3::X * 2.0], corners].concat(), 1);
        let glowing = Material { emission: Vec3::new(1.0, 2.0, 3.0), ..Material::default() };
        SceneDescription {
            meshes: vec![
                Mesh { name: "wall".into(), primitives: vec![wall.clone()] },
                Mesh { name: "glow".into(), primitives: vec![wall, glow.clone(), glow] },
            ],
            instances: [(0, Vec3::ONE), (1, Vec3::splat(0.5)), (1, Vec3::new(-0.5, 0.5, 0.5))]
                .map(|(mesh, scale)| Instance {
                    name: String::new(),
                    mesh,
                    transform: Affine3A::from_scale(scale),
                })
                .to_vec(),
            materials: vec![Material::default(), glowing],
            point_lights: vec![PointLight { position: Vec3::Y, intensity: Vec3::splat(7.0) }],
            ..SceneDescription::default()
        }
    }

    #[test]
    fn lights_come_in_order() {
        let table = LightTable::new(&scene());
        assert_eq!(table.lights.len(), 1 + 2 * 2 * 3);
        assert_eq!(table.lights[0].kind, kind::POINT);
        assert!(table.lights[1..].iter().all(|light| light.kind == kind::TRIANGLE));
    }

    #[test]
    fn power_is_that_of_lambertian_triangles() {
        let table = LightTable::new(&scene());
        assert!((table.lights[0].power - 4.0 * PI * 7.0).abs() < 1e-4);
        // 2 m² at half the scale: 0.5 m².
        let power = PI * 0.5 * (0.2126 + 2.0 * 0.7152 + 3.0 * 0.0722);
        for (i, light) in table.lights.iter().enumerate().skip(1) {
            let expected = if i % 3 == 2 { 0.0 } else { power };
            assert!((light.power - expected).abs() < 1e-5, "light {i}: {} lm", light.power);
        }
        // Those without power are never drawn.
        assert_eq!((table.alias[2].pmf, table.alias[1].pmf > 0.0), (0.0, true));
    }

    #[test]
    fn both_sides_emit_twice_the_power() {
        let mut scene = scene();
        let single = LightTable::new(&scene).lights[1].power;
        scene.materials[1].double_sided = true;
        assert!((LightTable::new(&scene).lights[1].power - 2.0 * single).abs() < 1e-5);
    }

    /// The triangle faces +z; a mirror along x must not turn it, a mirror along z must.
    #[test]
    fn mirrors_keep_the_emitting_side_outward() {
        let mut scene = scene();
        for (scale, side) in
            [(Vec3::new(-1.0, 1.0, 1.0), 1.0), (Vec3::new(1.0, 1.0, -1.0), -1.0), (Vec3::ONE, 1.0)]
        {
            scene.instances[1].transform = Affine3A::from_scale(scale);
            let light = LightTable::new(&scene).lights[1];
            let irradiance = |z: f32| light.sample_li(Vec2::splat(0.5), Vec3::new(0.0, 0.0, z)).irradiance.x;
            assert!(irradiance(side) > 0.0 && irradiance(-side) == 0.0, "scale {scale}");
        }
    }

    /// A texture that is bright to the left and dark to the right, on a triangle, far from the origin and mirrored: the
    /// lights cover its left part, face outward, and have the whole of its power.
    #[test]
    fn textured_lights_are_where_the_texture_is_bright() {
        let mut scene = scene();
        let texels = [[255; 4], [0; 4]].concat();
        let image = Arc::new(Image { name: String::new(), width: 2, height: 1, texels });
        scene.textures =
            vec![Texture { image, srgb: true, wrap: [Wrap::Repeat; 2], filter: Filter::NEAREST }];
        scene.materials[1].emissive_texture = Some(0);
        let glow = &mut scene.meshes[1].primitives[1];
        // u grows along x: bright from 0 to 1 m of 2.
        glow.uvs = glow.positions.iter().map(|p| Vec2::new(p.x / 2.0, p.y / 2.0)).collect();
        glow.indices.truncate(3);
        scene.meshes[1].primitives.truncate(2);
        let place = Vec3::new(4096.0, -2000.0, 1000.0);
        for mirror in [1.0, -1.0] {
            let scale = Affine3A::from_scale(Vec3::new(mirror, 1.0, 1.0));
            scene.instances = vec![Instance {
                name: String::new(),
                mesh: 1,
                transform: Affine3A::from_translation(place) * scale,
            }];
            let lights = LightTable::new(&scene).lights[1..].to_vec();
            // Of 2 m², 1.5 m² lie at x < 1.
            let power: f64 = lights.iter().map(|light| f64::from(light.power)).sum();
            let exact = std::f64::consts::PI * 1.5 * f64::from(luminance(Vec3::new(1.0, 2.0, 3.0)));
            assert!((power / exact - 1.0).abs() < 1e-5, "{power} instead of {exact} lm");
            for light in &lights {
                let middle = light.position + (light.edge1 + light.edge2) / 3.0 - place;
                assert!((0.0..1.0).contains(&(mirror * middle.x)), "{middle}");
                assert!(light.edge1.cross(light.edge2).z > 0.0, "it faces +z");
            }
        }
    }

    #[test]
    fn black_textures_are_no_light() {
        let mut scene = scene();
        scene.point_lights.clear();
        assert!(is_lit(&scene));
        let image = Arc::new(Image { name: String::new(), width: 1, height: 1, texels: vec![0, 0, 0, 255] });
        scene.textures = vec![Texture { image, srgb: true, wrap: [Wrap::Repeat; 2], filter: Filter::LINEAR }];
        scene.materials[1].emissive_texture = Some(0);
        assert!(!is_lit(&scene) && LightTable::new(&scene).lights.is_empty());
    }

    /// A table that follows a pose is the table made anew; only what grows draws more often.
    #[test]
    fn tables_follow_poses() {
        use glam::{DAffine3, DVec3};
        let mut scene = scene();
        let mut table = LightTable::new(&scene);
        for (scale, rebuilt) in [(0.5, false), (2.0, true), (2.0, false), (0.0, true)] {
            let world = DAffine3::from_scale(DVec3::splat(scale)) * DAffine3::from_rotation_y(0.4);
            let pose = Pose { places: vec![(Thing::Instance(1), world), (Thing::PointLight(0), world)] };
            scene.apply(&pose);
            let (changed, alias) = table.follow(&scene, &pose);
            assert_eq!(changed, [1..4, 4..7, 0..1]);
            assert_eq!(alias, rebuilt, "scale {scale}");
            let anew = LightTable::new(&scene);
            for (i, (a, b)) in table.lights.iter().zip(&anew.lights).enumerate() {
                assert_eq!(
                    (a.position, a.edge1, a.area, a.emission),
                    (b.position, b.edge1, b.area, b.emission)
                );
                assert!((a.power - b.power).abs() <= 1e-3 * b.power, "light {i}");
            }
            assert_eq!(table.alias.len(), anew.alias.len());
        }
    }

    #[test]
    fn edits_map_lights() {
        let before = scene();
        let mut now = before.clone();
        let light = |x: f32| PointLight { position: Vec3::X * x, intensity: Vec3::ONE };
        now.point_lights = vec![light(5.0), light(6.0), before.point_lights[0]];
        let [old, new] = [&before, &now].map(LightTable::new);
        let none = NO_LIGHT;
        // In their order: the first stays the first; triangles move two places up.
        let [to_now, back] = light_maps(&old, &new, &LightEdits::default());
        assert_eq!(to_now[..3], [0, 3, 4]);
        assert_eq!(back[..4], [0, none, none, 1]);
        assert_eq!((to_now.len(), back.len()), (13, 15));
        // As said: the only one is the last one now.
        let edits = LightEdits { points: Some(vec![Some(2)]), ..LightEdits::default() };
        let [to_now, back] = light_maps(&old, &new, &edits);
        assert_eq!((&to_now[..2], &back[..4]), (&[2, 3][..], &[none, none, 0, 1][..]));
        // Gone; and a place that does not exist.
        for place in [None, Some(9)] {
            let edits = LightEdits { points: Some(vec![place]), ..LightEdits::default() };
            assert_eq!(light_maps(&old, &new, &edits)[0][..2], [none, 3]);
        }
        // Emission that went out: its triangles are gone, the others keep their pairs.
        let [map, _] = light_maps(
            &old,
            &LightTable {
                of_primitives: vec![vec![0..0], vec![0..0, 0..0, 1..4], vec![0..0, 4..7, 7..10]],
                ..new.clone()
            },
            &LightEdits::default(),
        );
        assert_eq!(map[1..10], [none, none, none, 1, 2, 3, 4, 5, 6]);
    }

    #[test]
    fn a_dark_scene_has_no_lights() {
        let table = LightTable::new(&SceneDescription::default());
        assert!(table.lights.is_empty() && table.alias.is_empty());
    }

    #[test]
    fn scattered_lights_are_repeatable_and_inside() {
        let lights = |count, seed| {
            let mut scene = scene();
            scene.point_lights.clear();
            scatter(&mut scene, count, seed);
            (scene.bounds(), scene.point_lights)
        };
        let (bounds, first) = lights(1000, 5);
        assert_eq!(first, lights(1000, 5).1);
        // Both halves of the seed count.
        assert_ne!(first, lights(1000, 6).1);
        assert_ne!(first, lights(1000, 5 + (1 << 32)).1);
        let inset = 0.0099 * bounds.extent();
        let (min, max) = (bounds.min + inset, bounds.max - inset);
        assert!(first.iter().all(|l| l.position.cmpge(min).all() && l.position.cmple(max).all()));
        // Uniform: the mean of 1000 has a deviation of extent / sqrt(12 000); 5 of them.
        let mean = first.iter().map(|l| l.position).sum::<Vec3>() / 1000.0;
        assert!(
            ((mean - bounds.center()) / bounds.extent()).abs().max_element() < 5.0 / 12_000f32.sqrt(),
            "{mean}"
        );
    }

    #[test]
    fn scattered_flux_depends_on_neither_count_nor_size() {
        for (count, scale) in [(1, 1.0), (100, 1.0), (100, 10.0)] {
            let mut scene = scene();
            scene.point_lights.clear();
            scene.instances.truncate(1);
            scene.instances[0].transform = Affine3A::from_scale(Vec3::splat(scale));
            scatter(&mut scene, count, 1);
            let flux: f32 = scene.point_lights.iter().map(|l| 4.0 * PI * luminance(l.intensity)).sum();
            // The box of 2 x 4 x 6 m has 88 m².
            let illuminance = flux / (88.0 * scale * scale);
            assert!((illuminance - 500.0).abs() < 0.05, "{count} lights, scale {scale}: {illuminance} lx");
        }
        let mut empty = SceneDescription::default();
        scatter(&mut empty, 10, 1);
        assert!(empty.point_lights.is_empty());
    }
}
