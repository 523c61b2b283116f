//! The integrand of direct lighting, and its luminance: the only p̂.

use crate::bsdf;
use crate::light::Incident;
use crate::math::luminance;
use crate::reflected::Reflected;
use crate::surface::Surface;

/// f(wo, wi) Le G without visibility: reflected radiance per measure of the light (nit/m² or nit), linear RGB.
/// 0 for light from behind the surface, real or shaded.
///
/// Equation (1): Bitterli (1), Bitterli (2); thesis (4.1), thesis (4.2).
pub fn unshadowed<L: Reflected>(surface: &Surface, incident: &Incident) -> L {
    let cos = surface.normal.dot(incident.direction);
    if (surface.geometric_normal.dot(incident.direction) <= 0.0) | (cos <= 0.0) {
        return L::default();
    }
    bsdf::eval::<L>(&surface.reflectance, surface.normal, surface.wo, incident.direction)
        * incident.irradiance
        * cos
}

/// p̂ = luminance of [`unshadowed`] (Bitterli et al. 2020, section 3).
///
/// Equation (12): Bitterli section 5; thesis section 4.1.5.
pub fn target_function(surface: &Surface, incident: &Incident) -> f32 {
    luminance(unshadowed(surface, incident))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::Light;
    use crate::material::Reflectance;
    use glam::{Vec2, Vec3};

    fn floor() -> Surface {
        Surface {
            position: Vec3::ZERO,
            distance: 1.0,
            wo: Vec3::Y,
            geometric_normal: Vec3::Y,
            normal: Vec3::Y,
            reflectance: Reflectance { diffuse: Vec3::splat(0.5), f0: Vec3::ZERO, roughness: 1.0 },
        }
    }

    /// A point light over a diffuse floor: L = ρ/π I cosθ/d² (1 - F) + the specular term, which for f0 = 0 and
    /// wi = wo = n is 0.
    #[test]
    fn overhead_point_light_in_closed_form() {
        let light = Light::point(Vec3::new(0.0, 2.0, 0.0), Vec3::splat(8.0));
        let radiance: Vec3 = unshadowed(&floor(), &light.sample_li(Vec2::ZERO, Vec3::ZERO));
        assert!((radiance - Vec3::splat(0.5 / core::f32::consts::PI * 8.0 / 4.0)).abs().max_element() < 1e-6);
        let target = target_function(&floor(), &light.sample_li(Vec2::ZERO, Vec3::ZERO));
        assert!((target - radiance.x).abs() < 1e-6);
    }

    #[test]
    fn light_from_below_or_along_the_surface_is_dark() {
        for position in [-Vec3::Y, Vec3::X, -Vec3::X + -0.1 * Vec3::Y, Vec3::ZERO] {
            let light = Light::point(position, Vec3::ONE);
            assert_eq!(
                target_function(&floor(), &light.sample_li(Vec2::ZERO, Vec3::ZERO)),
                0.0,
                "{position}"
            );
        }
        // A shading normal that leans over does not light what its surface hides.
        let leaning = Surface { normal: Vec3::new(1.0, 1.0, 0.0).normalize(), ..floor() };
        let light = Light::point(Vec3::new(1.0, -0.1, 0.0), Vec3::ONE);
        assert_eq!(target_function(&leaning, &light.sample_li(Vec2::ZERO, Vec3::ZERO)), 0.0);
    }
}
