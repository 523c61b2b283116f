//! The reflection model: glTF 2.0 appendix B (Lambert under a GGX microfacet lobe), and directions drawn from it.
//!
//! A direction comes from one of two lobes: the Lambertian one by the cosine, the specular one by the normals that wo sees
//! (Heitz 2018, "Sampling the GGX Distribution of Visible Normals"). The lobe is drawn by the luminance of what each reflects
//! at wo, with Schlick's F at the normal, see [`specular_probability`]; the density is that of the mixture.

#[cfg(test)]
mod sampling_tests;

use crate::material::Reflectance;
use crate::math::{basis, luminance, normalize_or, safe_ratio};
use crate::pdf::PdfSolidAngle;
use crate::reflected::Reflected;
use crate::sampling::{cap_direction, square_to_disk};
use core::f32::consts::FRAC_1_PI;
use glam::{Vec2, Vec3};
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float;

/// Least α = roughness²: a mirror lit by a point light has no finite radiance, so the narrowest lobe is 1 mrad wide.
pub const MIN_ALPHA: f32 = 1e-3;

/// f(wo, wi), 1/sr, linear RGB, for unit directions and the shading normal `n`; 0 where either is below the surface.
///
/// f = (1 - F) diffuse/π + F D V with Schlick's F at (wi·h), GGX D, height-correlated Smith V
/// (glTF 2.0 appendix B.3; Heitz 2014, eq. 99).
pub fn eval<L: Reflected>(reflectance: &Reflectance, n: Vec3, wo: Vec3, wi: Vec3) -> L {
    let cos_o = n.dot(wo);
    let cos_i = n.dot(wi);
    if !((cos_o > 0.0) & (cos_i > 0.0)) {
        return L::default();
    }
    let half = wo + wi;
    // wi·h = |wo + wi| / 2 for unit directions.
    let fresnel = schlick(reflectance.f0, 0.5 * half.length());
    let specular = specular(n, half, cos_o, cos_i, alpha(reflectance));
    L::from_lobes(reflectance.diffuse, fresnel, specular)
}

/// F = f0 + (1 - f0)(1 - cosθ)^5 (Schlick 1994).
fn schlick(f0: Vec3, cos: f32) -> Vec3 {
    let m = 1.0 - cos;
    let m2 = m * m;
    f0 + (Vec3::ONE - f0) * (m2 * m2 * m)
}

/// D(h) V(wo, wi), 1/sr, for `half` = h times any length: D of Trowbridge & Reitz 1975, with sin²θ from the cross product, which keeps its digits at narrow
/// lobes; V = G / (4 cosθo cosθi), height-correlated. One division for all.
fn specular(n: Vec3, half: Vec3, cos_o: f32, cos_i: f32, alpha: f32) -> f32 {
    let a2 = alpha * alpha;
    let cos_h = n.dot(half);
    let square = half.length_squared();
    let lobe = n.cross(half).length_squared() + cos_h * cos_h * a2;
    let o = cos_i * (cos_o * cos_o * (1.0 - a2) + a2).sqrt();
    let i = cos_o * (cos_i * cos_i * (1.0 - a2) + a2).sqrt();
    safe_ratio(0.5 * FRAC_1_PI * a2 * (square * square), lobe * lobe * (o + i))
}

fn alpha(reflectance: &Reflectance) -> f32 {
    (reflectance.roughness * reflectance.roughness).max(MIN_ALPHA)
}

/// Probability of drawing a direction from the specular lobe where cosθo = `cos_o`: s / (s + d), with the luminances
/// s = Y(F(θo)) and d = Y((1 - F(θo)) diffuse); 0 where both are black.
pub fn specular_probability(reflectance: &Reflectance, cos_o: f32) -> f32 {
    let fresnel = schlick(reflectance.f0, cos_o.clamp(0.0, 1.0));
    let specular = luminance(fresnel);
    safe_ratio(specular, specular + luminance((Vec3::ONE - fresnel) * reflectance.diffuse))
}

/// A direction wi for wo, unit, by the density [`pdf`]; it may lie below the surface, where nothing is reflected.
/// `lobe` chooses the lobe, `square` the direction in it.
pub fn sample(reflectance: &Reflectance, n: Vec3, wo: Vec3, lobe: f32, square: Vec2) -> Vec3 {
    let (tangent, bitangent) = basis(n);
    let to_world = |v: Vec3| tangent * v.x + bitangent * v.y + n * v.z;
    let cos_o = n.dot(wo);
    if lobe >= specular_probability(reflectance, cos_o) {
        // The disk lifted to the hemisphere (Malley's method): cosθ/π.
        let disk = square_to_disk(square);
        return to_world(disk.extend((1.0 - disk.length_squared()).max(0.0).sqrt()));
    }
    let alpha = alpha(reflectance);
    let local = Vec3::new(tangent.dot(wo), bitangent.dot(wo), cos_o);
    let half = to_world(visible_normal(local, alpha, square));
    half * (2.0 * wo.dot(half)) - wo
}

