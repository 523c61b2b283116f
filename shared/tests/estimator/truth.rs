//! Reflected radiance in f64: sums over delta lights in closed form, midpoint quadrature over triangles and over the sky.
//! Nothing here is the project's: no sampler, no density, no BSDF. Only light parameters and the unpacked G-buffer are read.

use crate::world::{SKY, View, World};
use shared::glam::{DVec2, DVec3, UVec2};
use shared::light::{DOUBLE_SIDED, Light, kind};
use shared::material::Reflectance;
use shared::surface::Surface;
use std::f64::consts::{PI, TAU};

/// Points along each edge of a triangle, and along each side of a texel of the sky.
const TRIANGLE_STEPS: usize = 48;
const SKY_STEPS: usize = 6;
/// And around a sphere, half of which is never seen.
const SPHERE_STEPS: usize = 128;

/// Radiance toward the camera, nit, linear RGB, of every pixel of `view`.
pub fn picture(world: &World, view: &View) -> Vec<DVec3> {
    let eye = view.camera.position.as_dvec3();
    let sky = sky(&world.lights);
    view.surfaces.iter().map(|s| radiance(world, s, eye) + from_sky(world, s, eye, &sky)).collect()
}

/// f(wo, wi) of glTF 2.0 appendix B.3 over a floor facing +Y, with Heitz 2014's G, roughness 0 as a lobe of α = 1e-3.
pub fn bsdf(r: &Reflectance, wo: DVec3, wi: DVec3) -> DVec3 {
    let (ci, co) = (wi.y, wo.y);
    if ci <= 0.0 || co <= 0.0 {
        return DVec3::ZERO;
    }
    let h = (wi + wo).normalize();
    let a2 = f64::from(r.roughness).powi(2).max(1e-3).powi(2);
    let sin2 = h.x * h.x + h.z * h.z;
    let d = a2 / (PI * (sin2 + h.y * h.y * a2).powi(2));
    let lambda = |c: f64| ((1.0 + a2 * (1.0 / (c * c) - 1.0)).sqrt() - 1.0) / 2.0;
    let g = 1.0 / (1.0 + lambda(ci) + lambda(co));
    let f0 = r.f0.as_dvec3();
    let f = f0 + (1.0 - f0) * (1.0 - wi.dot(h)).powi(5);
    (1.0 - f) * r.diffuse.as_dvec3() / PI + f * d * g / (4.0 * ci * co)
}

