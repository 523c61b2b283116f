//! A floor seen by a camera that moves to and fro, lights of every kind, and a screen in between.

use shared::alias_table::AliasEntry;
use shared::camera::Camera;
use shared::geometry::SurfacePoint;
use shared::glam::{DMat3, DVec3, UVec2, Vec2, Vec3};
use shared::interface::HitPayload;
use shared::light::tree::{self, Tree};
use shared::light::{Light, LightTable, Lights, UNTRACEABLE, build_alias_table, kind};
use shared::material::Reflectance;
use shared::math::{CENTER, pack_place, unpack_place};
use shared::points::Aim;
use shared::shadow::ShadowRay;
use shared::surface::{GBufferTexel, Surface};

/// Size of the environment maps.
pub const SKY: UVec2 = UVec2::new(16, 8);
/// Radius of the bounding sphere that light from infinity is told, m.
const RADIUS: f32 = 10.0;

/// What one frame sees.
pub struct View {
    pub camera: Camera,
    pub gbuffer: Vec<GBufferTexel>,
    pub surfaces: Vec<Surface>,
    /// Of points that last; empty where all lie behind pixels' centers.
    pub aims: Vec<Aim>,
}

#[derive(Clone)]
pub struct World {
    pub size: UVec2,
    pub reflectance: Reflectance,
    /// Where the cameras of even and of odd frames stand, m above a floor at y = 0.
    pub eyes: [Vec3; 2],
    pub forward: Vec3,
    pub lights: Vec<Light>,
    pub alias: Vec<AliasEntry>,
    pub tree: Tree,
    /// A square screen at y = 0.25, |x| < 0.6, |z| < 0.6, which only shadow rays meet.
    pub screen: bool,
    /// Odd frames shade the points of even frames that fall into their pixels, and even ones those again.
    pub lasting: bool,
}

impl World {
    /// Two cameras a few pixels apart, so that reuse over time crosses from pixel to pixel.
    pub fn new(lights: Vec<Light>) -> Self {
        World {
            size: UVec2::new(16, 12),
            reflectance: Reflectance::from_metallic_roughness(Vec3::new(0.8, 0.5, 0.3), 0.2, 0.6),
            eyes: [Vec3::new(0.0, 3.0, 3.0), Vec3::new(0.55, 3.1, 3.2)],
            forward: Vec3::new(0.0, -1.0, -0.9),
            alias: build_alias_table(&lights),
            tree: tree::build(&lights),
            lights,
            screen: false,
            lasting: false,
        }
    }

    /// With other lights, of which the tables know.
    pub fn with_lights(self, lights: Vec<Light>) -> Self {
        let World { alias, tree, lights, .. } = World::new(lights);
        World { alias, tree, lights, ..self }
    }

    pub fn behind_a_screen(self) -> Self {
        World { screen: true, ..self }
    }

    pub fn with_points_that_last(self) -> Self {
        World { lasting: true, ..self }
    }

    pub fn reflecting(self, metallic: f32, roughness: f32) -> Self {
        let color = Vec3::new(0.8, 0.5, 0.3);
        let reflectance = Reflectance::from_metallic_roughness(color, metallic, roughness);
        World { reflectance, ..self }
    }

