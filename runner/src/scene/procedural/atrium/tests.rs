//! The hall is checked as triangles in the world, by brute force: nothing here asks the generator how it was made.

use super::*;
use crate::scene::export::to_glb;
use glam::{DVec3, Mat3};
use plan::{BAY, HALF_LENGTH, NAVE, WALL};
use std::sync::LazyLock;

struct Triangle {
    corners: [Vec3; 3],
    normals: [Vec3; 3],
    double_sided: bool,
}

static HALL: LazyLock<SceneDescription> = LazyLock::new(|| atrium(DEFAULT_LIGHT_COUNT));

/// Every triangle of the hall, in world space.
static TRIANGLES: LazyLock<Vec<Triangle>> = LazyLock::new(|| {
    let mut triangles = Vec::new();
    for instance in &HALL.instances {
        let of_normals = Mat3::from(instance.transform.matrix3).inverse().transpose();
        for primitive in &HALL.meshes[instance.mesh].primitives {
            let double_sided = HALL.materials[primitive.material].double_sided;
            for t in primitive.indices.chunks_exact(3) {
                let at = [t[0], t[1], t[2]].map(|i| i as usize);
                let corners = at.map(|i| instance.transform.transform_point3(primitive.positions[i]));
                let normals = at.map(|i| (of_normals * primitive.normals[i]).normalize());
                triangles.push(Triangle { corners, normals, double_sided });
            }
        }
    }
    triangles
});

impl Triangle {
    fn cross(&self) -> Vec3 {
        let [a, b, c] = self.corners;
        (b - a).cross(c - a)
    }

    /// Distance along the ray (Möller & Trumbore 1997).
    fn hit(&self, origin: Vec3, direction: Vec3) -> Option<f32> {
        let [a, b, c] = self.corners;
        let (e1, e2) = (b - a, c - a);
        let p = direction.cross(e2);
        let determinant = e1.dot(p);
        let s = origin - a;
        let q = s.cross(e1);
        let (u, v, t) = (s.dot(p) / determinant, direction.dot(q) / determinant, e2.dot(q) / determinant);
        (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0).then_some(t)
    }

    /// Distance to a point, m.
    fn distance(&self, p: Vec3) -> f32 {
        let [a, b, c] = self.corners;
        let n = self.cross().normalize();
        let inside = [(a, b), (b, c), (c, a)].iter().all(|&(s, e)| (e - s).cross(p - s).dot(n) >= 0.0);
        if inside {
            return (p - a).dot(n).abs();
        }
        let to_edge = |(s, e): (Vec3, Vec3)| {
            let t = ((p - s).dot(e - s) / (e - s).length_squared()).clamp(0.0, 1.0);
            p.distance(s.lerp(e, t))
        };
        [(a, b), (b, c), (c, a)].map(to_edge).into_iter().fold(f32::INFINITY, f32::min)
    }
}

/// A direction for each number, spread over the sphere (a Fibonacci lattice).
fn direction(i: usize, n: usize) -> Vec3 {
    let y = 1.0 - 2.0 * (i as f32 + 0.5) / n as f32;
    let (sin, cos) = (2.399_963_2 * i as f32).sin_cos();
    let r = (1.0 - y * y).sqrt();
    Vec3::new(r * cos, y, r * sin)
}

/// Whether the first thing that the ray meets shows it its front; None if it leaves the hall.
fn sees_front(triangles: &[Triangle], origin: Vec3, direction: Vec3) -> Option<bool> {
    let hits = triangles.iter().filter_map(|t| Some((t.hit(origin, direction)?, t)));
    let (_, nearest) = hits.min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(nearest.double_sided || nearest.cross().dot(direction) < 0.0)
}

