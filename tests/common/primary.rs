//! What a pixel may see, in f64 and by every triangle: the oracle of primary visibility. It shares no code with the
//! rasterizer, the rays or the barycentrics of the shaders.

use candela::gpu_scene::arrays::{PrimitiveRange, SceneArrays};
use candela::scene::lights::LightTable;
use candela::scene::{AlphaMode, Material, SceneDescription};
use glam::{Affine3A, DVec2, DVec3, UVec2, Vec3};
use shared::alpha::is_let_through;
use shared::camera::Camera;
use shared::geometry::InstanceGeometry;

/// Vertices fall on a grid of 1/256 pixel, so an edge may be off by half of its diagonal, and by what f32 loses before.
const MARGIN: f64 = 1.0 / 128.0;
/// Of two surfaces nearer together than this part of their distance, either may be seen.
const DEPTH: f64 = 1e-4;

/// Errors that are planted in the oracle: the test must see each of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Planted {
    #[default]
    Nothing,
    /// Pixels are seen half a pixel to the right.
    HalfPixel,
    /// Backs are seen.
    NoCulling,
    /// The facing of mirrored instances is that of the picture.
    Unturned,
    /// What is masked or blended is opaque.
    Opaque,
}

/// A triangle in the world, relative to the eye, m.
struct Triangle {
    instance: u32,
    primitive: u32,
    corners: [DVec3; 3],
    /// Vertex colors' alpha.
    alpha: [f64; 3],
    /// Index of its material.
    material: usize,
    opaque: bool,
}

/// A triangle where a pixel's center lies on it, or nearly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    pub instance: u32,
    pub primitive: u32,
    /// Along the viewing direction, m: of the plane there, and of the triangle's nearest point to it.
    pub depth: f64,
    nearest: f64,
    /// From the eye, m: least and most. Of a triangle that is not surely met, any of its points may be taken.
    pub distance: [f64; 2],
    /// Cosine of the angle that the triangle is seen at.
    pub cosine: f64,
    /// The center is inside by more than the margin, and no stochastic alpha decides.
    pub sure: bool,
}

pub struct Oracle {
    camera: Camera,
    size: UVec2,
    planted: Planted,
    triangles: Vec<Triangle>,
    /// Those that may touch each pixel.
    bins: Vec<Vec<u32>>,
    materials: Vec<shared::material::Material>,
}

impl Oracle {
    /// Of a scene whose masked and blended materials have no textures.
    pub fn new(scene: &SceneDescription, camera: Camera, size: UVec2, planted: Planted) -> Self {
        let simple = |m: &Material| m.alpha == AlphaMode::Opaque || m.base_color_texture.is_none();
        assert!(scene.materials.iter().all(simple), "the oracle reads no textures");
        let arrays = SceneArrays::new(scene, &LightTable::new(scene)).expect("the scene fits");
        let mut oracle = Oracle {
            camera,
            size,
            planted,
            triangles: Vec::new(),
            bins: vec![Vec::new(); size.element_product() as usize],
            materials: arrays.materials.clone(),
        };
        for placement in &arrays.placements {
            let part = &arrays.parts[placement.part];
            let transform = arrays.transforms[placement.instance];
            for (instance, range) in (placement.custom_index..).zip(&part.ranges) {
                for i in 0..range.triangle_count {
                    let triangle = oracle.triangle(&arrays, instance, range, i);
                    if part.double_sided || !oracle.is_back(transform, triangle.corners) {
                        oracle.add(triangle);
                    }
                }
            }
        }
        oracle
    }

    fn triangle(
        &self,
        arrays: &SceneArrays,
        instance: u32,
        range: &PrimitiveRange,
        primitive: u32,
    ) -> Triangle {
        let first = (range.first_index + 3 * primitive) as usize;
        let vertices = [0, 1, 2].map(|i| (range.first_vertex + arrays.indices[first + i]) as usize);
        let at = |i: usize| {
            relative(&arrays.instances[instance as usize], arrays.positions[i], self.camera.position)
        };
        Triangle {
            instance,
            primitive,
            corners: vertices.map(at),
            alpha: vertices.map(|i| f64::from(arrays.attributes[i].color >> 24) / 255.0),
            material: arrays.instances[instance as usize].material as usize,
            opaque: range.opaque || self.planted == Planted::Opaque,
        }
    }

    /// glTF: the front is where corners run counter-clockwise, in the mesh's own space.
    fn is_back(&self, transform: Affine3A, [a, b, c]: [DVec3; 3]) -> bool {
        let m = transform.matrix3.as_dmat3();
        let mirrors = m.determinant() < 0.0 && self.planted != Planted::Unturned;
        let towards = -(b - a).cross(c - a).dot(a) * if mirrors { -1.0 } else { 1.0 };
        towards <= 0.0 && self.planted != Planted::NoCulling
    }