    pub fn table(&self) -> LightTable<'_> {
        LightTable { lights: Lights::untextured(&self.lights), alias: &self.alias }
    }

    pub fn pixels(&self) -> impl Iterator<Item = UVec2> + use<> {
        let size = self.size;
        (0..size.x * size.y).map(move |i| UVec2::new(i % size.x, i / size.x))
    }

    /// What even (0) or odd (1) frames see.
    pub fn view(&self, parity: u32) -> View {
        let camera = Camera::new(self.eyes[parity as usize], self.forward, Vec3::Y, 0.8, self.size);
        let aims = self.aims(parity);
        let place = |i: usize| aims.get(i).map_or(CENTER, |aim| aim.place);
        let texels = self.pixels().enumerate().map(|(i, pixel)| self.texel(&camera, pixel, place(i)));
        let gbuffer: Vec<_> = texels.collect();
        let surfaces =
            self.pixels().zip(&gbuffer).map(|(p, t)| t.unpack(u32::MAX, &camera, p, self.size)).collect();
        View { camera, gbuffer, surfaces, aims }
    }

    fn aims(&self, parity: u32) -> Vec<Aim> {
        if !self.lasting {
            return Vec::new();
        }
        let centers = World { lasting: false, ..self.clone() };
        let [even, odd] = [0, 1].map(|parity| centers.view(parity));
        let mut aims = [(); 2].map(|()| vec![Aim::anew(CENTER); even.surfaces.len()]);
        for (i, surface) in even.surfaces.iter().enumerate() {
            let at = odd.camera.project(surface.position - odd.camera.position, self.size);
            if at.cmplt(Vec2::ZERO).any() || at.cmpge(self.size.as_vec2()).any() {
                continue;
            }
            let pixel = at.as_uvec2();
            let j = (pixel.y * self.size.x + pixel.x) as usize;
            if aims[1][j].source().is_none() {
                aims[1][j] = Aim::at_point(pack_place(at - pixel.as_vec2()), i as u32);
                aims[0][i] = Aim::at_point(CENTER, j as u32);
            }
        }
        aims[parity as usize].clone()
    }

    fn texel(&self, camera: &Camera, pixel: UVec2, place: u32) -> GBufferTexel {
        let direction = camera.direction(pixel.as_vec2() + unpack_place(place), self.size);
        let position = camera.position - direction * (camera.position.y / direction.y);
        let point = SurfacePoint {
            position,
            geometric_normal: Vec3::Y,
            normal: Vec3::Y,
            tangent: Vec3::X,
            tangent_sign: 1.0,
            uv: Vec2::ZERO,
            color: Vec3::ONE,
        };
        GBufferTexel::new(&point, Vec3::Y, self.reflectance, 0, camera.position).seen_through(place)
    }

    /// Does the segment miss the screen?
    pub fn visible(&self, from: DVec3, to: DVec3) -> bool {
        let at = from + (to - from) * ((0.25 - from.y) / (to.y - from.y));
        !(self.screen && from.y < 0.25 && to.y > 0.25 && at.x.abs() < 0.6 && at.z.abs() < 0.6)
    }

    pub fn trace(&self, ray: ShadowRay) -> bool {
        self.visible(ray.origin.as_dvec3(), (ray.origin + ray.direction).as_dvec3())
    }
}

impl World {
    /// What a BSDF ray meets, in f64: the nearest triangle light, from either side, by its index as a primitive of instance 0,
    /// which has lights, or of instance 1 without; or the screen, as the latter, which `blind` rays pass. Lights hide one another
    /// from these rays alone: use such as don't.
    pub fn nearest(&self, origin: Vec3, direction: Vec3, blind: bool) -> HitPayload {
        let hit = |instance, primitive| HitPayload { hit: 1, instance, primitive, ..HitPayload::default() };
        let (x, d) = (origin.as_dvec3(), direction.as_dvec3());
        if !blind && !self.visible(x, x + d * 1e3) {
            return hit(1, 0);
        }
        let distance = |light: &Light| {
            let (e1, e2) = (light.edge1.as_dvec3(), light.edge2.as_dvec3());
            let solved = DMat3::from_cols(d, -e1, -e2).inverse() * (light.position.as_dvec3() - x);
            let inside = solved.y >= 0.0 && solved.z >= 0.0 && solved.y + solved.z <= 1.0 && solved.x > 0.0;
            if inside { solved.x } else { f64::INFINITY }
        };
        let met = (0..self.lights.len()).filter(|&i| self.lights[i].kind == kind::TRIANGLE);
        let nearest = met.map(|i| (distance(&self.lights[i]), i)).min_by(|a, b| a.0.total_cmp(&b.0));
        match nearest {
            Some((t, light)) if t < f64::INFINITY => {
                hit(u32::from(self.lights[light].flags & UNTRACEABLE != 0), light as u32)
            }
            _ => HitPayload::default(),
        }
    }
}

/// A kind of light: what lights every pixel, where 1/M weights must be right, and what lights only some of them.
pub struct Kind {
    pub everywhere: Vec<Light>,
    pub somewhere: Vec<Light>,
}

