//! Rays on the CPU, in f64 against every triangle: visibility without the driver.

use super::texels;
use candela::gpu_scene::arrays::{Placement, SceneArrays};
use candela::scene::SceneDescription;
use glam::{Affine3A, DVec3, Vec2, Vec3};
use serde::Serialize;
use shared::alpha::{SURE_HITS_ONLY, is_let_through};
use shared::frame::features;
use shared::geometry::{InstanceGeometry, interpolate, vertex_alpha};
use shared::material::slot;
use shared::shadow::ShadowRay;

/// The triangles of a scene, and what rays must know of their materials.
pub struct Occluders<'a> {
    pub scene: &'a SceneDescription,
    pub arrays: SceneArrays,
}

/// Where everything is: of each of the scene's instances object to world, and the vertices in object space.
#[derive(Clone, Copy)]
pub struct Places<'a> {
    pub transforms: &'a [Affine3A],
    pub positions: &'a [Vec3],
}

/// What a ray met first.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Hit {
    /// Along the ray, in lengths of its direction.
    pub t: f64,
    /// Index of the [`InstanceGeometry`].
    pub geometry: u32,
    /// Triangle within it.
    pub triangle: u32,
    /// Names of the instance and of the material.
    pub instance: String,
    pub material: String,
}

/// A triangle that a ray is tested against, and where it is met.
struct Candidate<'a> {
    placement: &'a Placement,
    geometry: usize,
    triangle: u32,
    opaque: bool,
    double_sided: bool,
    meets: Meets,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Meets {
    t: f64,
    barycentrics: Vec2,
    /// The corners run counter-clockwise as the ray sees them.
    front: bool,
}

impl Occluders<'_> {
    /// Where everything is now.
    pub fn places(&self) -> Places<'_> {
        Places { transforms: &self.arrays.transforms, positions: &self.arrays.positions }
    }

    /// What lies between the ends of `ray` where everything is at `places`; both sides of everything do. `key`: of
    /// [`shared::alpha`].
    pub fn blocker(&self, places: Places<'_>, ray: ShadowRay, key: u32) -> Option<Hit> {
        self.nearest(places, [ray.origin, ray.direction], 1.0, key, false)
    }

    /// What a ray from the eye sees: single-sided surfaces only from their front.
    pub fn seen(&self, eye: Vec3, direction: Vec3, key: u32) -> Option<Hit> {
        self.nearest(self.places(), [eye, direction], f64::INFINITY, key, true)
    }

    /// What a ray meets first that is surely in the way.
    pub fn surely_met(&self, origin: Vec3, direction: Vec3) -> Option<Hit> {
        self.nearest(self.places(), [origin, direction], f64::INFINITY, SURE_HITS_ONLY, false)
    }

    fn nearest(&self, places: Places<'_>, ray: [Vec3; 2], t_max: f64, key: u32, culls: bool) -> Option<Hit> {
        let (mut nearest, mut hit) = (t_max, None);
        let ray = ray.map(Vec3::as_dvec3);
        for placement in &self.arrays.placements {
            self.each_triangle(placement, places, ray, |candidate| {
                let culled = culls && !candidate.double_sided && !candidate.meets.front;
                if candidate.meets.t <= nearest && !culled && self.stops(&candidate, key) {
                    nearest = candidate.meets.t;
                    hit = Some(self.hit(&candidate));
                }
            });
        }
        hit
    }

    /// Calls `meet` for each triangle of `placement` that the ray's line meets in front of its origin.
    fn each_triangle<'a>(
        &'a self,
        placement: &'a Placement,
        places: Places<'_>,
        [origin, direction]: [DVec3; 2],
        mut meet: impl FnMut(Candidate<'a>),
    ) {
        let transform = &places.transforms[placement.instance];
        let (matrix, translation) = (transform.matrix3.as_dmat3(), transform.translation.as_dvec3());
        // Facing is decided in object space: a mirror turns what the world sees.
        let mirrored = matrix.determinant() < 0.0;
        let part = &self.arrays.parts[placement.part];
        for (i, range) in part.ranges.iter().enumerate() {
            let geometry = placement.custom_index as usize + i;
            for triangle in 0..range.triangle_count {
                let corners = self
                    .corners(&self.arrays.instances[geometry], triangle)
                    .map(|vertex| matrix * places.positions[vertex].as_dvec3() + translation - origin);
                if let Some(meets) = intersect(corners, direction) {
                    let meets = Meets { front: meets.front != mirrored, ..meets };
                    let (opaque, double_sided) = (range.opaque, part.double_sided);
                    meet(Candidate { placement, geometry, triangle, opaque, double_sided, meets });
                }
            }
        }
    }

    fn corners(&self, geometry: &InstanceGeometry, triangle: u32) -> [usize; 3] {
        let first = (geometry.first_index + 3 * triangle) as usize;
        [0, 1, 2].map(|i| (geometry.first_vertex + self.arrays.indices[first + i]) as usize)
    }

    /// What the any-hit shaders decide.
    fn stops(&self, candidate: &Candidate<'_>, key: u32) -> bool {
        if candidate.opaque {
            return true;
        }
        let geometry = &self.arrays.instances[candidate.geometry];
        let material = &self.arrays.materials[geometry.material as usize];
        let corners = self.corners(geometry, candidate.triangle);
        let attributes = corners.map(|vertex| self.arrays.attributes[vertex]);
        let map = material.uv_maps[slot::BASE_COLOR];
        let second = self.arrays.features & features::UV_MAPS != 0 && map.set != 0;
        let uvs =
            corners.map(|v| if second { self.arrays.second_uvs[v] } else { self.arrays.attributes[v].uv });
        let uv = map.apply(interpolate(uvs, candidate.meets.barycentrics));
        let texture = self.scene.materials[geometry.material as usize].base_color_texture;
        let texel = texture.map_or(1.0, |index| texels::alpha(&self.scene.textures[index], uv));
        let alpha = material.alpha * texel * vertex_alpha(attributes, candidate.meets.barycentrics);
        !is_let_through(material, alpha, key, candidate.geometry as u32, candidate.triangle)
    }

    fn hit(&self, candidate: &Candidate<'_>) -> Hit {
        let material = self.arrays.instances[candidate.geometry].material as usize;
        Hit {
            t: candidate.meets.t,
            geometry: candidate.geometry as u32,
            triangle: candidate.triangle,
            instance: self.scene.instances[candidate.placement.instance].name.clone(),
            material: self.scene.materials[material].name.clone(),
        }
    }
}

