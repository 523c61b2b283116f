//! A few squares under any lights, with rays that ask every triangle in f64.

use bytemuck::Zeroable;
use shared::alias_table::AliasEntry;
use shared::alpha::is_let_through;
use shared::camera::Camera;
use shared::environment::EnvironmentTexel;
use shared::frame::{FrameConstants, features};
use shared::geometry::{InstanceGeometry, VertexAttributes, pack_tangent};
use shared::glam::{Affine3A, DVec3, UVec2, UVec3, Vec2, Vec3, Vec4};
use shared::interface::{HitPayload, PassConstants};
use shared::light::{Light, build_alias_table};
use shared::material::{Material, NO_TEXTURE, flag, slot};
use shared::math::{luminance, pack_direction};
use shared::passes::{At, Question, Visibility, Witness, paths};
use shared::scene::Scene;
use shared::shadow::ShadowRay;
use shared::surface::{GBufferTexel, Surface};
use shared::textures::Texels;

/// Radius of the bounding sphere that light from infinity is told, m.
pub const RADIUS: f32 = 20.0;

#[derive(Default)]
pub struct World {
    materials: Vec<Material>,
    instances: Vec<InstanceGeometry>,
    positions: Vec<Vec3>,
    attributes: Vec<VertexAttributes>,
    indices: Vec<u32>,
    pub lights: Vec<Light>,
    sky: Vec<EnvironmentTexel>,
    pub sky_size: UVec2,
    pub first_sky_light: u32,
    pub alias: Vec<AliasEntry>,
    pub features: u32,
}

/// Reflects `color` as Lambert has it, and nothing else.
pub fn matt(color: Vec3) -> Material {
    Material { specular: Vec3::ZERO, ..glossy(color, 0.0, 1.0) }
}

/// A dielectric of F0 0.04, or a metal.
pub fn glossy(color: Vec3, metallic: f32, roughness: f32) -> Material {
    let specular = Vec3::splat(0.04);
    let textures = [NO_TEXTURE; slot::COUNT];
    Material { base_color: color, alpha: 1.0, metallic, specular, roughness, textures, ..Material::zeroed() }
}

/// Emits `radiance` (nit) from its front and reflects nothing.
pub fn lamp(radiance: Vec3) -> Material {
    Material { emission: radiance, ..matt(Vec3::ZERO) }
}

impl World {
    /// A parallelogram whose front is on the side of u x v.
    pub fn square(&mut self, corner: Vec3, u: Vec3, v: Vec3, material: Material) {
        let (first_index, first_vertex) = (self.indices.len() as u32, self.positions.len() as u32);
        let material_index = self.materials.len() as u32;
        let mut geometry =
            InstanceGeometry::new(Affine3A::IDENTITY, first_index, first_vertex, material_index);
        let corners = [corner, corner + u, corner + u + v, corner + v];
        if material.emission != Vec3::ZERO {
            geometry.first_light = self.lights.len() as u32;
            let both = material.has(flag::DOUBLE_SIDED);
            for [a, b, c] in [[0, 1, 2], [0, 2, 3]] {
                self.lights.push(Light::triangle(
                    [corners[a], corners[b], corners[c]],
                    material.emission,
                    both,
                ));
            }
            self.features |= features::TRACEABLE;
        }
        let attributes = |uv| VertexAttributes {
            normal: pack_direction(u.cross(v).normalize()),
            tangent: pack_tangent(u.normalize(), 1.0),
            uv,
            color: u32::MAX,
        };
        self.attributes.extend([Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y].map(attributes));
        self.positions.extend(corners);
        self.indices.extend([0, 1, 2, 0, 2, 3]);
        self.features |=
            if material.textures[slot::BASE_COLOR] == NO_TEXTURE { 0 } else { features::TEXTURES };
        self.materials.push(material);
        self.instances.push(geometry);
    }

