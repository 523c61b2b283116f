//! Deformation of a node's mesh: its skin, and the weights of its morph targets.

use super::accessors::{self, Integers};
use super::nodes::Placed;
use super::{Reason, label};
use crate::scene::Primitive;
use crate::scene::deform::{Deformed, Joint, JointPlace, Skin};
use glam::{DAffine3, DMat4, DVec3};
use gltf::accessor::Dimensions;
use std::collections::HashMap;

/// Where the nodes of the scene are that may be joints: by their index in the document.
pub type Joints = HashMap<usize, JointPlace>;

/// `moving`: which node of the animation each is.
pub fn joints(nodes: &[Placed], moving: &[Option<usize>]) -> Joints {
    let place = |(placed, moving): (&Placed, &Option<usize>)| {
        (placed.node.index(), moving.map_or(JointPlace::Resting(placed.world), JointPlace::Node))
    };
    nodes.iter().zip(moving).map(place).collect()
}

/// What bends the mesh of `placed`, which `mesh` of the scene will show: none where nothing does. `offset`: what its positions are
/// relative to; `morph`: what moves its weights. Error: a skin that is broken.
pub fn deformed(
    placed: &Placed,
    mesh: usize,
    rest: &[Primitive],
    offset: DVec3,
    morph: Option<usize>,
    joints: &Joints,
    buffers: &[Vec<u8>],
) -> Reason<Option<Deformed>> {
    let targets = rest.iter().map(|primitive| primitive.bends.targets.len()).max().unwrap_or(0);
    let skinned = rest.iter().any(|primitive| !primitive.bends.influences.is_empty());
    let skin = placed.node.skin().filter(|_| skinned);
    if targets == 0 && skin.is_none() {
        return Ok(None);
    }
    let world = -(placed.mesh_world.translation + offset);
    let skin = skin.map(|skin| read(&skin, joints, buffers)).transpose()?;
    let skin = skin.map(|joints| Skin { joints, world, offset });
    let usual = placed.node.mesh().and_then(|mesh| mesh.weights().map(<[f32]>::to_vec));
    let own = placed.node.weights().map(<[f32]>::to_vec);
    let mut weights: Vec<f64> = own.or(usual).unwrap_or_default().into_iter().map(f64::from).collect();
    weights.resize(targets, 0.0);
    weights.iter_mut().filter(|weight| !weight.is_finite()).for_each(|weight| *weight = 0.0);
    Ok(Some(Deformed { mesh, rest: rest.to_vec(), weights, morph, skin }))
}

fn read(skin: &gltf::Skin, joints: &Joints, buffers: &[Vec<u8>]) -> Reason<Vec<Joint>> {
    let label = label("skin", skin.index(), skin.name());
    let named = |reason: String| format!("{label}: {reason}");
    let matrices = skin
        .inverse_bind_matrices()
        .map(|accessor| accessors::floats::<16>(&accessor, &[Dimensions::Mat4], Integers::None, buffers))
        .transpose()
        .map_err(&named)?;
    let joint = |(i, node): (usize, gltf::Node)| {
        let place = *joints.get(&node.index()).ok_or_else(|| format!("joint {i} is outside of the scene"))?;
        let inverse_bind = match &matrices {
            None => DAffine3::IDENTITY,
            Some(matrices) => {
                let columns =
                    matrices.get(i).ok_or_else(|| format!("joint {i} has no inverse bind matrix"))?;
                DAffine3::from_mat4(DMat4::from_cols_array(&columns.map(f64::from)))
            }
        };
        if inverse_bind.is_finite() {
            Ok(Joint { place, inverse_bind })
        } else {
            Err(format!("the inverse bind matrix of joint {i} is not finite"))
        }
    };
    skin.joints().enumerate().map(joint).collect::<Reason<_>>().map_err(&named)
}