    /// Sorts a triangle into the pixels that it may touch.
    fn add(&mut self, triangle: Triangle) {
        let number = self.triangles.len() as u32;
        let size = self.size.as_dvec2();
        let (mut low, mut high) = (DVec2::splat(f64::INFINITY), DVec2::splat(f64::NEG_INFINITY));
        for corner in triangle.corners {
            let depth = corner.dot(self.camera.forward.as_dvec3());
            let (right, up) = (self.camera.right.as_dvec3(), self.camera.up.as_dvec3());
            let ndc =
                DVec2::new(corner.dot(right) / right.length_squared(), -corner.dot(up) / up.length_squared());
            let pixel = (ndc / depth * 0.5 + 0.5) * size;
            // What reaches behind the eye may be anywhere.
            let place = if depth > 0.0 { [pixel, pixel] } else { [DVec2::splat(-1e9), DVec2::splat(1e9)] };
            (low, high) = (low.min(place[0]), high.max(place[1]));
        }
        let range = |low: f64, high: f64, size: u32| {
            let bound = |x: f64| x.clamp(0.0, f64::from(size)) as u32;
            bound((low - 1.0).floor())..bound((high + 1.0).ceil())
        };
        for y in range(low.y, high.y, self.size.y) {
            for x in range(low.x, high.x, self.size.x) {
                self.bins[(y * self.size.x + x) as usize].push(number);
            }
        }
        self.triangles.push(triangle);
    }

    /// What the ray through the center of `pixel` meets, or passes within the margin; nearest first. `key`: of its stochastic alpha.
    pub fn candidates(&self, pixel: UVec2, key: u32) -> Vec<Candidate> {
        let shift = if self.planted == Planted::HalfPixel { DVec2::new(1.0, 0.5) } else { DVec2::splat(0.5) };
        let ndc = (pixel.as_dvec2() + shift) / self.size.as_dvec2() * 2.0 - 1.0;
        let (right, up) = (self.camera.right.as_dvec3(), self.camera.up.as_dvec3());
        let direction = self.camera.forward.as_dvec3() + ndc.x * right - ndc.y * up;
        let steps = [right * 2.0 / f64::from(self.size.x), up * 2.0 / f64::from(self.size.y)];
        let bin = &self.bins[(pixel.y * self.size.x + pixel.x) as usize];
        let mut found: Vec<Candidate> = bin
            .iter()
            .filter_map(|&i| self.meet(&self.triangles[i as usize], direction, steps, key))
            .collect();
        found.sort_by(|a, b| a.nearest.total_cmp(&b.nearest));
        found
    }

    /// `steps`: how the direction changes from pixel to pixel.
    fn meet(&self, t: &Triangle, direction: DVec3, steps: [DVec3; 2], key: u32) -> Option<Candidate> {
        let [a, b, c] = t.corners;
        let normal = (b - a).cross(c - a);
        let facing = normal.dot(direction);
        let depth = normal.dot(a) / facing;
        // Edges as planes through the eye: their values are weights, and over their slopes distances on the picture, in
        // pixels, positive inside.
        let edges = [b.cross(c), c.cross(a), a.cross(b)].map(|edge| edge * facing.signum());
        let weights = edges.map(|edge| edge.dot(direction));
        let slope = |edge: DVec3| DVec2::new(edge.dot(steps[0]), edge.dot(steps[1])).length();
        let margin = (0..3).map(|i| weights[i] / slope(edges[i])).fold(f64::INFINITY, f64::min);
        if facing == 0.0 || margin < -MARGIN || depth <= 0.0 {
            return None;
        }
        let inside = weights.map(|w| w.max(0.0));
        let [x, y, z] = inside.map(|w| w / inside.iter().sum::<f64>());
        let point = a * x + b * y + c * z;
        let covered = margin > MARGIN;
        let alpha = t.alpha[0] * x + t.alpha[1] * y + t.alpha[2] * z;
        let stops = self.stops(t, alpha, if covered { 1e-4 } else { 0.05 }, key);
        if stops == Some(false) {
            return None;
        }
        let most = |lengths: [DVec3; 3]| lengths.map(DVec3::length).into_iter().fold(0.0, f64::max);
        let (far, edge) = (most(t.corners), most([a - b, b - c, c - a]));
        Some(Candidate {
            instance: t.instance,
            primitive: t.primitive,
            depth,
            nearest: depth.min(point.dot(self.camera.forward.as_dvec3())),
            distance: if covered { [point.length(); 2] } else { [far - edge, far] },
            cosine: (facing / normal.length() / direction.length()).abs(),
            sure: covered && stops == Some(true),
        })
    }

    /// Does `t` stop the ray with `key` where vertices' alpha is `alpha`? None: too near to the limit to say.
    fn stops(&self, t: &Triangle, alpha: f64, margin: f64, key: u32) -> Option<bool> {
        let material = &self.materials[t.material];
        let passes = [alpha - margin, alpha + margin].map(|alpha| {
            let alpha = f64::from(material.alpha) * alpha;
            !t.opaque && is_let_through(material, alpha as f32, key, t.instance, t.primitive)
        });
        (passes[0] == passes[1]).then_some(!passes[0])
    }
}

/// A vertex relative to the eye. The matrix, the place and the eye are exact as they are.
fn relative(geometry: &InstanceGeometry, p: Vec3, eye: Vec3) -> DVec3 {
    let axes = [geometry.axis_x, geometry.axis_y, geometry.axis_z].map(Vec3::as_dvec3);
    let turned = axes[0] * f64::from(p.x) + axes[1] * f64::from(p.y) + axes[2] * f64::from(p.z);
    turned + (geometry.translation.as_dvec3() - eye.as_dvec3())
}

/// Of `candidates`, those that a pixel may show: none that surely has another one before it. None at all: the background.
pub fn possible(candidates: &[Candidate]) -> (Vec<Candidate>, bool) {
    let sure = candidates.iter().filter(|c| c.sure).map(|c| c.depth).fold(f64::INFINITY, f64::min);
    let shown = candidates.iter().copied().filter(|c| c.nearest <= sure * (1.0 + DEPTH)).collect();
    (shown, sure == f64::INFINITY)
}