fn around(i: usize, step: f32) -> Vec3 {
    let (angle, radius) = (i as f32 * 2.4, 0.3 + i as f32 * step);
    Vec3::new(angle.cos() * radius, 0.5 + (i % 4) as f32 * 0.7, angle.sin() * radius)
}

/// Strengths over two orders of magnitude.
fn strength(i: usize) -> Vec3 {
    Vec3::new(1.0, 0.7, 0.4) * 10f32.powi(i as i32 % 3 - 1)
}

pub fn points() -> Kind {
    let lights: Vec<_> = (0..24).map(|i| Light::point(around(i, 0.1), strength(i))).collect();
    Kind { everywhere: lights.clone(), somewhere: lights }
}

pub fn triangles() -> Kind {
    let at = |i: usize| around(i, 0.25) + Vec3::Y * 0.3;
    let facing_down = |i: usize| {
        let corner = at(i);
        Light::triangle([corner, corner + Vec3::X * 0.5, corner + Vec3::Z * 0.6], strength(i) * 5.0, false)
    };
    // Upright and leaning ones, both sides of some of which emit, and one that sinks into the floor.
    let leaning = |i: usize| {
        let corner = at(i) - Vec3::Y * 0.6 * (i % 3) as f32;
        let up = Vec3::new(0.2, 0.7, 0.1 * i as f32);
        Light::triangle([corner, corner + up, corner + Vec3::X * 0.8], strength(i) * 5.0, i.is_multiple_of(2))
    };
    Kind { everywhere: (0..7).map(facing_down).collect(), somewhere: (0..7).map(leaning).collect() }
}

/// Rectangles, as glTF has them: two triangles each.
pub fn rectangles() -> Kind {
    let rectangle = |i: usize, u: Vec3, v: Vec3| {
        let (a, radiance) = (around(i, 0.3) + Vec3::Y * 0.2, strength(i) * 4.0);
        [[a, a + u, a + u + v], [a, a + u + v, a + v]].map(|t| Light::triangle(t, radiance, false))
    };
    let down = |i| rectangle(i, Vec3::X * 0.7, Vec3::Z * 0.3);
    let wall = |i: usize| rectangle(i, Vec3::new(0.5, 0.0, 0.3 - 0.2 * i as f32), Vec3::new(0.0, 0.6, 0.2));
    Kind { everywhere: (0..4).flat_map(down).collect(), somewhere: (0..5).flat_map(wall).collect() }
}

/// Triangles in one plane, none before another, where a mirror would show them. Somewhere: every third shows its dark side.
pub fn ceiling() -> Kind {
    let triangle = |i: usize, up: bool| {
        let corner = Vec3::new((i % 3) as f32 * 1.1 - 1.6, 2.0, (i / 3) as f32 * 1.2 - 3.6);
        let (u, v) = (Vec3::X * 0.9, Vec3::Z * (0.5 + 0.1 * (i % 5) as f32));
        let edges = if up { [corner + v, corner + u] } else { [corner + u, corner + v] };
        let radiance = strength(i) * 5.0;
        Light::triangle([corner, edges[0], edges[1]], radiance, !up && i.is_multiple_of(2))
    };
    Kind {
        everywhere: (0..9).map(|i| triangle(i, false)).collect(),
        somewhere: (0..9).map(|i| triangle(i, i % 3 == 1)).collect(),
    }
}

/// With lights that no ray can find: points, suns, and triangles that are said to be such.
pub fn half_found() -> Kind {
    let mixed = |found: Vec<Light>| {
        let hidden = |(i, light)| match i % 4 {
            0 => Light { flags: UNTRACEABLE, ..light },
            _ => light,
        };
        let triangles = found.into_iter().enumerate().map(hidden);
        triangles.chain(points().everywhere).chain(suns().everywhere).collect()
    };
    let Kind { everywhere, somewhere } = ceiling();
    Kind { everywhere: mixed(everywhere), somewhere: mixed(somewhere) }
}