/// From all lights but the sky.
fn radiance(world: &World, surface: &Surface, eye: DVec3) -> DVec3 {
    let x = surface.position.as_dvec3();
    let wo = (eye - x).normalize();
    let reflect = |wi: DVec3| bsdf(&surface.reflectance, wo, wi) * wi.y.max(0.0);
    let from_point = |place: DVec3| {
        let to_light = place - x;
        // A light in the very point has no direction to come from.
        let seen = if world.visible(x, place) && to_light != DVec3::ZERO { 1.0 } else { 0.0 };
        (to_light.normalize_or_zero(), seen / to_light.length_squared().max(f64::MIN_POSITIVE))
    };
    let of_light = |light: &Light| {
        let emission = light.emission.as_dvec3();
        match light.kind {
            kind::POINT => {
                let (wi, falloff) = from_point(light.position.as_dvec3());
                reflect(wi) * emission * falloff
            }
            kind::SPOT => {
                let (wi, falloff) = from_point(light.position.as_dvec3());
                let cos_outer = f64::from(light.edge2.x);
                let t = (-wi.dot(light.edge1.as_dvec3()) - cos_outer) * f64::from(light.edge2.y);
                reflect(wi) * emission * falloff * t.clamp(0.0, 1.0).powi(2)
            }
            kind::DIRECTIONAL => {
                let wi = light.edge1.as_dvec3();
                let seen = if world.visible(x, x + wi * 1e3) { 1.0 } else { 0.0 };
                reflect(wi) * emission * seen
            }
            kind::TRIANGLE => {
                let (e1, e2) = (light.edge1.as_dvec3(), light.edge2.as_dvec3());
                let cross = e1.cross(e2);
                let (normal, area) = (cross.normalize_or_zero(), 0.5 * cross.length());
                let mut sum = DVec3::ZERO;
                for place in centroids(light.position.as_dvec3(), e1, e2) {
                    let (wi, falloff) = from_point(place);
                    let cos = -normal.dot(wi);
                    let cos = if light.flags & DOUBLE_SIDED != 0 { cos.abs() } else { cos.max(0.0) };
                    sum += reflect(wi) * falloff * cos;
                }
                sum * emission * area / (TRIANGLE_STEPS * TRIANGLE_STEPS) as f64
            }
            kind::SPHERE => {
                let (center, radius) = (light.position.as_dvec3(), f64::from(light.edge1.x));
                let from = |normal: DVec3| {
                    let (wi, falloff) = from_point(center + normal * radius);
                    reflect(wi) * falloff * (-normal.dot(wi)).max(0.0)
                };
                // I / (π r²) over 4π r².
                evenly(SPHERE_STEPS, |x, y| from(on_unit_sphere(x, y))) * emission * 4.0
            }
            kind::RECTANGLE => {
                let (u, v) = (light.edge1.as_dvec3(), light.edge2.as_dvec3());
                let cross = u.cross(v);
                let from = |place: DVec3| {
                    let (wi, falloff) = from_point(place);
                    reflect(wi) * falloff * (-cross.dot(wi)).max(0.0)
                };
                evenly(TRIANGLE_STEPS, |x, y| from(light.position.as_dvec3() + u * x + v * y)) * emission
            }
            kind::DISK => {
                let (u, v) = (light.edge1.as_dvec3(), light.edge2.as_dvec3());
                let cross = u.cross(v);
                let from = |at: DVec2| {
                    let (wi, falloff) = from_point(light.position.as_dvec3() + u * at.x + v * at.y);
                    reflect(wi) * falloff * (-cross.dot(wi)).max(0.0)
                };
                evenly(TRIANGLE_STEPS, |x, y| from(on_unit_disk(x, y))) * emission * PI
            }
            kind::SOFT_SPOT => {
                let axis = light.edge1.as_dvec3();
                let u = axis.any_orthonormal_vector() * f64::from(light.edge2.z);
                let v = axis.cross(u);
                let from = |at: DVec2| {
                    let (wi, falloff) = from_point(light.position.as_dvec3() + u * at.x + v * at.y);
                    let t = (-wi.dot(axis) - f64::from(light.edge2.x)) * f64::from(light.edge2.y);
                    reflect(wi) * falloff * t.clamp(0.0, 1.0).powi(2)
                };
                evenly(TRIANGLE_STEPS, |x, y| from(on_unit_disk(x, y))) * emission
            }
            // The sky, in one go.
            kind::ENVIRONMENT => DVec3::ZERO,
            other => panic!("no quadrature for lights of kind {other}"),
        }
    };
    world.lights.iter().map(of_light).sum()
}

/// The mean of `f` over the unit square, from the middles of `steps`² parts.
fn evenly(steps: usize, f: impl Fn(f64, f64) -> DVec3) -> DVec3 {
    let at = |i: usize| (i as f64 + 0.5) / steps as f64;
    let sum: DVec3 = (0..steps * steps).map(|i| f(at(i / steps), at(i % steps))).sum();
    sum / (steps * steps) as f64
}

/// Rings of equal area.
fn on_unit_disk(x: f64, y: f64) -> DVec2 {
    DVec2::from_angle(TAU * y) * x.sqrt()
}

/// Zones of equal area (Archimedes).
fn on_unit_sphere(x: f64, y: f64) -> DVec3 {
    let height = 1.0 - 2.0 * x;
    (DVec2::from_angle(TAU * y) * (1.0 - height * height).sqrt()).extend(height)
}

/// Centroids of the n² equal triangles that a triangle splits in.
fn centroids(a: DVec3, e1: DVec3, e2: DVec3) -> impl Iterator<Item = DVec3> {
    let n = TRIANGLE_STEPS;
    let at = move |u: f64, v: f64| a + (e1 * u + e2 * v) / n as f64;
    (0..n).flat_map(move |i| {
        (0..n - i).flat_map(move |j| {
            let (u, v) = (i as f64, j as f64);
            let upright = at(u + 1.0 / 3.0, v + 1.0 / 3.0);
            let inverted = (j + 1 < n - i).then(|| at(u + 2.0 / 3.0, v + 2.0 / 3.0));
            [Some(upright), inverted].into_iter().flatten()
        })
    })
}

