//! Probability measures as types, so that a density over area is never taken for one over solid angle.

use crate::math::safe_ratio;

/// Probability of one of finitely many outcomes. Unit 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pmf(pub f32);

/// Density over surface area. Unit 1/m².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PdfArea(pub f32);

/// Density over solid angle. Unit 1/sr.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PdfSolidAngle(pub f32);

/// Density of a light sample in the measure of its light: area (1/m²), solid angle (1/sr) or counting (delta lights, 1).
/// This is the p of resampling. Samples live on the light, so reuse between pixels has Jacobian 1; a light whose measure changes
/// between frames brings [`crate::motion::PastLights::jacobian`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SourcePdf(pub f32);

impl Pmf {
    /// p(light, point) = p(light) p(point | light).
    pub fn and_on_light(self, on_light: SourcePdf) -> SourcePdf {
        SourcePdf(self.0 * on_light.0)
    }
}

impl PdfArea {
    /// dω = cosθ' / d² dA, so p_ω = p_A d² / cosθ'; 0 where the light is seen edge-on.
    ///
    /// Equation (2).
    pub fn to_solid_angle(self, distance: f32, cos_light: f32) -> PdfSolidAngle {
        PdfSolidAngle(safe_ratio(self.0 * distance * distance, cos_light))
    }
}

impl PdfSolidAngle {
    /// The inverse of [`PdfArea::to_solid_angle`].
    pub fn to_area(self, distance: f32, cos_light: f32) -> PdfArea {
        PdfArea(safe_ratio(self.0 * cos_light, distance * distance))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conversions_are_inverse() {
        let area = PdfArea(0.25);
        let solid_angle = area.to_solid_angle(3.0, 0.5);
        assert_eq!(solid_angle, PdfSolidAngle(4.5));
        assert_eq!(solid_angle.to_area(3.0, 0.5), area);
        assert_eq!(area.to_solid_angle(3.0, 0.0), PdfSolidAngle(0.0));
    }
}