/// Where a ray from 0 meets a triangle, at t >= 0. By the signs of the volumes that the ray spans with each edge: those of
/// an edge are the same number for both triangles that share it, so nothing slips between them.
fn intersect([a, b, c]: [DVec3; 3], direction: DVec3) -> Option<Meets> {
    let volumes = DVec3::new(direction.dot(b.cross(c)), direction.dot(c.cross(a)), direction.dot(a.cross(b)));
    let total = volumes.x + volumes.y + volumes.z;
    let inside = volumes.min_element() >= 0.0 || volumes.max_element() <= 0.0;
    let t = a.dot((b - a).cross(c - a)) / total;
    if !inside || total == 0.0 || t < 0.0 || !t.is_finite() {
        return None;
    }
    let barycentrics = Vec2::new((volumes.y / total) as f32, (volumes.z / total) as f32);
    Some(Meets { t, barycentrics, front: total < 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_is_met_inside_its_edges_only() {
        // In the plane z = 2, counter-clockwise for who looks along -z, so seen from behind here.
        let triangle = [DVec3::new(0.0, 0.0, 2.0), DVec3::new(1.0, 0.0, 2.0), DVec3::new(0.0, 1.0, 2.0)];
        let toward = |x: f64, y: f64| intersect(triangle, DVec3::new(x, y, 2.0));
        let hit = toward(0.25, 0.5).unwrap();
        assert_eq!((hit.t, hit.barycentrics, hit.front), (1.0, Vec2::new(0.25, 0.5), false));
        assert!(toward(-0.01, 0.5).is_none() && toward(0.6, 0.6).is_none());
        assert!(intersect(triangle, -DVec3::Z).is_none(), "behind the origin");
        assert!(intersect(triangle, DVec3::X).is_none(), "along the plane");
        let [a, b, c] = triangle;
        assert!(intersect([a, c, b], DVec3::new(0.25, 0.5, 2.0)).unwrap().front);
    }

    /// Rays at points of a shared edge, rounded as they come, meet one of its two triangles.
    #[test]
    fn nothing_slips_through_a_shared_edge() {
        let [a, b] = [DVec3::new(0.1, -0.7, 1.3), DVec3::new(-0.3, 0.9, 2.1)];
        let (left, right) = (DVec3::new(-2.0, 0.1, 1.7), DVec3::new(2.0, 0.3, 1.9));
        for i in 0..10_000 {
            let direction = a.lerp(b, (f64::from(i) + 0.5) / 10_000.0);
            let met = [[a, b, left], [b, a, right]].map(|t| intersect(t, direction).is_some());
            assert!(met[0] || met[1], "slipped through at {i}");
        }
    }
}