/// A microfacet normal as `wo` sees them, in the frame of the surface (Dupuy & Benyoub 2023, "Sampling Visible GGX Normals
/// with Spherical Caps").
fn visible_normal(wo: Vec3, alpha: f32, square: Vec2) -> Vec3 {
    let stretched = normalize_or(Vec3::new(wo.x * alpha, wo.y * alpha, wo.z), Vec3::Z);
    let half = cap_direction(-stretched.z, square) + stretched;
    normalize_or(Vec3::new(half.x * alpha, half.y * alpha, half.z.max(0.0)), Vec3::Z)
}

/// Density of [`sample`]; 0 where either direction is below the surface.
///
/// p = P D G1(wo) / (4 cosθo) + (1 - P) cosθi / π, with P of [`specular_probability`] (Heitz 2018, eq. 17; the Jacobian of
/// the mirrored direction is 1 / (4 wo·h)).
///
/// Equation (17).
pub fn pdf(reflectance: &Reflectance, n: Vec3, wo: Vec3, wi: Vec3) -> PdfSolidAngle {
    let cos_o = n.dot(wo);
    let cos_i = n.dot(wi);
    if !(cos_o > 0.0 && cos_i > 0.0) {
        return PdfSolidAngle(0.0);
    }
    let half = (wo + wi).normalize();
    let specular = visible_normal_density(n, half, cos_o, alpha(reflectance));
    let probability = specular_probability(reflectance, cos_o);
    PdfSolidAngle(probability * specular + (1.0 - probability) * cos_i * FRAC_1_PI)
}

