//! Reflected light as a whole, or in the parts that denoisers and layered pictures want.

use core::f32::consts::FRAC_1_PI;
use core::ops::{AddAssign, Div, Mul};
use glam::Vec3;

/// What reflection gives: [`Vec3`], all of it, or [`Parts`]. Functions that are generic over it compute either in one way.
pub trait Reflected:
    Copy
    + Default
    + PartialEq
    + AddAssign
    + Mul<Vec3, Output = Self>
    + Mul<f32, Output = Self>
    + Div<f32, Output = Self>
{
    /// The BSDF's value for Schlick's F = `fresnel` and D V = `specular` over a diffuse lobe of `albedo`, 1/sr.
    fn from_lobes(albedo: Vec3, fresnel: Vec3, specular: f32) -> Self;

    /// All of it, from a surface of `albedo`.
    fn whole(self, albedo: Vec3) -> Vec3;
}

impl Reflected for Vec3 {
    fn from_lobes(albedo: Vec3, fresnel: Vec3, specular: f32) -> Self {
        (Vec3::ONE - fresnel) * albedo * FRAC_1_PI + fresnel * specular
    }

    fn whole(self, _: Vec3) -> Vec3 {
        self
    }
}

/// Light by the lobe that reflects it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Parts {
    /// Of a diffuse lobe of albedo 1: demodulated, so it is finite where the albedo is 0.
    pub diffuse: Vec3,
    /// As reflected.
    pub specular: Vec3,
}

impl Parts {
    /// Diffuse, specular.
    pub fn apart(self) -> (Vec3, Vec3) {
        (self.diffuse, self.specular)
    }
}

impl Reflected for Parts {
    fn from_lobes(_: Vec3, fresnel: Vec3, specular: f32) -> Self {
        Parts { diffuse: (Vec3::ONE - fresnel) * FRAC_1_PI, specular: fresnel * specular }
    }

    fn whole(self, albedo: Vec3) -> Vec3 {
        albedo * self.diffuse + self.specular
    }
}

impl AddAssign for Parts {
    fn add_assign(&mut self, other: Parts) {
        self.diffuse += other.diffuse;
        self.specular += other.specular;
    }
}

impl Mul<Vec3> for Parts {
    type Output = Parts;

    fn mul(self, factor: Vec3) -> Parts {
        Parts { diffuse: self.diffuse * factor, specular: self.specular * factor }
    }
}

impl Mul<f32> for Parts {
    type Output = Parts;

    fn mul(self, factor: f32) -> Parts {
        self * Vec3::splat(factor)
    }
}

impl Div<f32> for Parts {
    type Output = Parts;

    fn div(self, divisor: f32) -> Parts {
        Parts { diffuse: self.diffuse / divisor, specular: self.specular / divisor }
    }
}