/// Directions of the upper hemisphere, each with radiance times solid angle.
fn sky(lights: &[Light]) -> Vec<(DVec3, DVec3)> {
    let texels: Vec<_> = lights.iter().filter(|light| light.kind == kind::ENVIRONMENT).collect();
    let UVec2 { x: width, y: height } = SKY * SKY_STEPS as u32;
    let mut sky = Vec::new();
    for i in 0..texels.len() * SKY_STEPS * SKY_STEPS {
        let (column, row) = (i as u32 % width, i as u32 / width);
        // The picture's rows part the angle from the zenith evenly.
        let [theta0, theta, theta1] = [0.0, 0.5, 1.0].map(|s| (f64::from(row) + s) / f64::from(height) * PI);
        let phi = ((f64::from(column) + 0.5) / f64::from(width) - 0.5) * TAU;
        let solid_angle = (theta0.cos() - theta1.cos()) * TAU / f64::from(width);
        let direction = DVec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin());
        let texel = row as usize / SKY_STEPS * SKY.x as usize + column as usize / SKY_STEPS;
        if direction.y > 0.0 {
            sky.push((direction, texels[texel].emission.as_dvec3() * solid_angle));
        }
    }
    sky
}

fn from_sky(world: &World, surface: &Surface, eye: DVec3, sky: &[(DVec3, DVec3)]) -> DVec3 {
    let x = surface.position.as_dvec3();
    let wo = (eye - x).normalize();
    let seen = sky.iter().filter(|(wi, _)| world.visible(x, x + *wi * 1e3));
    seen.map(|&(wi, light)| bsdf(&surface.reflectance, wo, wi) * wi.y * light).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::glam::Vec3;

    /// Irradiance from a triangle, Lambert's closed form E = L/2 Σ θ_i Γ_i·n over its edges, and from an even sky, E = π L: a
    /// white diffuse floor without Fresnel term reflects E/π. The quadratures are within 1e-3 of both.
    #[test]
    fn quadratures_agree_with_closed_forms() {
        let white = Reflectance { diffuse: Vec3::ONE, f0: Vec3::ZERO, roughness: 1.0 };
        // Lambertian part: what the Fresnel term takes is added back by measuring with f alone.
        let corners = [Vec3::new(-0.5, 2.0, -0.5), Vec3::new(0.7, 2.2, -0.5), Vec3::new(-0.5, 1.9, 0.8)];
        let light = Light::triangle(corners, Vec3::splat(7.0), true);
        let d = corners.map(|c| c.as_dvec3().normalize());
        let lambert: f64 = (0..3)
            .map(|i| {
                let (a, b) = (d[i], d[(i + 1) % 3]);
                a.dot(b).acos() * a.cross(b).normalize().y
            })
            .sum();
        let (e1, e2) = (light.edge1.as_dvec3(), light.edge2.as_dvec3());
        let area_normal = 0.5 * e1.cross(e2);
        let sum: f64 = centroids(corners[0].as_dvec3(), e1, e2)
            .map(|p| p.normalize().y * area_normal.dot(p.normalize()).abs() / p.length_squared())
            .sum::<f64>()
            / (TRIANGLE_STEPS * TRIANGLE_STEPS) as f64;
        assert!((sum / (lambert.abs() / 2.0) - 1.0).abs() < 1e-3, "{sum} instead of {}", lambert / 2.0);

        let even: Vec<_> = (0..SKY.x * SKY.y)
            .map(|i| Light::environment(UVec2::new(i % SKY.x, i / SKY.x), SKY, Vec3::ONE, 1.0))
            .collect();
        let irradiance: f64 = sky(&even).iter().map(|(wi, light)| wi.y * light.x).sum();
        assert!((irradiance / PI - 1.0).abs() < 1e-3, "{irradiance} instead of π");
        let overhead = bsdf(&white, DVec3::Y, DVec3::Y);
        assert!((overhead.x - 1.0 / PI).abs() < 1e-12, "{overhead}");
    }
}