pub fn spots() -> Kind {
    let spot = |i: usize, inner, outer| {
        let axis = Vec3::new(0.2 - 0.05 * i as f32, -1.0, 0.1).normalize();
        Light::spot(around(i, 0.2) + Vec3::Y, axis, strength(i), inner, outer)
    };
    Kind {
        everywhere: (0..8).map(|i| spot(i, 0.1 * i as f32, 1.45)).collect(),
        somewhere: (0..8).map(|i| spot(i, 0.05 * i as f32, 0.45)).collect(),
    }
}

/// Small and large ones; somewhere: sunk into the floor.
pub fn spheres() -> Kind {
    let sphere = |i: usize, lift: f32| {
        let center = around(i, 0.25) + Vec3::Y * lift;
        Light::sphere(center, 0.05 + 0.12 * (i % 4) as f32, strength(i))
    };
    Kind {
        everywhere: (0..8).map(|i| sphere(i, 0.2)).collect(),
        somewhere: (0..8).map(|i| sphere(i, -0.3 * (i % 3) as f32)).collect(),
    }
}

/// Flat lights that look down, or aside as well.
pub fn panels() -> Kind {
    let rectangle = |i: usize, u: Vec3, v: Vec3| {
        Light::rectangle(around(i, 0.25) + Vec3::Y * 0.4, [u, v], strength(i) * 4.0)
    };
    let disk = |i: usize, axis: Vec3| {
        let center = around(i + 4, 0.2) + Vec3::Y * 0.4;
        Light::disk(center, axis.normalize(), 0.2 + 0.1 * (i % 3) as f32, strength(i + 1) * 5.0)
    };
    let tilt = |i: usize| Vec3::new(0.5, 0.3 * (i % 3) as f32 - 0.4, 0.4 - 0.2 * i as f32);
    let down = (0..4).flat_map(|i| [rectangle(i, Vec3::X * 0.7, Vec3::Z * 0.4), disk(i, Vec3::NEG_Y)]);
    let leaning = (0..4).flat_map(|i| [rectangle(i, tilt(i), Vec3::Y * 0.6), disk(i, tilt(i))]);
    Kind { everywhere: down.collect(), somewhere: leaning.collect() }
}

pub fn soft_spots() -> Kind {
    let soften = |lights: Vec<Light>| {
        let soft = |(i, spot): (usize, Light)| spot.soft_spot(0.1 + 0.1 * (i % 3) as f32);
        lights.into_iter().enumerate().map(soft).collect()
    };
    let Kind { everywhere, somewhere } = spots();
    Kind { everywhere: soften(everywhere), somewhere: soften(somewhere) }
}

pub fn suns() -> Kind {
    let sun = |i: usize| {
        let direction = Vec3::new(i as f32 - 2.0, 1.5, (i % 2) as f32).normalize();
        Light::directional(direction, strength(i), RADIUS)
    };
    let lights: Vec<_> = (0..5).map(sun).collect();
    Kind { everywhere: lights.clone(), somewhere: lights }
}

fn sky(below: f32) -> Vec<Light> {
    let radiance = |i: u32| match (i % SKY.x, i / SKY.x) {
        (5, 2) => Vec3::new(30.0, 20.0, 10.0),
        (x, y) if y < SKY.y / 2 => Vec3::new(0.1, 0.2, 0.3) * (1 + x % 3 + y) as f32,
        _ => Vec3::splat(below),
    };
    let texel = |i: u32| Light::environment(UVec2::new(i % SKY.x, i / SKY.x), SKY, radiance(i), RADIUS);
    (0..SKY.x * SKY.y).map(texel).collect()
}

pub fn environment() -> Kind {
    Kind { everywhere: sky(0.0), somewhere: sky(0.3) }
}

/// All kinds in one table.
pub fn together() -> Kind {
    let kinds = [
        points(),
        triangles(),
        rectangles(),
        spots(),
        suns(),
        environment(),
        spheres(),
        panels(),
        soft_spots(),
    ];
    let mut all = Kind { everywhere: Vec::new(), somewhere: Vec::new() };
    for kind in kinds {
        all.everywhere.extend(kind.everywhere);
        all.somewhere.extend(kind.somewhere);
    }
    all
}
