//! The lights that a scene lists one by one, in the physical terms of files. (Emissive meshes and the environment bring others.)

use glam::{DAffine3, Vec2, Vec3};
use shared::light::Light;

/// A light with a place of its own, in world space.
///
/// ```
/// use candela::scene::{DirectionalLight, PanelLight, PanelShape, PlacedLight, PointLight, SpotLight};
/// use candela::shared::glam::{Vec2, Vec3};
///
/// let bulb = PointLight { position: Vec3::Y, intensity: Vec3::splat(80.0), radius: 0.05 };
/// let spot = SpotLight {
///     position: 3.0 * Vec3::Y,
///     axis: -Vec3::Y,
///     intensity: Vec3::splat(1_000.0),
///     inner_angle: 0.3,
///     outer_angle: 0.5,
///     radius: 0.0,
/// };
/// let window = PanelLight {
///     position: Vec3::new(0.0, 1.5, -4.0),
///     axis: Vec3::Z,
///     up: Vec3::Y,
///     size: Vec2::new(2.0, 1.0),
///     shape: PanelShape::Rectangle,
///     radiance: Vec3::splat(500.0),
/// };
/// let sun = DirectionalLight { direction: Vec3::new(0.6, 0.8, 0.0), illuminance: Vec3::splat(100_000.0) };
/// let lights: [PlacedLight; 4] = [bulb.into(), spot.into(), window.into(), sun.into()];
/// assert!(lights[2].position() == Some(window.position) && lights[3].position().is_none());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlacedLight {
    /// In every direction.
    Point(PointLight),
    /// Into a cone.
    Spot(SpotLight),
    /// From infinity.
    Directional(DirectionalLight),
    /// From a rectangle or a disk.
    Panel(PanelLight),
}

/// A point light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLight {
    /// m
    pub position: Vec3,
    /// cd, linear RGB
    pub intensity: Vec3,
    /// m; 0 for a point, else it is a sphere with the same flux.
    pub radius: f32,
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
    /// None from here on, radians.
    pub outer_angle: f32,
    /// m; 0 for a point, else its flux leaves a disk across the axis.
    pub radius: f32,
}

/// Parallel light, such as the sun's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionalLight {
    /// Unit, toward the light.
    pub direction: Vec3,
    /// On a surface that faces the light, lx, linear RGB
    pub illuminance: Vec3,
}

/// A flat light (EXT_lights_area): it shines to one side, and its every point evenly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PanelLight {
    /// Its center, m.
    pub position: Vec3,
    /// Unit, the way it shines.
    pub axis: Vec3,
    /// Unit, across the axis: along its height.
    pub up: Vec3,
    /// Width and height, m; of a disk both are the diameter.
    pub size: Vec2,
    /// Rectangle or disk.
    pub shape: PanelShape,
    /// nit, linear RGB
    pub radiance: Vec3,
}

/// Of a flat light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PanelShape {
    /// Width x height.
    Rectangle,
    /// An ellipse where width and height differ.
    Disk,
}

impl PlacedLight {
    /// As estimators see it. `radius`: of the scene's bounding sphere, m; only light from infinity asks.
    pub fn light(&self, radius: impl FnOnce() -> f32) -> Light {
        match *self {
            PlacedLight::Point(l) if l.radius > 0.0 => Light::sphere(l.position, l.radius, l.intensity),
            PlacedLight::Point(l) => Light::point(l.position, l.intensity),
            PlacedLight::Spot(l) => {
                let spot = Light::spot(l.position, l.axis, l.intensity, l.inner_angle, l.outer_angle);
                if l.radius > 0.0 { spot.soft_spot(l.radius) } else { spot }
            }
            PlacedLight::Panel(l) => match l.shape {
                PanelShape::Rectangle => Light::rectangle(l.position, l.sides(), l.radiance),
                PanelShape::Disk => Light::disk(l.position, l.axis, 0.5 * l.size.x, l.radiance),
            },
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
            PlacedLight::Panel(l) => {
                l.position = position;
                let up = world.matrix3.y_axis.as_vec3().reject_from_normalized(back).normalize_or_zero();
                if back != Vec3::ZERO && up != Vec3::ZERO {
                    (l.axis, l.up) = (-back, up);
                }
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
            PlacedLight::Panel(l) => Some(l.position),
            PlacedLight::Directional(_) => None,
        }
    }

    /// Gives it a radius, m, if it is a point or a spot without.
    pub fn soften(&mut self, to: f32) {
        if let PlacedLight::Point(PointLight { radius, .. }) | PlacedLight::Spot(SpotLight { radius, .. }) =
            self
            && *radius == 0.0
        {
            *radius = to;
        }
    }

    /// What it radiates, in the unit of its kind, linear RGB.
    pub fn emission_mut(&mut self) -> &mut Vec3 {
        match self {
            PlacedLight::Point(l) => &mut l.intensity,
            PlacedLight::Spot(l) => &mut l.intensity,
            PlacedLight::Panel(l) => &mut l.radiance,
            PlacedLight::Directional(l) => &mut l.illuminance,
        }
    }
}

impl PanelLight {
    /// Its width and its height, m, whose cross product points where it shines.
    pub fn sides(&self) -> [Vec3; 2] {
        [self.up.cross(self.axis) * self.size.x, self.up * self.size.y]
    }
}

impl From<PanelLight> for PlacedLight {
    fn from(light: PanelLight) -> Self {
        PlacedLight::Panel(light)
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
