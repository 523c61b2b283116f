//! The node hierarchy -> instances, cameras and lights in world space.

use super::warnings::Warnings;
use super::{Reason, label};
use crate::scene::animation::{Local, Thing, view_axes};
use crate::scene::{
    DirectionalLight, PanelLight, PanelShape, PlacedLight, PointLight, SceneCamera, SceneDescription,
    SpotLight,
};
use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3, Vec2, Vec3};
use gltf::khr_lights_punctual::Kind;
use gltf::scene::Transform;
use gltf::{Document, Node};
use serde_json::Value;
use std::collections::HashMap;

/// The widest outer angle of a spot, radians: π/2, as files round it.
const MAX_CONE: f32 = std::f32::consts::FRAC_PI_2 + 1e-4;

/// A node and its place.
pub struct Placed<'a> {
    pub node: Node<'a>,
    /// Names the node in messages.
    pub label: String,
    /// It and all its parents are (KHR_node_visibility).
    pub visible: bool,
    /// Place in the list of its parent, if it has one.
    pub parent: Option<usize>,
    pub local: Local,
    /// Object to world, relative to the scene's origin once that is known.
    pub world: DAffine3,
    /// The same for its mesh: of a skin, it is the world's.
    pub mesh_world: DAffine3,
    /// Where the copies of its mesh stand, relative to it.
    pub copies: Vec<DAffine3>,
}

/// The nodes of the default scene (or the first), parents before their children. Composed in f64, so that deep
/// hierarchies lose nothing. Errors: no scene, a node that is `broken` or reached twice, a matrix that is no finite affine
/// one.
pub fn place<'a>(document: &'a Document, broken: &HashMap<usize, String>) -> Reason<Vec<Placed<'a>>> {
    let scene =
        document.default_scene().or_else(|| document.scenes().next()).ok_or("the file has no scene")?;
    let mut reached = vec![false; document.nodes().len()];
    let mut placed: Vec<Placed> = Vec::new();
    // An own stack: a file may nest its nodes deeper than the program's stack is. Reversed, as the last comes first.
    let mut open: Vec<(Node, Option<usize>)> = scene.nodes().map(|node| (node, None)).collect();
    open.reverse();
    while let Some((node, parent)) = open.pop() {
        let label = label("node", node.index(), node.name());
        if std::mem::replace(&mut reached[node.index()], true) {
            return Err(format!("{label} has two parents, or is its own ancestor"));
        }
        let in_sight = parent.is_none_or(|p| placed[p].visible);
        if let Some(reason) = broken.get(&node.index()).filter(|_| in_sight) {
            return Err(format!("{label}: {reason}"));
        }
        let visible = in_sight && is_shown(&node);
        let local = local_transform(node.transform()).map_err(|reason| format!("{label}: {reason}"))?;
        let world = parent.map_or(DAffine3::IDENTITY, |p: usize| placed[p].world) * local.affine();
        if !world.as_affine3a().is_finite() {
            return Err(format!("{label}: its transform to the world is not finite"));
        }
        let children: Vec<Node> = node.children().collect();
        open.extend(children.into_iter().rev().map(|child| (child, Some(placed.len()))));
        let mesh_world = if node.skin().is_some() { DAffine3::IDENTITY } else { world };
        let copies = vec![DAffine3::IDENTITY];
        placed.push(Placed { node, label, visible, parent, local, world, mesh_world, copies });
    }
    Ok(placed)
}

/// Does the node itself ask to be shown?
fn is_shown(node: &Node) -> bool {
    let visible = |extension: &serde_json::Value| extension.get("visible")?.as_bool();
    node.extension_value("KHR_node_visibility").and_then(visible).unwrap_or(true)
}

fn local_transform(transform: Transform) -> Reason<Local> {
    match transform {
        Transform::Matrix { matrix } => {
            let matrix = DMat4::from_cols_array_2d(&matrix.map(|column| column.map(f64::from)));
            if !matrix.is_finite() {
                return Err("its matrix has an element that is not finite".into());
            }
            let row = matrix.row(3);
            if (row - glam::DVec4::W).abs().max_element() > 1e-5 {
                return Err(format!("its matrix is not affine: the last row is {row}"));
            }
            Ok(Local::Matrix(DAffine3::from_mat4(matrix)))
        }
        Transform::Decomposed { translation, rotation, scale } => {
            let rotation = DQuat::from_array(rotation.map(f64::from));
            if !(rotation.is_finite() && rotation.length_squared() > 0.0) {
                return Err(format!("{rotation} is not a rotation"));
            }
            let [translation, scale] = [translation, scale].map(|v| DVec3::from_array(v.map(f64::from)));
            Ok(Local::Trs { translation, rotation: rotation.normalize(), scale })
        }
    }
}

