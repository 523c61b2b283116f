//! The lights that a scene lists one by one, in the physical terms of files. (Emissive meshes and the environment bring others.)

use glam::{DAffine3, Vec3};
use shared::light::Light;

/// A light with a place of its own, in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlacedLight {
    Point(PointLight),
    Spot(SpotLight),
    Directional(DirectionalLight),
}

/// A point light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLight {
    /// m
    pub position: Vec3,
    /// cd, linear RGB
    pub intensity: Vec3,
}

/// A point light that shines into a cone (KHR_lights_punctual).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpotLight {
    /// m
    pub position: Vec3,
    /// Unit, the way it shines.
    pub axis: Vec3,
    /// On the axis, cd, linear RGB
    pub intensity: Vec3,
    /// Angles from the axis, radians: full intensity up to the inner, none from the outer on.
    pub inner_angle: f32,
    pub outer_angle: f32,
}

/// Parallel light, such as the sun's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionalLight {
    /// Unit, toward the light.
    pub direction: Vec3,
    /// On a surface that faces the light, lx, linear RGB
    pub illuminance: Vec3,
}

impl PlacedLight {
    /// As estimators see it. `radius`: of the scene's bounding sphere, m; only light from infinity asks.
    pub fn light(&self, radius: impl FnOnce() -> f32) -> Light {
        match *self {
            PlacedLight::Point(l) => Light::point(l.position, l.intensity),
            PlacedLight::Spot(l) => {
                Light::spot(l.position, l.axis, l.intensity, l.inner_angle, l.outer_angle)
            }
            PlacedLight::Directional(l) => Light::directional(l.direction, l.illuminance, radius()),
        }
    }

    /// Puts it at `world`: lights shine along -z. What is scaled to nothing keeps its direction.
    pub fn place(&mut self, world: &DAffine3) {
        let position = world.translation.as_vec3();
        let back = world.matrix3.z_axis.normalize_or_zero().as_vec3();
        match self {
            PlacedLight::Point(l) => l.position = position,
            PlacedLight::Spot(l) => {
                l.position = position;
                l.axis = if back == Vec3::ZERO { l.axis } else { -back };
            }
            PlacedLight::Directional(l) => {
                l.direction = if back == Vec3::ZERO { l.direction } else { back };
            }
        }
    }

    /// Where it is, m; nowhere, if its light comes from infinity.
    pub fn position(&self) -> Option<Vec3> {
        match self {
            PlacedLight::Point(l) => Some(l.position),
            PlacedLight::Spot(l) => Some(l.position),
            PlacedLight::Directional(_) => None,
        }
    }

    /// What it radiates, in the unit of its kind, linear RGB.
    pub fn emission_mut(&mut self) -> &mut Vec3 {
        match self {
            PlacedLight::Point(l) => &mut l.intensity,
            PlacedLight::Spot(l) => &mut l.intensity,
            PlacedLight::Directional(l) => &mut l.illuminance,
        }
    }
}

impl From<PointLight> for PlacedLight {
    fn from(light: PointLight) -> Self {
        PlacedLight::Point(light)
    }
}

impl From<SpotLight> for PlacedLight {
    fn from(light: SpotLight) -> Self {
        PlacedLight::Spot(light)
    }
}

impl From<DirectionalLight> for PlacedLight {
    fn from(light: DirectionalLight) -> Self {
        PlacedLight::Directional(light)
    }
}