#[test]
fn the_size_is_as_documented() {
    let count = HALL.triangle_count();
    assert!((250_000..=275_000).contains(&count), "{count} triangles");
    assert_eq!(count, TRIANGLES.len());
    assert!((20..=30).contains(&HALL.materials.len()));
    let size = HALL.bounds().extent();
    assert!((size - Vec3::new(30.0, 12.0, 18.0)).abs().max_element() < 0.5, "{size}");
    assert!(HALL.cameras.len() >= 3 && HALL.cameras[0].name == "nave");
}

#[test]
fn two_calls_give_the_same_bytes() {
    assert!(to_glb(&atrium(700)).unwrap() == to_glb(&atrium(700)).unwrap());
}

#[test]
fn every_material_and_texture_is_used() {
    let used = |i: usize| HALL.meshes.iter().flat_map(|mesh| &mesh.primitives).any(|p| p.material == i);
    for (i, material) in HALL.materials.iter().enumerate() {
        assert!(used(i), "{}", material.name);
    }
    for i in 0..HALL.textures.len() {
        let uses = |m: &crate::scene::Material| [m.base_color_texture, m.normal_texture].contains(&Some(i));
        assert!(HALL.materials.iter().any(uses), "{}", HALL.textures[i].image.name);
    }
}

#[test]
fn vertices_are_sound() {
    for mesh in &HALL.meshes {
        for p in &mesh.primitives {
            let (name, n) = (&mesh.name, p.positions.len());
            assert!(p.normals.len() == n && p.uvs.len() == n && p.colors.is_empty(), "{name}");
            assert!(!p.indices.is_empty() && p.indices.len() % 3 == 0, "{name}");
            assert!(p.indices.iter().all(|&i| (i as usize) < n), "{name}");
            assert!(
                p.positions.iter().all(|v| v.is_finite()) && p.uvs.iter().all(|v| v.is_finite()),
                "{name}"
            );
            assert!(p.normals.iter().all(|v| (v.length() - 1.0).abs() < 1e-4), "{name}");
            let bumpy = HALL.materials[p.material].normal_texture.is_some();
            assert_eq!(p.tangents.len(), if bumpy { n } else { 0 }, "{name}");
            for (tangent, normal) in p.tangents.iter().zip(&p.normals) {
                let t = tangent.truncate();
                assert!((t.length() - 1.0).abs() < 1e-4 && t.dot(*normal).abs() < 1e-4, "{name}");
                assert_eq!(tangent.w.abs(), 1.0, "{name}");
            }
        }
    }
}

#[test]
fn no_triangle_is_degenerate() {
    let smallest = TRIANGLES.iter().map(|t| 0.5 * t.cross().length()).fold(f32::INFINITY, f32::min);
    assert!(smallest > 0.5e-8, "{smallest} m²");
}

/// Smooth normals may leave the side of a facet only in the sharpest folds: cloth at its ties, tips of leaves.
#[test]
fn normals_are_on_the_side_of_the_winding() {
    let wrong =
        TRIANGLES.iter().flat_map(|t| t.normals.map(|n| n.dot(t.cross()) <= 0.0)).filter(|w| *w).count();
    assert!(wrong * 1000 <= 3 * TRIANGLES.len(), "{wrong} of {} corners", 3 * TRIANGLES.len());
}

/// Everything that can be seen from inside shows its front, and nothing is open to the outside.
#[test]
fn the_hall_is_closed_and_faces_inward() {
    let eyes = HALL.cameras.iter().map(|camera| camera.position).chain([Vec3::new(3.0, 1.7, 7.0)]);
    for eye in eyes {
        for i in 0..90 {
            let d = direction(i, 90);
            assert_eq!(sees_front(&TRIANGLES, eye, d), Some(true), "from {eye} along {d}");
        }
    }
}

/// The test above must notice an inverted vault.
#[test]
fn an_inverted_part_would_be_noticed() {
    let eye = HALL.cameras[0].position;
    let inverted: Vec<Triangle> = TRIANGLES
        .iter()
        .map(|t| {
            let [a, b, c] = t.corners;
            let up = a.y > 9.9;
            Triangle { corners: if up { [a, c, b] } else { [a, b, c] }, ..*t }
        })
        .collect();
    assert!((0..90).any(|i| sees_front(&inverted, eye, direction(i, 90)) == Some(false)));
}