    /// A sky of `size` texels; call it after all squares that emit.
    pub fn sky(&mut self, size: UVec2, radiance: impl Fn(UVec2) -> Vec3) {
        (self.sky_size, self.first_sky_light) = (size, self.lights.len() as u32);
        for i in 0..size.x * size.y {
            let texel = UVec2::new(i % size.x, i / size.x);
            self.lights.push(Light::environment(texel, size, radiance(texel), RADIUS));
            self.sky.push(EnvironmentTexel { radiance: radiance(texel), light: i });
        }
        self.features |= features::TRACEABLE | features::ENVIRONMENT;
    }

    /// All is there.
    pub fn finished(mut self) -> Self {
        self.alias = build_alias_table(&self.lights);
        self.features |= features::LIGHT_KINDS;
        self
    }

    pub fn scene(&self) -> Scene<'_> {
        Scene {
            features: self.features,
            instances: &self.instances,
            positions: &self.positions,
            attributes: &self.attributes,
            indices: &self.indices,
            materials: &self.materials,
            second_uvs: &[],
            environment: &self.sky,
        }
    }

    /// Distance in lengths of `direction`, and the hit, of all triangles that the ray meets and that do not let it through.
    fn hits(&self, origin: Vec3, direction: Vec3, key: u32) -> impl Iterator<Item = (f64, HitPayload)> + '_ {
        let (x, d) = (origin.as_dvec3(), direction.as_dvec3());
        (0..self.indices.len() / 3).filter_map(move |triangle| {
            let (instance, primitive) = (triangle as u32 / 2, triangle as u32 % 2);
            let base = 4 * (triangle / 2);
            let at = |i: usize| self.positions[base + self.indices[3 * triangle + i] as usize].as_dvec3();
            let (t, b) = meets([at(0), at(1), at(2)], x, d)?;
            let material = &self.materials[instance as usize];
            let transparent = material.has(flag::BLEND)
                && is_let_through(material, material.alpha, key, instance, primitive);
            (!transparent).then_some((t, HitPayload { hit: 1, instance, primitive, barycentrics: b, key }))
        })
    }

    fn nearest(&self, origin: Vec3, direction: Vec3, key: u32) -> HitPayload {
        let nearest = self.hits(origin, direction, key).min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.map_or(HitPayload { key, ..HitPayload::default() }, |(_, hit)| hit)
    }

    /// What the center of `pixel` sees.
    pub fn texel(&self, camera: &Camera, pixel: UVec2, size: UVec2) -> GBufferTexel {
        let eye = camera.position;
        let hit = self.nearest(eye, camera.direction(pixel.as_vec2() + 0.5, size), 1);
        assert_eq!(hit.hit, 1, "{pixel} sees nothing");
        self.scene().met(Grid, hit.into()).seen.texel(eye)
    }

    /// What the eye sees along `forward`.
    pub fn view(&self, eye: Vec3, forward: Vec3) -> View<'_> {
        let camera = Camera::new(eye, forward, Vec3::new(0.1, 1.0, 0.2).normalize(), 0.5, UVec2::ONE);
        let texel = self.texel(&camera, UVec2::ZERO, UVec2::ONE);
        let surface = texel.unpack(u32::MAX, &camera, UVec2::ZERO, UVec2::ONE);
        View { world: self, camera, gbuffer: [texel], surface }
    }
}

/// Where x + t d meets a triangle at t > 0: t, and the weights of the second and third corner.
fn meets([a, b, c]: [DVec3; 3], x: DVec3, d: DVec3) -> Option<(f64, Vec2)> {
    let (u, v) = (b - a, c - a);
    let p = d.cross(v);
    let determinant = u.dot(p);
    let s = x - a;
    let q = s.cross(u);
    let (bu, bv, t) = (s.dot(p) / determinant, d.dot(q) / determinant, v.dot(q) / determinant);
    (bu >= 0.0 && bv >= 0.0 && bu + bv <= 1.0 && t > 0.0 && t.is_finite())
        .then(|| (t, Vec2::new(bu as f32, bv as f32)))
}

