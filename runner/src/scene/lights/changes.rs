//! Lights that move, come or go: a table follows them, and maps say which light is which.

use super::{LightTable, emitter_lights};
use crate::scene::SceneDescription;
use crate::scene::animation::{Pose, Thing};
use shared::light::{self, Light};
use shared::motion::NO_LIGHT;
use std::collections::HashSet;
use std::ops::Range;

/// Which of the former placed lights is which.
///
/// ```
/// # use candela::frame::renderer::{FrameOptions, Renderer};
/// # use candela::frame::schedule::{Primary, Work};
/// # use candela::gpu_scene::GpuScene;
/// # use candela::knobs::Knobs;
/// # use candela::scene::{Illumination, SceneSource, load};
/// # use candela::shared::glam::UVec2;
/// # use candela::vulkan::{Device, DeviceOptions};
/// use candela::scene::lights::LightEdits;
///
/// # let size = UVec2::new(32, 18);
/// # let mut scene = load(&SceneSource::Knot, &Illumination::points(3))?;
/// # let camera = scene.camera(None)?.seen_in(size);
/// # let device = Device::new(&DeviceOptions::default())?;
/// # let gpu_scene = GpuScene::new(&device, &scene)?;
/// # let settings = Knobs::default().settings(gpu_scene.lights());
/// # let mut renderer = Renderer::new(&device, gpu_scene, size, settings.reservoirs)?;
/// # let options = FrameOptions::new(Work::Restir(settings), Primary::Auto, 0);
/// # renderer.render(camera, &options)?;
/// // The first of three lights goes out: the other two move up.
/// scene.lights.remove(0);
/// renderer.replace_lights(&scene, &LightEdits { places: Some(vec![None, Some(0), Some(1)]) })?;
/// renderer.render(camera, &options)?;
/// assert_eq!(renderer.scene().lights().number, 2);
/// # Ok::<(), candela::error::Error>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct LightEdits {
    /// Of each its index in the scene's list now; `None` for one that is gone. Without: the list stays in its order, and what
    /// is new is at its end.
    pub places: Option<Vec<Option<usize>>>,
}

/// By how much a light's power may leave what the alias table was built from: any table is right, this one is good.
const POWER_TOLERANCE: f32 = 1e-3;

impl LightTable {
    /// Moves the lights that `pose` moved, in a `scene` that it was applied to. Gives the ranges of lights that changed, and
    /// whether the alias table did.
    pub fn follow(&mut self, scene: &SceneDescription, pose: &Pose) -> (Vec<Range<usize>>, bool) {
        let mut changed = Vec::new();
        for &(thing, _) in &pose.places {
            match thing {
                Thing::Light(i) => {
                    let radius = self.lights[i].scene_radius();
                    changed.push(self.set(i, scene.lights[i].light(|| radius)));
                }
                Thing::Instance(i) => self.follow_instance(scene, i, &mut changed),
                Thing::Camera(_) => {}
            }
        }
        let moved: HashSet<usize> = pose.instances().map(|(i, _)| i).collect();
        for i in scene.bent_instances(pose).filter(|i| !moved.contains(i)) {
            self.follow_instance(scene, i, &mut changed);
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

    /// Moves the lights of instance `i` to where its triangles are now. Textured emitters keep their parts.
    fn follow_instance(&mut self, scene: &SceneDescription, i: usize, changed: &mut Vec<Range<usize>>) {
        let instance = &scene.instances[i];
        let primitives = &scene.meshes[instance.mesh].primitives;
        for (p, primitive) in primitives.iter().enumerate() {
            let Some(emission) = &self.emitters.0[instance.mesh][p] else { continue };
            let material = &scene.materials[primitive.material];
            let range = self.of_primitives[i][p].clone();
            let moved = emitter_lights(instance, primitive, emission, material);
            for (at, light) in range.clone().zip(moved) {
                self.set(at, light);
            }
            changed.push(range);
        }
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
        for (from, to) in (from..from + count).zip(to..) {
            // Points of one kind are none of another's.
            if before.lights[from].kind == now.lights[to].kind {
                map[from] = to as u32;
            }
        }
    };
    match &edits.places {
        None => join(0, 0, before.placed.min(now.placed)),
        Some(places) => {
            for (i, place) in places.iter().enumerate().take(before.placed) {
                if let Some(place) = place.filter(|&place| place < now.placed) {
                    join(i, place, 1);
                }
            }
        }
    }
    for (old, new) in before.of_primitives.iter().flatten().zip(now.of_primitives.iter().flatten()) {
        join(old.start, new.start, old.len().min(new.len()));
    }
    let [old, new] = [before, now].map(|table| table.first_environment..table.lights.len());
    join(old.start, new.start, old.len().min(new.len()));
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

#[cfg(test)]
mod tests {
    use super::super::tests::scene;
    use super::*;
    use crate::scene::PointLight;
    use glam::Vec3;

    /// A table that follows a pose is the table made anew; only what grows draws more often.
    #[test]
    fn tables_follow_poses() {
        use glam::{DAffine3, DVec3};
        let mut scene = scene();
        let mut table = LightTable::new(&scene);
        for (scale, rebuilt) in [(0.5, false), (2.0, true), (2.0, false), (0.0, true)] {
            let world = DAffine3::from_scale(DVec3::splat(scale)) * DAffine3::from_rotation_y(0.4);
            let pose =
                Pose { places: vec![(Thing::Instance(1), world), (Thing::Light(0), world)], bent: None };
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
        let light = |x: f32| PointLight { position: Vec3::X * x, intensity: Vec3::ONE, radius: 0.0 }.into();
        now.lights = vec![light(5.0), light(6.0), before.lights[0]];
        let [old, new] = [&before, &now].map(LightTable::new);
        let none = NO_LIGHT;
        // In their order: the first stays the first; triangles move two places up.
        let [to_now, back] = light_maps(&old, &new, &LightEdits::default());
        assert_eq!(to_now[..3], [0, 3, 4]);
        assert_eq!(back[..4], [0, none, none, 1]);
        assert_eq!((to_now.len(), back.len()), (13, 15));
        // As said: the only one is the last one now.
        let edits = LightEdits { places: Some(vec![Some(2)]) };
        let [to_now, back] = light_maps(&old, &new, &edits);
        assert_eq!((&to_now[..2], &back[..4]), (&[2, 3][..], &[none, none, 0, 1][..]));
        // Gone; and a place that does not exist.
        for place in [None, Some(9)] {
            let edits = LightEdits { places: Some(vec![place]) };
            assert_eq!(light_maps(&old, &new, &edits)[0][..2], [none, 3]);
        }
        // Emission that went out: its triangles are gone, the others keep their pairs.
        let [map, _] = light_maps(
            &old,
            &LightTable {
                of_primitives: vec![vec![0..0], vec![0..0, 0..0, 1..4], vec![0..0, 4..7, 7..10]],
                ..old.clone()
            },
            &LightEdits::default(),
        );
        assert_eq!(map[1..10], [none, none, none, 1, 2, 3, 4, 5, 6]);
    }
}