#[test]
fn the_number_of_lights_is_what_was_asked_for() {
    let flux = |count: usize| -> f64 {
        let lights = lights::lights(count);
        assert_eq!(lights.len(), count);
        lights.iter().map(|light| f64::from(shared::math::luminance(light.intensity))).sum()
    };
    let reference = flux(DEFAULT_LIGHT_COUNT);
    for count in [1, 10, 499, 501, 20_000] {
        assert!((flux(count) / reference - 1.0).abs() < 1e-4, "{count} lights");
    }
    assert!(lights::lights(0).is_empty());
}

#[test]
fn the_default_is_one_light_for_each_flame() {
    let flames: usize =
        lamps::KINDS.iter().map(|&kind| lamps::mounts(kind).len() * lamps::flames(kind).len()).sum();
    assert_eq!(flames, DEFAULT_LIGHT_COUNT);
}

#[test]
fn lights_are_in_the_hall_and_not_in_columns() {
    for light in lights::lights(20_000) {
        let p = light.position;
        assert!(p.x.abs() < HALF_LENGTH - 0.1 && p.z.abs() < WALL - 0.1 && p.y > 0.15 && p.y < 12.0, "{p}");
        // The middles of the columns, ground floor: 0.31 m is the shaft's largest radius.
        let along = (p.x / BAY).round() * BAY;
        let to_axis = (p.x - along).hypot(p.z.abs() - NAVE);
        assert!(to_axis > 0.31 + 0.15 || p.y > 3.6, "{p}");
    }
}

/// Lamps' flames are near their lamps, but not in them; lights that float keep further away.
#[test]
fn lights_burn_in_free_air() {
    let lamps = lights::lights(DEFAULT_LIGHT_COUNT);
    let floating = lights::lights(20_000).split_off(DEFAULT_LIGHT_COUNT);
    let some = |lights: &[crate::scene::PointLight], step| {
        lights.iter().step_by(step).map(|light| light.position).collect::<Vec<_>>()
    };
    for (positions, least) in [(some(&lamps, 3), 0.03), (some(&floating, 97), 0.1)] {
        for p in positions {
            for t in TRIANGLES.iter() {
                let [a, b, c] = t.corners;
                let (low, high) = (a.min(b).min(c), a.max(b).max(c));
                let near = p.clamp(low, high).distance(p) < least;
                assert!(!near || t.distance(p) >= least, "{p}: {} m from {a}", t.distance(p));
            }
        }
    }
    // Inside a solid, rays meet backs.
    for p in some(&lamps, 11).into_iter().chain(some(&floating, 487)) {
        for i in 0..2 {
            assert_eq!(sees_front(&TRIANGLES, p, direction(i, 2)), Some(true), "from {p}");
        }
    }
}

/// Lambert's cosine law over a grid of the floor, without shadows.
#[test]
fn the_floor_receives_some_hundred_lux() {
    for count in [10, DEFAULT_LIGHT_COUNT, 20_000] {
        let lights = lights::lights(count);
        let (columns, rows) = (14, 8);
        let mut sum = 0.0;
        for i in 0..columns * rows {
            let u =
                DVec3::new((f64::from(i % columns) + 0.5) * 2.0, 0.0, (f64::from(i / columns) + 0.5) * 2.0);
            let p = u - DVec3::new(14.0, 0.0, 8.0);
            for light in &lights {
                let to_light = light.position.as_dvec3() - p;
                let intensity = f64::from(shared::math::luminance(light.intensity));
                sum += intensity * to_light.y / to_light.length().powi(3);
            }
        }
        let mean = sum / f64::from(columns * rows);
        assert!((100.0..300.0).contains(&mean), "{count} lights: {mean} lx");
    }
}