/// D(h) G1(wo) / (4 cosθo), 1/sr, with G1 = 2 cosθo / (cosθo + √(cosθo² (1 - α²) + α²)).
fn visible_normal_density(n: Vec3, half: Vec3, cos_o: f32, alpha: f32) -> f32 {
    let a2 = alpha * alpha;
    let cos_h = n.dot(half);
    let lobe = n.cross(half).length_squared() + cos_h * cos_h * a2;
    let o = (cos_o * cos_o * (1.0 - a2) + a2).sqrt();
    safe_ratio(0.5 * FRAC_1_PI * a2, lobe * lobe * (cos_o + o))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn eval(reflectance: &Reflectance, n: Vec3, wo: Vec3, wi: Vec3) -> Vec3 {
        super::eval(reflectance, n, wo, wi)
    }

    fn direction(cos: f32, phi: f32) -> Vec3 {
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        Vec3::new(sin * phi.cos(), sin * phi.sin(), cos)
    }

    /// ∫ f cosθ dω by a midpoint rule in (cosθ², φ).
    fn albedo(reflectance: &Reflectance, wo: Vec3, n: usize) -> Vec3 {
        let mut sum = glam::DVec3::ZERO;
        for i in 0..n * n {
            let cos = (((i % n) as f32 + 0.5) / n as f32).sqrt();
            let phi = core::f32::consts::TAU * ((i / n) as f32 + 0.5) / n as f32;
            sum += eval(reflectance, Vec3::Z, wo, direction(cos, phi)).as_dvec3();
        }
        (sum * core::f64::consts::PI / (n * n) as f64).as_vec3()
    }

    /// The formulas as the literature has them, in f64: glTF 2.0 appendix B.3 with Heitz 2014's G = 1/(1 + Λo + Λi).
    fn specification(r: &Reflectance, n: Vec3, wo: Vec3, wi: Vec3) -> glam::DVec3 {
        use core::f64::consts::PI;
        let (n, v, l) = (n.as_dvec3(), wo.as_dvec3().normalize(), wi.as_dvec3().normalize());
        let h = (l + v).normalize();
        let a = f64::from(r.roughness) * f64::from(r.roughness);
        let (nl, nv, nh, vh) = (n.dot(l), n.dot(v), n.dot(h), v.dot(h));
        let d = a * a / (PI * (nh * nh * (a * a - 1.0) + 1.0).powi(2));
        let lambda = |c: f64| ((1.0 + a * a * (1.0 / (c * c) - 1.0)).sqrt() - 1.0) / 2.0;
        let g = 1.0 / (1.0 + lambda(nl) + lambda(nv));
        let f0 = r.f0.as_dvec3();
        let f = f0 + (1.0 - f0) * (1.0 - vh.abs()).powi(5);
        (1.0 - f) * r.diffuse.as_dvec3() / PI + f * d * g / (4.0 * nl * nv)
    }

    #[test]
    fn equals_the_specification() {
        for i in 0..2000 {
            let t = i as f32 / 2000.0;
            let (wo, wi) = (direction(0.02 + 0.97 * t, 7.0 * t), direction(0.99 - 0.9 * t, -11.0 * t));
            let r = Reflectance::from_metallic_roughness(
                Vec3::new(0.9, 0.4, 0.1),
                (t * 3.0) % 1.0,
                0.1 + 0.9 * t,
            );
            let (ours, exact) = (eval(&r, Vec3::Z, wo, wi).as_dvec3(), specification(&r, Vec3::Z, wo, wi));
            assert!(
                (ours - exact).abs().max_element() <= 1e-4 * exact.max_element(),
                "{ours} is not {exact} at {t}"
            );
        }
    }

    /// White furnace: a metal gives back no more light than it gets.
    #[test]
    fn metals_make_no_energy() {
        for roughness in [0.2, 0.5, 1.0] {
            for cos in [0.05, 0.2, 0.5, 0.8, 1.0] {
                let r = Reflectance::from_metallic_roughness(Vec3::ONE, 1.0, roughness);
                let a = albedo(&r, direction(cos, 0.3), 400).max_element();
                assert!(a < 1.001, "albedo {a}: roughness {roughness}, cos {cos}");
            }
        }
    }

    /// glTF's dielectric is a simple blend and does make energy at grazing angles; averaged over the hemisphere, a
    /// white one stays within 7 % of the furnace.
    #[test]
    fn dielectrics_make_little_energy() {
        for roughness in [0.2, 0.5, 1.0] {
            let r = Reflectance::from_metallic_roughness(Vec3::ONE, 0.0, roughness);
            let n = 16;
            let mean = (0..n)
                .map(|i| albedo(&r, direction(((i as f32 + 0.5) / n as f32).sqrt(), 0.3), 200).x)
                .sum::<f32>();
            assert!(
                (0.9..1.07).contains(&(mean / n as f32)),
                "mean albedo {}: roughness {roughness}",
                mean / n as f32
            );
        }
    }

    /// A smooth metal loses nothing: single scattering keeps all energy as roughness goes to 0.
    #[test]
    fn smooth_metal_reflects_all() {
        let r = Reflectance::from_metallic_roughness(Vec3::ONE, 1.0, 0.2);
        let a = albedo(&r, Vec3::Z, 2000).x;
        assert!((a - 1.0).abs() < 5e-3, "albedo {a}");
    }

    #[test]
    fn reciprocal() {
        for i in 0..1000 {
            let t = i as f32 / 1000.0;
            let wo = direction(0.02 + 0.97 * t, 7.0 * t);
            let wi = direction(0.99 - 0.9 * t, -11.0 * t);
            let r = Reflectance::from_metallic_roughness(Vec3::new(0.9, 0.4, 0.1), t, 1.0 - t);
            let (there, back) = (eval(&r, Vec3::Z, wo, wi), eval(&r, Vec3::Z, wi, wo));
            assert!((there - back).abs().max_element() <= 1e-4 * there.max_element(), "{there} and {back}");
        }
    }

    /// ∫ D cosθ dω = 1, in closed form for GGX; checked by quadrature over tanθ, where D is smooth at any width.
    #[test]
    fn microfacets_cover_the_surface_once() {
        for alpha in [MIN_ALPHA, 0.04, 0.3, 1.0] {
            let n = 20_000;
            let mut sum = 0.0f64;
            for i in 0..n {
                // u = tan²θ/(α² + tan²θ) maps the measure to du, exactly.
                let u = (f64::from(i) + 0.5) / f64::from(n);
                let tan2 = f64::from(alpha).powi(2) * u / (1.0 - u);
                let cos2 = 1.0 / (1.0 + tan2);
                let du = f64::from(alpha).powi(2) / (f64::from(alpha).powi(2) + tan2).powi(2);
                let dtan2 = 1.0 / du;
                let h = Vec3::new((1.0 - cos2).sqrt() as f32, 0.0, cos2.sqrt() as f32);
                // cosθ dω = 2π cosθ sinθ dθ = π cos⁴θ d(tan²θ).
                let jacobian = core::f64::consts::PI * cos2 * cos2 * dtan2;
                // V = 1/4 for cosθo = cosθi = 1.
                let d = 4.0 * specular(Vec3::Z, h, 1.0, 1.0, alpha);
                sum += f64::from(d) * jacobian / f64::from(n);
            }
            assert!((sum - 1.0).abs() < 1e-3, "alpha {alpha}: {sum}");
        }
    }

    #[test]
    fn hard_directions_stay_finite() {
        for roughness in [0.0, 1e-3, 1.0] {
            for cos in [1e-7, 1e-4, 1.0] {
                let r = Reflectance::from_metallic_roughness(Vec3::ONE, 1.0, roughness);
                for phi in [0.0, core::f32::consts::PI] {
                    let f = eval(&r, Vec3::Z, direction(cos, 0.0), direction(cos, phi));
                    assert!(f.is_finite() && f.min_element() >= 0.0, "{f}: roughness {roughness}, cos {cos}");
                }
            }
        }
        let r = Reflectance::from_metallic_roughness(Vec3::ONE, 0.0, 1.0);
        assert_eq!(eval(&r, Vec3::Z, Vec3::Z, -Vec3::Z), Vec3::ZERO);
        assert_eq!(eval(&r, Vec3::Z, -Vec3::Z, Vec3::Z), Vec3::ZERO);
    }
}
