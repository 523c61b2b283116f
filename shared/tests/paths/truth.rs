//! Light after one and two reflections by quadrature in f64: points of the walls, and of the lights, on a grid.

use crate::world::View;
use shared::bsdf;
use shared::glam::{DVec3, Vec2, Vec3};
use shared::material::Reflectance;
use shared::math::luminance;
use shared::surface::Surface;

/// A parallelogram that reflects.
#[derive(Clone, Copy)]
pub struct Wall {
    pub corner: Vec3,
    pub u: Vec3,
    pub v: Vec3,
    /// Of a place in it.
    pub reflectance: fn(Vec2) -> Reflectance,
}

impl Wall {
    /// Middles of n x n cells, and the area of each.
    fn cells(self, n: usize) -> impl Iterator<Item = (DVec3, Vec2)> {
        (0..n * n).map(move |i| {
            let place = Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32;
            let [u, v] = [self.u.as_dvec3() * f64::from(place.x), self.v.as_dvec3() * f64::from(place.y)];
            (self.corner.as_dvec3() + u + v, place)
        })
    }

    fn normal(self) -> DVec3 {
        self.u.as_dvec3().cross(self.v.as_dvec3()).normalize()
    }

    fn area(self) -> f64 {
        self.u.as_dvec3().cross(self.v.as_dvec3()).length()
    }
}

/// f(wo, wi) cosθi of `surface` for light from `wi`.
pub fn reflected(surface: &Surface, wi: DVec3) -> DVec3 {
    let cos = surface.normal.as_dvec3().dot(wi);
    let f: Vec3 = bsdf::eval(&surface.reflectance, surface.normal, surface.wo, wi.as_vec3());
    f.as_dvec3() * cos.max(0.0)
}

/// ∫ f cosθ L cosθ' / d² dA over `wall` as `x` sees it, with `light` what leaves a point of it toward `x`.
pub fn bounce(
    view: &View<'_>,
    x: &Surface,
    wall: Wall,
    n: usize,
    light: &dyn Fn(&Surface) -> DVec3,
) -> DVec3 {
    let (from, normal) = (x.position.as_dvec3(), wall.normal());
    let cell = wall.area() / (n * n) as f64;
    let mut sum = DVec3::ZERO;
    for (place, uv) in wall.cells(n) {
        let (d, wi) = (place - from, (place - from).normalize());
        let cos = -normal.dot(wi);
        if cos <= 0.0 || x.geometric_normal.as_dvec3().dot(wi) <= 0.0 || !view.clear(from, place) {
            continue;
        }
        let normal = normal.as_vec3();
        let y = Surface {
            position: place.as_vec3(),
            distance: 1.0,
            wo: -wi.as_vec3(),
            geometric_normal: normal,
            normal,
            reflectance: (wall.reflectance)(uv),
        };
        sum += reflected(x, wi) * light(&y) * (cos / d.length_squared() * cell);
    }
    sum
}

/// Light of one point of a light: `arriving` is what arrives without a cosine, from `to`.
pub fn lit(view: &View<'_>, y: &Surface, to: DVec3, arriving: DVec3) -> DVec3 {
    let from = y.position.as_dvec3();
    let wi = (to - from).normalize();
    if y.geometric_normal.as_dvec3().dot(wi) <= 0.0 || !view.clear(from, to) {
        return DVec3::ZERO;
    }
    reflected(y, wi) * arriving
}

pub fn y(rgb: DVec3) -> f64 {
    f64::from(luminance(rgb.as_vec3()))
}