impl Placed<'_> {
    /// Does its transform leave an area of anything?
    pub fn has_area(&self) -> bool {
        let DMat3 { x_axis: x, y_axis: y, z_axis: z } = self.mesh_world.matrix3;
        let areas = [x.cross(y), y.cross(z), z.cross(x)];
        areas.iter().any(|&area| area != DVec3::ZERO)
    }

    /// The node's perspective camera. Its transform turns and moves, but does not scale it. One without a name is called
    /// by its `number`.
    pub fn camera(&self, number: usize, warnings: &mut Warnings) -> Option<SceneCamera> {
        let camera = self.node.camera()?;
        let fov_y = match camera.projection() {
            gltf::camera::Projection::Perspective(perspective) => perspective.yfov(),
            gltf::camera::Projection::Orthographic(_) => {
                warnings.add("orthographic cameras are left out", &self.label);
                return None;
            }
        };
        let axes = view_axes(&self.world).filter(|_| fov_y > 0.0 && fov_y < std::f32::consts::PI);
        let Some((forward, up)) = axes else {
            warnings.add("a camera without a view is left out", &self.label);
            return None;
        };
        let name = camera.name().or(self.node.name()).filter(|name| !name.is_empty());
        Some(SceneCamera {
            name: name.map_or_else(|| number.to_string(), str::to_owned),
            position: self.world.translation.as_vec3(),
            forward,
            up,
            fov_y,
        })
    }

    /// The node's mesh, if it is shown.
    pub fn mesh(&self) -> Option<gltf::Mesh<'_>> {
        self.node.mesh().filter(|_| self.visible)
    }

    /// Adds the node's light (KHR_lights_punctual), if it is shown: its color is linear, and no scale changes its
    /// intensity. Gives the light.
    pub fn add_light(&self, scene: &mut SceneDescription, warnings: &mut Warnings) -> Option<Thing> {
        let light = self.node.light().filter(|_| self.visible)?;
        if light.range().is_some() {
            let text = "the range of a light is ignored: it falls off with the square of the distance";
            warnings.add(text, &self.label);
        }
        let intensity = Vec3::from(light.color()) * light.intensity();
        if !(intensity.is_finite() && intensity.min_element() >= 0.0) {
            let label = format!("{}: {intensity}", self.label);
            warnings.add("a light of negative or infinite intensity is left out", &label);
            return None;
        }
        let position = self.world.translation.as_vec3();
        // It shines along -z.
        let axis = -self.world.matrix3.z_axis.normalize_or_zero().as_vec3();
        if axis == Vec3::ZERO && !matches!(light.kind(), Kind::Point) {
            warnings.add("a light with a scale of 0 is left out", &self.label);
            return None;
        }
        let radius = radius_of(light.extras()).or(radius_of(self.node.extras())).unwrap_or(0.0);
        let possible = (0.0..=MAX_RADIUS).contains(&radius);
        if !possible {
            let label = format!("{}: {radius}", self.label);
            warnings.add("a light with an invalid radius becomes a point", &label);
        }
        let radius = if possible { radius } else { 0.0 };
        scene.lights.push(match light.kind() {
            Kind::Point => PointLight { position, intensity, radius }.into(),
            Kind::Spot { inner_cone_angle: inner, outer_cone_angle: outer } => {
                let outer_angle = outer.clamp(0.0, MAX_CONE);
                let inner_angle = inner.clamp(0.0, outer_angle);
                if [inner_angle, outer_angle] != [inner, outer] {
                    let label = format!("{}: from {inner} to {outer} rad", self.label);
                    warnings.add("the cone of a spot is cut to 0 <= inner <= outer <= pi/2", &label);
                }
                SpotLight { position, axis, intensity, inner_angle, outer_angle, radius }.into()
            }
            Kind::Directional => DirectionalLight { direction: -axis, illuminance: intensity }.into(),
        });
        Some(Thing::Light(scene.lights.len() - 1))
    }

    /// Adds the node's light of `panels` (EXT_lights_area, as the document has it), if it is shown. Gives the light.
    pub fn add_panel(
        &self,
        panels: Option<&Value>,
        scene: &mut SceneDescription,
        warnings: &mut Warnings,
    ) -> Option<Thing> {
        let place = self.node.extension_value("EXT_lights_area")?.get("light")?.as_u64()?;
        let light = panels?.get("lights")?.get(usize::try_from(place).ok()?).filter(|_| self.visible)?;
        let number = |object: Option<&Value>, name, usual| number(object, name).unwrap_or(usual);
        let color = light.get("color").and_then(Value::as_array);
        let channel = |i: usize| color.map_or(1.0, |color| color[i].as_f64().unwrap_or(1.0)) as f32;
        let radiance = Vec3::from_array([0, 1, 2].map(channel)) * number(Some(light), "intensity", 1000.0);
        let scale = self.world.matrix3;
        let scale =
            [scale.x_axis, scale.y_axis, scale.z_axis].map(DVec3::length).into_iter().fold(0.0, f64::max);
        let height = number(Some(light), "size", 1.0) * scale as f32;
        let (shape, aspect) = match light.get("type").and_then(Value::as_str) {
            Some("disk") => (PanelShape::Disk, 1.0),
            _ => (PanelShape::Rectangle, number(light.get("rect"), "aspect", 1.0)),
        };
        let size = Vec2::new(height * aspect, height);
        if !(radiance.is_finite() && radiance.min_element() >= 0.0) {
            let label = format!("{}: {radiance}", self.label);
            warnings.add("a light of negative or infinite intensity is left out", &label);
            return None;
        }
        if !(size.min_element() > 0.0 && size.max_element() <= MAX_RADIUS) {
            warnings.add("an area light without a size is left out", &format!("{}: {size} m", self.label));
            return None;
        }
        let mut light: PlacedLight =
            PanelLight { position: Vec3::ZERO, axis: Vec3::NEG_Z, up: Vec3::Y, size, shape, radiance }.into();
        light.place(&self.world);
        scene.lights.push(light);
        Some(Thing::Light(scene.lights.len() - 1))
    }
}

/// m: squares of it are numbers.
const MAX_RADIUS: f32 = 1e12;

fn number(object: Option<&Value>, name: &str) -> Option<f32> {
    Some(object?.get(name)?.as_f64()? as f32)
}

/// m: `radius` of what a file may add to things.
fn radius_of(extras: &gltf::json::Extras) -> Option<f32> {
    let extras: Value = serde_json::from_str(extras.as_ref()?.get()).ok()?;
    number(Some(&extras), "radius")
}