/// The one texture: see [`grid`].
#[derive(Clone, Copy)]
pub struct Grid;

/// Color of a texture with four fields, each even.
pub fn grid(uv: Vec2) -> Vec3 {
    match (uv.x < 0.5, uv.y < 0.5) {
        (true, true) => Vec3::new(0.9, 0.2, 0.1),
        (false, true) => Vec3::new(0.1, 0.8, 0.3),
        (true, false) => Vec3::new(0.2, 0.3, 0.9),
        (false, false) => Vec3::splat(0.7),
    }
}

impl Texels for Grid {
    fn size(self, _: u32) -> UVec2 {
        UVec2::splat(2)
    }

    fn sample(self, _: u32, uv: Vec2, lod: f32) -> Vec4 {
        assert_eq!(lod, 0.0, "the finest level");
        grid(uv).extend(1.0)
    }
}

/// The rays of a world.
#[derive(Clone, Copy)]
pub struct Rays<'a>(pub &'a World);

impl Visibility for Rays<'_> {
    const TRACES: bool = true;

    fn sees(&mut self, _: Question, ray: ShadowRay, key: u32) -> bool {
        self.0.hits(ray.origin, ray.direction, key).all(|(t, _)| t >= 1.0)
    }

    fn nearest(&mut self, origin: Vec3, direction: Vec3, key: u32) -> HitPayload {
        self.0.nearest(origin, direction, key)
    }
}

/// One pixel of a picture.
pub struct View<'a> {
    world: &'a World,
    camera: Camera,
    gbuffer: [GBufferTexel; 1],
    pub surface: Surface,
}

/// A mean of independent estimates, and its standard error.
#[derive(Clone, Copy, Debug)]
pub struct Estimate {
    pub mean: f64,
    pub error: f64,
}

impl Estimate {
    /// How many standard errors it is off; what is left where nothing is left to chance is rounding.
    pub fn t(self, truth: f64) -> f64 {
        (self.mean - truth).abs() / (self.error + 2e-5 * truth.abs() + f64::MIN_POSITIVE)
    }
}

impl View<'_> {
    /// Luminance of `count` paths, nit.
    pub fn paths(&self, bounces: u32, count: u32, note: impl Witness + Copy) -> Estimate {
        let World { lights, alias, instances, positions, attributes, indices, materials, sky, .. } =
            self.world;
        let (mut sum, mut squares) = (0.0, 0.0);
        for index in 0..count {
            let frame = FrameConstants {
                camera: self.camera,
                size: UVec2::ONE,
                index,
                environment_size: self.world.sky_size,
                first_environment_light: self.world.first_sky_light,
                ..FrameConstants::zeroed()
            };
            let constants = PassConstants { bounces, paths: 1, ..PassConstants::default() };
            let at = At::new(&frame, constants, self.world.features, 0, UVec3::ZERO);
            let light = paths::paths(
                at,
                Rays(self.world),
                note,
                lights,
                alias,
                instances,
                positions,
                attributes,
                indices,
                materials,
                &[],
                sky,
                Grid,
                &self.gbuffer,
            );
            let light = f64::from(luminance(light));
            sum += light;
            squares += light * light;
        }
        let n = f64::from(count);
        let mean = sum / n;
        Estimate { mean, error: ((squares / n - mean * mean).max(0.0) / (n - 1.0)).sqrt() }
    }

    /// Is nothing opaque between two points? In f64, but for their surfaces.
    pub fn clear(&self, from: DVec3, to: DVec3) -> bool {
        let (x, d) = (from.as_vec3(), (to - from).as_vec3());
        self.world.hits(x, d, shared::alpha::SURE_HITS_ONLY).all(|(t, _)| !(1e-5..=1.0 - 1e-5).contains(&t))
    }
}
